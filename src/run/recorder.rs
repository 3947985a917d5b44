//! Takes what the machine says of every control cycle to the observer, the journal, the trace and the
//! progress bar.

use std::path::PathBuf;

use machine::Machine;
use process::shell::{Clock, Pace};
use protocol::{Axis, Input, Taken};
use rig::{
    observe::{Observer, Record, Summary},
    replay::{Arrivals, Collector},
    trace::{Row, TraceError, TraceWriter},
};

use super::{Setup, folder::ARRIVALS, journal::Journal, moment::Live, progress::Progress};
use crate::error::CliError;

/// What a run was; and what could not be written of it.
pub(crate) type Recorded = (Summary, Option<CliError>);

/// What the system calls a disk, and a share of it, that is full: ENOSPC, EDQUOT.
const FULL: [i32; 2] = [28, 122];

/// Records one run.
pub(crate) struct Recorder {
    observer: Observer,
    trace: Option<TraceWriter>,
    trace_path: Option<PathBuf>,
    /// The journal, and how far the machine is; none where it is measured what they cost.
    journal: Option<Journal>,
    /// What reached the modules otherwise than in lock step, and where that is kept.
    pub(crate) arrivals: Collector,
    kept: PathBuf,
    live: Option<Live>,
    progress: Progress,
    cycle_s: f64,
    failed: Option<CliError>,
}

impl Recorder {
    /// A recorder that writes into the run folder.
    pub(crate) fn new(setup: &Setup, one_process: bool) -> Result<Recorder, CliError> {
        let axes: Vec<Axis> = axes(&setup.machine);
        let create = |format: rig::trace::Format| {
            let trace = TraceWriter::create(&setup.folder.path.join(format.file_name()), format, &axes)?;
            Ok::<_, CliError>(if setup.folder.every_cycle { trace } else { trace.thinned() })
        };
        let head = Arrivals::head(one_process, setup.clock == Clock::Real, setup.seed);
        let observer = setup.program.observer(&setup.machine);
        let kept = !setup.unkept;
        let fast = setup.clock == Clock::Virtual && setup.pace == Pace::MAX;
        Ok(Recorder {
            observer: match setup.resumed.as_ref() {
                Some(resumed) => observer.going_on(resumed.observer.clone()).resumed(resumed.report.clone()),
                None => observer,
            },
            trace_path: setup.folder.trace.map(|format| setup.folder.path.join(format.file_name())),
            trace: setup.folder.trace.map(create).transpose()?,
            journal: kept.then(|| Journal::create(&setup.folder.path, setup.keeper(), fast)).transpose()?,
            arrivals: Collector::new(one_process, setup.machine.cycles_per_tick()),
            kept: setup.folder.path.join(ARRIVALS),
            live: kept.then(|| Live::create(&setup.folder.path, &head)).transpose()?,
            progress: Progress::new(setup),
            cycle_s: setup.machine.general.cycle_s,
            failed: None,
        })
    }

    /// Takes one control cycle. A trace that cannot be written (a full disk) is given up, not the run.
    pub(crate) fn cycle(&mut self, record: &Record) {
        if let Some(journal) = &mut self.journal {
            journal.cycle(record);
        }
        let told = self.observer.told().len();
        self.observer.cycle(record);
        if let Some(live) = &mut self.live {
            self.arrivals.cycle(record);
            live.cycle(record.truth.cycle.0 + 1, &self.arrivals);
        }
        for message in &self.observer.told()[told..] {
            self.progress.say(&format!("line {}: {}", message.line, message.text));
        }
        if let Some(trace) = &mut self.trace
            && let Err(error) = trace.row(&Row::of(record, &self.observer, self.cycle_s))
        {
            self.progress.say(&format!("{error}; the run goes on without a trace"));
            self.trace = None;
            self.give_up_trace(&error);
            self.failed = Some(error.into());
        }
        self.progress.cycle(record);
    }

    /// A trace that has no room any more goes: its room is that of the journal and the rest.
    fn give_up_trace(&self, error: &TraceError) {
        let (text, full) =
            (error.to_string(), FULL.map(|code| std::io::Error::from_raw_os_error(code).to_string()));
        if let Some(path) = &self.trace_path
            && full.iter().any(|full| text.contains(full.as_str()))
        {
            let _ = std::fs::remove_file(path);
        }
    }

    /// What has been observed so far.
    pub(crate) fn observer(&self) -> &Observer {
        &self.observer
    }

    /// Since which control cycle the interpolator has wanted machine code and got none, in real time.
    pub(crate) fn hungry_since(&self) -> Option<u64> {
        let changes = &self.arrivals.so_far().changes;
        let (cycle, _, taken) = changes.iter().rfind(|(_, input, _)| *input == Input::Code)?;
        (*taken == Taken::This(0)).then_some(*cycle)
    }

    /// Tells the operator something.
    pub(crate) fn say(&self, text: &str) {
        self.progress.say(text);
    }

    /// Ends the recording; and why there is no trace of all of it, if there is none.
    pub(crate) fn finish(mut self, program: &str, clock: Clock) -> Recorded {
        let finished = self.trace.take().map(TraceWriter::finish).transpose();
        if let Err(error) = &finished {
            self.give_up_trace(error);
        }
        self.progress.finish();
        let (hash, unfinished) = finished.map_or_else(|error| (None, Some(error)), |hash| (hash, None));
        let unwritten = self.journal.and_then(|journal| journal.finish().err());
        let unwritten = unwritten.map(|error| CliError::Machine(format!("the journal: {error}")));
        let kept = self.live.and_then(|live| {
            let kept = intake::replace(&self.kept, self.arrivals.finish().text().as_bytes());
            kept.map(|()| live.remove()).map_err(|error| CliError::file(&self.kept, error)).err()
        });
        let failed = self.failed.or(unfinished.map(CliError::from)).or(unwritten).or(kept);
        let summary = self.observer.finish().summary(program, clock_name(clock));
        (Summary { trace_file_hash: hash, ..summary }, failed)
    }
}

fn clock_name(clock: Clock) -> &'static str {
    match clock {
        Clock::Virtual => "virtual",
        Clock::Real => "real",
    }
}

/// The axes of a machine.
pub(crate) fn axes(machine: &Machine) -> Vec<Axis> {
    machine.axes().map(|(axis, _)| axis).collect()
}
