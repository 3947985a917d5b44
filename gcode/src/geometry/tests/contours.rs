//! Segments, frames, corners and allowances.

use proptest::prelude::*;

use super::random::{contours, distance, points};
use crate::geometry::contour::{Point, ROUNDING, Segment, crossings};
use crate::geometry::corner::{Corner, blend};
use crate::geometry::frame::Frame;
use crate::geometry::offset::raised;

fn line(z1: f64, x1: f64, z2: f64, x2: f64) -> Segment {
    Segment::line(Point::new(z1, x1), Point::new(z2, x2))
}

fn near(a: Point, b: Point) -> bool {
    a.distance(b) < 1e-9
}

#[test]
fn a_quarter_by_its_radius_has_the_centre_of_its_sense() {
    let (start, end) = (Point::new(0.0, 5.0), Point::new(-3.0, 8.0));
    let g3 = Segment::arc_of_radius(start, end, 3.0, true).unwrap();
    let g2 = Segment::arc_of_radius(start, end, 3.0, false).unwrap();
    assert!(near(g3.bend.unwrap().center, Point::new(-3.0, 5.0)));
    assert!(near(g2.bend.unwrap().center, Point::new(0.0, 8.0)));
    assert!(Segment::arc_of_radius(start, end, 2.0, true).is_none());
    assert!(near(g3.direction(start), Point::new(0.0, 1.0)));
    assert!(near(g2.direction(start), Point::new(-1.0, 0.0)));
}

#[test]
fn x_and_z_of_a_valley() {
    let valley = Segment::arc(Point::new(4.0, 5.0), Point::new(-4.0, 5.0), Point::new(0.0, 8.0), false);
    assert!(valley.is_monotone());
    assert!((valley.x_at(0.0) - 3.0).abs() < 1e-12);
    let (down, up) = valley.halves();
    let up = up.unwrap();
    assert!(near(down.end, Point::new(0.0, 3.0)) && near(up.start, down.end));
    assert!((down.z_at(4.0).unwrap() - 3.0).abs() < 1e-12 && (up.z_at(4.0).unwrap() + 3.0).abs() < 1e-12);
    assert_eq!(down.z_at(2.9), None);
}

#[test]
fn more_than_half_a_turn_is_not_monotone() {
    let arc = |ccw| Segment::arc(Point::new(3.0, 4.0), Point::new(-3.0, 4.0), Point::new(0.0, 8.0), ccw);
    assert!(arc(false).is_monotone());
    assert!(!arc(true).is_monotone());
    assert!(!line(0.0, 5.0, 0.1, 6.0).is_monotone());
    assert!(line(0.0, 5.0, 0.0005, 6.0).is_monotone());
}

#[test]
fn the_tool_is_on_the_upper_side_of_every_frame() {
    // contour, start, facing
    let steps = |z: f64, x: f64| {
        vec![line(0.0, 5.0 * x, -10.0 * z, 5.0 * x), line(-10.0 * z, 5.0 * x, -20.0 * z, 9.0 * x)]
    };
    for (z, x) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        let (contour, start) = (steps(z, x), Point::new(2.0 * z, 12.0 * x));
        let frame = Frame::of(&contour, start, false);
        assert_eq!((frame.z, frame.x), (z, x));
        assert!(near(frame.leave(frame.enter(start)), start));
        let swapped: Vec<Segment> =
            contour.iter().map(|s| line(s.start.x, s.start.z, s.end.x, s.end.z)).collect();
        let frame = Frame::of(&swapped, Point::new(start.x, start.z), true);
        assert_eq!((frame.z, frame.x), (z, x));
    }
}

#[test]
fn a_bore_that_widens_inside_is_cut_from_the_inside() {
    let contour = [line(0.0, 5.0, -5.0, 5.0), line(-5.0, 5.0, -10.0, 8.0)];
    assert_eq!(Frame::of(&contour, Point::new(2.0, 4.0), false).x, -1.0);
    assert_eq!(Frame::of(&contour, Point::new(2.0, 9.0), false).x, 1.0);
}

#[test]
fn a_fillet_touches_both_lines() {
    let (floor, wall) = (line(0.0, 5.0, -10.0, 5.0), line(-10.0, 5.0, -10.0, 9.0));
    let [before, arc, after] = blend(&floor, &wall, Corner::Fillet(2.0)).unwrap();
    assert!(near(before.end, Point::new(-8.0, 5.0)) && near(after.start, Point::new(-10.0, 7.0)));
    let bend = arc.bend.unwrap();
    assert!(near(bend.center, Point::new(-8.0, 7.0)) && !bend.ccw);
    let [_, chamfer, _] = blend(&floor, &wall, Corner::Chamfer(2.0)).unwrap();
    assert_eq!(chamfer, line(-8.0, 5.0, -10.0, 7.0));
    assert!(blend(&floor, &wall, Corner::Fillet(4.1)).is_none());
    assert!(blend(&floor, &line(-10.0, 5.0, -20.0, 5.0), Corner::Fillet(1.0)).is_none());
}

#[test]
fn a_step_with_an_allowance() {
    let step = [line(0.0, 5.0, -10.0, 5.0), line(-10.0, 5.0, -10.0, 9.0), line(-10.0, 9.0, -20.0, 9.0)];
    let path = raised(&step, 0.5).unwrap();
    assert_eq!(path.len(), 4);
    assert!(near(path[0].end, Point::new(-9.5, 5.5)));
    assert!(near(path[1].end, Point::new(-9.5, 9.0)));
    assert!(near(path[2].end, Point::new(-10.0, 9.5)) && path[2].bend.unwrap().ccw);
    assert!(near(path[3].end, Point::new(-20.0, 9.5)));
    let path = raised(&step, -0.5).unwrap();
    assert!(near(path[0].end, Point::new(-10.0, 4.5)) && !path[1].bend.unwrap().ccw);
}

#[test]
fn a_notch_narrower_than_the_allowance_closes() {
    let notch = [
        line(0.0, 5.0, -5.0, 5.0),
        line(-5.0, 5.0, -5.0, 2.0),
        line(-5.0, 2.0, -5.8, 2.0),
        line(-5.8, 2.0, -5.8, 5.0),
        line(-5.8, 5.0, -9.0, 5.0),
    ];
    let path = raised(&notch, 0.5).unwrap();
    let lowest = path.iter().flat_map(points).map(|at| at.x).fold(f64::INFINITY, f64::min);
    assert!((lowest - 5.3).abs() < 1e-9, "{lowest}"); // two arcs of 0.5 that are 0.8 apart
}

#[test]
fn a_spike_gets_half_a_circle() {
    let spike = [
        line(0.0, 5.0, -5.0, 5.0),
        line(-5.0, 5.0, -5.0, 8.0),
        line(-5.0, 8.0, -5.0, 5.0),
        line(-5.0, 5.0, -9.0, 5.0),
    ];
    let path = raised(&spike, 0.5).unwrap();
    assert!(path.iter().flat_map(points).all(|at| distance(at, &spike) > 0.5 - 1e-9));
    assert!(
        path.iter().any(|segment| segment.bend.is_some_and(|bend| near(bend.center, Point::new(-5.0, 8.0))))
    );
}

#[test]
fn a_small_allowance_leaves_arcs_on_their_circles() {
    let center = Point::new(1.3480808, 11.3694658);
    let (start, end) = (Point::new(0.0, 5.0), Point::new(-4.9784325, 9.8323757));
    let contour =
        [Segment::arc(start, end, center, false), Segment::line(end, Point::new(-5.4784325, 7.6271617))];
    for segment in raised(&contour, 0.0045).unwrap() {
        if let Some(bend) = segment.bend {
            assert!((segment.radius() - segment.end.distance(bend.center)).abs() < 1e-5, "{segment:?}");
        }
    }
}

proptest! {
    #[test]
    fn an_allowance_is_the_same_everywhere(contour in contours(), d in 0.02..2.0f64) {
        let Some(path) = raised(&contour, d) else { return Ok(()) };
        for pair in path.windows(2) {
            prop_assert!(pair[0].end.distance(pair[1].start) < 1e-5);
        }
        for segment in &path {
            prop_assert!(segment.start.z > segment.end.z - 1e-6, "{segment:?}");
            for at in points(segment) {
                let from = distance(at, &contour);
                prop_assert!(from > d - 1.1 * ROUNDING, "{from} at {at:?}");
                prop_assert!(from < d + 0.02, "{from} at {at:?}");
            }
        }
    }

    #[test]
    fn a_negative_allowance_is_below(contour in contours(), d in -1.0..-0.02f64) {
        let Some(path) = raised(&contour, d) else { return Ok(()) };
        for segment in &path {
            prop_assert!(segment.start.z > segment.end.z - 1e-6, "{segment:?}");
            for at in points(segment) {
                prop_assert!(at.z.is_finite() && at.x.is_finite());
                let over = contour.iter().find(|s| !s.is_wall() && s.start.z >= at.z && s.end.z <= at.z);
                prop_assert!(over.is_none_or(|over| at.x < over.x_at(at.z) + 1e-3), "{at:?}");
            }
        }
    }

    #[test]
    fn crossings_are_on_both(a in contours(), b in contours()) {
        for (one, other) in a.iter().zip(&b) {
            for at in crossings(one, other).into_iter().flatten() {
                for segment in [one, other] {
                    let off = match segment.bend {
                        Some(bend) => at.distance(bend.center) - segment.radius(),
                        None => (at - segment.start).cross(segment.direction(segment.start)),
                    };
                    prop_assert!(off.abs() < 1e-3 * (1.0 + at.length() / 100.0), "{off} at {at:?}");
                }
            }
        }
    }
}
