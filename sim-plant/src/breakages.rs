//! What a scenario has broken, besides the spindle encoder. In: the values of events, then the cycle. Out:
//! what happens to drives and encoders of the axes, forces on slides, what the drive of the spindle does.

use protocol::{Axis, PerAxis};

use crate::drive::Trip;
use crate::scenario::SpindleFault;

/// What breaks at an axis in a cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct AxisBreakage {
    /// Of its drive.
    pub(crate) trip: Option<Trip>,
    /// By how much its counter jumps, mm.
    pub(crate) jump_mm: f64,
}

/// What is broken in the present cycle.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Breakages {
    /// Whether there is anything to take.
    fresh: bool,
    axes: PerAxis<AxisBreakage>,
    /// Forces in N and the cycles in which they end.
    spikes: PerAxis<Option<(f64, u64)>>,
    /// What is wrong with the drive of the spindle, and the cycle in which it ends, if it does.
    spindle: Option<(SpindleFault, Option<u64>)>,
}

impl Breakages {
    /// Something happens to the drive of an axis.
    pub(crate) fn trip(&mut self, axis: Axis, trip: Trip) {
        self.fresh = true;
        self.axes[axis.index()].trip = Some(trip);
    }

    /// The counter of an axis jumps.
    pub(crate) fn jump(&mut self, axis: Axis, mm: f64) {
        self.fresh = true;
        self.axes[axis.index()].jump_mm += mm;
    }

    /// A force pushes on a slide until a cycle; one that was there before is over.
    pub(crate) fn spike(&mut self, axis: Axis, force_n: f64, until: u64) {
        self.spikes[axis.index()] = Some((force_n, until));
    }

    /// The drive of the spindle is at fault.
    pub(crate) fn break_spindle(&mut self, fault: SpindleFault, until: Option<u64>) {
        self.spindle = Some((fault, until));
    }

    /// What is wrong with the drive of the spindle.
    pub(crate) fn spindle(&self) -> Option<SpindleFault> {
        self.spindle.map(|(fault, _)| fault)
    }

    /// What happens to the axes; once.
    pub(crate) fn take(&mut self) -> Option<PerAxis<AxisBreakage>> {
        std::mem::take(&mut self.fresh).then(|| std::mem::take(&mut self.axes))
    }

    /// The force on the slide of an axis that a spike adds, N.
    pub(crate) fn spike_n(&self, axis: Axis) -> Option<f64> {
        self.spikes[axis.index()].map(|(force_n, _)| force_n)
    }

    /// Goes on to a cycle.
    pub(crate) fn advance(&mut self, cycle: u64) {
        if self.spindle.is_some_and(|(_, until)| until.is_some_and(|until| cycle >= until)) {
            self.spindle = None;
        }
        for spike in &mut self.spikes {
            if spike.is_some_and(|(_, until)| cycle >= until) {
                *spike = None;
            }
        }
    }
}
