//! Why a cut has no law, and what would give it one. In: a refusal and its cut. Out: a problem that names the
//! highest spindle speed that would do, and what else would help.

use gcode::Problem;
use gcode::canon::Units;
use gcode::problem::{Blame, short};
use machine::Machine;
use protocol::{Axis, Refused};

use super::chain::Broken;
use super::cut::Cut;
use super::plan::plan;

/// Why a cut cannot be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// An axis would have to be faster than it can.
    TooFast {
        /// Which.
        axis: Axis,
        /// Speed that the thread needs of it, mm/s.
        needs_mm_s: f64,
        /// Its highest speed, mm/s.
        limit_mm_s: f64,
    },
    /// Run-in and run-out leave no thread between them: their lengths and the length there is, mm.
    NoThread {
        /// Way along the axis until the tool is at depth on the helix, mm.
        run_in_mm: f64,
        /// Way along the axis from the end of full depth to the programmed end, mm.
        run_out_mm: f64,
        /// Programmed length, mm.
        length_mm: f64,
    },
    /// X cannot make the taper at the start in its length.
    EntryTaper {
        /// Length in which it could, mm.
        least_mm: f64,
    },
    /// X cannot make the taper at the end in its length.
    ExitTaper {
        /// Length in which it could, mm.
        least_mm: f64,
    },
    /// The lead cannot change between two threads of a chain in the room that they leave.
    Corner {
        /// Line of the thread that begins there.
        line: u32,
        /// It lies within the arc of that thread.
        in_arc: bool,
        /// Angle that the change takes, degrees.
        needs_deg: f64,
        /// Way along the axis in it, mm, and the way that there is.
        needs_mm: f64,
        /// See there.
        has_mm: f64,
    },
    /// An axis would leave its travel.
    Travel {
        /// Which.
        axis: Axis,
        /// Where it would be, mm.
        at_mm: f64,
    },
    /// A number of the pass is beyond what a regulator takes.
    Extreme {
        /// Which, and why.
        refused: Refused,
    },
}

/// Slowest speed the search considers, as a share of the programmed one.
const SLOWEST: f64 = 1e-3;
/// Halvings of the search at most; what is shown is mostly decided after ten.
const STEPS: u32 = 24;

/// The highest spindle speed up to the programmed one at which all cuts can be made, 1/min, rounded down.
pub(super) fn highest_speed(cuts: &[Cut], machine: &Machine) -> Option<f64> {
    let programmed = cuts.first()?.s_rpm;
    let of_one = |cut: &Cut, top| {
        highest_possible([cut.s_rpm, top], |s_rpm| plan(&Cut { s_rpm, ..*cut }, machine).is_ok())
    };
    let speed = cuts.iter().try_fold(programmed, |top, cut| of_one(cut, top))?;
    Some(shown(speed)).filter(|speed| *speed > 0.0)
}

/// The same of a tap.
pub(crate) fn highest_of_tap(programmed: f64, possible: impl Fn(f64) -> bool) -> Option<f64> {
    highest_possible([programmed; 2], possible).map(shown).filter(|speed| *speed > 0.0)
}

/// A speed as it is shown, rounded down.
fn shown(speed: f64) -> f64 {
    if speed >= 10.0 { speed.floor() } else { (speed * 100.0).floor() / 100.0 }
}

/// The highest speed up to `top` that is possible.
fn highest_possible([programmed, top]: [f64; 2], possible: impl Fn(f64) -> bool) -> Option<f64> {
    let (mut low, mut high) = (programmed * SLOWEST, top);
    if possible(high) {
        return Some(high);
    }
    if !possible(low) {
        return None;
    }
    for _ in 0..STEPS {
        if shown(low) == shown(high) {
            break;
        }
        let middle = 0.5 * (low + high);
        if possible(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(low)
}

impl Refusal {
    /// What the user is told: `self` is the refusal of one of the cuts of a block. `units`: those of the
    /// program.
    pub(crate) fn problem(self, cuts: &[Cut], units: Units, machine: &Machine) -> Box<Problem> {
        let s = short(cuts.first().map_or(0.0, |cut| cut.s_rpm));
        let speed = highest_speed(cuts, machine);
        let lower = speed.map(|rpm| format!("the highest spindle speed that would do is S{}", short(rpm)));
        let slower = lower.clone().unwrap_or_else(|| "no spindle speed would do".to_owned());
        let (code, message, help) = match self {
            Refusal::TooFast { axis, needs_mm_s, limit_mm_s } => (
                "pass-not-feasible",
                format!(
                    "at S{s} the thread needs {}/s of {axis}, which can do {}",
                    units.length(needs_mm_s),
                    short(limit_mm_s / units.mm())
                ),
                format!("{slower}; a smaller lead would help too"),
            ),
            Refusal::NoThread { run_in_mm, run_out_mm, length_mm } => (
                "pass-not-feasible",
                format!(
                    "no thread is left: at S{s} the run-in takes {} and the run-out {} of the {} from \
                     start to end",
                    units.length(run_in_mm),
                    units.length(run_out_mm),
                    units.length(length_mm)
                ),
                format!(
                    "{slower}; a start further from the part, a smaller lead, or run_out = \"beyond\" would help \
                     too"
                ),
            ),
            Refusal::EntryTaper { least_mm } | Refusal::ExitTaper { least_mm } => {
                let which = if matches!(self, Refusal::EntryTaper { .. }) { "entry" } else { "exit" };
                (
                    "pass-not-feasible",
                    format!("at S{s} X cannot make the {which} taper in its length E"),
                    format!("make E at least {}, or lower S: {slower}", short(least_mm / units.mm() + 5e-5)),
                )
            }
            Refusal::Corner { line, in_arc, needs_deg, needs_mm, has_mm } => (
                "pass-not-feasible",
                format!(
                    "at S{s} the lead changes over {} ({} degrees of the spindle) about {}, and there is room for {}",
                    units.length(needs_mm),
                    short(needs_deg),
                    corner(line, in_arc),
                    units.length(has_mm)
                ),
                format!(
                    "{slower}; longer threads before and behind the corner, or leads that differ less, would help too"
                ),
            ),
            Refusal::Travel { axis, at_mm } => {
                let name = axis.name();
                let [low, high] = machine.axis.get(&axis).map_or([0.0, 0.0], |config| config.travel_mm);
                let message = format!(
                    "the run-out would take {axis} to {} mm, outside axis.{name}.travel_mm = [{}, {}]",
                    short(at_mm),
                    short(low),
                    short(high)
                );
                let help = lower.unwrap_or_else(|| "end the thread earlier".to_owned());
                ("travel-limit", message, help)
            }
            Refusal::Extreme { refused } => (
                "pass-not-feasible",
                format!("the pass is beyond what a regulator takes: {refused}"),
                "use a lead, a speed and a length that a machine can have".to_owned(),
            ),
        };
        Problem::error(code, Blame::Block, message, help)
    }
}

/// Where a lead changes.
fn corner(line: u32, in_arc: bool) -> String {
    match in_arc {
        true => format!("a place within the thread of line {line}"),
        false => format!("the corner where the thread of line {line} begins"),
    }
}

impl Broken {
    /// What the user is told.
    pub(crate) fn problem(self, units: Units) -> Box<Problem> {
        let (message, help) = match self {
            Broken::Ends(mm) => (
                format!("the lead falls to nothing after {} of the thread", units.length(mm)),
                "let it fall less in a turn (K), begin with a greater lead (F), or end the thread before"
                    .to_owned(),
            ),
            Broken::TooMany => (
                format!("a chain of threads changes its lead at {} corners at most", motion::MOST_CHANGES),
                "join threads of one direction and lead, put a G0 between two of them, or give a table of leads less rows"
                    .to_owned(),
            ),
            Broken::TooRound(pieces) => (
                format!(
                    "a thread along this arc takes {pieces} pieces or more to be within 0.5 um of it, and a pass has {}",
                    motion::MOST_CHANGES - 1
                ),
                "cut less of the arc, or write it as a chain of short G32".to_owned(),
            ),
            Broken::Steep => (
                "a thread along an arc has its lead along Z or, on a face, along X, and this arc gets steeper than \
                 45 degrees to either, or turns back"
                    .to_owned(),
                "end it where it is at 45 degrees; and look at G35 and G36, centre and radius: clockwise is as in \
                 G02"
                    .to_owned(),
            ),
            Broken::Turns(along) => (
                format!(
                    "a chain of threads goes one way along {}, and this one does not go on so",
                    along.axis()
                ),
                "let the thread go on in the direction of the first one, or put a G0 between them".to_owned(),
            ),
        };
        Problem::error("bad-value", Blame::Block, message, help)
    }
}
