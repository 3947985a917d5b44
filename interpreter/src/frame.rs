//! Where a programmed point lies on the machine. In: units, offsets and rotation, as they are called. Out: mm
//! and degrees, machine coordinates, X of a lathe a radius.
//!
//! ```text
//! machine = R(u p + (G52, G92)) + (coordinate system) + (tool)       u: mm in one unit of the program
//! ```
//! R turns X and Y by the angle of the coordinate system.

use gcode::canon::{Pose, Units, X, Y};
use gcode::problem::short;

use crate::thread::Point;

/// Units and offsets in force; offsets in mm and degrees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) units: Units,
    /// Whether the program writes X as a diameter.
    pub(crate) x_is_diameter: bool,
    /// Offset of the coordinate system.
    pub(crate) system: Pose,
    /// Its rotation about Z, degrees.
    pub(crate) rotation_deg: f64,
    /// G52 and G92.
    pub(crate) shift: Pose,
    /// Offset of the tool.
    pub(crate) tool: Pose,
}

impl Frame {
    pub(crate) fn new() -> Frame {
        let zero = [0.0; 6];
        Frame {
            units: Units::Millimetre,
            x_is_diameter: false,
            system: zero,
            rotation_deg: 0.0,
            shift: zero,
            tool: zero,
        }
    }

    /// mm in one unit.
    pub(crate) fn unit(&self) -> f64 {
        self.units.mm()
    }

    /// X and Z of the part, mm and a radius, as the program writes them.
    pub(crate) fn place(&self, at: Point) -> String {
        let (twice, what) = if self.x_is_diameter { (2.0, "diameter") } else { (1.0, "radius") };
        let [x, z] = [twice * at.x, at.z].map(|mm| short(mm / self.unit()));
        format!("X{x} Z{z} of the part (X as a {what}, {})", self.units.name())
    }

    /// A vector of the program in mm and degrees.
    pub(crate) fn scaled(&self, vector: &Pose) -> Pose {
        let [x, y, z, a, b, c] = *vector;
        [x * self.unit(), y * self.unit(), z * self.unit(), a, b, c]
    }

    /// A programmed position on the machine.
    pub(crate) fn machine(&self, position: &Pose) -> Pose {
        let mut at = sum(self.scaled(position), &self.shift);
        if self.rotation_deg != 0.0 {
            let (sin, cos) = libm::sincos(self.rotation_deg.to_radians());
            (at[X], at[Y]) = (at[X] * cos - at[Y] * sin, at[X] * sin + at[Y] * cos);
        }
        sum(sum(at, &self.system), &self.tool)
    }

    /// A position of the machine as it is programmed: the inverse of [`Frame::machine`].
    pub(crate) fn programmed(&self, at: &Pose) -> Pose {
        let mut from: Pose = std::array::from_fn(|axis| at[axis] - self.system[axis] - self.tool[axis]);
        if self.rotation_deg != 0.0 {
            let (sin, cos) = libm::sincos(self.rotation_deg.to_radians());
            (from[X], from[Y]) = (from[X] * cos + from[Y] * sin, from[Y] * cos - from[X] * sin);
        }
        let [x, y, z, a, b, c] = std::array::from_fn(|axis| from[axis] - self.shift[axis]);
        [x / self.unit(), y / self.unit(), z / self.unit(), a, b, c]
    }
}

fn sum(one: Pose, other: &Pose) -> Pose {
    std::array::from_fn(|axis| one[axis] + other[axis])
}
