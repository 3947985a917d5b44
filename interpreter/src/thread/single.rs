//! The cut of a G33 block, or of a chain of them. In: the path and K, mm; what the next block does with the
//! axis that lifts the tool. Out: a [`Cut`].
//!
//! K is the advance per revolution along the path: on a taper of half angle φ the lead of Z is K cos φ, that
//! of X K sin φ. Along an arc it is that along Z, or along X.

use gcode::canon::Units;

use super::chain::{Broken, Chain, Leg, NO_WAY};
use super::cut::{Along, Cut, Point};

/// A tool that has gone this many leads away from the path is out of any thread profile: those are less than
/// one lead deep.
const CLEAR_LEADS: f64 = 1.3;

/// A G33 block and those that go on from it: mm, radius; checked.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Single {
    pub(crate) s_rpm: f64,
    pub(crate) direction: f64,
    /// Of the program.
    pub(crate) units: Units,
    pub(crate) from: Point,
    /// At least one.
    pub(crate) legs: Vec<Leg>,
    /// Angle of the spindle at which the path begins, degrees from the index.
    pub(crate) start_deg: f64,
    /// Directions of X and Z out of the material, as their last infeeds tell, ±1.
    pub(crate) outwards: Point,
    /// What comes next.
    pub(crate) next: Next,
}

/// What the call behind a G33 does with the axis that lifts the tool: X, of a face thread Z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Next {
    /// A rapid takes it alone there, mm: the retract.
    Retract(f64),
    /// Another move takes it there, mm: that is where the tool is out of the groove.
    Lift(f64),
    /// Nothing.
    Stays,
}

impl Single {
    /// The axis along which it runs: that of its first leg.
    pub(crate) fn along(&self) -> Along {
        self.legs.first().map_or(Along::Z, |leg| leg.along)
    }

    /// Where it ends.
    pub(crate) fn to(&self) -> Point {
        self.legs.last().map_or(self.from, |leg| leg.to)
    }

    /// Why a leg cannot go on from the last one, if it cannot.
    pub(crate) fn contradicts(&self, leg: &Leg) -> Option<Broken> {
        let along = self.along();
        let first = self.legs.first().map_or(self.from, |leg| leg.to);
        let way = |from: Point, to: Point| along.of(to) - along.of(from);
        let (one, other) = (way(self.from, first), way(self.to(), leg.to));
        if one * other <= 0.0 || other.abs() < NO_WAY || along != leg.along {
            return Some(Broken::Turns(along));
        }
        let legs: Vec<Leg> = self.legs.iter().chain([leg]).copied().collect();
        Chain::of(&legs).err()
    }

    /// The cut of the block, or of the chain.
    pub(crate) fn cut(&self) -> Cut {
        let lead = self.legs[0].lead;
        let along = self.along();
        let end = along.across(self.to());
        // What is no chain was refused when it was read.
        let chain = Chain::of(&self.legs).unwrap_or_default();
        let [retract_mm, lift_mm] = match self.next {
            Next::Retract(mm) => [mm - end, 0.0],
            Next::Lift(mm) => [0.0, mm - end],
            Next::Stays => [0.0; 2],
        };
        Cut {
            s_rpm: self.s_rpm,
            top_share: 1.0,
            direction: self.direction,
            along,
            lead,
            chain,
            from: self.from,
            to_mm: along.of(self.to()),
            start_deg: self.start_deg,
            approach_mm: 0.0,
            retract_mm,
            lift_mm,
            outwards: along.across(self.outwards),
            clear_mm: retract_mm.abs().min(CLEAR_LEADS * along.of(lead).abs()),
            depth_mm: 0.0,
            depth_is_told: false,
            entry: None,
            exit: None,
        }
    }
}
