//! `[plant.spindle]`: what is true of the spindle. In: its table. Out: checked values in the units of their
//! names.

use serde::Deserialize;

use super::{PlantError, range};

/// `[plant.spindle]`: motor and drive, everything that turns, and what makes its speed uneven.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct SpindleTrain {
    /// Everything that turns, referred to the spindle, kg m².
    pub(crate) inertia_kg_m2: f64,
    /// Limits of the motor at the spindle: torque below, power above the corner speed.
    pub(crate) peak_torque_nm: f64,
    pub(crate) peak_power_kw: f64,
    /// Friction of belt and bearings.
    pub(crate) coulomb_nm: f64,
    pub(crate) viscous_nm_s: f64,
    /// Speed loop of the drive: Kp = inertia × 2π × bandwidth, integral time, and lag of the torque.
    pub(crate) speed_bandwidth_hz: f64,
    pub(crate) speed_integral_s: f64,
    pub(crate) torque_lag_s: f64,
    /// Ripple of the speed, per cent of it, and how often a turn it comes.
    pub(crate) ripple_pct: f64,
    pub(crate) ripple_per_rev: u32,
}

impl Default for SpindleTrain {
    fn default() -> Self {
        SpindleTrain {
            inertia_kg_m2: 0.15,
            peak_torque_nm: 60.0,
            peak_power_kw: 7.5,
            coulomb_nm: 1.0,
            viscous_nm_s: 0.01,
            speed_bandwidth_hz: 3.0,
            speed_integral_s: 0.15,
            torque_lag_s: 0.002,
            ripple_pct: 0.2,
            ripple_per_rev: 2,
        }
    }
}

impl SpindleTrain {
    pub(super) fn check(&self) -> Result<(), PlantError> {
        for (name, value, low, high) in [
            ("inertia_kg_m2", self.inertia_kg_m2, 1e-4, 1e4),
            ("peak_torque_nm", self.peak_torque_nm, 0.1, 1e5),
            ("peak_power_kw", self.peak_power_kw, 0.01, 1e4),
            ("coulomb_nm", self.coulomb_nm, 0.0, 0.9 * self.peak_torque_nm),
            ("viscous_nm_s", self.viscous_nm_s, 0.0, 10.0),
            ("speed_bandwidth_hz", self.speed_bandwidth_hz, 0.1, 50.0),
            ("speed_integral_s", self.speed_integral_s, 0.005, 100.0),
            ("torque_lag_s", self.torque_lag_s, 1e-5, 0.1),
            ("ripple_pct", self.ripple_pct, 0.0, 10.0),
            ("ripple_per_rev", f64::from(self.ripple_per_rev), 1.0, 100.0),
        ] {
            range(&format!("plant.spindle.{name}"), value, low, high)?;
        }
        Ok(())
    }
}
