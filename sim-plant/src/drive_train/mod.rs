//! Mechanics of one axis: motor with screw, backlash of the nut, an elastic mode, the slide, friction at
//! both. In: torque command in N·m, force on the slide in N. Out: positions in m from where it stood at the
//! start, speeds in m/s, torque in N·m. Source: see `config`.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | M, m | kg | motor side referred to the slide, J (2π/lead)²; slide |
//! | k, c | N/m, N s/m | elastic mode: k = m (2π f)², c = 2 ζ m 2π f |
//! | b_M, b_m | N s/m | viscous friction of screw and guide |
//! | tau, T_c | N·m, s | torque of the motor as its drive believes it, and lag of its current loop |
//! | e | – | what the motor gives more than its drive believes, a share |
//! | T_g, n_g, phi | N·m, –, rad | cogging: torque of the magnets, how often a turn, its phase |
//! | x, v; y, w | m, m/s | motor (turns times lead) and slide |
//! | n, n' | m, 1 | nut by the true screw, and dn/dx (`screw`; without error x and 1) |
//! | B | m | backlash: at home the slide stands in its middle |
//! | G | N | weight of the slide along the axis |
//! | f, F | N | force between nut and slide; other forces on the slide |
//!
//! ```text
//! M dv/dt = 2π/lead ((1 + e) tau − T_g sin(n_g 2π x/lead + phi)) − n' f − b_M v − bristles(v)         (M108)
//! m dw/dt = f − b_m w − bristles(w) + F + G
//! f = k g + c (n' v − w),   g = n − y − G/k − B/2 sgn G                         without backlash      (M111)
//! f = max(0, k (g − B/2) + c (n' v − w)) beyond one flank, min(0, …) beyond the other, 0 between      (M73)
//! tau = command + (tau − command) exp(−t/T_c)        exact, its mean over the step drives the motor
//! ```
//! The machine was referenced as it hangs. So the slide is at home when its weight rests on the spring of the
//! drive train, and with backlash on a flank: that is the rest of g. While the motor is without torque its
//! brake holds the weight. A flank pushes and does not pull: that is the max. The error of the screw acts
//! like a lever, so its force on the motor is n' f: what the motor gives in power, the slide takes.
//! Semi-implicit Euler at 25 µs or less: speeds first, positions with the new speeds, so the mode neither
//! grows nor decays by the method.

mod both;
mod cogging;
#[cfg(test)]
mod tests;

use core::f64::consts::TAU;

use protocol::Axis;

use crate::config::{AxisTrain, Facts, PlantError};
use crate::friction::{Bristles, Pair};
use crate::screw::ScrewError;
use crate::seed::Seed;
use cogging::Cogging;

/// Longest step of the mechanics, s.
const LONGEST_STEP_S: f64 = 25e-6;
/// Largest ω² dt² of a mass on its springs: beyond it the step is too coarse for the stiffness.
const COARSEST: f64 = 0.1;

/// Motor, screw and slide of one axis.
#[derive(Clone, Debug)]
pub(crate) struct DriveTrain {
    steps: u32,
    step_s: f64,
    /// What the motor gives by what its drive believes.
    torque_constant: f64,
    /// Force at the slide by torque as the drive believes it, 1/m.
    force_per_torque: f64,
    cogging: Option<Cogging>,
    motor_step: f64,
    slide_step: f64,
    stiffness: f64,
    damping: f64,
    half_backlash: f64,
    gravity_n: f64,
    /// What the nut lies back from the slide at home, m.
    hang_m: f64,
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

/// State of the two masses, of the current loop and of the bristles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Motion {
    pub(crate) motor_m: f64,
    pub(crate) motor_m_s: f64,
    pub(crate) slide_m: f64,
    pub(crate) slide_m_s: f64,
    pub(crate) torque_nm: f64,
    screw_m: f64,
    guide_m: f64,
}

/// What acts on a drive train in one control cycle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Acting {
    /// Torque command, N·m, as the drive believes it; without one the motor has no torque and is held by the
    /// brake, which first has to stop what moves.
    pub(crate) command_nm: Option<f64>,
    /// Force on the slide besides its weight, N.
    pub(crate) force_n: f64,
}

impl DriveTrain {
    /// At rest at home; where the magnets lie is drawn from the seed, if nothing is said of it.
    ///
    /// # Errors
    /// A stiffness that the step cannot follow, and a table that no screw has, by key.
    pub(crate) fn new(
        train: &AxisTrain,
        axis: Axis,
        facts: &Facts,
        cycle_s: f64,
        seed: &mut Seed,
    ) -> Result<DriveTrain, PlantError> {
        let section = format!("plant.axis.{}", axis.name());
        let screw_lead_mm = facts.screw_lead_mm;
        let steps = (cycle_s / LONGEST_STEP_S - 1e-9).ceil() as u32;
        let step_s = cycle_s / f64::from(steps);
        let turns = TAU / (screw_lead_mm * 1e-3);
        let motor_kg = train.inertia_kg_m2 * turns * turns;
        let slide_kg = train.slide_mass_kg;
        let mode_rad_s = TAU * train.mode_hz;
        let stiffness = slide_kg * mode_rad_s * mode_rad_s;
        let damping = 2.0 * train.mode_damping * slide_kg * mode_rad_s;
        let (screw, guide) = (train.screw(), train.guide());
        let (screw_viscous, slide_viscous) =
            (train.screw_viscous_n_s_mm * 1e3, train.slide_viscous_n_s_mm * 1e3);
        let drawn = seed.fraction();
        let at_home = train.cogging_deg.map_or(drawn, |degrees| degrees / 360.0);
        let homes_mm = [facts.built_home_mm, facts.home_mm];
        let screw_error = ScrewError::new(train, screw_lead_mm, homes_mm, &section)?;
        let off = (motor_mm(&screw_error, facts.home_mm) - facts.built_home_mm) / screw_lead_mm;
        let phase = at_home + f64::from(train.cogging_per_rev) * off;
        let cogging = Cogging::new(train.cogging_nm, train.cogging_per_rev, turns, phase);
        let magnets = cogging.map_or(0.0, |cogging| cogging.stiffness());
        for (key, pair, springs, dashpots, kg) in [
            ("screw_presliding_n_mm", screw, stiffness + magnets, damping + screw_viscous, motor_kg),
            ("slide_presliding_n_mm", guide, stiffness, damping + slide_viscous, slide_kg),
        ] {
            let (springs, dashpots) = (springs + pair.stiffness_n_m, dashpots + pair.damping_n_s_m);
            if (springs * step_s + dashpots) * step_s / kg > COARSEST {
                return Err(too_stiff(format!("{section}.{key}"), &pair, kg));
            }
        }
        let half_backlash = 0.5e-3 * train.backlash_mm;
        let torque_constant = 1.0 + 0.01 * train.torque_constant_pct;
        let lag_left = libm::exp(-step_s / train.current_lag_s);
        Ok(DriveTrain {
            steps,
            step_s,
            torque_constant,
            force_per_torque: turns * torque_constant,
            cogging,
            motor_step: step_s / motor_kg,
            slide_step: step_s / slide_kg,
            stiffness,
            damping,
            half_backlash,
            gravity_n: train.gravity_n,
            hang_m: hang_m(train.gravity_n, stiffness, half_backlash),
            screw_error,
            screw_viscous,
            slide_viscous,
            brake_step: step_s / motor_kg * train.brake_n,
            lag_left,
            lag_mean: train.current_lag_s / step_s * (1.0 - lag_left),
            screw: Bristles::new(screw, step_s),
            guide: Bristles::new(guide, step_s),
            motion: Motion::default(),
        })
    }

    pub(crate) fn motion(&self) -> &Motion {
        &self.motion
    }

    /// Position of the motor in the machine, mm, where its nut is at this one.
    pub(crate) fn motor_mm(&self, nut_mm: f64) -> f64 {
        motor_mm(&self.screw_error, nut_mm)
    }

    /// Position and speed of the nut, m and m/s.
    pub(crate) fn nut(&self) -> (f64, f64) {
        let Motion { motor_m, motor_m_s, .. } = self.motion;
        let (nut_m, slope) = nut(&self.screw_error, motor_m);
        (nut_m, slope * motor_m_s)
    }

    /// True torque of the motor, N·m.
    pub(crate) fn torque_nm(&self) -> f64 {
        let Motion { motor_m, torque_nm, .. } = self.motion;
        self.torque_constant * (torque_nm - self.cogging_n(motor_m) / self.force_per_torque)
    }

    /// One control cycle.
    pub(crate) fn advance(&mut self, acting: Acting) {
        let acting = Acting { force_n: acting.force_n + self.gravity_n, ..acting };
        let mut motion = self.begin(&acting);
        for _ in 0..self.steps {
            self.step(&mut motion, &acting);
        }
        self.motion = motion;
    }

    /// One control cycle of two drive trains with the same steps: with torque, in the time of one.
    pub(crate) fn advance_both(&mut self, acting: Acting, other: &mut DriveTrain, acting_there: Acting) {
        if let (Some(here), Some(there)) = (acting.command_nm, acting_there.command_nm) {
            let forces_n = [acting.force_n + self.gravity_n, acting_there.force_n + other.gravity_n];
            [self.motion, other.motion] = both::advance([self, other], [here, there], forces_n);
        } else {
            self.advance(acting);
            other.advance(acting_there);
        }
    }

    /// Whether the nut is where the motor is, and the motor runs evenly.
    fn is_plain(&self) -> bool {
        let follows = self.screw_error.is_none() && self.half_backlash == 0.0 && self.hang_m == 0.0;
        follows && self.cogging.is_none()
    }

    /// Force of the magnets against the motion, at the slide, N.
    #[inline]
    fn cogging_n(&self, motor_m: f64) -> f64 {
        self.cogging.map_or(0.0, |cogging| cogging.against(motor_m))
    }

    fn begin(&self, acting: &Acting) -> Motion {
        let torque_nm = if acting.command_nm.is_some() { self.motion.torque_nm } else { 0.0 };
        Motion { torque_nm, ..self.motion }
    }

    #[inline(always)]
    fn step(&self, motion: &mut Motion, acting: &Acting) {
        let Motion { motor_m: x, motor_m_s: v, slide_m: y, slide_m_s: w, torque_nm: tau, screw_m, guide_m } =
            motion;
        let command = acting.command_nm.unwrap_or(0.0);
        let mean = command + (*tau - command) * self.lag_mean;
        *tau = command + (*tau - command) * self.lag_left;
        let (nut_m, slope) = nut(&self.screw_error, *x);
        let push = self.push(nut_m - *y, slope * *v - *w);
        let on_motor = self.force_per_torque * mean
            - self.cogging_n(*x)
            - slope * push
            - self.screw_viscous * *v
            - self.screw.force(screw_m, *v);
        let on_slide = push - self.slide_viscous * *w - self.guide.force(guide_m, *w) + acting.force_n;
        *v += self.motor_step * on_motor;
        if acting.command_nm.is_none() {
            *v = if v.abs() > self.brake_step { *v - self.brake_step.copysign(*v) } else { 0.0 };
        }
        *w += self.slide_step * on_slide;
        *x += *v * self.step_s;
        *y += *w * self.step_s;
    }

    /// Force of the nut on the slide (M73, M111): the nut ahead by a gap, and gaining on the slide.
    #[inline]
    fn push(&self, gap_m: f64, gaining_m_s: f64) -> f64 {
        let gap_m = gap_m - self.hang_m;
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

/// Position of the motor for one of the nut, mm of the machine.
fn motor_mm(screw: &Option<ScrewError>, nut_mm: f64) -> f64 {
    screw.as_ref().map_or(nut_mm, |screw| screw.motor_mm(nut_mm))
}

/// What the nut lies back from the slide, m, where a weight hangs on it (M111).
fn hang_m(gravity_n: f64, stiffness: f64, half_backlash: f64) -> f64 {
    if gravity_n == 0.0 { 0.0 } else { gravity_n / stiffness + half_backlash.copysign(gravity_n) }
}

/// A pair whose bristles are too stiff for the step.
fn too_stiff(key: String, pair: &Pair, kg: f64) -> PlantError {
    let reason = format!(
        "with mode_hz and what damps it this is too stiff for a mass of {kg:.1} kg; lower one of them or raise \
         the mass"
    );
    PlantError::Value { key, value: pair.stiffness_n_m * 1e-3, reason }
}
