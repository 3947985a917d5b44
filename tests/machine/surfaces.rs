//! Surfaces and contours from formulas in the whole machine: how far commanded and true tool are from
//! touching them, whether the feed is held, whether limits are kept. Bounds are those the work is accepted
//! by.
//!
//! What the observer measures by the formula of the machine code is measured once more by brute force, with
//! the formula written down here.

use std::path::{Path, PathBuf};

use machine::{Machine, SMALL_MILL};
use protocol::{Axis, Item};
use rig::observe::{Observation, Record, TraceReport};

use crate::shop;

/// Farthest that tools may be from their surface, µm.
const COMMANDED_UM: f64 = 2.0;
const TRUE_UM: f64 = 6.0;
/// How constant a feed is that no limit slows, per cent.
const FEED_PCT: f64 = 1.0;
const CHORD_UM: f64 = 2.0;

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/shape").join(name)
}

fn mill() -> Machine {
    Machine::from_toml(SMALL_MILL).expect("the mill is shipped")
}

/// Machine code of a job, which has no errors.
fn items(path: &Path) -> Vec<Item> {
    shop::items(&mill(), path)
}

/// Machine code of the wave, changed.
fn changed(changes: &[(&str, &str)]) -> Vec<Item> {
    let mut text = std::fs::read_to_string(example("wave.toml")).expect("the wave is shipped");
    for (from, to) in changes {
        assert!(text.contains(from), "the wave has {from}");
        text = text.replace(from, to);
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("job.toml");
    std::fs::write(&path, text).expect("it can be written");
    items(&path)
}

/// A small part of the wave: five lines.
const SMALL: [(&str, &str); 2] = [("x = [0, 100]", "x = [0, 30]"), ("y = [0, 80]", "y = [0, 2]")];

fn run(items: &[Item], scenario: &str, see: impl FnMut(&Record)) -> Observation {
    shop::observed(&mill(), items, scenario, see)
}

/// What holds whatever the operator does.
fn is_exact<'a>(observation: &'a Observation, what: &str) -> &'a TraceReport {
    let [trace] = &observation.traces[..] else { panic!("{what}: {} traces", observation.traces.len()) };
    assert_eq!((observation.moves.limit_violations, observation.moves.starved), (0, 0), "{what}");
    assert!(trace.cut_cycles > 1000 && trace.unmeasured_cycles == 0, "{what}: {trace:#?}");
    assert!(trace.commanded.max_abs_um() <= COMMANDED_UM, "{what}: {:?}", trace.commanded);
    assert!(trace.slide.max_abs_um() <= TRUE_UM, "{what}: {:?}", trace.slide);
    for (axis, used) in &trace.limits_used {
        let most = used.velocity_pct.max(used.acceleration_pct).max(used.jerk_pct).max(used.jerk_rate_pct);
        assert!(most <= 100.0 + 1e-4, "{what}: {axis} {used:?}");
    }
    assert!(trace.feed.chord_max_um <= CHORD_UM, "{what}: {:?}", trace.feed);
    trace
}

/// What holds besides at an override that stands still.
fn is_steady(trace: &TraceReport, what: &str) {
    let feed = &trace.feed;
    // On the flat ellipse there are 0.16 s in which the chain slows down and uses no limit to a quarter.
    let most_s = if what == "circle" { 0.2 } else { 0.0 };
    assert!(feed.unexplained_s <= most_s, "{what}: slower without a reason, {feed:?}");
    assert!(feed.most_pct <= FEED_PCT, "{what}: {feed:?}");
    assert!(feed.true_low_pct >= -FEED_PCT && feed.true_high_pct <= FEED_PCT, "{what}: {feed:?}");
}

/// Height of the wave, as one writes it down.
fn wave(x: f64, y: f64) -> f64 {
    0.02 * x * x + 8.0 * libm::sin(x / 15.0) * libm::cos(y / 20.0)
}

/// Distance of a point from the wave: the best of a grid over everything within reach, and from there ever
/// smaller steps.
fn distance(c: [f64; 3], reach: f64) -> f64 {
    const GRID: i32 = 30;
    let of =
        |[x, y]: [f64; 2]| ((x - c[0]).powi(2) + (y - c[1]).powi(2) + (wave(x, y) - c[2]).powi(2)).sqrt();
    let nearest = |from: [f64; 2], step: f64, steps: i32| {
        let places =
            (-steps..=steps).flat_map(|i| (-steps..=steps).map(move |j| (f64::from(i), f64::from(j))));
        let places = places.map(|(i, j)| [from[0] + i * step, from[1] + j * step]);
        places.min_by(|a, b| of(*a).total_cmp(&of(*b))).expect("there are places")
    };
    let mut step = reach / f64::from(GRID);
    let mut at = nearest([c[0], c[1]], step, GRID);
    while step > 1e-7 {
        let next = nearest(at, step, 1);
        step *= if next == at { 0.5 } else { 1.0 };
        at = next;
    }
    of(at)
}

/// The wave as it is shipped, all of it: 100 mm × 80 mm under a ball of 6 mm.
#[test]
fn the_wave_is_cut_as_its_formula_says() {
    const RADIUS: f64 = 3.0;
    let origin = [-50.0, -40.0, -170.0];
    let mut worst = [0.0_f64; 2];
    let mut cuts = [0, 0];
    let observation = run(&changed(&[]), "", |record| {
        cuts = [cuts[1], record.machine.work];
        if !record.truth.cycle.0.is_multiple_of(1500) || cuts != [1, 1] {
            return;
        }
        let place = |of: &dyn Fn(Axis) -> f64| {
            let at = |i: usize| of([Axis::X, Axis::Y, Axis::Z][i]) - origin[i];
            [at(0), at(1), at(2) + RADIUS]
        };
        let commanded = |axis| {
            record.axes.iter().find(|(other, _)| *other == axis).map_or(0.0, |(_, one)| one.commanded_mm)
        };
        let slide = |axis: Axis| record.truth.axes[axis.index()].slide_mm;
        for (worst, centre) in worst.iter_mut().zip([place(&commanded), place(&slide)]) {
            *worst = worst.max(1e3 * (distance(centre, 1.2 * RADIUS) - RADIUS).abs());
        }
    });
    let trace = is_exact(&observation, "the wave");
    is_steady(trace, "the wave");
    assert!(trace.feed.held_pct > 90.0, "{:?}", trace.feed);
    // Everywhere: lines from border to border, so close that the ridges are 10 µm, and the contact up to 3 mm
    // beside the tip.
    assert!(trace.way_mm > 300.0 * 100.0, "{trace:#?}");
    let [x, y, _] = trace.reach_mm;
    assert!(x[0] < 0.0 && x[1] > 97.0 && y[0] < 1.0 && y[1] > 79.0, "{:?}", trace.reach_mm);
    // Brute force agrees with the observer.
    assert!(worst[0] <= trace.commanded.max_abs_um() + 0.001, "{worst:?} {trace:#?}");
    assert!(worst[1] > 0.5 && worst[1] <= trace.slide.max_abs_um() + 0.001, "{worst:?} {trace:#?}");
}

/// Every pattern, every tool.
#[test]
fn every_pattern_and_every_tool_keeps_to_the_surface() {
    const LINES: &str = "path = { pattern = \"lines\", along = \"x\", scallop_mm = 0.01 }";
    const BALL: &str = "tool = { kind = \"ball\", diameter_mm = 6 }";
    const CIRCLE: &str =
        "path = { pattern = \"curve\", x = \"15 + 9*cos(t)\", y = \"1 + 0.9*sin(t)\", t = [0, 6.28] }";
    // The share of the time in which the feed is held, per cent: what there is. Lines across are 2 mm long,
    // and at each end of a line, and of a ring, the tool turns a corner.
    let paths = [
        ("across", 24.0, LINES, "path = { pattern = \"lines\", along = \"y\", step_mm = 5 }"),
        (
            "one way",
            85.0,
            LINES,
            "path = { pattern = \"lines\", along = \"x\", step_mm = 1, one_way = true }",
        ),
        ("rings", 74.0, LINES, "path = { pattern = \"rings\", step_mm = 1 }"),
        ("circle", 32.0, LINES, CIRCLE),
        ("bull nose", 78.0, BALL, "tool = { kind = \"bull\", diameter_mm = 3, corner_mm = 1 }"),
        ("small ball", 78.0, BALL, "tool = { kind = \"ball\", diameter_mm = 2 }"),
    ];
    for (what, held_pct, from, to) in paths {
        let observation = run(&changed(&[SMALL[0], SMALL[1], (from, to)]), "", |_| {});
        let trace = is_exact(&observation, what);
        is_steady(trace, what);
        assert!(trace.feed.held_pct >= held_pct, "{what}: {:?}", trace.feed);
    }
}

/// What a ball leaves of the wave in a square of 12 mm, by the commanded way of its tip alone: the highest
/// point above the surface, µm along its normal, and where that is.
fn highest_left(path: &str) -> (f64, [f64; 2]) {
    const RADIUS: f64 = 3.0;
    const FROM: [f64; 2] = [4.0, 30.0];
    const SIDE: f64 = 12.0;
    const STEPS: i32 = 240;
    let origin = [-50.0, -40.0, -170.0];
    let [x, y] = FROM.map(|from| format!("[{from}, {}]", from + SIDE));
    let (x, y) = (format!("x = {x}"), format!("y = {y}"));
    let items = changed(&[
        ("x = [0, 100]", &x),
        ("y = [0, 80]", &y),
        ("path = { pattern = \"lines\", along = \"x\", scallop_mm = 0.01 }", path),
    ]);
    let mut tips: Vec<[f64; 3]> = Vec::new();
    run(&items, "", |record| {
        let at = [Axis::X, Axis::Y, Axis::Z].map(|axis| {
            record.axes.iter().find(|(other, _)| *other == axis).map_or(0.0, |(_, one)| one.commanded_mm)
        });
        let tip: [f64; 3] = std::array::from_fn(|i| at[i] - origin[i]);
        let moved = tips.last().is_none_or(|last| (0..3).any(|i| (tip[i] - last[i]).abs() > 0.03));
        if record.machine.work == 1 && moved {
            tips.push(tip);
        }
    });
    let mut highest = (0.0, [0.0; 2]);
    for i in 1..STEPS {
        for j in 1..STEPS {
            let [x, y] = [
                FROM[0] + SIDE * f64::from(i) / f64::from(STEPS),
                FROM[1] + SIDE * f64::from(j) / f64::from(STEPS),
            ];
            let left = tips.iter().fold(f64::INFINITY, |left, tip| {
                let square = (x - tip[0]).powi(2) + (y - tip[1]).powi(2);
                if square < RADIUS * RADIUS {
                    left.min(tip[2] + RADIUS - (RADIUS * RADIUS - square).sqrt())
                } else {
                    left
                }
            });
            let slope = [(1e-5, 0.0), (0.0, 1e-5)]
                .map(|(dx, dy)| (wave(x + dx, y + dy) - wave(x - dx, y - dy)) / 2e-5);
            let normal = (1.0 + slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
            let um = 1e3 * (left - wave(x, y)) / normal;
            if um > highest.0 {
                highest = (um, [x, y]);
            }
        }
    }
    highest
}

/// The ridges that are left are as high as was asked for, and nothing is left out.
#[test]
fn what_is_left_between_paths_is_what_was_asked_for() {
    for pattern in
        ["pattern = \"lines\", along = \"x\"", "pattern = \"lines\", along = \"y\"", "pattern = \"rings\""]
    {
        let (um, at) = highest_left(&format!("path = {{ {pattern}, scallop_mm = 0.02 }}"));
        assert!((16.0..=20.0).contains(&um), "{pattern}: {um} µm at {at:?}");
    }
}

/// Turned knobs and a hold in the middle of a line: the tool stays on the surface.
#[test]
fn whatever_the_operator_does_the_tool_stays_on_the_surface() {
    let items = changed(&SMALL);
    let quiet = run(&items, "", |_| {});
    let middle = quiet.traces[0].t_s
        + 0.4 * (quiet.traces[0].end_cycle - quiet.traces[0].begin_cycle) as f64 * quiet.cycle_s;
    let event = |after: f64, action: &str| {
        format!("[[event]]\nat = {{ time_s = {:.4} }}\n{action}\n", middle + after)
    };
    let knob = |after: f64, pct: u32| event(after, &format!("feed_override_pct = {pct}"));
    let scenarios = [
        ("slower", knob(0.0, 40) + &knob(0.5, 100)),
        ("faster", knob(0.0, 150) + &knob(0.6, 90)),
        ("slowly", knob(0.0, 60).replace("_pct = 60", "_pct = 60\nramp_s = 0.5") + &knob(1.0, 100)),
        ("hold", event(0.0, "feed_hold = true") + &event(1.0, "cycle_start = true")),
        ("nothing at all", knob(0.0, 0) + &knob(0.5, 100)),
    ];
    for (what, scenario) in scenarios {
        let observation = run(&items, &scenario, |_| {});
        let trace = is_exact(&observation, what);
        assert_ne!(observation.trace_hash, quiet.trace_hash, "{what}: it came to pass");
        assert!((trace.way_mm - quiet.traces[0].way_mm).abs() < 0.01, "{what}: the same way");
        let longer = trace.cut_cycles as f64 - quiet.traces[0].cut_cycles as f64;
        let held = matches!(what, "hold" | "nothing at all");
        assert!(!held || longer * observation.cycle_s > 0.4, "{what}: {longer} cycles");
    }
}

/// A contour under the side of a tool, as it is shipped.
#[test]
fn a_contour_is_followed_as_its_formula_says() {
    let observation = run(&items(&example("contour.toml")), "", |_| {});
    is_steady(is_exact(&observation, "the contour"), "the contour");
    assert!(observation.traces[0].way_mm > 100.0, "{:#?}", observation.traces);
}

/// A job between the blocks of a G-code program.
#[test]
fn a_surface_in_gcode_is_cut_as_its_formula_says() {
    let observation = run(&items(&example("inline.ngc")), "", |_| {});
    is_steady(is_exact(&observation, "inline"), "inline");
}
