//! The curves of timed motion. In: rows in mm and degrees. Out: contour error over seconds, deviation of the
//! worst circle over the angle gone, in µm.

use rig::observe::{CircleReport, Summary};
use rig::trace::{Row, STRIDE};

use crate::envelope::Envelope;

/// Intervals of the curve over time, and of one turn of a circle.
const SLOTS: usize = 1400;
const SLOTS_A_TURN: usize = 720;

/// Curves of timed motion.
pub(super) struct MovesCurves {
    /// Contour error over time, µm.
    pub(super) contour: Envelope,
    /// The circle that is drawn.
    pub(super) lap: Option<LapCurve>,
}

/// The deviation of a circle.
pub(super) struct LapCurve {
    /// Where its report stands in the summary.
    pub(super) index: usize,
    /// Direction of its first point from the centre, degrees.
    pub(super) from_deg: f64,
    /// Deviation over the angle gone since then, degrees, µm.
    pub(super) deviation: Envelope,
    before_deg: Option<f64>,
    swept_deg: f64,
}

impl MovesCurves {
    /// Empty curves for a run.
    pub(super) fn new(summary: &Summary) -> MovesCurves {
        let circles = summary.moves.circles.iter().enumerate();
        let worst = circles.max_by(|(_, a), (_, b)| a.round_max_um.total_cmp(&b.round_max_um));
        MovesCurves {
            contour: Envelope::new(0.0, summary.simulated_s, SLOTS),
            lap: worst.map(|(index, circle)| LapCurve::new(index, circle)),
        }
    }

    /// Takes the next row.
    pub(super) fn add(&mut self, summary: &Summary, row: &Row) {
        if let Some(mm) = row.contour_error_mm() {
            self.contour.add(row.t_s, 1e3 * mm);
        }
        if let Some(lap) = &mut self.lap
            && let Some(circle) = summary.moves.circles.get(lap.index)
            && (circle.begin_cycle..=circle.end_cycle).contains(&row.cycle)
        {
            lap.add(circle, row);
        }
    }
}

impl LapCurve {
    fn new(index: usize, circle: &CircleReport) -> LapCurve {
        let swept = circle.swept_deg.abs() + 1.0;
        let slots = (swept / 360.0 * SLOTS_A_TURN as f64).clamp(1.0, 20.0 * SLOTS_A_TURN as f64) as usize;
        let cycles = circle.end_cycle.saturating_sub(circle.begin_cycle).max(1) as f64;
        LapCurve {
            index,
            from_deg: 0.0,
            deviation: Envelope::new(0.0, swept, slots).with_steps(2.0 * STRIDE as f64 * swept / cycles),
            before_deg: None,
            swept_deg: 0.0,
        }
    }

    fn add(&mut self, circle: &CircleReport, row: &Row) {
        let [Some(first), Some(second)] = circle.plane.map(|axis| row.axis(axis)) else { return };
        let from_center = |at: [f64; 2]| [at[0] - circle.center_mm[0], at[1] - circle.center_mm[1]];
        let [x, y] = from_center([first.commanded, second.commanded]);
        let [p, q] = from_center([first.true_mm, second.true_mm]);
        let psi = libm::atan2(y, x).to_degrees();
        match self.before_deg.replace(psi) {
            Some(before) => self.swept_deg += psi - before - 360.0 * ((psi - before) / 360.0).round(),
            None => self.from_deg = psi,
        }
        self.deviation.add(self.swept_deg.abs(), 1e3 * (libm::hypot(p, q) - circle.radius_mm));
    }
}
