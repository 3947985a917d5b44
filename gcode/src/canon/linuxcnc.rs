//! Calls as LinuxCNC's stand-alone interpreter (`rs274 -g`, version 2.10) prints them, byte for byte.
//!
//! In: calls. Out: lines of a running number, the N word of the program line (`N.....` without one), and the
//! call:
//! ```text
//!    13 N0010  STRAIGHT_FEED(3.0000, 0.3000, 5.0000, 0.0000, 0.0000, 0.0000)
//! ```
//! Lengths have four decimals, leads, tolerances of the path and output values six. `(PRINT,...)` is its text
//! alone, without a number. What that interpreter passes over in silence (M66, the change to G93) prints
//! nothing.

use std::io::{self, Write};

use super::printer::Lines;
use super::{Arc, Call, FeedMode, PathMode, Place, Pose, Sink};
use crate::bounds::NO_HIGHEST_SPEED;
use crate::files::Tool;
use crate::problem::Problem;

/// Prints calls as `rs274 -g` does.
pub struct LinuxcncPrinter<W: Write> {
    lines: Lines<W>,
    number: Counter,
}

impl<W: Write> LinuxcncPrinter<W> {
    /// A printer that writes to `file`, 64 KiB at a time.
    pub fn new(file: W) -> LinuxcncPrinter<W> {
        LinuxcncPrinter { lines: Lines::new(file), number: Counter::new() }
    }

    /// Writes what is left in the buffer.
    ///
    /// # Errors
    /// The first error of the file, of this write or of an earlier one.
    pub fn flush(&mut self) -> io::Result<()> {
        self.lines.flush()
    }

    fn head(&mut self, place: Place) {
        self.lines.bytes(self.number.next());
        match place.n {
            None => self.lines.text(" N..... "),
            Some(n) => self.n_word(n, usize::from(place.n_digits)),
        }
    }

    /// N as it was written, leading zeros included, in six columns.
    fn n_word(&mut self, n: u32, digits: usize) {
        if digits == 0 {
            return self.lines.text(" N      ");
        }
        let own = n.checked_ilog10().map_or(1, |power| power as usize + 1);
        self.lines.text(" N");
        (own..digits).for_each(|_| self.lines.text("0"));
        self.lines.integer(n);
        (own.max(digits)..6).for_each(|_| self.lines.text(" "));
    }

    fn position(&mut self, name: &str, position: &Pose) {
        self.lines.text(name);
        let (lengths, angles) = position.split_at(3);
        self.lines.fours(lengths, ", ");
        self.angles(angles);
    }

    /// The angles that end a position, which are hardly ever other than zero.
    fn angles(&mut self, angles: &[f64]) {
        if angles.iter().all(|angle| angle.to_bits() == 0) {
            return self.lines.text(", 0.0000, 0.0000, 0.0000)");
        }
        self.lines.text(", ");
        self.lines.fours(angles, ", ");
        self.lines.text(")");
    }

    fn arc(&mut self, arc: &Arc) {
        self.lines.text("ARC_FEED(");
        self.lines.fours(&arc.end, ", ");
        self.lines.text(", ");
        self.lines.fours(&arc.center, ", ");
        self.lines.text(", ");
        self.lines.integer(arc.turns);
        self.lines.text(", ");
        self.lines.four(arc.along);
        self.angles(&arc.rotary);
    }

    fn one_number(&mut self, name: &str, value: f64) {
        self.lines.text(name);
        self.lines.four(value);
        self.lines.text(")");
    }

    /// Nine offsets in three groups; `between` parts the groups.
    fn nine(&mut self, offset: &Pose, uvw: &[f64; 3], between: &str) {
        let (lengths, angles) = offset.split_at(3);
        self.lines.fours(lengths, " ");
        self.lines.text(between);
        self.lines.fours(angles, " ");
        self.lines.text(between);
        self.lines.fours(uvw, " ");
    }

    fn tool(&mut self, tool: &Tool) {
        self.lines.text("SET_TOOL_TABLE_ENTRY(");
        self.lines.integer(tool.index);
        self.lines.text(", ");
        self.lines.integer(tool.number);
        self.lines.text(", ");
        self.nine(&tool.offset, &tool.uvw, " ");
        self.lines.text(", ");
        self.lines.fours(&[tool.front_angle, tool.back_angle], ", ");
        self.lines.text(", ");
        self.lines.integer(tool.orientation);
        self.lines.text(")");
    }

    fn output_value(&mut self, name: &str, index: u32, value: f64) {
        self.lines.text(name);
        self.lines.integer(index);
        self.lines.text(",");
        self.lines.six(value);
        self.lines.text(")");
    }

    fn path_mode(&mut self, mode: PathMode) {
        self.lines.text("SET_MOTION_CONTROL_MODE(CANON_");
        match mode {
            PathMode::ExactPath => self.lines.text("EXACT_PATH"),
            PathMode::ExactStop => self.lines.text("EXACT_STOP"),
            PathMode::Continuous(tolerance) => {
                self.lines.text("CONTINUOUS, ");
                self.lines.six(tolerance);
            }
        }
        self.lines.text(")");
    }

    /// Everything that is neither a move nor a state of coordinates.
    fn others(&mut self, call: &Call<'_>) {
        match *call {
            Call::SetSpindleMode(limit) => {
                self.one_number("SET_SPINDLE_MODE(0 ", limit.min(NO_HIGHEST_SPEED))
            }
            Call::SetSpindleSpeed(speed) => self.one_number("SET_SPINDLE_SPEED(0, ", speed),
            Call::NurbsFeed(curve) => {
                let (name, count) = match curve.named {
                    true => ("saicanon NURBS_G6_FEED_(", curve.knots.len()),
                    false => ("NURBS_G5_FEED(", curve.points.len()),
                };
                self.lines.text(name);
                self.lines.integer(count as u32);
                self.lines.text(", ...)");
            }
            Call::SetPlannerMode(smooth) => {
                let (kind, scale) = smooth.map_or((0, -1.0), |scale| (1, scale));
                self.lines.text("SET_PLANNER_MODE(type=");
                self.lines.integer(kind);
                self.lines.text(", peak_scale=");
                self.lines.six(scale);
                self.lines.text(")");
            }
            Call::OrientSpindle(angle, direction) => {
                self.lines.text("ORIENT_SPINDLE(0, ");
                self.lines.four(angle);
                self.lines.text(", ");
                self.lines.integer(direction);
                self.lines.text(")");
            }
            Call::WaitSpindleOrient(time) => self.one_number("SPINDLE.0.WAIT_ORIENT_COMPLETE(", time),
            Call::ChangeTool(_) => self.lines.text("CHANGE_TOOL()"),
            Call::SetToolTableEntry(tool) => self.tool(tool),
            Call::SetMotionOutputValue(index, value) => {
                self.output_value("SET_MOTION_OUTPUT_VALUE(", index, value);
            }
            Call::SetAuxOutputValue(index, value) => self.output_value("SET_AUX_OUTPUT_VALUE(", index, value),
            Call::Comment(text) => self.lines.quoted("COMMENT", text),
            Call::Note(text) => {
                self.lines.text("COMMENT(\"interpreter: ");
                self.lines.text(text);
                self.lines.text("\")");
            }
            Call::Message(text) => self.lines.quoted("MESSAGE", text),
            Call::Log("LOGCLOSE", _) => self.lines.text("LOGCLOSE()"),
            Call::Log(verb, text) => self.lines.quoted(verb, text),
            _ => {
                let known = self.lines.simple(call);
                debug_assert!(known, "{call:?} has no line");
            }
        }
    }
}

impl<W: Write> Sink for LinuxcncPrinter<W> {
    fn call(&mut self, place: Place, call: Call<'_>) -> Result<(), Box<Problem>> {
        match call {
            Call::WaitInput { .. } | Call::MoveByHand => return Ok(()),
            Call::ThreadCycle(cycle) => return cycle.expand(&mut |call| self.call(place, call)),
            Call::Print(text) => {
                self.lines.text(text);
                return self.lines.end();
            }
            _ => {}
        }
        self.head(place);
        match call {
            Call::StraightFeed(end) => self.position("STRAIGHT_FEED(", &end),
            Call::StraightTraverse(end) => self.position("STRAIGHT_TRAVERSE(", &end),
            Call::ArcFeed(arc) => self.arc(&arc),
            Call::StraightProbe(_, end) => {
                self.lines.text("TURN_PROBE_ON()");
                self.lines.end()?;
                self.head(place);
                self.position("STRAIGHT_PROBE(", &end);
                self.lines.end()?;
                self.head(place);
                self.lines.text("TURN_PROBE_OFF()");
            }
            Call::RigidTap(bottom, ..) => {
                self.lines.text("RIGID_TAP(");
                self.lines.fours(bottom.split_at(3).0, ", ");
                self.lines.text(")");
            }
            Call::SetFeedRate(feed) => self.one_number("SET_FEED_RATE(", feed),
            Call::SetFeedMode(mode) => {
                let turns = mode == FeedMode::PerRevolution;
                self.lines.text(if turns { "SET_FEED_MODE(0, 1)" } else { "SET_FEED_MODE(0, 0)" });
            }
            Call::Dwell(time) => self.one_number("DWELL(", time),
            Call::StartSpeedFeedSynch { lead, velocity, .. } => {
                self.lines.text("START_SPEED_FEED_SYNC(");
                self.lines.six(lead);
                self.lines.text(if velocity { ",1)" } else { ",0)" });
            }
            Call::SetG5xOffset(system, offset) => {
                self.lines.text("SET_G5X_OFFSET(");
                self.lines.integer(system);
                self.position(", ", &offset);
            }
            Call::SetG92Offset(offset) => self.position("SET_G92_OFFSET(", &offset),
            Call::SetXyRotation(angle) => self.one_number("SET_XY_ROTATION(", angle),
            Call::UseToolLengthOffset(offset) => {
                self.lines.text("USE_TOOL_LENGTH_OFFSET(");
                self.nine(&offset, &[0.0; 3], ", ");
                self.lines.text(")");
            }
            Call::SetMotionControlMode(mode) => self.path_mode(mode),
            Call::SetNaivecamTolerance { tolerance, .. } => {
                self.one_number("SET_NAIVECAM_TOLERANCE(", tolerance)
            }
            _ => self.others(&call),
        }
        self.lines.end()
    }
}

/// A number that counts up as text: cheaper than making its digits anew forevery line.
struct Counter {
    /// Right-aligned, blanks in front.
    text: [u8; 20],
    digits: usize,
}

impl Counter {
    /// Counts from 0.
    fn new() -> Counter {
        Counter { text: [b' '; 20], digits: 0 }
    }

    /// The next number, in five columns or more.
    fn next(&mut self) -> &[u8] {
        for (n, place) in self.text.iter_mut().rev().enumerate() {
            match place {
                b'9' => *place = b'0',
                b' ' => {
                    (*place, self.digits) = (b'1', n + 1);
                    break;
                }
                digit => {
                    *digit += 1;
                    break;
                }
            }
        }
        self.text.split_at(self.text.len() - self.digits.max(5)).1
    }
}
