//! Speed and acceleration of the spindle from its encoder count, one measurement per control cycle (M53).
//! In: counts (or any unit of angle), unwrapped, taken every T seconds. Out: angle, speed, acceleration at a lead time.
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
//! The third order follows a constant acceleration without steady error, as a spindle under override makes it.
//! Differences of counts cannot do this: one count per cycle is already a speed error of q/T.
//!
//! While the observer learns of a change, its corrections move the angle besides: c goes with w + g res/T, w with
//! al + h res/T². An axis that is led by c has to be fed forward with these; with w and al alone it is left behind by
//! g res/T for the time of learning, three times as far as the observer errs.

use core::f64::consts::TAU;

/// Angle of the spindle and its derivatives, in units of the measurement per sⁿ.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpindleMotion {
    /// Unwrapped angle.
    pub angle: f64,
    /// Speed, 1/s.
    pub speed: f64,
    /// Acceleration, 1/s².
    pub acceleration: f64,
}

impl SpindleMotion {
    /// The motion `lead_s` seconds later (earlier if negative) at constant acceleration.
    #[must_use]
    pub fn after(self, lead_s: f64) -> SpindleMotion {
        let SpindleMotion { angle, speed, acceleration } = self;
        SpindleMotion {
            angle: angle + (speed + 0.5 * acceleration * lead_s) * lead_s,
            speed: speed + acceleration * lead_s,
            acceleration,
        }
    }
}

/// Observer of the spindle with three equal real poles. Feed it the *middle* of the count (count + 1/2): the true
/// angle lies anywhere between two counts. Never restart it at the zero mark, only shift the origin of the angle.
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
    /// The same for a spindle so slow that counts come one by one, and the speed below which it is.
    slow: Option<(SpindleMotion, f64)>,
    /// `None` before the first measurement.
    state: Option<SpindleMotion>,
    /// g res/T, h res/T²: what the last correction added to angle and speed, per second.
    drift: SpindleMotion,
}

impl SpindleObserver {
    /// Observer that has seen nothing yet, of `bandwidth_hz` f_o, measured every `period_s` T. Default for an encoder of
    /// 1024 lines and more: 30 Hz at 1 ms.
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
            slow: None,
            state: None,
            drift: SpindleMotion::default(),
        }
    }

    /// The same for angles that are whole counts. While fewer than four counts come in 1/f_o and each comes within a
    /// count of where it was foretold, a quarter of the bandwidth averages over more of them.
    ///
    /// # Panics
    /// As [`new`](Self::new).
    #[must_use]
    pub fn of_counts(bandwidth_hz: f64, period_s: f64) -> SpindleObserver {
        let slow = Some((gain(bandwidth_hz / 4.0, period_s), 4.0 * bandwidth_hz));
        SpindleObserver { slow, ..SpindleObserver::new(bandwidth_hz, period_s) }
    }

    /// Sets the state to `count` and `speed` (per s) without acceleration. Take the speed from two counts far apart,
    /// and start at least 10/f_o before the thread.
    pub fn start(&mut self, count: f64, speed: f64) {
        self.state = Some(SpindleMotion { angle: count, speed, acceleration: 0.0 });
        self.drift = SpindleMotion::default();
    }

    /// Advances by one period and corrects with the angle `measured` at its end. The first measurement of an observer
    /// that was not started is where it stands.
    pub fn update(&mut self, measured: f64) {
        let Some(state) = self.state else { return self.start(measured, 0.0) };
        let predicted = state.after(self.period);
        let res = measured - predicted.angle;
        let (gain, learning) = match self.slow {
            Some((slow, below)) if res.abs() <= 1.0 && predicted.speed.abs() < below => (slow, 0.0),
            _ => (self.gain, 1.0),
        };
        self.state = Some(SpindleMotion {
            angle: predicted.angle + gain.angle * res,
            speed: predicted.speed + gain.speed * res,
            acceleration: predicted.acceleration + gain.acceleration * res,
        });
        let per_s = learning * res / self.period;
        self.drift =
            SpindleMotion { angle: 0.0, speed: gain.angle * per_s, acceleration: gain.speed * per_s };
    }

    /// Motion `lead_s` seconds after the last measurement; 0 is the measurement itself. Each millisecond of lead at
    /// 30 Hz adds about 20 % of noise.
    #[must_use]
    pub fn at(&self, lead_s: f64) -> SpindleMotion {
        self.state.unwrap_or_default().after(lead_s)
    }

    /// Motion for an axis that follows the estimate, `lead_s` seconds after the last measurement: as [`at`](Self::at),
    /// with the speed and acceleration at which the estimate itself moves, its corrections among them.
    #[must_use]
    pub fn following(&self, lead_s: f64) -> SpindleMotion {
        let SpindleMotion { angle, speed, acceleration } = self.at(lead_s);
        SpindleMotion {
            angle,
            speed: speed + self.drift.speed,
            acceleration: acceleration + self.drift.acceleration,
        }
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
