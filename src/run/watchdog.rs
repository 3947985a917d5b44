//! Finds out who holds the machine up when nothing happens any more. Time of the wall, because in lock step
//! there is no other: a machine that waits for a frozen process has none.

use std::time::Duration;

use process::ipc::{NameSpace, Process, child::used, time::Moment};

use super::children::Started;
use crate::error::CliError;

/// The longest time between two looks that counts: a launcher that was stopped itself has not waited.
const STEP: Duration = Duration::from_millis(100);
/// Before this nobody is asked who waits for whom.
const QUIET: Duration = Duration::from_millis(500);
/// Processes that wait say so once a second: so long what they say is collected at least.
const COLLECT: Duration = Duration::from_secs(2);

/// The watch.
pub(crate) struct Watchdog {
    limit: Option<Duration>,
    /// For how long nothing has happened.
    quiet: Duration,
    last: Moment,
    /// What the interpreter had used of a processor when who waits for whom began to be collected.
    collecting: Option<Option<u64>>,
}

impl Watchdog {
    /// A watchdog that bites after so many seconds; 0 is one that never does.
    pub(crate) fn new(limit_s: f64) -> Watchdog {
        let limit = Some(Duration::from_secs_f64(limit_s)).filter(|limit| !limit.is_zero());
        Watchdog { limit, quiet: Duration::ZERO, last: Moment::now(), collecting: None }
    }

    /// Something has happened.
    pub(crate) fn calm(&mut self) {
        *self = Watchdog { quiet: Duration::ZERO, last: Moment::now(), collecting: None, ..*self };
    }

    /// Whether the time is over, nothing having happened since [`Watchdog::calm`]. For waits in which nothing
    /// can happen any more but that they end.
    pub(crate) fn is_over(&mut self) -> bool {
        self.quiet += self.last.elapsed().min(STEP);
        self.last = Moment::now();
        self.limit.is_some_and(|limit| self.quiet >= limit)
    }

    /// Nothing has happened since the last look. Names those who hold the machine up once the time is over.
    /// An interpreter that computes is not one of them: it has no deadline.
    pub(crate) fn look(
        &mut self,
        space: &mut NameSpace,
        started: &[Started],
    ) -> Result<Vec<Process>, CliError> {
        self.is_over();
        let Some(limit) = self.limit.filter(|limit| self.quiet >= QUIET && self.quiet + COLLECT >= *limit)
        else {
            return Ok(Vec::new());
        };
        let Some(used_before) = self.collecting else {
            space.awaited()?;
            self.collecting = Some(used_by_interpreter(started));
            return Ok(Vec::new());
        };
        if self.quiet < limit.max(COLLECT) {
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
        if self.watch.limit.is_none() || self.watch.quiet < self.known + COLLECT {
            return Ok(false);
        }
        self.known = self.watch.quiet;
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

fn used_by_interpreter(started: &[Started]) -> Option<u64> {
    let interpreter = started.iter().find(|one| one.host.holds(Process::Interpreter) && one.lives());
    interpreter.and_then(|one| used(one.pid()))
}
