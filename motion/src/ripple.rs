//! What of the angle of a spindle repeats with every turn. In: its measured angle, once a period. Out: the
//! angle of its even rotation; and that again with as much of the ripple on it as somebody can follow, with
//! derivatives.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | θ | rad | angle of the spindle within its turn |
//! | h | 1/turn | which harmonic, 1 … 8 |
//! | Z_h | unit of the angle | complex amplitude of it |
//! | f_l | Hz | bandwidth of the observer (M53) that learns: half the turns per second, 4 … 16 |
//! | x | – | frequency of the harmonic over f_l |
//! | S | – | share of a swing that the observer leaves in its residual res |
//! | n | turns | learned from so far, 1 … 5 |
//! | T | s | period |
//!
//! ```text
//! R(θ) = Σ Re(Z_h e^(jhθ))
//! Z_h ← Z_h + 2 Δturns/n · res e^(−jhθ)/S,   1/S = (1 − j/x)³                                    (M130)
//! ```
//! A swing slower than 0.7 f_l the observer follows by itself: then nothing is learned of that harmonic, and
//! what is known of it stays. So f_l is low where the spindle is slow. It is no lower than that needs,
//! because a spindle goes on settling long after its ramp, and a slow observer takes that for ripple. Nothing
//! is learned while the speed changes by more than 1 % a turn, or the residual is larger than any ripple, nor
//! for 1/f_l after that: a residual is no ripple then. Of a swing whose peaks are too large the rest would
//! teach harmonics that are not there.
//!
//! An observer as slow as that sees late that the speed begins to change, and takes the beginning for ripple:
//! several counts along a ramp. So what is learned is believed only if the speed stays steady for 0.25/f_l to
//! 0.5/f_l more; else it is forgotten. What is believed comes and goes smoothly, within 0.25/f_l.
//!
//! Ripple of the speed, and an encoder that is eccentric or badly divided, look the same. Both are taken off
//! the measurement and put back where they are followed; so it does no harm that something was learned
//! wrongly but where a harmonic is not followed.

use core::f64::consts::TAU;

use crate::{SpindleMotion, SpindleObserver};

/// Harmonics that are learned.
const HARMONICS: usize = 8;
/// Lowest and highest bandwidth of the observer that learns, Hz.
const SLOWEST_HZ: f64 = 4.0;
const FASTEST_HZ: f64 = 16.0;
/// It is set anew where it is off by more than this share.
const OFF: f64 = 0.05;
/// Slowest harmonic that is learned, by that bandwidth.
const SLOWEST: f64 = 0.7;
/// Turns that are averaged in the end.
const TURNS: f64 = 5.0;
/// Change of the speed in a turn, a share of it, up to which a spindle turns steadily.
const STEADY: f64 = 0.01;
/// How long it has to, by the bandwidth.
const STEADY_FOR: f64 = 1.0;
/// From one look at what has been learned to the next, and how fast what is believed comes, by the bandwidth.
const LOOK: f64 = 0.25;
const COMES: f64 = 4.0;
/// Largest residual that is learned from, shares of a turn: no spindle is that uneven.
const LARGEST: f64 = 0.002;

/// A complex number.
type Complex = (f64, f64);
/// Amplitudes of all harmonics.
type Waves = [Complex; HARMONICS];

/// What has been learned.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Learned {
    z: Waves,
    turns: f64,
}

/// What repeats with every turn of a spindle.
///
/// ```
/// // 2000 measurements a second of a spindle of 10 turns a second, uneven by a thousandth of a turn.
/// let mut ripple = motion::Ripple::new(1.0, 5e-4);
/// let uneven = |turns: f64| turns + 1e-3 * (2.0 * std::f64::consts::TAU * turns).sin();
/// ripple.start(0.0, 10.0);
/// let even: Vec<f64> = (1..20_000).map(|n| ripple.update(uneven(f64::from(n) * 5e-3))).collect();
/// assert!((even[19_998] - 19_999.0 * 5e-3).abs() < 1e-5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ripple {
    per_turn: f64,
    period: f64,
    observer: SpindleObserver,
    /// Bandwidth of the observer, Hz.
    learning_hz: f64,
    /// What is taken off and put back.
    z: Waves,
    /// What is learned now; what was at the last look, and what is believed.
    learned: Learned,
    seen: Learned,
    believed: Learned,
    looked_s: f64,
    steady_s: f64,
}

impl Ripple {
    /// Nothing is known yet of a spindle with so many units of the angle in a turn, measured every
    /// `period_s`.
    ///
    /// # Panics
    /// If the period is not positive and finite.
    #[must_use]
    pub fn new(per_turn: f64, period_s: f64) -> Ripple {
        Ripple {
            per_turn,
            period: period_s,
            observer: SpindleObserver::new(FASTEST_HZ, period_s),
            learning_hz: FASTEST_HZ,
            z: [(0.0, 0.0); HARMONICS],
            learned: Learned::default(),
            seen: Learned::default(),
            believed: Learned::default(),
            looked_s: 0.0,
            steady_s: 0.0,
        }
    }

    /// The observer goes on from an angle and a speed (per s); what is known stays.
    pub fn start(&mut self, angle: f64, speed: f64) {
        self.observer.start(angle, speed);
        self.steady_s = 0.0;
    }

    /// A measurement is missing.
    pub fn skip(&mut self) {
        self.observer.skip();
    }

    /// Takes a measured angle. That of the even rotation.
    pub fn update(&mut self, measured: f64) -> f64 {
        let wave = self.wave(measured);
        let residual = self.observer.update(measured - ahead(&self.learned.z, wave));
        self.learn(residual);
        measured - ahead(&self.z, wave)
    }

    fn learn(&mut self, residual: f64) {
        let SpindleMotion { angle, speed, acceleration, .. } = self.observer.at(0.0);
        let uneven = acceleration.abs() * self.per_turn > STEADY * speed * speed
            || residual.abs() > LARGEST * self.per_turn;
        self.steady_s = if uneven { 0.0 } else { self.steady_s + self.period };
        let turns_s = speed / self.per_turn;
        self.listen(turns_s.abs());
        self.believe(uneven);
        if self.steady_s * self.learning_hz < STEADY_FOR {
            return;
        }
        let turned = turns_s.abs() * self.period;
        self.learned.turns = (self.learned.turns + turned).min(TURNS);
        let gain = 2.0 * turned / self.learned.turns.max(1.0) * residual;
        let turn = self.wave(angle);
        let mut wave = turn;
        for (harmonic, z) in (1..).map(f64::from).zip(&mut self.learned.z) {
            let x = harmonic * turns_s / self.learning_hz;
            if x.abs() >= SLOWEST {
                let found = times((gain * wave.0, -gain * wave.1), unseen(x));
                *z = (z.0 + found.0, z.1 + found.1);
            }
            wave = times(wave, turn);
        }
    }

    /// Sets the observer to a spindle of so many turns a second.
    fn listen(&mut self, turns_s: f64) {
        let hz = (0.5 * turns_s).clamp(SLOWEST_HZ, FASTEST_HZ);
        if (hz - self.learning_hz).abs() > OFF * self.learning_hz {
            self.learning_hz = hz;
            self.observer.set_bandwidth(hz);
        }
    }

    /// What was learned some time ago is believed; if the speed changes, nothing since then is.
    fn believe(&mut self, uneven: bool) {
        self.looked_s += self.period;
        if uneven {
            (self.learned, self.seen, self.looked_s) = (self.believed, self.believed, 0.0);
        } else if self.looked_s * self.learning_hz >= LOOK {
            (self.believed, self.seen, self.looked_s) = (self.seen, self.learned, 0.0);
        }
        let share = (COMES * self.learning_hz * self.period).min(1.0);
        for (z, believed) in self.z.iter_mut().zip(&self.believed.z) {
            *z = (z.0 + share * (believed.0 - z.0), z.1 + share * (believed.1 - z.1));
        }
    }

    /// An even motion with the ripple on it, each harmonic by a share that depends on its frequency in Hz.
    #[must_use]
    pub fn upon(&self, even: &SpindleMotion, share: impl Fn(f64) -> f64) -> SpindleMotion {
        let turn = self.wave(even.angle);
        let mut wave = turn;
        let turns_s = even.speed / self.per_turn;
        let (w, al) = (TAU * turns_s, TAU * even.acceleration / self.per_turn);
        let mut motion = *even;
        for (h, z) in (1..).map(f64::from).zip(&self.z) {
            let (re, im) = times(*z, wave);
            let share = share(h * turns_s.abs());
            let (re, im, w, al) = (share * re, share * im, h * w, h * al);
            motion.angle += re;
            motion.speed -= w * im;
            motion.acceleration -= w * w * re + al * im;
            motion.jerk += w * w * w * im - 3.0 * w * al * re;
            motion.snap += w * w * w * w * re;
            wave = times(wave, turn);
        }
        motion
    }

    /// e^(jθ).
    fn wave(&self, angle: f64) -> Complex {
        let turns = angle / self.per_turn;
        let (sin, cos) = libm::sincos(TAU * (turns - turns.floor()));
        (cos, sin)
    }
}

/// R: how far ahead of its even rotation a spindle is at an angle whose wave is e^(jθ).
fn ahead(z: &Waves, turn: Complex) -> f64 {
    let mut wave = turn;
    let mut ahead = 0.0;
    for z in z {
        ahead += times(*z, wave).0;
        wave = times(wave, turn);
    }
    ahead
}

fn times(a: Complex, b: Complex) -> Complex {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

/// 1/S.
fn unseen(x: f64) -> Complex {
    let root = (1.0, -1.0 / x);
    times(root, times(root, root))
}

#[cfg(test)]
mod tests {
    use super::*;

    const T: f64 = 5e-4;
    const COUNTS: f64 = 10_000.0;

    /// Counts by which a spindle is ahead: two and six times a turn.
    fn uneven(turns: f64) -> f64 {
        1.6 * libm::sin(2.0 * TAU * turns + 1.0) + 0.4 * libm::sin(6.0 * TAU * turns)
    }

    /// What is known of it.
    fn known(ripple: &Ripple, turns: f64) -> f64 {
        ahead(&ripple.z, ripple.wave(turns * COUNTS))
    }

    /// Runs a spindle up to a speed, 1/min, and on for some turns, through an encoder with counts.
    fn learned(rpm: f64, turns: f64) -> Ripple {
        let mut ripple = Ripple::new(COUNTS, T);
        let (mut q, mut w) = (0.0f64, 0.0f64);
        let mut steady = 0.0;
        while steady < turns {
            w = (w + 800.0 / 60.0 * T).min(rpm / 60.0);
            q += w * T;
            steady += if w == rpm / 60.0 { w * T } else { 0.0 };
            ripple.update((q * COUNTS + uneven(q)).floor() + 0.5);
        }
        ripple
    }

    #[test]
    fn a_ripple_is_known_a_few_turns_after_the_speed_is_reached() {
        for (rpm, turns, within) in
            [(307.0, 6.0, 0.4), (607.0, 9.0, 0.4), (607.0, 25.0, 0.1), (2007.0, 25.0, 0.2)]
        {
            let ripple = learned(rpm, turns);
            let worst = (0..360).map(|deg| f64::from(deg) / 360.0);
            let worst = worst.map(|at| (known(&ripple, at) - uneven(at)).abs()).fold(0.0, f64::max);
            assert!(worst < within, "{worst} counts after {turns} turns at {rpm} 1/min");
        }
    }

    #[test]
    fn what_comes_once_a_turn_is_learned_of_slow_spindles_too() {
        for rpm in [183.0, 307.0, 2007.0] {
            let mut ripple = Ripple::new(COUNTS, T);
            let eccentric = |turns: f64| 1.6 * libm::sin(TAU * turns);
            let turned = |n: u32| f64::from(n) * T * rpm / 60.0;
            ripple.start(0.0, COUNTS * rpm / 60.0);
            (0..).map(turned).take_while(|q| *q < 25.0).for_each(|q| {
                ripple.update((q * COUNTS + eccentric(q)).floor() + 0.5);
            });
            let worst = (0..360).map(|deg| f64::from(deg) / 360.0);
            let worst = worst.map(|at| (known(&ripple, at) - eccentric(at)).abs()).fold(0.0, f64::max);
            assert!(worst < 0.3, "{worst} counts at {rpm} 1/min");
        }
    }

    #[test]
    fn what_is_larger_than_any_ripple_teaches_no_harmonics() {
        let mut ripple = Ripple::new(2000.0, T);
        ripple.start(0.0, 26.4 * 2000.0);
        for q in (0..2000).map(|n| f64::from(n) * T * 26.4) {
            ripple.update((q * 2000.0 + 7.5 * libm::sin(TAU * q)).floor() + 0.5);
            let worst = ripple.z[1..].iter().map(|z| (z.0 * z.0 + z.1 * z.1).sqrt()).fold(0.0, f64::max);
            assert!(worst < 0.5, "{worst} counts after {q} turns");
        }
    }

    #[test]
    fn the_beginning_of_a_change_of_speed_is_no_ripple() {
        for (rpm, ramp_rpm_s) in [(307.0, 200.0), (607.0, 800.0), (1207.0, 800.0), (2007.0, 400.0)] {
            let mut ripple = learned(rpm, 25.0);
            let before = ripple.z;
            let (mut q, mut w) = (25.0f64, rpm / 60.0);
            ripple.start(q * COUNTS, w * COUNTS);
            for n in 0..4000 {
                w -= if (1000..2000).contains(&n) { ramp_rpm_s / 60.0 * T } else { 0.0 };
                q += w * T;
                ripple.update((q * COUNTS + uneven(q)).floor() + 0.5);
            }
            let moved = ripple.z.iter().zip(before).map(|(a, b)| libm::hypot(a.0 - b.0, a.1 - b.1));
            let moved = moved.fold(0.0, f64::max);
            assert!(moved < 0.15, "{moved} counts at {rpm} 1/min");
        }
    }

    #[test]
    fn a_slow_spindle_and_one_that_changes_its_speed_teach_nothing() {
        assert_eq!(learned(20.0, 3.0).z, [(0.0, 0.0); HARMONICS]);
        let mut ripple = Ripple::new(COUNTS, T);
        (0..4000).map(|n| f64::from(n) * T).for_each(|t| {
            ripple.update(((5.0 + 5.0 * t) * t * COUNTS).floor());
        });
        assert_eq!(ripple.z, [(0.0, 0.0); HARMONICS]);
    }

    #[test]
    fn the_derivatives_belong_to_the_angle() {
        let ripple = learned(600.0, 20.0);
        let even = |t: f64| SpindleMotion {
            angle: 3000.0 + (1e5 + 1e4 * t) * t,
            speed: 1e5 + 2e4 * t,
            acceleration: 2e4,
            ..SpindleMotion::default()
        };
        let (all, h) = (|_: f64| 1.0, 1e-5);
        let (before, now, after) = (even(-h), even(0.0), even(h));
        let [before, now, after] = [before, now, after].map(|even| ripple.upon(&even, all));
        let rate = |of: fn(&SpindleMotion) -> f64| (of(&after) - of(&before)) / (2.0 * h);
        for (name, found, expected) in [
            ("speed", now.speed, rate(|motion| motion.angle)),
            ("acceleration", now.acceleration, rate(|motion| motion.speed)),
            ("jerk", now.jerk, rate(|motion| motion.acceleration)),
            ("snap", now.snap, rate(|motion| motion.jerk)),
        ] {
            assert!((found / expected - 1.0).abs() < 0.02, "{name}: {found}, not {expected}");
        }
    }

    #[test]
    fn a_harmonic_that_is_not_followed_is_left_out() {
        let ripple = learned(600.0, 20.0);
        let even = SpindleMotion { angle: 1234.0, speed: 1e5, ..SpindleMotion::default() };
        assert_eq!(ripple.upon(&even, |_| 0.0), even);
        let slow = ripple.upon(&even, |hz| if hz < 30.0 { 1.0 } else { 0.0 });
        let expected = 1.6 * libm::sin(2.0 * TAU * 0.1234 + 1.0);
        assert!((slow.angle - even.angle - expected).abs() < 0.15, "{slow:?}");
    }
}
