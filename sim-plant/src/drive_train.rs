//! Mechanics of one axis: motor with screw, backlash of the nut, an elastic mode, the slide, friction at
//! both. In: torque command in N·m, force on the slide in N. Out: positions in m from where it stood at the
//! start, speeds in m/s, torque in N·m. Source: see `config`.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | M, m | kg | motor side referred to the slide, J (2π/lead)²; slide |
//! | k, c | N/m, N s/m | elastic mode: k = m (2π f)², c = 2 ζ m 2π f |
//! | b_M, b_m | N s/m | viscous friction of screw and guide |
//! | tau, T_c | N·m, s | torque of the motor and lag of its current loop |
//! | x, v; y, w | m, m/s | motor (turns times lead) and slide |
//! | n, n' | m, 1 | nut by the true screw, and dn/dx (`screw`; without error x and 1) |
//! | B | m | backlash: at home the slide stands in its middle |
//! | f | N | force between nut and slide |
//!
//! ```text
//! M dv/dt = 2π/lead tau − n' f − b_M v − bristles(v)
//! m dw/dt = f − b_m w − bristles(w) + F
//! f = k g + c (n' v − w),   g = n − y                                           without backlash
//! f = max(0, k (g − B/2) + c (n' v − w)) beyond one flank, min(0, …) beyond the other, 0 between      (M73)
//! tau = command + (tau − command) exp(−t/T_c)        exact, its mean over the step drives the motor
//! ```
//! A flank pushes and does not pull: that is the max. The error of the screw acts like a lever, so its force
//! on the motor is n' f: what the motor gives in power, the slide takes. Semi-implicit Euler at 25 µs or
//! less: speeds first, positions with the new speeds, so the mode neither grows nor decays by the method.

use core::f64::consts::TAU;

use machine::AxisConfig;
use protocol::Axis;

use crate::config::{AxisTrain, PlantError};
use crate::friction::Bristles;
use crate::screw::ScrewError;

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
    half_backlash: f64,
    screw_error: Option<ScrewError>,
    screw_viscous: f64,
    slide_viscous: f64,
    /// Speed that the brake takes from the motor in a step, m/s.
    brake_step: f64,
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
    /// At rest at home.
    ///
    /// # Errors
    /// A stiffness that the step cannot follow, and a table that no screw has, by key.
    pub(crate) fn new(
        train: &AxisTrain,
        axis: Axis,
        belief: &AxisConfig,
        cycle_s: f64,
    ) -> Result<DriveTrain, PlantError> {
        let section = format!("plant.axis.{}", axis.name());
        let screw_lead_mm = belief.screw_lead_mm;
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
                        "with mode_hz and the viscous friction this is too stiff for a mass of {kg:.1} kg; \
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
            half_backlash: 0.5e-3 * train.backlash_mm,
            screw_error: ScrewError::new(train, screw_lead_mm, belief.home_mm, &section)?,
            screw_viscous,
            slide_viscous,
            brake_step: step_s / motor_kg * train.brake_n,
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

    /// Position and speed of the nut, m and m/s.
    pub(crate) fn nut(&self) -> (f64, f64) {
        let Motion { motor_m, motor_m_s, .. } = self.motion;
        let (nut_m, slope) = nut(&self.screw_error, motor_m);
        (nut_m, slope * motor_m_s)
    }

    /// One control cycle: towards a torque command in N·m, or without torque and held by the brake, which first
    /// has to stop what moves; with a force on the slide in N.
    pub(crate) fn advance(&mut self, command_nm: Option<f64>, force_n: f64) {
        let Motion { motor_m: mut x, motor_m_s: mut v, slide_m: mut y, slide_m_s: mut w, torque_nm: mut tau } =
            self.motion;
        let (mut screw, mut guide) = (self.screw, self.guide);
        let braked = command_nm.is_none();
        let command = command_nm.unwrap_or(0.0);
        if braked {
            tau = 0.0;
        }
        for _ in 0..self.steps {
            let mean = command + (tau - command) * self.lag_mean;
            tau = command + (tau - command) * self.lag_left;
            let (nut_m, slope) = nut(&self.screw_error, x);
            let push = self.push(nut_m - y, slope * v - w);
            let on_motor =
                self.force_per_torque * mean - slope * push - self.screw_viscous * v - screw.force(v);
            let on_slide = push - self.slide_viscous * w - guide.force(w) + force_n;
            v += self.motor_step * on_motor;
            if braked {
                v = if v.abs() > self.brake_step { v - self.brake_step.copysign(v) } else { 0.0 };
            }
            w += self.slide_step * on_slide;
            x += v * self.step_s;
            y += w * self.step_s;
        }
        (self.screw, self.guide) = (screw, guide);
        self.motion = Motion { motor_m: x, motor_m_s: v, slide_m: y, slide_m_s: w, torque_nm: tau };
    }

    /// Force of the nut on the slide (M73): the nut ahead by a gap, and gaining on the slide.
    #[inline]
    fn push(&self, gap_m: f64, gaining_m_s: f64) -> f64 {
        let force = |beyond_m: f64| self.stiffness * beyond_m + self.damping * gaining_m_s;
        if self.half_backlash == 0.0 {
            force(gap_m)
        } else if gap_m > self.half_backlash {
            force(gap_m - self.half_backlash).max(0.0)
        } else if gap_m < -self.half_backlash {
            force(gap_m + self.half_backlash).min(0.0)
        } else {
            0.0
        }
    }
}

/// Position of the nut for that of the motor, and its slope.
#[inline]
fn nut(screw: &Option<ScrewError>, x: f64) -> (f64, f64) {
    screw.as_ref().map_or((x, 1.0), |screw| screw.nut(x))
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

    fn of_x(train: &AxisTrain) -> Result<DriveTrain, PlantError> {
        let x = machine::Machine::default().axis[&Axis::X].clone();
        DriveTrain::new(train, Axis::X, &x, CYCLE_S)
    }

    fn built(train: &AxisTrain) -> DriveTrain {
        of_x(train).unwrap()
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
    fn the_nut_goes_through_its_backlash_before_it_takes_the_slide_along() {
        let mut train = built(&AxisTrain { backlash_mm: 0.02, ..AxisTrain::default() });
        // Pushes until the motor is there, then lets the brake hold it.
        let push = |train: &mut DriveTrain, force_n: f64, way_um: f64| {
            while 1e6 * train.motion().motor_m * force_n.signum() < way_um * force_n.signum() {
                train.advance(torque(force_n), 0.0);
            }
            (0..2000).for_each(|_| train.advance(None, 0.0));
            1e6 * train.motion().slide_m
        };
        // Half of it lies on either side of home.
        assert_eq!(push(&mut train, 170.0, 9.0), 0.0);
        let there_um = push(&mut train, 320.0, 110.0);
        // The slide may coast a little when the motor stops.
        let behind_um = 1e6 * train.motion().motor_m - there_um;
        assert!((7.0..10.5).contains(&behind_um), "{behind_um}");
        // Back through almost all of it, and then with the slide.
        let back_um = 1e6 * train.motion().motor_m - 16.0;
        assert!((push(&mut train, -170.0, back_um) - there_um).abs() < 0.1);
        let home_um = push(&mut train, -320.0, 0.0);
        let behind_um = 1e6 * train.motion().motor_m - home_um;
        assert!((-10.5..-7.0).contains(&behind_um), "{behind_um}");
    }

    #[test]
    fn a_flank_pushes_and_does_not_pull() {
        let train = built(&AxisTrain { backlash_mm: 0.02, ..AxisTrain::default() });
        assert_eq!(train.push(9e-6, 1.0), 0.0);
        assert_eq!(train.push(11e-6, -1.0), 0.0);
        assert_eq!(train.push(-11e-6, 1.0), 0.0);
        assert!(
            (train.push(20e-6, 0.0) - 434.2).abs() < 0.1 && (train.push(-20e-6, 0.0) + 434.2).abs() < 0.1
        );
        assert!(train.push(11e-6, 0.1) > 400.0);
    }

    #[test]
    fn the_error_of_the_screw_is_a_lever() {
        let screw_error = vec![[0.0, 0.0], [60.0, 0.0], [61.0, 40.0], [70.0, 40.0]];
        let mut train = built(&AxisTrain { screw_error, ..frictionless() });
        train.advance(torque(100.0), 0.0);
        let mut work = 0.0;
        for _ in 0..200 {
            let before = train.motion().motor_m;
            train.advance(torque(100.0), 0.0);
            work += 100.0 * (train.motion().motor_m - before);
        }
        let Motion { motor_m_s: v, slide_m_s: w, .. } = *train.motion();
        let motor_kg = 12e-4 * (TAU / 5e-3).powi(2);
        let moving = 0.5 * (motor_kg * v * v + 110.0 * w * w);
        assert!((moving / work - 1.0).abs() < 0.01, "{moving} J of {work} J");
        let (nut_m, nut_m_s) = train.nut();
        assert!(nut_m > train.motion().motor_m && nut_m_s != v, "{nut_m} {nut_m_s}");
    }

    #[test]
    fn refuses_what_the_step_cannot_follow() {
        let stiff = AxisTrain { slide_mass_kg: 0.1, ..AxisTrain::default() };
        let refusal = of_x(&stiff).unwrap_err().to_string();
        assert!(refusal.starts_with("plant.axis.x.slide_presliding_n_mm = 15000: with mode_hz"), "{refusal}");
    }
}
