//! A plane contour Y = f(X), and the path of a round tool beside it.

use serde::{Deserialize, Serialize};

/// On which side of the contour the tool stands, as seen along the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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
    /// X at the start and at the end, mm.
    pub x: [f64; 2],
    /// Radius of the tool, mm, ≥ 0.
    pub radius_mm: f64,
    /// Its side.
    pub side: Side,
}
