//! Where a programmed point lies on the machine. In: units, offsets and rotation, as they are called. Out: mm
//! and degrees, machine coordinates, X of a lathe a radius.
//!
//! ```text
//! machine = R(u p + (G52, G92)) + (coordinate system) + (tool)       u: mm in one unit of the program
//! ```
//! R turns X and Y by the angle of the coordinate system.

use gcode::canon::{A, B, C, Pose, Units, X, Y, Z};
use gcode::problem::short;
use machine::{Kinematics, Machine};
use protocol::Axis;

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

    /// What a program may write for the axis that a message about travel begins with, where that is not
    /// what the machine file has.
    pub(crate) fn travel(&self, message: &str, machine: &Machine) -> Option<String> {
        let (axis, config) = machine.axes().find(|(axis, _)| message.starts_with(&axis.to_string()))?;
        let at = [X, Y, Z, A, B, C].get(Axis::ALL.iter().position(|other| *other == axis)?).copied()?;
        let turned = self.rotation_deg != 0.0 && at < Z;
        let kinematics = machine.general.kinematics;
        if turned || kinematics == Kinematics::Positioner {
            return None;
        }
        let twice = if at == X && self.x_is_diameter { 2.0 } else { 1.0 };
        let ends = config.travel_mm.map(|mm| {
            let mut point = [0.0; 6];
            point[at] = mm;
            twice * self.programmed(&point)[at]
        });
        if ends == config.travel_mm {
            return None;
        }
        let unit = if Axis::METRIC[axis.index()] { self.units.name() } else { "degrees" };
        let how = if twice == 2.0 { ", as a diameter" } else { "" };
        let [low, high] = ends.map(short);
        Some(format!("here the program may write {axis} from {low} to {high} ({unit}{how})"))
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

    /// Where a Z of the program lies on the machine, mm.
    pub(crate) fn z_on_machine(&self, z: f64) -> f64 {
        let mut at = Pose::default();
        at[Z] = z;
        self.machine(&at)[Z]
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
