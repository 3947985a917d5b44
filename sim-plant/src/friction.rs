//! Friction of a guide or a screw that holds before it slides. In: speed in m/s each step. Out: force in N.
//! Source: Canudas de Wit, Olsson, Åström, Lischinsky 1995 (LuGre), with a smooth Stribeck curve.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | z | m | mean deflection of the bristles |
//! | s0 | N/m | their stiffness: the friction is a spring until it breaks away |
//! | Fc, Fs | N | friction when sliding fast, and just before sliding |
//! | v_s | m/s | Stribeck speed |
//!
//! ```text
//! dz/dt = v − s0 |v| z/g(v),   F = s0 z,   g(v) = Fc + (Fs − Fc)/(1 + (v/v_s)²)
//! ```
//! The Stribeck curve of Hess and Soom takes the place of the Gaussian one: the same shape without an
//! exponential. The step is implicit in z, so it is stable at every speed, and its steady state is F = g(v)
//! exactly: with u = (v/v_s)² and G = Fs + Fc u,  z' = (z + v dt) G/(G + s0 |v| dt (1 + u)).

/// Bristles between two surfaces; their deflection, at first 0, is whose they are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bristles {
    pub(crate) coulomb_n: f64,
    pub(crate) static_n: f64,
    pub(crate) inverse_stribeck_squared: f64,
    pub(crate) stiffness_n_m: f64,
    pub(crate) stiffness_step: f64,
    pub(crate) step_s: f64,
}

impl Bristles {
    /// Forces in N, positive or both zero; Stribeck speed in m/s; stiffness in
    /// N/m.
    pub(crate) fn new(coulomb_n: f64, static_n: f64, stribeck_m_s: f64, n_m: f64, step_s: f64) -> Bristles {
        Bristles {
            coulomb_n,
            // Without any friction G would be 0/0.
            static_n: static_n.max(1e-9),
            inverse_stribeck_squared: 1.0 / (stribeck_m_s * stribeck_m_s),
            stiffness_n_m: n_m,
            stiffness_step: n_m * step_s,
            step_s,
        }
    }

    /// Force against the motion after one step at a speed, which takes the bristles along, N.
    #[inline]
    pub(crate) fn force(&self, deflection_m: &mut f64, v: f64) -> f64 {
        let u = v * v * self.inverse_stribeck_squared;
        let g = self.static_n + self.coulomb_n * u;
        let slip = self.stiffness_step * v.abs() * (1.0 + u);
        *deflection_m = (*deflection_m + v * self.step_s) * g / (g + slip);
        self.stiffness_n_m * *deflection_m
    }
}

#[cfg(test)]
mod tests {
    use super::Bristles;

    const STEP: f64 = 25e-6;

    fn guide() -> Bristles {
        Bristles::new(120.0, 160.0, 1.5e-3, 1.5e7, STEP)
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
}
