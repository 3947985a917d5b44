//! Where a programmed point lies on the machine. In: units and offsets, as they are called. Out: mm, machine
//! coordinates, X a radius.
//!
//! ```text
//! machine = u p + (coordinate system) + (G52, G92) + (tool)       u: mm in one unit of the program
//! ```

use gcode::canon::{Position, Units, X, Y, Z};

use crate::thread::Point;

/// Units and offsets in force; offsets in mm and degrees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    /// mm in one unit.
    pub(crate) unit: f64,
    /// Offset of the coordinate system.
    pub(crate) system: Position,
    /// G52 and G92.
    pub(crate) shift: Position,
    /// Offset of the tool.
    pub(crate) tool: Position,
}

impl Frame {
    pub(crate) fn new() -> Frame {
        Frame { unit: Units::Millimetre.mm(), system: [0.0; 6], shift: [0.0; 6], tool: [0.0; 6] }
    }

    /// A vector of the program in mm and degrees.
    pub(crate) fn scaled(&self, vector: &Position) -> Position {
        let [x, y, z, a, b, c] = *vector;
        [x * self.unit, y * self.unit, z * self.unit, a, b, c]
    }

    /// A programmed position on the machine.
    pub(crate) fn machine(&self, position: &Position) -> Position {
        let mut at = self.scaled(position);
        for offset in [&self.system, &self.shift, &self.tool] {
            at.iter_mut().zip(offset).for_each(|(at, offset)| *at += offset);
        }
        at
    }

    /// The point of the lathe's plane that a programmed X and Z mean.
    pub(crate) fn point(&self, x: f64, z: f64) -> Point {
        let at = self.machine(&[x, 0.0, z, 0.0, 0.0, 0.0]);
        Point { x: at[X], z: at[Z] }
    }

    /// The first axis that a lathe of X and Z does not have and that lies off its zero: name and position.
    pub(crate) fn foreign(position: &Position) -> Option<(char, f64)> {
        ['Y', 'A', 'B', 'C']
            .into_iter()
            .zip([position[Y], position[3], position[4], position[5]])
            .find(|(_, at)| at.abs() > 1e-9)
    }
}
