//! A lightly damped mode behind an ideal drive. In: a law of motion, frequency in Hz. Out: how far the mass
//! swings from where it is led, mm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | u | mm | mass minus law |
//! | w, ζ, w_d | rad/s, –, rad/s | frequency, damping, w (1 − ζ²)^½ |
//! | λ = −ζ w + i w_d | 1/s | the pole |
//! | q | mm/s | state of the mode as a complex number |
//! | ψ | rad | phase of λ q |
//!
//! ```text
//! u″ + 2 ζ w u′ + w² u = −a(t),  at rest before
//! q(t) = ∫₀ᵗ a(τ) exp(λ (t − τ)) dτ,  u(t) = −Im q(t)/w_d
//! after the law: q(T + s) = q(T) exp(λ s), amplitude |q(T)|/w_d
//! turning points where ψ + w_d s is a multiple of π
//! ```
//! Spring and damper both act between law and mass, so the equation of u is exact. The integral is Gauss's
//! with eight points in every half period and less; a test holds it to 1e-9 of the closed forms.

use core::f64::consts::{PI, TAU};

use super::laws::Law;

/// Damping of the mode.
pub(super) const DAMPING: f64 = 0.02;

/// Points of Gauss's quadrature in (0, 1), and their weights, which add up to 1/2 a side.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

/// A mode.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mode {
    pub(super) hz: f64,
    pub(super) damping: f64,
}

/// What is left of a motion when it is over, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Residual {
    /// Farthest that the mass is off from the end of the law on.
    pub(super) largest: f64,
    /// Amplitude of the decaying swing at the end of the law; never less.
    pub(super) amplitude: f64,
}

impl Mode {
    /// The mode of the experiment at a frequency.
    pub(super) fn at(hz: f64) -> Mode {
        Mode { hz, damping: DAMPING }
    }

    /// Real and imaginary part of the pole.
    fn pole(&self) -> (f64, f64) {
        let w = TAU * self.hz;
        (-self.damping * w, w * (1.0 - self.damping * self.damping).sqrt())
    }

    /// q at `t`, which is not after the end of the law.
    fn state(&self, law: &Law, t: f64) -> (f64, f64) {
        let (decay, w_d) = self.pole();
        let (mut re, mut im, mut begin) = (0.0, 0.0, 0.0);
        for end in law.ends.iter().map(|end| end.min(t)) {
            let parts = (2.0 * (end - begin) * self.hz).ceil() + 3.0;
            let half = 0.5 * (end - begin) / parts;
            for part in 0..parts as u32 {
                let middle = begin + half * f64::from(2 * part + 1);
                for (point, weight) in GAUSS.into_iter().flat_map(|(x, weight)| [(x, weight), (-x, weight)]) {
                    let at = middle + half * point;
                    let size = half * weight * (law.at)(at).a * libm::exp(decay * (t - at));
                    let (sin, cos) = libm::sincos(w_d * (t - at));
                    (re, im) = (re + size * cos, im + size * sin);
                }
            }
            begin = end;
        }
        (re, im)
    }

    /// How far the mass is off its law at `t`, mm.
    pub(super) fn deflection(&self, law: &Law, t: f64) -> f64 {
        let over = (t - law.duration()).max(0.0);
        self.swung(self.state(law, t - over), over)
    }

    /// Deflection `over` seconds after the state q when nothing drives the mode any more, mm.
    fn swung(&self, (re, im): (f64, f64), over: f64) -> f64 {
        let (decay, w_d) = self.pole();
        let (sin, cos) = libm::sincos(w_d * over);
        -libm::exp(decay * over) * (re * sin + im * cos) / w_d
    }

    /// What the law leaves in the mode.
    pub(super) fn residual(&self, law: &Law) -> Residual {
        let (decay, w_d) = self.pole();
        let (re, im) = self.state(law, law.duration());
        let psi = libm::atan2(decay * im + w_d * re, decay * re - w_d * im);
        let turned = self.swung((re, im), (-psi).rem_euclid(PI) / w_d);
        Residual { largest: turned.abs().max(im.abs() / w_d), amplitude: libm::hypot(re, im) / w_d }
    }
}

#[cfg(test)]
mod tests {
    use super::super::laws::Profile;
    use super::*;
    use motion::Stroke;

    const TIMES: [f64; 4] = [0.1, 0.15, 0.2, 0.3];

    fn modes() -> impl Iterator<Item = f64> {
        (0..=120).map(|n| 60.0 + 0.5 * f64::from(n))
    }

    #[test]
    fn without_damping_a_sin2_stroke_leaves_what_m8a_says() {
        for (t, hz) in TIMES.into_iter().flat_map(|t| modes().map(move |hz| (t, hz))) {
            let left = Mode { hz, damping: 0.0 }.residual(&Profile::Sin2Acceleration.law(5.0, t));
            let said = Stroke::new(5.0, t).residual(hz);
            assert!((left.amplitude - said).abs() < 1e-12, "{t} s, {hz} Hz: {left:?} for {said}");
            assert!((left.largest - said).abs() < 1e-12, "{t} s, {hz} Hz: {left:?} for {said}");
        }
    }

    /// Constant accelerations in closed form: ∫exp(λ(T − τ)) over a piece is the difference of exp/−λ at its
    /// ends.
    #[test]
    fn with_damping_trapezoidal_speed_leaves_its_closed_form() {
        for (t, hz) in TIMES.into_iter().flat_map(|t| modes().map(move |hz| (t, hz))) {
            let mode = Mode::at(hz);
            let (decay, w_d) = mode.pole();
            let power = |left: f64| {
                let (sin, cos) = libm::sincos(w_d * left);
                (libm::exp(decay * left) * cos, libm::exp(decay * left) * sin)
            };
            let a = 4.5 * 5.0 / (t * t);
            let [start, first, second, end] = [t, t * 2.0 / 3.0, t / 3.0, 0.0].map(power);
            let sum = |of: fn((f64, f64)) -> f64| of(start) - of(first) - of(second) + of(end);
            let amplitude = a * libm::hypot(sum(|c| c.0), sum(|c| c.1)) / libm::hypot(decay, w_d) / w_d;
            let got = mode.residual(&Profile::TrapezoidalSpeed.law(5.0, t)).amplitude;
            assert!(
                (got - amplitude).abs() < 1e-9 * amplitude + 1e-13,
                "{t} s, {hz} Hz: {got} for {amplitude}"
            );
        }
    }

    /// The equation of motion integrated by Runge and Kutta, and its largest deflection after the end.
    #[test]
    fn every_law_leaves_what_stepping_leaves() {
        let (hz, t_end, steps) = (70.0, 0.1, 24_000);
        let w = TAU * hz;
        for profile in Profile::ALL {
            let (law, mode) = (profile.law(5.0, t_end), Mode::at(hz));
            let dt = t_end / f64::from(steps);
            let rate = |a: f64, u: f64, v: f64| -a - 2.0 * DAMPING * w * v - w * w * u;
            let (mut u, mut v, mut largest) = (0.0, 0.0, 0.0_f64);
            for step in 0..2 * steps {
                let at = |share: f64| {
                    let t = dt * (f64::from(step) + share);
                    if t <= t_end { (law.at)(t).a } else { 0.0 }
                };
                // Just inside of the step, so that a step of the acceleration belongs to one side.
                let (a0, a1, a2) = (at(1e-6), at(0.5), at(1.0 - 1e-6));
                let k1 = (v, rate(a0, u, v));
                let k2 = (v + 0.5 * dt * k1.1, rate(a1, u + 0.5 * dt * k1.0, v + 0.5 * dt * k1.1));
                let k3 = (v + 0.5 * dt * k2.1, rate(a1, u + 0.5 * dt * k2.0, v + 0.5 * dt * k2.1));
                let k4 = (v + dt * k3.1, rate(a2, u + dt * k3.0, v + dt * k3.1));
                u += dt / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
                v += dt / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
                let t = dt * f64::from(step + 1);
                if step % 1000 == 999 {
                    let exact = mode.deflection(&law, t);
                    assert!((u - exact).abs() < 1e-9, "{} at {t}: {exact} for {u}", profile.name());
                }
                largest = if step + 1 >= steps { largest.max(u.abs()) } else { 0.0 };
            }
            let got = mode.residual(&law);
            assert!((got.largest - largest).abs() < 1e-8, "{}: {got:?} for {largest}", profile.name());
            assert!(got.largest <= got.amplitude && got.largest > 0.93 * got.amplitude, "{got:?}");
        }
    }
}
