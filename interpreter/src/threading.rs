//! Synchronised motion: G33 and the threading cycles. In: calls. Out: passes, and the timed moves to their starts.
//!
//! A G33 waits until it is known what comes next: a G0 that moves only X becomes its retract, made in step with the
//! spindle.

use gcode::canon::{ThreadCycle, X, Z};
use gcode::problem::{Blame, short};
use gcode::{Call, Place, Problem};
use protocol::machine::Kinematics;
use protocol::{Axis, AxisLaw, Code, Feed, ThreadPass};

use crate::moves::{SAME, within_travel};
use crate::thread::{Cut, Cycle, MOST_PASSES, Plan, Point, Single, plan};
use crate::translate::{Done, Translator, missing};

/// Leads a thread may have, mm.
const LEADS: [f64; 2] = [0.001, 1000.0];
/// Steepest infeed, degrees.
const INFEED_DEG: f64 = 80.0;
/// Highest degression.
const DEGRESSION: f64 = 100.0;
/// So many counts of the spindle encoder at least have to lie within the servo error that Z may have on the helix. On the
/// small lathe a lead of 5 mm faults with one of them at most speeds, with two at some.
const COUNTS_IN_THREAD_ERROR: f64 = 4.0;
/// The end of a law may miss the programmed one by this much, mm.
const ROUNDING: f64 = 1e-8;

/// What a user wants to know about a pass before it is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassNote {
    /// Running number, from 1.
    pub pass: u32,
    /// Line of the program.
    pub line: u32,
    /// Depth below the crest, mm; 0 for G33, which does not know it.
    pub depth_mm: f64,
    /// Z at which the pass starts, mm.
    pub start_z_mm: f64,
    /// Z at which full depth begins and ends, mm.
    pub full_depth_z_mm: [f64; 2],
    /// ΔZ of the run-in and of the run-out, mm.
    pub delta_z_mm: [f64; 2],
    /// Highest spindle speed that every axis can follow, per cent of the programmed one.
    pub max_override_pct: f64,
    /// Size of the pass on the wire, bytes.
    pub packet_bytes: usize,
}

/// A G33 that waits for its retract.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Held {
    place: Place,
    single: Single,
}

impl Translator {
    /// G33: one pass along the path to the target; it is planned when the next move is known.
    pub(crate) fn thread_move(
        &mut self,
        place: Place,
        target: &gcode::Position,
        lead_mm: f64,
        start_deg: f64,
    ) -> Done {
        let (s_rpm, direction) = self.spindle_of_thread()?;
        check_lead(lead_mm, 'K')?;
        let (from, to) = (in_plane(&self.point), in_plane(target));
        if in_plane_of(target, from) != self.point {
            return Err(missing("a thread that turns the spindle as an axis", "move X and Z alone"));
        }
        if (to.z - from.z).abs() < SAME {
            let message = "G33 without a move along Z";
            let help = "threads along X alone (scrolls) are not available yet: add a Z word";
            return Err(Problem::error("not-available", Blame::Block, message, help));
        }
        if self.after_thread {
            let message = "threads that follow each other without a pause are not available yet";
            let help = "put a G0 between the G33 blocks";
            return Err(Problem::error("not-available", Blame::Block, message, help));
        }
        self.check_encoder(place, lead_mm);
        let single = Single { s_rpm, direction, from, to, k_mm: lead_mm, start_deg, retract_to: None };
        (self.point, self.after_thread) = (*target, true);
        self.held = Some(Held { place, single });
        Ok(())
    }

    /// Whether a call is the retract of the G33 that waits; if so, the pass has it now.
    pub(crate) fn retracts(&mut self, call: &Call<'_>) -> bool {
        let Call::StraightTraverse(to) = call else { return false };
        let (from, to) = (self.point, self.frame.machine(to));
        let stays = |coordinate: usize| (to[coordinate] - from[coordinate]).abs() < SAME;
        let only_x = (0..to.len()).all(|coordinate| stays(coordinate) != (coordinate == X))
            && within_travel(&self.machine, Axis::X, to[X], Blame::Block).is_ok();
        if only_x {
            self.release(Some(to[X]));
        }
        only_x
    }

    /// Plans the G33 that waits.
    pub(crate) fn release(&mut self, retract_to: Option<f64>) {
        let Some(Held { place, mut single }) = self.held.take() else { return };
        single.retract_to = retract_to;
        let cut = single.cut();
        match plan(&cut, &self.machine) {
            Ok(planned) => {
                let start = self.starts.number(&cut);
                self.add_pass(place.line, planned, start);
            }
            Err(why) => {
                let problem = why.problem(&[cut], &self.machine);
                return self.report(place, Problem { blame: Blame::Line(place.line), ..*problem });
            }
        }
        if retract_to.is_none() {
            let message = "the tool stays in the groove while Z brakes and marks it";
            let help = "let a G0 that moves only X follow: it is then made in step with the spindle";
            let blame = Blame::Line(place.line);
            self.report(place, *Problem::warning("no-retract", blame, message, help));
        }
    }

    /// A threading cycle: every pass of a thread, with the moves between them.
    pub(crate) fn thread_cycle(&mut self, place: Place, cycle: &ThreadCycle) -> Done {
        let cycle = self.cycle_on_machine(cycle)?;
        self.check_encoder(place, cycle.lead_mm);
        let depths = cycle.depths();
        if depths.len() > MOST_PASSES {
            let message = format!("the cycle would take more than {MOST_PASSES} passes");
            let help = "raise the depth of the first pass, or lower the degression";
            return Err(Problem::error("bad-value", Blame::Block, message, help));
        }
        let cuts: Vec<Cut> = depths.into_iter().map(|depth| cycle.cut(depth)).collect();
        let mut plans = Vec::with_capacity(cuts.len());
        for cut in &cuts {
            within_travel(&self.machine, Axis::X, cut.from.x + cut.approach_mm, Blame::Block)?;
            within_travel(&self.machine, Axis::Z, cut.from.z, Blame::Block)?;
            within_travel(&self.machine, Axis::Z, cut.to_z, Blame::Block)?;
            plans.push(plan(cut, &self.machine).map_err(|why| why.problem(&cuts, &self.machine))?);
        }
        let start = cuts.first().map_or(0, |cut| self.starts.number(cut));
        for (cut, planned) in cuts.iter().zip(plans) {
            self.line_to(place.line, &in_plane_of(&self.rest, cut.from), Feed::Rapid);
            self.add_pass(place.line, planned, start);
        }
        let end = in_plane_of(&self.rest, Point { x: cycle.from.x, z: cycle.to_z });
        if (self.rest[Z] - end[Z]).abs().max((self.rest[X] - end[X]).abs()) > ROUNDING {
            self.line_to(place.line, &end, Feed::Rapid);
        }
        (self.point, self.after_thread) = (end, false);
        Ok(())
    }

    /// The cycle in mm, machine coordinates.
    fn cycle_on_machine(&self, cycle: &ThreadCycle) -> Result<Cycle, Box<Problem>> {
        let (s_rpm, direction) = self.spindle_of_thread()?;
        let unit = self.frame.unit;
        let from = in_plane(&self.frame.machine(&cycle.from));
        let to_z = self.frame.machine(&in_plane_of(&cycle.from, Point { x: 0.0, z: cycle.end_z }))[Z];
        if (to_z - from.z).abs() < SAME {
            let help = "let Z differ from where the tool stands";
            return Err(Problem::error("bad-value", Blame::Word('Z'), "the thread has no length", help));
        }
        let lead_mm = cycle.lead * unit;
        check_lead(lead_mm, 'P')?;
        let out_of_range = |letter, value: f64, range: &str| {
            let message = format!("{letter}{} is out of range", short(value));
            Err(Problem::error("bad-value", Blame::Word(letter), message, format!("allowed: {range}")))
        };
        if cycle.infeed_deg.abs() > INFEED_DEG {
            return out_of_range('Q', cycle.infeed_deg, "-80 to 80 degrees");
        }
        if !(1.0..=DEGRESSION).contains(&cycle.degression.exponent) {
            return out_of_range('R', cycle.degression.exponent, "1 to 100");
        }
        if (cycle.chamfer_in || cycle.chamfer_out) && cycle.chamfer <= 0.0 {
            let help = "give its length with E, or leave L out";
            let message = "L asks for a taper that has no length";
            return Err(Problem::error("bad-value", Blame::Word('L'), message, help));
        }
        Ok(Cycle { s_rpm, direction, from, to_z, unit, lead_mm, words: *cycle })
    }

    /// Speed and direction of a spindle that turns at a constant speed, as threads need it, on a lathe.
    fn spindle_of_thread(&self) -> Result<(f64, f64), Box<Problem>> {
        if self.machine.machine.kinematics != Kinematics::Lathe {
            return Err(missing(
                "a thread (G33, G76) on a mill",
                "mill it with G2 or G3 and Z, or use a lathe",
            ));
        }
        if self.spindle.is_surface() {
            let what = "a thread under constant surface speed (G96), whose lead would depend on X";
            return Err(missing(what, "give the speed in 1/min with G97 S before the thread"));
        }
        self.spindle.turning().ok_or_else(|| {
            let message = "a thread needs a turning spindle";
            let help = "start it in a block before or in this one, as in S400 M3";
            Problem::error("spindle-not-turning", Blame::Block, message, help)
        })
    }

    /// Warns of a spindle encoder that is too coarse for a lead.
    fn check_encoder(&mut self, place: Place, lead_mm: f64) {
        let Some(axis) = self.machine.axis.get(&Axis::Z) else { return };
        let (count_mm, allowed_mm) = (lead_mm / self.machine.spindle_counts(), axis.thread_error_mm);
        if COUNTS_IN_THREAD_ERROR * count_mm <= allowed_mm * (1.0 + ROUNDING) {
            return;
        }
        let lines = (COUNTS_IN_THREAD_ERROR / 4.0 * lead_mm / allowed_mm * (1.0 - ROUNDING)).ceil();
        let message = format!(
            "one count of the spindle encoder is {} mm of this lead, and axis.z.thread_error_mm is {}",
            short(count_mm),
            short(allowed_mm)
        );
        let help = format!("the thread may end in thread-error: take an encoder of {lines} lines or more");
        self.report(place, *Problem::warning("coarse-encoder", Blame::Line(place.line), message, help));
    }

    fn add_pass(&mut self, line: u32, planned: Plan, start: u32) {
        self.passes += 1;
        let mut pass = ThreadPass { pass: self.passes, start, ..planned.pass };
        let here = self.positions(&self.rest);
        for (axis, _) in self.machine.axes().filter(|(axis, _)| !matches!(axis, Axis::X | Axis::Z)) {
            let at = here[axis.index()];
            pass.axes[axis.index()] = AxisLaw { start: at, end: at, ..AxisLaw::default() };
        }
        let (x, z) = (pass.axis(Axis::X), pass.axis(Axis::Z));
        self.rest = in_plane_of(&self.rest, Point { x: x.end.mm(), z: z.end.mm() });
        self.notes.push(PassNote {
            pass: pass.pass,
            line,
            depth_mm: pass.depth_mm,
            start_z_mm: z.start.mm(),
            full_depth_z_mm: planned.full_depth_z_mm,
            delta_z_mm: planned.delta_z_mm,
            max_override_pct: 100.0 * pass.max_ratio,
            packet_bytes: size_of::<ThreadPass>(),
        });
        self.push(line, Code::Pass(pass));
    }
}

/// X and Z of a point.
fn in_plane(point: &gcode::Position) -> Point {
    Point { x: point[X], z: point[Z] }
}

/// A point with other X and Z.
fn in_plane_of(point: &gcode::Position, Point { x, z }: Point) -> gcode::Position {
    let mut moved = *point;
    (moved[X], moved[Z]) = (x, z);
    moved
}

fn check_lead(mm: f64, letter: char) -> Done {
    let [low, high] = LEADS;
    if (low..=high).contains(&mm) {
        return Ok(());
    }
    let message = format!("{} mm is no lead", short(mm));
    let help =
        format!("a lead lies between {low} and {high} mm; its sign comes from the direction of the move");
    Err(Problem::error("bad-value", Blame::Word(letter), message, help))
}
