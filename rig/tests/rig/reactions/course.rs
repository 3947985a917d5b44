//! A run as an outside observer notes it, cycle by cycle: what was true and measured, what arrived at the
//! regulators, what everybody said. In: a machine, machine code, a scenario. Out: a [`Course`].

use machine::Machine;
use protocol::{
    Axis, AxisCommand, AxisState, AxisStatus, Cycle, DriveState, Fault, Item, MachineState, MachineStatus,
    Measurement, Setpoint,
};
use rig::wires::Wires;
use rig::{Exchange, Rig};
use sim_plant::Scenario;

/// The axes of the small lathe.
pub(super) const AXES: [Axis; 2] = [Axis::X, Axis::Z];

/// One control cycle. What is by axis is in the order of [`AXES`].
#[derive(Clone, Copy)]
pub(super) struct Moment {
    pub(super) deg: f64,
    pub(super) rpm: f64,
    pub(super) measurement: Measurement,
    pub(super) axes: [AxisStatus; 2],
    /// The last setpoints that arrived, and whether a frame with an order to stop arrives.
    pub(super) led: [Setpoint; 2],
    pub(super) stopped: [bool; 2],
    pub(super) framed: [bool; 2],
    pub(super) machine: MachineStatus,
}

/// The cycles of a run, the first is cycle 0.
pub(super) type Course = Vec<Moment>;

impl Moment {
    fn of(exchange: &Exchange, before: Option<&Moment>) -> Moment {
        let Exchange { record, frames, .. } = exchange;
        let frame = |i: usize| frames[AXES[i].index()];
        let command = |i| frame(i).and_then(|frame| frame.unpack().ok());
        let told = before.map_or([Setpoint::default(); 2], |before| before.led);
        Moment {
            deg: record.truth.spindle_deg,
            rpm: record.truth.spindle_rpm,
            measurement: record.truth.measurement,
            axes: [0, 1].map(|i| record.axes[i].1),
            led: [0, 1].map(|i| frame(i).map_or(told[i], |frame| frame.setpoint)),
            stopped: [0, 1].map(|i| command(i) == Some(AxisCommand::Stop)),
            framed: [0, 1].map(|i| frame(i).is_some()),
            machine: *record.machine,
        }
    }

    /// Where an axis is measured, mm.
    pub(super) fn measured_mm(&self, axis: usize) -> f64 {
        self.measurement.axes[AXES[axis].index()].position.mm()
    }

    /// Whether the drive of an axis is in operation.
    pub(super) fn holds(&self, axis: usize) -> bool {
        self.measurement.axes[AXES[axis].index()].drive().state() == Some(DriveState::OperationEnabled)
    }

    /// Whether an axis tells a fault: it leaves because of it, or has latched it.
    pub(super) fn tells(&self, axis: usize, fault: Fault) -> bool {
        let status = &self.axes[axis];
        let reacts = matches!(status.state(), AxisState::Leaving | AxisState::Fault);
        reacts && status.fault == fault as u32
    }

    pub(super) fn all_tell(&self, fault: Fault) -> bool {
        self.tells(0, fault) && self.tells(1, fault)
    }

    pub(super) fn machine_tells(&self, fault: Fault) -> bool {
        self.machine.fault == fault as u32
    }
}

/// Wires on which the regulator of Z speaks another version of the protocol from a cycle on: it is in fault,
/// and nobody knows why.
struct Stranger {
    from: Option<u64>,
    said: AxisStatus,
}

impl Wires for Stranger {
    fn status<'a>(
        &'a mut self,
        now: Cycle,
        axis: Axis,
        sent: Option<&'a AxisStatus>,
    ) -> Option<&'a AxisStatus> {
        if axis != Axis::Z || self.from.is_none_or(|from| now.0 < from) {
            return sent;
        }
        self.said = AxisStatus { state: AxisState::Fault as u32, fault: 0, ..*sent? };
        Some(&self.said)
    }
}

/// What is run.
pub(super) struct Job<'a> {
    pub(super) machine: &'a Machine,
    pub(super) items: &'a [Item],
    /// As in a scenario file.
    pub(super) scenario: &'a str,
    /// From this cycle on Z speaks another version of the protocol.
    pub(super) stranger: Option<u64>,
}

impl Job<'_> {
    /// Runs until somebody has seen enough, the program ends, or so many cycles are over.
    pub(super) fn run(&self, cycles: u64, mut enough: impl FnMut(&Moment) -> bool) -> Course {
        let scenario = Scenario::from_toml(self.scenario).expect("the scenarios of the tests are sound");
        let wires = Stranger { from: self.stranger, said: AxisStatus::default() };
        let mut rig = Rig::with_wires(self.machine, self.items.iter().copied(), scenario, 11, wires)
            .expect("the machines of the tests can be built");
        let mut course: Course = Vec::new();
        for _ in 0..cycles {
            let mut over = false;
            let goes_on = rig.exchange(None, |exchange| {
                let moment = Moment::of(exchange, course.last());
                over = enough(&moment);
                course.push(moment);
            });
            if over || !goes_on {
                break;
            }
        }
        course
    }
}

/// Where in a program something happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stage {
    /// X and Z move by time.
    Timed,
    /// A dwell, the spindle at speed.
    Dwell,
    /// Approach and run-in of a pass, the thread, its run-out.
    RunIn,
    Thread,
    RunOut,
    /// Frames arm the axes.
    Arming,
    /// The axes are about to move by time.
    SetOff,
    /// The spindle turns back, and on to the index that it met last.
    Returning,
    /// The first cycles.
    Start,
}

impl Stage {
    /// The cycles of an undisturbed run that belong to it.
    pub(super) fn cycles(self, twin: &Course) -> Vec<u64> {
        let of = |at: usize| {
            let now = &twin[at];
            let z = now.axes[1].state();
            let moves = |now: &Moment| now.axes.iter().all(|axis| axis.velocity_mm_s != 0.0);
            let rests = |now: &Moment| now.axes.iter().all(|axis| axis.velocity_mm_s == 0.0);
            let rpm = now.machine.spindle_rpm;
            let at_speed = rpm != 0.0 && (now.rpm - rpm).abs() < 0.02 * rpm.abs();
            let timed = now.machine.state() == MachineState::Moving && moves(now);
            match self {
                Stage::Timed => timed && z == AxisState::Streaming,
                Stage::Dwell => now.machine.state() == MachineState::Waiting && at_speed,
                Stage::RunIn => z == AxisState::RunIn,
                Stage::Thread => z == AxisState::Locked,
                Stage::RunOut => z == AxisState::RunOut,
                Stage::Arming => z == AxisState::Armed && twin[at - 1].axes[1].state() != z,
                Stage::SetOff => {
                    at > 100 && twin.get(at + 16).is_some_and(rests) && twin.get(at + 24).is_some_and(moves)
                }
                Stage::Returning => returns(twin, at),
                Stage::Start => (100..140).contains(&at),
            }
        };
        (1..twin.len()).filter(|at| of(*at)).map(|at| at as u64).collect()
    }
}

/// Whether the next index is the one before again, met from the other side.
fn returns(twin: &Course, at: usize) -> bool {
    let index = |now: &Moment| (now.measurement.index_number, now.measurement.index_count);
    let (number, count) = index(&twin[at]);
    let next = twin[at..].iter().map(index).find(|(next, _)| *next > number);
    number > 0 && next.is_some_and(|(_, next)| (next - count).abs() <= 1)
}
