//! The cut of a G33 block. In: the path and K, mm; what the next block does with X. Out: a [`Cut`].
//!
//! K is the advance per revolution along the path: on a taper of half angle φ the lead of Z is K cos φ, that
//! of X K sin φ.

use gcode::canon::Units;

use super::cut::{Cut, Point};

/// A tool that has gone this many leads away from the path is out of any thread profile: those are less than
/// one lead deep.
const CLEAR_LEADS: f64 = 1.3;

/// A G33 block: mm, radius; checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Single {
    pub(crate) s_rpm: f64,
    pub(crate) direction: f64,
    /// Of the program.
    pub(crate) units: Units,
    pub(crate) from: Point,
    pub(crate) to: Point,
    pub(crate) k_mm: f64,
    /// Angle of the spindle at which the path begins, degrees from the index.
    pub(crate) start_deg: f64,
    /// Direction of X out of the material, as the last infeed tells, ±1.
    pub(crate) outwards: f64,
    /// What comes next.
    pub(crate) next: Next,
}

/// What the call behind a G33 does with X.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Next {
    /// A rapid takes X alone there, mm: the retract.
    Retract(f64),
    /// Another move takes X there, mm: that is where the tool is out of the groove.
    Lift(f64),
    /// Nothing.
    Stays,
}

impl Single {
    /// The cut of the block.
    pub(crate) fn cut(&self) -> Cut {
        let (dx, dz) = (self.to.x - self.from.x, self.to.z - self.from.z);
        let per_mm = self.k_mm / libm::hypot(dx, dz);
        let lead = Point { x: dx * per_mm, z: dz * per_mm };
        let [retract_mm, lift_mm] = match self.next {
            Next::Retract(x) => [x - self.to.x, 0.0],
            Next::Lift(x) => [0.0, x - self.to.x],
            Next::Stays => [0.0; 2],
        };
        Cut {
            s_rpm: self.s_rpm,
            direction: self.direction,
            lead,
            from: self.from,
            to_z: self.to.z,
            start_deg: self.start_deg,
            approach_mm: 0.0,
            retract_mm,
            lift_mm,
            outwards: self.outwards,
            clear_mm: retract_mm.abs().min(CLEAR_LEADS * lead.z.abs()),
            depth_mm: 0.0,
            depth_is_told: false,
            entry: None,
            exit: None,
        }
    }
}
