//! G68: the coordinate system turns about a point of the XY plane. G69: it is straight again.
//!
//! ```text
//! point of the machine = c + R(p − c) + s + G5x = R(p + s) + G5x'        p: programmed point, c: centre
//! G5x' = G5x + (1 − R)(c + s)                                            s: shift of G52 and G92
//! ```

use super::super::execution::Execution;
use super::compensation_off;
use crate::canon::{Call, Plane, Pose, X, Y};
use crate::codes::G;
use crate::execute::Done;
use crate::options::DecimalPoint;
use crate::problem::{Blame, Problem};
use crate::state::turn;

/// G68 X Y R.
///
/// # Errors
/// There is no R, or another plane is in force.
pub(super) fn begin(run: &mut Execution) -> Done {
    let blame = Blame::G(G(680));
    compensation_off(blame, "turn the coordinate system", run)?;
    if run.state.modes.plane != Plane::Xy || run.line.has('Z') {
        let message = "G68 turns the XY plane alone";
        return Err(Problem::error("not-available", blame, message, "select G17, and give X, Y and R"));
    }
    let before = if run.modal.straight.is_some() { run.state.axes.rotation() } else { 0.0 };
    end(run)?;
    let Some(angle) = run.line.plain('R') else {
        let message = "G68 needs R, the angle";
        return Err(Problem::error("missing-word", blame, message, "add R, degrees, such as R30."));
    };
    let increments = run.line.is_bare('R') && run.line.decimal_point != Some(DecimalPoint::PocketCalculator);
    let angle = if increments { angle / 1000.0 } else { angle };
    let incremental = run.state.modes.incremental;
    let angle = if incremental { before + angle } else { angle };
    let straight = run.state.axes.g5x();
    let (mut center, shift) = (run.state.axes.position, run.state.axes.g92());
    for (axis, letter) in [(X, 'X'), (Y, 'Y')] {
        if let Some(word) = run.line.length(letter) {
            center[axis] = if incremental { center[axis] + word } else { word };
        }
    }
    let arm: Pose = std::array::from_fn(|axis| center[axis] + shift[axis]);
    let mut turned = arm;
    turn(&mut turned, angle);
    let offset: Pose = std::array::from_fn(|axis| straight[axis] + arm[axis] - turned[axis]);
    run.modal.straight = Some(straight);
    enter(offset, angle, run)
}

/// G69.
///
/// # Errors
/// The radius of the tool is being compensated.
pub(super) fn end(run: &mut Execution) -> Done {
    let Some(straight) = run.modal.straight else { return Ok(()) };
    compensation_off(Blame::G(G(690)), "turn the coordinate system back", run)?;
    run.modal.straight = None;
    enter(straight, 0.0, run)
}

fn enter(offset: Pose, rotation: f64, run: &mut Execution) -> Done {
    let system = run.state.axes.system();
    run.state.axes.enter(system, offset, rotation);
    run.out.call(Call::SetG5xOffset(system, offset))?;
    run.out.call(Call::SetXyRotation(rotation))
}

/// Coordinates do not change while they are turned.
///
/// # Errors
/// G68 is on.
pub(super) fn refuse_inside(code: G, run: &Execution) -> Done {
    if run.modal.straight.is_none() || matches!(code.0, 280 | 300 | 530) {
        return Ok(());
    }
    let message = format!("{code} while G68 is on: the coordinates are turned");
    Err(Problem::error("not-available", Blame::G(code), message, "end the rotation with G69 first"))
}
