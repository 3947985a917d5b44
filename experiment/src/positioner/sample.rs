//! Displacements of points by errors of the drives: drawn at random, and at the poses where they are largest.
//! In: size of part and positioner, errors of the drives. Out: mm.
//!
//! | symbol | meaning |
//! |---|---|
//! | L | every coordinate of a point, y2 and z2 lie within ±L |
//! | m, δ | errors of slides and angles lie within ±m, ±δ |
//! | u, q | −X sin β + Y cos β, X cos β + Y sin β: a point of the part turned by β |
//!
//! ```text
//! dz = δ((2L − q) sin α + (L + u) cos α)      at y2 = z2 = Z = L, both angles in error by −δ           (M50)
//! largest where (−q, u) = √2 L (2, 1)/√5, (sin α, cos α) ~ (2L − q, L + u):  (√5 + √2) L δ             (M51)
//! ```

use std::f64::consts::{FRAC_PI_4, PI, SQRT_2};

use shape::{DriveErrors, Drives, Positioner};
use sim_plant::Seed;

/// What is drawn for each case, evenly and at the ends.
pub(super) const DRAWS: u32 = 50_000;

/// A case: part and positioner of the size L, errors of the drives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Case {
    pub(super) size_mm: f64,
    pub(super) errors: DriveErrors,
}

/// What was drawn, mm.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Drawn {
    /// Largest magnitude along each axis of the machine.
    pub(super) largest: [f64; 3],
    /// Root of the mean square.
    pub(super) rms: [f64; 3],
    /// Largest difference between exact and linear displacement, along any axis.
    pub(super) neglected: f64,
}

/// How a case is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Spread {
    /// Everything evenly within its limits.
    Even,
    /// Sizes and errors at either end of their limits; poses evenly.
    Ends,
}

/// One displacement: exact, and linear (M50).
#[derive(Clone, Copy, Debug)]
pub(super) struct Displacement {
    pub(super) exact: [f64; 3],
    pub(super) linear: [f64; 3],
}

impl Case {
    /// Displaces one point.
    fn displaced(
        &self,
        [y2, z2]: [f64; 2],
        point: [f64; 3],
        [alpha, beta]: [f64; 2],
        error: Drives,
    ) -> Displacement {
        let positioner = Positioner { y2, z2, ..Positioner::default() };
        let pose = Drives { alpha, beta, ..Drives::default() };
        Displacement {
            exact: positioner.exact_error(point, &pose, &error),
            linear: positioner.linear_error(point, &pose, &error),
        }
    }

    /// Displacements at random.
    pub(super) fn draws(&self, seed: u64, spread: Spread) -> impl Iterator<Item = Displacement> {
        let case = *self;
        let mut seed = Seed(seed);
        std::iter::repeat_with(move || {
            let mut within = |limit: f64| match spread {
                Spread::Even => limit * (2.0 * seed.fraction() - 1.0),
                Spread::Ends => limit.copysign(seed.fraction() - 0.5),
            };
            let Case { size_mm, errors: DriveErrors { linear_mm, angular_rad } } = case;
            let [y2, z2, x, y, z] = [size_mm; 5].map(&mut within);
            let [dx, dy] = [linear_mm; 2].map(&mut within);
            let [da, db] = [angular_rad; 2].map(&mut within);
            let pose = [PI; 2].map(|limit| limit * (2.0 * seed.fraction() - 1.0));
            case.displaced([y2, z2], [x, y, z], pose, Drives { x: dx, y: dy, alpha: da, beta: db })
        })
    }

    /// What [`DRAWS`] of them come to.
    pub(super) fn drawn(&self, seed: u64, spread: Spread) -> Drawn {
        let mut drawn = Drawn::default();
        for Displacement { exact, linear } in self.draws(seed, spread).take(DRAWS as usize) {
            for (axis, (exact, linear)) in exact.into_iter().zip(linear).enumerate() {
                drawn.largest[axis] = drawn.largest[axis].max(exact.abs());
                drawn.rms[axis] += exact * exact / f64::from(DRAWS);
                drawn.neglected = drawn.neglected.max((exact - linear).abs());
            }
        }
        drawn.rms = drawn.rms.map(f64::sqrt);
        drawn
    }

    /// The poses where M51 says that x, y and z are displaced most: what comes of it, exactly.
    pub(super) fn corners(&self) -> [Displacement; 3] {
        let Case { size_mm: l, errors: DriveErrors { linear_mm: m, angular_rad: d } } = *self;
        let corner = |pose, error| self.displaced([l, l], [l, l, l], pose, error);
        // (q, u) = √2 L (cos φ, −sin φ) with φ = β − 45°
        let turned = |q: f64, u: f64| libm::atan2(-u, q) + FRAC_PI_4;
        let u = SQRT_2 * l / 5_f64.sqrt();
        let q = 2.0 * u;
        [
            corner([0.0, -FRAC_PI_4], Drives { x: m, beta: d, ..Drives::default() }),
            corner(
                [libm::atan2(-(l + u), 2.0 * l + q), turned(q, u)],
                Drives { y: m, alpha: d, beta: -d, ..Drives::default() },
            ),
            corner(
                [libm::atan2(2.0 * l + q, l + u), turned(-q, u)],
                Drives { alpha: -d, beta: -d, ..Drives::default() },
            ),
        ]
    }

    /// What is displaced most along x, y, z at those poses, mm.
    pub(super) fn attained(&self) -> [f64; 3] {
        let [x, y, z] = self.corners();
        [x.exact[0].abs(), y.exact[1].abs(), z.exact[2].abs()]
    }

    /// M51, mm.
    pub(super) fn tight(&self) -> [f64; 3] {
        Positioner::of_size(self.size_mm).error_bound([self.size_mm; 3], self.errors)
    }

    /// (9) of the source, mm.
    pub(super) fn published(&self) -> [f64; 3] {
        self.errors.published_bound(self.size_mm)
    }

    /// M91: what M51 leaves out at most, mm.
    pub(super) fn neglected(&self) -> f64 {
        Positioner::of_size(self.size_mm).neglected([self.size_mm; 3], self.errors)
    }
}
