//! Blocks that are given by hand. In: where the axes rest, which others may have moved. Out: where the
//! program is then; the items of a block, to its end.

use gcode::Pose;
use protocol::{ByHand, Code, PerAxis, Position};

use super::Translator;
use crate::thread::Next;

impl Translator {
    /// The axes rest here: the programmed point, in units of the program.
    pub(crate) fn rests_at(&mut self, at: &PerAxis<Position>) -> Pose {
        self.points.axes_rest_at(at);
        self.points.program_follows_axes();
        self.modal.frame.programmed(self.points.programmed())
    }

    /// A block by hand is over: nothing of it waits for what follows.
    pub(crate) fn ends_by_hand(&mut self) {
        self.release(Next::Stays);
        let line = self.place().line;
        self.push(line, Code::ByHand(ByHand::Waits));
    }

    /// The offset of the tool that is in force, mm.
    pub(crate) fn tool_offset(&self) -> PerAxis<Position> {
        self.points.axes(&self.modal.frame.tool)
    }

    /// X and Z of the machine where those of the program are 0 now, mm.
    pub(crate) fn zero(&self) -> PerAxis<Position> {
        self.points.axes(&self.modal.frame.machine(&[0.0; 6]))
    }
}
