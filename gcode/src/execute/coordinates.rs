//! G54 to G59.3, G10 L2 L20, G28 G30 and their .1, G52, G92 to G92.3. The parameters #5161 to #5390 hold what they
//! set, in machine units.
//!
//! ```text
//! point of the machine = R(point + G92) + G5x + tool        R: rotation about Z
//! ```
//! Whatever changes one of the offsets keeps the point of the machine.

use crate::block::Block;
use crate::canon::Call;
use crate::codes::G;
use crate::problem::Blame;
use crate::state::{
    G92_APPLIED, G92_OFFSET, HOME, SYSTEM, State, offset_of_system, rotation_of_system, turn,
};

use super::{Done, Output, check, integer};

/// G54 to G59.3.
pub(super) fn system(code: G, state: &mut State, out: &mut Output) -> Done {
    check::compensation_off(Blame::G(code), "change the coordinate system", state)?;
    let system = match code.0 {
        591..=593 => code.0 - 584,
        tenths => tenths / 10 - 53,
    } as u8;
    if system == state.system {
        return out.call(Call::Note("continuing to use same coordinate system"));
    }
    state.set_parameter(SYSTEM, f64::from(system));
    enter(system, state);
    out.call(Call::SetG5xOffset(system, state.g5x))?;
    out.call(Call::SetG92Offset(state.g92))?;
    out.call(Call::SetXyRotation(state.rotation))
}

/// Puts offset and rotation of a system in force as the parameters hold them.
pub(super) fn enter(system: u8, state: &mut State) {
    let place = state.absolute(&state.position);
    state.system = system;
    state.g5x = state.lengths_at(offset_of_system(system));
    state.rotation = state.parameter(rotation_of_system(system));
    state.position = state.relative(&place);
}

/// G10 L2 (offset as given) and L20 (so that the programmed point reads as given).
pub(super) fn set_offset(block: &Block, state: &mut State, out: &mut Output) -> Done {
    let system = match integer(block, 'P') {
        Some(system @ 1..=9) => system as u8,
        _ => state.system,
    };
    if system == state.system {
        check::compensation_off(Blame::G(G(100)), "change the coordinate system in force", state)?;
    }
    let first = offset_of_system(system);
    let mut origin = state.lengths_at(first);
    let words = state.axes(block);
    if integer(block, 'L') == Some(20) {
        let rotation = state.parameter(rotation_of_system(system));
        let mut missing = point_in(system, state);
        for (value, word) in missing.iter_mut().zip(words) {
            *value = word.map_or(0.0, |word| *value - word);
        }
        turn(&mut missing, rotation);
        for (value, missing) in origin.iter_mut().zip(missing) {
            *value += missing;
        }
    } else {
        for (value, word) in origin.iter_mut().zip(words) {
            *value = word.unwrap_or(*value);
        }
        if let Some(rotation) = block.get('R') {
            state.set_parameter(rotation_of_system(system), rotation);
        }
    }
    state.set_lengths_at(first, &origin);
    if system != state.system {
        return out.call(Call::Note("setting coordinate system origin"));
    }
    enter(system, state);
    out.call(Call::SetG5xOffset(system, state.g5x))?;
    out.call(Call::SetXyRotation(state.rotation))
}

/// The programmed point as another coordinate system would show it, with the same tool offset.
fn point_in(system: u8, state: &State) -> crate::Position {
    let origin = state.lengths_at(offset_of_system(system));
    let applied = state.parameter(G92_APPLIED) != 0.0;
    let shift = if applied { state.lengths_at(G92_OFFSET) } else { [0.0; 6] };
    let mut point = state.absolute(&state.position);
    for (axis, value) in point.iter_mut().enumerate() {
        *value -= origin[axis] + state.tool_offset[axis];
    }
    turn(&mut point, -state.parameter(rotation_of_system(system)));
    for (value, shift) in point.iter_mut().zip(shift) {
        *value -= shift;
    }
    point
}

/// G28, G30: by the point of the axis words to the home position, in the axes that have words (all if none has).
pub(super) fn home(code: G, block: &Block, state: &mut State, out: &mut Output) -> Done {
    check::compensation_off(Blame::G(code), "go home", state)?;
    let words = state.axes(block);
    for (value, word) in state.position.iter_mut().zip(words) {
        match word {
            Some(word) if state.incremental => *value += word,
            Some(word) => *value = word,
            None => {}
        }
    }
    out.call(Call::StraightTraverse(state.position))?;
    state.unseen = [0.0; 6];
    let home = state.relative(&state.lengths_at(HOME[usize::from(code == G(300))]));
    let all = !block.has_axes();
    for (axis, value) in state.position.iter_mut().enumerate() {
        if all || words[axis].is_some() {
            *value = home[axis];
        }
    }
    out.call(Call::StraightTraverse(state.position))
}

/// G28.1, G30.1: home is here.
pub(super) fn set_home(code: G, state: &mut State) -> Done {
    check::compensation_off(Blame::G(code), "set the home position", state)?;
    let place = state.absolute(&state.position);
    state.set_lengths_at(HOME[usize::from(code == G(301))], &place);
    Ok(())
}

/// G52 (shift as given) and G92 (so that the programmed point reads as given).
pub(super) fn shift(code: G, block: &Block, state: &mut State, out: &mut Output) -> Done {
    check::compensation_off(Blame::G(code), "shift the coordinate system", state)?;
    for (axis, word) in state.axes(block).into_iter().enumerate() {
        let Some(word) = word else { continue };
        let sum = state.position[axis] + state.g92[axis];
        let shift = if code == G(520) { word } else { sum - word };
        (state.g92[axis], state.position[axis]) = (shift, sum - shift);
    }
    state.set_parameter(G92_APPLIED, 1.0);
    let shift = state.g92;
    state.set_lengths_at(G92_OFFSET, &shift);
    out.call(Call::SetG92Offset(shift))
}

/// G92.1 forgets the shift, G92.2 suspends it, G92.3 applies it again.
pub(super) fn suspend(code: G, state: &mut State, out: &mut Output) -> Done {
    check::compensation_off(Blame::G(code), "shift the coordinate system", state)?;
    let applied = code == G(923);
    if code == G(921) {
        state.set_lengths_at(G92_OFFSET, &[0.0; 6]);
    }
    state.set_parameter(G92_APPLIED, f64::from(applied));
    let shift = if applied { state.lengths_at(G92_OFFSET) } else { [0.0; 6] };
    for (axis, shift) in shift.iter().enumerate() {
        state.position[axis] += state.g92[axis] - shift;
    }
    state.g92 = shift;
    out.call(Call::SetG92Offset(shift))
}
