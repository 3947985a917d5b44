//! The way out of a pass: which axis lifts the tool, to where, what makes the axes leave.

use zerocopy::{FromBytes, Immutable, IntoBytes};

use crate::{refused::Refused, units::Position};

/// The way out of a pass, the same for every axis: which axis lifts the tool off, and where it is out of the
/// part. Whoever leaves a thread early needs no more than this and the law of its own axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct WayOut {
    /// Index of the axis that lifts the tool off (`Axis::index`); X of a thread on a cylinder. Of a pass
    /// that returns the one along the helix: nothing else takes a tap out.
    pub axis: u32,
    /// Sum of [`WayOut::ON_HOLD`], [`WayOut::ON_STOP`], [`WayOut::ON_FAULT`]: what makes the axes leave at
    /// once; for the rest the pass is finished. Emergency stop, loss of power and a drive that fails always
    /// do. And [`WayOut::RETURNS`].
    pub leaves: u32,
    /// Where that axis rests when it has left.
    pub clear: Position,
    /// Beyond this, seen from the part, the tool is out of the groove: the other axes may brake. It lies
    /// between the groove and `clear`, or at `clear`.
    pub free: Position,
}

impl WayOut {
    /// Feed hold leaves the thread; cycle start enters it again.
    pub const ON_HOLD: u32 = 1;
    /// Stop and abort leave the thread.
    pub const ON_STOP: u32 = 2;
    /// So do faults that would let the pass be finished.
    pub const ON_FAULT: u32 = 4;
    /// A tap: the axes follow the spindle in and, once it has turned round, out again on the same helix, to
    /// where the pass started. Nobody lifts the tool; `axis` is the one along the helix, `clear` its start.
    pub const RETURNS: u32 = 8;

    /// Whether something that the packet may say makes the axes leave.
    pub fn on(&self, what: u32) -> bool {
        self.leaves & what != 0
    }

    /// Whether the axis that lifts is out of the groove at a position.
    pub fn is_free(&self, position: Position) -> bool {
        match self.clear >= self.free {
            true => position >= self.free,
            false => position <= self.free,
        }
    }

    /// Refuses a way out that leads nowhere.
    ///
    /// # Errors
    /// The axis or a bit of `leaves` is unknown, or a place lies beyond every machine.
    pub fn check(&self) -> Result<(), Refused> {
        let known = WayOut::ON_HOLD | WayOut::ON_STOP | WayOut::ON_FAULT | WayOut::RETURNS;
        let near = |place: Position| place.0.unsigned_abs() <= WayOut::FARTHEST;
        match () {
            () if self.axis as usize >= crate::units::AXES => Err(Refused::OutOfRange("axis of the way out")),
            () if self.leaves & !known != 0 => Err(Refused::OutOfRange("what leaves a pass")),
            () if !(near(self.clear) && near(self.free)) => Err(Refused::OutOfRange("way out")),
            () => Ok(()),
        }
    }

    /// 100 m in counts of a position.
    const FARTHEST: u64 = 100_000_000_000_000;
}
