//! The launcher's ends of the channels: what the machine says of itself, joined by cycle; what the operator
//! does.

use std::{collections::VecDeque, time::Duration};

use machine::Machine;
use process::ipc::{
    ChannelCount, IpcError, NameSpace, Patience, Port, Process, Receiver, Sender, Undelivered, channel,
};
use process::shell::Clock;
use protocol::{
    Arrival, Axis, AxisStatus, MachineStatus, Message, Truth,
    operator::{OperatorRequest, Request},
};
use rig::observe::{self, Record};

use super::recorder::axes;
use crate::error::CliError;

/// In real time, whoever has said nothing for so long while the plant went on is dead or hangs, s.
pub(crate) const SILENT_S: f64 = 1.0;

/// So long a request waits for a place in the queue of a plant that takes none.
const PANEL: Duration = Duration::from_millis(100);

/// What was counted on a channel, as a summary has it.
pub(super) fn counted(count: ChannelCount) -> observe::Channel {
    let ChannelCount { name, sent, received, lost, bytes, late, late_in_row, not_counted } = count;
    observe::Channel { name, sent, received, lost, bytes, late, late_in_row, not_counted }
}

/// One source, and what of it waits for the others.
struct Source<T: Message> {
    receiver: Receiver<T>,
    waiting: VecDeque<T>,
    /// Its sender has died: what has not come will not come.
    gone: bool,
    /// Cycle of the newest that has come.
    newest: u64,
    silence: Silence,
}

/// For how long a source has said nothing while the plant went on. Truths are counted as they come: a
/// launcher that was itself held up finds old ones in its queues, and a gap behind them.
#[derive(Clone, Copy, Debug, Default)]
struct Silence {
    /// At the look before there was nothing either.
    was_empty: bool,
    /// Truths in it.
    truths: u64,
}

impl Silence {
    /// At a look so many truths were taken, then so many messages of the source. The queues are not emptied
    /// at one moment: truths of a look with which the silence begins may be older than the last message,
    /// which was taken the look before, if the launcher stood between the two queues. So they do not count.
    fn look(&mut self, truths: usize, messages: usize) {
        let counted = if messages == 0 && self.was_empty { self.truths + truths as u64 } else { 0 };
        *self = Silence { was_empty: messages == 0, truths: counted };
    }
}

impl<T: Message> Source<T> {
    fn new(receiver: Receiver<T>) -> Source<T> {
        Source { receiver, waiting: VecDeque::new(), gone: false, newest: 0, silence: Silence::default() }
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

    /// Takes what has come, and gives how many.
    fn drain(&mut self, cycle: impl Fn(&T) -> u64, mut see: impl FnMut(&T)) -> Result<usize, IpcError> {
        let before = self.waiting.len();
        while let Some(message) = self.receiver.receive()? {
            self.newest = cycle(&message);
            see(&message);
            self.waiting.push_back(message);
        }
        Ok(self.waiting.len() - before)
    }

    /// So many truths have come, and so many messages of this source, which it gives.
    fn heard(&mut self, truths: usize, messages: usize) -> usize {
        self.silence.look(truths, messages);
        messages
    }
}

/// The launcher's ports.
pub(crate) struct Channels {
    truths: Source<Truth>,
    axes: Vec<(Axis, Source<AxisStatus>)>,
    ticks: Source<MachineStatus>,
    arrivals: Receiver<Arrival>,
    operator: Sender<OperatorRequest>,
    requests: u64,
    cycles_per_tick: u64,
    /// How far behind the truth whoever lives can be in real time, control cycles; `None` in lock step.
    oldest: Option<u64>,
    late_answers: u64,
    seen: Vec<(Axis, AxisStatus)>,
    machine: MachineStatus,
    ended: bool,
}

impl Channels {
    /// Opens them.
    pub(crate) fn open(space: &mut NameSpace, machine: &Machine, clock: Clock) -> Result<Channels, CliError> {
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
            arrivals: member.receiver(channel::ARRIVAL)?,
            operator: member.sender(channel::OPERATOR, Patience::Bounded(PANEL))?,
            requests: 0,
            cycles_per_tick: machine.cycles_per_tick(),
            oldest: (clock == Clock::Real).then(|| (SILENT_S / machine.general.cycle_s).ceil() as u64),
            late_answers: 0,
            seen: axes.iter().map(|axis| (*axis, AxisStatus::default())).collect(),
            machine: MachineStatus::default(),
            ended: false,
        })
    }

    /// The ports, for the rendezvous.
    pub(crate) fn ports(&self) -> Vec<&dyn Port> {
        let mut ports: Vec<&dyn Port> = vec![&self.truths.receiver, &self.ticks.receiver, &self.operator];
        ports.push(&self.arrivals);
        ports.extend(self.axes.iter().map(|(_, source)| &source.receiver as &dyn Port));
        ports
    }

    /// Takes what has come, and shows every truth to `see`. Gives how many messages there were.
    pub(crate) fn drain(&mut self, see: impl FnMut(&Truth)) -> Result<usize, CliError> {
        let truths = self.truths.drain(|truth| truth.cycle.0, see)?;
        let ticks = self.ticks.drain(|status| status.cycle.0, |_| {})?;
        let mut all = truths + self.ticks.heard(truths, ticks);
        for (_, source) in &mut self.axes {
            let statuses = source.drain(|status| status.cycle.0, |_| {})?;
            all += source.heard(truths, statuses);
        }
        Ok(all)
    }

    /// Takes what modules tell of their inputs.
    pub(crate) fn arrivals(&mut self, mut take: impl FnMut(&Arrival)) -> Result<(), CliError> {
        while let Some(arrival) = self.arrivals.receive()? {
            take(&arrival);
        }
        Ok(())
    }

    /// Gives every cycle of which everything is known to `record`. True if there was any. With `force` what
    /// is missing is taken for lost.
    pub(crate) fn record(&mut self, force: bool, mut record: impl FnMut(&Record)) -> bool {
        let mut any = false;
        while let Some(truth) = self.next(force) {
            record(&Record { truth: &truth, axes: &self.seen, machine: &self.machine });
            self.ended |= truth.measurement.last != 0;
            self.late_answers = truth.late_answers;
            any = true;
        }
        any
    }

    /// The oldest truth, when all that belongs to it has come: a status of its cycle, or a later one because
    /// it was lost, of every axis, and of the interpolator at its ticks.
    fn next(&mut self, force: bool) -> Option<Truth> {
        let cycle = self.truths.waiting.front()?.cycle;
        let tick = cycle.0.is_multiple_of(self.cycles_per_tick);
        let statuses = self.axes.iter().all(|(_, source)| source.has(|status| status.cycle >= cycle));
        let complete = statuses && (!tick || self.ticks.has(|status| status.cycle >= cycle));
        let lost = self.oldest.is_some_and(|oldest| self.truths.newest > cycle.0 + oldest);
        if !complete && !lost && !force {
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

    /// Who has said nothing for so long that it must have died or hang, in real time.
    pub(crate) fn silent(&self) -> Option<Process> {
        let oldest = self.oldest?;
        let silent = |silence: Silence, gone: bool| !gone && silence.truths > oldest;
        let axes = self.axes.iter().find(|(_, source)| silent(source.silence, source.gone));
        let interpolator = silent(self.ticks.silence, self.ticks.gone);
        axes.map(|(axis, _)| Process::Regulator(*axis)).or(interpolator.then_some(Process::Interpolator))
    }

    /// Takes what a process that has died had said before.
    pub(crate) fn last_words(&mut self, process: Process) -> Result<(), CliError> {
        if process == Process::Interpolator {
            self.ticks.drain(|status| status.cycle.0, |_| {})?;
        }
        for (_, source) in self.axes.iter_mut().filter(|(axis, _)| process == Process::Regulator(*axis)) {
            source.drain(|status| status.cycle.0, |_| {})?;
        }
        Ok(())
    }

    /// The first control cycle that a process has not answered.
    pub(crate) fn unanswered(&self, process: Process) -> u64 {
        let axis = |axis| self.axes.iter().find(|(other, _)| *other == axis);
        match process {
            Process::Regulator(of) => axis(of).map_or(0, |(_, source)| source.newest + 1),
            // What came of it can be there before its next tick.
            Process::Interpolator => (self.ticks.newest + self.cycles_per_tick).min(self.truths.newest),
            Process::Plant => self.truths.newest + 1,
            Process::Interpreter | Process::Launcher => self.truths.newest,
        }
    }

    /// Answers that came after their cycle, in real time.
    pub(crate) fn late_answers(&self) -> u64 {
        self.late_answers
    }

    /// Does something at the panel. A plant that has just died, or hangs, hears nothing of it: that is seen
    /// elsewhere.
    pub(crate) fn operate(&mut self, request: Request) -> Result<(), CliError> {
        match self.operator.send(&OperatorRequest::pack(self.requests, request)) {
            Ok(()) | Err(Undelivered::Full(_) | Undelivered::Receivers { .. }) => {}
            Err(broken) => return Err(IpcError::from(broken).into()),
        }
        self.requests += 1;
        Ok(())
    }

    /// What went through the launcher's ends.
    pub(crate) fn counts(&self) -> Vec<ChannelCount> {
        let mut counts =
            vec![self.truths.receiver.count(), self.ticks.receiver.count(), self.operator.count()];
        counts.push(self.arrivals.count());
        counts.extend(self.axes.iter().map(|(_, source)| source.receiver.count()));
        counts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truths that came in a row of looks, each with what the source had said by then.
    fn silent_for(looks: &[(usize, usize)]) -> u64 {
        let mut silence = Silence::default();
        looks.iter().for_each(|(truths, messages)| silence.look(*truths, *messages));
        silence.truths
    }

    /// The launcher stands between two queues: it takes the statuses that came meanwhile with the look that
    /// began before it stood, and the truths with the next one. Then the source waits for the next
    /// measurement, or with its last word: it is not silent.
    #[test]
    fn a_launcher_that_stood_between_two_queues_takes_nobody_for_silent() {
        assert_eq!(silent_for(&[(1, 1), (1, 1024), (1024, 0)]), 0);
        assert_eq!(silent_for(&[(1, 1), (1, 1024), (1024, 0), (1, 0), (1, 1)]), 0);
    }

    #[test]
    fn whoever_says_nothing_while_the_plant_goes_on_is_silent() {
        assert_eq!(silent_for(&[(1, 1), (3, 0), (100, 0), (151, 0)]), 251);
        assert_eq!(silent_for(&[(0, 0), (1024, 0)]), 1024);
        assert_eq!(silent_for(&[(1, 0), (1024, 0), (1, 1)]), 0);
    }
}
