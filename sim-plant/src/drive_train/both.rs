//! Two drive trains whose motors have torque, side by side: the same steps as one by one, number for number,
//! with the same operation on both in one instruction. Plain is a train without backlash, error of the screw,
//! weight and cogging: its nut is where its motor is, and its motor runs evenly.

use core::array::from_fn;
use core::ops::{Add, Div, Mul, Sub};

use super::{DriveTrain, Motion, nut};
use crate::friction::Bristles;

/// A number of each of the two, side by side in memory: so the compiler takes them in one instruction.
#[derive(Clone, Copy)]
#[repr(align(16))]
struct Both([f64; 2]);

impl Both {
    fn of<T>(two: [&T; 2], number: impl Fn(&T) -> f64) -> Both {
        Both(from_fn(|lane| number(two[lane])))
    }

    #[inline(always)]
    fn abs(self) -> Both {
        Both(self.0.map(f64::abs))
    }
}

macro_rules! operation {
    ($name:ident, $method:ident, $sign:tt) => {
        impl $name for Both {
            type Output = Both;
            #[inline(always)]
            fn $method(self, other: Both) -> Both {
                Both([self.0[0] $sign other.0[0], self.0[1] $sign other.0[1]])
            }
        }
    };
}

operation!(Add, add, +);
operation!(Sub, sub, -);
operation!(Mul, mul, *);
operation!(Div, div, /);

/// Bristles of both, as [`Bristles::force`].
struct BothBristles {
    coulomb_n: Both,
    static_n: Both,
    inverse_stribeck_squared: Both,
    stiffness_n_m: Both,
    stiffness_step: Both,
    damping_rate: Both,
    step_s: Both,
}

impl BothBristles {
    fn of(two: [&Bristles; 2]) -> BothBristles {
        BothBristles {
            coulomb_n: Both::of(two, |own| own.coulomb_n),
            static_n: Both::of(two, |own| own.static_n),
            inverse_stribeck_squared: Both::of(two, |own| own.inverse_stribeck_squared),
            stiffness_n_m: Both::of(two, |own| own.stiffness_n_m),
            stiffness_step: Both::of(two, |own| own.stiffness_step),
            damping_rate: Both::of(two, |own| own.damping_rate),
            step_s: Both::of(two, |own| own.step_s),
        }
    }

    #[inline(always)]
    fn force(&self, deflection_m: &mut Both, v: Both) -> Both {
        let u = v * v * self.inverse_stribeck_squared;
        let g = self.static_n + self.coulomb_n * u;
        let slip = self.stiffness_step * v.abs() * (Both([1.0; 2]) + u);
        let before_m = *deflection_m;
        *deflection_m = (before_m + v * self.step_s) * g / (g + slip);
        self.stiffness_n_m * *deflection_m + self.damping_rate * (*deflection_m - before_m)
    }
}

/// What does not change of both.
struct Trains {
    lag_mean: Both,
    lag_left: Both,
    force_per_torque: Both,
    stiffness: Both,
    damping: Both,
    screw_viscous: Both,
    slide_viscous: Both,
    motor_step: Both,
    slide_step: Both,
    step_s: Both,
    screw: BothBristles,
    guide: BothBristles,
}

/// The [`Motion`] of both.
struct Motions {
    motor_m: Both,
    motor_m_s: Both,
    slide_m: Both,
    slide_m_s: Both,
    torque_nm: Both,
    screw_m: Both,
    guide_m: Both,
}

impl Trains {
    fn of(two: [&DriveTrain; 2]) -> Trains {
        Trains {
            lag_mean: Both::of(two, |train| train.lag_mean),
            lag_left: Both::of(two, |train| train.lag_left),
            force_per_torque: Both::of(two, |train| train.force_per_torque),
            stiffness: Both::of(two, |train| train.stiffness),
            damping: Both::of(two, |train| train.damping),
            screw_viscous: Both::of(two, |train| train.screw_viscous),
            slide_viscous: Both::of(two, |train| train.slide_viscous),
            motor_step: Both::of(two, |train| train.motor_step),
            slide_step: Both::of(two, |train| train.slide_step),
            step_s: Both::of(two, |train| train.step_s),
            screw: BothBristles::of(two.map(|train| &train.screw)),
            guide: BothBristles::of(two.map(|train| &train.guide)),
        }
    }

    /// So many steps of two whose nuts are where their motors are. By itself: among other code the compiler
    /// pairs other numbers than those of the two.
    #[inline(never)]
    fn advance_plain(&self, steps: u32, motions: &mut Motions, acting: [Both; 2]) {
        let push = |gap: Both, gaining: Both| self.stiffness * gap + self.damping * gaining;
        let even = |_| Both([0.0; 2]);
        self.advance(steps, motions, acting, even, |x| (x, Both([1.0; 2])), push);
    }

    /// The same of any two: magnets, nut and backlash of each are its own.
    #[inline(never)]
    fn advance_any(&self, two: [&DriveTrain; 2], motions: &mut Motions, acting: [Both; 2]) {
        let cogging = |Both(x): Both| Both(from_fn(|lane| two[lane].cogging_n(x[lane])));
        let nut = |Both(x): Both| {
            let [here, there] = from_fn(|lane| nut(&two[lane].screw_error, x[lane]));
            (Both([here.0, there.0]), Both([here.1, there.1]))
        };
        let push =
            |gap: Both, gaining: Both| Both(from_fn(|lane| two[lane].push(gap.0[lane], gaining.0[lane])));
        self.advance(two[0].steps, motions, acting, cogging, nut, push);
    }

    /// Steps under torque commands in N·m and forces on the slides in N, as those of [`DriveTrain`].
    #[inline(always)]
    fn advance(
        &self,
        steps: u32,
        motions: &mut Motions,
        [command, force_n]: [Both; 2],
        cogging: impl Fn(Both) -> Both,
        nut: impl Fn(Both) -> (Both, Both),
        push: impl Fn(Both, Both) -> Both,
    ) {
        let Motions {
            motor_m: mut x,
            motor_m_s: mut v,
            slide_m: mut y,
            slide_m_s: mut w,
            torque_nm: mut tau,
            mut screw_m,
            mut guide_m,
        } = *motions;
        for _ in 0..steps {
            let mean = command + (tau - command) * self.lag_mean;
            tau = command + (tau - command) * self.lag_left;
            let (nut_m, slope) = nut(x);
            let push = push(nut_m - y, slope * v - w);
            let screw_n = self.screw.force(&mut screw_m, v);
            let guide_n = self.guide.force(&mut guide_m, w);
            let driving = self.force_per_torque * mean - cogging(x);
            let on_motor = driving - slope * push - self.screw_viscous * v - screw_n;
            let on_slide = push - self.slide_viscous * w - guide_n + force_n;
            v = v + self.motor_step * on_motor;
            w = w + self.slide_step * on_slide;
            x = x + v * self.step_s;
            y = y + w * self.step_s;
        }
        *motions =
            Motions { motor_m: x, motor_m_s: v, slide_m: y, slide_m_s: w, torque_nm: tau, screw_m, guide_m };
    }
}

impl Motions {
    fn of(two: [&Motion; 2]) -> Motions {
        Motions {
            motor_m: Both::of(two, |motion| motion.motor_m),
            motor_m_s: Both::of(two, |motion| motion.motor_m_s),
            slide_m: Both::of(two, |motion| motion.slide_m),
            slide_m_s: Both::of(two, |motion| motion.slide_m_s),
            torque_nm: Both::of(two, |motion| motion.torque_nm),
            screw_m: Both::of(two, |motion| motion.screw_m),
            guide_m: Both::of(two, |motion| motion.guide_m),
        }
    }

    fn each(&self) -> [Motion; 2] {
        from_fn(|lane| Motion {
            motor_m: self.motor_m.0[lane],
            motor_m_s: self.motor_m_s.0[lane],
            slide_m: self.slide_m.0[lane],
            slide_m_s: self.slide_m_s.0[lane],
            torque_nm: self.torque_nm.0[lane],
            screw_m: self.screw_m.0[lane],
            guide_m: self.guide_m.0[lane],
        })
    }
}

/// The states after one control cycle under torque commands in N·m and forces on the slides in N.
pub(super) fn advance(two: [&DriveTrain; 2], commands_nm: [f64; 2], forces_n: [f64; 2]) -> [Motion; 2] {
    let mut motions = Motions::of(two.map(|train| &train.motion));
    let (trains, acting) = (Trains::of(two), [Both(commands_nm), Both(forces_n)]);
    if two.iter().all(|train| train.is_plain()) {
        trains.advance_plain(two[0].steps, &mut motions, acting);
    } else {
        trains.advance_any(two, &mut motions, acting);
    }
    motions.each()
}
