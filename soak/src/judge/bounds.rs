//! How long things may take: the machine's limits, not what it was seen to do. In: a machine, a pass. Out:
//! control cycles.

use machine::Machine;
use motion::Stroke;
use protocol::{Axis, ThreadPass};

/// A way out that begins while the tool still moves in takes longer than one from rest to rest; it turns
/// round first, with a jerk and a rate of jerk that are limited.
const TURNING: f64 = 2.5;
/// And so many control cycles: for a measurement, a drive, a servo that lags.
const LAG_CYCLES: u64 = 12;
/// Servo lag at the end of a way, s.
const LAG_S: f64 = 0.015;

/// Control cycles in which the tool has left the material, once its axes leave.
pub(crate) fn way_out(machine: &Machine, pass: &ThreadPass) -> u64 {
    let Some(x) = machine.axis.get(&Axis::X) else { return 0 };
    let law = pass.axis(Axis::X);
    let root = law.start.mm() + law.stroke_mm;
    let way = (pass.out.clear.mm() - root).abs().max((pass.out.clear.mm() - law.end.mm()).abs()).max(0.1);
    let s = TURNING * Stroke::shortest(way, &x.limits()) + LAG_S;
    (s / machine.general.cycle_s).ceil() as u64 + LAG_CYCLES + 3 * machine.cycles_per_tick()
}

/// Turns in which a spindle of so many 1/min that is told to stop stands: until it is told, until its ramp is
/// over, and what its loop swings over.
pub(crate) fn run_down_turns(machine: &Machine, rpm: f64) -> f64 {
    let told_s = machine.general.cycle_s * (20 + 5 * machine.cycles_per_tick()) as f64;
    1.15 * rpm * rpm / (120.0 * machine.spindle.ramp_rpm_s) + rpm.abs() / 60.0 * told_s + 0.5
}

/// Control cycles in which the axes of timed motion are at rest, once one of them has lost its torque.
pub(crate) fn stop(machine: &Machine) -> u64 {
    let slowest = machine.axes().fold(0.0, |slowest: f64, (_, axis)| {
        let ramp_s = axis.velocity_mm_s / axis.acceleration_mm_s2 + axis.acceleration_mm_s2 / axis.jerk_mm_s3;
        slowest.max(ramp_s)
    });
    (TURNING * slowest / machine.general.cycle_s).ceil() as u64 + LAG_CYCLES + 5 * machine.cycles_per_tick()
}

/// Control cycles in which a spindle that is told to stop stands, from its highest speed.
pub(crate) fn spindle_stop(machine: &Machine) -> u64 {
    let spindle = &machine.spindle;
    if spindle.is_none() {
        return 0;
    }
    let s = 2.0 * spindle.max_rpm * spindle.override_max_pct / 100.0 / spindle.ramp_rpm_s + 1.0;
    (s / machine.general.cycle_s).ceil() as u64
}
