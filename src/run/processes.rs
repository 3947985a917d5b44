//! The machine as processes: start them, watch them, record, end them.

use std::{
    process::{Child, Command, Stdio},
    time::Duration,
};

use process::{
    ipc::{ChannelCount, NameSpace, Process, time::Moment, total},
    shell::{Clock, START_S},
};
use protocol::operator::Request;
use rig::observe::{self, FaultReport, Outcome, Summary};

use super::{
    Setup,
    channels::Channels,
    interrupts::Interrupts,
    recorder::{Recorder, axes},
};
use crate::error::CliError;

/// How long the launcher sleeps when nobody wakes it.
const NAP: Duration = Duration::from_millis(20);

/// How long processes may take to end after the last measurement, or to finish a pass after one of them died,
/// s.
const END_S: f64 = 10.0;

/// A process of this run. Dropping it ends the process.
struct Started {
    process: Process,
    child: Child,
    exit: Option<Option<i32>>,
}

impl Drop for Started {
    fn drop(&mut self) {
        // It may be gone already; then there is nothing to end.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Runs the machine to its end.
pub(crate) fn run(setup: &Setup) -> Result<Summary, CliError> {
    let mut interrupts = Interrupts::catch()?;
    let axes = axes(&setup.machine);
    let mut space = NameSpace::create(&axes)?;
    let mut channels = Channels::open(&mut space, &setup.machine)?;
    let mut started = Vec::new();
    for process in Process::members(&axes) {
        started.push(start(setup, &space, process)?);
    }
    rendezvous(&mut space, &channels, &mut started, &mut interrupts)?;
    let mut recorder = Recorder::new(setup)?;
    let begun = Moment::now();
    space.start()?;

    let mut died = Vec::new();
    let mut deadline = None;
    let mut force = false;
    while !channels.ended() {
        let recorded = channels.record(&mut recorder, force)?;
        if interrupts.came() {
            if interrupts.count() > 1 {
                break;
            }
            channels.operate(Request::Stop)?;
        }
        for process in newly_dead(&mut started)? {
            space.bury(process)?;
            channels.bury(process);
            died.push(process);
            deadline.get_or_insert_with(|| Moment::in_s(END_S));
        }
        // A pass in hand is cut to its end and the tool retracted, whoever died above.
        let over = !died.is_empty() && (!channels.in_pass() || died.contains(&Process::Plant));
        if over || deadline.is_some_and(Moment::passed) {
            break;
        }
        // In real time messages may be lost, the last ones among them.
        force = !recorded && setup.clock == Clock::Real && channels.last_has_come();
        if !recorded {
            space.launcher().wait_at_most(NAP)?;
        }
    }
    let counts = end(&mut space, &mut started, &channels, died.is_empty() && channels.ended())?;
    let mut summary = recorder.finish(&setup.folder.named, setup.clock)?;
    summary.deadline_misses = channels.late_answers();
    summary.processes = started.iter().map(report).collect();
    summary.channels = counts;
    for process in &died {
        summary.outcome = Outcome::Faulted;
        summary.faults.push(FaultReport {
            cycle: summary.cycles,
            source: process.name(),
            code: "process-died".into(),
            text: "the process ended before the machine did; its last words are on standard error".into(),
        });
    }
    Ok(complete(summary, setup, begun))
}

/// What only the launcher knows of a run.
pub(crate) fn complete(mut summary: Summary, setup: &Setup, begun: Moment) -> Summary {
    summary.seed = setup.seed;
    summary.wall_s = begun.elapsed().as_secs_f64();
    summary
}

/// Starts one process: this program again, under another command, in a process group of its own so that
/// Ctrl-C reaches the launcher only.
fn start(setup: &Setup, space: &NameSpace, process: Process) -> Result<Started, CliError> {
    use std::os::unix::process::CommandExt as _;
    let this = std::env::current_exe().map_err(|error| CliError::Machine(error.to_string()))?;
    let mut command = Command::new(this);
    command.stdin(Stdio::null()).stdout(Stdio::null()).process_group(0);
    match process {
        Process::Interpreter => {
            command.arg("interpreter").arg(&setup.folder.program).args(setup.folder.language_args())
        }
        Process::Interpolator => command.arg("interpolator"),
        Process::Plant => {
            command.arg("sim-plant").arg("--seed").arg(setup.seed.to_string());
            if let Some(scenario) = &setup.folder.scenario {
                command.arg("--scenario").arg(scenario);
            }
            &mut command
        }
        Process::Regulator(axis) => command.arg("regulator").arg("--axis").arg(axis.name()),
        Process::Launcher => unreachable!("the launcher starts the others"),
    };
    command.arg("--address").arg(space.address()).arg("--machine").arg(&setup.folder.machine);
    match setup.clock {
        // In lock step everybody waits for everybody: taking turns on one processor is fastest.
        Clock::Virtual => {
            command.arg("--clock").arg("virtual").arg("--processor").arg(processor().to_string())
        }
        Clock::Real => command.arg("--clock").arg("real"),
    };
    let child = command
        .spawn()
        .map_err(|error| CliError::Machine(format!("cannot start {}: {error}", process.name())))?;
    Ok(Started { process, child, exit: None })
}

/// The processor for this machine's processes: machines started side by side spread over all there are.
fn processor() -> usize {
    let allowed = process::ipc::time::processors();
    allowed[std::process::id() as usize % allowed.len()]
}

/// Waits until every process has connected all its ports.
fn rendezvous(
    space: &mut NameSpace,
    channels: &Channels,
    started: &mut [Started],
    interrupts: &mut Interrupts,
) -> Result<(), CliError> {
    let deadline = Moment::in_s(START_S);
    loop {
        let missing = space.missing(&channels.ports())?;
        if missing.is_empty() {
            return Ok(());
        }
        if let Some(process) = newly_dead(started)?.first() {
            return Err(CliError::Machine(format!(
                "{} ended while the machine was starting",
                process.name()
            )));
        }
        if interrupts.came() {
            return Err(CliError::Machine("interrupted while the machine was starting".into()));
        }
        if deadline.passed() {
            let names: Vec<_> = missing.into_iter().map(Process::name).collect();
            return Err(CliError::Machine(format!(
                "{} did not connect within {START_S} s; run `pitchlock doctor`",
                names.join(", ")
            )));
        }
        process::ipc::time::sleep_until(Moment::in_s(0.001));
    }
}

/// Processes that ended since the last look.
fn newly_dead(started: &mut [Started]) -> Result<Vec<Process>, CliError> {
    let mut dead = Vec::new();
    for one in started.iter_mut().filter(|one| one.exit.is_none()) {
        let status = one.child.try_wait().map_err(|error| CliError::Machine(error.to_string()))?;
        if let Some(status) = status {
            one.exit = Some(status.code());
            dead.push(one.process);
        }
    }
    Ok(dead)
}

/// Lets everybody finish and go; whoever does not is ended.
fn end(
    space: &mut NameSpace,
    started: &mut [Started],
    channels: &Channels,
    good: bool,
) -> Result<Vec<observe::Channel>, CliError> {
    let deadline = Moment::in_s(if good { END_S } else { 0.0 });
    while good && !space.unfinished()?.is_empty() && !deadline.passed() {
        process::ipc::time::sleep_until(Moment::in_s(0.001));
    }
    let mut counts = space.end()?;
    counts.extend(channels.counts());
    while started.iter().any(|one| one.exit.is_none()) && !deadline.passed() {
        newly_dead(started)?;
        process::ipc::time::sleep_until(Moment::in_s(0.001));
    }
    for one in started.iter_mut().filter(|one| one.exit.is_none()) {
        // It may be gone by now; either way its status is collected.
        let _ = one.child.kill();
        one.exit = one.child.wait().ok().map(|status| status.code());
    }
    Ok(total(counts).into_iter().map(channel).collect())
}

fn channel(count: ChannelCount) -> observe::Channel {
    let ChannelCount { name, sent, received, lost, bytes } = count;
    observe::Channel { name, sent, received, lost, bytes }
}

fn report(one: &Started) -> observe::Process {
    observe::Process { name: one.process.name(), pid: one.child.id(), exit: one.exit.flatten() }
}
