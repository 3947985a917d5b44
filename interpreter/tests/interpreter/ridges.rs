//! Ridges between paths, measured on what the tool leaves: how far the material stands up from the surface,
//! along its normal, until the first place that the tool comes to on any path. No curvature is asked for.

use shape::{Formula, Leg, Plan, Surface, Touch};

use super::jobs::{WAVE, formulas, good, mill, surface};

/// Places across a gap that are looked at, those in its middle.
const ACROSS: f64 = 12.0;

/// How far the tool on one path keeps from a point, mm: negative if the point is cut away.
fn clearance(
    surface: &Surface,
    psi: &Formula,
    point: [f64; 3],
    on: impl Fn(f64) -> [f64; 2],
    at: f64,
) -> f64 {
    let tool = surface.tool;
    let gap = |t: f64| {
        let tip = surface.tip(psi, on(t));
        let beside = libm::hypot(point[0] - tip[0], point[1] - tip[1]) - (tool.radius_mm - tool.corner_mm);
        libm::hypot(beside.max(0.0), (point[2] - tip[2] - tool.corner_mm).min(0.0)) - tool.corner_mm
    };
    // The gap has its lowest places near the point in one stretch: the tool is convex, and the path nearly
    // straight.
    let mut least = f64::INFINITY;
    let (mut low, mut high) = (at - tool.radius_mm, at + tool.radius_mm);
    for _ in 0..45 {
        let (a, b) = (low + 0.382 * (high - low), low + 0.618 * (high - low));
        let [before, behind] = [a, b].map(gap);
        least = least.min(before).min(behind);
        if before < behind { high = b } else { low = a }
    }
    least
}

/// Where neighbouring lines lie: across them, mm.
fn lines(surface: &Surface, across: usize) -> Vec<f64> {
    let line = |leg| match surface.leg(leg) {
        Some(Leg::Cut(Plan::Line { from, .. })) => Some(from[across]),
        _ => None,
    };
    (0..surface.legs()).step_by(2).filter_map(line).collect()
}

/// How high the material between two lines stands over a place that is `at` along them, mm; not above 0.5.
fn left(surface: &Surface, psi: &Formula, along_y: bool, sides: [f64; 2], at: f64, share: f64) -> f64 {
    let across = sides[0] + (sides[1] - sides[0]) * share;
    let place = if along_y { [across, at] } else { [at, across] };
    let touch = Touch::at(psi, place);
    let [a, b] = touch.slope;
    let w = (1.0 + a * a + b * b).sqrt();
    let stands = |height: f64| {
        let point = [place[0] - height * a / w, place[1] - height * b / w, touch.z + height / w];
        sides.iter().all(|side| {
            let on = |t: f64| if along_y { [*side, t] } else { [t, *side] };
            clearance(surface, psi, point, on, at) > 0.0
        })
    };
    let (mut under, mut over) = (0.0, 0.5);
    for _ in 0..25 {
        let middle = 0.5 * (under + over);
        if stands(middle) { under = middle } else { over = middle }
    }
    under
}

/// Highest ridge between neighbouring lines, mm.
fn ridge(surface: &Surface, psi: &Formula, along_y: bool) -> f64 {
    let (along, across) = if along_y { (1, 0) } else { (0, 1) };
    let lines = lines(surface, across);
    let [low, high] = [surface.x, surface.y][along];
    let mut highest = 0.0_f64;
    for station in 0..=10 {
        let at = low + (high - low) * f64::from(station) / 10.0;
        for pair in lines.windows(2).step_by(1 + lines.len() / 16) {
            for n in 4..=8 {
                let share = f64::from(n) / ACROSS;
                highest = highest.max(left(surface, psi, along_y, [pair[0], pair[1]], at, share));
            }
        }
    }
    highest
}

/// A job whose highest ridge is what was asked for, but for what makes whole lines of it, and for places
/// between those that are looked at here.
fn keeps(text: &str, along_y: bool, scallop_mm: f64) {
    let check = good(text, &mill());
    let (psi, surface) = (formulas(&check.items)[0], surface(&check.items));
    let ridge = ridge(&surface, &psi, along_y);
    assert!((0.9..1.01).contains(&(ridge / scallop_mm)), "{ridge} for {scallop_mm}: {:?}", check.jobs);
    let um = told_um(&check.jobs[0].facts);
    assert!((0.9..1.01).contains(&(1000.0 * ridge / um)), "{ridge} mm, and {um} µm are told");
}

/// The height of ridges that `check` tells, µm.
fn told_um(facts: &[(&'static str, String)]) -> f64 {
    let (_, told) = facts.iter().find(|(what, _)| *what == "spacing").expect("it is told");
    told.split(' ').rev().nth(1).and_then(|word| word.parse().ok()).expect("a figure")
}

#[test]
fn ridges_of_a_ball_are_as_high_as_was_asked_for() {
    keeps(WAVE, false, 0.01);
    let coarse = WAVE.replace("along = \"x\", scallop_mm = 0.01", "along = \"y\", scallop_mm = 0.05");
    keeps(&coarse, true, 0.05);
}

#[test]
fn ridges_of_a_bull_nose_on_a_slope_are_as_high_as_was_asked_for() {
    let slope = WAVE
        .replace("0.02*x^2 + 8*sin(x/15)*cos(y/20)", "0.8*x + 2*sin(x/20) + 0.3*y + 2*cos(y/25)")
        .replace("kind = \"ball\", diameter_mm = 6", "kind = \"bull\", diameter_mm = 10, corner_mm = 2");
    keeps(&slope, false, 0.01);
    keeps(&slope.replace("along = \"x\"", "along = \"y\""), true, 0.01);
}

/// The highest place between two lines on a plane, sought from both sides: it need not be in the middle.
fn ridge_of_a_plane(surface: &Surface, psi: &Formula) -> f64 {
    let lines = lines(surface, 1);
    let left = |share| left(surface, psi, false, [lines[3], lines[4]], 50.0, share);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..16 {
        let (a, b) = (low + 0.382 * (high - low), low + 0.618 * (high - low));
        if left(a) > left(b) { high = b } else { low = a }
    }
    left(0.5 * (low + high))
}

/// A flat end of 6 mm up a slope of 0.5 leaves 3 sin θ (1 − (1 − (4/6)²)^½) = 0.3416 mm: its rim is seen
/// along
/// the path as an ellipse, whose circle of curvature stands less high.
#[test]
fn ridges_of_a_flat_end_and_wide_ones_of_a_bull_nose_are_those_of_an_ellipse() {
    let both = |z: &str, tool: &str, step: f64| {
        let ball = "kind = \"ball\", diameter_mm = 6";
        let text = WAVE.replace("0.02*x^2 + 8*sin(x/15)*cos(y/20)", z).replace(ball, tool);
        let check = good(&text.replace("scallop_mm = 0.01", &format!("step_mm = {step}")), &mill());
        let (psi, surface) = (formulas(&check.items)[0], surface(&check.items));
        (ridge_of_a_plane(&surface, &psi), 1e-3 * told_um(&check.jobs[0].facts))
    };
    let flat = "kind = \"flat\", diameter_mm = 6";
    let bull = "kind = \"bull\", diameter_mm = 10, corner_mm = 1";
    for (z, tool, step, within) in [
        ("0.5*x", flat, 4.0, 1e-3),
        ("0.5*x + 0.2*y", flat, 3.2, 1e-3),
        ("0.4*x", bull, 5.0, 1e-3),
        ("0.3*x + 0.1*y", bull, 4.0, 0.01),
    ] {
        let (found, told) = both(z, tool, step);
        assert!((found / told - 1.0).abs() < within, "{z}, {tool}: {found} mm, and {told} mm is told");
    }
    let (_, told) = both("0.5*x", flat, 4.0);
    assert!((told - 0.3416).abs() < 1e-4, "{told}");
}

/// How far the place on a plane that is farthest from all rings is from them, between the outer two, mm.
fn farthest(surface: &Surface, psi: &Formula) -> f64 {
    let on = |[x, y]: [f64; 2]| [x, y, psi.eval([x, y])];
    let sides: Vec<[[f64; 3]; 2]> = (0..10)
        .filter_map(|leg| match surface.leg(leg) {
            Some(Leg::Cut(Plan::Line { from, to })) if leg % 5 != 4 => Some([on(from), on(to)]),
            _ => None,
        })
        .collect();
    let apart = |point: [f64; 3], [from, to]: &[[f64; 3]; 2]| {
        let along: [f64; 3] = std::array::from_fn(|i| to[i] - from[i]);
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let out: [f64; 3] = std::array::from_fn(|i| point[i] - from[i]);
        let share = (dot(out, along) / dot(along, along)).clamp(0.0, 1.0);
        let off: [f64; 3] = std::array::from_fn(|i| out[i] - share * along[i]);
        dot(off, off).sqrt()
    };
    let Some([first, _]) = sides.get(4) else { panic!("there is a second ring") };
    let step = first[0] - surface.x[0];
    let places = (0..=60).flat_map(|i| (0..=60).map(move |j| [i, j].map(|n| step * f64::from(n) / 60.0)));
    let corners =
        |[a, b]: [f64; 2]| [[surface.x[0] + a, surface.y[0] + b], [surface.x[1] - a, surface.y[0] + b]];
    let places = places.flat_map(corners).map(on);
    places.map(|at| sides.iter().map(|side| apart(at, side)).fold(f64::MAX, f64::min)).fold(0.0, f64::max)
}

#[test]
fn ridges_where_rings_turn_are_as_high_as_was_asked_for() {
    for (z, least) in [("0*x", 0.85), ("0.7*x + 0.7*y", 0.85), ("0.6*x - 0.1*y", 0.7)] {
        let text = WAVE
            .replace("0.02*x^2 + 8*sin(x/15)*cos(y/20)", z)
            .replace("pattern = \"lines\", along = \"x\", scallop_mm", "pattern = \"rings\", scallop_mm")
            .replace("y = [0, 80]", "y = [0, 40]")
            .replace("x = [0, 100]", "x = [0, 40]");
        let check = good(&text, &mill());
        let (psi, surface) = (formulas(&check.items)[0], surface(&check.items));
        let off = farthest(&surface, &psi);
        let ridge = 3.0 - (9.0 - off * off).sqrt();
        assert!((least..1.001).contains(&(ridge / 0.01)), "{z}: {ridge} mm, {:?}", check.jobs);
    }
}
