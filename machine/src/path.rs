//! `[path]` of the machine file: how exactly timed motion keeps to the programmed path.
//! Out: checked values, or the path of the key and the reason.

use serde::{Deserialize, Serialize};

use super::{MachineError, range};

/// `[path]`
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PathConfig {
    /// How far a rounded corner may leave the programmed path in G64 without P, which is the mode at the
    /// start, mm.
    pub tolerance_mm: f64,
    /// How exactly G61 follows the path, mm: within this the jumps of curvature at tangent junctions are
    /// smoothed.
    pub exact_mm: f64,
    /// Chord error of the setpoints that are streamed, mm.
    pub chord_mm: f64,
}

impl Default for PathConfig {
    fn default() -> Self {
        PathConfig { tolerance_mm: 0.01, exact_mm: 0.000_5, chord_mm: 0.001 }
    }
}

impl PathConfig {
    pub(super) fn check(&self) -> Result<(), MachineError> {
        range("path.tolerance_mm", self.tolerance_mm, 1e-6, 10.0)?;
        range("path.exact_mm", self.exact_mm, 1e-6, self.tolerance_mm)?;
        range("path.chord_mm", self.chord_mm, 1e-6, 1.0)
    }
}
