//! The programmed point, and the offsets between it and the machine.
//!
//! ```text
//! point of the machine = R(point + G92) + G5x + tool        R: rotation about Z
//! ```
//! Whatever changes one of the offsets keeps the point of the machine.

use super::scale::scaled;
use crate::canon::{Pose, X, Y};

/// The programmed point and its offsets, program units and degrees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axes {
    /// The programmed point.
    pub(crate) position: Pose,
    system: u8,
    g5x: Pose,
    g92: Pose,
    rotation: f64,
    tool_offset: Pose,
    /// By how much offsets of tools have shifted the programmed point since the last move.
    unseen: Pose,
}

impl Axes {
    pub(super) fn new(position: Pose) -> Axes {
        let nothing = [0.0; 6];
        Axes {
            position,
            system: 1,
            g5x: nothing,
            g92: nothing,
            rotation: 0.0,
            tool_offset: nothing,
            unseen: nothing,
        }
    }

    /// The offsets in which a program begins; the programmed point stays.
    pub(super) fn begin(&mut self, system: u8, g5x: Pose, rotation: f64, g92: Pose) {
        (self.system, self.g5x, self.rotation, self.g92) = (system, g5x, rotation, g92);
    }

    /// Coordinate system in force, 1 (G54) to 9 (G59.3).
    pub(crate) fn system(&self) -> u8 {
        self.system
    }

    /// Its offset.
    pub(crate) fn g5x(&self) -> Pose {
        self.g5x
    }

    /// G52 and G92: the offset in force (zero while G92.2 suspends it).
    pub(crate) fn g92(&self) -> Pose {
        self.g92
    }

    /// Rotation of the coordinate system about Z, degrees.
    pub(crate) fn rotation(&self) -> f64 {
        self.rotation
    }

    /// G43: offset of the tool.
    pub(crate) fn tool_offset(&self) -> Pose {
        self.tool_offset
    }

    /// A point of the coordinate system in force as a point of the machine.
    pub(crate) fn absolute(&self, point: &Pose) -> Pose {
        let mut absolute: Pose = std::array::from_fn(|axis| point[axis] + self.g92[axis]);
        turn(&mut absolute, self.rotation);
        std::array::from_fn(|axis| absolute[axis] + self.g5x[axis] + self.tool_offset[axis])
    }

    /// A point of the machine as a point of the coordinate system in force.
    pub(crate) fn relative(&self, point: &Pose) -> Pose {
        let mut relative: Pose =
            std::array::from_fn(|axis| point[axis] - self.tool_offset[axis] - self.g5x[axis]);
        turn(&mut relative, -self.rotation);
        std::array::from_fn(|axis| relative[axis] - self.g92[axis])
    }

    /// The programmed point as a point of the machine.
    pub(crate) fn machine_point(&self) -> Pose {
        self.absolute(&self.position)
    }

    /// Puts a coordinate system in force, with its offset and its rotation.
    pub(crate) fn enter(&mut self, system: u8, g5x: Pose, rotation: f64) {
        let place = self.machine_point();
        (self.system, self.g5x, self.rotation) = (system, g5x, rotation);
        self.position = self.relative(&place);
    }

    /// G52: the shift along an axis is `shift`.
    pub(crate) fn shift_by(&mut self, axis: usize, shift: f64) {
        let sum = self.position[axis] + self.g92[axis];
        (self.g92[axis], self.position[axis]) = (shift, sum - shift);
    }

    /// G92: the programmed point reads `value` along an axis.
    pub(crate) fn read_as(&mut self, axis: usize, value: f64) {
        let sum = self.position[axis] + self.g92[axis];
        self.shift_by(axis, sum - value);
    }

    /// G92.1 to G92.3: another shift of all axes.
    pub(crate) fn set_shift(&mut self, shift: Pose) {
        for (axis, shift) in shift.iter().enumerate() {
            self.position[axis] += self.g92[axis] - shift;
        }
        self.g92 = shift;
    }

    /// G43, G49.
    pub(crate) fn set_tool_offset(&mut self, offset: Pose) {
        let (point, place) = (self.position, self.machine_point());
        self.tool_offset = offset;
        self.position = self.relative(&place);
        for (axis, unseen) in self.unseen.iter_mut().enumerate() {
            *unseen += self.position[axis] - point[axis];
        }
    }

    /// A move was made: offsets of tools have been taken up.
    pub(crate) fn moved(&mut self) {
        self.unseen = [0.0; 6];
    }

    /// The programmed point goes back to the end of the last move.
    pub(crate) fn back_to_last_move(&mut self) {
        for (value, unseen) in self.position.iter_mut().zip(self.unseen) {
            *value -= unseen;
        }
        self.unseen = [0.0; 6];
    }

    /// G20, G21: lengths times a factor, the offset of the tool only `with_tool`.
    pub(crate) fn scale(&mut self, factor: f64, with_tool: bool) {
        for lengths in [&mut self.position, &mut self.g5x, &mut self.g92, &mut self.unseen] {
            *lengths = scaled(lengths, factor);
        }
        if with_tool {
            self.tool_offset = scaled(&self.tool_offset, factor);
        }
    }
}

/// Turns a point about Z by degrees.
pub(crate) fn turn(point: &mut Pose, degrees: f64) {
    if degrees == 0.0 {
        return;
    }
    let (sin, cos) = libm::sincos(degrees.to_radians());
    let [x, y, ..] = *point;
    point[X] = x * cos - y * sin;
    point[Y] = x * sin + y * cos;
}
