//! Machine code that is given by hand while a run goes on. In: its items, before they are executed. Out: an
//! observer that expects their passes.

use protocol::Item;

use super::{Message, Observer, planned::planned, workshop};

impl Observer {
    /// More of the program: what is given by hand, before it is executed, and what that tells its operator.
    pub fn gives(&mut self, items: &[Item], messages: Vec<Message>) {
        self.program.extend(planned(&self.machine, items, &mut self.tool));
        self.out.tools.extend(workshop::tools(&self.machine, items));
        self.messages.gives(messages);
    }
}
