//! Signals that ask for the end of a run. Ctrl-C, SIGTERM, and SIGHUP (the terminal was closed) ask the
//! machine to stop. Only Ctrl-C can ask for more: the second is an emergency stop, the third ends the
//! processes.

use signal_hook::{
    consts::{SIGHUP, SIGINT, SIGTERM},
    iterator::Signals,
};

use crate::error::CliError;

/// What was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Wish {
    /// Nothing.
    None,
    /// The machine is to stop.
    Stop,
    /// Emergency stop.
    EmergencyStop,
    /// The processes are to be ended as they are.
    End,
}

/// Signals that came so far.
pub(crate) struct Interrupts {
    signals: Signals,
    told: bool,
    presses: usize,
}

impl Interrupts {
    /// Catches them from here on.
    pub(crate) fn catch() -> Result<Interrupts, CliError> {
        let signals =
            Signals::new([SIGINT, SIGTERM, SIGHUP]).map_err(|error| CliError::Machine(error.to_string()))?;
        Ok(Interrupts { signals, told: false, presses: 0 })
    }

    /// All that has been asked for so far, in one word.
    pub(crate) fn wish(&mut self) -> Wish {
        for signal in self.signals.pending() {
            match signal {
                SIGINT => self.presses += 1,
                _ => self.told = true,
            }
        }
        match self.presses + usize::from(self.told) {
            0 => Wish::None,
            1 => Wish::Stop,
            2 => Wish::EmergencyStop,
            _ => Wish::End,
        }
    }
}
