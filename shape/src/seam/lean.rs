//! How a direction leans from the turn axis: M49 for series, where the direction goes through ±Z, too.
//! In: a direction about a place of t. Out: both solutions of M49, angles with their derivatives.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | f(τ) | – | (lx, ly) about a place, τ the parameter from there; coefficients f₀ … f₄ |
//! | τ₀ | – | where f is 0, if it is near |
//! | h | – | distance from ±Z with the sign of α |
//!
//! ```text
//! f = (τ − τ₀) g,   g₃ = f₄,   gₙ = fₙ₊₁ + τ₀ gₙ₊₁;   h = ±(τ − τ₀) |g|,   (lx, ly)/h = ±g/|g|         (M98)
//! f₄ = (3 d″ − η d‴)/12η² + O(η²),   d(η) = f(η) − f₀ − f₁ η − f₂ η² − f₃ η³
//! ```
//! So α goes through 0 or 180° and β stays on its way: the distance |f| would have a corner there, and its
//! azimuth a step of 180°. Series end with f₃; f₄, of which the third derivative of β needs to know, comes
//! from a place beside.

use crate::number::Number;
use crate::positioner::nearest_turn;
use crate::{Branch, Series};

/// Directions that lean less are asked whether they go through ±Z, rad.
const NEARLY_UPRIGHT: f64 = 2e-3;
/// A direction that comes as near to ±Z goes through it, rad: rounding of what it is made from.
const ROUNDED: f64 = 4e-15;
/// Steps of Newton's method to τ₀: each doubles the digits, of which one is there at the start.
const STEPS: usize = 5;

/// A direction about a place of its seam.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lean {
    /// h of the positive branch.
    h: Series,
    lz: Series,
    /// Along (lx, ly)/h, and its length.
    flat: [Series; 2],
    norm: Series,
    /// Whether the direction is ±Z all along: both branches are one.
    free: bool,
}

/// A solution of M49.
pub(super) struct Angles {
    /// α and β, degrees.
    pub(super) degrees: [Series; 2],
    /// sin α, cos α.
    pub(super) tilt: [Series; 2],
    /// sin β, cos β.
    pub(super) turn: [Series; 2],
}

impl Lean {
    /// A direction of a seam that goes on in the sense of ±1. Where it is ±Z all along, β is `idle`, rad.
    /// `fourth` finds f₄.
    pub(super) fn of(
        [lx, ly, lz]: [Series; 3],
        sense: f64,
        idle: f64,
        fourth: impl FnOnce() -> [f64; 2],
    ) -> Lean {
        if lx == Series::default() && ly == Series::default() {
            let (sin, cos) = libm::sincos(idle);
            return Lean {
                h: Series::default(),
                lz,
                flat: [sin, -cos].map(Series::constant),
                norm: Series::constant(1.0),
                free: true,
            };
        }
        let h = lx.hypot(ly);
        let away = Lean { h, lz, flat: [lx, ly], norm: h, free: false };
        let upright = lz.value().abs();
        if libm::hypot(lx.value(), ly.value()) <= NEARLY_UPRIGHT * upright {
            through([lx, ly], fourth(), ROUNDED * upright, sense).map_or(away, |(h, flat)| Lean {
                h,
                lz,
                flat,
                norm: flat[0].hypot(flat[1]),
                free: false,
            })
        } else {
            away
        }
    }

    fn sign(&self, branch: Branch) -> f64 {
        if self.free { 1.0 } else { branch.sign() }
    }

    /// The solution of a branch, both angles within ±180°.
    pub(super) fn angles(&self, branch: Branch) -> Angles {
        let sign = self.sign(branch);
        let (h, [x, y]) = (self.h * sign, self.flat.map(|c| c * sign));
        let length = h.hypot(self.lz);
        Angles {
            degrees: [h.atan2(self.lz), x.atan2(-y)].map(|angle| angle * 1_f64.to_degrees()),
            tilt: [h / length, self.lz / length],
            turn: [x / self.norm, -y / self.norm],
        }
    }

    /// The branch whose farther angle is nearer to where the axes are, degrees.
    pub(super) fn branch_near(&self, [alpha, beta]: [f64; 2]) -> Branch {
        let [x, y] = self.flat.map(|c| c.value());
        let farther = |branch: Branch| {
            let sign = self.sign(branch);
            let tilt = libm::atan2(sign * self.h.value(), self.lz.value()).to_degrees();
            let turn = libm::atan2(sign * x, -sign * y).to_degrees();
            let way = |angle: f64, here: f64| (nearest_turn(angle, here, 360.0) - here).abs();
            way(tilt, alpha).max(way(turn, beta))
        };
        if farther(Branch::Positive) < farther(Branch::Negative) {
            Branch::Positive
        } else {
            Branch::Negative
        }
    }
}

/// h and g of M98, if f goes through 0 within `rounded`; h is positive at the place, or where f is 0 there,
/// behind it in the sense of the seam.
fn through(f: [Series; 2], fourth: [f64; 2], rounded: f64, sense: f64) -> Option<(Series, [Series; 2])> {
    // Ways are counted along f₁, where the root is a simple one.
    let [x1, y1] = f.map(|c| c.0[1]);
    let along = |n: usize| {
        let [x, y] = f.map(|c| c.0.get(n).copied());
        x.unwrap_or(fourth[0]) * x1 + y.unwrap_or(fourth[1]) * y1
    };
    let p = [0, 1, 2, 3, 4].map(along);
    let mut root = 0.0;
    for _ in 0..STEPS {
        let (value, slope) =
            p.iter().rev().fold((0.0, 0.0), |(value, slope), c| (value * root + c, slope * root + value));
        root -= value / slope;
    }
    let divided = |c: Series, fourth: f64| {
        let [c0, c1, c2, c3] = c.0;
        let g2 = c3 + root * fourth;
        let g1 = c2 + root * g2;
        let g0 = c1 + root * g1;
        (Series([g0, g1, g2, fourth]), c0 + root * g0)
    };
    let [(gx, missed_x), (gy, missed_y)] = [divided(f[0], fourth[0]), divided(f[1], fourth[1])];
    let h = Series([-root, 1.0, 0.0, 0.0]) * gx.hypot(gy);
    // Not by ">": what is no number goes through nothing.
    if !(libm::hypot(missed_x, missed_y) <= rounded && h.is_finite()) {
        return None;
    }
    let is_there = h.value().abs() <= rounded;
    let sign = if is_there { sense } else { h.value().signum() };
    let mut h = h * sign;
    if is_there {
        // Neither −0 nor less: at −Z it would be the other end of α.
        h.0[0] = 0.0;
    }
    Some((h, [gx * sign, gy * sign]))
}

/// f₄ of a function about a place from its series there and from that at `eta` beside.
pub(super) fn fourth(here: Series, beside: Series, eta: f64) -> f64 {
    let [_, _, c2, c3] = here.0;
    let second = beside.derivative(2) - 2.0 * c2 - 6.0 * c3 * eta;
    let third = beside.derivative(3) - 6.0 * c3;
    (3.0 * second - eta * third) / (12.0 * eta * eta)
}
