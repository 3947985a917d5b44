//! Fillets and chamfers between two segments of a contour.
//!
//! In: two segments that meet, a radius. The centre of a fillet is as far from both as its radius, on the
//! side that the contour turns to: it is where the two cross after both moved by the radius. Moving them back
//! gives the points where the fillet begins and ends. A chamfer joins the same two points.

use super::contour::{NEAR, Point, Segment, crossings};

/// What stands at the end of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Corner {
    /// As programmed.
    Sharp,
    /// An arc of this radius.
    Fillet(f64),
    /// A line between the points where a fillet of this radius would begin and end.
    Chamfer(f64),
}

/// The two segments, shortened, and what goes between them. `None` if the radius is too large for one of
/// them, or the segments do not make a corner.
pub(crate) fn blend(before: &Segment, after: &Segment, corner: Corner) -> Option<[Segment; 3]> {
    let (radius, round) = match corner {
        Corner::Sharp => return None,
        Corner::Fillet(radius) => (radius, true),
        Corner::Chamfer(radius) => (radius, false),
    };
    let turn = before.direction(before.end).cross(after.direction(after.start));
    let left = turn > 0.0;
    let side = if left { -radius } else { radius };
    let ((one, one_left), (two, two_left)) = (before.offset(side), after.offset(side));
    if turn.abs() < NEAR || !one_left || !two_left {
        return None;
    }
    let near = |at: &Point| at.distance(before.end);
    let centers = crossings(&one, &two).into_iter().flatten();
    let center = centers.min_by(|a, b| near(a).total_cmp(&near(b)))?;
    let (start, end) = (foot(before, center), foot(after, center));
    if !holds(before, start) || !holds(after, end) {
        return None;
    }
    let between = if round { Segment::arc(start, end, center, left) } else { Segment::line(start, end) };
    Some([Segment { end: start, ..*before }, between, Segment { start: end, ..*after }])
}

/// The point of the line or circle of a segment that is nearest to `at`.
fn foot(segment: &Segment, at: Point) -> Point {
    match segment.bend {
        None => {
            let t = segment.direction(segment.start);
            segment.start + t * (at - segment.start).dot(t)
        }
        Some(bend) => {
            let (way, r) = (at - bend.center, segment.radius());
            if way.length() > 0.0 { bend.center + way * (r / way.length()) } else { segment.start }
        }
    }
}

/// Whether a point of the line or circle of a segment is between its ends.
fn holds(segment: &Segment, at: Point) -> bool {
    let (start, end) = (segment.start, segment.end);
    match segment.bend {
        None => (at - start).dot(end - start) >= -NEAR && (at - end).dot(start - end) >= -NEAR,
        Some(bend) => {
            let side = if bend.ccw { 1.0 } else { -1.0 };
            let from_center = |point: Point| point - bend.center;
            side * from_center(start).cross(from_center(at)) >= -NEAR
                && side * from_center(at).cross(from_center(end)) >= -NEAR
        }
    }
}
