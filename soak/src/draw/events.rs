//! What happens in a case. In: a seed, the machine, and what the program does undisturbed: how long it takes
//! and the cycles in which a state changes. Out: no event to four, mostly one, at any cycle, half of them
//! near a border.

use machine::Machine;
use protocol::{Axis, Module};
use testing::Seed;

use crate::event::{Button, Channel, Event, Fate, SpindleFault, Trouble, What};

/// Cycles around a border in which half of the events lie.
const NEAR: u64 = 15;

/// The events of a case.
pub(crate) fn events(seed: &mut Seed, machine: &Machine, cycles: u64, borders: &[u64]) -> Vec<Event> {
    let count = match seed.below(100) {
        0..8 => 0,
        8..78 => 1,
        78..92 => 2,
        92..97 => 3,
        _ => 4,
    };
    let mut events: Vec<Event> = (0..count)
        .map(|_| Event { at: moment(seed, cycles, borders), what: what(seed, machine, cycles) })
        .collect();
    events.sort_by_key(|event| event.at);
    events
}

fn moment(seed: &mut Seed, cycles: u64, borders: &[u64]) -> u64 {
    if borders.is_empty() || seed.chance(0.5) {
        return 1 + seed.within(0..cycles);
    }
    let border = borders[seed.below(borders.len())] + seed.within(0..2 * NEAR);
    border.saturating_sub(NEAR).max(1)
}

fn what(seed: &mut Seed, machine: &Machine, cycles: u64) -> What {
    let lathe = machine.axis.contains_key(&Axis::Z);
    match seed.below(100) {
        0..24 => What::Press(button(seed)),
        24..46 => packet(seed, machine),
        46..54 => What::Kill(module(seed, machine)),
        54..62 => What::Freeze(module(seed, machine), frozen(seed, machine, cycles)),
        62..70 => What::Plant(drive(seed, machine)),
        _ if lathe && !machine.spindle.is_none() => What::Plant(trouble(seed, machine)),
        _ => What::Press(button(seed)),
    }
}

fn button(seed: &mut Seed) -> Button {
    match seed.below(12) {
        0..3 => Button::Hold(seed.within(1..1500)),
        3 => Button::Start,
        4 => Button::Stop,
        5 => Button::Abort,
        6 | 7 => Button::EmergencyStop,
        8 => Button::SingleBlock(seed.within(50..600)),
        9 => Button::Spindle(seed.between(40.0, 130.0)),
        10 => Button::Feed(seed.between(20.0, 150.0)),
        _ => Button::Rapid(seed.between(20.0, 100.0)),
    }
}

fn axis(seed: &mut Seed, machine: &Machine) -> Axis {
    let axes: Vec<Axis> = machine.axes().map(|(axis, _)| axis).collect();
    axes[seed.below(axes.len())]
}

fn module(seed: &mut Seed, machine: &Machine) -> Module {
    match seed.below(5) {
        0 => Module::Interpreter,
        1 | 2 => Module::Interpolator,
        _ => Module::Regulator(axis(seed, machine)),
    }
}

/// How long a module stands still, s: some cycles, or for ever.
fn frozen(seed: &mut Seed, machine: &Machine, cycles: u64) -> Option<f64> {
    let cycles = match seed.below(3) {
        0 => return None,
        1 => seed.within(1..12),
        _ => seed.within(1..cycles.max(2)),
    };
    Some(cycles as f64 * machine.general.cycle_s)
}

fn packet(seed: &mut Seed, machine: &Machine) -> What {
    let axis = axis(seed, machine);
    let channel = match seed.below(10) {
        0 => Channel::Code,
        1 => Channel::Ticks,
        2 => Channel::Spindle,
        3 => Channel::Measurements,
        4 => Channel::Measurement(axis),
        5 | 6 => Channel::Drive(axis),
        7 => Channel::Status(axis),
        _ => Channel::Frame(axis),
    };
    let fate = match seed.below(6) {
        0 => Fate::Drop,
        1 => Fate::Delay(1 + seed.below(12) as u32),
        2 => Fate::Duplicate,
        3 => Fate::Reorder,
        _ => Fate::Corrupt(seed.below(1 << 16) as u32),
    };
    // One message, some, many.
    let count = match seed.below(4) {
        0 | 1 => 1,
        2 => seed.within(2..12),
        _ => seed.within(12..400),
    };
    What::Packet(channel, fate, count)
}

/// What breaks at an axis, or everywhere.
fn drive(seed: &mut Seed, machine: &Machine) -> Trouble {
    let axis = axis(seed, machine);
    let sign = if seed.chance(0.5) { 1.0 } else { -1.0 };
    match seed.below(8) {
        0..2 => Trouble::DriveFault(axis),
        2..4 => Trouble::TorqueLost(axis),
        4 => Trouble::PowerLost,
        5 => Trouble::Jump(axis, sign * seed.scale(0.001, 1.0)),
        _ => Trouble::Spike(axis, sign * seed.scale(100.0, 5000.0), seed.scale(0.0005, 0.02)),
    }
}

fn trouble(seed: &mut Seed, machine: &Machine) -> Trouble {
    let turn = machine.spindle_counts();
    let sign = if seed.chance(0.5) { 1.0 } else { -1.0 };
    let axis = if seed.chance(0.5) { Axis::X } else { Axis::Z };
    let fault = match seed.below(4) {
        0 => SpindleFault::Runaway,
        1 => SpindleFault::Reversal,
        2 => SpindleFault::Stall,
        _ => SpindleFault::Jam,
    };
    match seed.below(16) {
        0 | 1 => Trouble::Dip(seed.between(5.0, 40.0), seed.between(0.02, 0.3)),
        2 => Trouble::Load(seed.between(70.0, 150.0), seed.between(0.1, 0.6)),
        3 | 4 => Trouble::Spindle(fault, seed.scale(0.02, 2.0)),
        5 => Trouble::Force(axis, sign * seed.scale(50.0, 2000.0), seed.between(0.005, 0.2)),
        6 | 7 => Trouble::Counts(nonzero(sign * seed.scale(1.0, 60.0))),
        8 => Trouble::Counts(nonzero(sign * seed.scale(1.0, 0.5 * turn))),
        9 | 10 => Trouble::Glitch(nonzero(sign * seed.scale(2.0, 2.0 * turn)), seed.between(0.001, 0.05)),
        11 | 12 => Trouble::IndexLost(seed.scale(0.01, 1.0)),
        13 => Trouble::Stands(if seed.chance(0.5) { None } else { Some(seed.scale(0.001, 0.5)) }),
        14 => Trouble::Noise(1 + seed.below(6) as u32),
        _ => Trouble::Eccentricity(seed.between(1.0, 20.0)),
    }
}

fn nonzero(counts: f64) -> i64 {
    if counts < 0.0 { counts.min(-1.0) as i64 } else { counts.max(1.0) as i64 }
}
