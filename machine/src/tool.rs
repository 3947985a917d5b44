//! Tools. In: `[tools]` of the machine file. Out: what each of them is, mm and degrees.

use serde::{Deserialize, Serialize};

use crate::{MachineError, range};

/// Who puts the next tool in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ToolChange {
    /// A turret or a changer: the program does not wait for it.
    #[default]
    Automatic,
    /// Somebody at the machine: the program waits, at rest, until a cycle start says that it is in.
    ByHand,
}

impl ToolChange {
    /// Whether nobody is asked.
    pub fn is_automatic(&self) -> bool {
        *self == ToolChange::Automatic
    }
}

/// A tool.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tool {
    /// What it is, for people.
    pub name: String,
    /// Angle between its flanks, degrees: 60 of a metric thread.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angle_deg: Option<f64>,
    /// Radius of its nose, mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nose_mm: Option<f64>,
    /// Width of its edge along Z, mm; the diameter of a drill.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub width_mm: Option<f64>,
}

impl Tool {
    /// How far its edge reaches to either side of the point along Z, mm: half its width, or its nose.
    pub fn edge_mm(&self) -> f64 {
        (0.5 * self.width_mm.unwrap_or(0.0)).max(self.nose_mm.unwrap_or(0.0))
    }

    pub(crate) fn check(&self, key: &str) -> Result<(), MachineError> {
        for (name, value, low, high) in [
            ("angle_deg", self.angle_deg, 2.0, 120.0),
            ("nose_mm", self.nose_mm, 0.0, 50.0),
            ("width_mm", self.width_mm, 0.01, 200.0),
        ] {
            value.map_or(Ok(()), |value| range(&format!("{key}.{name}"), value, low, high))?;
        }
        Ok(())
    }
}
