//! The contour of a cycle as it is, without tools and allowances.
//!
//! In: calls of its blocks. Out: lines and arcs in the plane of Z and X, a radius, and which of them are
//! rapids.

use crate::canon::{Arc, Call, Place, Sink, X, Z};
use crate::execute::Done;
use crate::geometry::contour::{Point, Segment};

/// Keeps the moves of a contour, and whether they are rapids.
pub(super) struct Shape {
    pub(super) at: Point,
    pub(super) segments: Vec<(Segment, bool)>,
}

impl Sink for Shape {
    fn call(&mut self, _: Place, call: Call<'_>) -> Done {
        let rapid = matches!(call, Call::StraightTraverse(_));
        let segment = match call {
            Call::StraightTraverse(end) | Call::StraightFeed(end) => {
                Segment::line(self.at, Point::new(end[Z], end[X]))
            }
            Call::ArcFeed(Arc { end, center, turns, .. }) => {
                let [end, center] = [end, center].map(|[z, x]| Point::new(z, x));
                Segment::arc(self.at, end, center, turns > 0)
            }
            _ => return Ok(()),
        };
        self.at = segment.end;
        if segment.chord() > 0.0 || segment.bend.is_some() || self.segments.is_empty() {
            self.segments.push((segment, rapid));
        }
        Ok(())
    }
}
