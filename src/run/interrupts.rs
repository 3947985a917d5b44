//! Signals that ask for the end of a run. Ctrl-C, SIGTERM, and SIGHUP (the terminal was closed) ask the
//! machine to stop. Only Ctrl-C can ask for more: one that comes when the machine stops already is an
//! emergency stop, the next ends the processes. The others ask for the end of the whole command, if it would
//! go on behind the run.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

use signal_hook::{
    consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ},
    flag::{register, register_conditional_default},
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
    wish: Wish,
    ends: bool,
    over: Arc<AtomicBool>,
    asked: Arc<AtomicBool>,
}

impl Drop for Interrupts {
    fn drop(&mut self) {
        self.let_go();
    }
}

impl Interrupts {
    /// Catches them from here on.
    pub(crate) fn catch() -> Result<Interrupts, CliError> {
        let refused = |error: std::io::Error| CliError::Machine(error.to_string());
        let (over, asked) = (Arc::<AtomicBool>::default(), Arc::<AtomicBool>::default());
        for signal in [SIGINT, SIGTERM, SIGHUP] {
            register_conditional_default(signal, Arc::clone(&over)).map_err(refused)?;
            register(signal, Arc::clone(&asked)).map_err(refused)?;
        }
        // A file that may not become longer is an error of whoever writes it, and not the end of the
        // launcher.
        register(SIGXFSZ, Arc::default()).map_err(refused)?;
        let signals = Signals::new([SIGINT, SIGTERM, SIGHUP]).map_err(refused)?;
        Ok(Interrupts { signals, wish: Wish::None, ends: false, over, asked })
    }

    /// Whether anything has been asked for.
    pub(crate) fn is_wished(&mut self) -> bool {
        self.wish() != Wish::None
    }

    /// The run is over: signals do what they do to any program, and nothing that is still to be written or
    /// printed holds that up.
    pub(crate) fn let_go(&self) {
        self.over.store(true, Ordering::Relaxed);
    }

    /// Another run may begin: what was asked for in the one before is over.
    pub(crate) fn forget(&mut self) {
        self.over.store(false, Ordering::Relaxed);
        self.wish = Wish::None;
        self.asked.store(false, Ordering::Relaxed);
    }

    /// Whether the command is to end, and not only its run.
    pub(crate) fn ends(&mut self) -> bool {
        self.wish();
        self.ends
    }

    /// Set as soon as anything is asked for, for whoever waits for something else.
    pub(crate) fn asked(&self) -> &Arc<AtomicBool> {
        &self.asked
    }

    /// All that has been asked for so far, in one word.
    pub(crate) fn wish(&mut self) -> Wish {
        let (mut pressed, mut told) = (false, false);
        for signal in self.signals.pending() {
            pressed |= signal == SIGINT;
            told |= signal != SIGINT;
        }
        // Of those that came at the same time Ctrl-C counts as the first: the others never ask for more.
        if pressed {
            self.wish = self.wish.more();
        }
        self.ends |= told;
        if told {
            self.wish = self.wish.max(Wish::Stop);
        }
        self.wish
    }
}

/// What the operator is told of each wish.
const WORDS: [(Wish, &str); 3] = [
    (Wish::Stop, "stopping; Ctrl-C again is an emergency stop"),
    (Wish::EmergencyStop, "emergency stop; Ctrl-C again ends the processes as they are"),
    (Wish::End, "the processes are ended as they are"),
];

impl Wish {
    /// What the operator is told, if this is what is asked for after `before`.
    pub(crate) fn words(self, before: Wish) -> impl Iterator<Item = &'static str> {
        WORDS.into_iter().filter(move |(wish, _)| before < *wish && *wish <= self).map(|(_, words)| words)
    }

    /// What one more Ctrl-C asks for.
    fn more(self) -> Wish {
        match self {
            Wish::None => Wish::Stop,
            Wish::Stop => Wish::EmergencyStop,
            Wish::EmergencyStop | Wish::End => Wish::End,
        }
    }
}
