//! G54 to G59.3, G10 L2 L20, G28 G30 and their .1, G52, G92 to G92.3. The parameters #5161 to #5390 hold what
//! they set, in machine units.
//!
//! ```text
//! point of the machine = R(point + G92) + G5x + tool        R: rotation about Z
//! ```
//! Whatever changes one of the offsets keeps the point of the machine.

use super::{Done, Output, check};
use crate::block::Block;
use crate::canon::{Call, Pose};
use crate::codes::G;
use crate::problem::Blame;
use crate::state::{
    G92_APPLIED, G92_OFFSET, HOME, SYSTEM, State, offset_of_system, rotation_of_system, turn,
};

/// G54 to G59.3.
pub(super) fn system(code: G, state: &mut State, out: &mut Output) -> Done {
    check::compensation_off(Blame::G(code), "change the coordinate system", state)?;
    let system = match code.0 {
        591..=593 => code.0 - 584,
        tenths => tenths / 10 - 53,
    } as u8;
    if system == state.axes.system() {
        return out.call(Call::Note("continuing to use same coordinate system"));
    }
    state.set_parameter(SYSTEM, f64::from(system));
    enter(system, state);
    out.call(Call::SetG5xOffset(system, state.axes.g5x()))?;
    out.call(Call::SetG92Offset(state.axes.g92()))?;
    out.call(Call::SetXyRotation(state.axes.rotation()))
}

/// Puts offset and rotation of a system in force as the parameters hold them.
pub(super) fn enter(system: u8, state: &mut State) {
    let (offset, rotation) = state.origin_of(system);
    state.axes.enter(system, offset, rotation);
}

/// G10 L2 (offset as given) and L20 (so that the programmed point reads as given).
pub(super) fn set_offset(block: &Block, state: &mut State, out: &mut Output) -> Done {
    let system = match block.integer('P') {
        Some(system @ 1..=9) => system as u8,
        _ => state.axes.system(),
    };
    if system == state.axes.system() {
        check::compensation_off(Blame::G(G(100)), "change the coordinate system in force", state)?;
    }
    let first = offset_of_system(system);
    let mut origin = state.lengths_at(first);
    let words = state.modes.axes(block);
    if block.integer('L') == Some(20) {
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
    if system != state.axes.system() {
        return out.call(Call::Note("setting coordinate system origin"));
    }
    enter(system, state);
    out.call(Call::SetG5xOffset(system, state.axes.g5x()))?;
    out.call(Call::SetXyRotation(state.axes.rotation()))
}

/// The programmed point as another coordinate system would show it, with the same tool offset.
fn point_in(system: u8, state: &State) -> Pose {
    let ((origin, rotation), shift) = (state.origin_of(system), state.shift());
    let (mut point, tool) = (state.axes.machine_point(), state.axes.tool_offset());
    for (axis, value) in point.iter_mut().enumerate() {
        *value -= origin[axis] + tool[axis];
    }
    turn(&mut point, -rotation);
    for (value, shift) in point.iter_mut().zip(shift) {
        *value -= shift;
    }
    point
}

/// G28, G30: by the point of the axis words to the home position, in the axes that have words (all if none
/// has).
pub(super) fn home(code: G, block: &Block, state: &mut State, out: &mut Output) -> Done {
    check::compensation_off(Blame::G(code), "go home", state)?;
    let words = state.modes.axes(block);
    for (value, word) in state.axes.position.iter_mut().zip(words) {
        match word {
            Some(word) if state.modes.incremental => *value += word,
            Some(word) => *value = word,
            None => {}
        }
    }
    out.call(Call::StraightTraverse(state.axes.position))?;
    state.axes.moved();
    let home = state.axes.relative(&state.lengths_at(HOME[usize::from(code == G(300))]));
    let all = !block.has_axes();
    for (axis, value) in state.axes.position.iter_mut().enumerate() {
        if all || words[axis].is_some() {
            *value = home[axis];
        }
    }
    out.call(Call::StraightTraverse(state.axes.position))
}

/// G28.1, G30.1: home is here.
pub(super) fn set_home(code: G, state: &mut State) -> Done {
    check::compensation_off(Blame::G(code), "set the home position", state)?;
    let place = state.axes.machine_point();
    state.set_lengths_at(HOME[usize::from(code == G(301))], &place);
    Ok(())
}

/// G52 (shift as given) and G92 (so that the programmed point reads as given).
pub(super) fn shift(code: G, block: &Block, state: &mut State, out: &mut Output) -> Done {
    check::compensation_off(Blame::G(code), "shift the coordinate system", state)?;
    for (axis, word) in state.modes.axes(block).into_iter().enumerate() {
        match word {
            Some(word) if code == G(520) => state.axes.shift_by(axis, word),
            Some(word) => state.axes.read_as(axis, word),
            None => {}
        }
    }
    state.set_parameter(G92_APPLIED, 1.0);
    let shift = state.axes.g92();
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
    let shift = state.shift();
    state.axes.set_shift(shift);
    out.call(Call::SetG92Offset(shift))
}
