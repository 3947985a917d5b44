//! Compensation of screw and backlash, and the loop over a linear scale.
#![allow(clippy::unwrap_used)]

use core::f64::consts::TAU;

use crate::stand::{self, ARMED, BEGINS, HOME_MM, OVER, T, machine, run};
use machine::{AxisConfig, Feedforward, Machine};
use motion::Sample;
use protocol::Fault;
use regulator::compensation::Compensation;

const BACKLASH_MM: f64 = 0.012;
/// How far feedforward looks, s.
const REACH: [f64; 2] = [0.000_25, 0.001_25];

/// An axis with an error of the screw that bends, and with backlash.
fn worn(x: &mut AxisConfig) {
    x.backlash_mm = BACKLASH_MM;
    x.screw_error = vec![[0.0, -9.0], [30.0, 2.0], [55.0, 6.0], [72.0, -3.0], [90.0, 1.0], [120.0, 12.0]];
}

fn compensation(change: impl FnOnce(&mut AxisConfig)) -> Compensation {
    let machine: Machine = machine(change);
    Compensation::of(&machine.axis[&protocol::Axis::X], REACH, T).unwrap()
}

/// Swings by 20 mm about home.
fn swing(t: f64) -> Sample {
    let w = TAU / 0.8;
    let (sin, cos) = libm::sincos(w * t);
    Sample { s: HOME_MM + 20.0 * sin, v: 20.0 * w * cos, a: -20.0 * w * w * sin, ..Sample::default() }
}

#[test]
fn nothing_to_compensate_is_none() {
    let machine = machine(|_| {});
    assert!(Compensation::of(&machine.axis[&protocol::Axis::X], REACH, T).is_none());
}

#[test]
fn m68_speed_and_acceleration_of_the_motor_are_those_of_its_position() {
    let mut compensation = compensation(worn);
    let (mut turning, h) = (0, 1e-6);
    for cycle in 0..4000 {
        let t = f64::from(cycle) * T;
        compensation.step();
        compensation.watch(0.0, |lead_s| swing(t + lead_s));
        turning += u32::from(compensation.is_turning());
        for lead_s in [-0.000_25, 0.0, 0.000_7, 0.001_249] {
            let at = |lead_s: f64| compensation.motor(&swing(t + lead_s), lead_s);
            let (before, motor, after) = (at(lead_s - h), at(lead_s), at(lead_s + h));
            let (v, a) = ((after.s - before.s) / (2.0 * h), (after.v - before.v) / (2.0 * h));
            assert!((v - motor.v).abs() < 1e-6, "{v} {} at {t} + {lead_s}", motor.v);
            assert!((a - motor.a).abs() < 1e-6 * 1234.0, "{a} {} at {t} + {lead_s}", motor.a);
        }
        let axis_mm = compensation.axis_mm(compensation.motor(&swing(t), 0.0).s, 0.0);
        assert!((axis_mm - swing(t).s).abs() < 1e-12, "{axis_mm} at {t}");
    }
    assert!((200..1000).contains(&turning), "{turning} cycles");
}

/// What a cycle says of a moment ahead, the cycles behind it say too: nothing jumps when a reversal is seen.
#[test]
fn m69_every_cycle_sees_the_same_motor() {
    let mut compensation = compensation(worn);
    let mut foreseen: Vec<(u32, Sample)> = Vec::new();
    for cycle in 0..4000_u32 {
        let t = f64::from(cycle) * T;
        compensation.step();
        compensation.watch(0.0, |lead_s| swing(t + lead_s));
        let at = |lead_s: f64| compensation.motor(&swing(t + lead_s), lead_s);
        let now = at(0.0);
        for (_, before) in foreseen.iter().filter(|(of, _)| *of == cycle) {
            assert!(
                (before.s - now.s).abs() < 1e-11 && (before.v - now.v).abs() < 1e-8,
                "{before:?} {now:?}"
            );
            assert!((before.a - now.a).abs() < 1e-5, "{before:?} {now:?}");
        }
        foreseen.retain(|(of, _)| *of > cycle);
        foreseen.extend([(cycle + 1, at(T)), (cycle + 2, at(2.0 * T))]);
    }
}

/// Which side of the backlash the motor is on after some positions, each of which lasts a cycle.
fn side_after(positions: impl IntoIterator<Item = f64>) -> f64 {
    let mut compensation = compensation(|x| x.backlash_mm = BACKLASH_MM);
    let mut last = HOME_MM;
    for s in positions {
        let v = (s - last) / T;
        compensation.step();
        compensation.watch(0.0, |_| Sample { s, v, ..Sample::default() });
        last = s;
    }
    let rest = Sample { s: last, ..Sample::default() };
    compensation.motor(&rest, 0.0).s - last
}

#[test]
fn the_side_follows_the_direction_and_a_standing_axis_has_none() {
    let up = (0..200).map(|i| HOME_MM + 0.01 * f64::from(i));
    let top = HOME_MM + 1.99;
    let down = (0..200).map(|i| top - 0.001 * f64::from(i));
    let noise = (0..400).map(|i: i32| top - 0.000_9 * f64::from(i % 2));
    let (high, low) = (BACKLASH_MM / 2.0, -BACKLASH_MM / 2.0);
    let is = |side_mm: f64, positions: Vec<f64>| {
        let found = side_after(positions);
        assert!((found - side_mm).abs() < 1e-12, "{found} instead of {side_mm}");
    };
    is(0.0, vec![HOME_MM; 400]);
    is(high, up.clone().collect());
    is(high, up.clone().chain([top; 400]).collect());
    is(high, up.clone().chain(noise).collect());
    is(low, up.clone().chain(down.clone()).collect());
    is(low, up.clone().chain(down.clone()).chain([top - 0.199; 400]).collect());
    // A reversal while the side still changes waits; an axis that has stopped meanwhile stays on its side.
    let shortly = || up.clone().chain(down.clone().take(10));
    is(low, shortly().chain([top - 0.009; 300]).collect());
    is(low, shortly().chain([top - 0.005; 300]).collect());
    is(high, shortly().chain((0..200).map(|i| top - 0.009 + 0.001 * f64::from(i))).collect());
}

/// An axis on a lead of 5 mm behind an encoder of 100 counts: one count is 50 µm.
#[test]
fn noise_of_the_spindle_in_a_thread_is_no_reversal() {
    let turns = |count_mm: f64| {
        let mut compensation = compensation(|x| x.backlash_mm = BACKLASH_MM);
        let (mut last, mut turning) = (HOME_MM, 0);
        for cycle in 0..4000 {
            let t = f64::from(cycle) * T;
            // Ten millimetres a second, and a count and a half to and fro.
            let s = HOME_MM + 10.0 * t + 0.0375 * libm::sin(TAU * 60.0 * t);
            let ahead = Sample { s, v: (s - last) / T, ..Sample::default() };
            compensation.step();
            compensation.watch(count_mm, |_| ahead);
            turning += u32::from(compensation.is_turning());
            last = s;
        }
        turning
    };
    let (first, all) = (turns(0.05), turns(0.0));
    assert!((1..200).contains(&first), "the first stroke alone: {first} cycles");
    assert!(all > 5 * first, "by 1 µm it would turn again and again: {all} cycles");
}

/// A motor that does what its drive is told, a screw whose error grows evenly, and a nut with a dead zone.
struct Worn {
    motor_mm: f64,
    slide_mm: f64,
    um_per_mm: f64,
}

impl Worn {
    fn new() -> Worn {
        Worn { motor_mm: HOME_MM, slide_mm: HOME_MM, um_per_mm: 0.2 }
    }

    fn advance(&mut self, before: &regulator::Out) {
        self.motor_mm += (before.drive.target_velocity_mm_s + before.drive.velocity_offset_mm_s) * T;
        let nut_mm = self.motor_mm + 1e-3 * self.um_per_mm * (self.motor_mm - HOME_MM);
        self.slide_mm = self.slide_mm.clamp(nut_mm - BACKLASH_MM / 2.0, nut_mm + BACKLASH_MM / 2.0);
    }
}

/// Speeds of the law half a cycle ahead: the mean of the next cycle, which this motor makes in it.
fn ideal(x: &mut AxisConfig) {
    x.velocity_lead_s = T / 2.0;
}

fn compensated(x: &mut AxisConfig) {
    ideal(x);
    x.backlash_mm = BACKLASH_MM;
    x.screw_error = (0..=12).map(|row| 10.0 * f64::from(row)).map(|mm| [mm, 0.2 * mm]).collect();
}

/// Largest error of the slide, µm: going up, at depth, back up; each 80 ms after its reversal.
fn slide_errors(machine: &Machine) -> [f64; 3] {
    let worn = core::cell::RefCell::new(Worn::new());
    let mut worst = [0.0_f64; 3];
    let follow = |_: u64, before: &regulator::Out| {
        worn.borrow_mut().advance(before);
        [worn.borrow().motor_mm, worn.borrow().slide_mm]
    };
    run(machine, follow, |cycle, _, out| {
        let off_um = 1e3 * (out.status.commanded_mm - worn.borrow().slide_mm).abs();
        let part = match (cycle, out.status.state) {
            (..BEGINS, _) => return,
            (c, 1) if c > BEGINS + 260 && c < ARMED => 0,
            (_, 5) => 1,
            (c, 1) if c > OVER - 400 => 2,
            _ => return,
        };
        worst[part] = worst[part].max(off_um);
    });
    worst
}

#[test]
fn a_worn_axis_is_where_it_is_commanded() {
    let plain = slide_errors(&machine(ideal));
    let corrected = slide_errors(&machine(compensated));
    assert!(plain[0] > 3.0 && plain[1] > 4.0 && plain[2] > 3.0, "{plain:?}");
    assert!(corrected.iter().all(|um| *um < 0.02), "{corrected:?}");
}

/// With a scale the loop sees the slide: what the controller does not know of the screw goes away, and the
/// servo error is that of the slide.
#[test]
fn a_scale_closes_the_loop_over_the_slide() {
    let plain = slide_errors(&machine(ideal));
    let scaled = |x: &mut AxisConfig| {
        ideal(x);
        x.scale_step_mm = Some(1e-4);
    };
    let errors = slide_errors(&machine(scaled));
    assert!(errors[1] < 0.1 * plain[1] && errors[2] < 0.1 * plain[2], "{errors:?} {plain:?}");

    let machine = machine(scaled);
    let mut looked = 0;
    let scale_off = |cycle: u64, before: &regulator::Out| {
        let [_, follows] = stand::follows(cycle, before);
        if before.status.state == 0 { [HOME_MM; 2] } else { [follows + 0.02, follows - 0.001] }
    };
    run(&machine, scale_off, |_, measurement, out| {
        if out.status.state != 0 {
            looked += 1;
            let error_mm = out.status.commanded_mm - measurement.axes[0].scale.mm();
            assert_eq!(out.status.servo_error_mm, error_mm);
            assert_eq!(out.drive.target_velocity_mm_s, 100.0 * error_mm);
        }
    });
    assert!(looked > 6000 && machine.axis[&protocol::Axis::X].position_gain_1_s == 100.0);
}

#[test]
fn supervision_sees_what_the_loop_sees() {
    let scaled = machine(|x| x.scale_step_mm = Some(1e-4));
    let away = |cycle: u64| 0.002 * (cycle.clamp(3000, 3250) - 3000) as f64;
    let mut fault = 0;
    let scale_off = |cycle: u64, before: &regulator::Out| {
        let follows = before.status.commanded_mm + before.status.velocity_mm_s * T;
        [follows, follows + away(cycle)]
    };
    run(&scaled, scale_off, |_, _, out| fault = out.status.fault);
    assert_eq!(fault, Fault::ThreadError as u32);
    let motor_off = |cycle: u64, before: &regulator::Out| {
        let follows = before.status.commanded_mm + before.status.velocity_mm_s * T;
        [follows + away(cycle), follows]
    };
    run(&scaled, motor_off, |_, _, out| fault = out.status.fault);
    assert_eq!(fault, 0);
}

/// With a scale the tables still make feedforward right.
#[test]
fn feedforward_of_the_motor_knows_the_screw_with_a_scale_too() {
    let speeds = |change: fn(&mut AxisConfig)| {
        let machine = machine(change);
        let mut speeds = Vec::new();
        let follow = |_: u64, before: &regulator::Out| [before.status.commanded_mm; 2];
        run(&machine, follow, |_, _, out| speeds.push(out.drive.velocity_offset_mm_s));
        speeds
    };
    let plain = speeds(|x| x.feedforward = Feedforward::AnalyticV);
    let steep = speeds(|x| {
        (x.feedforward, x.scale_step_mm) = (Feedforward::AnalyticV, Some(1e-4));
        x.screw_error = (0..=12).map(|row| 10.0 * f64::from(row)).map(|mm| [mm, 4.0 * mm]).collect();
    });
    let moving = plain.iter().zip(&steep).filter(|(plain, _)| plain.abs() > 1.0);
    assert!(moving.clone().count() > 500);
    for (plain, steep) in moving {
        assert!((steep / plain - 0.996).abs() < 1e-9, "{plain} {steep}");
    }
}
