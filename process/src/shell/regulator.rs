//! The process of one regulator: receive, tick, send.

use protocol::{Axis, AxisFrame, Cycle, Input, Measurement};

use crate::{
    ipc::{Member, Port, Process, Receiver, channel, time::Moment},
    shell::{Clock, Notes, ProcessArgs, START_S, ShellError, Wait, deliver, record},
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
    let axis = *axis;
    let machine = args.read_machine()?;
    if !machine.axis.contains_key(&axis) {
        return Err(ShellError::Input(format!("the machine has no axis {axis}")));
    }
    let mut member = args.join(Process::Regulator(axis))?;
    let patience = args.patience(&machine);
    let mut measurements = member.receiver(channel::MEASUREMENT)?;
    let mut frames = Frames {
        receiver: member.receiver(channel::AXIS_COMMAND.of(axis))?,
        next: None,
        cycles_per_tick: machine.cycles_per_tick(),
    };
    let mut drive = member.sender(channel::DRIVE_COMMAND.of(axis), patience)?;
    let mut status = member.sender(channel::AXIS_STATUS.of(axis), args.recorded())?;
    let plant = member.waker(Process::Plant)?;
    let [of_measurement, of_frame] = [Input::Measurement(axis), Input::Frame(axis)];
    let mut notes = Notes::open(&member, args, [of_frame])?;
    let ports: [&dyn Port; 6] = [&measurements, &frames.receiver, &drive, &status, &plant, notes.port()];
    member.start(&ports, Moment::in_s(START_S))?;

    let mut regulator = Regulator::new(&machine, axis);
    let mut expected = 0;
    let mut wait = Wait::on(Process::Plant);
    while !wait.is_in_vain(&mut member) {
        let Some(measurement) = measurements.receive()?.filter(Measurement::is_whole) else {
            wait.sleep(&mut member, args.clock)?;
            continue;
        };
        wait = Wait::on(Process::Plant);
        let frame = frames.due(&mut member, args.clock, &measurement)?;
        let now = measurement.cycle.0;
        notes.gap(of_measurement, now, expected)?;
        expected = now + 1;
        notes.note(now, of_frame, frame.map(|frame| frame.cycle.0), frames.tick_before(measurement.cycle))?;
        let out = regulator.tick(&In { measurement: &measurement, frame: frame.as_ref() });
        // In lock step the status goes first, so that it is there at the next tick of the interpolator. In
        // real time the command does, which alone has a deadline.
        if args.clock == Clock::Virtual {
            deliver(&mut status, &out.status)?;
        }
        deliver(&mut drive, &out.drive)?;
        plant.wake()?;
        let last = measurement.last != 0;
        if args.clock == Clock::Real {
            record(&mut status, &out.status, last)?;
        }
        if last {
            break;
        }
    }
    notes.finish()?;
    let counts = [measurements.count(), frames.receiver.count(), drive.count(), status.count()];
    Ok(member.finish(&[counts.as_slice(), &[notes.count()]].concat())?)
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
            self.next = match self.next.take() {
                Some(frame) if frame.cycle.after(self.cycles_per_tick) <= cycle => return Ok(Some(frame)),
                Some(frame) => Some(frame),
                None => self.receiver.receive()?,
            };
            let patient = clock == Clock::Virtual && !wait.is_in_vain(member);
            match (&self.next, patient) {
                (Some(frame), _) if frame.cycle.after(self.cycles_per_tick) <= cycle => {}
                (None, true) => wait.sleep(member, clock)?,
                _ => return Ok(None),
            }
        }
    }
}
