//! Seams: series against differences, axes against M49, meetings against both surfaces, turns without a jump.

#![allow(clippy::disallowed_methods)] // what is checked against may be platform maths

use shape::{
    Branch, Curve, Formula, Meeting, Op, Positioner, Quadric, Ruled, Seam, SeamCurve, SeamPath, Series,
    Walker,
};
use std::f64::consts::{PI, TAU};

fn positioner() -> Positioner {
    Positioner { x1: 120.0, y1: -35.0, z1: 250.0, x2: 15.0, y2: 8.0, z2: -50.0 }
}

const BEAM: [f64; 2] = [130.0, -20.0];

/// A branch of Ø 40 mm upwards on a pipe of Ø 60 mm along X, 50 mm above the table.
fn pipes() -> Meeting {
    Meeting {
        first: Ruled {
            at: [3.0, 0.0, 50.0],
            axis: [0.0, 0.0, 1.0],
            zero: [1.0, 0.0, 0.0],
            radius_mm: 20.0,
            slope: 0.0,
        },
        second: Quadric { at: [0.0, 0.0, 50.0], axis: [1.0, 0.0, 0.0], c: [-900.0, 0.0, 0.0, 1.0] },
        leaving: true,
        share: 0.5,
    }
}

fn seam(curve: SeamCurve, branch: Branch) -> Seam {
    Seam { curve, t: [0.0, TAU], branch, idle_beta_deg: 33.0, moved: None }
}

/// Every derivative of every axis and of the tip against central differences of the one below.
fn check_derivatives(path: &SeamPath, t: f64) {
    let h = 1e-4;
    let values = |t: f64| {
        let point = path.at(t);
        point.axes.into_iter().chain(point.tip).collect::<Vec<Series>>()
    };
    let (here, before, behind) = (values(t), values(t - h), values(t + h));
    for (i, series) in here.iter().enumerate() {
        assert!(series.is_finite(), "{i} at {t}");
        for n in 1..4 {
            let turn = if n == 1 && i == 3 { 360.0 } else { f64::INFINITY };
            let step = behind[i].derivative(n - 1) - before[i].derivative(n - 1);
            let step = if step.abs() > turn / 2.0 { step - turn.copysign(step) } else { step };
            let (want, got) = (step / (2.0 * h), series.derivative(n));
            assert!((want - got).abs() < 2e-5 * (1.0 + got.abs()), "{i}, {n} at {t}: {got} {want}");
        }
    }
}

/// The axes at t bring the place under the beam and turn the direction onto it.
fn check_pose(path: &SeamPath, t: f64) {
    let point = path.at(t);
    let [x, y, alpha, beta] = point.axes.map(|axis| axis.value());
    let drives = shape::Drives { x, y, alpha: alpha.to_radians(), beta: beta.to_radians() };
    let [place, direction] = path.place(t).map(|vector| vector.map(|c| c.value()));
    assert_eq!(point.tip.map(|c| c.value()), place);
    let [xa, ya, _] = positioner().forward(place, &drives);
    assert!((xa - BEAM[0]).abs() < 1e-10 && (ya - BEAM[1]).abs() < 1e-10, "{t}: {xa} {ya}");
    let length = direction.iter().map(|c| c * c).sum::<f64>().sqrt();
    let [lx, ly, lz] = Positioner::turned(direction, &drives);
    assert!(lx.hypot(ly) < 1e-13 * length && lz > 0.0, "{t}: {lx} {ly} {lz}");
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
    v.map(|c| c / length)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[test]
fn two_pipes_meet_on_both_and_the_direction_bisects_their_normals() {
    for branch in Branch::BOTH {
        let seam = seam(SeamCurve::Meeting(pipes()), branch);
        let path = seam.on(&[], positioner(), BEAM);
        for step in 0..=360 {
            let t = TAU * f64::from(step) / 360.0;
            let [[x, y, z], direction] = path.place(t).map(|vector| vector.map(|c| c.value()));
            assert!(((x - 3.0).hypot(y) - 20.0).abs() < 1e-13 && (y.hypot(z - 50.0) - 30.0).abs() < 1e-13);
            assert!(z > 70.0, "{t}: the upper of both curves, not {z}");
            let (one, other) = ([(x - 3.0) / 20.0, y / 20.0, 0.0], [0.0, y / 30.0, (z - 50.0) / 30.0]);
            let l = unit(direction);
            let bisector = unit([one[0] + other[0], one[1] + other[1], one[2] + other[2]]);
            assert!((dot(l, bisector) - 1.0).abs() < 1e-14, "{t}: {l:?} {bisector:?}");
            check_pose(&path, t);
            check_derivatives(&path, t);
            let alpha = path.at(t).axes[2].value();
            assert!(alpha * branch.sign() > 40.0, "{alpha}");
        }
    }
}

/// Other pairs: every point lies on both surfaces, the direction lies between the normals at its share of the
/// angle.
#[test]
fn every_pair_of_surfaces_meets_on_both() {
    let tilted = unit([0.2, -0.1, 1.0]);
    let cylinder = Ruled {
        at: [1.0, 2.0, 3.0],
        axis: [0.0, 0.0, 1.0],
        zero: [0.0, 1.0, 0.0],
        radius_mm: 10.0,
        slope: 0.0,
    };
    let zero = unit([1.0, 0.0, -0.2]);
    let cone = Ruled { at: [0.0, 0.0, -30.0], axis: tilted, zero, radius_mm: 12.0, slope: -0.15 };
    let plane = Quadric { at: [0.0, 0.0, 9.0], axis: unit([0.1, 0.3, 1.0]), c: [0.0, 1.0, 0.0, 0.0] };
    let sphere = Quadric { at: [2.0, -1.0, 0.0], axis: [0.0, 0.0, 1.0], c: [-900.0, 0.0, 1.0, 1.0] };
    let (r, k) = (25.0, 0.25);
    let funnel =
        Quadric { at: [0.0, 1.0, 2.0], axis: unit([1.0, 0.1, 0.0]), c: [-r * r, -2.0 * r * k, -k * k, 1.0] };
    for first in [cylinder, cone] {
        for second in [plane, sphere, funnel] {
            for (leaving, share) in [(true, 0.3), (false, 0.5), (true, 0.0), (true, 1.0)] {
                if second == plane && !leaving {
                    continue; // every generator leaves it
                }
                let meeting = Meeting { first, second, leaving, share };
                let seam = seam(SeamCurve::Meeting(meeting), Branch::Negative);
                let path = seam.on(&[], positioner(), BEAM);
                for step in 0..60 {
                    check_meeting(&meeting, &path, TAU * f64::from(step) / 60.0);
                }
            }
        }
    }
}

fn check_meeting(Meeting { first, second, leaving, share }: &Meeting, path: &SeamPath, t: f64) {
    let [p, direction] = path.place(t).map(|vector| vector.map(|c| c.value()));
    let against = |at: [f64; 3], axis: [f64; 3]| {
        let from: [f64; 3] = std::array::from_fn(|i| p[i] - at[i]);
        let h = dot(from, axis);
        let across: [f64; 3] = std::array::from_fn(|i| from[i] - h * axis[i]);
        (h, across)
    };
    let (h, across) = against(first.at, first.axis);
    let rho = dot(across, across).sqrt();
    assert!((rho - first.radius_mm - first.slope * h).abs() < 1e-12, "{t}: {rho} {h}");
    assert!((dot(across, first.zero) / rho - t.cos()).abs() < 1e-12, "{t}");
    let one = unit(std::array::from_fn(|i| across[i] / rho - first.slope * first.axis[i]));
    let (h, across) = against(second.at, second.axis);
    let [c0, c1, c2, c3] = second.c;
    let off = c0 + c1 * h + c2 * h * h + c3 * dot(across, across);
    assert!(off.abs() < 1e-10, "{t}: {off}");
    let other = unit(std::array::from_fn(|i| 2.0 * c3 * across[i] + (c1 + 2.0 * c2 * h) * second.axis[i]));
    let generator = unit(std::array::from_fn(|i| one_axis(first, t)[i]));
    assert_eq!(dot(other, generator) > 0.0, *leaving, "{t}");
    let (angle, l) = (dot(one, other).clamp(-1.0, 1.0).acos(), unit(direction));
    assert!((dot(l, one).clamp(-1.0, 1.0).acos() - share * angle).abs() < 3e-8, "{t}");
    assert!((dot(l, other).clamp(-1.0, 1.0).acos() - (1.0 - share) * angle).abs() < 3e-8, "{t}");
    check_pose(path, t);
    check_derivatives(path, t);
}

/// Direction of the generator at t.
fn one_axis(first: &Ruled, t: f64) -> [f64; 3] {
    let ([ax, ay, az], [ux, uy, uz]) = (first.axis, first.zero);
    let side = [ay * uz - az * uy, az * ux - ax * uz, ax * uy - ay * ux];
    std::array::from_fn(|i| first.axis[i] + first.slope * (first.zero[i] * t.cos() + side[i] * t.sin()))
}

#[test]
fn a_generator_that_misses_is_nowhere() {
    let mut meeting = pipes();
    (meeting.first.radius_mm, meeting.first.at[1]) = (20.0, 15.0);
    let seam = seam(SeamCurve::Meeting(meeting), Branch::Negative);
    let path = seam.on(&[], positioner(), BEAM);
    assert!(path.at(PI / 2.0).axes.iter().any(|axis| !axis.is_finite()));
    assert!(path.at(-PI / 2.0).axes.iter().all(|axis| axis.is_finite()));
}

#[test]
fn polynomials_and_formulas_that_say_the_same_are_the_same() {
    use Op::{Add, Constant, Mul, Variable};
    let coefficients: [[f64; 8]; 6] = std::array::from_fn(|i| {
        std::array::from_fn(|n| f64::from(u32::try_from((7 * i + 3 * n) % 5).unwrap()) - 1.7)
    });
    let formulas = coefficients.map(|c| {
        let mut ops = vec![Constant(c[7])];
        for c in c.iter().rev().skip(1) {
            ops.extend([Variable(0), Mul, Constant(*c), Add]);
        }
        Formula::new(&ops).unwrap()
    });
    let (one, other) = (
        seam(SeamCurve::Polynomials(coefficients), Branch::Positive),
        seam(SeamCurve::Formulas, Branch::Positive),
    );
    let (one, other) = (one.on(&[], positioner(), BEAM), other.on(&formulas, positioner(), BEAM));
    for step in 0..100 {
        let t = -1.0 + f64::from(step) / 50.0;
        let (a, b) = (one.at(t), other.at(t));
        for (a, b) in a.axes.iter().chain(&a.tip).zip(b.axes.iter().chain(&b.tip)) {
            assert!(
                a.0.iter().zip(b.0).all(|(a, b)| (a - b).abs() <= 1e-9 * (1.0 + a.abs())),
                "{t}: {a:?} {b:?}"
            );
        }
        check_pose(&one, t);
    }
    let lacking = seam(SeamCurve::Formulas, Branch::Positive);
    assert!(!lacking.on(&formulas[..5], positioner(), BEAM).at(0.0).axes[2].is_finite());
}

/// A flat seam under an upright beam: β stays where it is told to, x and y do the work.
#[test]
fn a_seam_whose_direction_is_upright_keeps_the_turn() {
    for (up, alpha) in [(2.0, 0.0), (-1.0, 180.0)] {
        let mut c = [[0.0; 8]; 6];
        (c[0][1], c[1][0], c[1][2], c[5][0]) = (10.0, 4.0, -3.0, up);
        for branch in Branch::BOTH {
            let seam = seam(SeamCurve::Polynomials(c), branch);
            keeps_the_turn(&seam.on(&[], positioner(), BEAM), alpha);
        }
    }
    let seam = seam(SeamCurve::Polynomials([[0.0; 8]; 6]), Branch::Positive);
    assert!(!seam.on(&[], positioner(), BEAM).at(0.0).axes[2].is_finite());
}

fn keeps_the_turn(path: &SeamPath, alpha: f64) {
    for step in 0..10 {
        let t = f64::from(step) / 10.0;
        let point = path.at(t);
        for (axis, angle) in [(2, alpha), (3, 33.0)] {
            let [value, slopes @ ..] = point.axes[axis].0;
            assert!((value - angle).abs() < 1e-13 && slopes == [0.0; 3], "{:?}", point.axes[axis]);
        }
        check_pose(path, t);
        check_derivatives(path, t);
    }
}

/// Around the pipe and on, three times, forwards and back: β never turns by more than the way between two
/// places asks.
#[test]
fn the_turn_goes_on_around_and_around() {
    let seam = seam(SeamCurve::Meeting(pipes()), Branch::Negative);
    let path = seam.on(&[], positioner(), BEAM);
    for sign in [1.0, -1.0] {
        let mut here = path.at(0.0).axes.map(|axis| axis.value());
        let start = here[3];
        for step in 1..=1080 {
            let t = sign * TAU * f64::from(step) / 360.0;
            let next = path.near(t, &here).axes.map(|axis| axis.value());
            assert!((next[3] - here[3]).abs() < 2.0, "{t}: {here:?} {next:?}");
            here = next;
        }
        assert!((here[3] - start - sign * 1080.0).abs() < 1e-9, "{}", here[3] - start);
    }
}

/// The walker winds β up with the seam, from the turn where the axes stand, and its pieces join without a
/// jump.
#[test]
fn a_walker_goes_around_from_the_turn_where_it_stands() {
    for turns in [-2.0, 0.0, 1.0] {
        let seam = Seam { t: [0.3, 0.3 - 2.0 * TAU], ..seam(SeamCurve::Meeting(pipes()), Branch::Positive) };
        let path = seam.on(&[], positioner(), BEAM);
        let mut here = path.at(0.3).axes.map(|axis| axis.value());
        here[3] += 360.0 * turns;
        let (start, mut length, mut pieces) = (here[3], 0.0, 0);
        let mut walker = Walker::new(seam.t).standing([here[0], here[1], here[2], start + 170.0]);
        while let Some(span) = walker.next(&path).unwrap() {
            assert!(
                span.from.iter().zip(here).all(|(a, b)| (a - b).abs() < 1e-11),
                "{:?} {here:?}",
                span.from
            );
            let [ways, ..] = span.path.at(span.path.length());
            assert!((0..4).all(|i| (span.from[i] + ways[i] - span.to[i]).abs() < 1e-9));
            (here, length, pieces) = (span.to, length + span.path.length(), pieces + 1);
        }
        assert!((here[3] - start + 720.0).abs() < 1e-9, "{}", here[3] - start);
        assert!((length - 2.0 * 130.0).abs() < 10.0 && pieces < 500, "{length} mm in {pieces} pieces");
    }
}
