//! What the regulators say, taken together. In: the status of every axis, as it arrives. Out: one answer for
//! all axes that exist.
//!
//! A status that is damaged is no fact: the one before it counts on, and ages. A regulator whose last word is
//! too old is silent.

use machine::Machine;
use protocol::{
    Axis, AxisState, AxisStatus, Cycle, DriveState, Fault, Measurement, PerAxis, Position, ThreadPass,
    units::AXES,
};

use crate::task::Trouble;

/// Two ways of computing one position differ by less, mm: what the wire rounds to, and a sum of two strokes.
const SAME_MM: f64 = 1e-6;

/// A status may be so many control cycles older than the one that is due.
const MOST_AGE: u64 = 3;

/// No axis is so far away, so fast, or turns so far: beyond it a number is damage.
const MOST: f64 = 1e12;

/// The last status of each axis that can be believed.
#[derive(Clone, Debug)]
pub(crate) struct Heard {
    statuses: PerAxis<AxisStatus>,
    damaged: PerAxis<bool>,
    /// It is newer than the measurement of the tick.
    newer: PerAxis<bool>,
    /// The first axis that a fault is about.
    accused: Option<(Fault, Axis)>,
}

impl Heard {
    pub(crate) fn new() -> Heard {
        Heard {
            statuses: [AxisStatus::default(); AXES],
            damaged: [false; AXES],
            newer: [false; AXES],
            accused: None,
        }
    }

    /// The faults that the axes have told.
    pub(crate) fn faults(&self) -> impl Iterator<Item = Fault> {
        self.statuses.iter().filter_map(|status| Fault::from_code(status.fault))
    }

    /// Remembers which axis a trouble is about.
    pub(crate) fn accuse(&mut self, trouble: &Trouble) {
        self.accused = self.accused.or(trouble.axis.map(|axis| (trouble.fault, axis)));
    }

    /// The axis that a fault is about.
    pub(crate) fn accused(&self, fault: Fault) -> Option<Axis> {
        self.accused.filter(|(accused, _)| *accused == fault).map(|(_, axis)| axis)
    }

    /// Takes what has arrived by the tick of a cycle.
    pub(crate) fn take(&mut self, machine: &Machine, arrived: &PerAxis<AxisStatus>, tick: Cycle) {
        for (axis, _) in machine.axes() {
            let (i, status) = (axis.index(), &arrived[axis.index()]);
            self.newer[i] = status.cycle > tick;
            self.damaged[i] = self.newer[i] || !sound(status);
            if !self.damaged[i] && status.cycle >= self.statuses[i].cycle {
                self.statuses[i] = *status;
            }
        }
    }
}

/// Whether a status can be one.
fn sound(status: &AxisStatus) -> bool {
    let numbers = [
        status.commanded_mm,
        status.velocity_mm_s,
        status.acceleration_mm_s2,
        status.servo_error_mm,
        status.angle_deg,
        status.spindle_rpm,
    ];
    AxisState::from_code(status.state).is_ok()
        && (status.fault == 0 || Fault::from_code(status.fault).is_some_and(Fault::is_of_regulator))
        && status.in_position <= 1
        && numbers.iter().all(|number| number.abs() <= MOST)
}

/// Which axes the machine has, and what each of them said last.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axes<'a> {
    machine: &'a Machine,
    heard: &'a Heard,
    tick: Cycle,
}

impl<'a> Axes<'a> {
    pub(crate) fn new(machine: &'a Machine, heard: &'a Heard, tick: Cycle) -> Axes<'a> {
        Axes { machine, heard, tick }
    }

    fn each(&self) -> impl Iterator<Item = (Axis, &'a AxisStatus)> + use<'a> {
        let statuses = &self.heard.statuses;
        self.machine.axes().map(move |(axis, _)| (axis, &statuses[axis.index()]))
    }

    /// The axes whose regulators are not silent.
    fn live(&self) -> impl Iterator<Item = (Axis, &'a AxisStatus)> {
        self.each().filter(|(axis, _)| !self.is_silent(*axis))
    }

    fn all_in(&self, state: AxisState) -> bool {
        self.each().all(|(_, status)| status.state() == state)
    }

    /// The status of an axis.
    pub(crate) fn status(&self, axis: Axis) -> &'a AxisStatus {
        &self.heard.statuses[axis.index()]
    }

    /// Whether the last word of a regulator is too old. One that arrives damaged is bridged for a tick.
    fn is_silent(&self, axis: Axis) -> bool {
        let i = axis.index();
        let due = self.tick.0.saturating_sub(1);
        let bridged = if self.heard.damaged[i] { self.machine.cycles_per_tick() } else { 0 };
        due.saturating_sub(self.heard.statuses[i].cycle.0) > MOST_AGE + bridged
    }

    /// The first of the regulators that is silent.
    pub(crate) fn silent(&self) -> Option<Axis> {
        self.machine.axes().map(|(axis, _)| axis).find(|axis| self.is_silent(*axis))
    }

    /// Whether all of them have answered a later measurement than this tick has: it is the interpolator that
    /// was held up.
    pub(crate) fn ahead(&self) -> bool {
        self.machine.axes().all(|(axis, _)| self.heard.newer[axis.index()])
    }

    /// The first axis that is not armed with this pass.
    pub(crate) fn unarmed(&self, pass: u32) -> Option<Axis> {
        let armed = |status: &AxisStatus| status.state() == AxisState::Armed && status.pass == pass;
        self.each().find(|(_, status)| !armed(status)).map(|(axis, _)| axis)
    }

    /// What an axis says is wrong with it: the cause, not what it did to another axis.
    pub(crate) fn cause(&self) -> Option<Fault> {
        let follows = |fault: &Fault| !matches!(fault, Fault::OtherAxis | Fault::Stopped | Fault::AxisFault);
        self.each().filter_map(|(_, status)| Fault::from_code(status.fault)).find(follows)
    }

    /// Whether one of them is in fault, or comes to rest because of one, and all speak: who does not tells
    /// why as soon as it speaks again, or is silent.
    pub(crate) fn in_fault(&self) -> bool {
        let fails = |status: &AxisStatus| status.state() == AxisState::Fault || status.fault != 0;
        self.each().any(|(_, status)| fails(status)) && self.each().all(|(axis, _)| self.speaks(axis))
    }

    /// Whether a drive does not hold its axis. It trips when its regulator says nothing: that one tells why
    /// as soon as it speaks again, or is silent.
    pub(crate) fn drive_off(&self, measurement: &Measurement) -> bool {
        let off =
            |axis: Axis| measurement.axes[axis.index()].drive().state() != Some(DriveState::OperationEnabled);
        self.machine.axes().any(|(axis, _)| off(axis) && self.speaks(axis))
    }

    /// Whether a regulator has answered the measurement before this tick.
    fn speaks(&self, axis: Axis) -> bool {
        self.heard.statuses[axis.index()].cycle.after(1) >= self.tick
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
        self.unarmed(pass).is_none()
    }

    /// Whether one of them has seen the index of its pass.
    pub(crate) fn begun(&self) -> bool {
        self.each().any(|(_, status)| status.state().has_begun())
    }

    /// Whether the law of a pass leads one of them already.
    pub(crate) fn under_law(&self) -> bool {
        self.each().any(|(_, status)| (AxisState::RunIn..=AxisState::RunOut).contains(&status.state()))
    }

    /// Whether one of them is on its way out of a pass.
    pub(crate) fn leave(&self) -> bool {
        self.each().any(|(_, status)| status.state() == AxisState::Leaving)
    }

    /// Whether an axis that follows the stream is farther from where it is led than it can be on its way, or
    /// not there although it should have arrived: its setpoints do not. `here` lies so many s ahead of it,
    /// and has been the same since a cycle.
    pub(crate) fn astray(
        &self,
        machine: &Machine,
        here: &PerAxis<Position>,
        since: &PerAxis<Cycle>,
        ahead_s: f64,
    ) -> bool {
        self.live().any(|(axis, status)| {
            let i = axis.index();
            let most = machine.axis.get(&axis).map_or(f64::INFINITY, |config| config.velocity_mm_s * ahead_s);
            let (here_mm, arrived) = (here[i].mm(), status.cycle > since[i]);
            let far = (here_mm - status.commanded_mm).abs() > most;
            status.state() == AxisState::Streaming && (far || arrived && !near(status.commanded_mm, here_mm))
        })
    }

    /// Whether an axis that follows the stream rests elsewhere than it was led: its last setpoints have not
    /// arrived.
    pub(crate) fn elsewhere(&self, here: &PerAxis<Position>) -> bool {
        self.live().any(|(axis, status)| {
            status.state() == AxisState::Streaming && !near(status.commanded_mm, here[axis.index()].mm())
        })
    }

    /// Whether all that live stand and belong to no pass.
    pub(crate) fn rest(&self) -> bool {
        self.live().all(|(_, status)| {
            let over = matches!(status.state(), AxisState::Streaming | AxisState::Fault | AxisState::Idle);
            over && status.velocity_mm_s == 0.0 && status.acceleration_mm_s2 == 0.0
        })
    }

    /// Where each of them is led; what does not exist is where it was.
    pub(crate) fn commanded(&self, here: &PerAxis<Position>) -> PerAxis<Position> {
        let mut commanded = *here;
        self.each().for_each(|(axis, status)| {
            commanded[axis.index()] = Position::from_mm(status.commanded_mm);
        });
        commanded
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_is_astray_that_is_farther_from_its_setpoint_than_it_can_go() {
        let machine = Machine::plain();
        let most_mm = machine.axis[&Axis::Z].velocity_mm_s * 0.012;
        let since = |state: AxisState, apart_mm: f64, tick: u64, since: u64| {
            let (mut statuses, mut here) = ([AxisStatus::default(); AXES], [Position(0); AXES]);
            for (axis, _) in machine.axes() {
                let (cycle, state) = (Cycle(99), state as u32);
                statuses[axis.index()] =
                    AxisStatus { cycle, state, commanded_mm: 7.0, ..AxisStatus::default() };
                here[axis.index()] = Position::from_mm(7.0);
            }
            here[Axis::Z.index()] = Position::from_mm(7.0 + apart_mm);
            let mut heard = Heard::new();
            heard.take(&machine, &statuses, Cycle(100));
            Axes::new(&machine, &heard, Cycle(tick)).astray(&machine, &here, &[Cycle(since); AXES], 0.012)
        };
        let astray = |state, apart_mm, tick| since(state, apart_mm, tick, 110);
        for sign in [1.0, -1.0] {
            assert!(!astray(AxisState::Streaming, sign * 0.99 * most_mm, 100));
            assert!(astray(AxisState::Streaming, sign * 1.01 * most_mm, 100));
            // It has to have arrived, or has not.
            assert!(since(AxisState::Streaming, sign * 0.01, 100, 98));
            assert!(!since(AxisState::Streaming, sign * 0.01, 100, 99));
            assert!(!since(AxisState::Streaming, 0.0, 100, 98));
            // One that is led by no setpoints, and one that is silent, are not.
            assert!(!astray(AxisState::Leaving, sign * 2.0 * most_mm, 100));
            assert!(!astray(AxisState::Streaming, sign * 2.0 * most_mm, 120));
        }
    }

    #[test]
    fn a_status_with_a_fault_that_no_regulator_finds_is_damaged() {
        let machine = Machine::plain();
        let believed = |fault: u32| {
            let status = AxisStatus { cycle: Cycle(7), fault, ..AxisStatus::default() };
            let mut heard = Heard::new();
            heard.take(&machine, &[status; AXES], Cycle(8));
            Axes::new(&machine, &heard, Cycle(8)).in_fault()
        };
        assert!(believed(Fault::AxisJump as u32) && believed(Fault::EmergencyStop as u32));
        assert!(!believed(Fault::PlanRejected as u32) && !believed(Fault::TravelLimit as u32));
        assert!(!believed(Fault::ALL.len() as u32 + 1));
    }
}
