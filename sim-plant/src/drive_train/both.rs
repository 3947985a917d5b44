//! Two plain drive trains side by side: the same steps as one by one, number for number, with the same
//! operation on both in one instruction. Plain is a train without backlash and without error of the screw,
//! whose motor has torque.

use core::array::from_fn;
use core::ops::{Add, Div, Mul, Sub};

use super::{DriveTrain, Motion};
use crate::friction::Bristles;

/// A number of each of the two.
#[derive(Clone, Copy)]
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
            step_s: Both::of(two, |own| own.step_s),
        }
    }

    #[inline(always)]
    fn force(&self, deflection_m: &mut Both, v: Both) -> Both {
        let u = v * v * self.inverse_stribeck_squared;
        let g = self.static_n + self.coulomb_n * u;
        let slip = self.stiffness_step * v.abs() * (Both([1.0; 2]) + u);
        *deflection_m = (*deflection_m + v * self.step_s) * g / (g + slip);
        self.stiffness_n_m * *deflection_m
    }
}

/// The states after one control cycle under torque commands in N·m and forces on the slides in N.
pub(super) fn advance(two: [&DriveTrain; 2], commands_nm: [f64; 2], forces_n: [f64; 2]) -> [Motion; 2] {
    let of = |number: fn(&DriveTrain) -> f64| Both::of(two, number);
    let (command, force_n) = (Both(commands_nm), Both(forces_n));
    let (lag_mean, lag_left) = (of(|train| train.lag_mean), of(|train| train.lag_left));
    let force_per_torque = of(|train| train.force_per_torque);
    let (stiffness, damping) = (of(|train| train.stiffness), of(|train| train.damping));
    let (screw_viscous, slide_viscous) = (of(|train| train.screw_viscous), of(|train| train.slide_viscous));
    let (motor_step, slide_step) = (of(|train| train.motor_step), of(|train| train.slide_step));
    let step_s = of(|train| train.step_s);
    let screw = BothBristles::of(two.map(|train| &train.screw));
    let guide = BothBristles::of(two.map(|train| &train.guide));

    let mut x = of(|train| train.motion.motor_m);
    let mut v = of(|train| train.motion.motor_m_s);
    let mut y = of(|train| train.motion.slide_m);
    let mut w = of(|train| train.motion.slide_m_s);
    let mut tau = of(|train| train.motion.torque_nm);
    let mut screw_m = of(|train| train.motion.screw_m);
    let mut guide_m = of(|train| train.motion.guide_m);
    for _ in 0..two[0].steps {
        let mean = command + (tau - command) * lag_mean;
        tau = command + (tau - command) * lag_left;
        let push = stiffness * (x - y) + damping * (v - w);
        let on_motor = force_per_torque * mean - push - screw_viscous * v - screw.force(&mut screw_m, v);
        let on_slide = push - slide_viscous * w - guide.force(&mut guide_m, w) + force_n;
        v = v + motor_step * on_motor;
        w = w + slide_step * on_slide;
        x = x + v * step_s;
        y = y + w * step_s;
    }
    from_fn(|lane| Motion {
        motor_m: x.0[lane],
        motor_m_s: v.0[lane],
        slide_m: y.0[lane],
        slide_m_s: w.0[lane],
        torque_nm: tau.0[lane],
        screw_m: screw_m.0[lane],
        guide_m: guide_m.0[lane],
    })
}
