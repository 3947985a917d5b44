//! The link between the two levels of a control that are two computers: the interpreter on host A (the upper
//! level), interpolator, regulators and plant on host B (the lower level). In: machine code of A, credit of
//! B. Out: the same on the other side, under a key that both have.
//!
//! On A the link stands in for the interpolator, on B for the interpreter: both are members of the name space
//! of their host, as [`process::ipc`] knows them, and no module notices that the other one is far away. What
//! crosses the wire is machine code, credit, a beat that says "I live", and what somebody presses. The
//! control loop does not, and neither does anything that an armed pass needs. Of a panel on A its socket to
//! the launcher on B does (`panel`), and then the interpreter is on B as well.
//!
//! Zenoh carries the bytes, to an address that is named: nothing is looked for on a network. It speaks to
//! sockets of its own host alone: in front of it stands a gate (`gate`), which has whoever calls prove that
//! he has the key.

pub mod call;
pub mod door;
pub mod gate;
pub mod hall;
pub mod hello;
pub mod joined;
pub mod lower;
pub mod message;
pub mod panel;
pub mod ping;
pub mod pipe;
pub mod places;
pub mod proof;
pub mod seal;
pub mod session;
pub mod talk;
pub mod upper;
pub mod wire;

/// Why the link cannot be had, or ended.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// An argument, a key, or what the other host is: nothing has moved.
    #[error("{0}")]
    Input(String),
    /// The other host lets nobody in: another key, no place, not a pitchlock. Nothing has moved.
    #[error("{0}")]
    Refused(String),
    /// Nobody answers there: nothing has moved.
    #[error("{0}")]
    Nobody(String),
    /// The network, or the other host, or this one.
    #[error("{0}")]
    Broken(String),
    /// Nothing was heard of the other host.
    #[error("nothing was heard of the other host for {} s: the cable, or its power", .0.as_secs())]
    Silent(std::time::Duration),
    /// The other processes of this host cannot be reached.
    #[error(transparent)]
    Shell(#[from] process::shell::ShellError),
    /// The same.
    #[error(transparent)]
    Ipc(#[from] process::ipc::IpcError),
}

impl LinkError {
    /// Something that Zenoh or the system refuses.
    pub(crate) fn broken(what: &str, why: impl std::fmt::Display) -> LinkError {
        LinkError::Broken(format!("{what}: {why}"))
    }

    /// A file that cannot be read or written.
    pub(crate) fn file(path: &std::path::Path, why: impl std::fmt::Display) -> LinkError {
        LinkError::Input(format!("{}: {why}", path.display()))
    }

    /// The exit status that it leaves: 2 for what is to be put right before anything moves.
    pub fn status(&self) -> u8 {
        if matches!(self, LinkError::Input(_) | LinkError::Refused(_) | LinkError::Nobody(_)) { 2 } else { 1 }
    }
}
