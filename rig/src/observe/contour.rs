//! How far the axes are from the commanded path in timed motion. In: one [`Record`] each control cycle, mm. Out: the
//! contour error, µm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | c, v | mm, mm/s | commanded position and speed of the linear axes |
//! | p | mm | their true positions at the motors |
//!
//! ```text
//! e = p − c,   contour error = |e − (e·v) v/v²|          the part that is normal to the motion
//! ```
//! What is along the path is a matter of time, not of shape, and is left out. Rotary axes have no place in a distance.

use protocol::{Axis, AxisState};

use super::{MovesReport, Record};

/// Slower than this is standing, mm/s: there is no direction to be normal to.
const STANDS_MM_S: f64 = 1e-3;

/// The part of the error that is normal to the motion, as a vector over `axes` in mm; `None` if the axes do not move,
/// or not in timed motion.
pub(super) fn normal_error(record: &Record) -> Option<impl Iterator<Item = (Axis, f64)>> {
    if record.axes.iter().any(|(_, status)| status.state != AxisState::Streaming as u32) {
        return None;
    }
    let linear = || record.axes.iter().filter(|(axis, _)| !axis.is_rotary());
    let error = |axis: Axis, commanded: f64| record.truth.axes[axis.index()].motor_mm - commanded;
    let (mut along, mut square) = (0.0, 0.0);
    for (axis, status) in linear() {
        along += error(*axis, status.commanded_mm) * status.velocity_mm_s;
        square += status.velocity_mm_s * status.velocity_mm_s;
    }
    let share = along / square;
    (square > STANDS_MM_S * STANDS_MM_S).then(|| {
        linear().map(move |(axis, status)| {
            (*axis, error(*axis, status.commanded_mm) - share * status.velocity_mm_s)
        })
    })
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
    /// Takes one control cycle; what it adds, mm.
    pub(super) fn cycle(&mut self, record: &Record) {
        let Some(error) = normal_error(record) else { return };
        let square: f64 = error.map(|(_, mm)| mm * mm).sum();
        self.sum_of_squares += square;
        self.cycles += 1;
        if square > self.max_mm * self.max_mm {
            self.max_mm = square.sqrt();
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
