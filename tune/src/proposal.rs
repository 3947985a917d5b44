//! The `[axis.*]` that follows from what was identified. In: what was identified, the margins that are
//! wanted. Out: the axis as it should be configured.
//!
//! ```text
//! velocity lead −T/2: speed is measured by one difference;   acceleration lead δ + T/2 + τ             (M54)
//! f_v: the highest with the wanted margins of the velocity loop, with Ti = 4/(2π f_v):
//!      the integral takes 14° there
//! Kv:  the highest with the wanted margins of the position loop;
//!      no higher than it was over a scale behind a backlash                                (M82)
//! ```

use core::f64::consts::TAU;

use machine::AxisConfig;
use protocol::Axis;

use crate::{
    margins::{self, LoopMargins, Timing},
    mode::Mode,
    refusal::Refusal,
    response::Line,
};

/// Ti times the angular frequency of the velocity bandwidth.
const INTEGRAL: f64 = 4.0;
/// Steps of a search for a gain, a factor.
const STEP: f64 = 1.01;
/// Gains that are tried: velocity bandwidth in Hz, position gain in 1/s.
const BANDWIDTHS_HZ: (f64, f64) = (2.0, 500.0);
const POSITION_GAINS: (f64, f64) = (1.0, 1000.0);

/// What is wanted of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goals {
    /// Least phase margin of the velocity loop, degrees.
    pub velocity_phase_deg: f64,
    /// Least gain margin of the velocity loop.
    pub velocity_gain: f64,
    /// Least phase margin of the position loop, degrees.
    pub position_phase_deg: f64,
    /// Least gain margin of the position loop.
    pub position_gain: f64,
    /// Stroke of an approach whose residual vibration is asked for, mm.
    pub stroke_mm: f64,
    /// Residual vibration that may be left of it, µm.
    pub residual_um: f64,
}

impl Default for Goals {
    fn default() -> Self {
        Goals {
            velocity_phase_deg: 35.0,
            velocity_gain: 2.2,
            position_phase_deg: 60.0,
            position_gain: 3.0,
            stroke_mm: 5.0,
            residual_um: 0.2,
        }
    }
}

impl Goals {
    fn velocity(&self, found: &LoopMargins) -> bool {
        found.crosses() && found.phase_deg >= self.velocity_phase_deg && found.gain >= self.velocity_gain
    }

    fn position(&self, found: &LoopMargins) -> bool {
        found.crosses() && found.phase_deg >= self.position_phase_deg && found.gain >= self.position_gain
    }
}

/// Sets the gains of an axis whose identified values are set already.
pub(crate) fn gains(
    axis: Axis,
    config: &mut AxisConfig,
    lines: &[Line],
    timing: Timing,
    goals: &Goals,
) -> Result<(), Refusal> {
    let with = |config: &AxisConfig, hz: f64| AxisConfig {
        velocity_bandwidth_hz: hz,
        velocity_integral_s: INTEGRAL / (TAU * hz),
        ..config.clone()
    };
    let good = |hz| goals.velocity(&margins::of(lines, &with(config, hz), timing).velocity);
    let Goals { velocity_phase_deg: phase, velocity_gain: gain, .. } = *goals;
    let hz = highest(BANDWIDTHS_HZ, good).ok_or(Refusal::NoGain(axis, "velocity", phase, gain))?;
    *config = with(config, hz);
    let with = |kv: f64| AxisConfig { position_gain_1_s: kv, ..config.clone() };
    let good = |kv| goals.position(&margins::of(lines, &with(kv), timing).position);
    let Goals { position_phase_deg: phase, position_gain: gain, .. } = *goals;
    let kv = highest(POSITION_GAINS, good).ok_or(Refusal::NoGain(axis, "position", phase, gain))?;
    // Margins are those of a linear loop. One that closes behind a backlash hunts at gains they allow.
    let slack = config.scale_step_mm.is_some() && config.backlash_mm > 0.0;
    config.position_gain_1_s = if slack { kv.min(config.position_gain_1_s) } else { kv };
    Ok(())
}

/// A value in so many significant digits.
pub(crate) fn digits(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value)
}

/// The identified keys and gains with the digits that a machine file shall show. Leads keep those of a
/// microsecond.
pub(crate) fn rounded(config: AxisConfig) -> AxisConfig {
    let microsecond = |seconds: f64| (seconds * 1e6).round() / 1e6;
    AxisConfig {
        mass_kg: digits(config.mass_kg, 5),
        coulomb_n: digits(config.coulomb_n, 4),
        viscous_n_s_mm: digits(config.viscous_n_s_mm, 3),
        presliding_n_mm: digits(config.presliding_n_mm, 3),
        velocity_lead_s: microsecond(config.velocity_lead_s),
        acceleration_lead_s: microsecond(config.acceleration_lead_s),
        velocity_bandwidth_hz: digits(config.velocity_bandwidth_hz, 3),
        velocity_integral_s: digits(config.velocity_integral_s, 3),
        position_gain_1_s: digits(config.position_gain_1_s, 3),
        gravity_n: digits(config.gravity_n, 4),
        ..config
    }
}

/// The highest gain that is good together with all good ones just below it, from the lowest good one on.
fn highest((low, high): (f64, f64), good: impl Fn(f64) -> bool) -> Option<f64> {
    let steps = (libm::log(high / low) / libm::log(STEP)) as i32;
    let gains = (0..=steps).map(|step| low * libm::pow(STEP, f64::from(step)));
    gains.skip_while(|gain| !good(*gain)).take_while(|gain| good(*gain)).last()
}

/// Shortest time of an approach that leaves no more than the wanted residual in a mode (M8a), s.
pub(crate) fn shortest_approach(mode: &Mode, goals: &Goals) -> f64 {
    let hz = mode.hz.value;
    let left = |time_s: f64| motion::Stroke::new(goals.stroke_mm, time_s).residual_bound(hz);
    let (mut low, mut high) = (2.0 / hz, 2.0 / hz);
    while left(high) > goals.residual_um * 1e-3 && high < 1e3 {
        (low, high) = (high, 2.0 * high);
    }
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if left(middle) > goals.residual_um * 1e-3 { low = middle } else { high = middle }
    }
    high
}
