//! Waiting for one thing from another process. In lock step it lasts as long as it lasts, and whoever waits
//! for a second says so once a second, so that the launcher knows who holds the machine up.

use std::time::Duration;

use super::{Clock, ShellError};
use crate::ipc::{
    Member, Process, is_orphan,
    time::{Moment, sleep_until},
};

/// How often a process looks for messages in real time. A wake-up can be lost (see `ipc`), a clock cannot.
pub(crate) const POLL: Duration = Duration::from_micros(50);
/// So long nobody is told.
const PATIENT: Duration = Duration::from_secs(1);

/// Without a launcher a process that has not answered another one for so long counts as dead, for ever. Who
/// waits for somebody who may be waiting himself waits longer, so that only the dead are given up.
fn forsaken(who: Process, whom: Process) -> Duration {
    Duration::from_secs(match (who, whom) {
        (Process::Interpolator, Process::Interpreter | Process::Regulator(_)) => 2,
        (_, Process::Interpolator) => 6,
        (_, Process::Regulator(_)) => 9,
        (_, _) => 20,
    })
}

/// A wait.
pub(crate) struct Wait {
    whom: Process,
    since: Option<Moment>,
    told: u32,
}

impl Wait {
    /// A wait that begins when it first [sleeps](Wait::sleep).
    pub(crate) fn on(whom: Process) -> Wait {
        Wait { whom, since: None, told: 0 }
    }

    /// A wait that goes on where the one for somebody else, which began at the same time, has ended.
    pub(crate) fn after(self, since: Option<Moment>) -> Wait {
        Wait { since, ..self }
    }

    /// When it began, if it has.
    pub(crate) fn since(&self) -> Option<Moment> {
        self.since
    }

    /// Waits for news: in lock step asleep until woken, in real time by looking often.
    pub(crate) fn sleep(&mut self, member: &mut Member, clock: Clock) -> Result<(), ShellError> {
        match clock {
            Clock::Virtual => member.wait()?,
            Clock::Real => {
                sleep_until(Moment::now().after(POLL));
                member.look()?;
            }
        }
        self.go_on(member)
    }

    /// Waits in real time for what is not due before a moment: until then, then by looking often.
    pub(crate) fn sleep_until(&mut self, member: &mut Member, moment: Moment) -> Result<(), ShellError> {
        sleep_until(moment.max(Moment::now().after(POLL)));
        member.look()?;
        self.go_on(member)
    }

    /// It is still not there, though this process does something else meanwhile.
    pub(crate) fn go_on(&mut self, member: &Member) -> Result<(), ShellError> {
        let since = *self.since.get_or_insert_with(Moment::now);
        if since.elapsed() >= PATIENT * (self.told + 1) {
            self.told += 1;
            member.waits_for(self.whom)?;
        }
        Ok(())
    }

    /// Whether it will not come any more. Without a launcher this is remembered: nobody is waited for again
    /// who was given up.
    pub(crate) fn is_in_vain(&self, member: &mut Member) -> bool {
        if member.is_gone(self.whom) {
            return true;
        }
        let patience = forsaken(member.process(), self.whom);
        let given_up = is_orphan() && self.since.is_some_and(|since| since.elapsed() >= patience);
        if given_up {
            member.give_up(self.whom);
        }
        given_up
    }
}
