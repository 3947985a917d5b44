//! What an axis on a long lead follows of the spindle: its angle as observed, without the steps of the
//! estimate. In: angle, speed and acceleration as observed, once a period. Out: a motion whose jerk is
//! continuous.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | c, w, al | count … count/s² | angle, speed and acceleration as observed (M53) |
//! | p, v, a, j | count … count/s³ | those of what follows, and its jerk |
//! | u | count/s⁴ | its snap, constant from one period to the next |
//! | f, T | Hz, s | bandwidth: the quadruple pole; period |
//! | Ω = (1 − exp(−2π f T))/T | 1/s | the pole in differences |
//! | ω_o, q | 1/s, mm | bandwidth of the observer, 2π f_o; way of the axis in a count |
//!
//! ```text
//! u = k₄ (c − p) + k₃ (w − v) + k₂ (al − a) − k₁ j                                               (M135)
//! k₄ = Ω⁴,  k₃ = 4 Ω³ − 3/2 T k₄,  k₂ = 6 Ω² − T k₃ − 7/12 T² k₄,
//! k₁ = 4 Ω − 1/2 T k₂ − 1/6 T² k₃ − 1/24 T³ k₄
//! 2π f = ω_o (J/(0.9 ω_o³ q))^(4/7)                                                              (M135a)
//! ```
//! An observer corrects angle, speed and acceleration at once, by steps. Along a long lead, or with a
//! coarse encoder, a count is much of what an axis may do: led by the steps it is shaken, and swings
//! behind its motor. What follows the observer gets there by itself: at a constant acceleration nothing
//! is left between the two, at a constant jerk j 4 j/Ω³. Jerk and snap are known, so that a motor can
//! stand ahead of its slide (M131).
//!
//! A count that an observer takes in full costs a jerk of 0.9 q ω_o^(5/4) (2π f)^(7/4) (peak of the
//! answer of both to a step, within a sixth). (M135a) makes this J, with f between a quarter of f_o and
//! twice: the longer the lead and the coarser the encoder, the softer an axis is led, and the later it
//! sees a spindle that is bogged.

use core::f64::consts::TAU;

use crate::SpindleMotion;

/// Peak of the jerk after a step of one, by ω_o^(5/4) (2π f)^(7/4).
const PEAK: f64 = 0.9;
/// Lowest and highest bandwidth, shares of that of the observer.
const LEAST: f64 = 0.25;
const MOST: f64 = 2.0;

/// Follows an observed spindle.
///
/// ```
/// let mut follower = motion::Follower::new(60.0, 5e-4);
/// let observed = motion::SpindleMotion { angle: 1.0, ..Default::default() }; // it was taken to stand at 0
/// (0..100).for_each(|_| follower.update(&observed)); // 50 ms
/// assert!((follower.at(0.0).angle - 1.0).abs() < 1e-3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Follower {
    period: f64,
    /// k₄ … k₁.
    gains: [f64; 4],
    motion: SpindleMotion,
}

impl Follower {
    /// Stands at 0; of `bandwidth_hz` f, asked every `period_s` T.
    ///
    /// # Panics
    /// If either is not positive and finite.
    #[must_use]
    pub fn new(bandwidth_hz: f64, period_s: f64) -> Follower {
        assert!(bandwidth_hz > 0.0 && bandwidth_hz.is_finite(), "follower bandwidth {bandwidth_hz} Hz");
        assert!(period_s > 0.0 && period_s.is_finite(), "follower period {period_s} s");
        Follower { period: period_s, gains: gains(bandwidth_hz, period_s), motion: SpindleMotion::default() }
    }

    /// The bandwidth, Hz, behind an observer of `observer_hz` f_o, at which a count that is taken in full
    /// costs a jerk of `jerk` J/q, count/s³ (M135a).
    #[must_use]
    pub fn gentle_hz(observer_hz: f64, jerk: f64) -> f64 {
        let observer = TAU * observer_hz;
        let counts = jerk / (PEAK * observer * observer * observer);
        observer_hz * libm::pow(counts, 4.0 / 7.0).clamp(LEAST, MOST)
    }

    /// Moves as observed from now on.
    pub fn start(&mut self, observed: &SpindleMotion) {
        self.motion = *observed;
    }

    /// Advances by one period, at whose end the spindle is observed to move so: angle, speed and acceleration
    /// of it are followed.
    pub fn update(&mut self, observed: &SpindleMotion) {
        let now = self.motion.after(self.period);
        let [k4, k3, k2, k1] = self.gains;
        let [angle, speed] = [observed.angle - now.angle, observed.speed - now.speed];
        let acceleration = observed.acceleration - now.acceleration;
        let snap = k4 * angle + k3 * speed + k2 * acceleration - k1 * now.jerk;
        self.motion = SpindleMotion { snap, ..now };
    }

    /// Its motion `lead_s` after the last period, earlier if negative.
    #[must_use]
    pub fn at(&self, lead_s: f64) -> SpindleMotion {
        self.motion.after(lead_s)
    }
}

/// k₄ … k₁.
fn gains(bandwidth_hz: f64, t: f64) -> [f64; 4] {
    let pole = (1.0 - libm::exp(-TAU * bandwidth_hz * t)) / t;
    let k4 = pole * pole * pole * pole;
    let k3 = 4.0 * pole * pole * pole - 1.5 * t * k4;
    let k2 = 6.0 * pole * pole - t * k3 - 7.0 / 12.0 * t * t * k4;
    let k1 = 4.0 * pole - 0.5 * t * k2 - t * t / 6.0 * k3 - t * t * t / 24.0 * k4;
    [k4, k3, k2, k1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SpindleObserver;

    const T: f64 = 5e-4;

    #[test]
    fn its_four_poles_are_those_of_the_bandwidth() {
        for hz in [15.0, 60.0, 200.0] {
            let (mut follower, pole) = (Follower::new(hz, T), libm::exp(-TAU * hz * T));
            let one = SpindleMotion { angle: 1.0, ..SpindleMotion::default() };
            let left: Vec<f64> = (0..60)
                .map(|_| {
                    follower.update(&one);
                    1.0 - follower.at(0.0).angle
                })
                .collect();
            for e in left.windows(5).skip(1) {
                let next = 4.0 * pole * e[3] - 6.0 * pole.powi(2) * e[2] + 4.0 * pole.powi(3) * e[1]
                    - pole.powi(4) * e[0];
                assert!((e[4] - next).abs() < 1e-9, "{hz} Hz: {} for {next}", e[4]);
            }
        }
    }

    #[test]
    fn nothing_is_left_at_a_constant_acceleration_and_little_at_a_constant_jerk() {
        let jerk = 1e6;
        let course = |t: f64, jerk: f64| SpindleMotion {
            angle: (1e5 + (2e4 + jerk / 6.0 * t) * t) * t,
            speed: 1e5 + (4e4 + jerk / 2.0 * t) * t,
            acceleration: 4e4 + jerk * t,
            ..SpindleMotion::default()
        };
        let behind = |jerk: f64| {
            let mut follower = Follower::new(60.0, T);
            follower.start(&course(0.0, jerk));
            (1..=1000).for_each(|n| follower.update(&course(f64::from(n) * T, jerk)));
            course(1000.0 * T, jerk).angle - follower.at(0.0).angle
        };
        assert!(behind(0.0).abs() < 1e-6, "{}", behind(0.0));
        let expected = 4.0 * jerk / (TAU * 60.0_f64).powi(3);
        assert!((behind(jerk) / expected - 1.0).abs() < 0.3, "{} for {expected}", behind(jerk));
    }

    /// Peak of the jerk of the two after a step of one count that the observer takes in full.
    fn peak(observer_hz: f64, follower_hz: f64) -> f64 {
        let mut observer = SpindleObserver::new(observer_hz, T);
        let mut follower = Follower::new(follower_hz, T);
        observer.start(0.0, 0.0);
        let jerk = |_| {
            observer.update(1.0);
            follower.update(&observer.at(0.0));
            follower.at(0.0).jerk.abs()
        };
        (0..1000).map(jerk).fold(0.0, f64::max)
    }

    #[test]
    fn a_count_costs_no_more_jerk_than_is_allowed() {
        for observer_hz in [30.0, 45.0, 60.0] {
            for jerk in [3e6, 1e7, 3e7] {
                let hz = Follower::gentle_hz(observer_hz, jerk);
                let (softest, stiffest) = (hz == LEAST * observer_hz, hz == MOST * observer_hz);
                let peak = peak(observer_hz, hz);
                assert!(softest || peak < 1.1 * jerk, "{jerk} behind {observer_hz} Hz, at {hz} Hz: {peak}");
                assert!(stiffest || peak > 0.8 * jerk, "{jerk} behind {observer_hz} Hz, at {hz} Hz: {peak}");
            }
        }
        assert_eq!(Follower::gentle_hz(60.0, 1e9), 120.0);
        assert_eq!(Follower::gentle_hz(60.0, 1.0), 15.0);
    }
}
