//! Where the axes stand, units, planes.

use crate::problem::short;

/// X, Y, Z in units of length; A, B, C in degrees.
pub type Pose = [f64; 6];

/// Indexes into a [`Pose`].
pub const X: usize = 0;
/// Y.
pub const Y: usize = 1;
/// Z.
pub const Z: usize = 2;
/// A.
pub const A: usize = 3;
/// B.
pub const B: usize = 4;
/// C.
pub const C: usize = 5;

/// Units of length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Units {
    /// G20.
    Inch,
    /// G21.
    Millimetre,
}

impl Units {
    /// mm in one unit.
    pub fn mm(self) -> f64 {
        match self {
            Units::Inch => 25.4,
            Units::Millimetre => 1.0,
        }
    }

    /// What one is called.
    pub fn name(self) -> &'static str {
        match self {
            Units::Inch => "inch",
            Units::Millimetre => "mm",
        }
    }

    /// A length of so many mm with its unit, as a program in these units has it.
    pub fn length(self, mm: f64) -> String {
        format!("{} {}", short(mm / self.mm()), self.name())
    }
}

/// Plane of arcs and cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// G17.
    Xy,
    /// G18: first axis Z, second axis X.
    Xz,
    /// G19.
    Yz,
}

impl Plane {
    /// Indexes of first axis, second axis and the axis across the plane.
    pub fn axes(self) -> (usize, usize, usize) {
        match self {
            Plane::Xy => (X, Y, Z),
            Plane::Xz => (Z, X, Y),
            Plane::Yz => (Y, Z, X),
        }
    }
}
