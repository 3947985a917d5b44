//! What an axis does, its drive, or the operator.

use machine::Machine;
use protocol::{Fault, Panel};
use testing::Seed;

use super::super::case::Case;
use super::super::course::{AXES, Course, Stage};
use super::{EVERYWHERE, IN_PASS, WHOLE, X, Z, always, event, when};

/// Sharper than the machine file says, mm.
const FOLLOWING_MM: f64 = 0.03;

pub(super) fn cases() -> Vec<Case> {
    let each = [(X, Z), (Z, X)].into_iter().flat_map(|(axis, other)| of_axis(axis, other));
    each.chain([
        Case::new((Fault::FollowingError, 0), WHOLE, &[Stage::RunIn, Stage::RunOut], pushed(Z))
            .on(sharp)
            .lasting(40)
            .seen(strays(Z, FOLLOWING_MM))
            .told_by(Z),
        Case::new((Fault::EmergencyStop, 0), WHOLE, EVERYWHERE, always("emergency_stop = true"))
            .seen(pressed(Panel::EMERGENCY_STOP)),
        Case::new((Fault::PowerLost, 0), WHOLE, EVERYWHERE, always("power_lost = true"))
            .seen(pressed(Panel::POWER_LOST)),
    ])
    .collect()
}

fn of_axis(axis: usize, other: usize) -> [Case; 6] {
    let thread_mm = Machine::plain().axis[&AXES[axis]].thread_error_mm;
    [
        Case::new((Fault::FollowingError, 0), WHOLE, &[Stage::Timed], pushed(axis))
            .on(sharp)
            .lasting(40)
            .seen(strays(axis, FOLLOWING_MM))
            .told_by(axis),
        Case::new((Fault::ThreadError, 0), WHOLE, &[Stage::Thread], pushed(axis))
            .lasting(60)
            .seen(strays(axis, thread_mm))
            .told_by(axis),
        Case::new((Fault::DriveFault, 0), WHOLE, EVERYWHERE, fails(axis)).seen(is_off(axis)).told_by(axis),
        Case::new((Fault::OtherAxis, 0), WHOLE, IN_PASS, fails(axis)).seen(is_off(axis)).told_by(other),
        Case::new((Fault::OtherAxis, 0), WHOLE, &[Stage::Thread], pushed(axis))
            .lasting(60)
            .seen(when(move |course, _, n| course[n].measurement.axes[AXES[axis].index()].drive().calls()))
            .told_by(other),
        Case::new((Fault::AxisJump, 0), WHOLE, EVERYWHERE, jumps(axis))
            .seen(when(move |course, twin, n| {
                (course[n].measured_mm(axis) - twin[n].measured_mm(axis)).abs() > 0.01
            }))
            .told_by(axis),
    ]
}

fn sharp(machine: &mut Machine) {
    machine.axis.values_mut().for_each(|axis| axis.following_error_mm = FOLLOWING_MM);
}

fn either_way(seed: &mut Seed) -> f64 {
    if seed.chance(0.5) { 1.0 } else { -1.0 }
}

/// With more than the drive can hold, and less than looks like an encoder that jumps.
fn pushed(axis: usize) -> impl Fn(&mut Seed, u64) -> String {
    let name = AXES[axis].name();
    move |seed, at| {
        let force_n = seed.between(22_000.0, 30_000.0) * either_way(seed);
        event(at, &format!("force_spike = {{ axis = \"{name}\", force_n = {force_n:.0}, for_s = 0.2 }}"))
    }
}

fn fails(axis: usize) -> impl Fn(&mut Seed, u64) -> String {
    let name = AXES[axis].name();
    move |seed, at| {
        let lost = seed.chance(0.5);
        event(at, &format!("drive_fault = {{ axis = \"{name}\", torque_lost = {lost} }}"))
    }
}

fn jumps(axis: usize) -> impl Fn(&mut Seed, u64) -> String {
    let name = AXES[axis].name();
    move |seed, at| {
        let mm = seed.scale(0.02, 50.0) * either_way(seed);
        event(at, &format!("axis_jump = {{ axis = \"{name}\", mm = {mm:.4} }}"))
    }
}

/// It is measured farther than this from where it was led a cycle before, and on at that speed.
fn strays(axis: usize, most_mm: f64) -> impl Fn(&Course, &Course, usize) -> Option<usize> {
    let cycle_s = Machine::plain().general.cycle_s;
    when(move |course, _, n| {
        let led = &course[n - 1].axes[axis];
        (led.commanded_mm + led.velocity_mm_s * cycle_s - course[n].measured_mm(axis)).abs() > most_mm
    })
}

fn is_off(axis: usize) -> impl Fn(&Course, &Course, usize) -> Option<usize> {
    when(move |course, _, n| !course[n].holds(axis))
}

fn pressed(button: u32) -> impl Fn(&Course, &Course, usize) -> Option<usize> {
    when(move |course, _, n| course[n].measurement.panel.pressed(button))
}
