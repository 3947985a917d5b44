//! What the physics of an event excuses. In: the events of a case and its machine. Out: by how much the tool
//! may be beside its groove in a cycle, because no control could know better; whether an event lets the
//! program be completed.
//!
//! | event | excuse |
//! |---|---|
//! | counts lost or gained, a glitch | as far as the encoder cannot see it before the next index: n/4N leads, for a turn and the way out |
//! | force | the slide gives way by F/k, k = m (2πf)², swings to twice that, and the servo to as much; what its impulse gives the axis, until the servo has caught it |
//! | a jump of an axis | as far as the axis could have moved, and the jerk of its drive |
//! | a spindle that is stopped harder than Z can brake | the way in which Z brakes, three times, and in which the observer learns of it |
//! | an encoder that stands, of a spindle so slow that it may be jammed | anything, until the drive has been waited for |
//! | an emergency stop, no mains | X on its way to depth comes to rest by time, while the spindle slows down |
//! | a spindle that changes its speed | the slide lags by a/(2πf)², and the servo by as much; over a bus of d s everybody goes on at the speed that an observer had learned, a d (t + d/2) |
//! | a spindle that runs away | no axis can follow a retract by its angle: the groove is as deep as at its deepest; where the pass brakes Z goes on as far as its drive cannot brake it |
//! | measurements, or commands to drives, that come late or not at all | half the way of a cycle |
//! | a command to a drive that is damaged | all its torque for a cycle |
//! | noise, eccentricity | their counts |
//! | an encoder that is not believed | what the spindle has turned otherwise than it would have at its speed |
//! | a load on the spindle | a count: at another speed its counts meet the mode of the slide otherwise |
//! | all others | none |

use std::ops::Range;

use machine::{AxisConfig, Machine};
use protocol::{Axis, AxisLaw, ThreadPass};

use crate::event::{Button, Channel, Event, Fate, SpindleFault, Trouble, What};

/// How much more a drive and its screw give way than the slide on them.
const SERVO: f64 = 3.0;
/// A force that comes at once makes a slide swing to twice what it gives way, and its screw to as much.
const SWING: f64 = 4.0;
/// Fastest change of a spindle's speed that an encoder must not be blamed for: top speed to rest in 50 ms.
const STALL_S: f64 = 0.05;

/// Slower than this, an encoder that stands may be that of a spindle that is jammed, 1/min; how long that may
/// be waited for, s.
const SEEN_RPM: f64 = 100.0;
const BLIND_S: f64 = 2.0;
/// Torque of the spindle drive in the built-in file, N·m.
const SPINDLE_NM: f64 = 60.0;

/// More counts at once are a glitch, which nobody follows.
const MOST_COUNTS: f64 = 30.0;
/// Control cycles from the start in which nobody holds an axis.
const UNSEEN_CYCLES: u64 = 60;
/// What an observer makes of noise and of a step, in its deviations, at the worst in a hundred thousand runs.
const NOISE: f64 = 4.5;
/// In so many s the loop of a spindle has forgotten a load.
pub(crate) const UNWINDS_S: f64 = 0.6;
/// What of an excuse is only estimated.
pub(crate) const SLACK: f64 = 2.0;

/// What is excused at a moment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Excuse {
    /// Error of the spindle angle, turns.
    pub(crate) turns: f64,
    /// Along Z and along X, mm.
    pub(crate) axial_mm: f64,
    pub(crate) radial_mm: f64,
    /// The groove may be as deep everywhere as at its deepest.
    pub(crate) deepest: bool,
}

/// The excuse of an event in a cycle. `out` is how long a way out takes, `turn` how long a turn, both cycles.
pub(crate) fn excuse(
    machine: &Machine,
    event: &Event,
    now: u64,
    pass: &ThreadPass,
    out: u64,
    turn: u64,
) -> Excuse {
    let lead_mm = pass.axis(Axis::Z).lead_mm.abs();
    let lead_mm_s = lead_mm * pass.s_rpm * pass.max_ratio.min(1.5) / 60.0;
    // Seen at half the programmed speed, too: the override.
    let per_cycle = 0.5 * pass.s_rpm / 60.0 * machine.spindle_counts() * machine.general.cycle_s;
    let fast = per_cycle > seen_counts(machine);
    let cycle_s = machine.general.cycle_s;
    if let What::Packet(channel, fate, count) = event.what {
        let until = event.at + 2 * count + out;
        return of_packets(machine, (channel, fate), event.at..until, now, lead_mm_s);
    }
    let stops = matches!(event.what, What::Press(Button::EmergencyStop) | What::Plant(Trouble::PowerLost));
    if stops && (event.at..event.at + out).contains(&now) {
        return Excuse { radial_mm: ahead_mm(machine, pass), ..Excuse::default() };
    }
    let What::Plant(trouble) = event.what else { return Excuse::default() };
    let until = |s: f64| event.at + (s / cycle_s) as u64;
    if now < event.at {
        return Excuse::default();
    }
    match trouble {
        Trouble::Counts(counts) => counts_excuse(machine, counts, now < event.at + 2 * turn + out),
        Trouble::Glitch(counts, s) => counts_excuse(machine, counts, now < until(s) + 2 * turn + out),
        Trouble::Force(axis, force_n, s) | Trouble::Spike(axis, force_n, s) => {
            let pushed_mm = pushed_mm(machine, axis, force_n.abs(), s);
            let pushed = SWING * force_n.abs() / stiffness_n_mm(machine, axis) + pushed_mm;
            let mm = sticks_mm(machine, axis) + if now < until(s + 0.1) { pushed } else { 0.0 };
            match axis {
                Axis::Z => Excuse { axial_mm: mm, ..Excuse::default() },
                _ => Excuse { radial_mm: mm, ..Excuse::default() },
            }
        }
        Trouble::Noise(counts) => {
            Excuse { turns: NOISE * f64::from(counts) / machine.spindle_counts(), ..Excuse::default() }
        }
        Trouble::Eccentricity(counts) => {
            // It comes at once: a step, and the observer swings over.
            let step = if now < event.at + turn { 2.0 } else { 1.0 };
            Excuse { turns: step * counts / machine.spindle_counts(), ..Excuse::default() }
        }
        Trouble::Stands(_) if !fast && now < until(BLIND_S) + out => {
            Excuse { axial_mm: f64::INFINITY, ..Excuse::default() }
        }
        Trouble::Spindle(SpindleFault::Runaway, s) if now < until(s) + out => {
            Excuse { deepest: true, ..Excuse::default() }
        }
        Trouble::Spindle(SpindleFault::Jam | SpindleFault::Reversal, s) if now < until(s) + out => {
            overrun(machine, lead_mm_s)
        }
        Trouble::Load(nm, s) if beyond(machine, nm, lead_mm) && now < until(s) + out => {
            overrun(machine, lead_mm_s)
        }
        // At another speed the counts of the encoder meet the mode of the slide otherwise.
        Trouble::Dip(_, s) | Trouble::Load(_, s) if now < until(s + UNWINDS_S) => {
            Excuse { turns: 0.5 / machine.spindle_counts(), ..Excuse::default() }
        }
        // Before anybody looks an axis is where its encoder says.
        Trouble::Jump(axis, mm) if event.at < UNSEEN_CYCLES => kicked(machine, axis, mm.abs()),
        Trouble::Jump(axis, mm) => jump(machine, axis, mm),
        _ => Excuse::default(),
    }
}

/// What messages excuse that are disturbed for so many cycles.
fn of_packets(
    machine: &Machine,
    (channel, fate): (Channel, Fate),
    lasts: Range<u64>,
    now: u64,
    lead_mm_s: f64,
) -> Excuse {
    match (channel, fate) {
        (Channel::Drive(axis), Fate::Corrupt(_)) if now >= lasts.start => kicked(machine, axis, 0.0),
        (Channel::Drive(_), Fate::Corrupt(_)) => Excuse::default(),
        (Channel::Measurements | Channel::Measurement(_) | Channel::Drive(_), _) if lasts.contains(&now) => {
            Excuse { axial_mm: 0.5 * lead_mm_s * machine.general.cycle_s, ..Excuse::default() }
        }
        _ => Excuse::default(),
    }
}

/// Whether Z would have to brake harder than it can to stay in the groove of a spindle that is loaded.
fn beyond(machine: &Machine, nm: f64, lead_mm: f64) -> bool {
    let spindle = machine.plant.get("spindle");
    let inertia =
        spindle.and_then(|table| table.get("inertia_kg_m2")).and_then(toml::Value::as_float).unwrap_or(0.15);
    let a = machine.axis.get(&Axis::Z).map_or(0.0, |z| z.acceleration_mm_s2);
    lead_mm / core::f64::consts::TAU * (nm + SPINDLE_NM) / inertia > 0.5 * a
}

/// Where an axis comes to rest behind a force: friction holds it beside its place.
fn sticks_mm(machine: &Machine, axis: Axis) -> f64 {
    machine.axis.get(&axis).map_or(0.0, |config| config.coulomb_n / config.presliding_n_mm)
}

/// How far a force moves an axis that is as light as its drive believes, until its velocity loop has caught
/// it.
fn pushed_mm(machine: &Machine, axis: Axis, force_n: f64, s: f64) -> f64 {
    let Some(config) = machine.axis.get(&axis) else { return 0.0 };
    let loop_s = 1.0 / (core::f64::consts::TAU * config.velocity_bandwidth_hz);
    1000.0 * force_n / config.mass_kg * s.min(loop_s) * loop_s
}

/// How far an axis at a speed, mm/s, goes on its brake with all the torque that its drive has, mm.
pub(crate) fn overshoot_mm(machine: &Machine, axis: Axis, v: f64) -> f64 {
    let Some(config) = machine.axis.get(&axis) else { return 0.0 };
    v * v / (2.0 * 1000.0 * force_n(config) / config.mass_kg)
}

/// What the motor of an axis can push with, N.
fn force_n(config: &AxisConfig) -> f64 {
    core::f64::consts::TAU * 1000.0 * config.torque_limit_nm / config.screw_lead_mm
}

/// Z comes to rest behind a spindle that has stopped dead: it brakes three times as far as it must, once the
/// observer has learned of it.
fn overrun(machine: &Machine, v: f64) -> Excuse {
    let brake_mm = machine.axis.get(&Axis::Z).map_or(0.0, |z| v * v / (2.0 * z.acceleration_mm_s2));
    Excuse { axial_mm: 3.0 * brake_mm + v * learned_s(machine), ..Excuse::default() }
}

/// In so many s the observer of a lead learns of a new speed.
fn learned_s(machine: &Machine) -> f64 {
    2.0 / (core::f64::consts::TAU * machine.spindle.observer_hz)
}

/// How long a bus takes there and back, s.
fn bus_s(machine: &Machine) -> f64 {
    let bus = machine.plant.get("bus");
    let cycles = |key: &str| bus.and_then(|bus| bus.get(key)).and_then(toml::Value::as_integer).unwrap_or(0);
    (cycles("input_cycles") + cycles("output_cycles")) as f64 * machine.general.cycle_s
}

/// How far X on its way to depth goes ahead of where the spindle has Z that is stopped meanwhile, mm: it
/// comes to rest by time, (M100) with 5.77 v/j T², and the spindle loses r T of its speed.
fn ahead_mm(machine: &Machine, pass: &ThreadPass) -> f64 {
    let Some(x) = machine.axis.get(&Axis::X) else { return 0.0 };
    let (limits, law) = (x.limits(), pass.axis(Axis::X));
    let v = steepest_mm(law) * pass.s_rpm / 60.0;
    let t = (1.875 * v / limits.a).max((5.77 * v / limits.j).sqrt());
    0.25 * v * t * (machine.spindle.ramp_rpm_s * t / pass.s_rpm).min(1.0)
}

/// A jump that the axis could have made is believed; a larger one makes the drive jump for a cycle with all
/// its torque, until its loop has caught it.
fn jump(machine: &Machine, axis: Axis, mm: f64) -> Excuse {
    let Some(config) = machine.axis.get(&axis) else { return Excuse::default() };
    let cycle_s = machine.general.cycle_s;
    kicked(machine, axis, mm.abs().min(10.0 * config.acceleration_mm_s2 * cycle_s * cycle_s))
}

/// The drive gives all its torque for a cycle, besides an error of its encoder that is believed.
fn kicked(machine: &Machine, axis: Axis, believed: f64) -> Excuse {
    let Some(config) = machine.axis.get(&axis) else { return Excuse::default() };
    let cycle_s = machine.general.cycle_s;
    let v = 1000.0 * force_n(config) / config.mass_kg * cycle_s;
    let mm = believed + 4.0 * v / (core::f64::consts::TAU * config.velocity_bandwidth_hz);
    match axis {
        Axis::Z => Excuse { axial_mm: mm, ..Excuse::default() },
        _ => Excuse { radial_mm: mm, ..Excuse::default() },
    }
}

fn counts_excuse(machine: &Machine, counts: i64, young: bool) -> Excuse {
    let turn = machine.spindle_counts();
    let unseen = (counts.unsigned_abs() as f64).min(seen_counts(machine));
    Excuse { turns: if young { 2.0 * unseen / turn } else { 0.0 }, ..Excuse::default() }
}

/// A jump of the count by more than this is seen at once (M70).
fn seen_counts(machine: &Machine) -> f64 {
    let (turn, cycle_s) = (machine.spindle_counts(), machine.general.cycle_s);
    let a = (machine.spindle.max_rpm / STALL_S).max(20_000.0) / 60.0 * turn;
    6.0 + a * cycle_s * cycle_s + 0.02 * machine.spindle.max_rpm / 60.0 * turn * cycle_s
}

/// What is true of the backlash of an axis, mm.
pub(crate) fn backlash_mm(machine: &Machine, axis: Axis) -> f64 {
    in_truth(machine, axis, "backlash_mm", 0.0)
}

/// The slide on its screw, N/mm.
fn stiffness_n_mm(machine: &Machine, axis: Axis) -> f64 {
    let rad_s = core::f64::consts::TAU * in_truth(machine, axis, "mode_hz", 100.0);
    in_truth(machine, axis, "slide_mass_kg", 110.0) * rad_s * rad_s / 1000.0
}

/// What the plant of a machine file says of an axis, or what it usually is.
pub(crate) fn in_truth(machine: &Machine, axis: Axis, key: &str, usual: f64) -> f64 {
    let truth = machine.plant.get("axis").and_then(|axes| axes.get(axis.name()));
    truth.and_then(|table| table.get(key)).and_then(toml::Value::as_float).unwrap_or(usual)
}

/// Whether the encoder of the spindle is not believed any more behind this, or may not be: the spindle is
/// taken to turn on as it did.
pub(crate) fn blinds(what: &What) -> bool {
    matches!(what, What::Plant(Trouble::Glitch(..) | Trouble::Stands(_)))
}

/// Whether that encoder counts wrongly behind this.
pub(crate) fn miscounts(what: &What) -> bool {
    blinds(what)
        || matches!(what, What::Plant(Trouble::Counts(_) | Trouble::IndexLost(_)))
        || matches!(what, What::Plant(Trouble::Noise(_) | Trouble::Eccentricity(_)))
}

/// Whether the spindle has just jammed.
pub(crate) fn jams(machine: &Machine, event: &Event, now: u64) -> bool {
    let over = event.at + (STALL_S / machine.general.cycle_s) as u64;
    matches!(event.what, What::Plant(Trouble::Spindle(SpindleFault::Jam, _)))
        && (event.at..=over).contains(&now)
}

/// Whether a program is completed although this happens.
pub(crate) fn is_harmless(what: &What) -> bool {
    match what {
        What::Press(button) => !matches!(button, Button::Stop | Button::Abort | Button::EmergencyStop),
        _ => false,
    }
}

/// Whether the operator ends the program by it.
pub(crate) fn is_stop(what: &What) -> bool {
    matches!(what, What::Press(Button::Stop | Button::Abort))
}

/// Whether no program is completed in which this happens.
pub(crate) fn ends(what: &What) -> bool {
    let pressed = matches!(what, What::Press(Button::Stop | Button::Abort | Button::EmergencyStop));
    pressed || matches!(what, What::Plant(Trouble::PowerLost | Trouble::DriveFault(_)))
}

/// Whether nothing can brake the spindle any more.
pub(crate) fn coasts(what: &What) -> bool {
    matches!(what, What::Plant(Trouble::PowerLost | Trouble::Spindle(SpindleFault::Stall, _)))
}

/// How much faster an axis on a lead goes from one cycle to the next because its spindle encoder tells of
/// counts that are none, mm/s: of a count the observer takes its gain at once (M53).
pub(crate) fn counted_mm_s(machine: &Machine, events: &[Event], now: u64, lead_mm: f64) -> f64 {
    let (turn, cycle_s) = (machine.spindle_counts(), machine.general.cycle_s);
    let counts = events.iter().filter(|event| now >= event.at).map(|event| match event.what {
        What::Plant(Trouble::Counts(counts) | Trouble::Glitch(counts, _)) => {
            (counts.unsigned_abs() as f64).min(MOST_COUNTS.max(seen_counts(machine)))
        }
        What::Plant(Trouble::Noise(counts)) => 4.0 * f64::from(counts),
        What::Plant(Trouble::Eccentricity(counts)) => counts,
        What::Plant(Trouble::Stands(_)) => SEEN_RPM / 60.0 * turn * cycle_s,
        _ => 0.0,
    });
    let pole = libm::exp(-core::f64::consts::TAU * machine.spindle.observer_hz * cycle_s);
    // A count more or less is rounding.
    2.0 * (0.5 + counts.sum::<f64>()) * lead_mm.abs() / turn * (1.0 - pole * pole * pole) / cycle_s
}

/// How far an axis goes in a turn at most, mm: on a cone, and on its strokes by the angle, twice as steep as
/// on average.
pub(crate) fn steepest_mm(law: &AxisLaw) -> f64 {
    let steep = |mm: f64, degrees: f64| 2.0 * mm.abs() * 360.0 / degrees.max(1.0);
    let approach = steep(law.stroke_mm, law.locked_deg() - law.begins_deg());
    law.lead_mm.abs() + approach.max(steep(law.retract_mm, law.done_deg() - law.leaves_deg()))
}

/// How far an axis on a stroke of so many mm a turn is beside its place, mm, while the spindle changes its
/// speed by so many 1/min in a cycle: the slow observer that leads it learns of it late.
pub(crate) fn late_mm(machine: &Machine, stroke_mm: f64, change_rpm: f64) -> f64 {
    let a = stroke_mm * change_rpm / 60.0 / machine.general.cycle_s;
    let rad_s = core::f64::consts::TAU * machine.spindle.stroke_observer_hz;
    a / (rad_s * rad_s)
}

/// How far the slide of an axis lags behind that goes so many mm in a turn, while the spindle changes its
/// speed by so many 1/min in a cycle, mm: by a/(2πf)², and the observer of the spindle and the servo by more
/// than that. What is under way on a bus for d was reckoned for the speed that was known, a t behind
/// until the observer has learned, and lacks a d at the end: a d (t + d/2).
pub(crate) fn lag_mm(machine: &Machine, axis: Axis, lead_mm: f64, change_rpm: f64) -> f64 {
    let a = lead_mm * change_rpm / 60.0 / machine.general.cycle_s;
    let rad_s = core::f64::consts::TAU * in_truth(machine, axis, "mode_hz", 100.0);
    let bus_s = bus_s(machine);
    2.0 * SERVO * a / (rad_s * rad_s) + a * bus_s * (learned_s(machine) + 0.5 * bus_s)
}
