//! The words in which routes, legs and courses speak: what a block carries, where on a work something is, why
//! it cannot be followed, and the formulas that it refers to.

use protocol::{Axis, FORMULAS, Feed, PerAxis, Position};
use shape::{Clock, Formula, PieceError, Plan};

/// Where a block lies on the machine, and whence in the program.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Move {
    /// Line of the part program.
    pub line: u32,
    /// Absolute start of every axis.
    pub from: PerAxis<Position>,
    /// Absolute end.
    pub to: PerAxis<Position>,
    /// How fast.
    pub feed: Feed,
    /// What it is of a work; nothing for moves of the program.
    pub work: Option<Stretch>,
}

/// A part of a work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Number of the work: that of its `Course`.
    pub number: u32,
    /// Share of the work that is done where it begins, 0 to 1.
    pub share: f64,
    /// What the tool cuts there, or the beam; nothing on the way from one path to the next.
    pub cut: Option<Cut>,
}

/// A piece of a leg of a work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// The leg, seen from above.
    pub plan: Plan,
    /// Its parameter along the piece.
    pub clock: Clock,
}

impl Move {
    /// Whether two moves can be one chain: overrides act on both alike.
    pub fn joins(&self, other: &Move) -> bool {
        std::mem::discriminant(&self.feed) == std::mem::discriminant(&other.feed)
    }
}

/// Where on a work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spot {
    /// X of the contour, mm.
    Contour(f64),
    /// X and Y of the point of contact, mm.
    Surface([f64; 2]),
    /// Parameter of a curve over a surface, or of a seam.
    Parameter(f64),
}

impl std::fmt::Display for Spot {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Spot::Contour(x) => write!(out, "x = {x:.4}"),
            Spot::Surface([x, y]) => write!(out, "x = {x:.4}, y = {y:.4}"),
            Spot::Parameter(t) => write!(out, "t = {t:.6}"),
        }
    }
}

/// Why a work cannot be followed, and where.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unworkable {
    /// A formula that it refers to was not given.
    #[error("formula {0} is missing: it has to come before the work")]
    NoFormula(usize),
    /// The machine lacks an axis.
    #[error("the machine has no axis {0}: choose a machine that has it, or a plane without it")]
    NoAxis(Axis),
    /// The machine is no positioner.
    #[error("the machine is not a positioner: choose a machine file with kinematics = \"positioner\"")]
    NoPositioner,
    /// The axes stand elsewhere.
    #[error("{axis} stands {mm:.6} from the start of the path: move the axes there first")]
    NotAtStart {
        /// The farthest axis.
        axis: Axis,
        /// How far, mm or degrees.
        mm: f64,
    },
    /// The path is not defined there, or not smooth.
    #[error("{spot}: {error}")]
    NoPath {
        /// What is wrong with it.
        error: PieceError,
        /// Where.
        spot: Spot,
    },
    /// A piece that begins there leaves the travel of an axis.
    #[error(
        "the path leaves the travel of {axis} near {spot}: move the zero of the workpiece, or end the path earlier"
    )]
    BeyondTravel {
        /// Which axis.
        axis: Axis,
        /// Where the piece begins.
        spot: Spot,
    },
    /// A retract would end below the tool, or below the start of the next leg.
    #[error("the clearance is {mm:.4} mm below the path at {spot}: raise it above the surface")]
    TooLow {
        /// The end of the leg, or the start of the next one.
        spot: Spot,
        /// How far, mm.
        mm: f64,
    },
}

/// What works refer to by number.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Formulas {
    pub(crate) all: [Formula; FORMULAS],
    given: [bool; FORMULAS],
}

impl Formulas {
    pub(crate) fn set(&mut self, slot: usize, formula: Formula) {
        if let (Some(place), Some(given)) = (self.all.get_mut(slot), self.given.get_mut(slot)) {
            (*place, *given) = (formula, true);
        }
    }

    pub(crate) fn get(&self, slot: usize) -> Result<&Formula, Unworkable> {
        let given = self.given.get(slot).is_some_and(|given| *given);
        self.all.get(slot).filter(|_| given).ok_or(Unworkable::NoFormula(slot))
    }
}
