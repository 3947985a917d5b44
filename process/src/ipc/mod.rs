//! The channels between the processes of one machine, over iceoryx2.
//!
//! The launcher owns a [`NameSpace`]: it creates every channel of [`channel`] before it starts a process, and
//! wipes all traces in the end. Each process joins it as a [`Member`], opens [`Sender`]s and [`Receiver`]s,
//! and stands at the start until everybody is connected:
//!
//! ```no_run
//! use process::ipc::{IpcError, Member, Patience, Process, channel, time::Moment};
//! use protocol::{Axis, DriveCommand};
//! # fn main() -> Result<(), IpcError> {
//! # let address = String::new();
//! let mut member = Member::join(&address, Process::Regulator(Axis::X))?;
//! let mut measurements = member.receiver(channel::MEASUREMENT)?;
//! let mut commands = member.sender(channel::DRIVE_COMMAND.of(Axis::X), Patience::Forever)?;
//! let plant = member.waker(Process::Plant)?;
//! member.start(&[&measurements, &commands, &plant], Moment::in_s(5.0))?;
//! loop {
//!     let Some(measurement) = measurements.receive()? else {
//!         member.wait()?;
//!         continue;
//!     };
//!     commands.send(&DriveCommand { cycle: measurement.cycle, ..DriveCommand::default() })?;
//!     plant.wake()?;
//!     if measurement.last != 0 {
//!         break;
//!     }
//! }
//! member.finish(&[commands.count(), measurements.count()])
//! # }
//! ```
//!
//! Three habits keep this safe. Data decide, never the wake-up: a receiver looks again after every wake,
//! because one wake may stand for many messages or for none. Every message of a lossless channel is accounted
//! for: the sender compares the receivers reached with those expected, the receiver checks the running
//! number. And nobody cleans up while others work: only the owner does, when a process has died or all have
//! ended.

mod bell;
pub mod channel;
pub mod child;
pub mod computer;
mod count;
mod folder;
mod layout;
mod member;
mod name_space;
mod orphan;
mod port;
mod process;
pub mod real_time;
pub mod time;
mod wake;

pub use bell::Doorbell;
pub use channel::{Channel, Keep};
pub use count::{ChannelCount, of_the_living, total};
pub use layout::{Host, Layout, hosts};
pub use member::Member;
pub use name_space::NameSpace;
pub use orphan::{ENDS_WITH, end_with_starter, is_orphan};
pub use port::{Patience, Port, Receiver, Sender, Undelivered};
pub use process::Process;
pub use wake::Waker;

/// Why a name space, a port or a wake-up cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum IpcError {
    /// iceoryx2 refused; the name of the channel or event, and its reason.
    #[error("{name}: {reason}; run `pitchlock doctor`")]
    Bus {
        /// Channel, event or node.
        name: String,
        /// In the words of iceoryx2.
        reason: String,
    },
    /// A file of the name space cannot be made, locked or removed.
    #[error("{path}: {source}")]
    File {
        /// Which file.
        path: std::path::PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// A process that writes where no memory is left would be killed by SIGBUS.
    #[error(
        "/dev/shm has {} kB free, and a machine needs {} kB: remove what is left there, or give it more \
         (`mount -o remount,size=64m /dev/shm`; in a container --shm-size=64m)",
        .free / 1024, .needed.div_ceil(1024)
    )]
    NoRoom {
        /// What is free, bytes.
        free: u64,
        /// What a machine needs at most, bytes.
        needed: u64,
    },
    /// Every channel and every event takes some of them.
    #[error(
        "a process may open {allowed} files at once, and one of this machine needs {needed}: raise the limit \
         (`ulimit -n`; as administrator nofile in /etc/security/limits.conf)"
    )]
    TooFewFiles {
        /// How many are allowed at most.
        allowed: u64,
        /// How many are needed.
        needed: u64,
    },
    /// Sockets of the name space would not fit into 108 bytes.
    #[error(
        "the name of the folder for temporary files is too long ({path}): set TMPDIR to a folder such as /tmp"
    )]
    PathTooLong {
        /// The path.
        path: std::path::PathBuf,
    },
    /// The bus takes no such name.
    #[error(
        "the name of the folder for temporary files ({path}) has letters that are not ASCII: set TMPDIR to a folder such as \
         /tmp"
    )]
    PathNotAscii {
        /// The path.
        path: std::path::PathBuf,
    },
    /// Not an address that [`NameSpace::address`] gave.
    #[error(
        "{0:?} is not the address of a running machine; processes of a machine are started by `pitchlock run`"
    )]
    NoSuchAddress(String),
    /// The process that owns the name space is not the parent of this one: nobody would end it.
    #[error("the launcher (process {owner}) is gone, or did not start this process itself")]
    Orphaned {
        /// Process id of the owner.
        owner: i32,
    },
    /// The launcher ended before the machine started.
    #[error("the launcher ended while the machine was starting")]
    LauncherGone,
    /// Somebody has not answered for long, and there is no launcher any more that would know why.
    #[error("{0} says nothing, and the launcher is gone")]
    Forsaken(String),
    /// The other ends of these channels did not appear in time.
    #[error("nobody is at the other end of {}", .0.join(", "))]
    NotConnected(Vec<String>),
    /// The real-time set-up failed.
    #[error("{what}: {source}")]
    System {
        /// What was tried.
        what: &'static str,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// A message could not be delivered.
    #[error(transparent)]
    Undelivered(#[from] Undelivered),
}

impl IpcError {
    /// Takes over a refusal of iceoryx2.
    pub(crate) fn bus(name: &str, reason: impl std::fmt::Display) -> IpcError {
        IpcError::Bus { name: name.into(), reason: reason.to_string() }
    }

    /// Takes over an error of the file system.
    pub(crate) fn file(path: &std::path::Path, source: impl Into<std::io::Error>) -> IpcError {
        IpcError::File { path: path.into(), source: source.into() }
    }
}
