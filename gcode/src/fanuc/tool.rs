//! T: tool and offset. In: `T0102`, tool 1 with offset 2, or `T01102` with offset 102. Out: the change and
//! the offset in force. The turret turns without stopping the spindle.

use super::line::Line;
use crate::canon::Call;
use crate::execute::Done;
use crate::execute::Output;
use crate::files::Tool;
use crate::problem::{Blame, Problem};
use crate::state::State;

/// T, if the line has it.
///
/// # Errors
/// It is not a whole number of up to five digits, or the nose of the tool is being compensated.
pub(super) fn call(line: &Line, state: &mut State, out: &mut Output) -> Done {
    let Some(word) = line.whole('T')? else { return Ok(()) };
    let (tool, offset) = match word {
        0..=9999 => ((word / 100) as i32, (word % 100) as i32),
        // Controls with a hundred offsets or more have three digits for them.
        10_000..=99_999 => ((word / 1000) as i32, (word % 1000) as i32),
        _ => {
            let message = format!("T{word} does not name a tool and its offset");
            let help =
                "write two digits for the tool and two or three for the offset, such as T0101 or T01001";
            return Err(Problem::error("bad-value", Blame::Word('T'), message, help));
        }
    };
    if state.compensation.is_on() {
        let message = format!("T{word:04} while {} is on", state.compensation.code());
        return Err(Problem::error("compensation-on", Blame::Word('T'), message, "end it with G40 first"));
    }
    if word != 0 && word < 100 {
        let message = format!("T{word:04} names offset {word}, but no tool");
        let help = "write two digits for the tool and two for the offset, such as T0101";
        out.warn(Problem::warning("no-tool", Blame::Word('T'), message, help));
    }
    let changes = tool != 0 && tool != state.tools.number;
    if changes {
        (state.tools.selected, state.tools.number) = (Some(tool), tool);
        out.call(Call::SelectTool(tool))?;
        out.call(Call::ChangeTool(tool))?;
    }
    load(offset, state, out);
    let offset =
        if offset == 0 { [0.0; 6] } else { state.units.to_program(&state.tools.table.in_spindle.offset) };
    state.axes.set_tool_offset(offset);
    out.call(Call::UseToolLengthOffset(offset))
}

/// The entry of an offset: its lengths and its nose are those of the tool at work.
fn load(offset: i32, state: &mut State, out: &mut Output) {
    let number = state.tools.number;
    if offset == 0 {
        state.tools.table.in_spindle = Tool { number, ..Tool::default() };
        return;
    }
    let entry = state.tools.table.find(offset).cloned();
    if entry.is_none() {
        unknown(offset, state, out);
    }
    state.tools.table.in_spindle = Tool { index: 0, number, ..entry.unwrap_or_default() };
}

/// An offset that nobody has said: of a program without a tool table once.
fn unknown(offset: i32, state: &mut State, out: &mut Output) {
    let (message, help) = match state.tools.table.is_empty() {
        true if std::mem::replace(&mut state.tools.length.told_no_table, true) => return,
        true => (
            format!(
                "nothing is known of offset {offset}: there is no tool table, and offsets are taken as 0"
            ),
            "name one with --tools FILE, or as tool_table under [machine] of the machine file",
        ),
        false => (
            format!("offset {offset} is not in the tool table"),
            "it is taken to be 0 with a sharp nose; enter it in the table as the tool of this number",
        ),
    };
    out.warn(Problem::warning("unknown-tool", Blame::Word('T'), message, help));
}
