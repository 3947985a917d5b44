//! Takes what the machine says of every control cycle to the observer, the journal, the trace and the
//! progress bar.

use std::{
    path::Path,
    sync::{Arc, atomic::AtomicBool},
    time::Duration,
};

use machine::Machine;
use process::shell::{Clock, Pace};
use protocol::{Axis, Input, Item, Taken};
use rig::{
    observe::{Message, Observer, Record, Summary},
    replay::{Arrivals, Collector},
    trace::{Row, TraceWriter},
};

use super::{
    Setup,
    disk::{DISK, Unwritten},
    folder::ARRIVALS,
    journal::Journal,
    moment,
    progress::Progress,
    traced::{Lost, Patience, Traced},
};
use crate::error::CliError;

/// What a run was, and what could not be written of it.
pub(crate) struct Recorded {
    /// What it was.
    pub(crate) summary: Summary,
    /// What could not be written.
    pub(crate) failed: Option<CliError>,
    /// The disk does not answer.
    pub(crate) stands: bool,
    /// What reached the modules, if that is kept.
    pub(super) arrivals: Option<Arrivals>,
}

/// Writes what reached the modules as a whole file into a run folder.
pub(super) fn keep_arrivals(folder: &Path, arrivals: &Arrivals) -> Result<(), CliError> {
    let kept = folder.join(ARRIVALS);
    let replaced = intake::replace(&kept, arrivals.text().as_bytes());
    replaced.map_err(|error| CliError::file(&kept, error))?;
    moment::remove(folder);
    Ok(())
}

/// Records one run.
pub(crate) struct Recorder {
    observer: Observer,
    trace: Option<Traced>,
    /// What became of the trace: the rows that it lacks, its hash.
    lost: Lost,
    hash: Option<String>,
    /// The journal, and how far the machine is; none where it is measured what they cost.
    journal: Option<Journal>,
    /// What reached the modules otherwise than in lock step.
    pub(crate) arrivals: Collector,
    progress: Progress,
    cycle_s: f64,
    failed: Option<CliError>,
    stands: bool,
}

impl Recorder {
    /// A recorder that writes into the run folder; `asked` tells that the operator wants something.
    pub(crate) fn new(
        setup: &Setup,
        one_process: bool,
        asked: &Arc<AtomicBool>,
    ) -> Result<Recorder, CliError> {
        let axes: Vec<Axis> = axes(&setup.machine);
        let fast = setup.clock == Clock::Virtual && setup.pace == Pace::MAX;
        let create = |format: rig::trace::Format| {
            let path = setup.folder.path.join(format.file_name());
            let trace = TraceWriter::create(&path, format, &axes)?;
            let trace = if setup.folder.every_cycle { trace } else { trace.thinned() };
            let patience = Patience { waits: fast, asked: Arc::clone(asked) };
            Traced::start(&path, trace, patience).map_err(|error| CliError::Machine(error.to_string()))
        };
        let head = Arrivals::head(one_process, setup.clock == Clock::Real, setup.seed);
        let observer = setup.program.observer(&setup.machine);
        let journal = || Journal::create(&setup.folder.path, setup.keeper(), &head, fast, Arc::clone(asked));
        Ok(Recorder {
            observer: match setup.resumed.as_ref() {
                Some(resumed) => observer.going_on(resumed.observer.clone()).resumed(resumed.report.clone()),
                None => observer,
            },
            trace: setup.folder.trace.map(create).transpose()?,
            lost: Lost::default(),
            hash: None,
            journal: (!setup.unkept).then(journal).transpose()?,
            arrivals: Collector::new(one_process, setup.machine.cycles_per_tick()),
            progress: Progress::new(setup),
            cycle_s: setup.machine.general.cycle_s,
            failed: None,
            stands: false,
        })
    }

    /// Takes one control cycle. A trace that cannot be written (a full disk) is given up, not the run.
    pub(crate) fn cycle(&mut self, record: &Record) {
        if let Some(journal) = &mut self.journal {
            self.arrivals.cycle(record);
            journal.cycle(record, &self.arrivals);
        }
        let told = self.observer.told().len();
        self.observer.cycle(record);
        for message in &self.observer.told()[told..] {
            self.progress.say(&format!("line {}: {}", message.line, message.text));
        }
        if let Some(trace) = &mut self.trace
            && !trace.row(Row::of(record, &self.observer, self.cycle_s))
        {
            self.end_of_trace();
            if let Some(error) = &self.failed {
                self.progress.say(&format!("{error}; the run goes on without a trace"));
            }
        }
        self.progress.cycle(record);
    }

    /// Completes the trace, if there is one, or notes why it is not whole.
    fn end_of_trace(&mut self) {
        if let Some((hash, lost)) = self.trace.take().map(Traced::finish) {
            self.lost = lost;
            self.hash = hash.map_err(|error| self.fails("the trace: ", error)).ok();
        }
    }

    /// Notes what could not be written; the first counts.
    fn fails(&mut self, what: &str, why: Unwritten) {
        self.stands |= matches!(why, Unwritten::Stands);
        self.failed.get_or_insert(CliError::Machine(format!("{what}{why}")));
    }

    /// Something is given by hand.
    pub(crate) fn gives(&mut self, items: &[Item], messages: Vec<Message>) {
        self.observer.gives(items, messages);
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
        self.end_of_trace();
        self.progress.finish();
        let is_kept = self.journal.is_some();
        if let Some(journal) = self.journal.take() {
            // A disk that does not answer is not waited for twice.
            let patience = if self.stands { Duration::ZERO } else { DISK };
            journal.finish(patience).unwrap_or_else(|error| self.fails("the journal: ", error));
        }
        let mut summary = self.observer.finish().summary(program, clock_name(clock));
        summary.warnings.extend(self.lost.told());
        summary.trace_file_hash = self.hash;
        let arrivals = is_kept.then(|| self.arrivals.finish());
        Recorded { summary, failed: self.failed, stands: self.stands, arrivals }
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
