//! The process of one regulator: receive, tick, send.

use machine::Machine;
use protocol::{Axis, AxisCommand, AxisFrame, AxisStatus, Cycle, DriveCommand, Input, Measurement, Setpoint};

use crate::{
    ipc::{ChannelCount, IpcError, Member, Process, Receiver, Sender, Waker, channel, time::Moment},
    shell::{Clock, Ledger, Notes, ProcessArgs, START_S, ShellError, Wait, deliver, record},
};

use regulator::{In, Regulator};

/// Arguments of a regulator.
#[derive(Clone, Debug, clap::Args)]
pub struct RegulatorArgs {
    /// Its axis: x, z …
    #[arg(long, value_name = "AXIS", value_parser = axis)]
    pub axis: Axis,
    /// What every process needs.
    #[command(flatten)]
    pub process: ProcessArgs,
}

fn axis(name: &str) -> Result<Axis, String> {
    Axis::from_name(name).ok_or_else(|| "an axis is one of x y z a b c u v".into())
}

/// Runs a regulator until the last measurement, or the death of the plant.
///
/// # Errors
/// [`ShellError`] if the machine has no such axis, or the other processes cannot be reached.
pub fn run(args: &RegulatorArgs) -> Result<(), ShellError> {
    let RegulatorArgs { axis, process: args } = args;
    let machine = args.read_machine()?;
    if !machine.axis.contains_key(axis) {
        return Err(ShellError::Input(format!("the machine has no axis {axis}")));
    }
    let mut own = Shell::open(args.join(Process::Regulator(*axis))?, args, &machine, *axis)?;
    own.connect(Moment::in_s(START_S))?;
    let _set_up = args.set_up(Process::Regulator(*axis))?;
    own.member.stand_by()?;
    own.member.begin()?;
    let mut wait = Wait::on(Process::Plant);
    let mut ledger = Ledger::default();
    while !wait.is_in_vain(&mut own.member) {
        let (begun, expected) = (Moment::now(), own.expected);
        let Some(Answered { last }) = own.answer()? else {
            wait.sleep(&mut own.member, args.clock)?;
            continue;
        };
        let missed = own.expected.saturating_sub(expected + 1);
        ledger.note_taken(own.expected.saturating_sub(1), begun.elapsed(), missed);
        if last {
            break;
        }
        wait = Wait::on(Process::Plant);
    }
    args.tell(&ledger, "answer");
    let counts = own.counts()?;
    Ok(own.member.finish(&counts)?)
}

/// A measurement has been answered.
pub(super) struct Answered {
    /// It was the last one.
    last: bool,
}

/// A regulator with its ports. It has a process of its own, or lives in that of the plant, which then has it
/// answer what it has published.
pub(super) struct Shell {
    pub(super) member: Member,
    clock: Clock,
    measurements: Receiver<Measurement>,
    frames: Frames,
    drive: Sender<DriveCommand>,
    status: Sender<AxisStatus>,
    plant: Waker,
    notes: Notes,
    inputs: [Input; 2],
    regulator: Regulator,
    /// Cycle of the measurement that comes next.
    expected: u64,
}

impl Shell {
    pub(super) fn open(
        member: Member,
        args: &ProcessArgs,
        machine: &Machine,
        axis: Axis,
    ) -> Result<Shell, ShellError> {
        let frames = member.receiver(channel::AXIS_COMMAND.of(axis))?;
        let inputs = [Input::Measurement(axis), Input::Frame(axis)];
        Ok(Shell {
            clock: args.clock,
            measurements: member.receiver(channel::MEASUREMENT)?,
            frames: Frames { receiver: frames, next: None, cycles_per_tick: machine.cycles_per_tick() },
            drive: member.sender(channel::DRIVE_COMMAND.of(axis), args.patience(machine))?,
            status: member.sender(channel::AXIS_STATUS.of(axis), args.recorded())?,
            plant: member.waker(Process::Plant)?,
            notes: Notes::open(&member, args, [inputs[1]])?,
            member,
            inputs,
            regulator: Regulator::new(machine, axis),
            expected: 0,
        })
    }

    /// Waits until all ports have found their other ends.
    pub(super) fn connect(&mut self, deadline: Moment) -> Result<(), IpcError> {
        let Shell { member, measurements, frames, drive, status, plant, notes, .. } = self;
        member.connect(&[measurements, &frames.receiver, drive, status, plant, notes.port()], deadline)
    }

    /// Answers the oldest measurement that waits, if one does.
    pub(super) fn answer(&mut self) -> Result<Option<Answered>, ShellError> {
        let Some(measurement) = self.measurements.receive()?.filter(Measurement::is_whole) else {
            return Ok(None);
        };
        let Shell { member, clock, frames, drive, status, plant, notes, .. } = self;
        let frame = frames.due(member, *clock, &measurement)?;
        let (now, [of_measurement, of_frame]) = (measurement.cycle.0, self.inputs);
        notes.gap(of_measurement, now, self.expected)?;
        self.expected = now + 1;
        notes.note(now, of_frame, frame.map(|frame| frame.cycle.0), frames.tick_before(measurement.cycle))?;
        let out = self.regulator.tick(&In { measurement: &measurement, frame: frame.as_ref() });
        let last = measurement.last != 0;
        match clock {
            // The status goes first, so that it is there at the next tick of the interpolator.
            Clock::Virtual => {
                deliver(status, &out.status)?;
                deliver(drive, &out.drive)?;
                plant.wake()?;
            }
            // The command does, which alone has a deadline. Nobody sleeps for it.
            Clock::Real => {
                deliver(drive, &out.drive)?;
                record(status, &out.status, last)?;
            }
        }
        Ok(Some(Answered { last }))
    }

    /// The last word to the recorder, and what went through all ports.
    pub(super) fn counts(&mut self) -> Result<Vec<ChannelCount>, ShellError> {
        self.notes.finish()?;
        let Shell { measurements, frames, drive, status, notes, .. } = self;
        Ok(vec![measurements.count(), frames.receiver.count(), drive.count(), status.count(), notes.count()])
    }
}

/// Frames that have come and those in force.
struct Frames {
    receiver: Receiver<AxisFrame>,
    next: Option<AxisFrame>,
    cycles_per_tick: u64,
}

impl Frames {
    /// The tick that made the frame which takes effect in a cycle, if one does.
    fn tick_before(&self, Cycle(cycle): Cycle) -> Option<u64> {
        cycle.checked_sub(self.cycles_per_tick).filter(|_| cycle.is_multiple_of(self.cycles_per_tick))
    }

    /// The frame that takes effect with this measurement: one interpolator cycle after the tick that made it.
    /// In lock step it is waited for, because it is on its way; in real time one that is late takes effect
    /// when it comes.
    fn due(
        &mut self,
        member: &mut Member,
        clock: Clock,
        measurement: &Measurement,
    ) -> Result<Option<AxisFrame>, ShellError> {
        let cycle = measurement.cycle;
        if clock == Clock::Virtual && self.tick_before(cycle).is_none() {
            return Ok(None);
        }
        let mut wait = Wait::on(Process::Interpolator);
        loop {
            let by = cycle.0.checked_sub(self.cycles_per_tick).map(Cycle);
            let frame = due_by(by, &mut self.next, || self.receiver.receive())?;
            if frame.is_some() || self.next.is_some() || clock == Clock::Real || wait.is_in_vain(member) {
                return Ok(frame);
            }
            wait.sleep(member, clock)?;
        }
    }
}

/// The first frame of those made by then; a later one stays in `next`. One that was late once makes no other
/// one late for ever: at rest, where the next one says the same, it is left out. Until then nothing is, since
/// an order may stand in one frame alone, and a setpoint of a motion does.
fn due_by<E>(
    by: Option<Cycle>,
    next: &mut Option<AxisFrame>,
    mut receive: impl FnMut() -> Result<Option<AxisFrame>, E>,
) -> Result<Option<AxisFrame>, E> {
    let mut due: Option<AxisFrame> = None;
    loop {
        *next = match next.take() {
            Some(frame) => Some(frame),
            None => receive()?,
        };
        let Some(frame) = next.filter(|frame| Some(frame.cycle) <= by) else { return Ok(due) };
        if due.is_some_and(|due| !says_the_same(&due, &frame)) {
            return Ok(due);
        }
        due = next.take();
    }
}

/// Whether a frame leaves an axis that rests as the one before does.
fn says_the_same(before: &AxisFrame, frame: &AxisFrame) -> bool {
    let rests = |frame: &AxisFrame| {
        let Setpoint { velocity_mm_s, acceleration_mm_s2, .. } = frame.setpoint;
        let leads = matches!(frame.unpack(), Ok(AxisCommand::Stream | AxisCommand::Hold));
        leads && velocity_mm_s == 0.0 && acceleration_mm_s2 == 0.0
    };
    let same = (before.command, before.setpoint.position) == (frame.command, frame.setpoint.position);
    same && rests(before) && rests(frame)
}

#[cfg(test)]
mod tests {
    use std::{collections::VecDeque, convert::Infallible};

    use protocol::Position;

    use super::*;

    /// A frame of a tick: its command, where it leads and how fast.
    fn frame(tick: u64, command: &AxisCommand, mm: f64, velocity_mm_s: f64) -> AxisFrame {
        let position = Position::from_mm(mm);
        let setpoint = Setpoint { cycle: Cycle(tick + 3), position, velocity_mm_s, ..Setpoint::default() };
        AxisFrame::pack(Cycle(tick), 1, setpoint, 0.0, command)
    }

    /// The ticks of the frames that are taken cycle by cycle, each frame coming in a cycle of its own.
    fn taken(frames: &[(u64, AxisFrame)], cycles: std::ops::Range<u64>) -> Vec<Option<u64>> {
        let (mut queue, mut next) = (VecDeque::new(), None);
        cycles
            .map(|cycle| {
                queue.extend(frames.iter().filter(|(comes, _)| *comes == cycle).map(|(_, frame)| *frame));
                let receive = || Ok::<_, Infallible>(queue.pop_front());
                let Ok(frame) = due_by(cycle.checked_sub(1).map(Cycle), &mut next, receive);
                frame.map(|frame| frame.cycle.0)
            })
            .collect()
    }

    /// Frames of the ticks 0 to 7, that of tick 2 a cycle late.
    fn one_is_late(frame: impl Fn(u64) -> AxisFrame) -> Vec<Option<u64>> {
        let comes = |tick| tick + 1 + u64::from(tick == 2);
        let frames: Vec<_> = (0..8).map(|tick| (comes(tick), frame(tick))).collect();
        taken(&frames, 1..9)
    }

    #[test]
    fn at_rest_a_frame_that_is_late_makes_no_other_one_late() {
        let rests = |tick| frame(tick, &AxisCommand::Stream, 5.0, 0.0);
        let caught_up = [Some(0), Some(1), None, Some(3), Some(4), Some(5), Some(6), Some(7)];
        assert_eq!(one_is_late(rests), caught_up);
    }

    #[test]
    fn no_setpoint_of_a_motion_and_no_order_is_left_out() {
        let all = [Some(0), Some(1), None, Some(2), Some(3), Some(4), Some(5), Some(6)];
        assert_eq!(one_is_late(|tick| frame(tick, &AxisCommand::Stream, 0.5 * tick as f64, 1.0)), all);
        assert_eq!(one_is_late(|tick| frame(tick, &AxisCommand::Stream, 5.0, 1.0)), all);
        assert_eq!(one_is_late(|tick| frame(tick, &AxisCommand::CallOff, 5.0, 0.0)), all);
        // It comes late with an order, and what rests behind it is caught up with.
        let ordered = |tick| match tick {
            2 => frame(tick, &AxisCommand::CallOff, 5.0, 0.0),
            _ => frame(tick, &AxisCommand::Hold, 5.0, 0.0),
        };
        let behind = [Some(0), Some(1), None, Some(2), Some(4), Some(5), Some(6), Some(7)];
        assert_eq!(one_is_late(ordered), behind);
        // One that moves to where the next one rests.
        let stops = |tick| frame(tick, &AxisCommand::Stream, 5.0, if tick < 3 { 1.0 } else { 0.0 });
        let behind = [Some(0), Some(1), None, Some(2), Some(4), Some(5), Some(6), Some(7)];
        assert_eq!(one_is_late(stops), behind);
    }
}
