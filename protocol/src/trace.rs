//! Work that machine code carries as a formula and a pass instead of points: a contour, a surface, a seam.
//!
//! The formulas come before it ([`Code::Formula`](crate::Code::Formula)); the interpolator makes the motion of it.

use serde::{Deserialize, Serialize};
use shape::{Contour, Correction, Seam, Surface};

use crate::{Axis, Position};

/// Formulas that work may refer to, by their number.
pub const FORMULAS: usize = 6;

/// What is followed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Work {
    /// A contour in the plane of two axes: master, follower.
    Contour(Contour, [Axis; 2]),
    /// A surface under a tool, on X, Y, Z.
    Surface(Surface),
    /// A seam, on the axes of a positioner.
    Seam(Seam),
}

/// Work to be done from where it begins; the axes rest there when it is reached.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trace {
    /// What.
    pub work: Work,
    /// Machine position of the zero of the formulas on X, Y, Z (of a contour: on master and follower). Not of a seam, whose
    /// frame is that of the work-holder.
    pub origin: [Position; 3],
    /// Feed along the path of the tool, or of the beam on the part, mm/min.
    pub feed_mm_min: f64,
    /// Largest chord error of an interpolator cycle, mm.
    pub chord_mm: f64,
    /// How followers are led.
    pub correction: Correction,
}
