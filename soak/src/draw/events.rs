//! What happens in a case. In: a seed, the machine, and what the program does undisturbed: how long it takes and
//! the cycles in which a state changes. Out: no event to four, mostly one, at any cycle, half of them near a
//! border.

use machine::Machine;
use protocol::{Axis, Module};
use rig::wires::Wire;
use testing::Seed;

use crate::event::{Button, Event, Fate, Trouble, What};

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
        0..30 => What::Press(button(seed)),
        30..56 => wire(seed, machine),
        56..66 => What::Kill(module(seed, machine)),
        66..76 => What::Freeze(module(seed, machine), frozen(seed, cycles)),
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

/// How long a module stands still: some cycles, or for ever.
fn frozen(seed: &mut Seed, cycles: u64) -> Option<u64> {
    match seed.below(3) {
        0 => None,
        1 => Some(seed.within(1..12)),
        _ => Some(seed.within(1..cycles.max(2))),
    }
}

fn wire(seed: &mut Seed, machine: &Machine) -> What {
    let axis = axis(seed, machine);
    let wire = match seed.below(9) {
        0 => Wire::Code,
        1 => Wire::TickMeasurement,
        2 => Wire::Spindle,
        3 | 4 => Wire::Measurement(axis),
        5 => Wire::Drive(axis),
        6 => Wire::Status(axis),
        _ => Wire::Frame(axis),
    };
    let fate = match seed.below(6) {
        0 => Fate::Drop,
        1 => Fate::Delay(1 + seed.below(6) as u32),
        2 => Fate::Duplicate,
        3 => Fate::Reorder,
        _ => Fate::Corrupt(seed.below(1 << 16) as u32),
    };
    // One message, some, a long time; a wire that carries one a tick needs more cycles for as many.
    let messages = match seed.below(4) {
        0 | 1 => 1,
        2 => seed.within(2..12),
        _ => seed.within(12..400),
    };
    What::Wire { wire, fate, cycles: messages * machine.cycles_per_tick() }
}

fn trouble(seed: &mut Seed, machine: &Machine) -> Trouble {
    let turn = machine.spindle_counts();
    let sign = if seed.chance(0.5) { 1.0 } else { -1.0 };
    let axis = if seed.chance(0.5) { Axis::X } else { Axis::Z };
    match seed.below(8) {
        0 => Trouble::Dip(seed.between(5.0, 40.0), seed.between(0.02, 0.3)),
        1 => Trouble::Stall(seed.between(70.0, 150.0), seed.between(0.1, 0.6)),
        2 => Trouble::Force(axis, sign * seed.scale(50.0, 2000.0), seed.between(0.005, 0.2)),
        3 => Trouble::Counts((sign * seed.scale(1.0, 60.0)) as i64),
        4 => Trouble::Counts((sign * seed.scale(1.0, 0.5 * turn)) as i64),
        5 => Trouble::Glitch((sign * seed.scale(2.0, 2.0 * turn)) as i64, seed.between(0.001, 0.05)),
        _ => Trouble::IndexLost(seed.scale(0.01, 1.0)),
    }
}
