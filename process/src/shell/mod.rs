//! What the process shells have in common: their arguments, their errors, their clock.
//!
//! A shell reads its configuration, opens its ports, and then receives, ticks and sends until the last
//! measurement.

mod args;
mod forsaken;
pub mod interpolator;
pub mod interpreter;
mod ledger;
mod notes;
mod pace;
pub mod plant;
pub mod regulator;
mod spindle;
mod wait;

use std::{
    io::Write as _,
    path::{Path, PathBuf},
    time::Duration,
};

pub use args::{LanguageArgs, Named, ProcessArgs, one_of};
pub(crate) use ledger::Ledger;
pub(crate) use notes::Notes;
pub use pace::{Beat, Missed, Pace};
pub(crate) use wait::{POLL, Wait};

use machine::{Machine, MachineError};
use protocol::Payload;

use crate::ipc::{
    IpcError, Member, Patience, Process, Sender, Undelivered, is_orphan,
    real_time::{self, SetUp},
    time::{self, Moment, sleep_until},
};

/// How processes wait for each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Clock {
    /// In lock step, as fast as the computer can; every run gives the same numbers.
    #[default]
    Virtual,
    /// In real time; what comes too late is counted.
    Real,
}

/// Why a process ended early.
#[derive(Debug, thiserror::Error)]
pub enum ShellError {
    /// Another process cannot be reached.
    #[error(transparent)]
    Ipc(#[from] IpcError),
    /// A file cannot be read.
    #[error("{path}: {source}")]
    File {
        /// Which.
        path: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// The machine file is wrong.
    #[error("machine file: {0}")]
    Machine(#[from] MachineError),
    /// Something that real time needs was refused, and whoever started this wants all of it.
    #[error(
        "this computer refuses what real time needs, and nothing has moved:\n  {0}\n`--clock real` runs without it"
    )]
    NotSetUp(String),
    /// The input is wrong; the text says where and what would be right.
    #[error("{0}")]
    Input(String),
}

impl From<Undelivered> for ShellError {
    fn from(error: Undelivered) -> Self {
        ShellError::Ipc(error.into())
    }
}

/// How often a recorder that stands is asked again at the end.
pub(crate) const PAUSE: Duration = Duration::from_millis(50);

/// Longest wait for the other processes to come up, s.
pub const START_S: f64 = 20.0;

impl ProcessArgs {
    /// Reads the machine file.
    ///
    /// # Errors
    /// [`ShellError::File`] or [`ShellError::Machine`].
    pub fn read_machine(&self) -> Result<Machine, ShellError> {
        match &self.machine {
            None => Ok(Machine::default()),
            Some(path) => Ok(Machine::from_toml(&read_text(path)?)?),
        }
    }

    /// Joins the name space, on the processor that was asked for.
    ///
    /// # Errors
    /// [`ShellError::Ipc`].
    pub fn join(&self, process: Process) -> Result<Member, ShellError> {
        if let Some(processor) = self.processor {
            time::pin_to(processor)?;
        }
        Ok(Member::join(&self.address, process)?)
    }

    /// In real time the set-up of a process with a deadline. What is refused is said; a strict one does not
    /// start then. All of it is told the launcher by a line of JSON on standard output.
    ///
    /// # Errors
    /// [`ShellError::NotSetUp`].
    pub(crate) fn set_up(&self, process: Process) -> Result<Option<SetUp>, ShellError> {
        if self.clock == Clock::Virtual {
            return Ok(None);
        }
        let set_up = real_time::set_up(Path::new("/"), process);
        say(&serde_json::json!({ "set_up": set_up.items }).to_string());
        let refused = |item: &real_time::Item| format!("{}: {}", item.what, item.text);
        if self.strict_set_up {
            let all: Vec<_> = set_up.refused().map(refused).collect();
            return if all.is_empty() {
                Ok(Some(set_up))
            } else {
                Err(ShellError::NotSetUp(all.join("\n  ")))
            };
        }
        set_up.refused().for_each(|item| tracing::warn!("{}", refused(item)));
        Ok(Some(set_up))
    }

    /// What this process has written down of its deadlines, in real time: a line of JSON, as above.
    pub(crate) fn tell(&self, ledger: &Ledger, work: &str) {
        if self.clock == Clock::Real {
            say(&ledger.told(work));
        }
    }

    /// How long senders wait for a full queue: in lock step for ever, in real time a part of a cycle.
    pub fn patience(&self, machine: &Machine) -> Patience {
        match self.clock {
            Clock::Virtual => Patience::Forever,
            Clock::Real => Patience::Bounded(Duration::from_secs_f64(machine.general.cycle_s / 2.0)),
        }
    }
}

impl ProcessArgs {
    /// How long senders wait for a recorder: in lock step for ever, in real time not at all. A recorder that
    /// is slow or stands costs the record, never the machine.
    pub fn recorded(&self) -> Patience {
        match self.clock {
            Clock::Virtual => Patience::Forever,
            Clock::Real => Patience::Bounded(Duration::ZERO),
        }
    }
}

/// Sends a message, and goes on without receivers that have died: the launcher sees that and brings the
/// machine to rest. In real time a queue that stays full costs the message, and its receiver counts it as
/// lost.
///
/// # Errors
/// [`ShellError::Ipc`] if the channel is broken.
pub fn deliver<T: Payload>(sender: &mut Sender<T>, message: &T) -> Result<(), ShellError> {
    record(sender, message, false)
}

/// The same to the recorder. The last one of a run waits for a recorder that stands, since the machine rests.
///
/// # Errors
/// [`ShellError::Ipc`] if the channel is broken.
pub(crate) fn record<T: Payload>(sender: &mut Sender<T>, message: &T, last: bool) -> Result<(), ShellError> {
    loop {
        match sender.send(message) {
            Err(Undelivered::Full(_)) if last && !is_orphan() => {
                sender.comes_again();
                sleep_until(Moment::now().after(PAUSE));
            }
            Ok(()) | Err(Undelivered::Full(_)) => return Ok(()),
            Err(Undelivered::Receivers { .. }) => {
                sender.expect_one_less();
                return Ok(());
            }
            Err(broken) => return Err(broken.into()),
        }
    }
}

/// A line to the launcher, on standard output. One that is gone hears nothing, and that is no error.
fn say(line: &str) {
    let _ = writeln!(std::io::stdout(), "{line}");
}

/// Reads a machine file or a scenario.
///
/// # Errors
/// [`ShellError::File`].
pub fn read_text(path: &std::path::Path) -> Result<String, ShellError> {
    intake::text(path, intake::SETTINGS).map_err(|source| ShellError::File { path: path.into(), source })
}
