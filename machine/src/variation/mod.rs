//! Spindle speed variation in the thread: what a pass becomes by it, before it is cut. In: a variation, a
//! pass, the machine as the controller believes it to be. Out: speeds in 1/min, the bound on the error of the
//! thread in µm, the highest override; or why it cannot be, and what would do instead.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | S, r, a | turn/s, –, – | programmed speed, override, share of the variation |
//! | α, j | turn/s², turn/s³ | peaks of the angle's acceleration and jerk (M231), at r S |
//! | L, q | mm/turn, turn | lead of an axis, a count of the spindle encoder |
//! | ω, τ | rad/s, s | bandwidth of the observer (M53) that leads an axis; how far ahead of its counts it is asked |
//! | K, ω_v, ω_m | 1/s, rad/s | gain of the position loop, bandwidth of the velocity loop, mode of the slide |
//! | R, M | –, – | highest override at which the axes can follow the pass; at which the spindle is at its top speed |
//! | W | – | from which the axes take the spindle for one that has run away (M103) |
//! | ramp | turn/s² | of the drive |
//!
//! ```text
//! e = |L| (j (1/ω³ + 3τ/ω² + 3τ²/2ω + τ³/6) + 2.5 q + α (0.1/(K ω_v) + 0.2/ω_m²))                (M232)
//! r (1 + a) ≤ R,  r (1 + a) ≤ M,  1.05 r (1 + a) ≤ W,  α ≤ 0.9 ramp,  e ≤ error_um               (M233)
//! ```
//! The first term of M232 is what the observer does not know yet: its state errs by j times 1/(s + ω)³ in the
//! angle, (s + 3ω)/(s + ω)³ in the speed, (s² + 3ωs + 3ω²)/(s + ω)³ in the acceleration. None of these has an
//! impulse response that changes its sign, so each errs at most by its gain at rest times the largest jerk.
//! The second is an allowance for what the observer takes for the rounding of counts (one count, one and a
//! half of a slow spindle) and the rounding itself; a search with the observer holds it (`tests.rs`). The
//! third is what loops leave of a mass believed a tenth off, and a mode a tenth off; an axis without
//! `mode_hz` is believed to be rigid.
//!
//! `error_um` is that of `[threading.variation]`. What of the torque of the spindle's drive a variation may
//! take is said by its ramp: a tenth is left for what the cut takes.

mod config;
mod law;

use core::f64::consts::TAU;

use protocol::{AxisLaw, ThreadPass, Variation};

use crate::{AxisConfig, Machine, SpindleConfig};

pub use config::VariationConfig;
pub use law::SpeedLaw;

/// What of its ramp the drive of the spindle may need.
const RAMP_SHARE: f64 = 0.9;
/// What the rounding of counts and what is taken for it makes of the angle, counts.
const COUNTS: f64 = 2.5;
/// How wrong mass and mode are believed at most, shares.
const WRONG: f64 = 0.1;
/// How far the peaks of a variation keep from what counts as running away.
const APART: f64 = 1.05;
/// Halvings of a search.
const STEPS: u32 = 40;

/// A pass under a variation that can be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Varied {
    /// Highest override, a ratio ≥ 1.
    pub max_ratio: f64,
    /// Lowest and highest speed at 100 % override, 1/min.
    pub rpm: [f64; 2],
    /// Highest change of the commanded speed at 100 %, 1/min per s.
    pub ramp_rpm_s: f64,
    /// Bound on what the thread is off by the variation at the highest override, µm (M232).
    pub error_um: f64,
}

/// Why a pass cannot be cut under a variation at 100 % override: what it needs, and what there is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NotVaried {
    /// The axes cannot follow its highest speed, 1/min.
    Axes {
        /// Highest speed.
        needs: f64,
        /// What they can follow.
        limit: f64,
    },
    /// The spindle does not turn so fast, 1/min.
    Spindle {
        /// Highest speed.
        needs: f64,
        /// Top speed.
        limit: f64,
    },
    /// The axes would take its highest speed for that of a spindle that has run away, 1/min.
    Watch {
        /// Highest speed.
        needs: f64,
        /// What they take for right.
        limit: f64,
    },
    /// The drive of the spindle does not change its speed so fast, 1/min per s.
    Ramp {
        /// Highest change.
        needs: f64,
        /// What of the ramp it may use.
        limit: f64,
    },
    /// The thread would be off by more than is allowed, µm.
    Error {
        /// The bound.
        needs: f64,
        /// What is allowed.
        limit: f64,
    },
}

impl Machine {
    /// What becomes of a pass under a variation. Both have been checked.
    ///
    /// # Errors
    /// [`NotVaried`]: the first of M233 that does not hold at 100 %.
    pub fn varied(&self, pass: &ThreadPass, variation: &Variation) -> Result<Varied, NotVaried> {
        self.allows(pass, variation, 1.0)?;
        let highest = (self.spindle.override_max_pct / 100.0).max(1.0);
        let can = |ratio: f64| self.allows(pass, variation, ratio).is_ok();
        // It can be at 100 %.
        let max_ratio = searched(highest, can, 1.0).unwrap_or(1.0);
        let [acceleration, _] = law::peaks(variation, pass.s_rpm / 60.0);
        Ok(Varied {
            max_ratio,
            rpm: [-1.0, 1.0].map(|sign| pass.s_rpm * (1.0 + sign * variation.share)),
            ramp_rpm_s: 60.0 * acceleration,
            error_um: self.variation_error_um(pass, variation, max_ratio),
        })
    }

    /// The largest share up to that of a variation with which the pass can be, in whole tenths of a per cent.
    pub fn largest_share(&self, pass: &ThreadPass, variation: &Variation) -> Option<f64> {
        let can = |share: f64| self.varied(pass, &Variation { share, ..*variation }).is_ok();
        let share = searched(variation.share, |share| share > 0.0 && can(share), 0.0)?;
        let rounded = (share * 1000.0).floor() / 1000.0;
        (rounded > 0.0).then_some(rounded)
    }

    /// The shortest period from that of a variation on with which the pass can be, in whole tenths of a turn.
    pub fn shortest_period(&self, pass: &ThreadPass, variation: &Variation) -> Option<f64> {
        let [_, longest] = Variation::REVOLUTIONS;
        let can = |revolutions| self.varied(pass, &Variation { revolutions, ..*variation }).is_ok();
        let shortest = searched(variation.revolutions, can, longest)?;
        let rounded = (shortest * 10.0).ceil() / 10.0;
        (rounded <= longest).then_some(rounded)
    }

    /// Whether M233 holds at an override.
    fn allows(&self, pass: &ThreadPass, variation: &Variation, ratio: f64) -> Result<(), NotVaried> {
        /// What a rounding may make of a limit.
        const ROUNDING: f64 = 1.0 + 1e-9;
        let refuse_beyond = |needs: f64, limit: f64, why: fn(f64, f64) -> NotVaried| {
            if needs <= limit * ROUNDING { Ok(()) } else { Err(why(needs, limit)) }
        };
        let rpm = ratio * pass.s_rpm;
        let top = rpm * (1.0 + variation.share);
        let [acceleration, _] = law::peaks(variation, rpm / 60.0);
        refuse_beyond(top, pass.s_rpm * pass.max_ratio, |needs, limit| NotVaried::Axes { needs, limit })?;
        refuse_beyond(top, self.spindle.max_rpm, |needs, limit| NotVaried::Spindle { needs, limit })?;
        let [faster, share] = SpindleConfig::RUNAWAY;
        let watched =
            faster * self.spindle.override_max_pct / 100.0 * pass.s_rpm + share * self.spindle.max_rpm;
        refuse_beyond(top, watched / APART, |needs, limit| NotVaried::Watch { needs, limit })?;
        let ramp = RAMP_SHARE * self.spindle.ramp_rpm_s;
        refuse_beyond(60.0 * acceleration, ramp, |needs, limit| NotVaried::Ramp { needs, limit })?;
        let error_um = self.variation_error_um(pass, variation, ratio);
        let allowed = self.threading.variation.error_um;
        refuse_beyond(error_um, allowed, |needs, limit| NotVaried::Error { needs, limit })
    }

    /// Bound on what a pass is off by a variation at an override, of its worst axis, µm (M232).
    fn variation_error_um(&self, pass: &ThreadPass, variation: &Variation, ratio: f64) -> f64 {
        let peaks = law::peaks(variation, ratio * pass.s_rpm / 60.0);
        let on_lead = self.axes().map(|(axis, config)| (pass.axis(axis), config));
        on_lead.map(|(law, config)| self.axis_error_um(law, config, peaks)).fold(0.0, f64::max)
    }

    fn axis_error_um(&self, law: &AxisLaw, config: &AxisConfig, [acceleration, jerk]: [f64; 2]) -> f64 {
        let unknown = jerk * observer_gain(TAU * self.spindle.observer_hz, self.observed_ahead_s(config));
        let rounding = COUNTS / self.spindle_counts();
        let loops = config.position_gain_1_s * TAU * config.velocity_bandwidth_hz;
        let mode = config.mode_hz.map_or(0.0, |hz| 2.0 * WRONG / (TAU * hz * TAU * hz));
        1e3 * law.most_lead_mm().abs() * (unknown + rounding + acceleration * (WRONG / loops + mode))
    }

    /// How far ahead of the counts of the spindle its angle is asked for at most, s.
    fn observed_ahead_s(&self, config: &AxisConfig) -> f64 {
        let (cycle_s, bus) = (self.general.cycle_s, &self.bus);
        let way = f64::from(bus.input_cycles + bus.output_cycles) * cycle_s;
        let lead = config.acceleration_lead_s.max(config.velocity_lead_s).max(0.0);
        way + self.spindle.encoder_delay_s.abs() + lead
    }
}

/// Largest error of an angle by so much jerk, s³: what an observer of bandwidth ω, rad/s, asked `ahead_s`
/// ahead, does not know (M232).
fn observer_gain(omega: f64, ahead_s: f64) -> f64 {
    let (w, t) = (omega, ahead_s);
    1.0 / (w * w * w) + 3.0 * t / (w * w) + 1.5 * t * t / w + t * t * t / 6.0
}

/// What is nearest to `from`, on the way to `to`, of those that can be: all from one on can.
fn searched(from: f64, can: impl Fn(f64) -> bool, to: f64) -> Option<f64> {
    if can(from) {
        return Some(from);
    }
    let (mut bad, mut good) = (0.0, 1.0);
    let at = |share: f64| from + (to - from) * share;
    // The end itself may be no value: close to it is near enough.
    if !can(at(1.0 - 1e-6)) {
        return None;
    }
    for _ in 0..STEPS {
        let middle = 0.5 * (bad + good);
        if can(at(middle)) {
            good = middle;
        } else {
            bad = middle;
        }
    }
    Some(at(good))
}

#[cfg(test)]
mod tests;
