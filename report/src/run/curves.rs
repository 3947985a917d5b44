//! The curves of a report, gathered while the trace is read once. In: rows in mm and degrees. Out: curves in
//! µm over degrees or turns, in mm, in per cent of limits, and over seconds.

use protocol::{Axis, AxisState};
use rig::observe::{PassReport, Summary};
use rig::trace::Row;

use super::curves_moves::MovesCurves;
use super::cutting::CutCurves;
use super::error_map::ErrorMap;
use super::part::Part;
use super::path::Path;
use super::tools::ToolUses;
use super::traces::TraceCurves;
use crate::envelope::Envelope;

/// Points kept of all passes together; a single curve has at least [`LEAST_SLOTS`] and at most [`MOST_SLOTS`]
/// intervals.
const ALL_SLOTS: usize = 12_000;
const LEAST_SLOTS: usize = 60;
const MOST_SLOTS: usize = 700;
/// Curves of one pass over its spindle angle.
pub(super) struct PassCurves {
    /// Number of the pass.
    pub(super) pass: u32,
    /// Line of the program that it belongs to.
    pub(super) line: u32,
    /// Servo errors of X and Z over degrees, µm.
    pub(super) servo: [Envelope; 2],
    /// True Z minus true helix over turns of the thread, µm.
    pub(super) helix: Envelope,
}

/// Curves of the pass that is shown in full, over its spindle angle in degrees.
pub(super) struct ShownCurves {
    /// Programmed and true position of X and Z, mm.
    pub(super) programmed: [Envelope; 2],
    pub(super) position: [Envelope; 2],
    /// Speed, acceleration and jerk of X and Z, per cent of the limit.
    pub(super) used: [[Envelope; 3]; 2],
    /// Commanded minus measured, and commanded minus true slide, of X and Z, µm.
    pub(super) servo: [Envelope; 2],
    pub(super) slide: [Envelope; 2],
    /// Angle at which the axes were armed, degrees (before the index, so negative).
    pub(super) armed_deg: f64,
}

/// Everything that is drawn.
pub(super) struct Curves {
    /// The tool path.
    pub(super) path: Path,
    /// How far the finished groove is off.
    pub(super) error_map: ErrorMap,
    /// What each tool took.
    pub(super) tools: ToolUses,
    pub(super) passes: Vec<PassCurves>,
    /// Where the pass shown in full stands in `passes`, and its curves once it has begun.
    pub(super) shown_index: usize,
    pub(super) shown: Option<ShownCurves>,
    /// True spindle speed over time, 1/min, and the override, per cent.
    pub(super) rpm: Envelope,
    /// Whether it turned at all: there may be none.
    pub(super) spindle_turns: bool,
    pub(super) override_pct: Envelope,
    /// What cutting took.
    pub(super) cutting: CutCurves,
    /// What is left of the part.
    pub(super) part: Part,
    /// Timed motion.
    pub(super) moves: MovesCurves,
    /// Contours, surfaces and seams.
    pub(super) traces: Vec<TraceCurves>,
}

/// The axes of a pass.
const AXES: [Axis; 2] = [Axis::X, Axis::Z];

/// The pass that is shown in full: the deepest of those that were cut to their end, else the first.
pub(super) fn shown_index(passes: &[PassReport]) -> usize {
    let complete = passes.iter().enumerate().filter(|(_, pass)| pass.complete);
    complete.max_by(|(_, a), (_, b)| a.depth_mm.total_cmp(&b.depth_mm)).map_or(0, |(index, _)| index)
}

/// Angles between which any axis of a pass moves, degrees; of a tap, which goes back to where it began, up to
/// its depth.
pub(super) fn moving_deg(pass: &PassReport) -> (f64, f64) {
    let ([x_from, .., x_to], [z_from, .., z_to]) = (pass.x_moments_deg, pass.z_moments_deg);
    match pass.tap {
        Some(_) => (z_from, pass.thread_end_deg),
        None => (x_from.min(z_from), x_to.max(z_to)),
    }
}

/// Angles between which a thread is cut, degrees.
pub(super) fn thread_deg(pass: &PassReport) -> (f64, f64) {
    (pass.x_moments_deg[1].max(pass.z_moments_deg[1]), pass.thread_end_deg)
}

impl Curves {
    /// Empty curves for a run.
    pub(super) fn new(summary: &Summary) -> Curves {
        let slots = (ALL_SLOTS / summary.passes.len().max(1)).clamp(LEAST_SLOTS, MOST_SLOTS);
        let of_pass = |pass: &PassReport| {
            let (from, to) = moving_deg(pass);
            let (locked, leaves) = thread_deg(pass);
            let servo = Envelope::new(from, to, slots);
            PassCurves {
                pass: pass.pass,
                line: pass.line,
                servo: [servo.clone(), servo],
                helix: Envelope::new(0.0, (leaves - locked) / 360.0, slots),
            }
        };
        let over_time = Envelope::new(0.0, summary.simulated_s, 2 * MOST_SLOTS);
        Curves {
            path: Path::new(summary),
            error_map: ErrorMap::new(summary),
            tools: ToolUses::default(),
            passes: summary.passes.iter().map(of_pass).collect(),
            shown_index: shown_index(&summary.passes),
            shown: None,
            rpm: over_time.clone(),
            spindle_turns: false,
            override_pct: over_time,
            cutting: CutCurves::new(summary, slots),
            part: Part::new(summary),
            moves: MovesCurves::new(summary),
            traces: TraceCurves::all(summary),
        }
    }

    /// Takes the next row.
    pub(super) fn add(&mut self, summary: &Summary, row: &Row) {
        self.rpm.add(row.t_s, row.spindle_rpm);
        self.spindle_turns |= row.spindle_rpm.abs() > 0.5;
        self.override_pct.add(row.t_s, row.override_pct);
        self.path.add(row);
        self.tools.add(summary, row);
        self.moves.add(summary, row);
        self.traces.iter_mut().for_each(|trace| trace.add(summary, row));
        let index = summary.passes.partition_point(|pass| pass.end_cycle < row.cycle);
        let pass = summary.passes.get(index).filter(|pass| pass.armed_cycle <= row.cycle);
        self.part.add(summary, pass.map(|_| index), row);
        let Some(pass) = pass else { return };
        let c = pass.direction * (row.spindle_true_deg - pass.index_deg);
        self.passes[index].add(pass, c, row);
        self.error_map.add(summary, index, c, row);
        self.cutting.add(summary, index, row);
        if index == self.shown_index {
            let shown = self.shown.get_or_insert_with(|| ShownCurves::new(pass, c));
            shown.add(summary, c, row);
        }
    }
}

impl PassCurves {
    fn add(&mut self, pass: &PassReport, c: f64, row: &Row) {
        for (axis, curve) in AXES.into_iter().zip(&mut self.servo) {
            if let Some(axis) = row.axis(axis) {
                curve.add(c, 1e3 * axis.servo_error);
            }
        }
        let locked = |axis: &Axis| row.axis(*axis).is_some_and(|axis| axis.state == AxisState::Locked);
        if let (true, Some(z)) = (AXES.iter().all(locked), row.axis(Axis::Z)) {
            let error = z.true_mm - pass.helix_mm(c);
            self.helix.add((c - thread_deg(pass).0) / 360.0, 1e3 * error);
        }
    }
}

impl ShownCurves {
    fn new(pass: &PassReport, armed_deg: f64) -> ShownCurves {
        let curve = Envelope::new(armed_deg, moving_deg(pass).1, MOST_SLOTS);
        let both = [curve.clone(), curve.clone()];
        let used = [curve.clone(), curve.clone(), curve];
        ShownCurves {
            programmed: both.clone(),
            position: both.clone(),
            used: [used.clone(), used],
            servo: both.clone(),
            slide: both,
            armed_deg,
        }
    }

    fn add(&mut self, summary: &Summary, c: f64, row: &Row) {
        for (index, axis) in AXES.into_iter().enumerate() {
            let Some(at) = row.axis(axis) else { continue };
            self.programmed[index].add(c, at.programmed);
            self.position[index].add(c, at.true_mm);
            self.servo[index].add(c, 1e3 * at.servo_error);
            self.slide[index].add(c, 1e3 * (at.commanded - at.slide));
            let Some(limits) = summary.limits.get(&axis) else { continue };
            let [v, a, j] = &mut self.used[index];
            v.add(c, 100.0 * at.velocity / limits.velocity_mm_s);
            a.add(c, 100.0 * at.acceleration / limits.acceleration_mm_s2);
            j.add(c, 100.0 * at.jerk / limits.jerk_mm_s3);
        }
    }
}
