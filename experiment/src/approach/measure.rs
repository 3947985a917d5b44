//! One pass of the published experiment on the whole machine. In: a machine, an override in per cent, a seed.
//! Out: servo errors of X in µm, its torque in N·m, and the approach as curves.

use machine::Machine;
use protocol::{Axis, AxisState};
use rig::{
    observe::{Record, ServoError},
    trial::Trial,
};

use crate::{ExperimentError, stand::Stand};

/// How long the curves go on after the approach, s.
const AFTER_S: f64 = 0.1;

/// X in one control cycle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment {
    /// Since the approach began, s.
    pub(super) t_s: f64,
    /// Commanded way, mm.
    pub(super) way_mm: f64,
    /// Commanded speed, mm/s.
    pub(super) v_mm_s: f64,
    /// Commanded acceleration, mm/s².
    pub(super) a_mm_s2: f64,
    /// Servo error, µm.
    pub(super) error_um: f64,
    /// Measured torque, N·m.
    pub(super) torque_nm: f64,
    /// It is under its stroke; later it rests at depth.
    approaches: bool,
}

/// What was measured of a pass.
#[derive(Clone, Debug)]
pub(super) struct Measured {
    /// Of X, by the summary of a run.
    pub(super) error: ServoError,
    /// Largest magnitude of torque in the approach, N·m.
    pub(super) torque_peak_nm: f64,
    /// Root of the mean square of the change of torque from cycle to cycle in the approach, N·m.
    pub(super) torque_noise_nm: f64,
    /// The approach and a little more, cycle by cycle.
    pub(super) curve: Vec<Moment>,
}

/// Runs the pass.
///
/// # Errors
/// As [`Stand::run`].
pub(super) fn measure(machine: &Machine, override_pct: f64, seed: u64) -> Result<Measured, ExperimentError> {
    let cycle_s = machine.general.cycle_s;
    let after = (AFTER_S / cycle_s) as usize;
    let mut curve: Vec<Moment> = Vec::new();
    let (mut start_mm, mut rested) = (0.0, 0);
    let trial = [Trial::default()];
    let seen = Stand::run(machine, &trial, override_pct, seed, &mut |record: &Record| {
        let Some((_, status)) = record.axes.iter().find(|(axis, _)| *axis == Axis::X) else { return };
        let approaches = status.state() == AxisState::RunIn;
        let rests = status.state() == AxisState::Locked;
        rested += usize::from(rests);
        let shown = approaches || (rests && rested <= after);
        if !shown {
            return;
        }
        if curve.is_empty() {
            start_mm = status.commanded_mm;
        }
        curve.push(Moment {
            t_s: curve.len() as f64 * cycle_s,
            way_mm: status.commanded_mm - start_mm,
            v_mm_s: status.velocity_mm_s,
            a_mm_s2: status.acceleration_mm_s2,
            error_um: 1e3 * status.servo_error_mm,
            torque_nm: record.truth.measurement.axes[Axis::X.index()].torque_nm,
            approaches,
        });
    })?;
    let torques: Vec<f64> =
        curve.iter().filter(|moment| moment.approaches).map(|moment| moment.torque_nm).collect();
    let squares: f64 = torques.windows(2).map(|pair| (pair[1] - pair[0]) * (pair[1] - pair[0])).sum();
    Ok(Measured {
        error: seen.passes.first().map(|pass| pass.x).unwrap_or_default(),
        torque_peak_nm: torques.iter().fold(0.0, |peak, torque| peak.max(torque.abs())),
        torque_noise_nm: (squares / torques.len().saturating_sub(1).max(1) as f64).sqrt(),
        curve,
    })
}
