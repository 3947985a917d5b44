//! G5, G5.1, G5.2 and G5.3, G6.2.

use gcode::canon::{Follows, Nurbs};
use gcode::{Call, Options, Place, Problem, Program, Sink};
use proptest::prelude::*;

use super::printed::{printed, refused};
use super::recorded::messages;
use crate::driven::driven;

/// The curves of a program.
#[derive(Default)]
struct Curves(Vec<Nurbs>);

impl Sink for Curves {
    fn call(&mut self, _: Place, call: Call<'_>) -> Result<(), Box<Problem>> {
        if let Call::NurbsFeed(curve) = call {
            self.0.push(curve.clone());
        }
        Ok(())
    }
}

fn curves(text: &str) -> Vec<Nurbs> {
    let program = Program::from_text("test.ngc", format!("{text}\nM2\n"), &Options::default());
    let driven = driven(program, Curves::default());
    assert!(driven.errors.is_empty(), "{}", driven.errors[0].render(false));
    driven.sink.0
}

/// The way from the start of a curve, as points with the arcs between them.
fn points(start: [f64; 2], way: &[Follows]) -> Vec<[f64; 2]> {
    let mut all = vec![start];
    for follows in way {
        let from = *all.last().unwrap_or(&start);
        let Some(([x, y], ccw)) = follows.arc else {
            all.push(follows.end);
            continue;
        };
        let angle = |at: [f64; 2]| libm::atan2(at[1] - y, at[0] - x);
        let (begin, radius) = (angle(from), libm::hypot(from[0] - x, from[1] - y));
        let sense = if ccw { 1.0 } else { -1.0 };
        let sweep = (sense * (angle(follows.end) - begin)).rem_euclid(std::f64::consts::TAU);
        assert!(sweep < 3.0, "an arc of {sweep} turns back");
        all.extend((1..=20).map(|n| {
            let angle = begin + sense * sweep * f64::from(n) / 20.0;
            [x + radius * libm::cos(angle), y + radius * libm::sin(angle)]
        }));
    }
    all
}

/// How far a point is from the nearest of some that lie close to each other.
fn off(at: [f64; 2], line: &[[f64; 2]]) -> f64 {
    let to = |pair: &[[f64; 2]]| {
        let [a, b] = [pair[0], pair[1]];
        let (way, from) = ([b[0] - a[0], b[1] - a[1]], [at[0] - a[0], at[1] - a[1]]);
        let square = way[0] * way[0] + way[1] * way[1];
        let part =
            if square > 0.0 { ((from[0] * way[0] + from[1] * way[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
        libm::hypot(from[0] - part * way[0], from[1] - part * way[1])
    };
    line.windows(2).map(to).fold(f64::INFINITY, f64::min)
}

#[test]
fn a_cubic_goes_on_in_the_direction_it_came_in() {
    let two = curves("F100\nG0 X1 Y2\nG5 I0 J3 P0 Q-3 X2 Y1\nG5 P0 Q-3 X4 Y1");
    assert_eq!(two[0].points, [[1.0, 2.0, 1.0], [1.0, 5.0, 1.0], [2.0, -2.0, 1.0], [2.0, 1.0, 1.0]]);
    assert_eq!(two[1].points, [[2.0, 1.0, 1.0], [2.0, 4.0, 1.0], [4.0, -2.0, 1.0], [4.0, 1.0, 1.0]]);
    assert_eq!(two[0].knots, [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]);
    assert_eq!(messages("F100\nG5 I0 J3 P0 Q-3 X2 Y1\n(debug,#<_x> #<_y>)"), ["2.000000 1.000000"]);
    assert_eq!(printed("F100\nG5 I0 J3 P0 Q-3 X2 Y1").pop().as_deref(), Some("NURBS_G5_FEED 4 "));
}

#[test]
fn a_parabola_is_one() {
    let curve = &curves("F100\nG0 X-2 Y4\nG5.1 X2 I2 J-8")[0];
    assert_eq!(curve.points, [[-2.0, 4.0, 1.0], [0.0, -4.0, 1.0], [2.0, 4.0, 1.0]]);
    let way = points([-2.0, 4.0], &curve.follow(1e-5, 1e6, 1000).unwrap());
    assert!(way.iter().all(|[x, y]| (y - x * x).abs() < 1e-4), "y is x²");
}

#[test]
fn a_block_of_points_is_a_circle_with_its_weights() {
    // a quarter of a circle: the corner has the weight √½
    let text = "F100\nG0 X10 Y0\nG5.2 P1 L3\nX10 Y10 P0.70710678118654752\nX0 Y10 P1\nG5.3";
    let curve = &curves(text)[0];
    let way = points([10.0, 0.0], &curve.follow(1e-6, 1e6, 1000).unwrap());
    assert!(way.iter().all(|[x, y]| (libm::hypot(*x, *y) - 10.0).abs() < 2e-6));
    let other = curves("G18\nF100\nG0 Z10 X0\nG91 G5.2 P2 L4\nZ0 X10\nZ-10 X10 P3 \nZ-10 X0\nG5.3");
    assert_eq!(other[0].points, [[10.0, 0.0, 2.0], [10.0, 10.0, 1.0], [0.0, 10.0, 3.0], [0.0, 0.0, 1.0]]);
    assert_eq!(other[0].order, 4);
}

#[test]
fn what_is_not_a_curve_is_refused() {
    refused("F100\nG5 X1 Y1 P1 Q1", "missing-word", &["I and J"]);
    refused("F100\nG5 X1 Y1 I1 J1 P1", "missing-word", &["Q"]);
    refused("F100\nG5 X1 I1 J0 P1 Q0\nG0 X0\nG5 X1 P1 Q0", "missing-word", &["I and J"]);
    refused("F100 G18\nG5.1 X1 I1", "bad-value", &["XY"]);
    refused("F100\nG5.1 X1 Z1 I1", "unused-word", &["Z"]);
    refused("G5.1 X1 I1", "no-feed", &[]);
    refused("F100\nG5.3", "no-motion-mode", &["G5.2"]);
    refused("F100\nG5.2 L4\nX1 Y1\nG5.3", "missing-word", &["L4", "has 2"]);
    refused("F100\nG5.2\nX1", "missing-word", &["Y"]);
    refused("F100\nG5.2\nX1 Y1\nG0 X2", "modal-group", &["G0"]);
    refused("F100\nG5.2\nX1 Y1 P0", "bad-value", &["P0"]);
    refused("F100\nG5.2 L2.5", "bad-value", &["L2.5"]);
    refused("F1\nG41.1 D1\nG5.1 X9 I5 J1", "compensation-on", &["spline"]);
}

/// A curve of order 4 with knots that are not evenly spaced.
const KNOTTED: &str = "G6.2 P4 Q1 X10 Y0 R1 K0\nX12 Y8 R2 K0\nX20 Y9 R0.5 K0\nX26 Y2 R1 K0\n\
                       X33 Y-4 R3 K0.7\nX40 Y5 R1 K2.2\nG6.2 K5\nG6.2 K5\nG6.2 K5\nG6.2 K5";

/// N of order k by the recursion of its definition.
fn basis(knots: &[f64], i: usize, k: usize, u: f64) -> f64 {
    if k == 1 {
        return f64::from(u8::from(knots[i] <= u && u < knots[i + 1]));
    }
    let part = |of: f64, whole: f64| if whole > 0.0 { of / whole } else { 0.0 };
    let (rises, falls) = (knots[i + k - 1] - knots[i], knots[i + k] - knots[i + 1]);
    part(u - knots[i], rises) * basis(knots, i, k - 1, u)
        + part(knots[i + k] - u, falls) * basis(knots, i + 1, k - 1, u)
}

/// A point of a curve as the sum of its points.
fn at(curve: &Nurbs, u: f64) -> [f64; 2] {
    let mut sum = [0.0; 3];
    for (i, [x, y, weight]) in curve.points.iter().enumerate() {
        let share = weight * basis(&curve.knots, i, curve.order, u);
        sum = [sum[0] + share * x, sum[1] + share * y, sum[2] + share];
    }
    [sum[0] / sum[2], sum[1] / sum[2]]
}

#[test]
fn a_curve_with_knots_is_the_sum_of_its_points() {
    let curve = &curves(&format!("F100\nG0 X10 Y0\n{KNOTTED}"))[0];
    assert_eq!(curve.knots, [0.0, 0.0, 0.0, 0.0, 0.7, 2.2, 5.0, 5.0, 5.0, 5.0]);
    let within = 1e-4;
    let way = points([10.0, 0.0], &curve.follow(within, 1e6, 10_000).expect("it can be followed"));
    for n in 0..500 {
        let there = at(curve, 5.0 * f64::from(n) / 500.0);
        assert!(off(there, &way) < 2.0 * within, "{there:?} is {} off", off(there, &way));
    }
    let end = way.last().expect("it ends");
    assert!(libm::hypot(end[0] - 40.0, end[1] - 5.0) < 1e-9, "at its last point: {end:?}");
    let after = messages(&format!("F100\nG0 X10 Y0\n{KNOTTED}\n(debug,#<_x> #<_y>)"));
    assert_eq!(after, ["40.000000 5.000000"]);
    let calls = printed(&format!("F100\nG0 X10 Y0\n{KNOTTED}"));
    assert!(calls.last().is_some_and(|call| call.contains("NURBS_G6_FEED_")), "{calls:?}");
}

#[test]
fn a_quarter_of_a_circle_with_knots_is_one_in_every_plane() {
    let text = "F100\nG0 Z10 X0\nG18 G6.2 P3 Q2 Z10 X0 R1 K2\nZ10 X10 R0.70710678118654752 K2\n\
                Z0 X10 R1 K2\nG6.2 K9\nG6.2 K9\nG6.2 K9";
    let curve = &curves(text)[0];
    let way = points([10.0, 0.0], &curve.follow(1e-6, 1e6, 1000).expect("it can be followed"));
    assert!(way.iter().all(|[z, x]| (libm::hypot(*z, *x) - 10.0).abs() < 2e-6));
}

#[test]
fn corners_of_a_curve_with_knots_are_corners_of_its_way() {
    let lines = "F100\nG6.2 P2 Q1 X0 Y0 R1 K0\nX10 Y0 R1 K0\nX10 Y10 R1 K1\nG6.2 K2\nG6.2 K2";
    let way = curves(lines)[0].follow(1e-5, 1e6, 100).expect("it can be followed");
    assert!(way.iter().all(|follows| follows.arc.is_none()), "{way:?}");
    let near = |[x, y]: [f64; 2], to: [f64; 2]| libm::hypot(x - to[0], y - to[1]) < 1e-9;
    let through = |to| way.iter().any(|follows| near(follows.end, to));
    assert!(through([10.0, 0.0]) && through([10.0, 10.0]), "{way:?}");
    // The knot 1 is there twice in a curve of order 3: it goes through the point (4, 4), with a corner.
    let text = "F100\nG6.2 P3 Q1 X0 Y0 R1 K0\nX2 Y4 R1 K0\nX4 Y4 R1 K0\nX4 Y0 R1 K1\nX8 Y0 R1 K1\n\
                G6.2 K2\nG6.2 K2\nG6.2 K2";
    let curve = &curves(text)[0];
    let way = points([0.0, 0.0], &curve.follow(1e-5, 1e6, 1000).expect("it can be followed"));
    assert!((0..200).all(|n| off(at(curve, f64::from(n) / 100.0), &way) < 2e-5));
    assert!(way.iter().any(|there| near(*there, [4.0, 4.0])), "{way:?}");
}

#[test]
fn what_is_not_a_curve_with_knots_is_refused() {
    let broken = |from: &str, to: &str| format!("F100\nG0 X10 Y0\n{}", KNOTTED.replacen(from, to, 1));
    refused("F100\nG6.2 Q1 X0 Y0 R1 K0", "missing-word", &["P"]);
    refused("F100\nG6.2 P1 Q1 X0 Y0 R1 K0", "bad-value", &["P1"]);
    refused("F100\nG6.2 P3 X0 Y0 R1 K0", "missing-word", &["Q"]);
    refused("G6.2 P3 Q1 X0 Y0 R1 K0", "no-feed", &[]);
    refused("F100 G93\nG6.2 P3 Q1 X0 Y0 R1 K0", "bad-value", &["G93"]);
    refused(&broken("K2.2", "K0.2"), "bad-value", &["K0.2"]);
    refused(&broken(" K2.2", ""), "missing-word", &["K"]);
    refused(&broken("R3", "R0"), "missing-word", &["R"]);
    refused(&broken("X33 Y-4", "X33"), "missing-word", &["Y"]);
    refused(&broken("X10 Y0 R1", "X11 Y0 R1"), "bad-value", &["1 from where the tool stands"]);
    refused(&broken("K0\nX12", "K-1\nX12"), "bad-value", &["knots"]);
    refused(
        &broken("R3 K0.7\nX40 Y5 R1 K2.2", "R3 K2\nX37 Y5 R1 K2\nX38 Y5 R1 K2\nX39 Y5 R1 K2\nX40 Y5 R1 K3"),
        "bad-value",
        &["torn"],
    );
    refused(&broken("G6.2 K5", "G0 X3"), "modal-group", &["G0"]);
    refused(&format!("{}\nF100\nG0 X10 Y0\n{KNOTTED}", broken("G6.2 K5", "M9")), "modal-group", &["M9"]);
    refused("F100\nG6.2 P3 Q1 X0 Y0 R1 K0\nG6.2 K1\nX1 Y1 R1 K1", "bad-value", &["behind a knot"]);
    refused(
        "F100\nG6.2 P3 Q1 X0 Y0 R1 K0\nX1 Y1 R1 K0\nG6.2 K1\nG6.2 K1\nG6.2 K1",
        "bad-value",
        &["this one has 2"],
    );
}

#[test]
fn curves_with_a_cusp_are_followed() {
    let curve =
        Nurbs::uniform(4, vec![[0.0, 0.0, 1.0], [10.0, 10.0, 1.0], [0.0, 10.0, 1.0], [10.0, 0.0, 1.0]]);
    let way = curve.follow(1e-4, 1e6, 10_000).unwrap();
    let end = way.last().unwrap().end;
    assert!(libm::hypot(end[0] - 10.0, end[1]) < 1e-9);
    // all points in one place, and two of them
    let still = Nurbs::uniform(3, vec![[1.0, 1.0, 1.0]; 3]);
    assert!(still.follow(1e-4, 1e6, 10).unwrap().len() <= 1);
    let twice = Nurbs::uniform(4, vec![[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [5.0, 5.0, 1.0], [9.0, 0.0, 1.0]]);
    assert!(twice.follow(1e-4, 1e6, 1000).is_some());
    assert!(curve.follow(1e-4, 1e6, 3).is_none());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Arcs keep to the curve, meet in their tangents and get few where little is asked.
    #[test]
    fn arcs_follow_their_curve(
        points_of in prop::collection::vec((-50.0..50.0f64, -50.0..50.0f64, 0.2..5.0f64), 4..9),
        order in 3..5usize,
    ) {
        let curve = Nurbs::uniform(order, points_of.iter().map(|(x, y, w)| [*x, *y, *w]).collect());
        let start = [points_of[0].0, points_of[0].1];
        let within = 1e-3;
        let Some(way) = curve.follow(within, 1e6, 100_000) else { return Err(TestCaseError::fail("too many")) };
        let fine = curve.follow(1e-5, 1e6, 1_000_000).unwrap();
        prop_assert!(way.len() < fine.len());
        let (coarse, fine) = (points(start, &way), points(start, &fine));
        for at in coarse.iter().step_by(37) {
            prop_assert!(off(*at, &fine) < 2.0 * within, "{at:?} is {} off", off(*at, &fine));
        }
        let end = points_of.last().map(|(x, y, _)| [*x, *y]).unwrap();
        prop_assert!(off(end, &coarse) < 1e-9);
    }
}
