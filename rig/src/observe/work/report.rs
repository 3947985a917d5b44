//! What `summary.json` says of traces: how far tool or beam were from where they shall be, and at which feed.
//! Errors in µm, angles in degrees.

use std::collections::BTreeMap;

use protocol::Axis;
use serde::{Deserialize, Serialize};

/// What was followed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum WorkKind {
    /// A contour in a plane.
    #[default]
    Contour,
    /// A surface under a tool.
    Surface,
    /// A seam under a beam.
    Seam,
}

/// How far a tool is from touching its surface or contour, positive where it stands off; or a beam from its
/// seam, positive to the left (M96, M97).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct DeviationReport {
    /// Lowest.
    pub low_um: f64,
    /// Highest.
    pub high_um: f64,
    /// Root of the mean square.
    pub rms_um: f64,
    /// Where its magnitude is largest, from the zero of the formulas: the tip of the tool, or the beam on the
    /// part.
    pub worst_mm: [f64; 3],
    /// When that is, s.
    pub worst_t_s: f64,
    /// Largest angle between the direction of a seam and the beam, degrees; 0 without a seam.
    pub angle_max_deg: f64,
}

impl DeviationReport {
    /// Largest magnitude, µm.
    pub fn max_abs_um(&self) -> f64 {
        self.high_um.max(-self.low_um)
    }
}

/// Feed along the path of the tool, or of the beam on the part. Per cent of what is asked for: the programmed
/// feed times the feed override.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FeedReport {
    /// F.
    pub programmed_mm_min: f64,
    /// Share of the time in which the commanded feed is held: within 1 % of what is asked for.
    pub held_pct: f64,
    /// Highest commanded feed beyond what is asked for.
    pub most_pct: f64,
    /// Share of that time in which the true feed is also within 1 %.
    pub true_held_pct: f64,
    /// Lowest true feed where the commanded one is held, less what is asked for.
    pub true_low_pct: f64,
    /// Highest.
    pub true_high_pct: f64,
    /// Root of the mean square.
    pub true_rms_pct: f64,
    /// Time at a lower feed although no limit was used to a quarter just then: in windows of 50 ms, see
    /// `docs/run-folder.md`.
    pub unexplained_s: f64,
    /// Largest chord error of an interpolator cycle.
    pub chord_max_um: f64,
}

/// Largest commanded speed, acceleration, jerk and jerk rate of an axis, per cent of its limits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
#[allow(missing_docs)] // the derivative, as the name says
pub struct AxisUsed {
    pub velocity_pct: f64,
    pub acceleration_pct: f64,
    pub jerk_pct: f64,
    pub jerk_rate_pct: f64,
}

/// A contour, a surface or a seam that was cut.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct TraceReport {
    /// Running number in the program, from 1.
    pub trace: u32,
    /// Line of the part program.
    pub line: u32,
    /// What it was.
    pub kind: WorkKind,
    /// Machine position of the zero of the formulas; 0 of a seam.
    pub origin_mm: [f64; 3],
    /// When cutting began, s.
    pub t_s: f64,
    /// First control cycle of it.
    pub begin_cycle: u64,
    /// Last control cycle of it.
    pub end_cycle: u64,
    /// Control cycles in which it was cut: approaches and retracts are not counted.
    pub cut_cycles: u64,
    /// Of these, cycles in which no nearest point was found.
    pub unmeasured_cycles: u64,
    /// Way that was cut.
    pub way_mm: f64,
    /// Lowest and highest coordinates of the commanded way, from the zero of the formulas.
    pub reach_mm: [[f64; 2]; 3],
    /// How far off it may be commanded: the chord error that the work asks for. None if it asks for a
    /// correction, whose error is what is looked at.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub most_um: Option<f64>,
    /// Deviation of the commanded positions.
    pub commanded: DeviationReport,
    /// Deviation of the true positions of the slides.
    pub slide: DeviationReport,
    /// Feed.
    pub feed: FeedReport,
    /// How much of the limits was used.
    pub limits_used: BTreeMap<Axis, AxisUsed>,
}

impl TraceReport {
    /// Measuring and rounding, µm.
    const MEASURED_UM: f64 = 1e-4;

    /// Whether it was commanded farther off than it may be: the part is not what the formula says, however
    /// true the axes.
    pub fn is_wrong(&self) -> bool {
        self.most_um.is_some_and(|most| self.commanded.max_abs_um() > most + TraceReport::MEASURED_UM)
    }
}
