//! The observer of the truth: sees what the plant really did, which no controller does, and measures every
//! pass.
//!
//! In: once per control cycle a [`Record`], positions in mm, angles in degrees. Out: an [`Observation`],
//! errors in µm, and the hash of the run. What is controlled is measured at the motor; what the part is
//! judged by, at the slide behind the elastic mode, as long as the tool is in the material ([`ToolReport`]).
//!
//! A [`Summary`] is what `summary.json` holds.

mod bus;
mod channels;
mod circle;
mod contour;
mod corrected;
mod cutting;
mod faults;
mod few;
mod full;
mod gauged;
mod gauges;
mod given;
mod going_on;
mod helix;
mod inside;
mod judged;
mod latched;
mod led;
mod limits;
mod messages;
mod observation;
mod outputs;
mod pass;
mod pause;
mod planned;
mod real_time;
mod references;
mod rings;
mod so_far;
mod span;
mod summary;
mod summary_file;
mod swing;
mod tap;
#[cfg(test)]
pub(crate) mod tests;
mod threads;
mod told;
mod tool;
mod used;
mod verdict;
mod work;
mod workshop;

use std::collections::BTreeMap;

use machine::{Machine, Part};
use protocol::{Axis, AxisStatus, Item, MachineState, MachineStatus, PerAxis, Truth};
use zerocopy::IntoBytes;

pub use channels::Channel;
pub use circle::Watch;
pub(crate) use contour::contour_error_mm;
pub use cutting::{CuttingReport, power_kw};
pub use gauged::{GaugeAsked, GaugeLimits, GaugeReport, GrooveAsked, GrooveReport};
pub use inside::TOOL_IN_THREAD;
pub use judged::PartReport;
pub use led::Led;
pub use messages::{Message, MessageReport};
pub use observation::Observation;
pub use outputs::{AnalogReport, SignalReport};
pub use pause::{PauseEnd, PauseReport};
pub use real_time::{Counted, LateCycle, RealTimeReport, SetUpItem, Times};
pub use references::ReferenceReport;
pub use rings::{ResumedReport, RingReport};
pub use summary::{
    AxisLimits, CircleReport, FaultReport, MovesReport, Outcome, PassEnd, PassReport, Process, ServoError,
    Summary, VERSION,
};
pub use summary_file::{ProgramWarning, SummaryError};
pub use tap::TapReport;
pub use threads::ThreadReport;
pub use tool::ToolReport;
pub use used::LimitsUsed;
pub use verdict::PartVerdict;
pub use work::{AxisUsed, DeviationReport, FeedReport, TraceReport, Traced, TracedPoint, WorkKind};
pub use workshop::{StockReport, ToolNote};

use bus::Bus;
use circle::Circles;
use contour::Contour;
use corrected::Corrected;
use gauged::{Gauged, Grooved};
use inside::Inside;
use latched::Latched;
use led::Setpoints;
use limits::Limits;
use messages::Messages;
use outputs::Outputs;
use pass::{PassObserver, state_in};
use pause::Pauses;
use planned::Planned;
use references::References;
use rings::Rings;
use swing::Swing;
use threads::Threads;
use work::Works;

/// Everything that is said of one control cycle.
#[derive(Clone, Copy, Debug)]
pub struct Record<'a> {
    /// The true state of the plant, with the measurement it gave out.
    pub truth: &'a Truth,
    /// What each regulator said of this cycle, in the order of the wire.
    pub axes: &'a [(Axis, AxisStatus)],
    /// What the interpolator said at its latest tick.
    pub machine: &'a MachineStatus,
}

/// Bytes that are hashed at once: a power of two, so that whole subtrees of the hash go side by side.
const HASH_BATCH: usize = 64 * 1024;
/// Bytes of a truth that count: all but what reference runs ask and what is to be done to a module.
const HASHED: usize = std::mem::offset_of!(Truth, measurement.references);

/// Watches a run. Feed it every control cycle from the first, in order.
#[derive(Clone)]
pub struct Observer {
    machine: Machine,
    /// Every pass of the program, by its number.
    program: BTreeMap<u32, Planned>,
    tool: u32, // behind all that is known of the program
    current: Option<PassObserver>,
    inside: Inside,
    threads: Threads,
    /// Passes of the runs that this one goes on with, and what else is known of those.
    earlier: Vec<PassReport>,
    rings: Rings,
    gauged: Vec<Gauged>,
    grooved: Option<Grooved>,
    index_number: u64,
    index_deg: f64,
    hash: blake3::Hasher,
    /// Neither the hash nor timed motion is asked for.
    brief: bool,
    batch: Vec<u8>,
    latched: Latched,
    swings: PerAxis<Swing>,
    corrected: Corrected,
    bus: Bus,
    moving_cycles: u64,
    limits: Limits,
    contour: Contour,
    circles: Circles,
    works: Works,
    setpoints: Setpoints,
    pauses: Pauses,
    references: References,
    outputs: Outputs,
    messages: Messages,
    /// Events of the scenario that did not happen yet, as in [`Truth::pending`].
    pending: u64,
    out: Observation,
}

impl Observer {
    /// An observer of a machine and of its program, of which what [`Watch`] wants is enough. A pass that no
    /// regulator would accept is not expected.
    pub fn new(machine: &Machine, items: &[Item]) -> Observer {
        let mut tool = 0;
        Observer {
            machine: machine.clone(),
            program: planned::planned(machine, items, &mut tool),
            tool,
            current: None,
            inside: Inside::new(),
            threads: Threads::default(),
            earlier: Vec::new(),
            rings: Rings::default(),
            gauged: Vec::new(),
            grooved: None,
            index_number: 0,
            index_deg: 0.0,
            hash: blake3::Hasher::new(),
            brief: false,
            batch: Vec::with_capacity(2 * HASH_BATCH),
            latched: Latched::default(),
            swings: Swing::of(machine),
            corrected: Corrected::default(),
            bus: Bus::of(machine),
            moving_cycles: 0,
            limits: Limits::of(machine),
            contour: Contour::default(),
            circles: Circles::of(items),
            works: Works::of(machine, items),
            setpoints: Setpoints::of(machine),
            pauses: Pauses::default(),
            references: References::of(machine),
            outputs: Outputs::of(machine),
            messages: Messages::default(),
            pending: 0,
            out: Observation {
                cycle_s: machine.general.cycle_s,
                limits: limits::reported(machine),
                tools: workshop::tools(machine, items),
                part_error_um: machine.threading.part_error_um,
                ..Observation::default()
            },
        }
    }

    /// The same observer of a part that is known, and where its zero lies on the machine in each pass: X, Z,
    /// mm.
    #[must_use]
    pub fn of_part(mut self, part: &Part, origins_mm: &BTreeMap<u32, [f64; 2]>) -> Observer {
        planned::lie_at(&mut self.program, origins_mm, Some(part));
        self.out.stock = Some(StockReport::of(part));
        self
    }

    /// The same observer of a program whose part nobody knows, but where its zero lies in each pass.
    #[must_use]
    pub fn lying_at(mut self, origins_mm: &BTreeMap<u32, [f64; 2]>) -> Observer {
        planned::lie_at(&mut self.program, origins_mm, None);
        self
    }

    /// The same observer, told more of the tools that the program selects.
    #[must_use]
    pub fn with_tools(mut self, tell: impl Fn(u32, &mut ToolNote)) -> Observer {
        self.out.tools.iter_mut().for_each(|(number, note)| tell(*number, note));
        self
    }

    /// The same observer for whoever makes many runs and asks how they ended: with the outcome, the faults
    /// and the passes, without the hash of the run and what is measured of timed motion.
    #[must_use]
    pub fn in_brief(self) -> Observer {
        Observer { brief: true, ..self }
    }

    /// The same observer of a program that tells its operator something.
    #[must_use]
    pub fn with_messages(self, messages: impl IntoIterator<Item = Message>) -> Observer {
        Observer { messages: Messages::of(messages), ..self }
    }

    /// Takes one control cycle.
    pub fn cycle(&mut self, record: &Record) {
        self.out.cycles += 1;
        let is_tick = record.machine.cycle == record.truth.cycle;
        self.take_index(record.truth);
        self.take_pass(record, is_tick);
        self.inside.cycle(&self.machine, &record.truth.measurement);
        if !self.brief {
            self.take_hash(record, is_tick);
            self.take_moves(record, is_tick);
            self.setpoints.cycle(record.truth.cycle, record.machine, is_tick);
            self.take_turned(record.truth);
            self.bus.cycle(record.axes);
        }
        self.pauses.cycle(record, self.out.cycle_s);
        self.references.cycle(record.truth, record.axes, record.machine);
        self.outputs.cycle(record.machine, &record.truth.measurement);
        self.messages.cycle(record.truth.cycle.0, record.machine);
        self.pending = record.truth.pending;
        self.take_faults(record);
    }

    /// Where the program wants an axis in the cycle taken last, mm: in a pass the law at the true spindle
    /// angle, otherwise as commanded.
    pub fn programmed_mm(&self, record: &Record, axis: Axis) -> f64 {
        let in_pass = self.current.as_ref();
        in_pass.and_then(|pass| pass.programmed_mm(axis, record.truth.spindle_deg)).unwrap_or_else(|| {
            record
                .axes
                .iter()
                .find(|(other, _)| *other == axis)
                .map_or(0.0, |(_, status)| status.commanded_mm)
        })
    }

    /// What was measured of a contour, a surface or a seam in the cycle taken last.
    pub fn traced(&self) -> Traced {
        self.works.now()
    }

    /// The tool that the axes carry in the cycle taken last, and how they are moved.
    pub fn led(&self) -> Led {
        self.setpoints.now()
    }

    /// Ends the observation; a pass in hand is reported as far as it came.
    pub fn finish(mut self) -> Observation {
        self.close();
        self.warn();
        self.report_gauges();
        (self.out.thread, self.out.resumed) = (self.thread(), self.rings.reported());
        self.out.trace_hash = self.trace_hash();
        self.out.moves.time_s = self.moving_cycles as f64 * self.out.cycle_s;
        self.contour.report(self.out.cycle_s, &mut self.out.moves);
        self.out.moves.circles = self.circles.finish(self.out.cycle_s);
        (self.out.traces, self.out.traces_left_out) = self.works.finish();
        (self.out.pauses, self.out.references) = (self.pauses.finish(), self.references.finish());
        (self.out.outputs, self.out.analog_outputs, self.out.inputs) = self.outputs.finish();
        self.out.messages = self.messages.told;
        self.out.groove = self.grooved.as_ref().map(Grooved::report);
        self.out
    }

    fn take_hash(&mut self, record: &Record, is_tick: bool) {
        self.batch.extend_from_slice(&record.truth.as_bytes()[..HASHED]);
        for (_, status) in record.axes {
            self.batch.extend_from_slice(status.as_bytes());
        }
        if is_tick {
            self.batch.extend_from_slice(record.machine.as_bytes());
        }
        if self.batch.len() >= HASH_BATCH {
            let (whole, rest) = self.batch.split_at(HASH_BATCH);
            self.hash.update(whole);
            let rest = rest.len();
            self.batch.copy_within(HASH_BATCH.., 0);
            self.batch.truncate(rest);
        }
    }

    /// The true index lies at a multiple of 360°; the cycle that first shows it is less than half a turn away
    /// from it in either direction of the spindle, so it is the nearest.
    fn take_index(&mut self, truth: &Truth) {
        if truth.measurement.index_number != self.index_number {
            self.index_number = truth.measurement.index_number;
            self.index_deg = 360.0 * (truth.spindle_deg / 360.0).round();
        }
    }

    fn take_pass(&mut self, record: &Record, is_tick: bool) {
        if self.current.is_none() {
            let armed = record.axes.iter().find(|(_, status)| state_in(status.pass, status).is_in_pass());
            let Some((_, status)) = armed else { return };
            let Some(planned) = self.program.get(&status.pass) else { return };
            self.current = Some(PassObserver::new(&self.machine, planned, record.truth.cycle.0));
        }
        let index_deg = self.index_deg;
        if let Some(pass) = &self.current {
            let gauges = self.gauged.iter_mut().chain(self.rings.gauges());
            gauges.for_each(|gauged| gauged.cycle(pass.pass(), record.truth));
            self.grooved.iter_mut().for_each(|grooved| grooved.cycle(pass.pass(), record.truth));
        }
        if self.current.as_mut().is_some_and(|pass| !pass.cycle(record, index_deg, is_tick)) {
            self.close();
        }
    }

    fn close(&mut self) {
        let Some(pass) = self.current.take() else { return };
        self.gauged.iter_mut().chain(self.rings.gauges()).for_each(Gauged::pass_ends);
        self.grooved.iter_mut().for_each(Grooved::pass_ends);
        let report = pass.finish();
        report.iter().for_each(|report| self.inside.ends(*pass.pass(), report.complete));
        report.iter().for_each(|report| self.threads.take(report, pass.depth()));
        // A tap that is turned round just in front of its depth is made again: the last one counts.
        let again = report.iter().filter(|report| report.complete && report.tap.is_some());
        for report in again {
            let before =
                self.out.passes.iter_mut().filter(|before| before.pass == report.pass && before.complete);
            before.for_each(|before| (before.complete, before.end) = (false, PassEnd::Left));
        }
        self.out.passes.extend(report);
    }

    fn take_moves(&mut self, record: &Record, is_tick: bool) {
        self.out.moves.count = record.machine.moves;
        self.moving_cycles += u64::from(record.machine.state() == MachineState::Moving);
        self.out.moves.starved = record.machine.starved;
        let used = self.limits.used(record);
        self.out.moves.limit_violations += u64::from(used.as_ref().is_some_and(limits::beyond));
        self.works.cycle(record, is_tick, used.as_ref());
        self.contour.cycle(record);
        self.circles.cycle(record);
    }

    /// What is no fault and has to be known.
    fn warn(&mut self) {
        let cycle = self.out.cycles;
        let warning = FaultReport::warning;
        let counts = |(since, text)| warning(since, "spindle-encoder", "encoder-counts-corrected", text);
        let warnings = &mut self.out.warnings;
        warnings.extend(self.corrected.told().map(counts));
        warnings.extend(self.bus.told().map(|text| warning(cycle, "bus", "bus-delay", text)));
        warnings.extend(self.inside.warning(&self.machine, self.out.outcome));
        for event in (1..=u64::BITS).filter(|event| self.pending >> (event - 1) & 1 == 1) {
            let text = format!("event {event} of the scenario did not happen: its moment never came");
            warnings.push(warning(cycle, "scenario", "event-never-came", text));
        }
    }
}
