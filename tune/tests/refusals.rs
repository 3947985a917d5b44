//! What cannot be tuned is refused by name, with what to do, and is left without power.

use protocol::{
    Axis, ControlWord, DriveCommand, DriveState, Machine, Measurement, PerAxis, Position, SpindleCommand,
    StatusWord,
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
    let mut machine = Machine::default();
    change(&mut machine);
    machine
}

fn x(machine: &mut Machine) -> &mut protocol::machine::AxisConfig {
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
    let machine = Machine::default();
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
}

#[test]
fn an_axis_that_stands_still() {
    let stuck = Position::from_mm(60.0);
    let refusal = refused(&Machine::default(), |seen| seen.axes[0].position = stuck);
    says(&refusal, "X did not move");
}

#[test]
fn torque_at_its_limit() {
    let weak = with(|machine| x(machine).torque_limit_nm = 0.8);
    says(&refused(&weak, |_| ()), "the torque of X was at its limit of 0.8 N·m");
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
    let refusal = refused(&Machine::default(), |seen| {
        cycles += 1;
        if cycles > 500 {
            seen.axes[0].status_word = u32::from(StatusWord::of(DriveState::Fault).0);
        }
    });
    says(&refusal, "the drive of X is in state Fault at 0.2");
}

#[test]
fn torque_that_is_not_measured() {
    let refusal = refused(&Machine::default(), |seen| seen.axes[0].torque_nm = 0.0);
    assert!(matches!(refusal, Refusal::Implausible(Axis::X, ..)), "{refusal}");
}

#[test]
fn torque_in_another_unit() {
    let refusal = refused(&Machine::default(), |seen| seen.axes[0].torque_nm *= 0.5);
    says(&refusal, "gain of the torque came out as 0.5");
}

#[test]
fn measurements_that_are_no_numbers() {
    let refusal = refused(&Machine::default(), |seen| seen.axes[0].torque_nm = f64::NAN);
    says(&refusal, "the torque of X");
}

#[test]
fn margins_that_no_gain_reaches() {
    let machine = Machine::default();
    let mut bench = Changed::new(&machine, |_| ());
    let goals = Goals { velocity_phase_deg: 100.0, ..Goals::default() };
    let refusal =
        tune_towards(&mut bench, Axis::X, &machine, &goals).expect_err("the integral alone takes 14°");
    says(&refusal, "no gain of the velocity loop reaches a phase margin of 100°");
}
