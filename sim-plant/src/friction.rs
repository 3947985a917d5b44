//! Friction of a guide or a screw that holds before it slides. In: speed in m/s each step. Out: force in N.
//! Source: Canudas de Wit, Olsson, Åström, Lischinsky 1995 (LuGre), with a smooth Stribeck curve.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | z | m | mean deflection of the bristles |
//! | s0 | N/m | their stiffness: the friction is a spring until it breaks away |
//! | s1 | N s/m | their damping: what brakes the spring while it does not slide yet |
//! | Fc, Fs | N | friction when sliding fast, and just before sliding |
//! | v_s | m/s | Stribeck speed |
//!
//! ```text
//! dz/dt = v − s0 |v| z/g(v),   F = s0 z + s1 dz/dt,   g(v) = Fc + (Fs − Fc)/(1 + (v/v_s)²)            (M107)
//! ```
//! The Stribeck curve of Hess and Soom takes the place of the Gaussian one: the same shape without an
//! exponential. The step is implicit in z, so it is stable at every speed, and its steady state is F = g(v)
//! exactly: with u = (v/v_s)² and G = Fs + Fc u,  z' = (z + v dt) G/(G + s0 |v| dt (1 + u)). The damping
//! takes the way of z in this step, (z' − z)/dt: bounded as z is, and none in steady sliding.

/// Bristles between two surfaces; their deflection, at first 0, is whose they are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bristles {
    pub(crate) coulomb_n: f64,
    pub(crate) static_n: f64,
    pub(crate) inverse_stribeck_squared: f64,
    pub(crate) stiffness_n_m: f64,
    pub(crate) stiffness_step: f64,
    /// Damping by the step, N/m.
    pub(crate) damping_rate: f64,
    pub(crate) step_s: f64,
}

/// What a sliding pair is like.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    /// Friction when sliding fast, N.
    pub(crate) coulomb_n: f64,
    /// And just before sliding, N; both are 0 or both are positive.
    pub(crate) static_n: f64,
    /// Speed over which the one falls to the other, m/s.
    pub(crate) stribeck_m_s: f64,
    /// Stiffness and damping before it slides, N/m and N s/m.
    pub(crate) stiffness_n_m: f64,
    pub(crate) damping_n_s_m: f64,
}

impl Bristles {
    /// Those of a pair, in steps of so many s.
    pub(crate) fn new(pair: Pair, step_s: f64) -> Bristles {
        Bristles {
            coulomb_n: pair.coulomb_n,
            // Without any friction G would be 0/0.
            static_n: pair.static_n.max(1e-9),
            inverse_stribeck_squared: 1.0 / (pair.stribeck_m_s * pair.stribeck_m_s),
            stiffness_n_m: pair.stiffness_n_m,
            stiffness_step: pair.stiffness_n_m * step_s,
            damping_rate: pair.damping_n_s_m / step_s,
            step_s,
        }
    }

    /// Force against the motion after one step at a speed, which takes the bristles along, N.
    #[inline]
    pub(crate) fn force(&self, deflection_m: &mut f64, v: f64) -> f64 {
        let u = v * v * self.inverse_stribeck_squared;
        let g = self.static_n + self.coulomb_n * u;
        let slip = self.stiffness_step * v.abs() * (1.0 + u);
        let before_m = *deflection_m;
        *deflection_m = (before_m + v * self.step_s) * g / (g + slip);
        self.stiffness_n_m * *deflection_m + self.damping_rate * (*deflection_m - before_m)
    }
}

#[cfg(test)]
mod tests {
    use super::{Bristles, Pair};

    const STEP: f64 = 25e-6;

    const GUIDE: Pair = Pair {
        coulomb_n: 120.0,
        static_n: 160.0,
        stribeck_m_s: 1.5e-3,
        stiffness_n_m: 1.5e7,
        damping_n_s_m: 0.0,
    };

    fn guide() -> Bristles {
        Bristles::new(GUIDE, STEP)
    }

    #[test]
    fn slides_with_the_stribeck_curve() {
        for (v, expected) in [(0.1, 120.0 + 40.0 / (1.0 + (100.0f64 / 1.5).powi(2))), (1.5e-3, 140.0)] {
            for sign in [1.0, -1.0] {
                let (guide, mut z) = (guide(), 0.0);
                let force = (0..200_000).map(|_| guide.force(&mut z, sign * v)).last().unwrap();
                assert!((force - sign * expected).abs() < 1e-6, "{force} N at {v} m/s");
            }
        }
    }

    #[test]
    fn is_a_spring_before_it_slides() {
        let (guide, mut z) = (guide(), 0.0);
        let mut moved = 0.0;
        for _ in 0..200 {
            moved += 1e-5 * STEP;
            let force = guide.force(&mut z, 1e-5);
            assert!((force / (1.5e7 * moved) - 1.0).abs() < 0.01, "{force} N after {moved} m");
        }
    }

    #[test]
    fn stays_bounded_at_any_speed() {
        let (guide, mut z) = (guide(), 0.0);
        for v in [1e3, -1e3, 1e6, 0.0, -1e-9] {
            assert!(guide.force(&mut z, v).abs() <= 160.0 * 1.000_001);
        }
    }

    #[test]
    fn damping_takes_the_swing_out_of_the_spring() {
        let (kg, ratio) = (110.0, 0.1);
        let rad_s = libm::sqrt(GUIDE.stiffness_n_m / kg);
        let guide = Bristles::new(Pair { damping_n_s_m: 2.0 * ratio * kg * rad_s, ..GUIDE }, STEP);
        // So small that nothing slides: 0.1 N of 160.
        let (mut z, mut v) = (0.1 / GUIDE.stiffness_n_m, 0.0);
        let mut peaks = Vec::new();
        for _ in 0..4000 {
            let before = v;
            v -= guide.force(&mut z, v) / kg * STEP;
            if before < 0.0 && v >= 0.0 {
                peaks.push(z);
            }
        }
        let damped = libm::log(peaks[0] / peaks[3]) / (3.0 * core::f64::consts::TAU);
        let expected = ratio / libm::sqrt(1.0 - ratio * ratio);
        assert!((damped / expected - 1.0).abs() < 0.02, "{damped}, not {expected}");
    }

    #[test]
    fn damping_is_gone_when_it_slides_and_bounded_when_it_turns() {
        let guide = Bristles::new(Pair { damping_n_s_m: 4e4, ..GUIDE }, STEP);
        let mut z = 0.0;
        let sliding = (0..20_000).map(|_| guide.force(&mut z, 0.1)).last().unwrap_or_default();
        assert!((sliding - 120.0).abs() < 0.02, "{sliding} N");
        // The bristles go over to the other side within a step.
        let turned = guide.force(&mut z, -1e3);
        let most = 160.0 + 4e4 / STEP * 2.0 * 160.0 / 1.5e7;
        assert!(turned < 0.0 && turned.abs() <= most, "{turned} N of {most} N");
    }
}
