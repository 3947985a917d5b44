//! The machine in one process with an observer at it, so that a test can hold a frame back or kill the
//! interpolator.
#![allow(dead_code, unreachable_pub)] // each test file uses its part

use machine::Machine;
use protocol::{Axis, AxisState, AxisStatus, Cycle, Item, MachineStatus};
use rig::Rig;
use rig::observe::{Observation, Observer};
use rig::wires::{Disturbed, Late, Losing, Straight, Wire, Wires};
use sim_plant::Scenario;

/// Wires that can be slow or cut.
type Broken = Disturbed<Losing, Disturbed<Late, Straight>>;

/// The machine, and what was seen of it in the last cycle.
pub struct Stand {
    rig: Rig<std::vec::IntoIter<Item>, Broken>,
    observer: Observer,
    cycle: Cycle,
    true_mm: [f64; 8],
    statuses: Vec<(Axis, AxisStatus)>,
    pub machine_status: MachineStatus,
}

impl Stand {
    /// The small lathe before cycle 0.
    pub fn new(items: Vec<Item>, scenario: &str) -> Stand {
        let machine = Machine::plain();
        let scenario = Scenario::from_toml(scenario).expect("the scenarios of the tests are sound");
        let observer = Observer::new(&machine, &items);
        let wires = Straight.with(Late::new(0, |_, _| false)).with(Losing::new(|_, _| false));
        let rig = Rig::with_wires(&machine, items.into_iter(), scenario, 1, wires);
        Stand {
            rig: rig.expect("the built-in machine can be built"),
            observer,
            cycle: Cycle(0),
            true_mm: [0.0; 8],
            statuses: Vec::new(),
            machine_status: MachineStatus::default(),
        }
    }

    /// One control cycle.
    pub fn cycle(&mut self) {
        let Stand { rig, observer, cycle, true_mm, statuses, machine_status } = self;
        rig.cycle(None, |record| {
            observer.cycle(record);
            *cycle = record.truth.cycle;
            *true_mm = record.truth.axes.map(|axis| axis.motor_mm);
            statuses.clear();
            statuses.extend(record.axes);
            *machine_status = *record.machine;
        });
    }

    /// From now on this axis gets its frames so many ticks late.
    pub fn delay_frames(&mut self, axis: Axis, ticks: usize) {
        let late = &mut self.rig.wires_mut().wires.disturbance;
        late.change(ticks, move |wire, _| wire == Wire::Frame(axis));
    }

    /// The interpolator dies: no tick and no frame any more, not even one that is under way.
    pub fn kill_interpolator(&mut self) {
        let of_the_dead = |wire, _| matches!(wire, Wire::TickMeasurement | Wire::Frame(_) | Wire::Spindle);
        self.rig.wires_mut().disturbance.change(of_the_dead);
    }

    /// Cycles until a condition, and not for ever.
    pub fn until(&mut self, what: &str, condition: impl Fn(&Stand) -> bool) {
        let patience = self.cycle.after(400_000);
        while self.statuses.is_empty() || !condition(self) {
            assert!(self.cycle < patience, "waited in vain: {what}");
            self.cycle();
        }
    }

    pub fn run(&mut self, cycles: u64) {
        (0..cycles).for_each(|_| self.cycle());
    }

    /// What every axis said last.
    pub fn statuses(&self) -> impl Iterator<Item = (Axis, AxisStatus)> {
        self.statuses.iter().copied()
    }

    /// Whether every axis is in one of these states.
    pub fn all_in(&self, states: &[AxisState]) -> bool {
        let within = |status: &AxisStatus| states.iter().any(|state| *state as u32 == status.state);
        self.statuses().all(|(_, status)| within(&status))
    }

    /// True position of an axis, mm.
    pub fn true_mm(&self, axis: Axis) -> f64 {
        self.true_mm[axis.index()]
    }

    /// What was observed so far.
    pub fn observed(self) -> Observation {
        self.observer.finish()
    }
}

/// Machine code of a program without errors.
pub fn compiled(program: &str) -> Vec<Item> {
    let check = interpreter::check("test.ngc", program, &Machine::plain());
    assert!(check.is_good(), "{:?}", check.diagnostics);
    check.items
}
