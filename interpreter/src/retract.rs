//! What follows a thread: its retract, or the way out of a tool that has none. In: the move behind a G33.
//! Out: what it does with the axis that lifts the tool; a warning.

use gcode::Problem;
use gcode::canon::{X, Z};
use gcode::problem::Blame;
use machine::Machine;

use crate::reach::within_travel;
use crate::thread::{Along, Next};
use crate::threading::SAME;

/// The tool stays in the groove at the end of a G33.
pub(crate) fn no_retract(line: u32, next: Next, along: Along) -> Option<Box<Problem>> {
    let axis = along.axis();
    let message = match next {
        Next::Retract(_) => return None,
        Next::Lift(_) => format!("the tool stays in the groove while {axis} brakes and marks it"),
        Next::Stays => format!(
            "the tool stays in the groove while {axis} brakes and marks it, and nothing says where it is out of it: \
             a fault lifts it by threading.lift_mm, a hold waits for the end of the pass"
        ),
    };
    let lifts = along.lifts();
    let help = format!("let a G0 that moves only {lifts} follow: it is then made in step with the spindle");
    Some(Problem::warning("no-retract", Blame::Line(line), message, help))
}

/// What a move to `to` does behind a G33 with the axis that lifts the tool, within its travel: a rapid of it
/// alone is the retract.
pub(crate) fn next(
    from: &gcode::Pose,
    to: &gcode::Pose,
    rapid: bool,
    along: Along,
    machine: &Machine,
) -> Next {
    let lifts = if along == Along::Z { X } else { Z };
    let stays = |coordinate: usize| (to[coordinate] - from[coordinate]).abs() < SAME;
    if stays(lifts) || within_travel(machine, along.lifts(), to[lifts], Blame::Block).is_err() {
        return Next::Stays;
    }
    let alone = (0..to.len()).all(|coordinate| coordinate == lifts || stays(coordinate));
    if rapid && alone { Next::Retract(to[lifts]) } else { Next::Lift(to[lifts]) }
}
