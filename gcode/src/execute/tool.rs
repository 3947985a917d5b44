//! T, M6, M61; G43 G43.1 G43.2 G49; G10 L1 L10 L11.

use super::{Done, Output, check};
use crate::block::Block;
use crate::canon::{Call, Pose, X, Y, Z};
use crate::codes::{G, M, group};
use crate::files::Tool;
use crate::problem::{Blame, Problem, short};
use crate::state::{State, turn};

/// T.
pub(super) fn select(block: &Block, state: &mut State, out: &mut Output) -> Done {
    if !block.has('T') {
        return Ok(());
    }
    let number = tool_number(block, 'T')?;
    if number != 0 && !state.tools.table.is_empty() && state.tools.table.find(number).is_none() {
        return Err(unknown(number, 'T', false));
    }
    state.tools.selected = Some(number);
    out.call(Call::SelectTool(number))
}

/// M6 and M61 Q.
pub(super) fn change(code: M, block: &Block, state: &mut State, out: &mut Output) -> Done {
    if code == M(61) {
        return change_number(block, state, out);
    }
    check::compensation_off(Blame::M(code), "change the tool", state)?;
    let number = state.tools.selected.unwrap_or_else(|| {
        let message = "M6 without T in this block or an earlier one: the spindle is left empty";
        out.warn(Problem::warning("no-tool", Blame::M(code), message, "name the tool, such as T1 M6"));
        0
    });
    state.spindle.turning = None;
    out.call(Call::StopSpindle)?;
    load(number, state);
    out.call(Call::ChangeTool(number))
}

fn change_number(block: &Block, state: &mut State, out: &mut Output) -> Done {
    if !block.has('Q') {
        let message = "M61 needs Q, the number of the tool that is in the spindle";
        return Err(Problem::error("missing-word", Blame::M(M(61)), message, "add Q"));
    }
    let number = tool_number(block, 'Q')?;
    if number != 0 {
        entry(number, 'Q', state)?;
    }
    load(number, state);
    out.call(Call::ChangeToolNumber(number))
}

/// After a block with a tool change, LinuxCNC's stand-alone driver says where the tool stands. It does not
/// follow offsets of tools.
pub(super) fn after_change(state: &mut State) {
    if state.settings.stand_alone {
        state.axes.back_to_last_move();
    }
}

/// Puts a copy of the tool into the spindle.
fn load(number: i32, state: &mut State) {
    if number != state.tools.number {
        state.tools.length.changed(number);
    }
    state.tools.number = number;
    let bare = || Tool { number, ..Tool::default() };
    let tool = state.tools.table.find(number).cloned().unwrap_or_else(bare);
    state.tools.table.in_spindle = Tool { index: 0, ..tool };
}

fn tool_number(block: &Block, letter: char) -> Result<i32, Box<Problem>> {
    match block.integer(letter) {
        Some(number) if (0..1_000_000_000).contains(&number) => Ok(number as i32),
        _ => {
            let message =
                format!("{letter}{} cannot be the number of a tool", short(block.get(letter).unwrap_or(0.0)));
            Err(Problem::error(
                "bad-value",
                Blame::Word(letter),
                message,
                "give a whole number, 0 or greater",
            ))
        }
    }
}

/// A tool that must be in the table; 0 is the one in the spindle.
fn entry(number: i32, letter: char, state: &State) -> Result<&Tool, Box<Problem>> {
    let number = if number == 0 { state.tools.number } else { number };
    if number == 0 {
        return Ok(&state.tools.table.in_spindle);
    }
    state.tools.table.find(number).ok_or_else(|| unknown(number, letter, state.tools.table.is_empty()))
}

fn unknown(number: i32, letter: char, no_table: bool) -> Box<Problem> {
    let (message, help) = match no_table {
        true => (
            format!("nothing is known of tool {number}: there is no tool table"),
            "name one with --tools FILE, or as tool_table under [machine] of the machine file",
        ),
        false => (
            format!("tool {number} is not in the tool table"),
            "enter it in the tool table (--tools FILE), or name another tool",
        ),
    };
    Problem::error("unknown-tool", Blame::Word(letter), message, help)
}

/// G43 H, G43.1 (axis words), G43.2 H or axis words, G49.
pub(super) fn offset(code: G, block: &Block, state: &mut State, out: &mut Output) -> Done {
    check::compensation_off(Blame::G(code), "change the tool offset", state)?;
    let words = state.modes.axes(block);
    let mut offset = state.axes.tool_offset();
    match code.0 {
        430 => {
            let number = if block.has('H') { tool_number(block, 'H')? } else { 0 };
            offset = state.units.to_program(&entry(number, 'H', state)?.offset);
            other_length(number, Blame::Word('H'), state, out);
        }
        431 => {
            for (value, word) in offset.iter_mut().zip(words) {
                *value = word.unwrap_or(*value);
            }
        }
        432 => {
            let added = match block.has('H') {
                true => state.units.to_program(&entry(tool_number(block, 'H')?, 'H', state)?.offset),
                false => words.map(|word| word.unwrap_or(0.0)),
            };
            for (value, added) in offset.iter_mut().zip(added) {
                *value += added;
            }
        }
        _ => offset = [0.0; 6],
    }
    state.tools.length.asked(code != G(490));
    state.axes.set_tool_offset(offset);
    out.call(Call::UseToolLengthOffset(offset))
}

/// A mill is warned where H is the length of another tool than that in the spindle.
pub(crate) fn other_length(h: i32, blame: Blame, state: &mut State, out: &mut Output) {
    let tool = state.tools.number;
    if state.settings.is_mill
        && let Some(warning) = state.tools.length.of(h, tool, blame)
    {
        out.warn(warning);
    }
}

/// A mill is warned where a tool moves along Z with a length that nobody asked for since it was put in.
pub(super) fn moves(block: &Block, state: &mut State, out: &mut Output) {
    if !state.settings.is_mill || !block.has('Z') || block.g(group::ONCE) == Some(G(530)) {
        return;
    }
    let has_length = state.tools.table.in_spindle.offset[Z] != 0.0;
    if let Some(warning) = state.tools.length.moves(state.tools.number, has_length) {
        out.warn(warning);
    }
}

/// G10 L1 (offsets as given), L10 (so that the tool is at the given place of the system in force), L11 (of
/// G59.3).
pub(super) fn set_entry(block: &Block, state: &mut State, out: &mut Output) -> Done {
    let number = tool_number(block, 'P')?;
    let words = state.modes.axes(block);
    let direct = block.integer('L') == Some(1);
    let to_fixture = block.integer('L') == Some(11);
    let mut tool = state.tools.table.find(number).cloned().ok_or_else(|| unknown(number, 'P', false))?;
    let mut offset = state.units.to_program(&tool.offset);
    if direct {
        for (value, word) in offset.iter_mut().zip(words) {
            *value = word.unwrap_or(*value);
        }
    } else {
        measure(&mut offset, &words, to_fixture, state);
    }
    tool.offset = state.units.to_machine(&offset);
    if let Some(radius) = block.get('R') {
        tool.diameter = 2.0 * radius / state.units.per_machine_unit();
    }
    tool.front_angle = block.get('I').unwrap_or(tool.front_angle);
    tool.back_angle = block.get('J').unwrap_or(tool.back_angle);
    if let Some(orientation) = block.integer('Q') {
        tool.orientation = orientation as u8;
    }
    out.call(Call::SetToolTableEntry(&tool))?;
    if state.settings.stand_alone && state.tools.number == 0 && tool.index == 1 {
        out.call(Call::SetToolTableEntry(&Tool { index: 0, ..tool.clone() }))?;
    }
    state.tools.table.set(tool);
    if state.tools.number == number {
        load(number, state);
        out.call(Call::SetToolTableEntry(&state.tools.table.in_spindle))?;
    }
    Ok(())
}

/// The offset with which the place of the machine reads the given values.
fn measure(offset: &mut Pose, words: &[Option<f64>; 6], to_fixture: bool, state: &State) {
    let system = if to_fixture { 9 } else { state.axes.system() };
    let (origin, rotation) = state.origin_of(system);
    let mut place = state.axes.machine_point();
    for (value, origin) in place.iter_mut().zip(origin) {
        *value -= origin;
    }
    turn(&mut place, -rotation);
    if !to_fixture {
        for (value, shift) in place.iter_mut().zip(state.shift()) {
            *value -= shift;
        }
    }
    let turned = words[X].is_some() || words[Y].is_some();
    if turned {
        turn(offset, -rotation);
    }
    for (axis, word) in words.iter().enumerate() {
        if let Some(word) = word {
            offset[axis] = place[axis] - word;
        }
    }
    if turned {
        turn(offset, rotation);
    }
}
