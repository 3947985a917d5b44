//! Finds out who holds the machine up when nothing happens any more. Time of the wall, because in lock step
//! there is no other: a machine that waits for a frozen process has none.

use std::time::Duration;

use process::ipc::{
    NameSpace, Process,
    child::{used, waited_for_pages, waits_for_device},
};

use super::{children::Started, quiet::Quiet};
use crate::error::CliError;

/// Before this nobody is asked who waits for whom.
const QUIET: Duration = Duration::from_millis(500);
/// Processes that wait say so once a second: so long what they say is collected at least.
const COLLECT: Duration = Duration::from_secs(2);

/// Who does something in the end is given so many times the patience: a computer whose disk or
/// processors are taken by others is slow, and a process that turns in a circle has to end some time.
const PERIODS: u32 = 6;

/// What a process has done so far, as the operating system counts it.
#[derive(Clone, Copy)]
struct Done {
    pid: u32,
    /// Ticks on a processor.
    used: u64,
    /// Pages that came from a disk.
    pages: u64,
}

impl Done {
    fn of(pid: u32) -> Option<Done> {
        Some(Done { pid, used: used(pid)?, pages: waited_for_pages(pid)? })
    }

    /// Whether the same process has gone on since. One that only waits wakes up once a second to say
    /// so, which may be a tick.
    fn has_gone_on(self, now: Done) -> bool {
        self.pid == now.pid && (now.used > self.used + 1 || now.pages > self.pages)
    }
}

/// The watch.
pub(crate) struct Watchdog {
    limit: Option<Duration>,
    /// For how long nothing has happened.
    quiet: Quiet,
    /// What the interpreter had used of a processor when who waits for whom began to be collected.
    collecting: Option<Option<u64>>,
    /// What the living had done when the wait for their end began, or was last prolonged; and how often
    /// it was.
    done: Vec<Done>,
    prolonged: u32,
}

impl Watchdog {
    /// A watchdog that bites after so many seconds; 0 is one that never does.
    pub(crate) fn new(limit_s: f64) -> Watchdog {
        let limit = Some(Duration::from_secs_f64(limit_s)).filter(|limit| !limit.is_zero());
        Watchdog { limit, quiet: Quiet::new(), collecting: None, done: Vec::new(), prolonged: 0 }
    }

    /// Something has happened.
    pub(crate) fn calm(&mut self) {
        self.quiet.begins_anew();
        self.collecting = None;
    }

    /// Whether the time is over, nothing having happened since [`Watchdog::calm`]. For waits in which nothing
    /// can happen any more but that they end.
    pub(crate) fn is_over(&mut self) -> bool {
        let quiet = self.quiet.look();
        self.limit.is_some_and(|limit| quiet >= limit)
    }

    /// They are waited for from here on: they have only to end.
    pub(crate) fn waits_for(&mut self, started: &[Started]) {
        self.calm();
        (self.done, self.prolonged) = (done(started), 0);
    }

    /// Whether they have had all their time to end. Who does something meanwhile, or waits for a
    /// device, is not frozen and only slow.
    pub(crate) fn have_had_time(&mut self, started: &[Started]) -> bool {
        if !self.is_over() {
            return false;
        }
        let now = done(started);
        let goes_on = |now: &Done| self.done.iter().any(|before| before.has_gone_on(*now));
        let slow = now.iter().any(goes_on) || living(started).any(waits_for_device);
        if !slow || self.prolonged + 1 >= PERIODS {
            return true;
        }
        self.calm();
        (self.done, self.prolonged) = (now, self.prolonged + 1);
        false
    }

    /// Nothing has happened since the last look. Names those who hold the machine up once the time is over.
    /// An interpreter that computes is not one of them: it has no deadline.
    pub(crate) fn look(
        &mut self,
        space: &mut NameSpace,
        started: &[Started],
    ) -> Result<Vec<Process>, CliError> {
        let quiet = self.quiet.look();
        let Some(limit) = self.limit.filter(|limit| quiet >= QUIET && quiet + COLLECT >= *limit) else {
            return Ok(Vec::new());
        };
        let Some(used_before) = self.collecting else {
            space.awaited()?;
            self.collecting = Some(used_by_interpreter(started));
            return Ok(Vec::new());
        };
        if quiet < limit.max(COLLECT) {
            return Ok(Vec::new());
        }
        let mut awaited = space.awaited()?;
        if used_by_interpreter(started) > used_before.map(|ticks| ticks + 1) {
            awaited.retain(|process| *process != Process::Interpreter);
        }
        self.calm();
        Ok(awaited)
    }
}

/// The watch over the interpreter in real time, where the machine goes on without machine code.
pub(crate) struct Hunger {
    watch: Watchdog,
    /// For how long there is something known, as the watch counts it.
    known: Duration,
    awaited: bool,
    used: Option<u64>,
}

impl Hunger {
    /// One that bites after so many seconds; 0 is one that never does.
    pub(crate) fn new(limit_s: f64) -> Hunger {
        Hunger { watch: Watchdog::new(limit_s), known: Duration::ZERO, awaited: false, used: None }
    }

    /// Whether the interpreter hangs: it has been awaited for all the time, and has computed nothing.
    pub(crate) fn look(&mut self, space: &mut NameSpace, started: &[Started]) -> Result<bool, CliError> {
        let is_over = self.watch.is_over();
        if self.watch.limit.is_none() || self.watch.quiet.lasts() < self.known + COLLECT {
            return Ok(false);
        }
        self.known = self.watch.quiet.lasts();
        let used = used_by_interpreter(started);
        let computed = used > std::mem::replace(&mut self.used, used).map(|ticks| ticks + 1);
        let awaited = space.awaited()?.contains(&Process::Interpreter) && used.is_some() && !computed;
        // What happened before it was first awaited does not count.
        if !(awaited && std::mem::replace(&mut self.awaited, awaited)) {
            self.awaited = awaited;
            self.known = Duration::ZERO;
            self.watch.calm();
            return Ok(false);
        }
        Ok(is_over)
    }
}

fn done(started: &[Started]) -> Vec<Done> {
    living(started).filter_map(Done::of).collect()
}

fn living(started: &[Started]) -> impl Iterator<Item = u32> {
    started.iter().filter(|one| one.lives()).map(Started::pid)
}

fn used_by_interpreter(started: &[Started]) -> Option<u64> {
    let interpreter = started.iter().find(|one| one.host.holds(Process::Interpreter) && one.lives());
    interpreter.and_then(|one| one.has_computed().or_else(|| used(one.pid())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use process::ipc::time::Moment;
    use std::process::{Child, Command};

    struct Ended(Child);

    impl Drop for Ended {
        fn drop(&mut self) {
            let _ = self.0.kill();
            let _ = self.0.wait();
        }
    }

    fn shell(does: &str) -> Ended {
        Ended(Command::new("sh").args(["-c", does]).spawn().expect("a shell"))
    }

    #[test]
    fn who_computes_is_told_from_who_waits() {
        let (busy, waiting) = (shell("while :; do :; done"), shell("exec sleep 1000"));
        let done = |one: &Ended| Done::of(one.0.id()).expect("it lives");
        let goes_on = |one: &Ended, before: Done| {
            let ends = Moment::in_s(60.0);
            while !before.has_gone_on(done(one)) && !ends.passed() {
                process::ipc::time::sleep_until(Moment::in_s(0.01));
            }
        };
        // Time enough for the other one to begin to wait.
        goes_on(&busy, done(&busy));
        let (busy_before, waiting_before) = (done(&busy), done(&waiting));
        goes_on(&busy, busy_before);
        assert!(busy_before.has_gone_on(done(&busy)));
        assert!(!waiting_before.has_gone_on(done(&waiting)));
        assert!(!busy_before.has_gone_on(done(&waiting)), "another process");
    }
}
