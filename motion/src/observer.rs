//! Speed and acceleration of the spindle from its encoder count, one measurement per control cycle (M53). In:
//! counts (or any unit of angle), unwrapped, taken every T seconds. Out: angle, speed, acceleration at a lead
//! time.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | T | s | period of the measurement |
//! | f_o | Hz | bandwidth: the triple pole |
//! | th = exp(−2π f_o T) | – | the pole per cycle |
//! | g, h, k | – | gains on angle, speed, acceleration |
//! | c, w, al | count, count/s, count/s² | state |
//! | res | count | measurement minus prediction |
//!
//! The third order follows a constant acceleration without steady error, as a spindle under override makes
//! it. Differences of counts cannot do this: one count per cycle is already a speed error of q/T.
//!
//! While the observer learns of a change, its corrections move the angle besides: c goes with w + g res/T, w
//! with al + h res/T². An axis that is led by c has to be fed forward with these; with w and al alone it is
//! left behind by g res/T for the time of learning, three times as far as the observer errs.
//!
//! A count is known to half of itself, so a small res may be nothing but rounding; at a speed with nearly
//! whole counts in a cycle it is a slow sawtooth, which no filter of this bandwidth averages. For counts, res
//! is split: what lies within a width is taken with the gains of a lower bandwidth, and only a share of it is
//! fed forward, so that no axis is shaken by it; what lies beyond is taken in full.
//!
//! | the spindle | width | bandwidth | fed forward |
//! |---|---|---|---|
//! | turns evenly | ±1: half of it rounding, half for what is not known yet | f_o/8 | nothing |
//! | does not: for 8/(2π f_o) after a res beyond that | ±3/4 | f_o/2 | a half |
//! | turns by less than four counts in 1/f_o: they come one by one, each with a res of about 1 | ±3/2 | f_o/8 | nothing |
//!
//! A spindle turns evenly if what repeats with its turns is taken off before ([`crate::Ripple`]).

use core::f64::consts::TAU;

/// What may be rounding is taken with a bandwidth so many times lower.
const QUIETER: f64 = 8.0;
/// How much of a residual may be rounding, counts; of a spindle that turns unevenly; while counts come one by
/// one.
const WIDTH: f64 = 1.0;
const BUSY_WIDTH: f64 = 0.75;
const SLOW_WIDTH: f64 = 1.5;
/// For how long a spindle counts as uneven after more than that, by 1/(2π f_o).
const HOLD: f64 = 8.0;

/// Angle of the spindle and its derivatives, in units of the measurement per sⁿ.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpindleMotion {
    /// Unwrapped angle.
    pub angle: f64,
    /// Speed, 1/s.
    pub speed: f64,
    /// Acceleration, 1/s².
    pub acceleration: f64,
    /// Jerk, 1/s³, and its rate, 1/s⁴; 0 where nobody knows them.
    pub jerk: f64,
    /// See `jerk`.
    pub snap: f64,
}

impl SpindleMotion {
    /// The motion `lead_s` seconds later (earlier if negative) at constant jerk.
    #[must_use]
    pub fn after(self, lead_s: f64) -> SpindleMotion {
        let SpindleMotion { angle, speed, acceleration, jerk, snap } = self;
        SpindleMotion {
            angle: angle + (speed + (0.5 * acceleration + jerk / 6.0 * lead_s) * lead_s) * lead_s,
            speed: speed + (acceleration + 0.5 * jerk * lead_s) * lead_s,
            acceleration: acceleration + jerk * lead_s,
            jerk,
            snap,
        }
    }

    /// Every part times a factor.
    fn times(self, factor: f64) -> SpindleMotion {
        let SpindleMotion { angle, speed, acceleration, jerk, snap } = self;
        SpindleMotion {
            angle: factor * angle,
            speed: factor * speed,
            acceleration: factor * acceleration,
            jerk: factor * jerk,
            snap: factor * snap,
        }
    }
}

/// Observer of the spindle with three equal real poles. Feed it the *middle* of the count (count + 1/2): the
/// true angle lies anywhere between two counts. Never restart it at the zero mark, only shift the origin of
/// the angle.
///
/// ```
/// let mut spindle = motion::SpindleObserver::new(30.0, 1e-3);
/// spindle.start(0.0, 3000.0); // counts, counts per second
/// for cycle in 1..=1000 {
///     spindle.update(3.0 * f64::from(cycle));
/// }
/// let ahead = spindle.at(0.5e-3); // half a cycle after the last measurement
/// assert!((ahead.angle - 3001.5).abs() < 1e-6 && (ahead.speed - 3000.0).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleObserver {
    period: f64,
    /// g, h/T, k/T².
    gain: SpindleMotion,
    /// What is done with rounding, if angles are counts.
    counts: Option<Counts>,
    /// `None` before the first measurement.
    state: Option<SpindleMotion>,
    /// What the last correction added to angle and speed, per second, as far as it is fed forward.
    drift: SpindleMotion,
}

impl SpindleObserver {
    /// Observer that has seen nothing yet, of `bandwidth_hz` f_o, measured every `period_s` T. Default for an
    /// encoder of 1024 lines and more: 30 Hz at 1 ms.
    ///
    /// # Panics
    /// If either is not positive and finite.
    #[must_use]
    pub fn new(bandwidth_hz: f64, period_s: f64) -> SpindleObserver {
        assert!(bandwidth_hz > 0.0 && bandwidth_hz.is_finite(), "observer bandwidth {bandwidth_hz} Hz");
        assert!(period_s > 0.0 && period_s.is_finite(), "observer period {period_s} s");
        SpindleObserver {
            period: period_s,
            gain: gain(bandwidth_hz, period_s),
            counts: None,
            state: None,
            drift: SpindleMotion::default(),
        }
    }

    /// The same for angles in counts: what of a residual may be rounding is taken with a lower bandwidth.
    ///
    /// # Panics
    /// As [`new`](Self::new).
    #[must_use]
    pub fn of_counts(bandwidth_hz: f64, period_s: f64) -> SpindleObserver {
        let counts = Counts {
            quiet: Rounding { width: WIDTH, gain: gain(bandwidth_hz / QUIETER, period_s), forward: 0.0 },
            busy: Rounding { width: BUSY_WIDTH, gain: gain(bandwidth_hz / 2.0, period_s), forward: 0.5 },
            hold_s: HOLD / (TAU * bandwidth_hz),
            left_s: 0.0,
            slow_below: 4.0 * bandwidth_hz,
        };
        SpindleObserver { counts: Some(counts), ..SpindleObserver::new(bandwidth_hz, period_s) }
    }

    /// Another bandwidth, Hz, from now on. Angles are not in counts.
    pub fn set_bandwidth(&mut self, bandwidth_hz: f64) {
        self.gain = gain(bandwidth_hz, self.period);
    }

    /// Sets the state to `count` and `speed` (per s) without acceleration. Take the speed from two counts far
    /// apart, and start at least 10/f_o before the thread.
    pub fn start(&mut self, count: f64, speed: f64) {
        self.state = Some(SpindleMotion { angle: count, speed, ..SpindleMotion::default() });
        self.drift = SpindleMotion::default();
    }

    /// Advances by one period and corrects with the angle `measured` at its end. The first measurement of an
    /// observer that was not started is where it stands. What it had not expected of the measurement.
    pub fn update(&mut self, measured: f64) -> f64 {
        let Some(state) = self.state else {
            self.start(measured, 0.0);
            return 0.0;
        };
        let predicted = state.after(self.period);
        let res = measured - predicted.angle;
        let (mut within, mut beyond) = (SpindleMotion::default(), self.gain.times(res));
        let mut forward = 0.0;
        if let Some(counts) = &mut self.counts {
            let rounding = counts.at(predicted.speed, res, self.period);
            let inside = res.clamp(-rounding.width, rounding.width);
            (within, beyond) = (rounding.gain.times(inside), self.gain.times(res - inside));
            forward = rounding.forward;
        }
        self.state = Some(SpindleMotion {
            angle: predicted.angle + within.angle + beyond.angle,
            speed: predicted.speed + within.speed + beyond.speed,
            acceleration: predicted.acceleration + within.acceleration + beyond.acceleration,
            ..SpindleMotion::default()
        });
        self.drift = SpindleMotion {
            angle: 0.0,
            speed: (forward * within.angle + beyond.angle) / self.period,
            acceleration: (forward * within.speed + beyond.speed) / self.period,
            ..SpindleMotion::default()
        };
        res
    }

    /// Advances by one period whose measurement is missing, as the observer expects it.
    pub fn skip(&mut self) {
        self.state = self.state.map(|state| state.after(self.period));
        self.drift = SpindleMotion::default();
    }

    /// Advances by one period without a measurement, at this speed (per s) and none other.
    pub fn coast(&mut self, speed: f64) {
        let angle = self.state.unwrap_or_default().angle + speed * self.period;
        self.start(angle, speed);
    }

    /// Motion `lead_s` seconds after the last measurement; 0 is the measurement itself. Each millisecond of
    /// lead at 30 Hz adds about 20 % of noise.
    #[must_use]
    pub fn at(&self, lead_s: f64) -> SpindleMotion {
        self.state.unwrap_or_default().after(lead_s)
    }

    /// Motion for an axis that follows the estimate, `lead_s` seconds after the last measurement: as
    /// [`at`](Self::at), with the speed and acceleration at which the estimate itself moves, its corrections
    /// among them.
    #[must_use]
    pub fn following(&self, lead_s: f64) -> SpindleMotion {
        let at = self.at(lead_s);
        SpindleMotion {
            speed: at.speed + self.drift.speed,
            acceleration: at.acceleration + self.drift.acceleration,
            ..at
        }
    }
}

/// What is done with a residual that may be rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Counts {
    /// While the spindle turns evenly, and while it does not.
    quiet: Rounding,
    busy: Rounding,
    /// For how long it counts as uneven after a residual that is no rounding, and for how long it does yet,
    /// s.
    hold_s: f64,
    left_s: f64,
    /// Speed below which counts come one by one, count/s.
    slow_below: f64,
}

/// So much of a residual, in counts, is taken with these gains, and a share of it fed forward.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Rounding {
    width: f64,
    gain: SpindleMotion,
    forward: f64,
}

impl Counts {
    /// What is done with a residual at a speed, a period after the one before.
    fn at(&mut self, speed: f64, residual: f64, period: f64) -> Rounding {
        if speed.abs() < self.slow_below {
            return Rounding { width: SLOW_WIDTH, ..self.quiet };
        }
        self.left_s = if residual.abs() > self.quiet.width { self.hold_s } else { self.left_s - period };
        if self.left_s > 0.0 { self.busy } else { self.quiet }
    }
}

/// g, h/T, k/T² of a bandwidth.
fn gain(bandwidth_hz: f64, period_s: f64) -> SpindleMotion {
    let th = libm::exp(-TAU * bandwidth_hz * period_s);
    let rest = 1.0 - th;
    SpindleMotion {
        angle: 1.0 - th * th * th,
        speed: 1.5 * (1.0 - th * th) * rest / period_s,
        acceleration: rest * rest * rest / (period_s * period_s),
        ..SpindleMotion::default()
    }
}

#[cfg(test)]
mod tests {
    use super::SpindleObserver;

    #[test]
    fn m53_gains_at_1_khz() {
        for (f_o, g, h, k) in [
            (15.0, 0.246287, 0.023178, 0.00072761),
            (20.0, 0.314078, 0.039365, 0.00164674),
            (30.0, 0.431916, 0.080936, 0.00507035),
        ] {
            let gain = SpindleObserver::new(f_o, 1e-3).gain;
            assert!((gain.angle - g).abs() < 1e-6, "g at {f_o} Hz: {}", gain.angle);
            assert!((gain.speed * 1e-3 - h).abs() < 1e-6, "h at {f_o} Hz: {}", gain.speed * 1e-3);
            assert!(
                (gain.acceleration * 1e-6 - k).abs() < 1e-8,
                "k at {f_o} Hz: {}",
                gain.acceleration * 1e-6
            );
        }
    }
}
