//! The process of the plant: it beats the time of the machine.
//!
//! In lock step a cycle lasts until every drive has its command; in real time until the next moment of the
//! clock, and what has not come by then is a late answer: the drive holds the command before, and tells the
//! third in a row to all regulators.
//!
//! In real time regulators may live in this process ([`Layout::Together`](crate::ipc::Layout)). They answer
//! as soon as something is measured, then the process sleeps to the end of the cycle: one wake-up per cycle.
//! A process that was held up finds that cycles have passed. The machine has not stood meanwhile: they are
//! made up for, their answers are late, nobody has seen what was measured in them.

use std::path::PathBuf;

use machine::Machine;
use protocol::{
    Axis, Cycle, DriveCommand, Input, Measurement, PerAxis, SpindleCommand, Taken, Truth,
    operator::{OperatorRequest, Request},
    units::AXES,
};

use crate::{
    ipc::{
        ChannelCount, IpcError, Member, Port, Process, Receiver, Sender, Waker, channel, is_orphan,
        real_time::SetUp, time::Moment,
    },
    shell::{
        Beat, Clock, Ledger, Missed, Notes, Pace, ProcessArgs, START_S, ShellError, Wait, deliver,
        forsaken::Forsaken, read_text, record, regulator, spindle::SpindleCommands,
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

/// Runs the plant until the machine is switched off, its regulators being elsewhere.
///
/// # Errors
/// [`ShellError`] if machine file or scenario are wrong, or the other processes cannot be reached.
pub fn run(args: &PlantArgs) -> Result<(), ShellError> {
    let machine = args.process.read_machine()?;
    let member = args.process.join(Process::Plant)?;
    let beat = |cycle_s| Beat::new(args.process.clock, args.pace, cycle_s);
    beats(args, &machine, member, Vec::new(), beat)
}

/// Runs the plant and all regulators in this process, in real time.
///
/// # Errors
/// [`ShellError`], as [`run`].
pub fn run_with_regulators(args: &PlantArgs) -> Result<(), ShellError> {
    if args.process.clock != Clock::Real {
        return Err(ShellError::Input("plant and regulators share a process in real time only".into()));
    }
    let machine = args.process.read_machine()?;
    let member = args.process.join(Process::Plant)?;
    let open = |(axis, _)| {
        let own = Member::join(&args.process.address, Process::Regulator(axis))?;
        regulator::Shell::open(own, &args.process, &machine, axis)
    };
    let regulators = machine.axes().map(open).collect::<Result<Vec<_>, _>>()?;
    beats(args, &machine, member, regulators, Beat::kept)
}

/// The machine from its start to its end. The regulators that live here answer what is published.
fn beats(
    args: &PlantArgs,
    machine: &Machine,
    mut member: Member,
    mut regulators: Vec<regulator::Shell>,
    beat: impl FnOnce(f64) -> Beat,
) -> Result<(), ShellError> {
    let clock = args.process.clock;
    let mut plant = plant(args, machine)?;
    let mut ports = Ports::open(&member, machine, &args.process)?;
    let _set_up = start(args, &mut member, &ports, &mut regulators)?;
    let mut beat = beat(machine.general.cycle_s);
    let (mut missed, mut ledger) = (Missed::default(), Ledger::default());
    let mut drives: PerAxis<DriveCommand> = [DriveCommand::default(); AXES];
    let mut in_force = SpindleCommand::default();
    let mut refused = 0;
    let mut forsaken = Forsaken::new(machine);
    loop {
        let measurement = plant.measurement().sealed();
        let now = measurement.cycle.0;
        let tick = machine.is_tick(measurement.cycle);
        let doomed = plant.truth().doom().is_some() || args.stand_at.contains(&measurement.cycle.0);
        ports.tell(plant.truth(), doomed)?;
        if doomed && clock == Clock::Virtual {
            member.stand()?;
        }
        if missed.cycles > 0 && measurement.last == 0 {
            missed.cycles -= 1;
            missed.answer = true;
        } else {
            ports.publish(&measurement, tick)?;
            for own in &mut regulators {
                while own.answer()?.is_some() {}
            }
            missed = beat.wait();
            ledger.note_slept(now, &missed);
        }
        if beat.is_real() {
            // Nobody sleeps for an event, so the launcher is heard here.
            member.look()?;
        }
        let late = ports.take_commands(&mut member, &measurement, &mut drives, missed.answer)?;
        (0..late).for_each(|_| plant.note_late());
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
    args.process.tell(&ledger, "answer");
    ports.notes.finish()?;
    for own in &mut regulators {
        let counts = own.counts()?;
        own.member.has_finished(&counts)?;
    }
    Ok(member.finish(&ports.counts())?)
}

/// Everybody in this process connects, sets it up, and waits until the machine begins.
fn start(
    args: &PlantArgs,
    member: &mut Member,
    ports: &Ports,
    regulators: &mut [regulator::Shell],
) -> Result<Option<SetUp>, ShellError> {
    let deadline = Moment::in_s(START_S);
    regulators.iter_mut().try_for_each(|own| own.connect(deadline))?;
    member.connect(&ports.all(), deadline)?;
    let set_up = args.process.set_up(Process::Plant)?;
    regulators.iter_mut().try_for_each(|own| own.member.stand_by())?;
    member.stand_by()?;
    regulators.iter_mut().try_for_each(|own| own.member.begin())?;
    member.begin()?;
    Ok(set_up)
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
    clock: Clock,
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
            clock: args.clock,
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

    /// The commands that the drives follow in this cycle, and how many of them are late. If this process has
    /// `missed` its end, all are.
    fn take_commands(
        &mut self,
        member: &mut Member,
        measurement: &Measurement,
        drives: &mut PerAxis<DriveCommand>,
        missed: bool,
    ) -> Result<usize, ShellError> {
        let (mut since, mut all, now) = (None, 0, measurement.cycle.0);
        for from in &mut self.axes {
            let command = &mut drives[from.axis.index()];
            if !missed {
                since = take_command(member, from, self.clock, measurement, command, since)?;
            }
            self.notes.note(now, Input::Drive(from.axis), from.newest, Some(now))?;
            let late = command.cycle < measurement.cycle;
            from.late.note(late);
            all += usize::from(late);
        }
        Ok(all)
    }

    /// What the operator asks for in this cycle. Whoever has passed it on waits to hear that.
    fn request(&mut self, now: u64, refused: &mut u64) -> Result<Option<Request>, ShellError> {
        let Some(packet) = self.operator.receive()? else { return Ok(None) };
        if packet.value != 0.0 {
            self.notes.tell(now, Input::OperatorValue, Taken::This(packet.value.to_bits()))?;
        }
        self.notes.tell(now, Input::Operator, Taken::This(packet.kind.into()))?;
        self.recorder.wake()?;
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
    /// is no tick. In real time all of them look by themselves.
    fn publish(&mut self, measurement: &Measurement, tick: bool) -> Result<(), ShellError> {
        let wakes = self.clock == Clock::Virtual;
        deliver(&mut self.measurements, measurement)?;
        if wakes {
            self.axes.iter().try_for_each(|from| from.regulator.wake())?;
        }
        if tick || measurement.last != 0 {
            deliver(&mut self.ticks, measurement)?;
            if wakes {
                self.interpolator.wake()?;
            }
        }
        Ok(())
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
