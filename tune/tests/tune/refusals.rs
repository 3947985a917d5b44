//! What cannot be tuned is refused by name, with what to do, and is left without power.

use machine::Machine;
use protocol::{
    Axis, ControlWord, DriveCommand, DriveState, Measurement, PerAxis, Position, SpindleCommand, StatusWord,
};
use sim_plant::{Plant, Scenario};
use tune::{Bench, Goals, Refusal, tune, tune_towards};

/// A machine whose measurements are changed on their way.
struct Changed<F> {
    plant: Plant,
    change: F,
    measurement: Measurement,
    last: DriveCommand,
}

impl<F: FnMut(&mut Measurement)> Changed<F> {
    fn new(machine: &Machine, change: F) -> Changed<F> {
        let plant = Plant::new(machine, Scenario::none(), 1).expect("the plant is sound");
        let measurement = *plant.measurement();
        Changed { plant, change, measurement, last: DriveCommand::default() }
    }
}

impl<F: FnMut(&mut Measurement)> Bench for Changed<F> {
    fn measurement(&self) -> &Measurement {
        &self.measurement
    }

    fn tick(&mut self, drives: &PerAxis<DriveCommand>) {
        self.last = drives[0];
        self.plant.tick(drives, &SpindleCommand::default(), None);
        self.measurement = *self.plant.measurement();
        (self.change)(&mut self.measurement);
    }
}

fn refused(machine: &Machine, change: impl FnMut(&mut Measurement)) -> Refusal {
    let mut bench = Changed::new(machine, change);
    let refusal = tune(&mut bench, Axis::X, machine).map(|_| ()).expect_err("it cannot be tuned");
    assert_eq!(bench.last.control_word, ControlWord::DisableVoltage as u32, "{refusal}");
    refusal
}

fn with(change: impl FnOnce(&mut Machine)) -> Machine {
    let mut machine = Machine::plain();
    change(&mut machine);
    machine
}

fn x(machine: &mut Machine) -> &mut machine::AxisConfig {
    machine.axis.get_mut(&Axis::X).expect("the lathe has an X")
}

fn plant(machine: &mut Machine, key: &str, value: f64) {
    machine.plant["axis"]["x"][key] = toml::Value::Float(value);
}

fn says(refusal: &Refusal, words: &str) {
    assert!(refusal.to_string().contains(words), "{refusal}");
}

#[test]
fn an_axis_that_does_not_exist() {
    let machine = Machine::plain();
    let mut bench = Changed::new(&machine, |_| ());
    let refusal = tune(&mut bench, Axis::Y, &machine).map(|_| ()).expect_err("there is no Y");
    says(&refusal, "add [axis.y]");
}

#[test]
fn too_little_travel() {
    let machine = with(|machine| x(machine).travel_mm = [57.0, 63.0]);
    let mut bench = Changed::new(&machine, |_| ());
    let refusal = tune(&mut bench, Axis::X, &machine).map(|_| ()).expect_err("there is no room");
    says(&refusal, "X has 3.0 mm of travel to one side and needs 6.0");
}

#[test]
fn a_little_travel_is_enough() {
    let machine = with(|machine| x(machine).travel_mm = [54.0, 70.0]);
    let mut bench = Changed::new(&machine, |_| ());
    let found = tune(&mut bench, Axis::X, &machine).expect("there is room");
    assert!((found.mass_kg.value / 2005.0 - 1.0).abs() < 0.01, "{:?}", found.mass_kg);
    assert!((found.coulomb_n.value / 270.0 - 1.0).abs() < 0.05, "{:?}", found.coulomb_n);
    let proposal = found.proposal;
    assert!((65.0..80.0).contains(&proposal.velocity_bandwidth_hz), "{proposal:?}");
    assert!((110.0..145.0).contains(&proposal.position_gain_1_s), "{proposal:?}");
}

/// On a slow run friction turns with the speed, and the response is not that of the axis.
#[test]
fn a_response_by_which_the_present_loops_would_swing() {
    let machine = with(|machine| x(machine).velocity_mm_s = 30.0);
    says(&refused(&machine, |_| ()), "the frequency response of X cannot be used");
}

#[test]
fn a_slow_axis_stays_within_its_travel() {
    let machine = with(|machine| {
        let x = x(machine);
        (x.acceleration_mm_s2, x.jerk_mm_s3, x.jerk_rate_mm_s4) = (50.0, 20.0, 2000.0);
        x.travel_mm = [9.0, 111.0];
    });
    let [mut low, mut high] = [f64::INFINITY, f64::NEG_INFINITY];
    // Friction is nearly all of what its test moves need, so they hardly tell its mass.
    let refusal = refused(&machine, |seen| {
        let at = seen.axes[0].position.mm();
        (low, high) = (low.min(at), high.max(at));
    });
    says(&refusal, "X: mass_kg came out as");
    assert!(low > 9.0 && high < 111.0, "{low} to {high}");
}

#[test]
fn an_axis_that_stands_still() {
    let stuck = Position::from_mm(60.0);
    let refusal = refused(&Machine::plain(), |seen| seen.axes[0].position = stuck);
    says(&refusal, "X did not move");
}

#[test]
fn torque_at_its_limit() {
    let weak = with(|machine| x(machine).torque_limit_nm = 0.8);
    says(&refused(&weak, |_| ()), "the torque of X was at its limit of 0.8 N·m");
}

/// The drive cuts at its limit, but shows less: its loop is not the one that was reckoned with.
#[test]
fn a_command_at_its_limit() {
    let weak = with(|machine| x(machine).torque_limit_nm = 0.8);
    let refusal = refused(&weak, |seen| seen.axes[0].torque_nm = seen.axes[0].torque_nm.clamp(-0.7, 0.7));
    says(&refusal, "the torque of X was at its limit of 0.8 N·m");
}

#[test]
fn loops_that_swing() {
    let light = with(|machine| {
        plant(machine, "inertia_kg_m2", 2e-4);
        plant(machine, "slide_mass_kg", 60.0);
    });
    let refusal = refused(&light, |_| ());
    says(&refusal, "lower velocity_bandwidth_hz");
}

#[test]
fn a_drive_in_fault() {
    let mut cycles = 0;
    let refusal = refused(&Machine::plain(), |seen| {
        cycles += 1;
        if cycles > 500 {
            seen.axes[0].status_word = u32::from(StatusWord::of(DriveState::Fault).0);
        }
    });
    says(&refusal, "the drive of X is in state Fault at 0.2");
}

#[test]
fn a_drive_that_does_not_come_into_operation() {
    let refusal = refused(&Machine::plain(), |seen| {
        seen.axes[0].status_word = u32::from(StatusWord::of(DriveState::SwitchedOn).0);
    });
    says(&refusal, "the drive of X is in state SwitchedOn at 2.0");
}

#[test]
fn torque_that_is_not_measured() {
    let refusal = refused(&Machine::plain(), |seen| seen.axes[0].torque_nm = 0.0);
    assert!(matches!(refusal, Refusal::Untold(Axis::X, ..)), "{refusal}");
}

#[test]
fn torque_in_another_unit() {
    let refusal = refused(&Machine::plain(), |seen| seen.axes[0].torque_nm *= 0.5);
    says(&refusal, "gain of the torque came out as 0.");
    let Refusal::Implausible(.., gain, _, _) = refusal else { panic!("{refusal}") };
    assert!((gain - 0.5).abs() < 1e-3, "{refusal}");
}

/// Measurements are a cycle old and commands act a cycle later, and nobody has said so.
#[test]
fn a_bus_that_is_not_believed() {
    let bus = with(|machine| {
        let truth = "input_cycles = 1\noutput_cycles = 1".parse().expect("a table");
        machine.plant.insert("bus".into(), toml::Value::Table(truth));
    });
    says(&refused(&bus, |_| ()), "check input_cycles and output_cycles of [bus] first");
}

#[test]
fn measurements_that_are_no_numbers() {
    let refusal = refused(&Machine::plain(), |seen| seen.axes[0].torque_nm = f64::NAN);
    says(&refusal, "the torque of X");
}

#[test]
fn margins_that_no_gain_reaches() {
    let machine = Machine::plain();
    let mut bench = Changed::new(&machine, |_| ());
    let goals = Goals { velocity_phase_deg: 100.0, ..Goals::default() };
    let refusal =
        tune_towards(&mut bench, Axis::X, &machine, &goals).expect_err("the integral alone takes 14°");
    says(&refusal, "no gain of the velocity loop reaches a phase margin of 100°");
}
