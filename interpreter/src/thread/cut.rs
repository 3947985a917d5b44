//! What one pass shall cut: geometry in mm and mm/rev, X a radius; free of limits, angles and times.

/// A point of the plane of the lathe, mm, X a radius.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Radius.
    pub x: f64,
    /// Along the spindle.
    pub z: f64,
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
    /// +1 clockwise, -1 counterclockwise.
    pub direction: f64,
    /// Advance per revolution of each axis, mm, signed; `z` is not 0.
    pub lead: Point,
    /// Where the axes rest before the pass; the helix goes through it at the start angle.
    pub from: Point,
    /// Programmed end of the helix in Z, mm.
    pub to_z: f64,
    /// Angle of the spindle at which the helix goes through `from`, degrees from the index.
    pub start_deg: f64,
    /// Signed stroke of X to depth, mm; 0 if X is there already.
    pub approach_mm: f64,
    /// Signed stroke of X out of the thread, mm; 0 for none.
    pub retract_mm: f64,
    /// Retract after which the tool is clear of the thread, mm, not negative.
    pub clear_mm: f64,
    /// How far the program takes X out of the thread behind a cut that has no retract, mm, signed; 0 if it
    /// does not say.
    pub lift_mm: f64,
    /// Direction of X out of the material, ±1, for a cut of which nobody says that.
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
