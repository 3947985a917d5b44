//! Random machines, within what a machine file allows and a builder would build. In: a seed, where the axes
//! shall stand. Out: a [`Machine`]. Limits, cycles, encoders, what is believed and what is true vary; the
//! loops are those of the machine it was made from, slower where the cycle is longer.

use std::sync::LazyLock;

use machine::{AxisConfig, Kinematics, Machine, PLAIN_LATHE, POSITIONER, Reaction, RunOut, SMALL_MILL};
use protocol::Axis;
use testing::Seed;
use toml::{Table, Value};

use super::shop::shop;

/// rad/s in one 1/min.
const RAD_S: f64 = core::f64::consts::TAU / 60.0;
/// Torque of the spindle drive in the built-in file, N·m, and the share of it that a ramp takes.
const PEAK_NM: f64 = 60.0;
const RAMP_SHARE: f64 = 0.6;

/// What the machines are made from, read once.
static LATHE: LazyLock<Machine> = LazyLock::new(|| read(PLAIN_LATHE));
static MILL: LazyLock<Machine> = LazyLock::new(|| read(SMALL_MILL));
static POSITIONING: LazyLock<Machine> = LazyLock::new(|| read(POSITIONER));

/// One of these with probability 1/n each.
fn one_of(seed: &mut Seed, list: &[f64]) -> f64 {
    list[seed.below(list.len())]
}

/// A lathe whose axes stand at X, Z; with a short travel, so that the plant keeps little of the part.
pub(super) fn lathe(seed: &mut Seed, x_mm: f64, z_mm: f64) -> Machine {
    let mut machine = LATHE.clone();
    for (axis, home_mm, reach) in [(Axis::X, x_mm, 45.0), (Axis::Z, z_mm, 60.0)] {
        if let Some(config) = machine.axis.get_mut(&axis) {
            config.home_mm = home_mm;
            config.travel_mm = [(home_mm - reach).floor(), (home_mm + reach).ceil()];
        }
    }
    let ramp = seed.scale(2000.0, 8000.0).round();
    let inertia = (PEAK_NM * RAMP_SHARE / (ramp * RAD_S)).min(0.15);
    machine.spindle.ramp_rpm_s = ramp;
    machine.spindle.encoder_lines = one_of(seed, &[500.0, 1024.0, 2500.0, 2500.0, 5000.0, 9000.0]) as u32;
    plant(&mut machine, "spindle", "inertia_kg_m2", inertia);
    plant(&mut machine, "spindle", "peak_power_kw", 15.0);
    plant(&mut machine, "spindle", "ripple_pct", seed.between(0.0, 0.5));
    let threading = &mut machine.threading;
    threading.design_override_pct = one_of(seed, &[100.0, 110.0, 120.0, 120.0, 130.0]);
    threading.limit_share_pct = one_of(seed, &[70.0, 80.0, 90.0, 90.0]);
    threading.run_out = if seed.chance(0.2) { RunOut::Beyond } else { RunOut::Within };
    let mut reaction = || if seed.chance(0.5) { Reaction::Finish } else { Reaction::Leave };
    (threading.on_hold, threading.on_stop, threading.on_fault) = (reaction(), reaction(), reaction());
    threading.lift_mm = seed.between(0.5, 3.0);
    what_all_have(seed, &mut machine);
    if seed.chance(0.2) {
        worn(seed, &mut machine);
    }
    // A branch of the seed: what follows draws what it would without.
    let branch = &mut Seed::new(!seed.clone().next());
    if branch.chance(0.5) {
        shop(branch, &mut machine);
    }
    machine
}

pub(super) fn mill(seed: &mut Seed) -> Machine {
    let mut machine = MILL.clone();
    machine.spindle.ramp_rpm_s = 6000.0;
    calm(&mut machine);
    what_all_have(seed, &mut machine);
    machine
}

pub(super) fn positioner(seed: &mut Seed) -> Machine {
    let mut machine = POSITIONING.clone();
    calm(&mut machine);
    what_all_have(seed, &mut machine);
    machine
}

/// Heavy slides on soft screws swing at the gains of the built-in files once their mass is believed 5 %
/// higher.
fn calm(machine: &mut Machine) {
    machine.axis.values_mut().for_each(|config| config.position_gain_1_s *= 0.6);
}

fn read(text: &str) -> Machine {
    Machine::from_toml(text).expect("the built-in machine files are tested")
}

/// What every machine has: cycles, limits, beliefs.
fn what_all_have(seed: &mut Seed, machine: &mut Machine) {
    // The slides of the others swing so that their loops do not take a millisecond.
    let longest = if machine.general.kinematics == Kinematics::Lathe { 0.001 } else { 0.000_5 };
    let cycle_s = one_of(seed, &[0.000_25, 0.000_5, 0.000_5, 0.000_5, 0.000_5, longest]);
    let ticks = one_of(seed, &[1.0, 2.0, 4.0, 4.0, 4.0, 8.0]);
    machine.general.name = "soak".into();
    let slower = (cycle_s / 0.000_5_f64).max(1.0);
    machine.general.cycle_s = cycle_s;
    // Feedforward looks one and a half cycles and the lag of the current ahead.
    machine.general.interpolator_cycle_s =
        cycle_s * if cycle_s < 0.000_5 { ticks.max(4.0) } else { ticks.max(2.0) };
    for config in machine.axis.values_mut() {
        axis(seed, config, slower, cycle_s);
    }
}

fn axis(seed: &mut Seed, config: &mut AxisConfig, slower: f64, cycle_s: f64) {
    let share = seed.between(0.5, 1.0);
    config.velocity_mm_s = (config.velocity_mm_s * share).round();
    config.acceleration_mm_s2 = (config.acceleration_mm_s2 * seed.between(0.5, 1.0)).round();
    config.jerk_mm_s3 = (config.jerk_mm_s3 * seed.between(0.5, 1.0)).round();
    config.position_gain_1_s /= slower;
    config.velocity_bandwidth_hz /= slower;
    config.velocity_integral_s *= slower;
    config.velocity_lead_s = -0.5 * cycle_s;
    config.acceleration_lead_s = 1.5 * cycle_s + 0.000_5;
    config.mass_kg = (config.mass_kg * seed.between(0.95, 1.05)).round();
    let friction = seed.between(0.7, 1.2);
    config.coulomb_n = (config.coulomb_n * friction).round();
}

/// Backlash and a wobbling screw, almost as somebody measured them.
fn worn(seed: &mut Seed, machine: &mut Machine) {
    for axis in [Axis::X, Axis::Z] {
        let backlash_mm = (seed.between(2.0, 15.0)).round() / 1000.0;
        if let Some(config) = machine.axis.get_mut(&axis) {
            config.backlash_mm = (backlash_mm - 0.001).max(0.0);
            config.position_gain_1_s = config.position_gain_1_s.min(40.0);
        }
        axis_truth(machine, axis, "backlash_mm", backlash_mm);
        axis_truth(machine, axis, "screw_wobble_um", seed.between(0.0, 1.0));
    }
}

pub(super) fn plant(machine: &mut Machine, section: &str, key: &str, value: impl Into<Value>) {
    let section = machine.plant.entry(section).or_insert_with(|| Value::Table(Table::new()));
    if let Value::Table(table) = section {
        table.insert(key.into(), value.into());
    }
}

pub(super) fn axis_truth(machine: &mut Machine, axis: Axis, key: &str, value: impl Into<Value>) {
    let axes = machine.plant.get_mut("axis").and_then(Value::as_table_mut);
    let table = axes.and_then(|axes| axes.get_mut(axis.name())).and_then(Value::as_table_mut);
    if let Some(table) = table {
        table.insert(key.into(), value.into());
    }
}
