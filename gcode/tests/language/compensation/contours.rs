//! Random contours: the tool's way keeps its distance, or the contour is refused.

use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

use super::{Move, run};

/// A point of the plane.
type Point = [f64; 2];

/// A line, or an arc with its centre and the sense of its turn.
#[derive(Clone, Copy, Debug)]
struct Element {
    from: Point,
    to: Point,
    arc: Option<(Point, i32)>,
}

#[derive(Clone, Copy, PartialEq)]
enum Side {
    Left,
    Right,
}

fn distance(a: Point, b: Point) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

/// An element: turn at its start, then length of a line, or radius and angle (> 0 left) of an arc.
#[derive(Clone, Copy, Debug)]
enum Leg {
    Line(f64, f64),
    Arc(f64, f64, f64),
}

fn turns() -> impl Strategy<Value = f64> {
    // Corners that are tangent within LinuxCNC's tolerance keep the distance within that tolerance only.
    prop_oneof![Just(0.0), 0.1..2.0, -2.0..-0.1, 2.0..3.0, -3.0..-2.0]
}

fn legs() -> impl Strategy<Value = Vec<Leg>> {
    let sweep = prop_oneof![0.2..1.2, -1.2..-0.2];
    let leg = prop_oneof![
        (turns(), 1.0..30.0).prop_map(|(turn, length)| Leg::Line(turn, length)),
        (turns(), 1.0..20.0, sweep).prop_map(|(turn, radius, sweep)| Leg::Arc(turn, radius, sweep)),
    ];
    prop::collection::vec(leg, 1..8)
}

fn direction(angle: f64) -> Point {
    [libm::cos(angle), libm::sin(angle)]
}

fn along(p: Point, s: f64, angle: f64) -> Point {
    let t = direction(angle);
    [p[0] + s * t[0], p[1] + s * t[1]]
}

/// Whether an element and the next one bend by less than half a turn together: else they may meet elsewhere,
/// which compensation does not see.
fn open(legs: &[Leg], number: usize) -> bool {
    let parts = |leg: &Leg| match *leg {
        Leg::Line(turn, _) => [turn.abs(), 0.0],
        Leg::Arc(turn, _, sweep) => [turn.abs(), sweep.abs()],
    };
    let ([_, before], [turn, after]) = (parts(&legs[number - 1]), parts(&legs[number]));
    before + turn + after < PI
}

/// The elements of a contour that begins with an entry along the first axis to the origin.
fn contour(legs: &[Leg]) -> Vec<Element> {
    let (mut p, mut angle) = ([0.0, 0.0], 0.0);
    let mut elements = vec![Element { from: [-30.0, 0.0], to: p, arc: None }];
    for leg in legs {
        let from = p;
        let arc = match *leg {
            Leg::Line(turn, length) => {
                angle += turn;
                p = along(p, length, angle);
                None
            }
            Leg::Arc(turn, radius, sweep) => {
                angle += turn;
                let quarter = PI / 2.0 * sweep.signum();
                let center = along(p, radius, angle + quarter);
                p = along(center, radius, angle + quarter + PI + sweep);
                angle += sweep;
                Some((center, sweep.signum() as i32))
            }
        };
        elements.push(Element { from, to: p, arc });
    }
    elements
}

/// The program of a contour: the element with number i is in line i + 4.
fn program(elements: &[Element], side: Side, r: f64) -> String {
    let start = elements[0].from;
    let code = if side == Side::Left { "G41.1" } else { "G42.1" };
    let mut text = format!("G21 G90.1 F100\nG0 X{} Y{}\n{code} D{}\n", start[0], start[1], 2.0 * r);
    for Element { to, arc, .. } in elements {
        match arc {
            None => text += &format!("G1 X{} Y{}\n", to[0], to[1]),
            Some((m, turns)) => {
                let code = if *turns > 0 { "G3" } else { "G2" };
                text += &format!("{code} X{} Y{} I{} J{}\n", to[0], to[1], m[0], m[1]);
            }
        }
    }
    text + "G40\nM2\n"
}

/// Points of an element, its ends included.
fn points(element: &Element) -> Vec<Point> {
    const COUNT: usize = 40;
    let Element { from, to, arc } = *element;
    (0..=COUNT)
        .map(|i| {
            let part = i as f64 / COUNT as f64;
            let Some((m, turns)) = arc else {
                return [from[0] + part * (to[0] - from[0]), from[1] + part * (to[1] - from[1])];
            };
            let [a, b] = [from, to].map(|p| libm::atan2(p[1] - m[1], p[0] - m[0]));
            let sweep = (f64::from(turns) * (b - a)).rem_euclid(TAU) * f64::from(turns);
            along(m, distance(m, from), a + part * sweep)
        })
        .collect()
}

/// Distance of a point from an element.
fn gap(p: Point, element: &Element) -> f64 {
    let Element { from, to, arc } = *element;
    let ends = distance(p, from).min(distance(p, to));
    match arc {
        None => {
            let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
            let part = ((p[0] - from[0]) * dx + (p[1] - from[1]) * dy) / (dx * dx + dy * dy);
            let foot = [from[0] + part * dx, from[1] + part * dy];
            if (0.0..=1.0).contains(&part) { distance(p, foot) } else { ends }
        }
        Some((m, turns)) => {
            let angle = |q: Point| f64::from(turns) * libm::atan2(q[1] - m[1], q[0] - m[0]);
            let sweep = (angle(to) - angle(from)).rem_euclid(TAU);
            let here = (angle(p) - angle(from)).rem_euclid(TAU);
            if here <= sweep { (distance(p, m) - distance(from, m)).abs().min(ends) } else { ends }
        }
    }
}

/// The moves of the tool's centre with the number of their element.
fn way(moves: &[(u32, Move)]) -> Vec<(usize, Element)> {
    let mut here = [0.0, 0.0];
    let mut way = Vec::new();
    for (line, made) in moves {
        let to = made.end();
        let arc = if let Move::Arc(arc) = made { Some((arc.center, arc.turns)) } else { None };
        if *line >= 4 {
            way.push((*line as usize - 4, Element { from: here, to, arc }));
        }
        here = to;
    }
    way
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn the_tool_touches_its_element_and_cuts_into_no_neighbour(
        legs in legs(), left in any::<bool>(), r in 0.1..8.0,
    ) {
        let side = if left { Side::Left } else { Side::Right };
        let elements = contour(&legs);
        let (record, problem) = run(&program(&elements, side, r));
        if let Some(problem) = problem {
            prop_assert_eq!(problem.code, "compensation-gouge", "{}", problem.render(false));
            return Ok(());
        }
        for (number, made) in way(&record.moves) {
            if number == 0 {
                continue; // the entry comes from where it likes
            }
            for point in points(&made) {
                let corner = made.arc.filter(|(center, _)| *center == elements[number].from);
                let own = corner.map_or(gap(point, &elements[number]), |(center, _)| distance(point, center));
                prop_assert!((own - r).abs() < 1e-9, "element {number}: {own} instead of {r} at {point:?}");
                for other in [number - 1, number + 1] {
                    let seen = other > 0 && other < elements.len() && open(&legs, number.min(other));
                    if !seen || other > number && corner.is_some() {
                        continue;
                    }
                    let gap = gap(point, &elements[other]);
                    prop_assert!(gap > r - 1e-9, "{number} is {gap} from {other}, not {r}, at {point:?}");
                }
            }
        }
    }

    #[test]
    fn outside_a_convex_contour_nothing_is_refused(
        lengths in prop::collection::vec((0.1..3.0, 1.0..30.0), 1..8), r in 0.1..8.0,
    ) {
        let legs: Vec<Leg> = lengths.iter().map(|(turn, length)| Leg::Line(*turn, *length)).collect();
        let elements = contour(&legs);
        let (record, problem) = run(&program(&elements, Side::Right, r));
        prop_assert!(problem.is_none());
        prop_assert_eq!(record.moves.len(), 2 + 2 * legs.len());
    }

    #[test]
    fn any_numbers_make_finite_moves_or_an_error(
        numbers in prop::collection::vec(prop_oneof![
            Just(0.0f64), Just(1.0), Just(-1.0), Just(5.0), Just(1e-12), Just(1e300), Just(-1e300), -9.0..9.0,
        ], 8..40),
        lathe in any::<bool>(),
    ) {
        let mut text = String::from("G21 G90.1 F100\n");
        text += if lathe { "G18 G41.1 L3" } else { "G42.1" };
        text += &format!(" D{}\n", numbers[0]);
        for (i, four) in numbers[1..].chunks_exact(4).enumerate() {
            let code = ["G1", "G2", "G3", "G0"][(i + four[0].abs() as usize % 7) % 4];
            let [a, b] = if lathe { ["Z", "K"] } else { ["Y", "J"] };
            text += &format!("{code} X{} {a}{}", four[0], four[1]);
            if i % 2 == 0 && code >= "G2" {
                text += &format!(" I{} {b}{}", four[2], four[3]);
            }
            text.push('\n');
        }
        let (record, _) = run(&text);
        for (_, made) in record.moves {
            let numbers = match made {
                Move::Traverse(to) | Move::Feed(to) => to.to_vec(),
                Move::Arc(arc) => [arc.end, arc.center].concat(),
            };
            prop_assert!(numbers.iter().all(|number| number.is_finite()), "{numbers:?} from\n{text}");
        }
    }
}
