//! The process of the interpolator: receive, tick, send.

use std::time::Duration;

use protocol::{
    Axis, AxisFrame, AxisStatus, CodePacket, Credit, Cycle, Input, MachineStatus, Measurement, PerAxis,
    SpindleCommand, Taken, units::AXES,
};

use crate::{
    ipc::{IpcError, Member, Patience, Port, Process, Receiver, Sender, Waker, channel, time::Moment},
    shell::{Clock, Ledger, Notes, POLL, ProcessArgs, START_S, ShellError, Wait, deliver, record},
};

use interpolator::{In, Interpolator, Out};

/// The ports to one regulator.
struct ToAxis {
    axis: Axis,
    frames: Sender<AxisFrame>,
    statuses: Receiver<AxisStatus>,
    /// A status behind a gap that came before its tick.
    early: Option<AxisStatus>,
    regulator: Waker,
    /// Cycle of the latest status, if any has come.
    newest: Option<u64>,
}

impl ToAxis {
    fn open(member: &Member, axis: Axis, patience: Patience) -> Result<ToAxis, IpcError> {
        Ok(ToAxis {
            axis,
            frames: member.sender(channel::AXIS_COMMAND.of(axis), patience)?,
            statuses: member.receiver(channel::AXIS_STATUS.of(axis))?,
            early: None,
            regulator: member.waker(Process::Regulator(axis))?,
            newest: None,
        })
    }

    /// Makes room: a status that waits for a recorder that stands is sent here again each time.
    fn drain(&mut self) -> Result<(), IpcError> {
        while self.statuses.receive()?.is_some() {}
        Ok(())
    }
}

/// The ports to the interpreter.
struct ToInterpreter {
    code: Receiver<CodePacket>,
    credit: Sender<Credit>,
    interpreter: Waker,
    /// For code, while the interpolator does something else.
    hungry: Wait,
    /// It was given up in this tick.
    lost: bool,
}

impl ToInterpreter {
    fn open(member: &Member, patience: Patience) -> Result<ToInterpreter, IpcError> {
        Ok(ToInterpreter {
            code: member.receiver(channel::MACHINE_CODE)?,
            credit: member.sender(channel::CREDIT, patience)?,
            interpreter: member.waker(Process::Interpreter)?,
            hungry: Wait::on(Process::Interpreter),
            lost: false,
        })
    }

    fn ports(&self) -> [&dyn Port; 3] {
        [&self.code, &self.credit, &self.interpreter]
    }
}

/// Runs the interpolator until the machine may be switched off.
///
/// # Errors
/// [`ShellError`] if the other processes cannot be reached.
pub fn run(args: &ProcessArgs) -> Result<(), ShellError> {
    let machine = args.read_machine()?;
    let mut member = args.join(Process::Interpolator)?;
    let patience = args.patience(&machine);
    let mut measurements = member.receiver(channel::TICK_MEASUREMENT)?;
    let mut spindle = member.sender(channel::SPINDLE_COMMAND, patience)?;
    let mut status = member.sender(channel::MACHINE_STATUS, args.recorded())?;
    let mut source = ToInterpreter::open(&member, patience)?;
    let axes = machine.axes().map(|(axis, _)| ToAxis::open(&member, axis, patience));
    let mut axes = axes.collect::<Result<Vec<_>, _>>()?;
    let plant = member.waker(Process::Plant)?;
    let inputs = axes.iter().map(|to| Input::Status(to.axis)).chain([Input::Code]);
    let mut notes = Notes::open(&member, args, inputs)?;
    let mut ports: Vec<&dyn Port> = vec![&measurements, &spindle, &status, &plant, notes.port()];
    ports.extend(source.ports());
    ports.extend(axes.iter().flat_map(|to| [&to.frames as &dyn Port, &to.statuses, &to.regulator]));
    member.connect(&ports, Moment::in_s(START_S))?;
    let _set_up = args.set_up(Process::Interpolator)?;
    member.stand_by()?;
    member.begin()?;

    let mut interpolator = Interpolator::new(&machine);
    let mut ledger = Ledger::default();
    let mut statuses: PerAxis<AxisStatus> = [AxisStatus::default(); AXES];
    let (mut finished, mut expected) = (false, 0);
    let mut wait = Wait::on(Process::Plant);
    // Its deadline is the next tick: until shortly before that nothing comes.
    let (tick, mut next_tick) =
        (Duration::from_secs_f64(machine.general.interpolator_cycle_s), Moment::now());
    let enough = args.clock == Clock::Real || machine.cycles_per_tick() > 1;
    while !finished && !wait.is_in_vain(&mut member) {
        let Some(measurement) = measurements.receive()?.filter(Measurement::is_whole) else {
            match args.clock {
                Clock::Virtual => wait.sleep(&mut member, args.clock)?,
                Clock::Real => wait.sleep_until(&mut member, next_tick)?,
            }
            continue;
        };
        wait = Wait::on(Process::Plant);
        next_tick = Moment::now().after(tick.saturating_sub(POLL));
        let now = measurement.cycle.0;
        let begun = Moment::now();
        notes.gap(Input::TickMeasurement, now, expected)?;
        let missed = now.saturating_sub(expected) / machine.cycles_per_tick();
        expected = now + machine.cycles_per_tick();
        take_statuses(&mut member, &mut axes, args.clock, &measurement, &mut statuses, &mut notes)?;
        let taken = take_code(&mut member, &mut interpolator, &mut source, args.clock)?;
        notes.note(now, Input::Code, taken, None)?;
        if std::mem::take(&mut source.lost) {
            notes.tell(now, Input::Lost, Taken::Nothing)?;
        }
        let was_finished = interpolator.finished();
        let input = In { measurement: &measurement, axes: &statuses };
        let Some(out) = interpolator.tick(&input) else { continue };
        // The tick after the one that says "finished" is the last: its predecessor is in force then. Where
        // each control cycle has a tick, lock step has one behind that.
        finished = measurement.last != 0 || was_finished && enough;
        send(&mut axes, &mut spindle, &plant, &mut status, &out, (args.clock, finished))?;
        ledger.note_taken(now, begun.elapsed(), missed);
    }
    args.tell(&ledger, "frame");
    notes.finish()?;
    deliver(&mut source.credit, &Credit::ENOUGH)?;
    source.interpreter.wake()?;
    let mut counts = vec![measurements.count(), spindle.count(), status.count()];
    counts.extend([source.code.count(), source.credit.count(), notes.count()]);
    counts.extend(axes.iter().flat_map(|to| [to.frames.count(), to.statuses.count()]));
    Ok(member.finish_and(&counts, || axes.iter_mut().try_for_each(ToAxis::drain))?)
}

/// Sends what a tick says and commands. In real time nobody is woken, since all look by themselves; a last
/// word waits for a recorder that stands, and nobody else for it.
fn send(
    axes: &mut [ToAxis],
    spindle: &mut Sender<SpindleCommand>,
    plant: &Waker,
    status: &mut Sender<MachineStatus>,
    out: &Out,
    (clock, finished): (Clock, bool),
) -> Result<(), ShellError> {
    let waits = finished && clock == Clock::Real;
    if !waits {
        record(status, &out.status, false)?;
    }
    for to in axes {
        deliver(&mut to.frames, &out.frames[to.axis.index()])?;
        if clock == Clock::Virtual {
            to.regulator.wake()?;
        }
    }
    deliver(spindle, &out.spindle)?;
    if clock == Clock::Virtual {
        plant.wake()?;
    }
    if waits { record(status, &out.status, true) } else { Ok(()) }
}

/// The statuses of all axes.
fn take_statuses(
    member: &mut Member,
    axes: &mut [ToAxis],
    clock: Clock,
    measurement: &Measurement,
    statuses: &mut PerAxis<AxisStatus>,
    notes: &mut Notes,
) -> Result<(), ShellError> {
    let (mut since, now) = (None, measurement.cycle.0);
    for to in axes {
        let latest = &mut statuses[to.axis.index()];
        since = take_status(member, to, clock, measurement, latest, since)?;
        notes.note(now, Input::Status(to.axis), to.newest, now.checked_sub(1))?;
    }
    Ok(())
}

/// The status of the cycle before the tick. It was sent before that cycle's command to the drive, so in lock
/// step it is there; in real time the newest one up to it counts, and later ones wait for the next tick.
/// Since when it was waited for, if it was.
fn take_status(
    member: &mut Member,
    to: &mut ToAxis,
    clock: Clock,
    measurement: &Measurement,
    latest: &mut AxisStatus,
    since: Option<Moment>,
) -> Result<Option<Moment>, ShellError> {
    if measurement.cycle == Cycle(0) {
        return Ok(None);
    }
    let wanted = Cycle(measurement.cycle.0 - 1);
    let mut wait = Wait::on(Process::Regulator(to.axis)).after(since);
    loop {
        let status = match to.early.take() {
            Some(status) => Some(status),
            None => to.statuses.receive()?,
        };
        match status {
            Some(status) if status.cycle > wanted => {
                to.early = Some(status);
                return Ok(wait.since());
            }
            Some(status) => {
                *latest = status;
                to.newest = Some(status.cycle.0);
                if status.cycle == wanted {
                    return Ok(wait.since());
                }
            }
            None if clock == Clock::Real || wait.is_in_vain(member) => return Ok(wait.since()),
            None => wait.sleep(member, clock)?,
        }
    }
}

/// Takes machine code and gives credit. In lock step until the queue is full or the program has ended, so
/// that nothing depends on how fast the interpreter is. How many packets were taken, if more were wanted.
fn take_code(
    member: &mut Member,
    interpolator: &mut Interpolator,
    source: &mut ToInterpreter,
    clock: Clock,
) -> Result<Option<u64>, ShellError> {
    let (mut taken, mut all, mut wanting) = (0, 0, false);
    while interpolator.wants() {
        if let Some(packet) = source.code.receive()? {
            // A refused packet is a fault of the machine; the next tick says so.
            let _ = interpolator.push(&packet);
            (taken, all) = (taken + 1, all + 1);
            source.hungry = Wait::on(Process::Interpreter);
            continue;
        }
        if taken > 0 {
            give_credit(interpolator, source)?;
            taken = 0;
        }
        if source.hungry.is_in_vain(member) {
            interpolator.lost_source();
            (source.lost, wanting) = (true, true);
        }
        if !interpolator.wants() {
            break;
        }
        if clock == Clock::Real {
            source.hungry.go_on(member)?;
            wanting = true;
            break;
        }
        source.hungry.sleep(member, clock)?;
    }
    if taken > 0 {
        give_credit(interpolator, source)?;
    }
    Ok(wanting.then_some(all))
}

fn give_credit(interpolator: &Interpolator, source: &mut ToInterpreter) -> Result<(), ShellError> {
    deliver(&mut source.credit, &Credit { taken: interpolator.received() })?;
    Ok(source.interpreter.wake()?)
}
