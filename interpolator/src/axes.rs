//! What the regulators say, taken together. In: the status of every axis. Out: one answer for all axes that
//! exist.

use machine::Machine;
use protocol::{Axis, AxisState, AxisStatus, PerAxis, ThreadPass};

/// Two ways of computing one position differ by less, mm: what the wire rounds to, and a sum of two strokes.
const SAME_MM: f64 = 1e-6;

/// Which axes the machine has, and what each of them said last.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axes<'a> {
    machine: &'a Machine,
    statuses: &'a PerAxis<AxisStatus>,
}

impl<'a> Axes<'a> {
    pub(crate) fn new(machine: &'a Machine, statuses: &'a PerAxis<AxisStatus>) -> Axes<'a> {
        Axes { machine, statuses }
    }

    fn each(&self) -> impl Iterator<Item = (Axis, &'a AxisStatus)> + use<'a> {
        let statuses = self.statuses;
        self.machine.axes().map(move |(axis, _)| (axis, &statuses[axis.index()]))
    }

    fn all_in(&self, state: AxisState) -> bool {
        self.each().all(|(_, status)| status.state() == state)
    }

    /// Whether one of them is in fault.
    pub(crate) fn in_fault(&self) -> bool {
        self.each().any(|(_, status)| status.state() == AxisState::Fault)
    }

    /// Whether all follow setpoints.
    pub(crate) fn stream(&self) -> bool {
        self.all_in(AxisState::Streaming)
    }

    /// Whether all rest where they were led.
    pub(crate) fn in_position(&self) -> bool {
        self.each().all(|(_, status)| status.in_position != 0)
    }

    /// Whether all have this pass and wait for its index.
    pub(crate) fn armed_with(&self, pass: u32) -> bool {
        self.all_in(AxisState::Armed) && self.each().all(|(_, status)| status.pass == pass)
    }

    /// Whether one of them has seen the index of its pass.
    pub(crate) fn begun(&self) -> bool {
        self.each().any(|(_, status)| status.state().has_begun())
    }

    /// Whether the law of a pass leads one of them already.
    pub(crate) fn under_law(&self) -> bool {
        self.each().any(|(_, status)| (AxisState::RunIn..=AxisState::RunOut).contains(&status.state()))
    }

    /// Whether all rest where a pass ends.
    pub(crate) fn at_end_of(&self, pass: &ThreadPass) -> bool {
        self.each().all(|(axis, status)| near(status.commanded_mm, pass.axis(axis).end.mm()))
    }

    /// Whether all rest where a pass starts.
    pub(crate) fn at_start_of(&self, pass: &ThreadPass) -> bool {
        self.each().all(|(axis, status)| near(status.commanded_mm, pass.axis(axis).start.mm()))
    }
}

fn near(a_mm: f64, b_mm: f64) -> bool {
    (a_mm - b_mm).abs() <= SAME_MM
}
