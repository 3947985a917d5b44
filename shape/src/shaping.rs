//! Shaping by feed ratios: in a step the followers move in a ratio to their master. In: a path and the
//! surface under it where a step begins, and the step h of the master. Out: ratios, and the step of the
//! followers. mm, rad.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | f | mm | a follower as a function of its master; f′, f″, f‴ its derivatives |
//! | h, k | mm | signed step of the master X; step of Y that goes with it |
//! | K1, K2 | – | ratios of the feeds of Y and Z to that of X |
//! | ρ, τ | 1/mm, rad | signed curvature; angle from the tangent to the chord |
//!
//! | | |
//! |---|---|
//! | M36, M37 | without correction: K1 = f′; on a surface K2 = Z_X + Z_Y Y′ |
//! | M38 | ρ = f″/(1 + f′²)^(3/2), τ = m ρ h (1 + f′²)^½, m = ½; exact on a circle if its arc stands for h (1 + f′²)^½ |
//! | M39 | K1 = (f′ + τ)/(1 − τ f′) |
//! | M40 | exact: K = (f(X + h) − f(X))/h |
//! | M41 | M39 in the sections XOZ (over h), YOZ (over k = K_XOY h) and XOY (over h); K2 = K_XOZ + K_YOZ K_XOY |
//! | M42 | K2 = K_XOZ + K_YOZ K_XOY + Z_XY h K_XOY |
//! | M43 | M41 with the section YOZ at X + h |
//!
//! The series of m ([`Section::exact_m`], [`Section::series_m`], f‴) and single sections serve
//! `experiment surface` alone.
//!
//! Source: "An alternative approach to control the shaping of parts with spatially complex surfaces",
//! equations (3) to (17). M39 is its (13) as printed; (14) to (16) are printed with −τ in the numerator, (17)
//! without the mixed term.

use serde::{Deserialize, Serialize};

use crate::fit::Touch;
use crate::series::Series;

/// How the ratio of a follower is found from the place where a step begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Correction {
    /// The slope (M36, M37).
    None,
    /// As published: (13) for a plane curve, (14) to (17) for a surface with the signs that are printed.
    Published,
    /// The published correction with right signs (M38, M39, M41).
    PublishedSigns,
    /// The same with the mixed term (M42).
    Mixed,
    /// Divided differences (M40): no error at the end of a step.
    #[default]
    Exact,
}

impl Correction {
    /// All of them, from the roughest to the exact one.
    pub const ALL: [Correction; 5] = [
        Correction::None,
        Correction::Published,
        Correction::PublishedSigns,
        Correction::Mixed,
        Correction::Exact,
    ];
}

/// A follower as a function f of its master, about one place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Section {
    /// f′.
    pub slope: f64,
    /// f″, 1/mm.
    pub second: f64,
    /// f‴, 1/mm²; only the series of m asks for it.
    pub third: f64,
}

impl Section {
    /// Of two functions of one parameter. Not finite where the master stands still.
    #[must_use]
    pub fn of(master: &Series, follower: &Series) -> Section {
        let derivatives = |&Series([_, first, second, third]): &Series| [first, 2.0 * second, 6.0 * third];
        let ([a1, a2, a3], [b1, b2, b3]) = (derivatives(master), derivatives(follower));
        let second = b2 * a1 - b1 * a2;
        let third = (b3 * a1 - b1 * a3) * a1 - 3.0 * a2 * second;
        Section { slope: b1 / a1, second: second / (a1 * a1 * a1), third: third / (a1 * a1 * a1 * a1 * a1) }
    }

    /// Signed curvature ρ, 1/mm (M38).
    #[must_use]
    pub fn curvature(&self) -> f64 {
        let w2 = 1.0 + self.slope * self.slope;
        self.second / (w2 * w2.sqrt())
    }

    /// Angle τ from the tangent to the chord over a step `h` of the master, rad (M38).
    #[must_use]
    pub fn turn(&self, h: f64) -> f64 {
        0.5 * h * self.second / (1.0 + self.slope * self.slope)
    }

    /// Corrected ratio over a step `h` of the master (M39).
    #[must_use]
    pub fn corrected(&self, h: f64) -> f64 {
        self.turned(self.turn(h), 1.0)
    }

    /// The ratio as (14) to (16) are printed: with −τ in the numerator.
    #[must_use]
    pub fn printed(&self, h: f64) -> f64 {
        self.turned(self.turn(h), -1.0)
    }

    fn turned(&self, tau: f64, sign: f64) -> f64 {
        (self.slope + sign * tau) / (1.0 - tau * self.slope)
    }

    /// The m of M38 with which M39 gives the ratio `exact` over a step `h`.
    #[must_use]
    pub fn exact_m(&self, h: f64, exact: f64) -> f64 {
        let tau = libm::atan((exact - self.slope) / (1.0 + exact * self.slope));
        0.5 * tau / self.turn(h)
    }

    /// Its series, to the first order of `h`: ½ + h (f‴/6f″ − f′f″/4(1 + f′²)) (M38).
    #[must_use]
    pub fn series_m(&self, h: f64) -> f64 {
        let w2 = 1.0 + self.slope * self.slope;
        0.5 + h * (self.third / (6.0 * self.second) - self.slope * self.second / (4.0 * w2))
    }
}

/// A surface Z(X, Y) with a path on it, about one place; X leads.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sections {
    /// Z over X at constant Y.
    pub xoz: Section,
    /// Z over Y at constant X.
    pub yoz: Section,
    /// Y over X: the path seen from above.
    pub xoy: Section,
    /// Z_XY, 1/mm.
    pub mixed: f64,
}

impl Sections {
    /// Ratios K1 of Y and K2 of Z over a step `h` of X (M37, M41, M42). `ways` are the exact ones of Y and Z:
    /// with [`Correction::Exact`] the ratios are theirs (M40). With `yoz` taken at X + h, the published
    /// correction with right signs is M43.
    #[must_use]
    pub fn ratios(&self, correction: Correction, h: f64, ways: [f64; 2]) -> [f64; 2] {
        let Sections { xoz, yoz, xoy, mixed } = self;
        match correction {
            Correction::None => [xoy.slope, xoz.slope + yoz.slope * xoy.slope],
            Correction::Published => {
                let k1 = xoy.printed(h);
                [k1, xoz.printed(h) + yoz.printed(k1 * h) * k1]
            }
            Correction::PublishedSigns => {
                let k1 = xoy.corrected(h);
                [k1, xoz.corrected(h) + yoz.corrected(k1 * h) * k1]
            }
            Correction::Mixed => {
                let k1 = xoy.corrected(h);
                [k1, xoz.corrected(h) + (yoz.corrected(k1 * h) + mixed * h) * k1]
            }
            Correction::Exact => ways.map(|way| way / h),
        }
    }
}

/// A path where a step of it begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// X, Y, Z as functions of one parameter, mm.
    pub path: [Series; 3],
    /// The surface that the path lies on, if it lies on one: of the point that moves, so the offset one of a
    /// tool.
    pub surface: Option<Touch>,
}

impl Place {
    /// The step that the axes make where the exact one is `exact`, mm: its largest component leads and stays
    /// as it is, the others follow in the [`Place::ratios`].
    ///
    /// The true ratios are at most 1 in magnitude. A correction that gives more than 2 is asked for a step
    /// beyond its range, a turn of the path by a good part of a right angle; the exact step is made then.
    #[must_use]
    pub fn step(&self, correction: Correction, exact: [f64; 3]) -> [f64; 3] {
        let leader = leader(exact);
        let mut step = exact;
        for (axis, ratio) in FOLLOWERS[leader].into_iter().zip(self.ratios(leader, correction, exact)) {
            if ratio.abs() <= 2.0 {
                step[axis] = ratio * exact[leader];
            }
        }
        step
    }

    /// Ratios of the two other axes, in the order X, Y, Z, to the one that leads (0, 1 or 2; a higher one is
    /// Z), for the step whose exact ways are `exact`, mm. On a surface led by X or Y they are M41 with what
    /// goes with it, else every follower is a plane curve over its master (M39). Not finite where the leader
    /// stands still.
    #[must_use]
    pub fn ratios(&self, leader: usize, correction: Correction, exact: [f64; 3]) -> [f64; 2] {
        let leader = leader.min(2);
        let (h, followers) = (exact[leader], FOLLOWERS[leader]);
        match (self.surface, leader) {
            (Some(surface), 0 | 1) => {
                self.sections(&surface, leader).ratios(correction, h, followers.map(|axis| exact[axis]))
            }
            _ => followers.map(|axis| {
                let section = Section::of(&self.path[leader], &self.path[axis]);
                match correction {
                    Correction::None => section.slope,
                    Correction::Published | Correction::PublishedSigns | Correction::Mixed => {
                        section.corrected(h)
                    }
                    Correction::Exact => exact[axis] / h,
                }
            }),
        }
    }

    /// The surface and the path on it, with X (0) or Y (1) leading. Y is then "X" of the sections.
    fn sections(&self, surface: &Touch, leader: usize) -> Sections {
        let follower = FOLLOWERS[leader][0];
        let own = |axis: usize| Section {
            slope: surface.slope[axis],
            second: surface.second[2 * axis],
            third: 0.0,
        };
        Sections {
            xoz: own(leader),
            yoz: own(follower),
            xoy: Section::of(&self.path[leader], &self.path[follower]),
            mixed: surface.second[1],
        }
    }
}

/// The other two of the axes X, Y, Z for each that leads.
pub const FOLLOWERS: [[usize; 2]; 3] = [[1, 2], [0, 2], [0, 1]];

/// The axis of the largest component; of equal ones the first.
#[must_use]
pub fn leader(step: [f64; 3]) -> usize {
    let largest = |best: usize, axis: usize| if step[axis].abs() > step[best].abs() { axis } else { best };
    (1..3).fold(0, largest)
}
