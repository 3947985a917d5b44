//! Machine code by hand, on its way to the interpreter: a pipe that holds a block at once, so that nobody
//! waits. In: items. Out: nothing; an interpreter that is gone takes none, and its death is seen elsewhere.

use std::process::ChildStdin;

use process::shell::interpreter::give;
use protocol::Item;

/// The launcher's end of the pipe. Closing it ends what is given by hand.
pub(super) struct Gives {
    to: ChildStdin,
    given: u64,
}

impl Gives {
    /// Nothing has been given yet.
    pub(super) fn new(to: ChildStdin) -> Gives {
        Gives { to, given: 0 }
    }

    /// These items come next.
    pub(super) fn give(&mut self, items: &[Item]) {
        let _ = give(items, &mut self.given, &mut self.to);
    }
}
