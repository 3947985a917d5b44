//! The frame of the cuts: which way a contour is turned so that it runs towards −Z with the tool on its +X
//! side.
//!
//! Turning and facing, outside and inside, towards the chuck and away from it differ by a change of axes and
//! signs alone. [`Frame::enter`] leads into the frame, [`Frame::leave`] back.

use super::contour::{Bend, NEAR, Point, Segment};

/// A change of axes and signs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    /// Passes run along X (facing): Z and X change places.
    pub(crate) facing: bool,
    /// Sign of Z in the frame.
    pub(crate) z: f64,
    /// Sign of X in the frame.
    pub(crate) x: f64,
}

impl Frame {
    /// The frame for a contour that the tool comes to from `start`. Passes run in the sense of the contour.
    /// The tool is on that side where `start` is, seen from the beginning of the contour in the direction of
    /// infeed. If both are level, it is where the area lies that the contour and the ways from `start` and
    /// back to it enclose.
    pub(crate) fn of(contour: &[Segment], start: Point, facing: bool) -> Frame {
        let mut frame = Frame { facing, z: 1.0, x: 1.0 };
        let (Some(first), Some(last)) = (contour.first(), contour.last()) else { return frame };
        if frame.enter(last.end).z > frame.enter(first.start).z {
            frame.z = -1.0;
        }
        let (mut area, mut at) = (0.0, Point::default());
        for next in contour.iter().map(|segment| segment.start).chain([last.end]) {
            let next = frame.enter(next) - frame.enter(start);
            area += at.cross(next);
            at = next;
        }
        let above = frame.enter(start).x - frame.enter(first.start).x;
        // travel is towards −Z below the area: clockwise around it
        let up = if above.abs() > NEAR { above } else { -area };
        if up < 0.0 {
            frame.x = -1.0;
        }
        frame
    }

    /// A point, seen in the frame.
    pub(crate) fn enter(&self, at: Point) -> Point {
        let at = if self.facing { Point::new(at.x, at.z) } else { at };
        Point::new(self.z * at.z, self.x * at.x)
    }

    /// A point of the frame, seen from outside.
    pub(crate) fn leave(&self, at: Point) -> Point {
        let at = Point::new(self.z * at.z, self.x * at.x);
        if self.facing { Point::new(at.x, at.z) } else { at }
    }

    /// Whether G2 becomes G3.
    pub(crate) fn mirrors(&self) -> bool {
        self.facing != (self.z * self.x < 0.0)
    }

    /// A segment, seen in the frame.
    pub(crate) fn enter_segment(&self, segment: &Segment) -> Segment {
        let bend = segment
            .bend
            .map(|bend| Bend { center: self.enter(bend.center), ccw: bend.ccw != self.mirrors() });
        Segment { start: self.enter(segment.start), end: self.enter(segment.end), bend }
    }
}
