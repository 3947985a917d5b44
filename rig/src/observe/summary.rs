//! `summary.json`, version 1: what a run was, what it did, and how good its threads are.
//!
//! The observer fills what it can see ([`super::Observation::summary`]); the rest is the launcher's. Lengths
//! in mm, errors in µm, angles in degrees, speeds in 1/min. Every number is finite.

use std::collections::BTreeMap;

use protocol::Axis;
use serde::{Deserialize, Serialize};

use super::{
    AnalogReport, Channel, CuttingReport, GaugeReport, GrooveReport, LimitsUsed, MessageReport, PartReport,
    PauseReport, ProgramWarning, RealTimeReport, ReferenceReport, ResumedReport, SignalReport, StockReport,
    TapReport, ThreadReport, ToolNote, ToolReport, TraceReport, few::few,
};

/// Version of the layout; fields may be added without a new one.
pub const VERSION: u32 = 1;

/// How a run ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// The program came to its end.
    Completed,
    /// A module latched a fault.
    Faulted,
    /// The operator ended the program, or the run was broken off before the program's end.
    #[default]
    Stopped,
}

/// A process of the machine and how it ended.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Process {
    /// Its name, as in `regulator-x`.
    pub name: String,
    /// Number of the process.
    pub pid: u32,
    /// Exit status; `None` if a signal ended it.
    pub exit: Option<i32>,
    /// Name of the signal that ended it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub signal: Option<String>,
}

/// A fault when it was first seen.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FaultReport {
    /// Control cycle in which it was first seen.
    pub cycle: u64,
    /// The module that latched it.
    pub source: String,
    /// Its stable name.
    pub code: String,
    /// What happened and what to look at.
    pub text: String,
}

/// Servo error of one axis in a pass: commanded minus measured at the sample instant, µm; or the error of its
/// slide: commanded minus true.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ServoError {
    /// Smallest while the axis runs in; 0 for an axis that does not.
    pub approach_min_um: f64,
    /// Largest while the axis runs in; 0 for an axis that does not.
    pub approach_max_um: f64,
    /// At the end of the run-in: the first sample on the helix, or the last of a run-in that was broken off.
    pub end_um: f64,
    /// Largest magnitude on the helix, its first sample included.
    pub thread_max_abs_um: f64,
    /// Largest magnitude on the helix from one turn after it was reached: what is left when the run-in has
    /// died away.
    pub settled_max_abs_um: f64,
}

/// One pass of a thread.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PassReport {
    /// Running number in the program, from 1.
    pub pass: u32,
    /// Line of the part program.
    pub line: u32,
    /// Which start of a multi-start thread, from 0.
    pub start: u32,
    /// Number of the tool; 0 if none was selected.
    #[serde(default)]
    pub tool_number: u32,
    /// X and Z of the machine at which X 0 and Z 0 of the program lie in it, where that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub origin_mm: Option<[f64; 2]>,
    /// It lies on a face: it runs along X, and Z takes the tool to depth.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub on_face: bool,
    /// Signed advance per revolution.
    pub lead_mm: f64,
    /// S.
    pub programmed_rpm: f64,
    /// Lowest true speed from the first motion to the last, in the direction of the pass.
    pub rpm_min: f64,
    /// Highest true speed, likewise.
    pub rpm_max: f64,
    /// Lowest spindle override on the panel.
    pub override_min_pct: f64,
    /// Highest spindle override on the panel.
    pub override_max_pct: f64,
    /// Highest override that every axis can follow.
    pub max_feasible_override_pct: f64,
    /// C0 of the run-in along the thread.
    pub c0_deg: f64,
    /// ΔC of the run-in along the thread.
    pub delta_c_deg: f64,
    /// ΔZ, signed: way of the run-in along the thread (M10).
    pub delta_z_mm: f64,
    /// ΔX, signed: stroke of the approach.
    pub delta_x_mm: f64,
    /// Angle at which the thread ends.
    pub thread_end_deg: f64,
    /// Bytes that told the regulators of the pass, all axes together.
    pub packet_bytes: u64,
    /// Setpoints that a stream would have needed meanwhile: interpolator ticks times axes.
    pub setpoints_saved: u64,
    /// Servo error of X.
    pub x: ServoError,
    /// Servo error of Z.
    pub z: ServoError,
    /// Error of the slide of X: commanded minus true slide, at the same instants. It holds what the servo
    /// error cannot see: backlash, error of the screw, elasticity.
    #[serde(default)]
    pub x_slide: ServoError,
    /// Error of the slide of Z.
    #[serde(default)]
    pub z_slide: ServoError,
    /// Largest magnitude of true Z (at the motor) minus true helix (true spindle angle) over the thread.
    pub helix_max_abs_um: f64,
    /// Mean of the same over the angle of the thread: where this pass lies against the programmed helix.
    pub phase_um: f64,
    /// Slope of the same.
    pub lead_error_um_per_rev: f64,
    /// How much of the limits the true motion of the nut used (M124).
    pub limits_used_pct: LimitsUsed,
    /// How much of them the law asked for, at the observed speed of the spindle (M8).
    #[serde(default)]
    pub limits_asked_pct: LimitsUsed,
    /// As `helix_max_abs_um`, for the slide behind the elastic mode.
    pub slide_helix_max_abs_um: f64,
    /// As `phase_um`, for the slide.
    pub slide_phase_um: f64,
    /// What the tool did in the material: what the part is judged by.
    #[serde(default)]
    pub tool: ToolReport,
    /// What a tap did; absent of other passes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tap: Option<TapReport>,
    /// What cutting took; absent if nothing was cut.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cutting: Option<CuttingReport>,
    /// +1 for M3, -1 for M4: the direction in which angles of this pass grow.
    pub direction: f64,
    /// True angle of the index that the pass started from, unwrapped degrees.
    pub index_deg: f64,
    /// Whether every axis started from that index (same-index rule).
    pub same_index: bool,
    /// Depth below the crest.
    pub depth_mm: f64,
    /// Angles at which X begins, is at depth, leaves it, and rests again.
    pub x_moments_deg: [f64; 4],
    /// Angles at which Z begins, is on the helix, leaves it, and rests again.
    pub z_moments_deg: [f64; 4],
    /// Where the programmed helix, prolonged, lies at angle 0, mm: at C it lies at this plus `lead_mm` C/360.
    pub helix_at_index_mm: f64,
    /// Where that lead changes: angle and width of each window, deg, jump of the lead, mm/rev, and of its
    /// growth, mm/rev² (M214).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lead_changes: Vec<[f64; 4]>,
    /// Control cycle in which the pass was armed.
    pub armed_cycle: u64,
    /// Control cycle in which the index of the pass was seen.
    pub begin_cycle: u64,
    /// Last control cycle in which an axis was under its law.
    pub end_cycle: u64,
    /// Control cycles in which the thread was cut: every axis on its helix.
    pub thread_cycles: u64,
    /// Whether every axis ran out to its rest.
    pub complete: bool,
    /// How it ended.
    #[serde(default)]
    pub end: PassEnd,
}

/// How a pass ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PassEnd {
    /// Every axis ran out to its rest.
    Complete,
    /// Every axis left it, and rests.
    Left,
    /// The record ends, or an axis could not be led, before all of them rested.
    #[default]
    CutOff,
}

/// The limits of one axis that its motion is held against.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AxisLimits {
    /// mm/s.
    pub velocity_mm_s: f64,
    /// mm/s².
    pub acceleration_mm_s2: f64,
    /// mm/s³.
    pub jerk_mm_s3: f64,
}

/// Timed motion. Contour error: distance of the true position (linear axes, at the motors) from the commanded
/// path, normal to it, while the axes move.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MovesReport {
    /// Moves completed.
    pub count: u64,
    /// Time in motion, s.
    pub time_s: f64,
    /// Interpolator cycles in which an axis was commanded beyond a limit of its speed, acceleration, jerk or
    /// jerk rate.
    pub limit_violations: u64,
    /// How often the machine stopped on its path because machine code did not come in time.
    pub starved: u32,
    /// Largest contour error.
    pub contour_max_um: f64,
    /// Root of the mean square of the contour error.
    pub contour_rms_um: f64,
    /// Line of the part program in which it is largest.
    pub contour_line: u32,
    /// When it is largest, s.
    pub contour_t_s: f64,
    /// Arcs of at least half a turn, in the order of their coming; at most 200.
    pub circles: Vec<CircleReport>,
}

/// A circle that was travelled. Deviation: distance of the true position (at the motors) from the centre,
/// minus the radius.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CircleReport {
    /// Line of the part program.
    pub line: u32,
    /// First and second axis of its plane.
    pub plane: [Axis; 2],
    /// Its centre in that plane.
    pub center_mm: [f64; 2],
    /// Its radius.
    pub radius_mm: f64,
    /// Mean of the commanded speed.
    pub feed_mm_min: f64,
    /// How far around it went, positive from the first axis to the second.
    pub swept_deg: f64,
    /// When it began, s.
    pub t_s: f64,
    /// First control cycle of it.
    pub begin_cycle: u64,
    /// Last control cycle of it.
    pub end_cycle: u64,
    /// Largest magnitude of the deviation.
    pub round_max_um: f64,
    /// Mean deviation.
    pub mean_um: f64,
    /// Quadrant glitches at 0, 90, 180 and 270 degrees from the first axis to the second: the deviation
    /// farthest from the mean within 15 degrees of it, less the mean; 0 for a quadrant that was not
    /// travelled.
    pub quadrants_um: [f64; 4],
}

/// The whole of `summary.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// [`VERSION`].
    pub version: u32,
    /// The part program, as the user named it.
    pub program: String,
    /// The run that was broken off and that this one goes on with.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resumed: Option<ResumedReport>,
    /// The line at which the program was begun, if not at its beginning.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_line: Option<u32>,
    /// `virtual` or `real`.
    pub clock: String,
    /// Seed of everything random about the plant.
    #[serde(default)]
    pub seed: u64,
    /// How it ended.
    pub outcome: Outcome,
    /// Control cycle, s.
    pub cycle_s: f64,
    /// Control cycles seen.
    pub cycles: u64,
    /// Time on the machine, s.
    pub simulated_s: f64,
    /// Time on the clock, s.
    pub wall_s: f64,
    /// BLAKE3 over all measurements, true states and statuses, in hex.
    pub trace_hash: String,
    /// BLAKE3 of the file of the trace, in hex.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trace_file_hash: Option<String>,
    /// BLAKE3 of every file in the run folder that decided what was run, in hex, by its name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub files: BTreeMap<String, String>,
    /// The processes of the run.
    pub processes: Vec<Process>,
    /// In real time, what the processes with deadlines say of themselves.
    #[serde(default, deserialize_with = "few", skip_serializing_if = "Vec::is_empty")]
    pub real_time: Vec<RealTimeReport>,
    /// The channels of the run.
    pub channels: Vec<Channel>,
    /// Faults in the order of their coming.
    pub faults: Vec<FaultReport>,
    /// What is no fault and has to be known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<FaultReport>,
    /// What the check of the program warned of, before anything moved.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub program_warnings: Vec<ProgramWarning>,
    /// Overrides that were clamped.
    pub overrides_clamped: u32,
    /// Late answers in real time.
    pub deadline_misses: u64,
    /// The passes in the order of their cutting.
    pub passes: Vec<PassReport>,
    /// The threads.
    pub thread: ThreadReport,
    /// What the gauge says, if one was asked for; of several the first with the worst verdict.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gauge: Option<GaugeReport>,
    /// What each of several gauges says, in the order of the program.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gauges: Vec<GaugeReport>,
    /// What becomes of the groove that the program draws, if it draws one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub groove: Option<GrooveReport>,
    /// Whether the part is good.
    #[serde(default)]
    pub part: PartReport,
    /// Timed motion.
    pub moves: MovesReport,
    /// Contours, surfaces and seams as they were cut; of more than 200 those with the largest deviation.
    #[serde(default, deserialize_with = "few", skip_serializing_if = "Vec::is_empty")]
    pub traces: Vec<TraceReport>,
    /// More of them, each with less deviation than those.
    #[serde(default, skip_serializing_if = "super::channels::is_zero")]
    pub traces_left_out: u64,
    /// Reference runs that made the position of their axis true.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub references: Vec<ReferenceReport>,
    /// Pauses of the program.
    #[serde(default)]
    pub pauses: Vec<PauseReport>,
    /// Changes of digital outputs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outputs: Vec<SignalReport>,
    /// Changes of analog outputs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub analog_outputs: Vec<AnalogReport>,
    /// Changes of digital inputs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<SignalReport>,
    /// What the program told its operator.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub messages: Vec<MessageReport>,
    /// Limits of the axes.
    pub limits: BTreeMap<Axis, AxisLimits>,
    /// The stock, if the program or a file beside it says what it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stock: Option<StockReport>,
    /// The tools that the program selects, by number.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub tools: BTreeMap<u32, ToolNote>,
}

impl PassReport {
    /// Where the programmed helix, prolonged, lies along the thread at an angle since the index, mm.
    pub fn helix_mm(&self, c_deg: f64) -> f64 {
        let changed = |[begins, dc, lead, growth]: &[f64; 4]| {
            motion::LeadChange::new(*lead, *growth, dc / 360.0).at((c_deg - begins) / 360.0).s
        };
        let way_mm: f64 = self.lead_changes.iter().map(changed).sum();
        self.helix_at_index_mm + self.lead_mm * c_deg / 360.0 + way_mm
    }
}
