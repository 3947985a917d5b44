//! The machine in one process, wired by hand, so that a test can cut a wire or hold a frame back. Order and delays are
//! those of `rig`.
#![allow(dead_code, unreachable_pub)] // each test file uses its part

use std::collections::VecDeque;

use interpolator::{Interpolator, Out};
use protocol::{
    Axis, AxisFrame, AxisState, AxisStatus, CodePacket, DriveCommand, Item, Machine, MachineStatus, PerAxis,
    SpindleCommand, Truth, units::AXES,
};
use regulator::Regulator;
use rig::observe::{Observation, Observer, Record};
use sim_plant::{Plant, Scenario};

/// The machine.
pub struct Wires {
    plant: Plant,
    /// `None` once it died.
    interpolator: Option<Interpolator>,
    regulators: Vec<(Axis, Regulator)>,
    items: std::vec::IntoIter<Item>,
    sent: u64,
    ticks: u64,
    /// Frames on their way to each axis.
    under_way: PerAxis<VecDeque<AxisFrame>>,
    spindle_made: SpindleCommand,
    spindle: SpindleCommand,
    drives: PerAxis<DriveCommand>,
    statuses: PerAxis<AxisStatus>,
    pub machine_status: MachineStatus,
    observer: Observer,
    /// From the arming of a pass on, this axis gets its frames so many ticks late.
    pub late: Option<(Axis, usize)>,
}

impl Wires {
    /// The small lathe before cycle 0.
    pub fn new(items: Vec<Item>, scenario: &str) -> Wires {
        let machine = Machine::default();
        let scenario = Scenario::from_toml(scenario).expect("the scenarios of the tests are sound");
        Wires {
            plant: Plant::new(&machine, scenario, 1).expect("the built-in machine can be built"),
            interpolator: Some(Interpolator::new(&machine)),
            regulators: machine.axes().map(|(axis, _)| (axis, Regulator::new(&machine, axis))).collect(),
            observer: Observer::new(&machine, &items),
            items: items.into_iter(),
            sent: 0,
            ticks: machine.cycles_per_tick(),
            under_way: Default::default(),
            spindle_made: SpindleCommand::default(),
            spindle: SpindleCommand::default(),
            drives: [DriveCommand::default(); AXES],
            statuses: [AxisStatus::default(); AXES],
            machine_status: MachineStatus::default(),
            late: None,
        }
    }

    /// One control cycle, with frames delivered as `late` says.
    pub fn cycle(&mut self) {
        let truth = *self.plant.truth();
        let measurement = &truth.measurement;
        let tick = measurement.cycle.0.is_multiple_of(self.ticks);
        let mut in_force: PerAxis<Option<AxisFrame>> = [None; AXES];
        if tick {
            in_force = self.arriving();
            self.spindle = self.spindle_made;
            self.interpolate(&truth);
        }
        for (axis, regulator) in &mut self.regulators {
            let frame = in_force[axis.index()].as_ref();
            let out = regulator.tick(&regulator::In { measurement, frame });
            self.drives[axis.index()] = out.drive;
            self.statuses[axis.index()] = out.status;
        }
        let axes: Vec<_> = self.statuses().collect();
        self.observer.cycle(&Record { truth: &truth, axes: &axes, machine: &self.machine_status });
        self.plant.tick(&self.drives, &self.spindle, None);
    }

    /// The oldest frame of every axis, unless it is held back.
    fn arriving(&mut self) -> PerAxis<Option<AxisFrame>> {
        let mut arriving = [None; AXES];
        for (axis, _) in &self.regulators {
            let late = self.late.filter(|(late, _)| late == axis).map_or(0, |(_, ticks)| ticks);
            let queue = &mut self.under_way[axis.index()];
            if queue.len() > late {
                arriving[axis.index()] = queue.pop_front();
            }
        }
        arriving
    }

    fn interpolate(&mut self, truth: &Truth) {
        let Some(interpolator) = &mut self.interpolator else { return };
        while interpolator.wants() {
            let Some(item) = self.items.next() else { break };
            let taken = interpolator.push(&CodePacket::pack(self.sent, &item));
            taken.expect("machine code of the interpreter is in order");
            self.sent += 1;
        }
        let Out { frames, spindle, status } =
            interpolator.tick(&interpolator::In { measurement: &truth.measurement, axes: &self.statuses });
        self.spindle_made = spindle;
        self.machine_status = status;
        for (queue, frame) in self.under_way.iter_mut().zip(frames) {
            queue.push_back(frame);
        }
    }

    /// Cycles until a condition, and not for ever.
    pub fn until(&mut self, what: &str, condition: impl Fn(&Wires) -> bool) {
        let patience = self.plant.truth().cycle.0 + 400_000;
        while !condition(self) {
            assert!(self.plant.truth().cycle.0 < patience, "in vain: {what}");
            self.cycle();
        }
    }

    pub fn run(&mut self, cycles: u64) {
        (0..cycles).for_each(|_| self.cycle());
    }

    /// The interpolator dies: no tick and no frame any more, not even one that is under way.
    pub fn kill_interpolator(&mut self) {
        self.interpolator = None;
        self.under_way.iter_mut().for_each(VecDeque::clear);
    }

    /// What every axis said last.
    pub fn statuses(&self) -> impl Iterator<Item = (Axis, AxisStatus)> {
        self.regulators.iter().map(|(axis, _)| (*axis, self.statuses[axis.index()]))
    }

    /// Whether every axis is in one of these states.
    pub fn all_in(&self, states: &[AxisState]) -> bool {
        let within = |status: &AxisStatus| states.iter().any(|state| *state as u32 == status.state);
        self.statuses().all(|(_, status)| within(&status))
    }

    /// True position of an axis, mm.
    pub fn true_mm(&self, axis: Axis) -> f64 {
        self.plant.truth().axes[axis.index()].motor_mm
    }

    /// What was observed so far.
    pub fn observed(self) -> Observation {
        self.observer.finish()
    }
}

/// Machine code of a program without errors.
pub fn compiled(program: &str) -> Vec<Item> {
    let check = interpreter::check("test.ngc", program, &Machine::default());
    assert!(check.is_good(), "{:?}", check.diagnostics);
    check.items
}
