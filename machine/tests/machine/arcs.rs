//! Arcs of machine code: which ends make one, and which of the machine's travel they need.
#![allow(clippy::unwrap_used)]

use machine::Machine;
use proptest::prelude::*;
use protocol::{Arc, Axis, PerAxis, Plane, Position, Refused};

fn point(x: f64, z: f64) -> PerAxis<Position> {
    let mut point = [Position(0); 8];
    (point[0], point[2]) = (Position::from_mm(x), Position::from_mm(z));
    point
}

fn arc(x: f64, z: f64, center: [f64; 2], turns: i32) -> Arc {
    let [x_center, z_center] = center.map(Position::from_mm);
    Arc { plane: Plane::Zx, target: point(x, z), center: [z_center, x_center], turns }
}

/// X and Z of a corner, mm.
fn xz(corner: &PerAxis<Position>) -> [f64; 2] {
    [Axis::X, Axis::Z].map(|axis| corner[axis.index()].mm())
}

#[test]
fn g3_turns_from_z_towards_x() {
    // From (Z 10, X 0) to (Z 0, X 10) about the origin: a quarter one way, three quarters the other.
    let (from, quarter) = (point(0.0, 10.0), 5.0 * std::f64::consts::PI);
    assert!((arc(10.0, 0.0, [0.0, 0.0], 1).path(&from).unwrap().length() - quarter).abs() < 1e-9);
    assert!((arc(10.0, 0.0, [0.0, 0.0], -1).path(&from).unwrap().length() - 3.0 * quarter).abs() < 1e-9);
    assert!((arc(10.0, 0.0, [0.0, 0.0], 2).path(&from).unwrap().length() - 5.0 * quarter).abs() < 1e-9);
}

#[test]
fn the_radii_may_differ_by_as_much_as_is_said() {
    let differ = |r: f64, by: f64| arc(r + by, 0.0, [0.0, 0.0], 1).path(&point(0.0, r)).is_ok();
    assert!(differ(1.0, 0.079) && differ(1.0, -0.079) && !differ(1.0, 0.081));
    assert!(differ(100.0, 0.099) && !differ(100.0, 0.101));
    assert!(differ(10_000.0, 7.49) && !differ(10_000.0, 7.51));
    let refused = arc(20.0, 0.0, [0.0, 0.0], 1).path(&point(0.0, 10.0));
    assert_eq!(refused, Err(Refused::OutOfRange("difference of the radii of an arc")));
    let from_center = arc(20.0, 0.0, [0.0, 0.0], 1).path(&point(0.0, 0.0));
    assert_eq!(from_center, Err(Refused::OutOfRange("radius of an arc")));
}

#[test]
fn quadrants_count_for_the_travel() {
    let machine = Machine::plain(); // X −5 to 120, Z −400 to 200
    // A half circle whose ends lie at X 115 and which bulges to X 125, or to X 105.
    let (from, outwards) = (point(115.0, 10.0), arc(115.0, -10.0, [115.0, 0.0], 1));
    let [low, high] = outwards.bounds(&from).unwrap();
    assert_eq!((xz(&low), xz(&high)), ([115.0, -10.0], [125.0, 10.0]));
    assert!(!machine.can_turn(&from, &outwards));
    assert!(machine.can_turn(&from, &Arc { turns: -1, ..outwards }));
    assert!(!machine.can_turn(&from, &Arc { turns: -2, ..outwards }), "a whole turn passes every quadrant");
    let to_the_last_count = arc(110.0, -10.0, [110.0, 0.0], 1);
    assert!(machine.can_turn(&point(110.0, 10.0), &to_the_last_count));
    assert!(!machine.can_turn(&point(110.0, 12.0), &to_the_last_count), "no arc at all");
}

/// Positions of all axes, mm and degrees.
fn at(mm: [f64; 8]) -> PerAxis<Position> {
    mm.map(Position::from_mm)
}

#[test]
fn g3_turns_from_the_first_axis_towards_the_second_in_every_plane() {
    for plane in Plane::ALL {
        let [first, second] = plane.axes().map(Axis::index);
        let (mut from, mut target, mut high) = ([0.0; 8], [0.0; 8], [0.0; 8]);
        (from[first], target[second]) = (10.0, 10.0);
        (high[first], high[second]) = (10.0, 10.0);
        let arc = Arc { plane, target: at(target), center: [Position(0); 2], turns: 1 };
        let quarter = arc.path(&at(from)).unwrap().length();
        assert!((quarter - 5.0 * std::f64::consts::PI).abs() < 1e-9, "{plane:?}: {quarter}");
        assert_eq!(arc.bounds(&at(from)).unwrap(), [at([0.0; 8]), at(high)], "{plane:?}");
    }
}

#[test]
fn a_helix_takes_the_other_axes_along() {
    // Two turns of 10 mm in XY, 30 mm up, 90 degrees of C, V down by 1.
    let from = at([10.0, 0.0, -5.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    let target = at([10.0, 0.0, 25.0, 0.0, 0.0, 90.0, 0.0, 0.0]);
    let arc = Arc { plane: Plane::Xy, target, center: [Position(0); 2], turns: 2 };
    let [low, high] = arc.bounds(&from).unwrap();
    let expected =
        [[-10.0, -10.0, -5.0, 0.0, 0.0, 0.0, 0.0, 0.0], [10.0, 10.0, 25.0, 0.0, 0.0, 90.0, 0.0, 1.0]];
    for (corner, expected) in [low, high].iter().zip(expected) {
        for (axis, mm) in corner.iter().zip(expected) {
            assert!((axis.mm() - mm).abs() < 2e-9, "{low:?} {high:?}");
        }
    }
    let path = arc.path(&from).unwrap();
    let length = libm::hypot(40.0 * std::f64::consts::PI, libm::hypot(30.0, 1.0));
    assert!((path.length() - length).abs() < 1e-9, "C does not count: {}", path.length());
    let [middle, ..] = path.at(0.5 * path.length());
    assert!((middle[2] - 15.0).abs() < 1e-9 && (middle[5] - 45.0).abs() < 1e-9);
}

proptest! {
    /// Ends that were rounded to counts do not make a quadrant leave the travel, nor a whole turn vanish.
    #[test]
    fn rounding_does_no_harm(r in 0.01..500.0_f64, angle in 0.0..6.0_f64, way in 1e-3..6.0_f64, turns in 1..4) {
        let at = |angle: f64| point(r * libm::sin(angle), r * libm::cos(angle));
        let arc = |to, turns| Arc { target: at(to), turns, ..arc(0.0, 0.0, [0.0, 0.0], 1) };
        let [low, high] = arc(angle + way, turns).bounds(&at(angle)).unwrap();
        for corner in [low, high] {
            prop_assert!(xz(&corner).iter().all(|mm| mm.abs() <= r + 2e-9), "{corner:?} of {r}");
        }
        let circle = arc(angle, turns).path(&at(angle)).unwrap();
        prop_assert!((circle.length() / (std::f64::consts::TAU * r * f64::from(turns)) - 1.0).abs() < 1e-6);
    }
}
