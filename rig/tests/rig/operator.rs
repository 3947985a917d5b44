//! What the operator does while the machine runs: overrides, hold, stop. Every change must keep the limits of
//! every axis and end at the same place.
#![allow(clippy::unwrap_used)]

use machine::Machine;
use protocol::{Axis, MachineState, operator::Request};
use rig::observe::{Observation, Outcome};
use testing::Seed;

use crate::stand::{Stand, compiled, pressed};

const HEAD: &str = "G18 G21 G90 G8 G94 G97\n";

struct Run {
    observation: Observation,
    /// Longest time between two cycles in which Z moved, s.
    longest_rest_s: f64,
    end_mm: [f64; 2],
    stopped: bool,
    peak_z_mm_s: f64,
}

fn run(program: &str, scenario: &str, requests: &[(u64, Request)]) -> Run {
    let machine = Machine::plain();
    let items = compiled(&machine, &format!("{HEAD}{program}"));
    let (mut resting, mut longest) = (0_u64, 0_u64);
    let (mut end_mm, mut stopped, mut peak) = ([0.0; 2], false, 0.0_f64);
    let observation = Stand { machine: &machine, items: &items, scenario, seed: 7 }.run(|record| {
        let z = &record.axes[1].1;
        let moving = record.machine.state() == MachineState::Moving;
        resting = if z.velocity_mm_s == 0.0 && moving { resting + 1 } else { 0 };
        longest = longest.max(resting);
        peak = peak.max(z.velocity_mm_s.abs());
        end_mm = [Axis::X, Axis::Z].map(|axis| record.truth.axes[axis.index()].motor_mm);
        stopped = record.machine.stopped != 0;
        pressed(requests, record)
    });
    let longest_rest_s = longest as f64 * machine.general.cycle_s;
    Run { observation, longest_rest_s, end_mm, stopped, peak_z_mm_s: peak }
}

#[track_caller]
fn assert_good(run: &Run, end_mm: [f64; 2]) {
    assert_eq!(run.observation.outcome, Outcome::Completed, "{:?}", run.observation.faults);
    assert_eq!(run.observation.moves.limit_violations, 0);
    for (got, want) in run.end_mm.iter().zip(end_mm) {
        assert!((got - want).abs() < 0.002, "ends at {:?}, not at {end_mm:?}", run.end_mm);
    }
}

const TURN: &str = "G0 X20 Z50\nG1 Z10 F1200\nG0 X30\nM2\n";

#[test]
fn half_the_feed_takes_twice_the_time() {
    let whole = run(TURN, "", &[]);
    let half = run(TURN, "[[event]]\nat = { cycle = 1 }\nfeed_override_pct = 50\n", &[]);
    assert_good(&whole, [30.0, 10.0]);
    assert_good(&half, [30.0, 10.0]);
    let rapid = run("G0 X20 Z50\nG0 X30\nM2\n", "", &[]).observation.moves.time_s;
    let (whole, half) = (whole.observation.moves.time_s - rapid, half.observation.moves.time_s - rapid);
    // Ramps to half the feed take less than twice the time.
    assert!((half / whole - 2.0).abs() < 0.05, "{half} / {whole}");
}

#[test]
fn overrides_turned_at_any_moment_keep_the_limits() {
    let program = "G0 X20 Z50\nG1 X25 Z-10 F3000\nG0 X60 Z80\nG1 Z60 F600\nM2\n";
    let machine = Machine::plain();
    let mut random = Seed::new(12_345);
    for _ in 0..20 {
        let requests: Vec<(u64, Request)> = (0..12)
            .map(|_| {
                let at = random.within(0..8000);
                let pct = random.below(201) as f64;
                let request = match random.below(3) {
                    0 => Request::RapidOverride(pct.clamp(5.0, 100.0)),
                    _ => Request::FeedOverride(pct.max(5.0)),
                };
                (at, request)
            })
            .collect();
        let run = run(program, "", &requests);
        assert_good(&run, [60.0, 60.0]);
        let highest = machine.axis[&Axis::Z].velocity_mm_s * (1.0 + 1e-6);
        assert!(run.peak_z_mm_s <= highest, "{} mm/s", run.peak_z_mm_s);
    }
}

#[test]
fn feed_hold_stands_on_the_path_and_goes_on() {
    // Held for 1.5 s; from full rapid the change of pace takes 0.75 s (2 v / (20 % of the acceleration), M8).
    let hold = [(1200, Request::FeedHold), (4200, Request::CycleStart)];
    let run = run(TURN, "", &hold);
    assert_good(&run, [30.0, 10.0]);
    assert!((0.7..1.5).contains(&run.longest_rest_s), "rested {} s", run.longest_rest_s);
}

#[test]
fn stop_ends_the_program_at_rest() {
    let run = run(TURN, "", &[(1800, Request::Stop)]);
    assert_eq!(run.observation.outcome, Outcome::Stopped, "{:?}", run.observation.faults);
    assert!(run.stopped && run.observation.faults.is_empty());
    assert_eq!(run.observation.moves.limit_violations, 0);
    assert!(run.end_mm[1] > 10.1, "ended the move all the same");
}

#[test]
fn feed_per_revolution_follows_the_spindle() {
    let program = "M3 S600\nG4 P2\nG0 X20 Z50\nG95 G1 Z20 F0.5\nM5\nM2\n";
    let whole = run(program, "", &[]);
    assert_good(&whole, [20.0, 20.0]);
    assert!((whole.peak_z_mm_s - 150.0).abs() < 1.0, "the rapid before");
    let slow = run(program, "[[event]]\nat = { line = 5 }\nspindle_override_pct = 50\n", &[]);
    assert_good(&slow, [20.0, 20.0]);
    // 30 mm at 5 mm/s, and at half of it.
    let gain = slow.observation.moves.time_s - whole.observation.moves.time_s;
    assert!((4.5..6.5).contains(&gain), "{gain} s more");
}

/// 120 % of 2900 1/min is more than the spindle has: the thread is cut at its highest speed, nobody waits for
/// more, and it is said.
#[test]
fn an_override_above_the_highest_speed_is_clamped_and_said() {
    let program = "M3 S2900\nG0 X22 Z8\nG33 Z-10 K1\nG0 X40\nM5\nM2\n";
    let mut machine = Machine::plain();
    machine.spindle.override_max_pct = 150.0;
    let items = compiled(&machine, &format!("{HEAD}{program}"));
    let run = |pct: f64| {
        let scenario = format!("[[event]]\nat = {{ cycle = 1 }}\nspindle_override_pct = {pct}\n");
        Stand { machine: &machine, items: &items, scenario: &scenario, seed: 1 }.run(|_| None)
    };
    let [whole, clamped] = [run(100.0), run(120.0)];
    for seen in [&whole, &clamped] {
        assert_eq!(seen.outcome, Outcome::Completed, "{:?}", seen.faults);
        assert!(seen.passes.len() == 1 && seen.passes[0].complete);
    }
    assert_eq!(whole.overrides_clamped, 0);
    assert!(clamped.overrides_clamped >= 1);
    let top = clamped.passes[0].rpm_max;
    assert!((0.99..1.01).contains(&(top / machine.spindle.max_rpm)), "{top} 1/min");
    assert!(clamped.cycles < whole.cycles + 2000, "{} cycles, {} without", clamped.cycles, whole.cycles);
}

#[test]
fn an_override_above_the_ceiling_of_a_pass_is_clamped_and_said() {
    let program = "M3 S600\nG0 X22 Z8\nG76 P2 Z-22 I-1 J0.3 K0.6\nG0 X40\nM5\nM2\n";
    let mut machine = Machine::plain();
    machine.spindle.override_max_pct = 200.0;
    let items = compiled(&machine, &format!("{HEAD}{program}"));
    let scenario = "[[event]]\nat = { pass = 1, angle_deg = 1000 }\nspindle_override_pct = 180\n";
    let seen = Stand { machine: &machine, items: &items, scenario, seed: 1 }.run(|_| None);
    assert_eq!(seen.outcome, Outcome::Completed, "{:?}", seen.faults);
    assert!(seen.overrides_clamped >= 1);
    for pass in &seen.passes {
        let top = pass.rpm_max / pass.programmed_rpm * 100.0;
        assert!(top < pass.max_feasible_override_pct * 1.02, "{top} of {}", pass.max_feasible_override_pct);
        assert!(pass.limits_asked_pct.most() <= 100.0, "{:?}", pass.limits_asked_pct);
    }
}
