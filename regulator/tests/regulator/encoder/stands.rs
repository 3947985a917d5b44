//! A spindle that stands in a pass (M105), one that jams, and an encoder that dies.

use super::*;

/// In a pass a count that stands is found before 2 % of a turn are lost, at any speed above what a ramp
/// leaves of it, and it is believed: the spindle may have been jammed.
#[test]
fn a_slow_encoder_that_dies_in_a_pass_is_found_within_a_fiftieth_of_a_turn() {
    for (lines, rpm) in [(500, 350.0), (500, 180.0), (500, 100.0), (1024, 180.0), (2500, 60.0), (25, 300.0)] {
        for sign in [1.0, -1.0] {
            let mut bench = Bench { tolerated: 7, in_pass: true, ..Bench::new(lines, 0.5) };
            assert_eq!(bench.turn_on(sign * rpm, 0.8, true), None);
            let (from, stuck) = (bench.before, bench.count(bench.before));
            let mut fault = None;
            while fault.is_none() && (bench.before - from).abs() < 2.0 {
                let angle = bench.before + sign * rpm / 60.0 * T;
                bench.shift += stuck - bench.count(angle);
                fault = bench.go_blind(angle);
            }
            assert_eq!(fault.map(|found| found.fault), Some(Fault::EncoderStands), "{lines} lines, {rpm}");
            let lost = (bench.before - from).abs() * bench.turn;
            let most = 1.3 * f64::max(8.0, bench.turn / 50.0) + 2.0 * rpm / 60.0 * T * bench.turn;
            assert!(lost <= most, "{lines} lines, {rpm} 1/min: {lost} counts");
        }
    }
}

/// What a spindle drive brakes to rest in a pass is no encoder that stands, nor one that creeps.
#[test]
fn a_spindle_that_comes_to_rest_in_a_pass_is_no_fault() {
    for lines in ENCODERS {
        for ramp in [200.0, 800.0, 8000.0] {
            let mut machine = machine(lines);
            machine.spindle.ramp_rpm_s = ramp;
            for rpm in [3.0, 20.0, 150.0, 700.0, 3000.0] {
                let mut bench = Bench { in_pass: true, ..Bench::of(&machine, 0.37) };
                let mut angle = 0.37;
                for cycle in 0..20_000 {
                    let t = f64::from(cycle) * T - 1.0;
                    // It rests for a while, and goes on.
                    let rests = rpm / ramp + 1.0;
                    let speed = if t < rests { rpm - ramp * t.max(0.0) } else { ramp * (t - rests) };
                    angle += speed.clamp(0.0, rpm) / 60.0 * T;
                    assert_eq!(bench.go_to(angle), None, "{lines} lines, {ramp} 1/min per s, {rpm}, {t} s");
                }
            }
        }
    }
}

/// A spindle that jams looks like a glitch, and then like what it is; an encoder that dies in the middle of a
/// cycle does not.
#[test]
fn a_spindle_that_jams_is_believed_to_stand_and_an_encoder_that_dies_is_not() {
    for rpm in [120.0, 250.0, 300.0, 700.0, 1500.0, 3000.0] {
        for slower in [38_000.0, 80_000.0, 115_000.0] {
            let mut bench = Bench { tolerated: 7, in_pass: true, ..Bench::new(2500, 0.5) };
            assert_eq!(bench.turn_on(rpm, 1.3, true), None);
            let (mut speed, mut stood) = (rpm, 0);
            while stood < 60 {
                let before = speed;
                speed = f64::max(0.0, speed - slower * T);
                bench.go_to(bench.before + 0.5 * (before + speed) / 60.0 * T);
                stood += u32::from(speed == 0.0);
                let blind = bench.encoder.is_blind();
                assert!(stood <= 4 || !blind, "{rpm} 1/min, {slower} per s: blind {stood} cycles later");
            }
            assert!(bench.encoder.fault().is_some(), "{rpm} 1/min, {slower} per s");
        }
        for share in [0.2, 0.5, 0.8] {
            let mut bench = Bench { tolerated: 7, in_pass: true, ..Bench::new(2500, 0.5) };
            assert_eq!(bench.turn_on(rpm, 1.3, true), None);
            let stuck = bench.count(bench.before + share * rpm / 60.0 * T);
            for _ in 0..100 {
                let angle = bench.before + rpm / 60.0 * T;
                bench.shift += stuck - bench.count(angle);
                bench.go_blind(angle);
            }
            assert!(rpm < 400.0 || bench.encoder.is_blind(), "{rpm} 1/min, {share} of a cycle");
        }
    }
}
