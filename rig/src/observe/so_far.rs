//! What is known of a run while it goes on.

use super::{FaultReport, MessageReport, Observer, PassReport, StockReport};

impl Observer {
    /// The trace hash of the cycles so far, hexadecimal.
    pub fn trace_hash(&self) -> String {
        let mut hash = self.hash.clone();
        hash.update(&self.batch);
        hash.finalize().to_hex().to_string()
    }

    /// The passes that are over.
    pub fn passes(&self) -> &[PassReport] {
        &self.out.passes
    }

    /// The pass in hand, as far as it has come; nothing before its law moves an axis.
    pub fn pass_so_far(&self) -> Option<PassReport> {
        self.current.as_ref()?.finish()
    }

    /// The faults that were seen.
    pub fn faults(&self) -> &[FaultReport] {
        &self.out.faults
    }

    /// The stock, if it is known.
    pub fn stock(&self) -> Option<&StockReport> {
        self.out.stock.as_ref()
    }

    /// What the program has told so far.
    pub fn told(&self) -> &[MessageReport] {
        &self.messages.told
    }
}
