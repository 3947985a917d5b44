//! The curves of a report, gathered while the trace is read once. In: rows in mm and degrees. Out: curves in
//! µm over degrees or turns, in mm, in per cent of limits, and over seconds.

use protocol::{Axis, AxisState};
use rig::observe::{PassReport, Summary};
use rig::trace::Row;

use super::curves_moves::MovesCurves;
use super::cutting::CutCurves;
use super::traces::TraceCurves;
use crate::envelope::Envelope;

/// Points kept of all passes together; a single curve has at least [`LEAST_SLOTS`] and at most [`MOST_SLOTS`]
/// intervals.
const ALL_SLOTS: usize = 12_000;
const LEAST_SLOTS: usize = 60;
const MOST_SLOTS: usize = 700;
/// The tool path keeps a point when the tool has moved this far since the last one kept, mm; the distance is
/// doubled whenever there are too many points.
const PATH_STEP_MM: f64 = 0.02;
const PATH_POINTS: usize = 24_000;

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
    /// The plane of the tool path, to the right and upwards: Z and X of a lathe, X and Y of a mill.
    pub(super) plane: [Axis; 2],
    /// True tool path in that plane, mm; `None` lifts the pen. Timed motion, and passes.
    pub(super) path: [Vec<Option<(f64, f64)>>; 2],
    path_at: (usize, f64, f64),
    path_step_mm: f64,
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
    /// Timed motion.
    pub(super) moves: MovesCurves,
    /// Contours, surfaces and seams.
    pub(super) traces: Vec<TraceCurves>,
}

/// The axes of a pass.
const AXES: [Axis; 2] = [Axis::X, Axis::Z];
const LATHE_PLANE: [Axis; 2] = [Axis::Z, Axis::X];
pub(super) const MILL_PLANE: [Axis; 2] = [Axis::X, Axis::Y];

/// The pass that is shown in full: the deepest of those that were cut to their end, else the first.
fn shown_index(passes: &[PassReport]) -> usize {
    let complete = passes.iter().enumerate().filter(|(_, pass)| pass.complete);
    complete.max_by(|(_, a), (_, b)| a.depth_mm.total_cmp(&b.depth_mm)).map_or(0, |(index, _)| index)
}

/// Angles between which any axis of a pass moves, degrees.
pub(super) fn moving_deg(pass: &PassReport) -> (f64, f64) {
    let ([x_from, .., x_to], [z_from, .., z_to]) = (pass.x_moments_deg, pass.z_moments_deg);
    (x_from.min(z_from), x_to.max(z_to))
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
        let mill = summary.limits.contains_key(&Axis::Y);
        Curves {
            plane: if mill { MILL_PLANE } else { LATHE_PLANE },
            path: Default::default(),
            path_at: (usize::MAX, 0.0, 0.0),
            path_step_mm: PATH_STEP_MM,
            passes: summary.passes.iter().map(of_pass).collect(),
            shown_index: shown_index(&summary.passes),
            shown: None,
            rpm: over_time.clone(),
            spindle_turns: false,
            override_pct: over_time,
            cutting: CutCurves::new(summary, slots),
            moves: MovesCurves::new(summary),
            traces: TraceCurves::all(summary),
        }
    }

    /// Takes the next row.
    pub(super) fn add(&mut self, summary: &Summary, row: &Row) {
        self.rpm.add(row.t_s, row.spindle_rpm);
        self.spindle_turns |= row.spindle_rpm.abs() > 0.5;
        self.override_pct.add(row.t_s, row.override_pct);
        self.add_path(row);
        self.moves.add(summary, row);
        self.traces.iter_mut().for_each(|trace| trace.add(summary, row));
        let index = summary.passes.partition_point(|pass| pass.end_cycle < row.cycle);
        let Some(pass) = summary.passes.get(index).filter(|pass| pass.armed_cycle <= row.cycle) else {
            return;
        };
        let c = pass.direction * (row.spindle_true_deg - pass.index_deg);
        self.passes[index].add(pass, c, row);
        self.cutting.add(summary, index, row);
        if index == self.shown_index {
            let shown = self.shown.get_or_insert_with(|| ShownCurves::new(pass, c));
            shown.add(summary, c, row);
        }
    }

    fn add_path(&mut self, row: &Row) {
        let [Some(right), Some(up)] = self.plane.map(|axis| row.axis(axis)) else { return };
        let in_pass = |state| (AxisState::RunIn..=AxisState::RunOut).contains(&state);
        let cutting = in_pass(right.state) || in_pass(up.state);
        let (kind, place) = (usize::from(cutting), (right.true_mm, up.true_mm));
        let (before, right_before, up_before) = self.path_at;
        let moved = libm::hypot(place.0 - right_before, place.1 - up_before);
        if before != kind {
            // Joins what follows to where the other kind of motion ended.
            if before != usize::MAX {
                self.path[before].extend([Some(place), None]);
            }
        } else if moved < self.path_step_mm {
            return;
        }
        self.path[kind].push(Some(place));
        self.path_at = (kind, place.0, place.1);
        if self.path.iter().map(Vec::len).sum::<usize>() > PATH_POINTS {
            self.path_step_mm *= 2.0;
            self.path.iter_mut().for_each(thin);
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
            let error = z.true_mm - pass.helix_at_index_mm - pass.lead_mm * c / 360.0;
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

/// Leaves out every other point of a path, but not the ends of its strokes.
fn thin(points: &mut Vec<Option<(f64, f64)>>) {
    let before = std::mem::take(points);
    let inner = |index: usize| {
        let neighbour =
            |other: Option<usize>| other.and_then(|other| before.get(other)).is_some_and(Option::is_some);
        before[index].is_some() && neighbour(index.checked_sub(1)) && neighbour(Some(index + 1))
    };
    let kept = (0..before.len()).filter(|index| index % 2 == 0 || !inner(*index));
    *points = kept.map(|index| before[index]).collect();
}

#[cfg(test)]
mod tests {
    use super::thin;

    #[test]
    fn thinning_keeps_the_ends_of_every_stroke() {
        let stroke = |from: i32, to: i32| (from..to).map(|z| Some((f64::from(z), 0.0))).chain([None]);
        let mut points: Vec<_> = stroke(0, 10).chain(stroke(20, 29)).collect();
        thin(&mut points);
        let kept: Vec<_> = points.iter().map(|point| point.map_or(-1, |point| point.0 as i32)).collect();
        assert_eq!(kept, [0, 2, 4, 6, 8, 9, -1, 20, 21, 23, 25, 27, 28, -1]);
    }
}
