//! Where moves stop: G61 at the end of every move, G64 nowhere, G09 at the end of the move of its block.
//!
//! In: a line. Out: calls of the path mode. They take their turn where compensation keeps moves back.

use super::codes::{Deed, EXACT_STOP};
use super::execution::Execution;
use super::line::Line;
use crate::canon::{Call, PathMode};
use crate::codes::{G, group};
use crate::execute::Done;
use crate::execute::Output;
use crate::problem::{Blame, Problem};
use crate::state::State;

/// G61, G64.
pub(super) fn modal(line: &Line, state: &mut State, out: &mut Output) -> Done {
    let Some(code) = line.block.g(group::PATH) else { return Ok(()) };
    state.modes.path.mode = if code == G(610) { PathMode::ExactStop } else { PathMode::Continuous(0.0) };
    out.call(Call::SetMotionControlMode(state.modes.path.mode))
}

/// G09, before the move.
///
/// # Errors
/// The block has no G00, G01, G02, G03.
pub(super) fn begin(line: &Line, deed: Deed, state: &State, out: &mut Output) -> Done {
    let Some(code) = line.block.g(EXACT_STOP) else { return Ok(()) };
    if matches!(deed, Deed::G(G(0 | 10 | 20 | 30))) {
        return change(PathMode::ExactStop, state, out);
    }
    let message = format!("{code} stops at the end of a move, and this block has none");
    let help = "write it into the block of a G00, G01, G02 or G03, or use G61";
    Err(Problem::error("missing-word", Blame::G(code), message, help))
}

/// G09, after the move.
///
/// # Errors
/// The end of the move is a corner that is cut off or rounded.
pub(super) fn end(run: &mut Execution) -> Done {
    let Some(code) = run.line.block.g(EXACT_STOP) else { return Ok(()) };
    if run.modal.pending.is_some() {
        let message = format!("{code} would stop at a corner that is cut off or rounded");
        let help = "leave G09 out, or write the corner as moves";
        return Err(Problem::error("not-available", Blame::G(code), message, help));
    }
    change(run.state.modes.path.mode, run.state, run.out)
}

/// Nothing under G61, where every move stops.
fn change(mode: PathMode, state: &State, out: &mut Output) -> Done {
    match state.modes.path.mode {
        PathMode::ExactStop => Ok(()),
        _ => out.call(Call::SetMotionControlMode(mode)),
    }
}
