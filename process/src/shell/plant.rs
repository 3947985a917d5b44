//! The process of the plant: it beats the time of the machine.
//!
//! In lock step a cycle lasts until every drive has its command; in real time until the next moment of the
//! clock, and what has not come by then is a late answer: the drive holds the command before, and trips at
//! the third in a row.

use std::path::PathBuf;

use machine::{Machine, SpindleConfig};
use protocol::{
    Axis, Cycle, DriveCommand, Input, Measurement, PerAxis, SpindleCommand, Taken, Truth,
    operator::{OperatorRequest, Request},
    units::AXES,
};

use crate::{
    ipc::{
        ChannelCount, IpcError, Member, Port, Process, Receiver, Sender, Waker, channel, is_orphan,
        time::{Moment, lock_memory},
    },
    shell::{
        Beat, Clock, Notes, Pace, ProcessArgs, START_S, ShellError, Wait, deliver, read_text, record,
        spindle::SpindleCommands,
    },
};

use sim_plant::{Plant, Scenario};

/// Arguments of the plant.
#[derive(Clone, Debug, clap::Args)]
pub struct PlantArgs {
    /// What every process needs.
    #[command(flatten)]
    pub process: ProcessArgs,
    /// What happens to the machine (TOML).
    #[arg(long, value_name = "FILE")]
    pub scenario: Option<PathBuf>,
    /// Seed of everything random: encoder phases, spindle ripple.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Time on the machine for each second on the wall, or max.
    #[arg(long, default_value_t)]
    pub pace: Pace,
    /// In these control cycles nothing goes on before the launcher says so: it kills or stops somebody.
    #[arg(long, value_name = "CYCLE", hide = true)]
    pub stand_at: Vec<u64>,
}

/// The ports to one regulator.
struct FromAxis {
    axis: Axis,
    commands: Receiver<DriveCommand>,
    regulator: Waker,
    late: Late,
    /// Cycle of the command that the drive follows, if any has come.
    newest: Option<u64>,
}

/// Answers that were not there when they were due.
#[derive(Default)]
struct Late {
    all: u64,
    in_row: u64,
    most_in_row: u64,
}

impl Late {
    fn note(&mut self, late: bool) {
        self.all += u64::from(late);
        self.in_row = if late { self.in_row + 1 } else { 0 };
        self.most_in_row = self.most_in_row.max(self.in_row);
    }
}

impl FromAxis {
    fn open(member: &Member, axis: Axis) -> Result<FromAxis, IpcError> {
        Ok(FromAxis {
            axis,
            commands: member.receiver(channel::DRIVE_COMMAND.of(axis))?,
            regulator: member.waker(Process::Regulator(axis))?,
            late: Late::default(),
            newest: None,
        })
    }

    fn count(&self) -> ChannelCount {
        ChannelCount { late: self.late.all, late_in_row: self.late.most_in_row, ..self.commands.count() }
    }
}

/// Runs the plant until the machine is switched off.
///
/// # Errors
/// [`ShellError`] if machine file or scenario are wrong, or the other processes cannot be reached.
pub fn run(args: &PlantArgs) -> Result<(), ShellError> {
    let machine = args.process.read_machine()?;
    let clock = args.process.clock;
    let mut plant = plant(args, &machine)?;

    let mut member = args.process.join(Process::Plant)?;
    let mut ports = Ports::open(&member, &machine, &args.process)?;
    member.start(&ports.all(), Moment::in_s(START_S))?;
    if clock == Clock::Real
        && let Err(error) = lock_memory()
    {
        tracing::warn!(%error, "memory is not locked");
    }

    let mut beat = Beat::new(clock, args.pace, machine.general.cycle_s);
    let mut drives: PerAxis<DriveCommand> = [DriveCommand::default(); AXES];
    let mut in_force = SpindleCommand::default();
    let mut refused = 0;
    let mut forsaken = Forsaken::new(&machine);
    loop {
        let measurement = plant.measurement().sealed();
        let now = measurement.cycle.0;
        let tick = machine.is_tick(measurement.cycle);
        let doomed = plant.truth().doom().is_some() || args.stand_at.contains(&measurement.cycle.0);
        ports.tell(plant.truth(), doomed)?;
        if doomed && clock == Clock::Virtual {
            member.stand()?;
        }
        ports.publish(&measurement, tick)?;
        beat.wait();
        if beat.is_real() {
            // Nobody sleeps for an event, so the launcher is heard here.
            member.look()?;
        }
        let mut since = None;
        for from in &mut ports.axes {
            let command = &mut drives[from.axis.index()];
            since = take_command(&mut member, from, clock, &measurement, command, since)?;
            ports.notes.note(now, Input::Drive(from.axis), from.newest, Some(now))?;
            let late = command.cycle < measurement.cycle;
            from.late.note(late);
            if late {
                plant.note_late();
            }
        }
        if tick && measurement.cycle > Cycle(0) {
            let taken = ports.spindle.take(&mut member, clock, measurement.cycle, &mut in_force)?;
            let due = now.checked_sub(machine.cycles_per_tick());
            ports.notes.note(now, Input::Spindle, taken, due)?;
        }
        if measurement.last != 0 {
            break;
        }
        let mut request = ports.request(now, &mut refused)?;
        if is_orphan() {
            request = forsaken.asks(plant.truth()).or(request);
        }
        if member.is_to_quit() || forsaken.is_over() {
            let finished = SpindleCommand::FINISHED;
            in_force = SpindleCommand { finished, line: in_force.line, ..SpindleCommand::default() };
        }
        plant.tick(&drives, &in_force, request);
    }
    forsaken.tell(plant.truth().cycle);
    ports.notes.finish()?;
    Ok(member.finish(&ports.counts())?)
}

/// The plant, and what happens to it.
fn plant(args: &PlantArgs, machine: &Machine) -> Result<Plant, ShellError> {
    let scenario = match &args.scenario {
        None => Scenario::none(),
        Some(path) => Scenario::from_toml(&read_text(path)?)
            .map_err(|error| ShellError::Input(format!("{}: {error}", path.display())))?,
    };
    let plant = Plant::new(machine, scenario, args.seed);
    plant.map_err(|error| ShellError::Input(format!("machine file: {error}")))
}

/// What the operator asks for; what cannot be unpacked is counted and said.
fn understood(packet: &OperatorRequest, refused: &mut u64) -> Option<Request> {
    let request = packet.unpack();
    if let Err(reason) = request {
        *refused += 1;
        tracing::warn!(%reason, refused = *refused, "a request of the operator was refused");
    }
    request.ok()
}

/// Every port of the plant.
struct Ports {
    measurements: Sender<Measurement>,
    ticks: Sender<Measurement>,
    truths: Sender<Truth>,
    spindle: SpindleCommands,
    operator: Receiver<OperatorRequest>,
    axes: Vec<FromAxis>,
    interpolator: Waker,
    recorder: Waker,
    notes: Notes,
}

impl Ports {
    fn open(member: &Member, machine: &Machine, args: &ProcessArgs) -> Result<Ports, IpcError> {
        let (patience, recorded) = (args.patience(machine), args.recorded());
        let axes = machine.axes().map(|(axis, _)| FromAxis::open(member, axis));
        let drives = machine.axes().map(|(axis, _)| Input::Drive(axis));
        Ok(Ports {
            notes: Notes::open(member, args, drives.chain([Input::Spindle]))?,
            measurements: member.sender(channel::MEASUREMENT, patience)?,
            ticks: member.sender(channel::TICK_MEASUREMENT, patience)?,
            truths: member.sender(channel::TRUTH, recorded)?,
            spindle: SpindleCommands::open(member, machine)?,
            operator: member.receiver(channel::OPERATOR)?,
            axes: axes.collect::<Result<_, _>>()?,
            interpolator: member.waker(Process::Interpolator)?,
            recorder: member.waker(Process::Launcher)?,
        })
    }

    fn all(&self) -> Vec<&dyn Port> {
        let mut ports: Vec<&dyn Port> = vec![&self.measurements, &self.ticks, &self.truths];
        ports.extend([self.spindle.port(), &self.operator, &self.interpolator, &self.recorder]);
        ports.push(self.notes.port());
        ports.extend(self.axes.iter().flat_map(|from| [&from.commands as &dyn Port, &from.regulator]));
        ports
    }

    fn counts(&self) -> Vec<ChannelCount> {
        let mut counts = vec![self.measurements.count(), self.ticks.count(), self.truths.count()];
        counts.extend([self.spindle.count(), self.operator.count(), self.notes.count()]);
        counts.extend(self.axes.iter().map(FromAxis::count));
        counts
    }

    /// What the operator asks for in this cycle.
    fn request(&mut self, now: u64, refused: &mut u64) -> Result<Option<Request>, ShellError> {
        let Some(packet) = self.operator.receive()? else { return Ok(None) };
        if packet.value != 0.0 {
            self.notes.tell(now, Input::OperatorValue, Taken::This(packet.value.to_bits()))?;
        }
        self.notes.tell(now, Input::Operator, Taken::This(packet.kind.into()))?;
        Ok(understood(&packet, refused))
    }

    /// Sends the truth to the recorder, which is woken now and then, and at once if it is wanted.
    fn tell(&mut self, truth: &Truth, wanted: bool) -> Result<(), ShellError> {
        let (cycle, last) = (truth.cycle.0, truth.measurement.last != 0);
        record(&mut self.truths, truth, last)?;
        if wanted || last || cycle.is_multiple_of(channel::RECORD_WAKE) {
            self.recorder.wake()?;
        }
        Ok(())
    }

    /// Sends what is measured to whoever needs it: the interpolator gets the last measurement even if there
    /// is no tick.
    fn publish(&mut self, measurement: &Measurement, tick: bool) -> Result<(), ShellError> {
        deliver(&mut self.measurements, measurement)?;
        self.axes.iter().try_for_each(|from| from.regulator.wake())?;
        if tick || measurement.last != 0 {
            deliver(&mut self.ticks, measurement)?;
            self.interpolator.wake()?;
        }
        Ok(())
    }
}

/// The launcher has gone: nobody records any more, nobody would end the machine. It is stopped like by an
/// emergency stop, and ends when it rests, or when it should have come to rest long ago.
struct Forsaken {
    cycles: u64,
    rests: u64,
    longest: u64,
}

/// That many control cycles in a row without motion are rest.
const REST_CYCLES: u64 = 20;

impl Forsaken {
    fn new(machine: &Machine) -> Forsaken {
        let ramp_s = machine.spindle.max_rpm / machine.spindle.ramp_rpm_s;
        let longest = ((3.0 * ramp_s + 10.0) / machine.general.cycle_s) as u64;
        Forsaken { cycles: 0, rests: 0, longest }
    }

    /// One control cycle without a launcher.
    fn asks(&mut self, truth: &Truth) -> Option<Request> {
        let stands = truth.axes.iter().all(|axis| axis.velocity_mm_s.abs() < 0.01);
        let stands = stands && truth.spindle_rpm.abs() < SpindleConfig::STANDSTILL_RPM;
        if self.cycles == 0 {
            tracing::warn!("the launcher has gone: emergency stop in cycle {}", truth.cycle.0);
        }
        self.cycles += 1;
        self.rests = if stands { self.rests + 1 } else { 0 };
        (self.cycles == 1).then_some(Request::EmergencyStop)
    }

    fn is_over(&self) -> bool {
        self.cycles > self.longest || self.rests > REST_CYCLES
    }

    /// Nobody but the log will know how it ended.
    fn tell(&self, now: Cycle) {
        match (self.cycles, self.rests) {
            (0, _) => {}
            (_, 0) => tracing::warn!("the machine has not come to rest by cycle {}", now.0),
            _ => tracing::warn!("the machine is at rest in cycle {}", now.0),
        }
    }
}

/// The answer of a regulator to this measurement; in real time what has come by now. Since when it was waited
/// for, if it was: all regulators got the measurement at the same time.
fn take_command(
    member: &mut Member,
    from: &mut FromAxis,
    clock: Clock,
    measurement: &Measurement,
    command: &mut DriveCommand,
    since: Option<Moment>,
) -> Result<Option<Moment>, ShellError> {
    let mut wait = Wait::on(Process::Regulator(from.axis)).after(since);
    loop {
        match from.commands.receive()?.filter(DriveCommand::is_whole) {
            Some(next) => {
                *command = next;
                from.newest = Some(next.cycle.0);
                if next.cycle >= measurement.cycle {
                    return Ok(wait.since());
                }
            }
            None if clock == Clock::Real || wait.is_in_vain(member) => return Ok(wait.since()),
            None => wait.sleep(member, clock)?,
        }
    }
}
