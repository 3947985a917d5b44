//! What the physics of an event excuses. In: the events of a case and its machine. Out: by how much the tool
//! may be beside its groove in a cycle, because no control could know better; whether an event lets the
//! program be completed.
//!
//! | event | excuse |
//! |---|---|
//! | counts lost or gained, a glitch | as far as the encoder cannot see it before the next index: n/4N leads, for a turn and the way out |
//! | force | the slide gives way by F/k, k = m (2πf)², and the servo by as much |
//! | a jump of an axis | as far as the axis could have moved, and the jerk of its drive |
//! | a spindle that is stopped harder than Z can brake | the way in which Z brakes, twice |
//! | an encoder that stands, of a spindle so slow that it may be jammed | anything, until the drive has been waited for |
//! | a spindle that changes its speed | the slide lags by a/(2πf)², and the servo by as much |
//! | noise, eccentricity | their counts |
//! | all others | none |

use machine::Machine;
use protocol::{Axis, ThreadPass};

use crate::event::{Button, Event, SpindleFault, Trouble, What};

/// How much more a drive and its screw give way than the slide on them.
const SERVO: f64 = 3.0;
/// Fastest change of a spindle's speed that an encoder must not be blamed for: top speed to rest in 50 ms.
const STALL_S: f64 = 0.05;

/// Slower than this, an encoder that stands may be that of a spindle that is jammed, 1/min; how long that may
/// be waited for, s.
const SEEN_RPM: f64 = 100.0;
const BLIND_S: f64 = 2.0;
/// Torque of the spindle drive in the built-in file, N·m.
const SPINDLE_NM: f64 = 60.0;

/// What is excused at a moment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Excuse {
    /// Error of the spindle angle, turns.
    pub(crate) turns: f64,
    /// Along Z and along X, mm.
    pub(crate) axial_mm: f64,
    pub(crate) radial_mm: f64,
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
    let fast = pass.s_rpm > SEEN_RPM;
    let What::Plant(trouble) = event.what else { return Excuse::default() };
    let cycle_s = machine.general.cycle_s;
    let until = |s: f64| event.at + (s / cycle_s) as u64;
    if now < event.at {
        return Excuse::default();
    }
    match trouble {
        Trouble::Counts(counts) => counts_excuse(machine, counts, now < event.at + 2 * turn + out),
        Trouble::Glitch(counts, s) => counts_excuse(machine, counts, now < until(s) + 2 * turn + out),
        Trouble::Force(axis, force_n, s) | Trouble::Spike(axis, force_n, s) if now < until(s + 0.1) => {
            let mm = SERVO * force_n.abs() / stiffness_n_mm(machine, axis);
            match axis {
                Axis::Z => Excuse { axial_mm: mm, ..Excuse::default() },
                _ => Excuse { radial_mm: mm, ..Excuse::default() },
            }
        }
        Trouble::Noise(counts) => {
            Excuse { turns: f64::from(counts) / machine.spindle_counts(), ..Excuse::default() }
        }
        Trouble::Eccentricity(counts) => {
            Excuse { turns: counts / machine.spindle_counts(), ..Excuse::default() }
        }
        Trouble::Stands(_) if !fast && now < until(BLIND_S) + out => {
            Excuse { axial_mm: f64::INFINITY, ..Excuse::default() }
        }
        Trouble::Spindle(SpindleFault::Jam, s) if now < until(s) + out => overrun(machine, lead_mm_s),
        Trouble::Load(nm, s) if beyond(machine, nm, lead_mm) && now < until(s) + out => {
            overrun(machine, lead_mm_s)
        }
        Trouble::Jump(axis, mm) => jump(machine, axis, mm),
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

/// Z comes to rest behind a spindle that has stopped dead.
fn overrun(machine: &Machine, v: f64) -> Excuse {
    let axial_mm = machine.axis.get(&Axis::Z).map_or(0.0, |z| v * v / (2.0 * z.acceleration_mm_s2));
    Excuse { axial_mm: 2.0 * axial_mm, ..Excuse::default() }
}

/// A jump that the axis could have made is believed; a larger one makes the drive jump for a cycle with all
/// its torque, until its loop has caught it.
fn jump(machine: &Machine, axis: Axis, mm: f64) -> Excuse {
    let Some(config) = machine.axis.get(&axis) else { return Excuse::default() };
    let cycle_s = machine.general.cycle_s;
    let believed = mm.abs().min(10.0 * config.acceleration_mm_s2 * cycle_s * cycle_s);
    let force_n = core::f64::consts::TAU * 1000.0 * config.torque_limit_nm / config.screw_lead_mm;
    let v = 1000.0 * force_n / config.mass_kg * cycle_s;
    let mm = believed + 4.0 * v / (core::f64::consts::TAU * config.velocity_bandwidth_hz);
    match axis {
        Axis::Z => Excuse { axial_mm: mm, ..Excuse::default() },
        _ => Excuse { radial_mm: mm, ..Excuse::default() },
    }
}

fn counts_excuse(machine: &Machine, counts: i64, young: bool) -> Excuse {
    let turn = machine.spindle_counts();
    let cycle_s = machine.general.cycle_s;
    let a = (machine.spindle.max_rpm / STALL_S).max(20_000.0) / 60.0 * turn;
    let seen = 6.0 + a * cycle_s * cycle_s + 0.02 * machine.spindle.max_rpm / 60.0 * turn * cycle_s;
    let unseen = (counts.unsigned_abs() as f64).min(seen);
    Excuse { turns: if young { unseen / turn } else { 0.0 }, ..Excuse::default() }
}

/// The slide on its screw, N/mm.
fn stiffness_n_mm(machine: &Machine, axis: Axis) -> f64 {
    let truth = machine.plant.get("axis").and_then(|axes| axes.get(axis.name()));
    let value = |key: &str, usual: f64| {
        truth.and_then(|table| table.get(key)).and_then(toml::Value::as_float).unwrap_or(usual)
    };
    let rad_s = core::f64::consts::TAU * value("mode_hz", 100.0);
    value("slide_mass_kg", 110.0) * rad_s * rad_s / 1000.0
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

/// Whether nothing can brake the spindle any more.
pub(crate) fn coasts(what: &What) -> bool {
    matches!(what, What::Plant(Trouble::PowerLost | Trouble::Spindle(SpindleFault::Stall, _)))
}

/// How far the slide of Z lags behind while the spindle changes its speed by so many 1/min in a cycle, mm: by
/// a/(2πf)², and the observer of the spindle and the servo by more than that.
pub(crate) fn lag_mm(machine: &Machine, lead_mm: f64, change_rpm: f64) -> f64 {
    let a = lead_mm * change_rpm / 60.0 / machine.general.cycle_s;
    let truth = machine.plant.get("axis").and_then(|axes| axes.get(Axis::Z.name()));
    let mode_hz =
        truth.and_then(|table| table.get("mode_hz")).and_then(toml::Value::as_float).unwrap_or(100.0);
    let rad_s = core::f64::consts::TAU * mode_hz;
    2.0 * SERVO * a / (rad_s * rad_s)
}
