//! Time of the operating system, for process shells only: moments, waiting for one, and the set-up that makes
//! waking up punctual. Nothing here may reach a module, whose only time is the [`Cycle`](protocol::Cycle).

use std::time::Duration;

use rustix::thread::{ClockId, CpuSet};

use super::IpcError;

/// A point on CLOCK_MONOTONIC, ns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Moment(u64);

impl Moment {
    /// Now.
    pub fn now() -> Moment {
        let now = rustix::time::clock_gettime(ClockId::Monotonic);
        Moment(now.tv_sec as u64 * 1_000_000_000 + now.tv_nsec as u64)
    }

    /// That many seconds from now; negative values count as none.
    pub fn in_s(seconds: f64) -> Moment {
        Moment::now().after(Duration::from_secs_f64(seconds.max(0.0)))
    }

    /// Later by a duration.
    pub fn after(self, duration: Duration) -> Moment {
        Moment(self.0.saturating_add(u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)))
    }

    /// Earlier by a duration.
    pub fn before(self, duration: Duration) -> Moment {
        Moment(self.0.saturating_sub(u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)))
    }

    /// How long ago it was; zero if it lies ahead.
    pub fn elapsed(self) -> Duration {
        Duration::from_nanos(Moment::now().0.saturating_sub(self.0))
    }

    /// How long after another one it is; zero if it is before it.
    pub fn since(self, other: Moment) -> Duration {
        Duration::from_nanos(self.0.saturating_sub(other.0))
    }

    /// Whether it has come.
    pub fn passed(self) -> bool {
        Moment::now() >= self
    }
}

/// Sleeps until an absolute moment: lateness of one cycle does not shift the next.
pub fn sleep_until(moment: Moment) {
    let request = rustix::thread::Timespec {
        tv_sec: (moment.0 / 1_000_000_000) as i64,
        tv_nsec: (moment.0 % 1_000_000_000) as i64,
    };
    while rustix::thread::clock_nanosleep_absolute(ClockId::Monotonic, &request)
        == Err(rustix::io::Errno::INTR)
    {}
}

/// Keeps this process on one processor, numbered from 0. In virtual time all processes of a machine are
/// fastest on the same one: each waits for the other anyway, and waking up on another costs more than taking
/// turns.
///
/// # Errors
/// [`IpcError::System`] if there is no such processor.
pub fn pin_to(processor: usize) -> Result<(), IpcError> {
    let mut set = CpuSet::new();
    if processor < CpuSet::MAX_CPU {
        set.set(processor);
    }
    rustix::thread::sched_setaffinity(None, &set)
        .map_err(|error| IpcError::System { what: "pinning to a processor", source: error.into() })
}

/// Wakes this process as near to its moments as the operating system can: no timer slack, and before others
/// that want the processor.
///
/// # Errors
/// [`IpcError::System`] if this user may not raise priorities. The slack is gone all the same.
pub fn be_punctual() -> Result<(), IpcError> {
    let system = |what| move |error: rustix::io::Errno| IpcError::System { what, source: error.into() };
    let slack = std::num::NonZeroU64::new(1);
    rustix::thread::set_current_timer_slack(slack).map_err(system("setting the timer slack"))?;
    rustix::process::setpriority_process(None, -20).map_err(system("raising the priority (ulimit -e)"))
}

/// The processors this process may use, at least one.
pub fn processors() -> Vec<usize> {
    let allowed = rustix::thread::sched_getaffinity(None).unwrap_or_else(|_| CpuSet::new());
    let all: Vec<usize> = (0..CpuSet::MAX_CPU).filter(|processor| allowed.is_set(*processor)).collect();
    if all.is_empty() { vec![0] } else { all }
}

/// Keeps every page in memory, now and later. Call it after all ports are open.
///
/// # Errors
/// [`IpcError::System`] if the limit of locked memory (`ulimit -l`) is too low.
pub fn lock_memory() -> Result<(), IpcError> {
    use rustix::mm::MlockAllFlags;
    rustix::mm::mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE)
        .map_err(|error| IpcError::System { what: "locking memory (ulimit -l)", source: error.into() })
}
