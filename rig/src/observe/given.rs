//! Machine code that is given by hand while a run goes on. In: its items, before they are executed. Out: an
//! observer that expects their passes.

use protocol::Item;

use super::{Observer, planned::planned, workshop};

impl Observer {
    /// More of the program: what is given by hand, before it is executed.
    pub fn gives(&mut self, items: &[Item]) {
        self.program.extend(planned(&self.machine, items, &mut self.tool));
        self.out.tools.extend(workshop::tools(&self.machine, items));
    }
}
