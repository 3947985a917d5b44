//! A seam: where the beam is on the part, and the direction that is turned towards it.

use serde::{Deserialize, Serialize};

/// Position and direction in the frame of the work-holder, as functions of t. The direction need not be of length 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum SeamCurve {
    /// Formulas 0 … 2 are x, y, z in mm, 3 … 5 the direction.
    Formulas,
    /// Polynomials of t for the same six, constant first.
    Polynomials([[f64; 8]; 6]),
}

/// A seam.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Seam {
    /// Where it runs.
    pub curve: SeamCurve,
    /// t at the start and at the end.
    pub t: [f64; 2],
    /// Of both solutions of M49 the first (α ≤ 0), else the second.
    pub first_branch: bool,
}
