//! Seams whose direction goes through that of the turn axis, begins or ends there, or passes it by, in the
//! whole machine: job, interpreter, interpolator, regulators, plant. No rotary axis turns by more than the
//! direction asks for, and the beam stays on the seam.

#![allow(clippy::unwrap_used, clippy::disallowed_methods)]

use interpreter::check_job;
use machine::{self, Machine};
use protocol::{Axis, Item};
use rig::observe::{Observation, Outcome};

use crate::stand::Stand;

/// A seam along X, mm, whose direction leans by 0.02 x along it and by `beside` across; and another key.
fn items(machine: &Machine, [from, to]: [f64; 2], beside: f64, key: &str) -> Vec<Item> {
    let text = format!(
        "kind = \"seam\"\nfeed_mm_min = 300\n{key}\nx = \"t\"\ny = \"0\"\nz = \"20\"\n\
         direction = [\"0.02*t\", \"{beside:e}\", \"1\"]\nt = [{from}, {to}]\n"
    );
    let check = check_job("seam.toml", &text, machine);
    let said: String = check.diagnostics.iter().map(|diagnostic| diagnostic.render(false)).collect();
    assert!(check.is_good(), "{said}");
    check.items
}

/// What the commanded A and C did while the beam was on the seam.
#[derive(Default)]
struct Turned {
    /// How far they went up and down in all, degrees.
    way: [f64; 2],
    /// The largest step of a cycle.
    step: [f64; 2],
    last: Option<[f64; 2]>,
    /// `tracing` of the cycles before: setpoints are made three ticks ahead.
    cuts: [u32; 12],
}

impl Turned {
    fn see(&mut self, tracing: u32, now: [f64; 2]) {
        self.cuts.rotate_left(1);
        self.cuts[11] = tracing;
        let cuts = self.cuts[0] == 1;
        let last = self.last.filter(|_| cuts);
        for i in 0..2 {
            let step = last.map_or(0.0, |last| (now[i] - last[i]).abs());
            (self.way[i], self.step[i]) = (self.way[i] + step, self.step[i].max(step));
        }
        self.last = Some(now);
    }
}

fn run(machine: &Machine, items: &[Item]) -> (Observation, Turned) {
    let mut turned = Turned::default();
    let seen = Stand { machine, items, scenario: "", seed: 5 }.run(|record| {
        let at = |axis: Axis| record.axes.iter().find(|(other, _)| *other == axis).unwrap().1.commanded_mm;
        turned.see(record.machine.work, [at(Axis::A), at(Axis::C)]);
        None
    });
    (seen, turned)
}

/// Runs a seam; A and C turn by what is demanded, and the beam is true. Says what the longest step of C was.
fn follows(t: [f64; 2], beside: f64, branch: &str, demanded: [f64; 2]) -> f64 {
    let machine = Machine::from_toml(machine::POSITIONER).unwrap();
    let what = format!("{t:?}, {beside} beside, {branch}");
    let (seen, turned) = run(&machine, &items(&machine, t, beside, &format!("branch = \"{branch}\"")));
    assert_eq!(seen.outcome, Outcome::Completed, "{what}: {:?}", seen.faults);
    assert_eq!((seen.moves.limit_violations, seen.moves.starved), (0, 0), "{what}");
    let [trace] = &seen.traces[..] else { panic!("{what}: one trace") };
    assert!(trace.cut_cycles > 1000 && trace.unmeasured_cycles == 0, "{what}: {trace:#?}");
    assert!(trace.commanded.max_abs_um() <= 0.001, "{what}: {:?}", trace.commanded);
    assert!(trace.commanded.angle_max_deg <= 1e-6, "{what}: {:?}", trace.commanded);
    assert!(trace.slide.max_abs_um() <= 10.0, "{what}: {:?}", trace.slide);
    assert!(trace.slide.angle_max_deg <= 0.01, "{what}: {:?}", trace.slide);
    for (way, demanded) in turned.way.iter().zip(demanded) {
        assert!((way - demanded).abs() < 0.01, "{what}: turned by {:?}, demanded {demanded}", turned.way);
    }
    turned.step[1]
}

/// How far the direction leans from the turn axis at x, degrees.
fn lean(x: f64, beside: f64) -> f64 {
    (0.02 * x).hypot(beside).atan().to_degrees()
}

#[test]
fn straight_through_the_pole_only_the_tilt_turns() {
    for (t, branch) in [
        ([-20.0, 20.0], "negative"),
        ([-20.0, 20.0], "positive"),
        ([-13.0, 20.0], "negative"),
        ([0.0, 20.0], "positive"),
        ([0.0, 20.0], "negative"),
        ([-20.0, 0.0], "negative"),
    ] {
        let through = if t[0] * t[1] < 0.0 { lean(t[0], 0.0) + lean(t[1], 0.0) } else { lean(20.0, 0.0) };
        assert!(follows(t, 0.0, branch, [through, 0.0]) < 1e-8);
    }
}

/// At 0.1° C turns by nearly 180°, at its highest speed of 60 °/s and no faster: 0.03° in a cycle of 0.5 ms.
#[test]
fn past_the_pole_at_a_tenth_of_a_degree_the_turn_takes_its_time() {
    let beside = 0.1_f64.to_radians().tan();
    let tilts = 2.0 * (lean(20.0, beside) - 0.1);
    let turns = 2.0 * (0.4 / beside).atan().to_degrees();
    let step = follows([-20.0, 20.0], beside, "negative", [tilts, turns]);
    assert!(step > 0.02 && step < 0.0301, "{step} degrees in a cycle");
}

/// At 0.5° with a direction that may be off by as much: C stands, the beam is on the seam, and the direction
/// off by no more than that.
#[test]
fn past_the_pole_within_a_tolerance_only_the_tilt_turns() {
    let machine = Machine::from_toml(machine::POSITIONER).unwrap();
    let beside = 0.5_f64.to_radians().tan();
    let (seen, turned) =
        run(&machine, &items(&machine, [-20.0, 20.0], beside, "direction_tolerance_deg = 0.51"));
    assert_eq!((seen.outcome, seen.moves.limit_violations), (Outcome::Completed, 0), "{:?}", seen.faults);
    let [trace] = &seen.traces[..] else { panic!("one trace") };
    assert!(trace.commanded.max_abs_um() <= 0.001, "{:?}", trace.commanded);
    assert!((trace.commanded.angle_max_deg - 0.5).abs() < 1e-4, "{:?}", trace.commanded);
    assert!((turned.way[0] - 2.0 * lean(20.0, 0.0)).abs() < 0.01, "A by {:?}", turned.way);
    assert!(turned.way[1] < 0.001, "C by {:?}", turned.way);
}
