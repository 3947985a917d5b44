//! How near a mill keeps to a circle of 10 mm at 2 m/min: the whole machine in one process, its controllers
//! knowing masses and frictions a little wrong, as in the built-in machine file.
#![allow(clippy::unwrap_used)]

use machine::{Machine, SMALL_MILL};
use protocol::{Arc, Axis, Code, Feed, Item, PerAxis, Plane, Position, SpindleMode, SpindleSpeed};
use rig::observe::{MovesReport, Observation, Outcome};

use crate::stand::Stand;

fn point(place: [f64; 3]) -> PerAxis<Position> {
    let mut point = [Position(0); 8];
    for (at, mm) in point.iter_mut().zip(place) {
        *at = Position::from_mm(mm);
    }
    point
}

/// In from the inside on a quarter that touches the circle, twice around 0, 0 in line 4, and out again.
fn program(radius_mm: f64, feed: Feed) -> Vec<Item> {
    let arc = |x: f64, y: f64, center: [f64; 2], turns: i32| {
        let center = center.map(Position::from_mm);
        Code::Arc { arc: Arc { plane: Plane::Xy, target: point([x, y, -1.0]), center, turns }, feed }
    };
    let inside = radius_mm - 3.0;
    let codes = [
        Code::Line { target: point([inside, -3.0, 2.0]), feed: Feed::Rapid },
        Code::Line { target: point([inside, -3.0, -1.0]), feed: Feed::PerMinute(500.0) },
        arc(radius_mm, 0.0, [inside, 0.0], 1),
        arc(radius_mm, 0.0, [0.0; 2], 2),
        arc(inside, 3.0, [inside, 0.0], 1),
        Code::Line { target: point([0.0, 3.0, -1.0]), feed },
        Code::Line { target: point([0.0, 3.0, 20.0]), feed: Feed::Rapid },
        Code::Spindle { mode: SpindleMode::Stop, speed: SpindleSpeed::Rpm(0.0) },
        Code::End,
    ];
    (1..).zip(codes).map(|(line, code)| Item { line, code }).collect()
}

fn run(machine: &str, items: &[Item]) -> Observation {
    let machine = Machine::from_toml(machine).unwrap();
    Stand { machine: &machine, items, scenario: "", seed: 5 }.run(|_| None)
}

fn moves(machine: &str) -> MovesReport {
    let observed = run(machine, &program(5.0, Feed::PerMinute(2000.0)));
    assert_eq!(observed.outcome, Outcome::Completed, "{:?}", observed.faults);
    observed.moves
}

#[test]
fn a_circle_of_10_mm_at_2_m_min_is_round() {
    let moves = moves(SMALL_MILL);
    let [circle] = &moves.circles[..] else { panic!("{:?}", moves.circles) };
    assert_eq!((circle.line, circle.plane), (4, [Axis::X, Axis::Y]));
    assert_eq!(moves.limit_violations, 0);
    assert!((circle.feed_mm_min - 2000.0).abs() < 20.0, "{} mm/min", circle.feed_mm_min);
    assert!(circle.quadrants_um.iter().all(|glitch| glitch.abs() > 0.1), "friction shows: {circle:?}");
    assert!(moves.contour_max_um <= 3.0, "{} µm in line {}", moves.contour_max_um, moves.contour_line);
}
