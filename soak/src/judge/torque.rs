//! Who takes the torque of an axis. In: the events of a case. Out: whether one of them explains that an axis
//! has no torque in a cycle: its drive fails, its regulator dies or hangs, commands to its drive or
//! measurements do not arrive, its encoder jumps farther than a drive may turn, the mains are away for longer
//! than the link holds. A regulator that faults explains nothing: it has to take the tool out first.

use machine::Machine;
use protocol::{Axis, Module};

use super::{Known, excuse::in_truth};
use crate::event::{Channel, Event, Fate, Trouble, What};

/// How long the link holds, where a machine does not say, s: as the plant takes it.
const LINK_HOLD_S: f64 = 0.1;
/// And where a drive trips, mm/s.
const OVERSPEED_MM_S: f64 = 290.0;
/// So many cycles in a row without a command, and a drive trips: as the plant takes it.
const LOST_COMMANDS: u64 = 12;

/// Whether an event explains that an axis has no torque in a cycle.
pub(crate) fn is_explained(known: &Known, axis: Axis, now: u64) -> bool {
    let events = || known.events.iter().filter(|event| now >= event.at);
    let lost: u64 = events().map(|event| lost(event, axis)).sum();
    lost >= LOST_COMMANDS || events().any(|event| takes(known.machine, event, axis, now))
}

/// How many commands in a row the drive of an axis has to do without.
fn lost(event: &Event, axis: Axis) -> u64 {
    match event.what {
        What::Packet(Channel::Measurements, fate, count) => gap(fate, count),
        What::Packet(Channel::Drive(disturbed) | Channel::Measurement(disturbed), fate, count)
            if disturbed == axis =>
        {
            gap(fate, count)
        }
        _ => 0,
    }
}

fn takes(machine: &Machine, event: &Event, axis: Axis, now: u64) -> bool {
    match event.what {
        What::Plant(Trouble::DriveFault(broken) | Trouble::TorqueLost(broken)) => broken == axis,
        What::Plant(Trouble::Jump(jumped, mm)) => jumped == axis && trips(machine, axis, mm),
        What::Plant(Trouble::PowerLost) => now >= event.at + link_hold_cycles(machine),
        What::Kill(module) | What::Freeze(module, _) => module == Module::Regulator(axis),
        _ => false,
    }
}

/// Whether a jump of the encoder of an axis looks to its drive like more than it may turn.
fn trips(machine: &Machine, axis: Axis, mm: f64) -> bool {
    let overspeed = in_truth(machine, axis, "overspeed_mm_s", OVERSPEED_MM_S);
    let fastest = machine.axis.get(&axis).map_or(0.0, |config| config.velocity_mm_s);
    mm.abs() / machine.general.cycle_s + fastest > overspeed
}

/// For how many cycles in a row nothing new arrives: late messages come again, one behind the other.
fn gap(fate: Fate, count: u64) -> u64 {
    match fate {
        Fate::Drop | Fate::Corrupt(_) => count,
        Fate::Delay(cycles) => count.min(u64::from(cycles)),
        Fate::Reorder => 1,
        Fate::Duplicate => 0,
    }
}

/// So long the drives have torque without mains, control cycles.
pub(crate) fn link_hold_cycles(machine: &Machine) -> u64 {
    let power = machine.plant.get("power").and_then(|table| table.get("link_hold_s"));
    let hold_s = power.and_then(toml::Value::as_float).unwrap_or(LINK_HOLD_S);
    (hold_s / machine.general.cycle_s).round() as u64
}
