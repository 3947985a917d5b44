//! Cogging: the magnets of the rotor hold on to the teeth of the stator.
//! In: way of the motor, m. Out: force at the slide against its motion, N.
//!
//! ```text
//! T_g sin(n_g 2π x/lead + phi) · 2π/lead                                                            (M108)
//! ```
//! It takes as much as it gives on every turn, and no drive measures it: no current flows for it.

use core::f64::consts::TAU;

/// The cogging of one motor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cogging {
    force_n: f64,
    per_m: f64,
    phase: f64,
}

impl Cogging {
    /// A torque in N·m, so often a turn, with 2π/lead in 1/m and a phase as a share of one; `None` for no
    /// torque.
    pub(super) fn new(torque_nm: f64, per_rev: u32, turns: f64, phase: f64) -> Option<Cogging> {
        let per_m = f64::from(per_rev) * turns;
        (torque_nm > 0.0).then_some(Cogging { force_n: torque_nm * turns, per_m, phase: TAU * phase })
    }

    /// Its force at a place of the motor.
    #[inline]
    pub(super) fn against(&self, motor_m: f64) -> f64 {
        self.force_n * libm::sin(self.per_m * motor_m + self.phase)
    }

    /// Its steepest spring, N/m.
    pub(super) fn stiffness(&self) -> f64 {
        self.force_n * self.per_m
    }
}
