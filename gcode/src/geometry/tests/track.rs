//! Offsets and corners, by number of their equation.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::geometry::track::{Corner, Element, Point, Side, Track, distance, meet};

const R: f64 = 2.0;

fn line(from: Point, to: Point) -> Element {
    Element { from, to, arc: None }
}

fn arc(from: Point, to: Point, center: Point, turns: i32) -> Element {
    Element { from, to, arc: Some((center, turns)) }
}

fn track(element: Element, side: Side) -> Track {
    element.offset(side, R).expect("the tool fits")
}

fn near(a: Point, b: Point) {
    assert!(distance(a, b) < 1e-12, "{a:?} is not {b:?}");
}

fn corner(before: Element, next: Element, side: Side) -> (Corner, Option<Point>) {
    let (p, before, next) = (before.to, track(before, side), track(next, side));
    let kind = Corner::between(before.normals[1], before.curvature, &next, side);
    (kind, meet(&before, &next, p, side, R))
}

#[test]
fn o2_a_line_is_shifted_to_its_side() {
    let east = line([0.0, 0.0], [10.0, 0.0]);
    let left = track(east, Side::Left);
    near(left.from, [0.0, 2.0]);
    near(left.to, [10.0, 2.0]);
    near(track(east, Side::Right).to, [10.0, -2.0]);
    assert_eq!(left.left, 10.0);
}

#[test]
fn o3_an_arc_grows_or_shrinks() {
    let quarter = arc([5.0, 0.0], [0.0, 5.0], [0.0, 0.0], 1);
    let inside = track(quarter, Side::Left);
    near(inside.from, [3.0, 0.0]);
    near(inside.to, [0.0, 3.0]);
    let outside = track(quarter, Side::Right);
    near(outside.to, [0.0, 7.0]);
    assert!((outside.left - FRAC_PI_2).abs() < 1e-12);
    let turns = track(arc([5.0, 0.0], [0.0, 5.0], [0.0, 0.0], -3), Side::Left);
    assert!((turns.left - (1.5 * PI + 4.0 * PI)).abs() < 1e-12);
}

#[test]
fn o3_the_tool_must_fit_into_an_arc() {
    let tight = arc([2.0, 0.0], [0.0, 2.0], [0.0, 0.0], 1);
    assert_eq!(tight.offset(Side::Left, 2.0), None);
    assert!(tight.offset(Side::Left, 1.999).is_some());
    assert!(tight.offset(Side::Right, 2.0).is_some());
}

#[test]
fn o4_corners_have_kinds() {
    let before = track(line([-10.0, 0.0], [0.0, 0.0]), Side::Left);
    for (degrees, kind) in [
        (0.0, Corner::Tangent),
        (2.5, Corner::Tangent),
        (3.0, Corner::Inside),
        (90.0, Corner::Inside),
        (176.0, Corner::Inside),
        (179.0, Corner::Outside),
        (180.0, Corner::Outside),
        (-179.0, Corner::Outside),
        (-90.0, Corner::Outside),
        (-3.0, Corner::Outside),
        (-2.5, Corner::Tangent),
    ] {
        let (sin, cos) = libm::sincos(f64::to_radians(degrees));
        let next = track(line([0.0, 0.0], [cos, sin]), Side::Left);
        assert_eq!(Corner::between(before.normals[1], 0.0, &next, Side::Left), kind, "{degrees}");
    }
}

#[test]
fn o5_two_lines() {
    let (kind, point) = corner(line([-10.0, 0.0], [0.0, 0.0]), line([0.0, 0.0], [0.0, 10.0]), Side::Left);
    assert_eq!(kind, Corner::Inside);
    near(point.unwrap(), [-2.0, 2.0]);
}

#[test]
fn o6_line_and_arc() {
    // Into a pocket: from its centre to its wall, then along the wall.
    let wall = arc([10.0, 0.0], [0.0, 10.0], [0.0, 0.0], 1);
    let (kind, point) = corner(line([0.0, 0.0], [10.0, 0.0]), wall, Side::Left);
    assert_eq!(kind, Corner::Inside);
    near(point.unwrap(), [60f64.sqrt(), 2.0]);
    // Against a boss and around it.
    let boss = arc([-10.0, 0.0], [0.0, 10.0], [0.0, 0.0], -1);
    let (kind, point) = corner(line([-20.0, 0.0], [-10.0, 0.0]), boss, Side::Left);
    assert_eq!(kind, Corner::Inside);
    near(point.unwrap(), [-(140f64.sqrt()), 2.0]);
}

#[test]
fn o6_arc_and_line() {
    let wall = arc([0.0, -10.0], [10.0, 0.0], [0.0, 0.0], 1);
    let (kind, point) = corner(wall, line([10.0, 0.0], [0.0, 0.0]), Side::Left);
    assert_eq!(kind, Corner::Inside);
    near(point.unwrap(), [60f64.sqrt(), -2.0]);
    let boss = arc([0.0, 10.0], [10.0, 0.0], [0.0, 0.0], -1);
    let (kind, point) = corner(boss, line([10.0, 0.0], [20.0, 0.0]), Side::Left);
    assert_eq!(kind, Corner::Inside);
    near(point.unwrap(), [140f64.sqrt(), 2.0]);
}

#[test]
fn o7_two_arcs() {
    // Between two bosses of radius 5 that touch at the origin's left and right.
    let first = arc([-5.0, 5.0], [0.0, 0.0], [-5.0, 0.0], -1);
    let second = arc([0.0, 0.0], [5.0, 5.0], [5.0, 0.0], -1);
    let (kind, point) = corner(first, second, Side::Left);
    assert_eq!(kind, Corner::Inside);
    near(point.unwrap(), [0.0, 24f64.sqrt()]);
    // A wall with a nose: both arcs hold the tool inside.
    let first = arc([-3.0, -8.0], [0.0, -7.0], [-3.0, -3.0], 1);
    let second = arc([0.0, -7.0], [3.0, -8.0], [3.0, -3.0], 1);
    assert_eq!(corner(first, second, Side::Left).0, Corner::Outside);
}

#[test]
fn turning_back_is_inside_where_the_arms_pinch_the_tool() {
    let boss = |radius: f64| arc([-radius, -radius], [0.0, 0.0], [0.0, -radius], -1);
    let back = line([0.0, 0.0], [-10.0, 0.0]);
    assert_eq!(corner(boss(5.0), back, Side::Left).0, Corner::Inside);
    let hollow = arc([-5.0, 5.0], [0.0, 0.0], [0.0, 5.0], 1);
    assert_eq!(corner(hollow, back, Side::Left).0, Corner::Outside);
    let pocket = |radius: f64| arc([0.0, 0.0], [-radius, -radius], [0.0, -radius], 1);
    assert_eq!(corner(boss(5.0), pocket(6.0), Side::Left).0, Corner::Inside);
    assert_eq!(corner(boss(5.0), pocket(4.0), Side::Left).0, Corner::Outside);
}

#[test]
fn ways_that_do_not_meet_have_no_corner() {
    let far = track(arc([30.0, 0.0], [0.0, 30.0], [0.0, 0.0], 1), Side::Left);
    let away = track(line([-10.0, 40.0], [10.0, 40.0]), Side::Left);
    assert_eq!(meet(&away, &far, [0.0, 0.0], Side::Left, R), None);
    assert_eq!(meet(&far, &far, [0.0, 0.0], Side::Left, R), None);
}

#[test]
fn o9_an_entry_arc_ends_tangent_to_the_programmed_one() {
    let programmed = arc([-10.0, 0.0], [0.0, 10.0], [0.0, 0.0], -1);
    let (track, center) = Track::entry_arc(&programmed, Side::Left, R).expect("it is long enough");
    near(track.to, [0.0, 12.0]);
    assert!(center[0].abs() < 1e-12);
    let radius = 12.0 - center[1];
    assert!((distance(center, [-10.0, 0.0]) - radius).abs() < 1e-12);
    let short = arc([0.0, 10.0], [6.0, 8.0], [0.0, 0.0], -1);
    assert_eq!(Track::entry_arc(&short, Side::Right, 2.5), None);
}

#[test]
fn corners_use_a_track_up() {
    let mut east = track(line([0.0, 0.0], [10.0, 0.0]), Side::Left);
    assert!(east.begin_at([4.0, 2.0]));
    assert!(east.end_at([4.0, 2.0]));
    assert!(!east.end_at([3.9, 2.0]));
    let mut quarter = track(arc([5.0, 0.0], [0.0, 5.0], [0.0, 0.0], 1), Side::Right);
    let at = |degrees: f64| [7.0 * libm::cos(degrees.to_radians()), 7.0 * libm::sin(degrees.to_radians())];
    assert!(quarter.begin_at(at(50.0)));
    assert!(quarter.end_at(at(51.0)));
    assert!(!quarter.end_at(at(49.0)));
}
