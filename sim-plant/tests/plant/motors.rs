//! Motors and drives of a shop: torque that is not what the drive believes, noise, cogging, weight, voltage.

use core::f64::consts::TAU;

use crate::stand::Stand;
use machine::Machine;
use protocol::{AxisTruth, DriveState};
use sim_plant::Scenario;

/// The small lathe with such keys of X.
fn lathe(keys: &str, seed: u64) -> Stand {
    let plant = format!("[axis.x]\n{keys}").parse().expect("the table of the test");
    Stand::new(&Machine { plant, ..Machine::plain() }, Scenario::none(), seed)
}

fn x(stand: &Stand) -> AxisTruth {
    stand.truth().axes[0]
}

fn shown_nm(stand: &Stand) -> f64 {
    stand.truth().measurement.axes[0].torque_nm
}

#[test]
fn the_drive_shows_the_torque_that_it_believes() {
    let mut stand = lathe("torque_constant_pct = 6", 1);
    stand.velocity = [20.0, 0.0];
    for _ in 0..1000 {
        stand.tick();
        assert!((x(&stand).torque_nm - 1.06 * shown_nm(&stand)).abs() < 1e-12);
    }
    // At 20 mm/s the screw and the guide take 150 N, 120 N and 2.6 N·s/mm.
    let needed_nm = 322.0 * 5e-3 / TAU;
    let mean_nm = (0..2000).map(|_| stand.tick().axes[0].torque_nm).sum::<f64>() / 2000.0;
    assert!((mean_nm / needed_nm - 1.0).abs() < 0.01, "{mean_nm} N·m");
}

#[test]
fn the_torque_that_is_shown_has_noise_and_steps_and_is_the_same_for_a_seed() {
    let run = |seed: u64| -> Vec<(f64, f64)> {
        let mut stand = lathe("torque_noise_nm = 0.02\ntorque_step_nm = 0.005", seed);
        stand.velocity = [20.0, 0.0];
        stand.run(200);
        let shown = |_| {
            stand.tick();
            (shown_nm(&stand), x(&stand).torque_nm)
        };
        (0..20_000).map(shown).collect()
    };
    let rows = run(4);
    assert_eq!(rows, run(4));
    assert_ne!(rows, run(5));
    let off = |(shown, real): &(f64, f64)| shown - real;
    let mean = rows.iter().map(off).sum::<f64>() / rows.len() as f64;
    let rms = (rows.iter().map(|row| off(row).powi(2)).sum::<f64>() / rows.len() as f64).sqrt();
    // Noise and the rounding to 0.005 N·m, by their squares.
    let expected = (0.02f64.powi(2) + 0.005f64.powi(2) / 12.0).sqrt();
    assert!(mean.abs() < 5e-4 && (rms / expected - 1.0).abs() < 0.03, "mean {mean}, rms {rms} of {expected}");
    let in_steps = |(shown, _): &(f64, f64)| (shown / 0.005 - (shown / 0.005).round()).abs() < 1e-9;
    assert!(rows.iter().all(in_steps));
}

#[test]
fn the_drive_works_against_the_cogging_of_its_motor() {
    let share_nm = |keys: &str, seed: u64| {
        let mut stand = lathe(keys, seed);
        stand.velocity = [1.0, 0.0];
        stand.run(4000);
        // Four turns of the motor: 20 s at 1 mm/s.
        let (mut c, mut s, mut cycles) = (0.0, 0.0, 0.0);
        let from_mm = x(&stand).motor_mm;
        while x(&stand).motor_mm < from_mm + 20.0 {
            stand.tick();
            let (sin, cos) = libm::sincos(TAU * 24.0 * x(&stand).motor_mm / 5.0);
            (c, s) = (c + shown_nm(&stand) * cos, s + shown_nm(&stand) * sin);
            cycles += 1.0;
        }
        (2.0 * (c * c + s * s).sqrt() / cycles, libm::atan2(c, s).to_degrees())
    };
    let cogging = "cogging_nm = 0.05\ncogging_per_rev = 24";
    let ((even, _), (drawn, _)) = (share_nm("", 1), share_nm(cogging, 1));
    assert!(even < 0.003 && (drawn / 0.05 - 1.0).abs() < 0.1, "{even} N·m, with magnets {drawn} N·m");
    // Home is a whole number of turns, and 24 times a turn is 4.8 Hz here.
    for seed in [1, 2] {
        let (nm, degrees) = share_nm(&format!("{cogging}\ncogging_deg = 70"), seed);
        assert!((nm / 0.05 - 1.0).abs() < 0.1 && (degrees - 70.0).abs() < 5.0, "{nm} N·m at {degrees}°");
    }
}

#[test]
fn a_weight_is_held_by_the_brake_and_then_by_the_motor() {
    let carried_nm = |gravity_n: f64| {
        let mut stand = lathe(&format!("gravity_n = {gravity_n:?}"), 1);
        let home_mm = x(&stand).slide_mm;
        stand.word = Some(0);
        for _ in 0..2000 {
            stand.tick();
            let now = x(&stand);
            assert!((now.slide_mm - home_mm).abs() < 1e-6 && now.motor_mm == home_mm, "{now:?}");
        }
        assert_eq!(x(&stand).torque_nm, 0.0);
        stand.word = None;
        let mut mean_nm = |mm_s: f64| {
            stand.velocity = [mm_s, 0.0];
            stand.run(2000);
            (0..2000).map(|_| stand.tick().axes[0].torque_nm).sum::<f64>() / 2000.0
        };
        // Friction is against the motion both ways, the weight is not.
        0.5 * (mean_nm(5.0) + mean_nm(-5.0))
    };
    for gravity_n in [-800.0, 300.0] {
        let expected_nm = -gravity_n * 5e-3 / TAU;
        let carried_nm = carried_nm(gravity_n);
        assert!((carried_nm / expected_nm - 1.0).abs() < 0.01, "{carried_nm} of {expected_nm} N·m");
    }
}

#[test]
fn a_weight_keeps_the_nut_on_its_flank() {
    let moved_um = |gravity_n: f64, mm_s: f64| {
        let mut stand = lathe(&format!("backlash_mm = 0.02\ngravity_n = {gravity_n:?}"), 1);
        stand.run(1000);
        let [slide_mm, motor_mm] = [x(&stand).slide_mm, x(&stand).motor_mm];
        stand.velocity = [mm_s, 0.0];
        stand.run(2000);
        // What the slide stays behind the motor.
        1e3 * ((x(&stand).motor_mm - motor_mm) - (x(&stand).slide_mm - slide_mm)).abs()
    };
    for mm_s in [2.0, -2.0] {
        let (free, hanging) = (moved_um(0.0, mm_s), moved_um(-800.0, mm_s));
        // Half of 20 µm without a weight; with one only what the friction of the guide bends.
        assert!(free > 10.0 && hanging < 6.0, "{free} µm, hanging {hanging} µm at {mm_s} mm/s");
    }
}

#[test]
fn above_the_corner_the_torque_fades_but_for_braking() {
    let mut stand = lathe("full_torque_mm_s = 100\nno_torque_mm_s = 200", 1);
    stand.velocity = [250.0, 0.0];
    let mut fastest: f64 = 0.0;
    for cycle in 0..2000 {
        let now = stand.tick().axes[0];
        // Limits are those of the speed two cycles ago, and the torque lags behind them: 16 mm/s at first.
        let slack_nm = if cycle < 200 { 2.4 } else { 0.1 };
        let limit_nm = 14.3 * ((200.0 - now.velocity_mm_s) / 100.0).clamp(0.0, 1.0);
        assert!(now.torque_nm < limit_nm + slack_nm, "{now:?}");
        fastest = fastest.max(now.velocity_mm_s);
    }
    // Where what is left of the torque takes the friction: 270 N and 2.6 N·s/mm.
    let balance = 14.3 * (200.0 - fastest) / 100.0 / ((270.0 + 2.6 * fastest) * 5e-3 / TAU);
    assert!((balance - 1.0).abs() < 0.1, "{fastest} mm/s: {balance}");
    stand.velocity = [0.0, 0.0];
    let braking = (0..10).map(|_| stand.tick().axes[0].torque_nm).fold(0.0, f64::min);
    assert!(braking < -14.0, "{braking} N·m");
    assert_eq!(stand.state(protocol::Axis::X), DriveState::OperationEnabled);
}
