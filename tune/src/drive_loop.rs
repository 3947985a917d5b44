//! The torque that the drive commands. The drive does not report it, but its velocity loop is configured from
//! the machine file and works on the encoder alone, so it can be computed beside it. In: the commanded speed
//! in mm/s, the encoder's speed over the last cycle in mm/s, the torque offset in N·m. Out: N·m.
//!
//! ```text
//! u = Kp (v_cmd − v) + I + offset,   I += Kp T/Ti (v_cmd − v),   Kp = M 2π f_v lead/2π                 (M54)
//! ```

use core::f64::consts::TAU;

use machine::AxisConfig;

/// Gain of the velocity loop of an axis as configured, N·m s/mm.
pub(crate) fn gain(config: &AxisConfig) -> f64 {
    config.mass_kg * TAU * config.velocity_bandwidth_hz * metres_per_radian(config) * 1e-3
}

/// Way of the axis for an angle of the motor, m/rad; a torque in N·m divided by it is a force in N.
pub(crate) fn metres_per_radian(config: &AxisConfig) -> f64 {
    config.screw_lead_mm * 1e-3 / TAU
}

/// Velocity loop of a drive, run beside it.
#[derive(Clone, Debug)]
pub(crate) struct DriveLoop {
    gain: f64,
    integral_gain: f64,
    integral_nm: f64,
}

impl DriveLoop {
    /// As the drive is when operation is enabled.
    pub(crate) fn new(config: &AxisConfig, cycle_s: f64) -> DriveLoop {
        let gain = gain(config);
        DriveLoop { gain, integral_gain: gain * cycle_s / config.velocity_integral_s, integral_nm: 0.0 }
    }

    /// One cycle. The stand ends a test whose torque comes to its limit, so none is applied here.
    pub(crate) fn torque(&mut self, error_mm_s: f64, offset_nm: f64) -> f64 {
        self.integral_nm += self.integral_gain * error_mm_s;
        self.gain * error_mm_s + self.integral_nm + offset_nm
    }
}
