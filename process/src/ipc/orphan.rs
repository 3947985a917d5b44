//! A process whose launcher has gone. It goes on as long as the machine needs to come to rest, waits for
//! nobody for ever, and the last one to go wipes the name space.

use std::{
    rc::Rc,
    sync::{
        Arc, OnceLock,
        atomic::{AtomicBool, AtomicI32, Ordering},
    },
};

use rustix::process::{Pid, Signal, getpid, getppid, set_parent_process_death_signal};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

use super::{IpcError, folder::Folder};

/// The signal that says so may have come.
static CALLED: OnceLock<Arc<AtomicBool>> = OnceLock::new();
/// The launcher of this process; 0 if there is none.
static OWNER: AtomicI32 = AtomicI32::new(0);

/// Has the operating system tell this process when its launcher ends, in whatever way. A process that is its
/// own launcher (a test) is left alone.
pub(crate) fn watch_for(owner: i32) -> Result<(), IpcError> {
    let system = |what| move |source| IpcError::System { what, source };
    let Some(pid) = Pid::from_raw(owner).filter(|pid| *pid != getpid()) else { return Ok(()) };
    OWNER.store(owner, Ordering::Relaxed);
    let called = CALLED.get_or_init(Arc::default);
    signal_hook::flag::register(SIGHUP, Arc::clone(called)).map_err(system("catching a signal"))?;
    // Whoever ends all processes of the machine at once asks its launcher, which brings the tool out first.
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register(signal, Arc::default()).map_err(system("catching a signal"))?;
    }
    set_parent_process_death_signal(Some(Signal::HUP))
        .map_err(|error| system("tying this process to its launcher")(error.into()))?;
    // If the launcher died before the line above took effect, somebody else is the parent by now.
    if getppid() != Some(pid) {
        return Err(IpcError::Orphaned { owner });
    }
    Ok(())
}

/// In the environment of a process that is nothing without the one that started it: that one's number.
pub const ENDS_WITH: &str = "PITCHLOCK_ENDS_WITH";

/// Ends this process at once when the one of [`ENDS_WITH`] ends, in whatever way; does nothing without it.
///
/// # Errors
/// That one has ended already, or the system refuses.
pub fn end_with_starter() -> Result<(), IpcError> {
    let named = std::env::var(ENDS_WITH).ok().and_then(|owner| Pid::from_raw(owner.parse().ok()?));
    let Some(owner) = named else { return Ok(()) };
    let system = |source: rustix::io::Errno| IpcError::System {
        what: "tying this process to its starter",
        source: source.into(),
    };
    set_parent_process_death_signal(Some(Signal::KILL)).map_err(system)?;
    if getppid() != Some(owner) {
        return Err(IpcError::Orphaned { owner: owner.as_raw_pid() });
    }
    Ok(())
}

/// Whether the launcher has gone. Costs nothing while it has not.
pub fn is_orphan() -> bool {
    let called = CALLED.get().is_some_and(|called| called.load(Ordering::Relaxed));
    called && getppid().map_or(0, Pid::as_raw_pid) != OWNER.load(Ordering::Relaxed)
}

/// That this process lives in a name space. Every port has its share: the last to be closed lets go of it.
#[derive(Clone, Debug)]
pub(crate) struct Presence {
    _folder: Rc<Leaving>,
}

#[derive(Debug)]
struct Leaving(Folder);

impl Presence {
    pub(crate) fn new(folder: Folder) -> Presence {
        Presence { _folder: Rc::new(Leaving(folder)) }
    }
}

impl Drop for Leaving {
    fn drop(&mut self) {
        // With a launcher, it wipes. What cannot be wiped now is wiped by the next one.
        if is_orphan()
            && let Err(error) = self.0.wipe_if_last()
        {
            tracing::warn!(%error, "the name space was not wiped");
        }
    }
}
