//! The contour of G70, G71 and G72 while its subroutine is read.

use crate::canon::{Place, Pose};
use crate::codes::G;
use crate::geometry::contour::{Point, Segment};
use crate::geometry::corner::Corner;

/// The cycle whose contour is being read, if there is one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Recorder(Option<Box<Cycle>>);

/// A cycle between its block and its passes.
#[derive(Clone, Debug)]
pub(crate) struct Cycle {
    pub(crate) code: G,
    pub(crate) subroutine: u32,
    pub(crate) place: Place,
    /// Depth of calls outside of the subroutine.
    pub(crate) level: u32,
    /// The subroutine was called.
    pub(crate) called: bool,
    /// A block of the contour was wrong.
    pub(crate) broken: bool,
    /// Where the passes start, and the same as a point of the machine's axes.
    pub(crate) start: Point,
    pub(crate) position: Pose,
    pub(crate) distance: f64,
    pub(crate) ending_distance: f64,
    pub(crate) passes: u32,
    pub(crate) infeed: f64,
    pub(crate) escape: f64,
    pub(crate) pieces: Vec<Piece>,
}

impl Recorder {
    /// Whether blocks are read for their contour.
    pub(crate) fn is_on(&self) -> bool {
        self.0.is_some()
    }

    /// The subroutine that has to be called now. It is named once.
    pub(crate) fn take_call(&mut self) -> Option<u32> {
        let cycle = self.0.as_mut().filter(|cycle| !cycle.called)?;
        cycle.called = true;
        Some(cycle.subroutine)
    }

    /// Begins to read the contour of a cycle.
    pub(crate) fn begin(&mut self, cycle: Cycle) {
        self.0 = Some(Box::new(cycle));
    }

    /// The cycle whose contour is being read.
    pub(crate) fn cycle_mut(&mut self) -> Option<&mut Cycle> {
        self.0.as_deref_mut()
    }

    /// The cycle, whose contour is complete, if its subroutine was left for `level`.
    pub(crate) fn take_ended(&mut self, level: u32) -> Option<Box<Cycle>> {
        self.0.take_if(|cycle| level <= cycle.level)
    }

    /// Forgets the cycle: its subroutine cannot be called.
    pub(crate) fn cancel(&mut self) {
        self.0 = None;
    }
}

/// A segment as programmed, and what stands at its end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub(crate) segment: Segment,
    pub(crate) corner: Corner,
}
