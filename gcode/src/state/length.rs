//! Whose length is in force, and what was said of it. In: tool changes, G43 and its like, moves along Z of a
//! mill. Out: a warning where a tool works with the length of another one, or with none that the program has
//! asked for since the change; each once.

use crate::problem::{Blame, Problem};

/// What is known of the length of the tool in the spindle.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Length {
    /// Tools that were put in so far.
    changes: u32,
    /// The tool was put in, and no length was asked for since.
    is_old: bool,
    /// The program has asked for a length.
    is_used: bool,
    told_other: bool,
    told_none: bool,
    /// It was said that there is no tool table.
    pub(crate) told_no_table: bool,
}

impl Length {
    /// Another tool is in the spindle; 0 is none.
    pub(crate) fn changed(&mut self, number: i32) {
        self.is_old = number != 0;
        self.changes += u32::from(number != 0);
    }

    /// The program says which length is in force: G43 or G44 one of a tool, G49 none.
    pub(crate) fn asked(&mut self, of_a_tool: bool) {
        (self.is_old, self.is_used) = (false, self.is_used || of_a_tool);
    }

    /// G43 H: the length of a tool, while another one is in the spindle.
    pub(crate) fn of(&mut self, h: i32, tool: i32, blame: Blame) -> Option<Box<Problem>> {
        let is_other = h != 0 && tool != 0 && h != tool && !self.told_other;
        self.told_other |= is_other;
        is_other.then(|| {
            let message = format!("the length is that of tool {h} (H{h}), and tool {tool} is in the spindle");
            Problem::warning("other-length", blame, message, format!("write H{tool}, or put in tool {h}"))
        })
    }

    /// A move along Z. `has_length`: the tool table has a length of the tool in the spindle.
    pub(crate) fn moves(&mut self, tool: i32, has_length: bool) -> Option<Box<Problem>> {
        let is_meant = self.is_used || has_length || self.changes > 1;
        let is_missing = self.is_old && is_meant && !self.told_none;
        self.told_none |= is_missing;
        is_missing.then(|| {
            let message =
                format!("tool {tool} moves along Z, and no length was put in force since it was put in");
            let help = format!("write G43 H{tool} between M6 and this move; G49 says that none is meant");
            Problem::warning("no-length", Blame::Word('Z'), message, help)
        })
    }
}
