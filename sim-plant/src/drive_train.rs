//! Mechanics of one axis: motor with screw, an elastic mode, the slide, friction at both.
//! In: torque command in N·m, force on the slide in N. Out: positions in m from where it stood at the start, speeds in
//! m/s, torque in N·m. Source: see `config`.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | M, m | kg | motor side referred to the slide, J (2π/lead)²; slide |
//! | k, c | N/m, N s/m | elastic mode: k = m (2π f)², c = 2 ζ m 2π f |
//! | b_M, b_m | N s/m | viscous friction of screw and guide |
//! | tau, T_c | N·m, s | torque of the motor and lag of its current loop |
//!
//! ```text
//! M dv/dt = 2π/lead tau − k (x − y) − c (v − w) − b_M v − bristles(v)
//! m dw/dt = k (x − y) + c (v − w) − b_m w − bristles(w) + F
//! tau = command + (tau − command) exp(−t/T_c)        exact, its mean over the step drives the motor
//! ```
//! Semi-implicit Euler at 25 µs or less: speeds first, positions with the new speeds, so the mode neither grows nor
//! decays by the method.

use core::f64::consts::TAU;

use crate::config::{AxisTrain, PlantError};
use crate::friction::Bristles;

/// Longest step of the mechanics, s.
const LONGEST_STEP_S: f64 = 25e-6;
/// Largest ω² dt² of a mass on its springs: beyond it the step is too coarse for the stiffness.
const COARSEST: f64 = 0.1;

/// Motor, screw and slide of one axis.
#[derive(Clone, Debug)]
pub(crate) struct DriveTrain {
    steps: u32,
    step_s: f64,
    force_per_torque: f64,
    motor_step: f64,
    slide_step: f64,
    stiffness: f64,
    damping: f64,
    screw_viscous: f64,
    slide_viscous: f64,
    lag_left: f64,
    lag_mean: f64,
    screw: Bristles,
    guide: Bristles,
    motion: Motion,
}

/// State of the two masses and of the current loop.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Motion {
    pub(crate) motor_m: f64,
    pub(crate) motor_m_s: f64,
    pub(crate) slide_m: f64,
    pub(crate) slide_m_s: f64,
    pub(crate) torque_nm: f64,
}

impl DriveTrain {
    /// At rest. `section` names the axis in errors.
    ///
    /// # Errors
    /// A stiffness that the step cannot follow, by key.
    pub(crate) fn new(
        train: &AxisTrain,
        screw_lead_mm: f64,
        cycle_s: f64,
        section: &str,
    ) -> Result<DriveTrain, PlantError> {
        let steps = (cycle_s / LONGEST_STEP_S - 1e-9).ceil() as u32;
        let step_s = cycle_s / f64::from(steps);
        let force_per_torque = TAU / (screw_lead_mm * 1e-3);
        let motor_kg = train.inertia_kg_m2 * force_per_torque * force_per_torque;
        let slide_kg = train.slide_mass_kg;
        let mode_rad_s = TAU * train.mode_hz;
        let stiffness = slide_kg * mode_rad_s * mode_rad_s;
        let damping = 2.0 * train.mode_damping * slide_kg * mode_rad_s;
        let screw_n_m = train.screw_presliding_n_mm * 1e3;
        let guide_n_m = train.slide_presliding_n_mm * 1e3;
        let (screw_viscous, slide_viscous) =
            (train.screw_viscous_n_s_mm * 1e3, train.slide_viscous_n_s_mm * 1e3);
        for (key, springs, dashpots, kg) in [
            ("screw_presliding_n_mm", stiffness + screw_n_m, damping + screw_viscous, motor_kg),
            ("slide_presliding_n_mm", stiffness + guide_n_m, damping + slide_viscous, slide_kg),
        ] {
            let coarse = springs * step_s * step_s / kg + dashpots * step_s / kg;
            if coarse > COARSEST {
                return Err(PlantError::Value {
                    key: format!("{section}.{key}"),
                    value: if key.starts_with("screw") { screw_n_m * 1e-3 } else { guide_n_m * 1e-3 },
                    reason: format!(
                        "with mode_hz and the viscous friction too stiff for a mass of {kg:.1} kg; \
                         lower one of them or raise the mass"
                    ),
                });
            }
        }
        let lag_left = libm::exp(-step_s / train.current_lag_s);
        Ok(DriveTrain {
            steps,
            step_s,
            force_per_torque,
            motor_step: step_s / motor_kg,
            slide_step: step_s / slide_kg,
            stiffness,
            damping,
            screw_viscous,
            slide_viscous,
            lag_left,
            lag_mean: train.current_lag_s / step_s * (1.0 - lag_left),
            screw: Bristles::new(train.screw_coulomb_n, train.screw_coulomb_n, 1.0, screw_n_m, step_s),
            guide: Bristles::new(
                train.slide_coulomb_n,
                train.slide_static_n,
                train.slide_stribeck_mm_s * 1e-3,
                guide_n_m,
                step_s,
            ),
            motion: Motion::default(),
        })
    }

    pub(crate) fn motion(&self) -> &Motion {
        &self.motion
    }

    /// One control cycle: towards a torque command in N·m, or held by the brake without one; with a force on the
    /// slide in N.
    pub(crate) fn advance(&mut self, command_nm: Option<f64>, force_n: f64) {
        let Motion { motor_m: mut x, motor_m_s: mut v, slide_m: mut y, slide_m_s: mut w, torque_nm: mut tau } =
            self.motion;
        let (mut screw, mut guide) = (self.screw, self.guide);
        // A brake that holds is a motor of infinite mass.
        let motor_step = if command_nm.is_some() { self.motor_step } else { 0.0 };
        let command = command_nm.unwrap_or(0.0);
        if command_nm.is_none() {
            (v, tau) = (0.0, 0.0);
        }
        for _ in 0..self.steps {
            let mean = command + (tau - command) * self.lag_mean;
            tau = command + (tau - command) * self.lag_left;
            let spring = self.stiffness * (x - y) + self.damping * (v - w);
            let on_motor = self.force_per_torque * mean - spring - self.screw_viscous * v - screw.force(v);
            let on_slide = spring - self.slide_viscous * w - guide.force(w) + force_n;
            v += motor_step * on_motor;
            w += self.slide_step * on_slide;
            x += v * self.step_s;
            y += w * self.step_s;
        }
        (self.screw, self.guide) = (screw, guide);
        self.motion = Motion { motor_m: x, motor_m_s: v, slide_m: y, slide_m_s: w, torque_nm: tau };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CYCLE_S: f64 = 0.0005;

    fn frictionless() -> AxisTrain {
        AxisTrain {
            screw_coulomb_n: 0.0,
            screw_viscous_n_s_mm: 0.0,
            slide_coulomb_n: 0.0,
            slide_static_n: 0.0,
            slide_viscous_n_s_mm: 0.0,
            ..AxisTrain::default()
        }
    }

    fn built(train: &AxisTrain) -> DriveTrain {
        DriveTrain::new(train, 5.0, CYCLE_S, "plant.axis.x").unwrap()
    }

    fn torque(force_n: f64) -> Option<f64> {
        Some(force_n * 5e-3 / TAU)
    }

    #[test]
    fn momentum_is_the_impulse_of_the_lagging_torque() {
        let mut train = built(&frictionless());
        for cycle in 1..=400 {
            train.advance(Some(1.0), 0.0);
            let (t, motion) = (CYCLE_S * f64::from(cycle), train.motion());
            let left = libm::exp(-t / 0.0005);
            assert!((motion.torque_nm - (1.0 - left)).abs() < 1e-12);
            let impulse = TAU / 5e-3 * (t - 0.0005 * (1.0 - left));
            let momentum = 12e-4 * (TAU / 5e-3).powi(2) * motion.motor_m_s + 110.0 * motion.slide_m_s;
            assert!((momentum / impulse - 1.0).abs() < 1e-9, "{momentum} of {impulse} N s at {t} s");
        }
    }

    #[test]
    fn the_slide_swings_with_its_mode_while_the_brake_holds() {
        let mut train = built(&frictionless());
        train.advance(None, 1000.0);
        let (mut before, mut crossings, mut sizes) = (0.0, Vec::new(), Vec::new());
        for cycle in 0..400 {
            train.advance(None, 0.0);
            let Motion { motor_m, slide_m, slide_m_s, .. } = *train.motion();
            assert_eq!(motor_m, 0.0);
            if before < 0.0 && slide_m >= 0.0 {
                crossings.push(f64::from(cycle) - slide_m / (slide_m - before));
            }
            before = slide_m;
            sizes.push(slide_m * slide_m + (slide_m_s / (TAU * 100.0)).powi(2));
        }
        let periods = (crossings.len() - 1) as f64;
        let hz = periods / ((crossings[crossings.len() - 1] - crossings[0]) * CYCLE_S);
        assert!((hz - 99.955).abs() < 0.1, "{hz} Hz");
        // Between the same phases of whole periods: 15 periods of 20 cycles.
        let damping = -libm::log(sizes[380] / sizes[80]) / (2.0 * TAU * 100.0 * 300.0 * CYCLE_S);
        assert!((damping - 0.03).abs() < 0.001, "{damping}");
    }

    #[test]
    fn holds_below_breakaway_and_returns_elastically() {
        let mut train = built(&AxisTrain::default());
        for cycle in 0..=1000 {
            train.advance(torque(0.06 * f64::from(cycle)), 0.0);
        }
        let loaded_um = 1e6 * train.motion().motor_m;
        // 60 N against the bristles of the screw, and of the guide behind the elastic mode.
        let guide = 1.0 / (1.0 / 1.5e7 + 1.0 / 4.34e7);
        let spring_um = 60e6 / (3e7 + guide);
        assert!((spring_um..1.2 * spring_um).contains(&loaded_um), "{loaded_um} of {spring_um} µm");
        for cycle in (0..=1000).rev() {
            train.advance(torque(0.06 * f64::from(cycle)), 0.0);
        }
        // A fifth of the friction: ln(1/0.8) of the bristles' length forth, ln(1.2) back.
        let left_um = 1e6 * train.motion().motor_m;
        assert!(left_um < 0.25 * loaded_um, "{left_um} µm stayed of {loaded_um}");
    }

    #[test]
    fn breaks_away_beyond_the_static_friction() {
        for (force_n, moves) in [(280.0, false), (340.0, true)] {
            let mut train = built(&AxisTrain::default());
            for cycle in 0..4000 {
                train.advance(torque(force_n * (f64::from(cycle) / 2000.0).min(1.0)), 0.0);
            }
            let moved_um = 1e6 * train.motion().motor_m;
            assert_eq!(moved_um > 50.0, moves, "{moved_um} µm at {force_n} N");
        }
    }

    #[test]
    fn slides_at_the_speed_where_friction_takes_the_force() {
        let mut train = built(&AxisTrain::default());
        for _ in 0..20_000 {
            train.advance(torque(150.0 + 120.0 + 2600.0 * 0.05), 0.0);
        }
        let v = train.motion().motor_m_s;
        assert!((v - 0.05).abs() < 5e-5, "{v} m/s");
    }

    #[test]
    fn refuses_what_the_step_cannot_follow() {
        let stiff = AxisTrain { slide_mass_kg: 0.1, ..AxisTrain::default() };
        let refusal = DriveTrain::new(&stiff, 5.0, CYCLE_S, "plant.axis.x").unwrap_err().to_string();
        assert!(refusal.starts_with("plant.axis.x.slide_presliding_n_mm = 15000: with mode_hz"), "{refusal}");
    }
}
