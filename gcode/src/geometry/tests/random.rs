//! Random contours in the frame of the cuts: towards −Z, lines, walls and arcs that rise or fall.

use proptest::prelude::*;

use crate::geometry::contour::{Point, Segment};

/// A contour of two to nine segments that begins at Z0.
pub(crate) fn contours() -> impl Strategy<Value = Vec<Segment>> {
    let step = (0..5u8, 0.5..6.0f64, -4.0..5.0f64, 1.0..3.0f64);
    (5.0..15.0f64, prop::collection::vec(step, 2..10)).prop_map(|(x, steps)| {
        let mut at = Point::new(0.0, x);
        let mut contour: Vec<Segment> = Vec::new();
        for (kind, advance, rise, bulge) in steps {
            let end = match kind {
                0 => Point::new(at.z, at.x + rise),
                1 => Point::new(at.z - advance, at.x),
                _ => Point::new(at.z - advance, at.x + rise),
            };
            let line = Segment::line(at, end);
            let arc = Segment::arc_of_radius(at, end, bulge * at.distance(end) / 2.0, kind == 3);
            let next = arc.filter(|arc| kind > 2 && arc.is_monotone()).unwrap_or(line);
            let back = contour.last().is_some_and(|last| last.is_wall() && next.is_wall());
            if next.chord() > 0.1 && !back {
                at = end;
                contour.push(next);
            }
        }
        contour.push(Segment::line(at, Point::new(at.z - 1.0, at.x + 0.5)));
        contour
    })
}

/// Points of a segment, in order, its ends among them.
pub(crate) fn points(segment: &Segment) -> Vec<Point> {
    (0..=40)
        .map(|n| {
            let part = f64::from(n) / 40.0;
            let way = segment.start + (segment.end - segment.start) * part;
            match segment.bend {
                Some(_) if n != 0 && n != 40 => Point::new(way.z, segment.x_at(way.z)),
                _ => way,
            }
        })
        .collect()
}

/// Distance of a point from a contour.
pub(crate) fn distance(at: Point, contour: &[Segment]) -> f64 {
    let one = |segment: &Segment| {
        let ends = at.distance(segment.start).min(at.distance(segment.end));
        let side = match segment.bend {
            None => {
                let t = segment.direction(segment.start);
                let along = (at - segment.start).dot(t);
                if (0.0..=segment.chord()).contains(&along) {
                    (at - segment.start).cross(t).abs()
                } else {
                    f64::INFINITY
                }
            }
            Some(bend) => {
                let way = at - bend.center;
                let foot = bend.center + way * (segment.radius() / way.length());
                let upper = (foot.x > bend.center.x) == bend.ccw;
                if upper && foot.z <= segment.start.z && foot.z >= segment.end.z {
                    (way.length() - segment.radius()).abs()
                } else {
                    f64::INFINITY
                }
            }
        };
        ends.min(side)
    };
    contour.iter().map(one).fold(f64::INFINITY, f64::min)
}
