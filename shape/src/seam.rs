//! A seam: where the beam is on the part, and the direction that is turned towards it.

use serde::{Deserialize, Serialize};

use crate::Branch;

/// Position and direction in the frame of the work-holder, as functions of t. The direction need not be of length 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[allow(clippy::large_enum_variant)] // fixed size is the point: the queue of machine code holds it by value
pub enum SeamCurve {
    /// Formulas 0 … 2 are x, y, z in mm, 3 … 5 the direction.
    Formulas,
    /// Polynomials of t for the same six, constant first.
    Polynomials([[f64; 8]; 6]),
    /// Where two surfaces meet; t is the angle about the axis of the first, rad.
    Meeting(Meeting),
}

/// Where a cylinder or cone, generator by generator, meets a second surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Meeting {
    /// The cylinder or cone.
    pub first: Ruled,
    /// The other.
    pub second: Quadric,
    /// Of the two points where a generator pierces the second surface that farther along the axis of the first.
    pub far: bool,
    /// Direction between both outward normals: 0 that of the first, 1 that of the second, 1/2 the bisector.
    pub share: f64,
}

/// A cylinder or cone about an axis: at the way h along the axis its radius is `radius_mm + slope·h`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ruled {
    /// A point of the axis, h = 0, mm.
    pub at: [f64; 3],
    /// Unit vector along the axis.
    pub axis: [f64; 3],
    /// Unit vector across it, where t = 0; t grows counterclockwise as seen against the axis.
    pub zero: [f64; 3],
    /// Radius at h = 0, mm.
    pub radius_mm: f64,
    /// Growth of the radius with h; 0 for a cylinder.
    pub slope: f64,
}

/// A surface of the second order about an axis: with the way h along it and the distance ρ from it, the points where
/// `c0 + c1 h + c2 h² + c3 ρ² = 0`. What is positive is outside.
///
/// | | c0 | c1 | c2 | c3 |
/// |---|---|---|---|---|
/// | plane, outside where the axis points | 0 | 1 | 0 | 0 |
/// | sphere | −R² | 0 | 1 | 1 |
/// | cylinder | −R² | 0 | 0 | 1 |
/// | cone of radius R + k h | −R² | −2 R k | −k² | 1 |
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quadric {
    /// A point of the axis, h = 0, mm.
    pub at: [f64; 3],
    /// Unit vector along the axis.
    pub axis: [f64; 3],
    /// The four coefficients.
    pub c: [f64; 4],
}

/// A seam.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Seam {
    /// Where it runs.
    pub curve: SeamCurve,
    /// t at the start and at the end.
    pub t: [f64; 2],
    /// Which of both solutions of M49.
    pub branch: Branch,
}
