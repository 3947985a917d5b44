//! One pass with positions that are rounded. In: a machine, a seed. Out: servo error of X in µm, torque in
//! N·m.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | τ, c | N·m | torque of the motor at the start of a cycle, torque that the drive asked for in it |
//! | T, T_c | s | control cycle, lag of the current loop |
//! | M, lead | kg, m | moving mass, lead of the screw |
//! | q, h | mm, s | quantum of positions, time from one position to the next |
//! | f_v | Hz | bandwidth of the velocity loop |
//!
//! ```text
//! τ(n+1) = c + (τ(n) − c) exp(−T/T_c),  so c = (τ(n+1) − τ(n) E)/(1 − E) with E = exp(−T/T_c)
//! torque noise = rms of c(t + h) − c(t) in the approach
//! foretold: M lead/2π · q/h² · (20/12 + (2π f_v h)² 6/12)^½                                            (M77)
//! ```
//! M77: a step of the acceleration is a third difference of rounded positions, one of the speed a second
//! (M28); the velocity loop makes torque of both. The leads of the two differ, so their errors of rounding
//! are independent.

use core::f64::consts::TAU;

use adviser::resolution::difference_rms;
use machine::{AxisConfig, Machine};
use protocol::{Axis, AxisState};
use rig::{observe::Record, trial::Trial};

use super::HOLD_CYCLES;
use crate::{ExperimentError, stand::Stand};

/// X in one control cycle of the approach.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment {
    /// Since the approach began, s.
    pub(super) t_s: f64,
    pub(super) error_um: f64,
    /// Asked for by the drive.
    pub(super) torque_nm: f64,
}

/// What was measured of a pass.
#[derive(Clone, Debug)]
pub(super) struct Measured {
    pub(super) approach_min_um: f64,
    pub(super) approach_max_um: f64,
    pub(super) end_um: f64,
    /// Largest from one turn after the approach on.
    pub(super) thread_max_abs_um: f64,
    pub(super) torque_noise_nm: f64,
    pub(super) curve: Vec<Moment>,
}

/// Runs the pass of the published experiment.
///
/// # Errors
/// As [`Stand::run`].
pub(super) fn measure(machine: &Machine, seed: u64) -> Result<Measured, ExperimentError> {
    let cycle_s = machine.general.cycle_s;
    let lag_s = sim_plant::current_lag_s(machine, Axis::X)
        .map_err(|error| ExperimentError::Input(error.to_string()))?;
    let left = libm::exp(-cycle_s / lag_s);
    let (mut curve, mut before_nm): (Vec<Moment>, f64) = (Vec::new(), 0.0);
    let seen = Stand::run(machine, &[Trial::default()], 100.0, seed, &mut |record: &Record| {
        let torque_nm = record.truth.axes[Axis::X.index()].torque_nm;
        let asked_nm = (torque_nm - left * before_nm) / (1.0 - left);
        before_nm = torque_nm;
        let Some((_, status)) = record.axes.iter().find(|(axis, _)| *axis == Axis::X) else { return };
        if status.state() == AxisState::RunIn {
            let t_s = curve.len() as f64 * cycle_s;
            curve.push(Moment { t_s, error_um: 1e3 * status.servo_error_mm, torque_nm: asked_nm });
        }
    })?;
    let error = seen.passes.first().map(|pass| pass.x).unwrap_or_default();
    Ok(Measured {
        approach_min_um: error.approach_min_um,
        approach_max_um: error.approach_max_um,
        end_um: error.end_um,
        thread_max_abs_um: error.settled_max_abs_um,
        torque_noise_nm: noise(&curve),
        curve,
    })
}

/// Root of the mean square of the steps of torque from one position to the next, N·m.
fn noise(curve: &[Moment]) -> f64 {
    let later = curve.iter().skip(HOLD_CYCLES as usize);
    let squares: Vec<f64> =
        curve.iter().zip(later).map(|(at, then)| (then.torque_nm - at.torque_nm).powi(2)).collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

/// The torque noise that rounding to `quantum_mm` makes by itself, N·m (M77).
pub(super) fn foretold(x: &AxisConfig, cycle_s: f64, quantum_mm: f64) -> f64 {
    let h = f64::from(HOLD_CYCLES) * cycle_s;
    let loop_gain = TAU * x.velocity_bandwidth_hz * h;
    let rms = (difference_rms(3).powi(2) + (loop_gain * difference_rms(2)).powi(2)).sqrt();
    let force_n = x.mass_kg * 1e-3 * quantum_mm / (h * h) * rms;
    force_n * x.screw_lead_mm * 1e-3 / TAU
}
