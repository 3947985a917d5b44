//! What one pass shall cut: geometry in mm and mm/rev, X a radius; free of limits, angles and times.
//!
//! A thread on a cylinder or a cone runs along Z, and X takes the tool to depth and lifts it. A thread on a
//! face (a scroll) is the same with the two axes exchanged: it runs along X, and Z lifts the tool.

use protocol::Axis;

use super::chain::Chain;

/// A point of the plane of the lathe, mm, X a radius.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Radius.
    pub x: f64,
    /// Along the spindle.
    pub z: f64,
}

impl Point {
    /// With the two axes exchanged.
    pub(crate) fn exchanged(self) -> Point {
        Point { x: self.z, z: self.x }
    }
}

/// The axis along which a thread runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Along {
    /// Cylinders and cones.
    #[default]
    Z,
    /// Faces.
    X,
}

impl Along {
    /// The axis that has the lead.
    pub fn axis(self) -> Axis {
        match self {
            Along::Z => Axis::Z,
            Along::X => Axis::X,
        }
    }

    /// The axis that takes the tool to depth, and lifts it.
    pub fn lifts(self) -> Axis {
        match self {
            Along::Z => Axis::X,
            Along::X => Axis::Z,
        }
    }

    /// Coordinate of a point along the thread.
    pub(crate) fn of(self, point: Point) -> f64 {
        match self {
            Along::Z => point.z,
            Along::X => point.x,
        }
    }

    /// Coordinate of a point across it.
    pub(crate) fn across(self, point: Point) -> f64 {
        match self {
            Along::Z => point.x,
            Along::X => point.z,
        }
    }
}

/// A taper at the beginning or the end of a thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taper {
    /// Length along the thread axis, mm, positive.
    pub length_mm: f64,
    /// Radial height, mm, positive.
    pub height_mm: f64,
}

/// One pass of a thread, as the program means it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// S: programmed spindle speed, 1/min, positive.
    pub s_rpm: f64,
    /// Highest speed in the pass at 100 % override as a multiple of S: 1, or more where it is varied.
    pub top_share: f64,
    /// +1 clockwise, -1 counterclockwise.
    pub direction: f64,
    /// Along which axis it runs.
    pub along: Along,
    /// Advance per revolution of each axis, mm, signed; not 0 along the thread. Of a chain the first.
    pub lead: Point,
    /// Where it changes.
    pub chain: Chain,
    /// Where the axes rest before the pass; the helix goes through it at the start angle.
    pub from: Point,
    /// Programmed end of the helix along the thread, mm.
    pub to_mm: f64,
    /// Angle of the spindle at which the helix goes through `from`, degrees from the index.
    pub start_deg: f64,
    /// Signed stroke to depth of the axis that lifts, mm; 0 if it is there already.
    pub approach_mm: f64,
    /// Its signed stroke out of the thread, mm; 0 for none.
    pub retract_mm: f64,
    /// Retract after which the tool is clear of the thread, mm, not negative.
    pub clear_mm: f64,
    /// How far the program takes it out of the thread behind a cut that has no retract, mm, signed; 0 if it
    /// does not say.
    pub lift_mm: f64,
    /// Its direction out of the material, ±1, for a cut of which nobody says that.
    pub outwards: f64,
    /// Depth below the crest, mm; 0 if not known.
    pub depth_mm: f64,
    /// The program says where the crest is; else that depth is a guess.
    pub depth_is_told: bool,
    /// Taper at the beginning.
    pub entry: Option<Taper>,
    /// Taper at the end.
    pub exit: Option<Taper>,
}

impl Cut {
    /// Advance per revolution along the thread, mm, signed.
    pub(crate) fn lead_mm(&self) -> f64 {
        self.along.of(self.lead)
    }

    /// The same across it: 0 of a cylinder and of a face.
    pub(crate) fn rise_mm(&self) -> f64 {
        self.along.across(self.lead)
    }

    /// Where the axes rest before the pass: along the thread.
    pub(crate) fn starts_mm(&self) -> f64 {
        self.along.of(self.from)
    }

    /// The same across it.
    pub(crate) fn above_mm(&self) -> f64 {
        self.along.across(self.from)
    }
}
