//! Spindle commands at the plant. In: what the interpolator sends each tick. Out: the command in force, which
//! is that of the tick before.

use machine::Machine;
use protocol::{Cycle, SpindleCommand};

use crate::{
    ipc::{ChannelCount, IpcError, Member, Port, Process, Receiver, channel},
    shell::{Clock, ShellError, Wait},
};

/// Spindle commands that have come, and one that has its time still to come.
pub(super) struct SpindleCommands {
    receiver: Receiver<SpindleCommand>,
    next: Option<SpindleCommand>,
    cycles_per_tick: u64,
}

impl SpindleCommands {
    pub(super) fn open(member: &Member, machine: &Machine) -> Result<SpindleCommands, IpcError> {
        let receiver = member.receiver(channel::SPINDLE_COMMAND)?;
        Ok(SpindleCommands { receiver, next: None, cycles_per_tick: machine.cycles_per_tick() })
    }

    pub(super) fn port(&self) -> &dyn Port {
        &self.receiver
    }

    pub(super) fn count(&self) -> ChannelCount {
        self.receiver.count()
    }

    /// The command of the tick before, which is in force from this one on; the cycle of what came into force.
    /// In real time it is the newest of those that are due: one that was late once makes no other one late.
    pub(super) fn take(
        &mut self,
        member: &mut Member,
        clock: Clock,
        now: Cycle,
        in_force: &mut SpindleCommand,
    ) -> Result<Option<u64>, ShellError> {
        let mut wait = Wait::on(Process::Interpolator);
        let mut taken = None;
        loop {
            let command = match self.next.take() {
                Some(command) => Some(command),
                None => self.receiver.receive()?,
            };
            match command {
                Some(command) if command.cycle.after(self.cycles_per_tick) <= now => {
                    // What is refused has not arrived.
                    if command.check().is_ok() {
                        *in_force = command;
                        taken = Some(command.cycle.0);
                    }
                    if clock == Clock::Virtual {
                        return Ok(taken);
                    }
                }
                Some(early) => {
                    self.next = Some(early);
                    return Ok(taken);
                }
                None if clock == Clock::Real || wait.is_in_vain(member) => return Ok(taken),
                None => wait.sleep(member, clock)?,
            }
        }
    }
}
