//! Texts that are given by hand, one by one. In: the next text. Out: a control that reads it in what is in
//! force.

use super::Control;
use super::flow::Flow;
use crate::codes::G;
use crate::options::Options;
use crate::text::Files;

impl Control {
    /// Goes on with another text: what is in force stays, as from block to block. Behind M30 and M99 it
    /// begins anew, in all but what variables and offsets hold.
    pub(crate) fn goes_on(&mut self, files: Files, options: &Options) {
        self.flow = Flow::new(files, options.limits.call_depth);
        self.variables.only_main();
        self.points.goes_on();
        self.fresh = true;
        if !self.started {
            (self.modal, self.behind) = (self.modal.anew(), None);
        }
    }

    /// What moves the words of a block that has no code for them.
    pub(crate) fn motion(&self) -> G {
        self.modal.in_force(self.line.mill)
    }
}
