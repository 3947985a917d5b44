//! Calls in a tidy form, made for reading and for comparing programs.
//!
//! In: calls. Out: one call a line in the names of RS274/NGC, in mm, radius for X, four decimals, no line
//! numbers:
//! ```text
//! USE_LENGTH_UNITS(CANON_UNITS_MM)
//! STRAIGHT_TRAVERSE(0.0000, 0.0000, 5.0000)
//! ```
//! Positions are X, Y, Z; A, B, C follow from the first of them on that is not zero. Offsets, plane and feed
//! mode are printed when they change, so that the beginning of a program says no more than the program does.
//! What the control says about itself (notes, resets) is left out.

use std::io::{self, Write};

use super::printer::Lines;
use super::{Arc, Call, FeedMode, Job, PathMode, Place, Plane, Pose, Sink, Units};
use crate::files::{Tool, ToolTable};
use crate::problem::Problem;

/// m/min in one ft/min.
const METRE_PER_FOOT: f64 = 0.3048;

/// Prints calls in mm, one a line.
pub struct PlainPrinter<W: Write> {
    lines: Lines<W>,
    /// mm in a unit of the program.
    mm: f64,
    /// mm in a unit of the machine: tools are described in these.
    machine_mm: f64,
    /// Whether any call came yet.
    begun: bool,
    /// Whether A, B, C are used.
    rotary: bool,
    surface_speed: bool,
    feed_mode: FeedMode,
    plane: Plane,
    /// Coordinate system in force and its offset, that of G92, and the rotation.
    system: (u8, Pose),
    g92: Pose,
    rotation: f64,
}

impl<W: Write> PlainPrinter<W> {
    /// A printer that writes to `file`, 64 KiB at a time. `machine` are the units of the tool table.
    pub fn new(file: W, machine: Units) -> PlainPrinter<W> {
        PlainPrinter {
            lines: Lines::new(file),
            mm: machine.mm(),
            machine_mm: machine.mm(),
            begun: false,
            rotary: false,
            surface_speed: false,
            feed_mode: FeedMode::PerMinute,
            plane: Plane::Xy,
            system: (1, [0.0; 6]),
            g92: [0.0; 6],
            rotation: 0.0,
        }
    }

    /// Writes what is left in the buffer.
    ///
    /// # Errors
    /// The first error of the file, of this write or of an earlier one.
    pub fn flush(&mut self) -> io::Result<()> {
        self.lines.flush()
    }

    /// Takes note of what is in force; `false` if the call says nothing that is new.
    fn is_news(&mut self, call: &Call<'_>) -> bool {
        fn change<T: PartialEq>(state: &mut T, new: T) -> bool {
            let changed = *state != new;
            *state = new;
            changed
        }
        match *call {
            Call::UseLengthUnits(units) => {
                self.mm = units.mm();
                false
            }
            Call::SetG5xOffset(system, offset) => {
                let offset = self.in_mm(&offset);
                change(&mut self.system, (system, offset))
            }
            Call::SetG92Offset(offset) => {
                let offset = self.in_mm(&offset);
                change(&mut self.g92, offset)
            }
            Call::SetXyRotation(angle) => change(&mut self.rotation, angle),
            Call::SelectPlane(plane) => change(&mut self.plane, plane),
            Call::SetFeedMode(mode) => change(&mut self.feed_mode, mode),
            Call::SetFeedReference | Call::Note(_) | Call::MoveByHand | Call::OnReset => false,
            _ => true,
        }
    }

    fn in_mm(&self, position: &Pose) -> Pose {
        let [x, y, z, a, b, c] = *position;
        [x * self.mm, y * self.mm, z * self.mm, a, b, c]
    }

    /// Numbers with a name, in parentheses.
    fn numbers(&mut self, name: &str, values: &[f64]) {
        self.lines.text(name);
        self.lines.text("(");
        self.lines.fours(values, ", ");
        self.lines.text(")");
    }

    /// The rest of a call after its name and, for offsets, the number of the system.
    fn position(&mut self, begin: &str, position: &Pose) {
        let position = self.in_mm(position);
        self.lines.text(begin);
        self.rotary |= position.iter().skip(3).any(|angle| *angle != 0.0);
        let (lengths, _) = position.split_at(3);
        self.lines.fours(if self.rotary { &position } else { lengths }, ", ");
        self.lines.text(")");
    }

    fn arc(&mut self, arc: &Arc) {
        let [[end_1, end_2], [center_1, center_2]] = [arc.end, arc.center].map(|at| at.map(|v| v * self.mm));
        self.lines.text("ARC_FEED(");
        self.lines.fours(&[end_1, end_2, center_1, center_2], ", ");
        self.lines.text(", ");
        self.lines.integer(arc.turns);
        self.lines.text(", ");
        self.lines.four(arc.along * self.mm);
        self.rotary |= arc.rotary.iter().any(|angle| *angle != 0.0);
        if self.rotary {
            self.lines.text(", ");
            self.lines.fours(&arc.rotary, ", ");
        }
        self.lines.text(")");
    }

    fn tool(&mut self, tool: &Tool) {
        self.lines.text("SET_TOOL_TABLE_ENTRY(");
        self.lines.integer(tool.index);
        self.lines.text(", ");
        self.lines.integer(tool.number);
        self.lines.text(", ");
        let [x, y, z, a, b, c] = tool.offset;
        let [x, y, z, diameter] = [x, y, z, tool.diameter].map(|v| v * self.machine_mm);
        self.lines.fours(&[x, y, z, a, b, c, diameter, tool.front_angle, tool.back_angle], ", ");
        self.lines.text(", ");
        self.lines.integer(tool.orientation);
        self.lines.text(")");
    }

    /// A call that begins with whole numbers and goes on with one that is not.
    fn indexed(&mut self, name: &str, index: u32, value: f64) {
        self.lines.text(name);
        self.lines.text("(");
        self.lines.integer(index);
        self.lines.text(", ");
        self.lines.four(value);
        self.lines.text(")");
    }

    fn wait_input(&mut self, index: u32, analog: bool, wait: u8, timeout: f64) {
        self.lines.text(if analog { "WAIT_ANALOG_INPUT(" } else { "WAIT_DIGITAL_INPUT(" });
        self.lines.integer(index);
        self.lines.text(", ");
        self.lines.integer(wait);
        self.lines.text(", ");
        self.lines.four(timeout);
        self.lines.text(")");
    }

    fn path_mode(&mut self, mode: PathMode) {
        match mode {
            PathMode::ExactPath => self.lines.text("SET_MOTION_CONTROL_MODE(CANON_EXACT_PATH)"),
            PathMode::ExactStop => self.lines.text("SET_MOTION_CONTROL_MODE(CANON_EXACT_STOP)"),
            PathMode::Continuous(tolerance) => {
                self.lines.text("SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, ");
                self.lines.four(tolerance * self.mm);
                self.lines.text(")");
            }
        }
    }

    fn state(&mut self, call: &Call<'_>) {
        match *call {
            Call::SetG5xOffset(system, offset) => {
                self.lines.text("SET_G5X_OFFSET(");
                self.lines.integer(system);
                self.position(", ", &offset);
            }
            Call::SetG92Offset(offset) => self.position("SET_G92_OFFSET(", &offset),
            Call::SetXyRotation(angle) => self.numbers("SET_XY_ROTATION", &[angle]),
            Call::SetFeedMode(mode) => self.lines.text(match mode {
                FeedMode::InverseTime => "SET_FEED_MODE(CANON_INVERSE_TIME)",
                FeedMode::PerMinute => "SET_FEED_MODE(CANON_UNITS_PER_MINUTE)",
                FeedMode::PerRevolution => "SET_FEED_MODE(CANON_UNITS_PER_REVOLUTION)",
            }),
            Call::SetSpindleMode(limit) => {
                self.surface_speed = limit != 0.0;
                self.indexed("SET_SPINDLE_MODE", 0, limit);
            }
            Call::SetSpindleSpeed(speed) => {
                let feet = self.surface_speed && self.mm != 1.0;
                self.indexed("SET_SPINDLE_SPEED", 0, if feet { speed * METRE_PER_FOOT } else { speed });
            }
            Call::UseToolLengthOffset(offset) => self.position("USE_TOOL_LENGTH_OFFSET(", &offset),
            Call::NurbsFeed(curve) => {
                self.lines.text("NURBS_FEED(");
                self.lines.integer(curve.order as u32);
                for [first, second, weight] in &curve.points {
                    self.lines.text(", ");
                    self.lines.fours(&[first * self.mm, second * self.mm, *weight], ", ");
                }
                for knot in curve.knots.iter().filter(|_| curve.named) {
                    self.lines.text(", ");
                    self.lines.four(*knot);
                }
                self.lines.text(")");
            }
            Call::SetPlannerMode(Some(scale)) => {
                self.lines.text("SET_PLANNER_MODE(SMOOTH, ");
                self.lines.four(scale);
                self.lines.text(")");
            }
            Call::SetPlannerMode(None) => self.lines.text("SET_PLANNER_MODE(TRAPEZOIDAL)"),
            Call::SetMotionControlMode(mode) => self.path_mode(mode),
            Call::SetNaivecamTolerance { tolerance, .. } => {
                self.numbers("SET_NAIVECAM_TOLERANCE", &[tolerance * self.mm]);
            }
            _ => {
                let known = self.lines.simple(call);
                debug_assert!(known, "{call:?} has no line");
            }
        }
    }
}

impl<W: Write> Sink for PlainPrinter<W> {
    fn call(&mut self, _: Place, call: Call<'_>) -> Result<(), Box<Problem>> {
        self.print(call)
    }

    /// A line for each that the job has.
    fn job(&mut self, _: Place, job: &Job, _: &ToolTable) -> Result<Option<Pose>, Box<Problem>> {
        self.begin()?;
        for line in job.lines() {
            self.lines.quoted("JOB", line);
            self.lines.end()?;
        }
        Ok(None)
    }
}

impl<W: Write> PlainPrinter<W> {
    /// The first line, before anything else.
    fn begin(&mut self) -> Result<(), Box<Problem>> {
        if self.begun {
            return Ok(());
        }
        self.begun = true;
        self.lines.text("USE_LENGTH_UNITS(CANON_UNITS_MM)");
        self.lines.end()
    }

    fn print(&mut self, call: Call<'_>) -> Result<(), Box<Problem>> {
        self.begin()?;
        if !self.is_news(&call) {
            return Ok(());
        }
        match call {
            Call::ThreadCycle(cycle) => return cycle.expand(&mut |call| self.print(call)),
            Call::StraightFeed(end) => self.position("STRAIGHT_FEED(", &end),
            Call::StraightTraverse(end) => self.position("STRAIGHT_TRAVERSE(", &end),
            Call::ArcFeed(arc) => self.arc(&arc),
            Call::StraightProbe(_, end) => self.position("STRAIGHT_PROBE(", &end),
            Call::RigidTap(bottom, ..) => self.position("RIGID_TAP(", &bottom),
            Call::SetFeedRate(feed) => {
                let mm = if self.feed_mode == FeedMode::InverseTime { 1.0 } else { self.mm };
                self.numbers("SET_FEED_RATE", &[feed * mm]);
            }
            Call::Dwell(time) => self.numbers("DWELL", &[time]),
            Call::StartSpeedFeedSynch { lead, velocity, start_deg, growth } => {
                self.lines.text("START_SPEED_FEED_SYNCH(0, ");
                self.lines.four(lead * self.mm);
                self.lines.text(if velocity { ", 1" } else { ", 0" });
                if (start_deg, growth) != (0.0, 0.0) {
                    self.lines.text(", ");
                    self.lines.four(start_deg);
                }
                if growth != 0.0 {
                    self.lines.text(", ");
                    self.lines.four(growth * self.mm);
                }
                self.lines.text(")");
            }
            Call::OrientSpindle(angle, direction) => {
                self.lines.text("ORIENT_SPINDLE(0, ");
                self.lines.four(angle);
                self.lines.text(", ");
                self.lines.integer(direction);
                self.lines.text(")");
            }
            Call::WaitSpindleOrient(time) => self.indexed("WAIT_SPINDLE_ORIENT_COMPLETE", 0, time),
            Call::ChangeTool(tool) => {
                self.lines.text("CHANGE_TOOL(");
                self.lines.integer(tool);
                self.lines.text(")");
            }
            Call::SetToolTableEntry(tool) => self.tool(tool),
            Call::SetMotionOutputValue(index, value) => self.indexed("SET_MOTION_OUTPUT_VALUE", index, value),
            Call::SetAuxOutputValue(index, value) => self.indexed("SET_AUX_OUTPUT_VALUE", index, value),
            Call::WaitInput { index, analog, wait, timeout } => self.wait_input(index, analog, wait, timeout),
            Call::Comment(text) => self.lines.quoted("COMMENT", text),
            Call::Message(text) => self.lines.quoted("MESSAGE", text),
            Call::Print(text) => self.lines.quoted("PRINT", text),
            Call::Log(verb, text) => self.lines.quoted(verb, text),
            _ => self.state(&call),
        }
        self.lines.end()
    }
}
