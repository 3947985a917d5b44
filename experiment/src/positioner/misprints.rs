//! What is misprinted in the published formulas, and how that is known. In: nothing. Out: what is printed,
//! what is right, and a number that shows it.
//!
//! | symbol | meaning |
//! |---|---|
//! | l | direction that is to be turned onto the beam, +Z |
//! | h | (lx² + ly²)^½ |

use std::f64::consts::{FRAC_PI_2, PI};

use shape::{Branch, Drives, Positioner};

use super::{
    EXAMPLE,
    sample::{DRAWS, Spread},
};

/// One formula.
#[derive(Clone, Debug)]
pub(super) struct Misprint {
    pub(super) formula: &'static str,
    pub(super) printed: &'static str,
    pub(super) right: &'static str,
    /// How it was established, with the number.
    pub(super) shown: String,
}

impl Misprint {
    pub(super) fn sentence(&self) -> String {
        let Misprint { formula, printed, right, shown } = self;
        format!("{formula}: printed {printed}; right {right}. {shown}")
    }
}

/// A direction with nothing special about it.
const DIRECTION: [f64; 3] = [1.0, 2.0, 3.0];

pub(super) fn all(seed: u64) -> Vec<Misprint> {
    vec![condition(), pairs(), zeros(), coefficient(seed), rounded()]
}

/// A direction turned by angles.
fn turned(alpha: f64, beta: f64) -> [f64; 3] {
    Positioner::turned(DIRECTION, &Drives { alpha, beta, ..Drives::default() })
}

/// Angle between a direction and the beam, degrees.
fn off_the_beam([x, y, z]: [f64; 3]) -> f64 {
    libm::atan2(libm::hypot(x, y), z).to_degrees()
}

/// Both conditions of (5) are of a direction that is turned: its x and its y are 0.
fn condition() -> Misprint {
    let [lx, ly, lz] = DIRECTION;
    let length = (lx * lx + ly * ly + lz * lz).sqrt();
    let Drives { alpha, beta, .. } =
        Positioner::default().inverse([0.0; 3], DIRECTION, [0.0; 2], Branch::Negative, 0.0);
    let ((sa, ca), (sb, cb)) = (libm::sincos(alpha), libm::sincos(beta));
    let across = ca * (ly * cb - lx * sb);
    let [right, printed] = [lz * sa, lz * ca * cb].map(|term| (across + term) / length);
    // With the first condition kept, the printed one leaves nothing but cos α = 0.
    let left = off_the_beam(turned(-FRAC_PI_2, beta)).min(off_the_beam(turned(FRAC_PI_2, beta)));
    Misprint {
        formula: "(5)",
        printed: "l_z cos α cos β in the condition along y",
        right: "l_z sin α",
        shown: format!(
            "By multiplying out the matrices of (3), and by the pose that turns l onto the beam: for l = (1, 2, 3)/√14 it \
             leaves {:.3} in the right condition and {:.3} in the printed one, for 0. What fulfils the printed one is α = ±90°, \
             which leaves l {:.1}° off the beam.",
            right.abs(),
            printed,
            left
        ),
    }
}

/// Every pair of angles that "+ πk" allows: β, and α that fulfils the second condition with it.
fn pairs() -> Misprint {
    let [lx, ly, lz] = DIRECTION;
    let beta = libm::atan(-lx / ly);
    let alpha = |beta: f64| libm::atan((lx * libm::sin(beta) - ly * libm::cos(beta)) / lz);
    let turns = [[0.0, 0.0], [0.0, PI], [PI, 0.0], [PI, PI]];
    let is_away = |[a, b]: &[f64; 2]| off_the_beam(turned(alpha(beta + b) + a, beta + b)) > 179.999;
    let wrong = turns.iter().filter(|pair| is_away(pair)).count();
    Misprint {
        formula: "(7)",
        printed: "arctangents with a + πk each",
        right: "two pairs, by atan2 of both components (M49)",
        shown: format!(
            "Both conditions are also fulfilled by a direction that points away from the beam, l onto −Z: {wrong} of the \
             four pairs for l = (1, 2, 3)/√14 do so. The beam would meet the back of the part."
        ),
    }
}

/// Directions for which (7) divides by 0.
fn zeros() -> Misprint {
    let inverse = |l| Positioner::default().inverse([0.0; 3], l, [0.0; 2], Branch::Negative, 0.0);
    let (flat, along) = (inverse([0.6, 0.8, 0.0]), inverse([0.6, 0.0, 0.8]));
    Misprint {
        formula: "(7)",
        printed: "quotients by l_y and l_z",
        right: "atan2, which has a value wherever l has one",
        shown: format!(
            "l_z = 0 is a direction in the plane of the table: α = {:.0}°. l_y = 0 is one in the plane of X and Z: β = \
             {:.0}°. In print both are divided by 0.",
            flat.alpha.to_degrees(),
            along.beta.to_degrees()
        ),
    }
}

/// The bound (9) is valid, but nothing reaches it.
fn coefficient(seed: u64) -> Misprint {
    let (attained, tight, published) = (EXAMPLE.attained(), EXAMPLE.tight(), EXAMPLE.published());
    let seen = EXAMPLE.drawn(seed, Spread::Ends).largest;
    Misprint {
        formula: "(9)",
        printed: "2 + √2 + 1/√2 = 4.121 for y and z",
        right: "√5 + √2 = 3.650 (M51)",
        shown: format!(
            "No misprint, but {:.0} % too much: it adds the largest values of terms that are not largest in one pose. At \
             the pose where their sum is, z is displaced by {:.3} µm, {:.5} of the tight bound and {:.3} of the published \
             one; the largest of {} drawn at their ends is {:.3} µm.",
            100.0 * (published[2] / tight[2] - 1.0),
            1e3 * attained[2],
            attained[2] / tight[2],
            attained[2] / published[2],
            DRAWS,
            1e3 * seen[2]
        ),
    }
}

/// The example (10) of the bound.
fn rounded() -> Misprint {
    let (published, tight) = (EXAMPLE.published(), EXAMPLE.tight());
    Misprint {
        formula: "(10)",
        printed: "0.05 and 0.02 mm for y and z",
        right: "0.0501 and 0.0201 mm by (9), 0.0478 and 0.0178 mm by M51",
        shown: format!(
            "A bound must not be rounded down: (9) gives {:.4} and {:.4} mm for 0.0014°, 0.03 mm and 200 mm. With the \
             tight factor, {:.4} and {:.4} mm, what is printed holds all the same.",
            published[1], published[2], tight[1], tight[2]
        ),
    }
}
