//! The launcher's ends of the channels: what the machine says of itself, joined by cycle; what the operator
//! does.

use std::collections::VecDeque;

use machine::Machine;
use process::ipc::{ChannelCount, IpcError, NameSpace, Patience, Port, Process, Receiver, Sender, channel};
use protocol::{
    Axis, AxisStatus, MachineStatus, Message, Truth,
    operator::{OperatorRequest, Request},
};
use rig::observe::Record;

use super::recorder::{Recorder, axes};
use crate::error::CliError;

/// One source, and what of it waits for the others.
struct Source<T: Message> {
    receiver: Receiver<T>,
    waiting: VecDeque<T>,
    /// Its sender has died: what has not come will not come.
    gone: bool,
}

impl<T: Message> Source<T> {
    fn new(receiver: Receiver<T>) -> Source<T> {
        Source { receiver, waiting: VecDeque::new(), gone: false }
    }

    /// Whether the oldest that waits is such, or nothing will come any more.
    fn has(&self, such: impl Fn(&T) -> bool) -> bool {
        self.waiting.front().map_or(self.gone, such)
    }

    /// Takes what is such, oldest first; the newest of it stays in `seen`.
    fn take_until(&mut self, such: impl Fn(&T) -> bool, seen: &mut T) {
        while self.waiting.front().is_some_and(&such)
            && let Some(message) = self.waiting.pop_front()
        {
            *seen = message;
        }
    }

    fn drain(&mut self) -> Result<(), IpcError> {
        while let Some(message) = self.receiver.receive()? {
            self.waiting.push_back(message);
        }
        Ok(())
    }
}

/// The launcher's ports.
pub(crate) struct Channels {
    truths: Source<Truth>,
    axes: Vec<(Axis, Source<AxisStatus>)>,
    ticks: Source<MachineStatus>,
    operator: Sender<OperatorRequest>,
    requests: u64,
    cycles_per_tick: u64,
    late_answers: u64,
    seen: Vec<(Axis, AxisStatus)>,
    machine: MachineStatus,
    ended: bool,
}

impl Channels {
    /// Opens them.
    pub(crate) fn open(space: &mut NameSpace, machine: &Machine) -> Result<Channels, CliError> {
        let member = space.launcher();
        let axes = axes(machine);
        let mut statuses = Vec::new();
        for axis in &axes {
            statuses.push((*axis, Source::new(member.receiver(channel::AXIS_STATUS.of(*axis))?)));
        }
        Ok(Channels {
            truths: Source::new(member.receiver(channel::TRUTH)?),
            axes: statuses,
            ticks: Source::new(member.receiver(channel::MACHINE_STATUS)?),
            operator: member
                .sender(channel::OPERATOR, Patience::Bounded(std::time::Duration::from_millis(100)))?,
            requests: 0,
            cycles_per_tick: machine.cycles_per_tick(),
            late_answers: 0,
            seen: axes.iter().map(|axis| (*axis, AxisStatus::default())).collect(),
            machine: MachineStatus::default(),
            ended: false,
        })
    }

    /// The ports, for the rendezvous.
    pub(crate) fn ports(&self) -> Vec<&dyn Port> {
        let mut ports: Vec<&dyn Port> = vec![&self.truths.receiver, &self.ticks.receiver, &self.operator];
        ports.extend(self.axes.iter().map(|(_, source)| &source.receiver as &dyn Port));
        ports
    }

    /// Records every cycle of which everything is known. True if there was any. With `force` what is missing
    /// is taken for lost.
    pub(crate) fn record(&mut self, recorder: &mut Recorder, force: bool) -> Result<bool, CliError> {
        self.truths.drain()?;
        self.ticks.drain()?;
        self.axes.iter_mut().try_for_each(|(_, source)| source.drain())?;
        let mut any = false;
        while let Some(truth) = self.next(force) {
            recorder.cycle(&Record { truth: &truth, axes: &self.seen, machine: &self.machine });
            self.ended |= truth.measurement.last != 0;
            self.late_answers = truth.late_answers;
            any = true;
        }
        Ok(any)
    }

    /// The oldest truth, when all that belongs to it has come: a status of its cycle, or a later one because
    /// it was lost, of every axis, and of the interpolator at its ticks.
    fn next(&mut self, force: bool) -> Option<Truth> {
        let cycle = self.truths.waiting.front()?.cycle;
        let tick = cycle.0.is_multiple_of(self.cycles_per_tick);
        let statuses = self.axes.iter().all(|(_, source)| source.has(|status| status.cycle >= cycle));
        let complete = statuses && (!tick || self.ticks.has(|status| status.cycle >= cycle));
        if !complete && !force {
            return None;
        }
        for ((_, source), (_, seen)) in self.axes.iter_mut().zip(&mut self.seen) {
            source.take_until(|status| status.cycle <= cycle, seen);
        }
        self.ticks.take_until(|status| status.cycle <= cycle, &mut self.machine);
        self.truths.waiting.pop_front()
    }

    /// Whether the last measurement has been recorded.
    pub(crate) fn ended(&self) -> bool {
        self.ended
    }

    /// Whether the last measurement has come, recorded or not.
    pub(crate) fn last_has_come(&self) -> bool {
        self.truths.waiting.back().is_some_and(|truth| truth.measurement.last != 0)
    }

    /// Nobody waits for what a process that has died would have said.
    pub(crate) fn bury(&mut self, process: Process) {
        self.ticks.gone |= process == Process::Interpolator;
        for (axis, source) in &mut self.axes {
            source.gone |= process == Process::Regulator(*axis);
        }
    }

    /// Whether an axis is in a pass, as far as recorded, and its regulator alive to end it.
    pub(crate) fn in_pass(&self) -> bool {
        let sources = self.axes.iter().map(|(_, source)| source);
        let mut living = self.seen.iter().zip(sources).filter(|(_, source)| !source.gone);
        living.any(|((_, status), _)| status.state().is_in_pass())
    }

    /// Answers that came after their cycle, in real time.
    pub(crate) fn late_answers(&self) -> u64 {
        self.late_answers
    }

    /// Does something at the panel.
    pub(crate) fn operate(&mut self, request: Request) -> Result<(), CliError> {
        self.operator.send(&OperatorRequest::pack(self.requests, request)).map_err(IpcError::from)?;
        self.requests += 1;
        Ok(())
    }

    /// What went through the launcher's ends.
    pub(crate) fn counts(&self) -> Vec<ChannelCount> {
        let mut counts =
            vec![self.truths.receiver.count(), self.ticks.receiver.count(), self.operator.count()];
        counts.extend(self.axes.iter().map(|(_, source)| source.receiver.count()));
        counts
    }
}
