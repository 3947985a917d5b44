//! Supervision of the spindle encoder (M70, M71) on angles that are known in closed form: what a spindle can
//! do raises no alarm, what it cannot is named.

mod stands;
mod turned;

use machine::Machine;
use protocol::{Cycle, Fault, Measurement};
use regulator::encoder::{Encoder, EncoderFault};

const T: f64 = 0.0005;
const ENCODERS: [u32; 4] = [25, 1024, 2500, 250_000];

fn machine(lines: u32) -> Machine {
    let mut machine = Machine::plain();
    machine.spindle.encoder_lines = lines;
    machine
}

/// An encoder at an angle in turns; the index lies at whole turns.
struct Bench {
    encoder: Encoder,
    turn: f64,
    before: f64,
    shift: i64,
    /// Counts by which the next index is latched too high.
    late: i64,
    /// Counts that may be lost or gained within ten turns.
    tolerated: i64,
    in_pass: bool,
    shown: Measurement,
}

impl Bench {
    fn new(lines: u32, angle: f64) -> Bench {
        Bench::of(&machine(lines), angle)
    }

    fn of(machine: &Machine, angle: f64) -> Bench {
        let encoder = Encoder::new(machine);
        let lines = machine.spindle.encoder_lines;
        let turn = 4.0 * f64::from(lines);
        let mut bench = Bench {
            encoder,
            turn,
            before: angle,
            shift: 0,
            late: 0,
            tolerated: 0,
            in_pass: false,
            shown: Measurement::default(),
        };
        bench.go_to(angle);
        bench
    }

    fn count(&self, angle: f64) -> i64 {
        (angle * self.turn + 0.3).floor() as i64 + self.shift
    }

    /// The encoder counts on; its index passes unseen.
    fn go_blind(&mut self, angle: f64) -> Option<EncoderFault> {
        self.shown.cycle = Cycle(self.shown.cycle.0 + 1);
        self.shown.spindle_count = self.count(angle);
        self.before = angle;
        self.encoder.update(&self.shown, self.tolerated, self.in_pass);
        self.encoder.fault()
    }

    fn go_to(&mut self, angle: f64) -> Option<EncoderFault> {
        let (low, high) = (self.before.floor(), angle.floor());
        if low != high {
            let index = if high > low { high } else { high + 1.0 };
            self.shown.index_count = self.count(index) + self.late;
            self.shown.index_number += 1;
        }
        self.go_blind(angle)
    }

    /// At a constant speed for some turns, or until a fault is found; whether the index is seen, turn by
    /// turn.
    fn turn_on(&mut self, rpm: f64, turns: f64, seen: bool) -> Option<EncoderFault> {
        let start = self.before;
        let mut cycles = 0_u32;
        while (self.before - start).abs() < turns {
            cycles += 1;
            let angle = start + rpm / 60.0 * T * f64::from(cycles);
            let found = if seen { self.go_to(angle) } else { self.go_blind(angle) };
            if found.is_some() {
                return found;
            }
        }
        None
    }
}

fn found(fault: Fault, counts: i64) -> Option<EncoderFault> {
    Some(EncoderFault { fault, counts })
}

/// Lets the spindle follow speeds (1/min over s) for some seconds from 0.37 turns on; no alarm.
#[track_caller]
fn sound(lines: u32, seconds: f64, rpm: impl Fn(f64) -> f64) {
    sound_from(0.37, lines, seconds, rpm);
}

#[track_caller]
fn sound_from(mut angle: f64, lines: u32, seconds: f64, rpm: impl Fn(f64) -> f64) {
    let mut bench = Bench::new(lines, angle);
    for cycle in 0..(seconds / T) as u32 {
        angle += rpm(f64::from(cycle) * T) / 60.0 * T;
        let fault = bench.go_to(angle);
        assert_eq!(fault, None, "{lines} lines, {} s", f64::from(cycle) * T);
    }
    assert!(bench.shown.index_number > 1, "it has turned");
}

#[test]
fn what_a_spindle_does_is_no_fault() {
    for lines in ENCODERS {
        for sign in [1.0, -1.0] {
            for rpm in [3000.0, 613.0, 60.0] {
                sound(lines, 3.0, |_| sign * rpm);
                sound(lines, 3.0, |t| sign * rpm * (1.0 - 0.03 * ((t - 1.0) / 0.015).clamp(0.0, 1.0)));
                // Stopped by the cut within the time from the top speed to rest, and let go again.
                let stalled = |t: f64| rpm * (1.0 - (t - 1.0) / 0.05 * 3000.0 / rpm).max(0.0);
                sound(lines, 3.5, |t| sign * if t < 1.0 { rpm } else { stalled(t).max(800.0 * (t - 2.0)) });
                for order in [1.0, 2.0, 7.0] {
                    let pace = std::f64::consts::TAU * order * rpm / 60.0;
                    sound(lines, 2.5, |t| sign * rpm * (1.0 + 0.01 * libm::sin(pace * t)));
                }
            }
            // The ramp of the drive: up, back through zero, and up the other way.
            sound(lines, 12.0, |t| sign * (3000.0 - (800.0 * t - 3000.0).abs()));
        }
    }
}

#[test]
fn to_and_fro_about_an_index_is_no_fault() {
    for lines in ENCODERS {
        for swing in [1e-5, 0.01, 0.4, 1.2, 2.5] {
            let pace = std::f64::consts::TAU * 0.4;
            sound_from(3.0 - 0.3 * swing, lines, 20.0, |t| 60.0 * swing * pace * libm::cos(pace * t));
        }
    }
    let mut bench = Bench::new(2500, 0.5);
    for (rpm, turns) in [(20.0, 1.7), (-20.0, 0.9), (20.0, 0.4), (-20.0, 3.9)] {
        assert_eq!(bench.turn_on(rpm, turns, true), None);
    }
}

#[test]
fn one_pulse_is_found_at_the_next_index() {
    for (lines, rpm) in [(25, 3000.0), (2500, 0.2), (2500, 600.0), (250_000, 3000.0)] {
        for sign in [1.0, -1.0] {
            for (shift, fault) in [(-1, Fault::EncoderPulsesLost), (1, Fault::EncoderPulsesGained)] {
                let mut bench = Bench::new(lines, 0.5);
                assert_eq!(bench.turn_on(sign * rpm, 0.8, true), None);
                bench.shift += sign as i64 * shift;
                assert_eq!(bench.turn_on(sign * rpm, 1.0, true), found(fault, shift), "{lines} lines");
            }
        }
    }
}

#[test]
fn pulses_lost_behind_an_index_are_lost_and_no_way_back() {
    for sign in [1.0, -1.0] {
        for lost in 1..=4 {
            let mut bench = Bench::new(2500, 0.5);
            assert_eq!(bench.turn_on(sign * 20.0, 1.5, true), None);
            // Two counts behind the index.
            bench.go_to(bench.before.round() + sign * 1.5e-4);
            bench.shift -= sign as i64 * lost;
            let fault = bench.turn_on(sign * 20.0, 1.1, true);
            assert_eq!(fault, found(Fault::EncoderPulsesLost, -lost), "{sign}");
        }
    }
}

#[test]
fn a_counter_that_stands_has_lost_its_pulses() {
    let mut bench = Bench::new(2500, 0.5);
    assert_eq!(bench.turn_on(20.0, 0.8, true), None);
    let stuck = bench.count(bench.before);
    let mut faults = (0..8000).map(|cycle| {
        let angle = 1.3 + 20.0 / 60.0 * T * f64::from(cycle);
        bench.shift += stuck - bench.count(angle);
        bench.go_to(angle)
    });
    let fault = faults.find_map(|fault| fault).expect("found within a turn");
    assert_eq!(fault.fault, Fault::EncoderPulsesLost, "it is too slow for anything else");
    assert!((-7010..-6990).contains(&fault.counts), "{fault:?}");
}

#[test]
fn counts_within_what_is_tolerated_are_corrected_one_a_cycle() {
    for sign in [1.0, -1.0] {
        for lost in [1, 5, -5] {
            let mut bench = Bench { tolerated: 5, ..Bench::new(2500, 0.5) };
            assert_eq!(bench.turn_on(sign * 600.0, 0.8, true), None);
            let shift = -(sign as i64) * lost;
            bench.shift += shift;
            let off = |bench: &Bench| bench.encoder.count(&bench.shown) - bench.count(bench.before) + shift;
            assert_eq!(bench.turn_on(sign * 600.0, 0.6, true), None);
            assert_eq!(off(&bench), shift, "not known before the index");
            while bench.encoder.corrected() == 0 {
                assert_eq!(bench.go_to(bench.before + sign * 600.0 / 60.0 * T), None);
            }
            let mut before = off(&bench);
            assert!((before - shift).abs() <= 1);
            while off(&bench) != 0 {
                bench.go_to(bench.before + sign * 600.0 / 60.0 * T);
                assert!(
                    (off(&bench) - before).abs() <= 1
                        && bench.encoder.corrected() == 5.min(lost.unsigned_abs() as u32)
                );
                before = off(&bench);
            }
            let at = bench.encoder.index_count(&bench.shown);
            assert_eq!(at + shift, bench.shown.index_count, "the index of the pass as well");
            // More within ten turns is too much, after them it is not.
            let mut later = Bench { shift: bench.shift, ..bench };
            assert_eq!(later.turn_on(sign * 600.0, 12.0, true), None);
            later.shift += shift;
            assert_eq!(later.turn_on(sign * 600.0, 1.0, true), None);
            later.shift += shift;
            let fault = later.turn_on(sign * 600.0, 1.1, true).map(|found| found.fault);
            let named = if lost > 0 { Fault::EncoderPulsesLost } else { Fault::EncoderPulsesGained };
            assert_eq!(fault, (lost.abs() > 1).then_some(named), "{lost}");
        }
    }
}

#[test]
fn a_latch_with_jitter_is_no_fault() {
    let mut bench = Bench { tolerated: 3, ..Bench::new(2500, 0.5) };
    for turn in 0..60 {
        bench.late = [1, -1, 0][turn % 3];
        assert_eq!(bench.turn_on(600.0, 1.0, true), None, "turn {turn}");
    }
}

#[test]
fn where_the_latch_jitters_a_count_is_corrected_once_sixteen_indexes_have_shown_it() {
    let mut machine = machine(2500);
    machine.spindle.index_jitter_s = 1e-6;
    let (mut bench, mut seed) = (Bench::of(&machine, 0.9), 1u64);
    bench.tolerated = 5;
    let mut turns = |bench: &mut Bench, turns: u32, drawn: fn(u64) -> bool| {
        for _ in 0..turns {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            bench.late = i64::from(drawn(seed >> 60));
            assert_eq!(bench.turn_on(1500.0, 1.0, true), None);
        }
        (bench.encoder.corrected(), bench.encoder.index_count(&bench.shown))
    };
    let (corrected, origin) = turns(&mut bench, 1, |_| false);
    assert_eq!(corrected, 0);
    // Half of the latches are a count late.
    assert_eq!(turns(&mut bench, 200, |n| n < 8), (0, origin + 200 * 10_000));
    // A count that is really lost.
    bench.shift -= 1;
    assert_eq!(turns(&mut bench, 15, |_| false), (0, origin + 215 * 10_000));
    assert_eq!(turns(&mut bench, 1, |_| false), (1, origin + 216 * 10_000));
    assert_eq!(turns(&mut bench, 50, |_| false), (1, origin + 266 * 10_000));
    // Many that are lost are no jitter.
    bench.shift -= 4;
    assert_eq!(turns(&mut bench, 1, |_| false), (5, origin + 267 * 10_000));
}

#[test]
fn an_encoder_that_dies_is_found_at_once() {
    for (rpm, within) in [(3000.0, 1), (600.0, 1), (75.0, 1)] {
        for sign in [1.0, -1.0] {
            let mut bench = Bench { tolerated: 7, ..Bench::new(2500, 0.5) };
            assert_eq!(bench.turn_on(sign * rpm, 0.8, true), None);
            let stuck = bench.count(bench.before);
            let mut faults = (1..100).map(|cycle| {
                let angle = bench.before + sign * rpm / 60.0 * T;
                bench.shift += stuck - bench.count(angle);
                (cycle, bench.go_blind(angle))
            });
            let (cycle, fault) = faults.find(|(_, fault)| fault.is_some()).expect("found");
            let fault = fault.expect("found").fault;
            assert_eq!(fault, Fault::EncoderStands);
            assert!(cycle <= within, "{rpm} 1/min: {cycle} cycles");
        }
    }
}

#[test]
fn a_glitch_is_found_at_once() {
    for (lines, rpm, counts) in
        [(25, 3000.0, 12), (2500, 0.2, 8), (2500, 3000.0, 20), (250_000, 3000.0, 2000)]
    {
        for sign in [1.0, -1.0] {
            for jump in [counts, -counts] {
                let mut bench = Bench::new(lines, 0.5);
                assert_eq!(bench.turn_on(sign * rpm, 1.2, true), None);
                bench.shift += jump;
                let fault = bench.go_to(bench.before + sign * rpm / 60.0 * T).expect("in the same cycle");
                assert_eq!(fault.fault, Fault::EncoderGlitch, "{lines} lines, {rpm} 1/min");
                assert!((fault.counts - jump).abs() <= 2, "{jump} counts: {fault:?}");
                bench.shift -= jump;
                assert_eq!(bench.turn_on(sign * rpm, 2.0, true), Some(fault), "it is latched");
            }
        }
    }
}

#[test]
fn an_index_that_does_not_come_is_missed_after_the_turns_that_are_let_pass() {
    for lines in ENCODERS {
        for sign in [1.0, -1.0] {
            let turned = |bench: &mut Bench, from: f64| {
                let fault = bench.turn_on(sign * 600.0, 5.0, false);
                assert_eq!(fault, found(Fault::EncoderIndexMissing, 0), "{lines} lines");
                (bench.before - from).abs()
            };
            let mut bench = Bench::new(lines, 0.5);
            // From the start.
            let from_start = turned(&mut bench, 0.5);
            assert!((3.0..3.1).contains(&from_start), "{lines} lines: {from_start} turns");
            // One that is not seen, in the turn after the last.
            let mut bench = Bench::new(lines, 0.5);
            assert_eq!(bench.turn_on(sign * 600.0, 2.7, true), None);
            let last = (bench.before * sign).floor() * sign;
            let from_last = turned(&mut bench, last);
            assert!((3.0..3.1).contains(&from_last), "{lines} lines: {from_last} turns");
        }
    }
}

#[test]
fn any_counts_are_taken() {
    let mut encoder = Encoder::new(&machine(2500));
    for (number, count) in [i64::MAX, i64::MIN, 0, i64::MIN, i64::MAX].into_iter().enumerate() {
        let shown = Measurement {
            spindle_count: count,
            index_count: count,
            index_number: number as u64 + 1,
            ..Measurement::default()
        };
        encoder.update(&shown, 0, true);
    }
    assert!(encoder.fault().is_some());
    // An index that is not where the count is.
    let mut encoder = Encoder::new(&machine(2500));
    for (number, index_count) in [0, i64::MIN, i64::MAX].into_iter().enumerate() {
        let index_number = number as u64;
        encoder.update(&Measurement { index_count, index_number, ..Measurement::default() }, 0, true);
    }
    assert!(encoder.fault().is_some());
}

/// A gap is no glitch, whatever the spindle does behind it.
#[test]
fn measurements_that_are_missing_are_no_glitch() {
    for lines in ENCODERS {
        for (missed, step) in [(1, 0.001), (2, 0.001), (2, 0.02), (40, 0.02)] {
            let mut bench = Bench::new(lines, 0.1);
            let mut angle = 0.1;
            for cycle in 0..3000 {
                let gap = if cycle % 7 == 3 { missed } else { 0 };
                if gap > 0 {
                    bench.encoder.skip();
                }
                angle += step * f64::from(1 + gap);
                // The index lies at whole turns, and a gap may hide none or one of them.
                bench.tolerated = 1 << 40;
                // A fault of another kind would hide a glitch behind it.
                assert_eq!(bench.go_to(angle), None, "{lines} lines, {missed} missed, cycle {cycle}");
            }
        }
    }
}
