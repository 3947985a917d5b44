//! Ctrl-C and SIGTERM: the first asks the machine to stop, the second breaks the run off.

use signal_hook::{
    consts::{SIGINT, SIGTERM},
    iterator::Signals,
};

use crate::error::CliError;

/// Signals that came so far.
pub(crate) struct Interrupts {
    signals: Signals,
    count: usize,
}

impl Interrupts {
    /// Catches them from here on.
    pub(crate) fn catch() -> Result<Interrupts, CliError> {
        let signals =
            Signals::new([SIGINT, SIGTERM]).map_err(|error| CliError::Machine(error.to_string()))?;
        Ok(Interrupts { signals, count: 0 })
    }

    /// Whether some came since the last time.
    pub(crate) fn came(&mut self) -> bool {
        let new = self.signals.pending().count();
        self.count += new;
        new > 0
    }

    /// How many came.
    pub(crate) fn count(&self) -> usize {
        self.count
    }
}
