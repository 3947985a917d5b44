//! The supervisor alone: what it asks for and when it lets everybody go, from made-up cycles.

use machine::Machine;
use protocol::{
    Axis, AxisLaw, AxisState, AxisStatus, Code, Cycle, Fault, Item, MachineState, MachineStatus, Module,
    Panel, ThreadPass, Truth, operator::Request,
};
use rig::{
    observe::Record,
    supervisor::{End, Moving, REST_CYCLES, Supervisor},
};

/// A made-up machine that is in a state, and moves as told.
struct Made {
    supervisor: Supervisor,
    truth: Truth,
    axes: Vec<(Axis, AxisStatus)>,
    asked: Vec<u64>,
    cycle_s: f64,
    /// When the interpolator hung.
    told: Option<Cycle>,
    /// What it says of itself, and its fault.
    said: (MachineState, u32),
}

impl Made {
    /// In a pass that is over after ten turns.
    fn in_pass() -> Made {
        let law = AxisLaw { retract_c_deg: 3500.0, retract_dc_deg: 100.0, ..AxisLaw::default() };
        let pass = ThreadPass { pass: 1, axes: [law; 8], ..ThreadPass::default() };
        let items = [Item { line: 5, code: Code::Pass(pass) }];
        let cuts = AxisStatus { state: AxisState::Locked as u32, pass: 1, ..AxisStatus::default() };
        let mut made = Made {
            supervisor: Supervisor::new(&Machine::plain(), &items),
            truth: Truth { spindle_rpm: 600.0, ..Truth::default() },
            axes: vec![(Axis::X, cuts), (Axis::Z, cuts)],
            asked: Vec::new(),
            cycle_s: Machine::plain().general.cycle_s,
            told: None,
            said: (MachineState::Ready, 0),
        };
        made.move_z(10.0);
        made
    }

    fn move_z(&mut self, mm_s: f64) {
        self.truth.axes[Axis::Z.index()].velocity_mm_s = mm_s;
    }

    fn set(&mut self, state: AxisState) {
        self.axes.iter_mut().for_each(|(_, status)| status.state = state as u32);
    }

    /// That many cycles, or until it is over.
    fn go(&mut self, cycles: u64) {
        for _ in 0..cycles {
            if self.supervisor.end().is_some() {
                return;
            }
            self.truth.cycle = Cycle(self.truth.cycle.0 + 1);
            self.truth.spindle_deg += self.truth.spindle_rpm * 6.0 * self.cycle_s;
            let (cycle, (state, fault)) = (self.told.unwrap_or(self.truth.cycle), self.said);
            let machine = MachineStatus { cycle, state: state as u32, fault, ..MachineStatus::default() };
            let record = Record { truth: &self.truth, axes: &self.axes, machine: &machine };
            let request = self.supervisor.cycle(&record);
            self.ask(request);
        }
    }

    fn died(&mut self, module: Module) {
        let request = self.supervisor.died(module, self.truth.cycle.0);
        self.ask(request);
    }

    fn emergency_stop(&mut self) {
        let request = self.supervisor.emergency_stop();
        self.ask(request);
    }

    fn ask(&mut self, request: Option<Request>) {
        assert!(matches!(request, None | Some(Request::EmergencyStop)));
        self.asked.extend(request.map(|_| self.truth.cycle.0));
    }
}

#[test]
fn a_machine_with_all_its_parts_is_left_alone_as_is_one_without_its_interpreter() {
    let mut made = Made::in_pass();
    made.go(100);
    made.died(Module::Interpreter);
    made.go(100_000);
    assert!(made.supervisor.is_watching() && made.asked.is_empty() && made.supervisor.end().is_none());
}

#[test]
fn a_pass_without_its_interpolator_is_cut_to_its_end_before_the_emergency_stop() {
    let mut made = Made::in_pass();
    made.go(100);
    made.died(Module::Interpolator);
    made.go(1000);
    assert!(made.asked.is_empty());
    made.set(AxisState::Fault);
    made.move_z(0.0);
    made.go(10);
    assert_eq!(made.asked, [1101]);
    assert_eq!(made.supervisor.end(), None, "the spindle turns");
    made.truth.spindle_rpm = 0.0;
    made.go(REST_CYCLES - 1);
    assert_eq!(made.supervisor.end(), None);
    made.go(1);
    assert_eq!(made.supervisor.end(), Some(End::Rest));
}

/// Several processes: a death is heard of before what was recorded until then has been looked at.
#[test]
fn what_was_before_the_pass_does_not_end_it() {
    let mut made = Made::in_pass();
    assert_eq!(made.supervisor.died(Module::Interpolator, 100), None);
    made.set(AxisState::Streaming);
    made.go(99);
    made.set(AxisState::Locked);
    made.go(1000);
    assert!(made.asked.is_empty());
    made.set(AxisState::Streaming);
    made.go(1);
    assert_eq!(made.asked, [1100]);
}

/// Its wire to the spindle is cut.
#[test]
fn an_interpolator_that_is_not_heard_at_the_end_is_helped_at_the_panel() {
    let cycles = (1.0 / Machine::plain().general.cycle_s) as u64;
    for said in [(MachineState::Ended, 0), (MachineState::Fault, Fault::SpindleDoesNotStop as u32)] {
        let mut made = Made::in_pass();
        made.set(AxisState::Streaming);
        made.go(100);
        made.said = said;
        made.go(cycles);
        assert!(made.asked.is_empty(), "{said:?}");
        made.go(10);
        assert_eq!(made.asked, [101 + cycles], "{said:?}");
    }
    let mut made = Made::in_pass();
    made.said = (MachineState::Fault, Fault::SpindleDoesNotStop as u32);
    made.truth.measurement.panel.buttons |= Panel::EMERGENCY_STOP;
    made.go(100 * cycles);
    assert!(made.asked.is_empty(), "the emergency stop has been heard");
}

#[test]
fn an_axis_that_faults_in_a_pass_without_its_interpolator_stops_the_machine_at_once() {
    let mut made = Made::in_pass();
    made.died(Module::Interpolator);
    made.go(100);
    assert!(made.asked.is_empty());
    made.axes[0].1.state = AxisState::Fault as u32;
    made.go(10);
    assert_eq!(made.asked, [101]);
    // Nobody has buried it yet.
    let mut made = Made::in_pass();
    made.go(100);
    made.axes[0].1.state = AxisState::Fault as u32;
    made.go(100);
    assert!(made.asked.is_empty(), "the interpolator stops the spindle");
    made.told = Some(made.truth.cycle);
    made.go(100);
    assert_eq!(made.asked, [201 + 4 * Machine::plain().cycles_per_tick()]);
    // Its regulator measures nothing, and says nothing: its drive has tripped.
    let mut made = Made::in_pass();
    made.go(100);
    made.truth.measurement.axes[Axis::X.index()].status_word = 0x0008;
    made.told = Some(made.truth.cycle);
    made.go(100);
    assert_eq!(made.asked, [101 + 4 * Machine::plain().cycles_per_tick()]);
}

#[test]
fn a_pass_without_its_interpolator_may_turn_so_far_and_no_farther() {
    let mut made = Made::in_pass();
    made.died(Module::Interpolator);
    made.go(1_000_000);
    // 3600° of the pass and two turns, at 600 1/min and 0.5 ms: 1.8° a cycle.
    assert_eq!(made.asked.len(), 1);
    assert!((2400..2405).contains(&made.asked[0]), "{:?}", made.asked);

    let mut made = Made::in_pass();
    made.died(Module::Interpolator);
    made.truth.spindle_rpm = 0.0;
    made.go(1_000_000);
    assert_eq!(made.asked.len(), 1, "nor may the spindle stand for ever");
    assert_eq!(made.supervisor.end(), Some(End::NoRest(Moving::Axis(Axis::Z, 10.0))));
}

#[test]
fn a_regulator_that_dies_stops_the_machine_at_once_and_only_once() {
    let mut made = Made::in_pass();
    made.go(100);
    made.died(Module::Regulator(Axis::X));
    made.go(1);
    made.died(Module::Interpolator);
    made.emergency_stop();
    made.go(100);
    assert_eq!(made.asked, [100]);
}

#[test]
fn a_spindle_that_slows_down_is_waited_for_and_one_that_does_not_is_named() {
    let mut made = Made::in_pass();
    made.move_z(0.0);
    made.emergency_stop();
    // It coasts for a minute: far longer than its ramp.
    for _ in 0..120_000 {
        made.go(1);
        made.truth.spindle_rpm = (made.truth.spindle_rpm - 600.0 / 121_000.0).max(0.0);
    }
    assert_eq!(made.supervisor.end(), None, "it still coasts");
    made.truth.spindle_rpm = 0.0;
    made.go(REST_CYCLES);
    assert_eq!(made.supervisor.end(), Some(End::Rest));

    let mut made = Made::in_pass();
    made.move_z(0.0);
    made.emergency_stop();
    made.go(1_000_000);
    assert_eq!(made.supervisor.end(), Some(End::NoRest(Moving::Spindle(600.0))));
    assert!(made.truth.cycle.0 < 30_000, "{:?}", made.truth.cycle);
}

#[test]
fn without_the_plant_there_is_nothing_to_wait_for() {
    let mut made = Made::in_pass();
    made.supervisor.plant_died();
    assert_eq!(made.supervisor.end(), Some(End::PlantGone));
    made.emergency_stop();
    made.go(10);
    assert!(made.asked.is_empty());
}
