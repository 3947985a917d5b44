//! A plane contour Y = f(X), and the path of a round tool beside it. In: X of the point of contact, mm. Out:
//! the centre of the tool, with its derivatives.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | X, Y | mm | master and follower, as one looks at them: X to the right, Y upwards |
//! | r | mm | radius of the tool |
//! | σ | – | +1 where the tool stands above the contour, −1 below, 0 on it |
//!
//! ```text
//! centre = (X, f) + σ r (−f′, 1)/(1 + f′²)^½                                                          (M88)
//! ```
//! Left of the contour is above it where X grows along the path, and below where X falls.

use serde::{Deserialize, Serialize};

use crate::{Curve, Formula, Gradient, Number, Point, Series};

/// On which side of the contour the tool stands, as seen along the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// On the contour.
    #[default]
    On,
    /// Left of it.
    Left,
    /// Right of it.
    Right,
}

/// A contour. Its formula is f.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Contour {
    /// X of the contour at the start and at the end, mm.
    pub x: [f64; 2],
    /// Radius of the tool, mm, ≥ 0.
    pub radius_mm: f64,
    /// Its side.
    pub side: Side,
}

/// The centre of the tool beside a contour, as a [`Curve`] of X of the point of contact. Axes: master,
/// follower.
#[derive(Clone, Copy, Debug)]
pub struct ContourCurve<'a> {
    contour: Contour,
    formula: &'a Formula,
}

impl Contour {
    /// The path of the tool; `formula` is f.
    #[must_use]
    pub fn curve<'a>(&self, formula: &'a Formula) -> ContourCurve<'a> {
        ContourCurve { contour: *self, formula }
    }

    /// X at the start and at the end: the parameter.
    #[must_use]
    pub fn t(&self) -> [f64; 2] {
        self.x
    }

    /// σ r, mm: how far above the contour the tool stands.
    #[must_use]
    pub fn above_mm(&self) -> f64 {
        let grows = if self.x[1] > self.x[0] { 1.0 } else { -1.0 };
        match self.side {
            Side::On => 0.0,
            Side::Left => grows * self.radius_mm,
            Side::Right => -grows * self.radius_mm,
        }
    }
}

impl Curve<2> for ContourCurve<'_> {
    fn at(&self, t: f64) -> Point<2> {
        let zero = Series::default();
        let x = Series::variable(t);
        let Gradient { value: y, x: slope, .. } = self.formula.eval(Gradient::variables(x, zero));
        let above = Series::constant(self.contour.above_mm());
        let across = above / (Series::constant(1.0) + slope * slope).sqrt();
        let axes = [x - slope * across, y + across];
        Point { axes, tip: [axes[0], axes[1], zero] }
    }
}
