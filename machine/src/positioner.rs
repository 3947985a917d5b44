//! `[positioner]` of the machine file: where the axes of a four-axis positioner lie, and where its beam
//! stands. In: mm; α is the axis A, β the axis C, degrees. Out: checked values.

use serde::{Deserialize, Serialize};

use super::axis::pair;
use protocol::Axis;

use super::{Kinematics, Machine, MachineError, range, refuse};

/// `[positioner]`
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PositionerConfig {
    /// Offset of the tilt axis along itself, mm.
    pub x1_mm: f64,
    /// Offset of the tilt axis across it, mm.
    pub y1_mm: f64,
    /// Height of the tilt axis, mm.
    pub z1_mm: f64,
    /// Offset of the turn axis along the tilt axis, mm.
    pub x2_mm: f64,
    /// Offset of the turn axis across the tilt axis, mm.
    pub y2_mm: f64,
    /// Offset of the face of the turntable along the turn axis, mm.
    pub z2_mm: f64,
    /// Where the beam stands in the frame of the machine: X, Y, mm.
    #[serde(deserialize_with = "pair")]
    pub beam_mm: [f64; 2],
}

impl PositionerConfig {
    fn check(&self) -> Result<(), MachineError> {
        let [beam_x, beam_y] = self.beam_mm;
        for (name, mm) in [
            ("x1_mm", self.x1_mm),
            ("y1_mm", self.y1_mm),
            ("z1_mm", self.z1_mm),
            ("x2_mm", self.x2_mm),
            ("y2_mm", self.y2_mm),
            ("z2_mm", self.z2_mm),
            ("beam_mm[0]", beam_x),
            ("beam_mm[1]", beam_y),
        ] {
            range(&format!("positioner.{name}"), mm, -1e4, 1e4)?;
        }
        Ok(())
    }
}

impl Machine {
    /// Refuses a positioner without its table, and the table on another machine.
    pub(super) fn check_positioner(&self) -> Result<(), MachineError> {
        match (self.general.kinematics, &self.positioner) {
            (Kinematics::Positioner, Some(positioner)) => positioner.check(),
            (Kinematics::Positioner, None) => {
                let reason = "needs [positioner] with x1_mm, y1_mm, z1_mm, x2_mm, y2_mm, z2_mm and beam_mm";
                Err(refuse("machine.kinematics", "positioner", reason))
            }
            (_, None) => Ok(()),
            (_, Some(_)) => {
                Err(refuse("positioner", "a table", "is for machine.kinematics = \"positioner\" only"))
            }
        }
    }
}

/// Axes of a positioner, in the order x, y, α, β.
pub const POSITIONER_AXES: [Axis; 4] = [Axis::X, Axis::Y, Axis::A, Axis::C];
