//! G40, G41, G42, G41.1, G42.1: a contour is programmed, and the centre of the tool moves beside it.
//!
//! In: programmed moves, radius and side of the tool. Out: moves of the tool's centre (of a turning tool: of
//! the point that its offsets measure), corners included, or a refusal where the tool would cut what it must
//! not.
//!
//! | file | content |
//! |---|---|
//! | `geometry.rs` | offsets of lines and arcs, corners: pure geometry |
//! | `contour.rs` | entry, following moves, corners; what is refused |
//! | `queue.rs` | the last move, which waits for the corner after it, and the calls after that |
//!
//! [`State::position`] is the programmed point all the time. Behaviour and limits are those of LinuxCNC
//! (manual, chapter Cutter Compensation), but where LinuxCNC lets the tool cut into the contour: moves that a
//! corner uses up and a tangent move follows, arcs that touch from inside, a stop in an inside corner, an
//! entry along too short an arc are refused; and the lead to the entry arc of a turning tool is not moved
//! with the corner after that arc. A corner is seen with the move before it and the move after it, parts of
//! the contour further away are not.

mod contour;
mod queue;

use crate::block::Block;
use crate::canon::{Call, Plane};
use crate::codes::G;
use crate::geometry::track::Side;
use crate::problem::{Blame, Problem, short};
use crate::state::{Compensation, Cutter, State};
pub(crate) use contour::{arc, straight};
pub(crate) use queue::Waiting;

use super::{Done, Output};

/// G40 to G42.1.
///
/// # Errors
/// G41 or G42 while it is on, in the YZ plane, or with a tool that does not exist or does not suit the plane.
pub(crate) fn switch(code: G, block: &Block, state: &mut State, out: &mut Output) -> Done {
    if code == G(400) {
        return switch_off(state, out);
    }
    if state.compensation.is_on() {
        let message = format!("{code} begins what {} has begun already", state.compensation.code());
        return Err(Problem::error("compensation-on", Blame::G(code), message, "end it with G40 first"));
    }
    if state.modes.plane == Plane::Yz {
        let message = "the radius of the tool can be compensated in the XY and the XZ plane only";
        return Err(Problem::error("compensation-plane", Blame::G(code), message, "select G17 or G18 first"));
    }
    let left = matches!(code.0, 410 | 411);
    let dynamic = code.0 % 10 == 1;
    let (radius, orientation) =
        if dynamic { from_block(code, block, state)? } else { from_table(code, block, state)? };
    let side = if left == (radius >= 0.0) { Side::Left } else { Side::Right };
    out.call(Call::Note(match side {
        Side::Left => "cutter radius compensation on left",
        Side::Right => "cutter radius compensation on right",
    }))?;
    if radius == 0.0 {
        out.warn(nothing(code, block, state, dynamic));
    }
    let cutter = Cutter { side, radius: radius.abs(), orientation };
    (state.compensation.tool, state.compensation.normal) = (Some(cutter), None);
    Ok(())
}

/// Nothing is compensated: the contour is cut as if the tool were a point.
fn nothing(code: G, block: &Block, state: &State, dynamic: bool) -> Box<Problem> {
    let table = &state.tools.table;
    let message = format!("{code} compensates a radius of 0: the tool cuts as if it were a point");
    let help = match (dynamic, table.is_empty()) {
        (true, _) => "D is the diameter of the tool",
        (false, true) => "there is no tool table: name one with --tools, with the radius of the tool",
        (false, false) => "enter the radius of the tool into the tool table, or leave the code out",
    };
    let blame = if block.get('D').is_some() { Blame::Word('D') } else { Blame::G(code) };
    Problem::warning("no-radius", blame, message, help)
}

fn switch_off(state: &mut State, out: &mut Output) -> Done {
    out.call(Call::Note("cutter radius compensation off"))?;
    flush(state, out)?;
    let Compensation { normal, leaving, .. } = state.compensation;
    state.compensation = Compensation { leaving: leaving || normal.is_some(), ..Compensation::default() };
    Ok(())
}

/// G41.1, G42.1: D is the diameter, L the orientation.
fn from_block(code: G, block: &Block, state: &State) -> Result<(f64, u8), Box<Problem>> {
    let Some(diameter) = block.get('D') else {
        let message = format!("{code} needs D, the diameter of the tool");
        let help = format!("add D, or take the tool of the table with G{}", code.0 / 10);
        return Err(Problem::error("missing-word", Blame::G(code), message, help));
    };
    let Some(l) = block.get('L') else { return Ok((diameter / 2.0, 0)) };
    if state.modes.plane != Plane::Xz {
        let message = "L is the orientation of a turning tool, and the plane is not XZ";
        return Err(Problem::error(
            "compensation-plane",
            Blame::Word('L'),
            message,
            "select G18, or leave L out",
        ));
    }
    match block.integer('L') {
        Some(orientation @ 0..=9) => Ok((diameter / 2.0, orientation as u8)),
        _ => {
            let message = format!("L{} is not an orientation of a turning tool", short(l));
            Err(Problem::error("bad-value", Blame::Word('L'), message, "orientations are 0 to 9"))
        }
    }
}

/// G41, G42: the tool in the spindle, or tool D of the table.
fn from_table(code: G, block: &Block, state: &State) -> Result<(f64, u8), Box<Problem>> {
    let tool = match (block.get('D'), block.integer('D')) {
        (None, _) | (_, Some(0)) => &state.tools.table.in_spindle,
        (Some(d), number) => {
            let number = number.and_then(|number| i32::try_from(number).ok());
            number.and_then(|number| state.tools.table.find(number)).ok_or_else(|| {
                let message = format!("D{} is not a tool of the tool table", short(d));
                let help = "D is the number of a tool; without D the tool in the spindle counts";
                Problem::error("unknown-tool", Blame::Word('D'), message, help)
            })?
        }
    };
    if state.modes.plane != Plane::Xz && !matches!(tool.orientation, 0 | 9) {
        let message = format!("T{} is a turning tool, and the plane is not XZ", tool.number);
        return Err(Problem::error("compensation-plane", Blame::G(code), message, "select G18 first"));
    }
    Ok((tool.diameter * state.units.per_machine_unit() / 2.0, tool.orientation))
}

/// Sends all that waits: the contour is held up here, or at its end.
pub(crate) fn flush(_state: &State, out: &mut Output) -> Done {
    out.release()
}

/// G20, G21: lengths in other units.
pub(crate) fn scale(factor: f64, state: &mut State, out: &mut Output) {
    if let Some(cutter) = &mut state.compensation.tool {
        cutter.radius *= factor;
    }
    out.waiting.scale(factor, !state.settings.stand_alone);
}

/// Refuses an arc right after G40.
pub(crate) fn arc_allowed(block: &Block, state: &State) -> Done {
    if !state.compensation.leaving {
        return Ok(());
    }
    let blame = block.g(crate::codes::group::MOTION).map_or(Blame::Block, Blame::G);
    let message = "the first move after G40 must be straight: the tool is not yet on the programmed path";
    Err(Problem::error("compensation-exit", blame, message, "leave the contour with G0 or G1"))
}
