//! What an ordinary lathe of a shop adds to a plain one, and what its controller has been told of it. In: a
//! seed, a machine. Out: the machine with some of it. Each is there in every other machine, between 0 and 1.5
//! times as large as in the built-in shop lathe; what is believed is right to a fifth, as in that file.

use machine::{Bus, Machine};
use protocol::Axis;
use testing::Seed;

use super::machines::{axis_truth, plant};

/// The name of such a machine.
pub(crate) const SHOP: &str = "shop-lathe";

/// No size is more than so many times that of the built-in shop lathe.
const MOST: f64 = 1.5;
/// What is believed is wrong by no more than this share.
const ROUGHLY: f64 = 0.2;
/// And the phase of cogging by no more than this, degrees.
const BESIDE_DEG: f64 = 10.0;
/// A bus takes fewer cycles than this in a direction. In so many machines the controller was told any number.
const BUS_CYCLES: usize = 3;
const MISTOLD: f64 = 0.1;
/// Of quotients of cycles.
const ROUNDING: f64 = 1e-9;

/// Nothing, or a share of what the built-in shop lathe has.
fn size(seed: &mut Seed) -> f64 {
    if seed.chance(0.5) { seed.between(0.0, MOST) } else { 0.0 }
}

/// What somebody believes to whom this was told.
fn told(seed: &mut Seed, truth: f64) -> f64 {
    truth * (1.0 + ROUGHLY * seed.signed())
}

/// Adds what a shop adds.
pub(super) fn shop(seed: &mut Seed, machine: &mut Machine) {
    machine.general.name = SHOP.into();
    bus(seed, machine);
    spindle(seed, machine);
    for axis in [Axis::X, Axis::Z] {
        motor(seed, machine, axis);
        screw(seed, machine, axis);
        if let Some(config) = machine.axis.get_mut(&axis) {
            config.mode_hz = seed.chance(0.5).then(|| told(seed, 100.0).round());
            config.learning = seed.chance(0.5);
        }
    }
    weight(seed, machine);
}

/// A bus in both directions; and an interpolator cycle that reaches as far ahead as feedforward looks then.
fn bus(seed: &mut Seed, machine: &mut Machine) {
    let mut under_way = |key: &str| {
        let cycles = seed.below(BUS_CYCLES) as u32;
        plant(machine, "bus", key, i64::from(cycles));
        if seed.chance(MISTOLD) { seed.below(BUS_CYCLES) as u32 } else { cycles }
    };
    machine.bus = Bus { input_cycles: under_way("input_cycles"), output_cycles: under_way("output_cycles") };
    let cycle_s = machine.general.cycle_s;
    let looks_s = machine.axes().map(|(_, axis)| axis.acceleration_lead_s).fold(0.0, f64::max);
    let reach = looks_s / cycle_s - 1.0 + f64::from(machine.bus.output_cycles);
    let ticks = (machine.cycles_per_tick() as f64).max((reach - ROUNDING).ceil());
    machine.general.interpolator_cycle_s = ticks * cycle_s;
}

/// Uneven in three ways, with an encoder that is eccentric, unevenly divided, and samples late.
fn spindle(seed: &mut Seed, machine: &mut Machine) {
    let ripple_pct = [0.2, 0.1, 0.05].map(|pct| pct * size(seed));
    plant(machine, "spindle", "ripple_pct", ripple_pct.to_vec());
    plant(machine, "spindle", "ripple_per_rev", vec![2, 1, 6]);
    let errors = [[1.0, 20.0 * size(seed)], [2.0, 8.0 * size(seed)]];
    plant(machine, "spindle", "encoder_error_arcsec", errors.map(|row| row.to_vec()).to_vec());
    plant(machine, "spindle", "index_jitter_s", 1e-6 * size(seed));
    let delay_s = 2e-5 * size(seed);
    plant(machine, "spindle", "encoder_delay_s", delay_s);
    machine.spindle.encoder_delay_s = told(seed, delay_s);
}

/// A motor that cogs, gives another torque than its drive believes, and less when it is warm or fast.
fn motor(seed: &mut Seed, machine: &mut Machine, axis: Axis) {
    let more = if seed.chance(0.5) { 5.0 } else { -5.0 };
    let more_pct = more * size(seed);
    axis_truth(machine, axis, "torque_constant_pct", more_pct);
    cogging(seed, machine, axis, 1.0 + more_pct / 100.0);
    axis_truth(machine, axis, "torque_noise_nm", 0.01 * size(seed));
    axis_truth(machine, axis, "torque_step_nm", 0.00477 * size(seed));
    let limit_nm = machine.axis.get(&axis).map_or(0.0, |config| config.torque_limit_nm);
    axis_truth(machine, axis, "torque_limit_nm", limit_nm * (1.0 - 0.05 * size(seed)));
    if seed.chance(0.5) {
        let none_mm_s = seed.between(300.0, 500.0);
        axis_truth(machine, axis, "full_torque_mm_s", none_mm_s / 1.4);
        axis_truth(machine, axis, "no_torque_mm_s", none_mm_s);
    }
}

/// So often a turn, with a torque so much more than its drive believes; perhaps told, as the drive has it.
fn cogging(seed: &mut Seed, machine: &mut Machine, axis: Axis, more: f64) {
    let (per_rev, nm, deg) = ([12, 24, 24, 36][seed.below(4)], 0.05 * size(seed), 360.0 * seed.signed());
    axis_truth(machine, axis, "cogging_per_rev", per_rev);
    axis_truth(machine, axis, "cogging_nm", nm);
    axis_truth(machine, axis, "cogging_deg", deg);
    if let Some(config) = machine.axis.get_mut(&axis).filter(|_| seed.chance(0.5)) {
        let times = per_rev as f64;
        let home_deg = 360.0 * times * config.home_mm / config.screw_lead_mm;
        let phase_deg = (deg - home_deg + BESIDE_DEG * seed.signed()) % 360.0;
        config.cogging = vec![[times, told(seed, nm / more), phase_deg]];
    }
}

/// A screw that breaks away and is a little longer than it should be; a home that was measured in haste.
fn screw(seed: &mut Seed, machine: &mut Machine, axis: Axis) {
    axis_truth(machine, axis, "screw_static_n", 150.0 + 40.0 * size(seed));
    axis_truth(machine, axis, "screw_bristle_n_s_mm", 48.0 * size(seed));
    axis_truth(machine, axis, "slide_bristle_n_s_mm", 8.0 * size(seed));
    let longer = 6e-5 * MOST * seed.signed();
    let believed = told(seed, longer);
    let Some(config) = machine.axis.get_mut(&axis) else { return };
    let lead_mm = config.screw_lead_mm;
    if seed.chance(0.5) {
        config.screw_error = config.travel_mm.map(|mm| [mm, 1000.0 * believed * mm]).to_vec();
    }
    if axis == Axis::X && seed.chance(0.5) {
        config.unload_mm = 0.008 * seed.between(0.0, MOST);
    }
    axis_truth(machine, axis, "screw_lead_mm", lead_mm * (1.0 + longer));
    axis_truth(machine, axis, "home_off_mm", 0.005 * MOST * seed.signed());
}

/// X on a bed that slants. More than the friction of its guide, so that it keeps the nut on its flank.
fn weight(seed: &mut Seed, machine: &mut Machine) {
    if seed.chance(0.5) {
        let gravity_n = 760.0 * if seed.chance(0.8) { -1.0 } else { 1.0 } * seed.between(0.5, MOST);
        axis_truth(machine, Axis::X, "gravity_n", gravity_n);
        if let Some(x) = machine.axis.get_mut(&Axis::X) {
            x.gravity_n = told(seed, gravity_n);
            x.backlash_mm = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use testing::Seed;

    use super::SHOP;
    use crate::draw::machines::lathe;

    /// Longest interpolator cycle of a lathe, s.
    const LONGEST_S: f64 = 0.005;

    #[test]
    fn half_of_the_lathes_stand_in_a_shop_and_what_it_adds_is_not_refused() {
        let mut shops = 0;
        for number in 0..400 {
            let machine = lathe(&mut Seed::of_case(number), 22.0, 10.0);
            if machine.general.name == SHOP && machine.general.interpolator_cycle_s <= LONGEST_S {
                machine.check().unwrap_or_else(|error| panic!("case {number}: {error}"));
            }
            shops += u64::from(machine.general.name == SHOP);
        }
        assert!((160..240).contains(&shops), "{shops} of 400");
    }
}
