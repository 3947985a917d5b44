//! How far the axes are from the commanded path in timed motion. In: one [`Record`] each control cycle, mm.
//! Out: the contour error, µm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | c, v | mm, mm/s | commanded position and speed of the linear axes |
//! | p | mm | their true positions at the motors |
//!
//! ```text
//! e = p − c,   contour error = |e − (e·v) v/v²|          the part that is normal to the motion
//! ```
//! What is along the path is a matter of time, not of shape, and is left out. Rotary axes have no place in a
//! distance.

use protocol::{AxisState, AxisStatus};

use super::{MovesReport, Record};

/// Slower than this is standing, mm/s: there is no direction to be normal to.
const STANDS_MM_S: f64 = 1e-3;

/// The contour error of linear axes, each as true minus commanded position and commanded speed, mm and mm/s;
/// `None` if they stand.
pub(crate) fn contour_error_mm(axes: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let (mut error, mut along, mut speed) = (0.0, 0.0, 0.0);
    for (e, v) in axes {
        (error, along, speed) = (error + e * e, along + e * v, speed + v * v);
    }
    (speed > STANDS_MM_S * STANDS_MM_S).then(|| (error - along * along / speed).max(0.0).sqrt())
}

/// The contour error of a run so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Contour {
    max_mm: f64,
    /// Line and cycle of it.
    worst: (u32, u64),
    sum_of_squares: f64,
    cycles: u64,
}

impl Contour {
    /// Takes one control cycle.
    pub(super) fn cycle(&mut self, record: &Record) {
        // Who has missed a measurement says nothing of this cycle.
        let tells = |status: &AxisStatus| {
            status.state() == AxisState::Streaming && status.cycle == record.truth.cycle
        };
        // Nor does an axis of which nobody knows where it is.
        if record.machine.unreferenced != 0 || !record.axes.iter().all(|(_, status)| tells(status)) {
            return;
        }
        let linear = record.axes.iter().filter(|(axis, _)| !axis.is_rotary());
        let error = contour_error_mm(linear.map(|(axis, status)| {
            (record.truth.axes[axis.index()].motor_mm - status.commanded_mm, status.velocity_mm_s)
        }));
        let Some(error) = error else { return };
        self.sum_of_squares += error * error;
        self.cycles += 1;
        if error > self.max_mm {
            self.max_mm = error;
            let line = record.axes.first().map_or(record.machine.line, |(_, status)| status.line);
            self.worst = (line, record.truth.cycle.0);
        }
    }

    /// Writes the result.
    pub(super) fn report(&self, cycle_s: f64, moves: &mut MovesReport) {
        moves.contour_max_um = 1e3 * self.max_mm;
        moves.contour_rms_um = 1e3 * (self.sum_of_squares / self.cycles.max(1) as f64).sqrt();
        moves.contour_line = self.worst.0;
        moves.contour_t_s = self.worst.1 as f64 * cycle_s;
    }
}
