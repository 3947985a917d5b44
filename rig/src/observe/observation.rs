//! What was observed of a run, and the summary that becomes of it. In: what the observer measured; mm, µm,
//! degrees. Out: a [`Summary`], judged.

use std::collections::BTreeMap;

use protocol::Axis;

use super::{
    AnalogReport, AxisLimits, FaultReport, GaugeReport, GrooveReport, MessageReport, MovesReport, Outcome,
    PassReport, PauseReport, ReferenceReport, ResumedReport, SignalReport, StockReport, Summary,
    ThreadReport, ToolNote, TraceReport, VERSION, judged::judged,
};

/// What was observed of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Observation {
    /// How it ended, as far as the modules say.
    pub outcome: Outcome,
    /// Control cycles seen.
    pub cycles: u64,
    /// Control cycle, s.
    pub cycle_s: f64,
    /// BLAKE3 over the bytes of every truth (which holds the measurement), of every axis status, and of the
    /// machine status of every tick, in this order within a cycle; hex.
    pub trace_hash: String,
    /// The passes whose law has moved an axis, in the order of their cutting.
    pub passes: Vec<PassReport>,
    /// The threads.
    pub thread: ThreadReport,
    /// The run that this one goes on with.
    pub resumed: Option<ResumedReport>,
    /// The line at which the program was begun, if not at its beginning.
    pub from_line: Option<u32>,
    /// What the gauge says, if one was asked for.
    pub gauge: Option<GaugeReport>,
    /// What each of several gauges says, in the order of the program.
    pub gauges: Vec<GaugeReport>,
    /// What becomes of the groove that the program draws, if it draws one.
    pub groove: Option<GrooveReport>,
    /// Timed motion.
    pub moves: MovesReport,
    /// Contours, surfaces and seams in the order of their cutting.
    pub traces: Vec<TraceReport>,
    /// More of them, each with less deviation than those.
    pub traces_left_out: u64,
    /// Faults in the order of their coming.
    pub faults: Vec<FaultReport>,
    /// What is no fault and has to be known.
    pub warnings: Vec<FaultReport>,
    /// Overrides that were clamped.
    pub overrides_clamped: u32,
    /// Reference runs in the order of their ends.
    pub references: Vec<ReferenceReport>,
    /// Pauses of the program in the order of their coming.
    pub pauses: Vec<PauseReport>,
    /// Changes of digital outputs in the order of their coming.
    pub outputs: Vec<SignalReport>,
    /// Changes of analog outputs in the order of their coming.
    pub analog_outputs: Vec<AnalogReport>,
    /// Changes of digital inputs in the order of their coming.
    pub inputs: Vec<SignalReport>,
    /// What the program told its operator.
    pub messages: Vec<MessageReport>,
    /// Limits of the axes.
    pub limits: BTreeMap<Axis, AxisLimits>,
    /// The stock, if it is known.
    pub stock: Option<StockReport>,
    /// The tools that the program selects, by number.
    pub tools: BTreeMap<u32, ToolNote>,
    /// What a thread may be off at the tool, µm.
    pub part_error_um: f64,
}

impl Observation {
    /// The summary of a run, as far as it can be observed. `clock` is `virtual` or `real`; processes,
    /// channels, wall time and deadline misses are for the launcher to fill.
    pub fn summary(self, program: &str, clock: &str) -> Summary {
        let summary = Summary {
            version: VERSION,
            program: program.into(),
            clock: clock.into(),
            outcome: self.outcome,
            cycle_s: self.cycle_s,
            cycles: self.cycles,
            simulated_s: self.cycles as f64 * self.cycle_s,
            trace_hash: self.trace_hash,
            faults: self.faults,
            warnings: self.warnings,
            overrides_clamped: self.overrides_clamped,
            passes: self.passes,
            resumed: self.resumed,
            from_line: self.from_line,
            thread: self.thread,
            gauge: self.gauge,
            gauges: self.gauges,
            groove: self.groove,
            moves: self.moves,
            traces: self.traces,
            traces_left_out: self.traces_left_out,
            references: self.references,
            pauses: self.pauses,
            outputs: self.outputs,
            analog_outputs: self.analog_outputs,
            inputs: self.inputs,
            messages: self.messages,
            limits: self.limits,
            stock: self.stock,
            tools: self.tools,
            ..Summary::default()
        };
        Summary { part: judged(&summary, self.part_error_um), ..summary }
    }
}
