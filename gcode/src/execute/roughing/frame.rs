//! The frame of the cuts: which way a contour is turned so that it runs towards −Z with the tool on its +X side.
//!
//! Turning and facing, outside and inside, towards the chuck and away from it differ by a change of axes and signs
//! alone. [`Frame::enter`] leads into the frame, [`Frame::leave`] back.

use super::contour::{Bend, NEAR, Point, Segment};

/// A change of axes and signs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Passes run along X (facing): Z and X change places.
    pub facing: bool,
    /// Sign of Z in the frame.
    pub z: f64,
    /// Sign of X in the frame.
    pub x: f64,
}

impl Frame {
    /// The frame for a contour that the tool comes to from `start`. Passes run in the sense of the contour. The tool
    /// is on that side of the contour where `start` is, seen from the line through its beginning and the
    /// beginning of its last segment; if `start` is on that line, on the side that the contour ends on, and at last
    /// on the side of the greater X (turning) or nearer to `start` (facing).
    pub fn of(contour: &[Segment], start: Point, facing: bool) -> Frame {
        let mut frame = Frame { facing, z: 1.0, x: 1.0 };
        let (Some(first), Some(last)) = (contour.first(), contour.last()) else { return frame };
        let [begin, knee, end, start] = [first.start, last.start, last.end, start].map(|at| frame.enter(at));
        if end.z > begin.z {
            frame.z = -1.0;
        }
        let way = if knee.distance(begin) > NEAR { knee - begin } else { end - begin };
        // travel is towards −Z of the frame: what is to its right is on +X if Z keeps its sign
        let side = frame.z * -way.cross(start - begin);
        let up = if side.abs() > NEAR {
            side
        } else if (end.x - begin.x).abs() > NEAR {
            end.x - begin.x
        } else {
            start.x - begin.x
        };
        if up < 0.0 {
            frame.x = -1.0;
        }
        frame
    }

    /// A point, seen in the frame.
    pub fn enter(&self, at: Point) -> Point {
        let at = if self.facing { Point::new(at.x, at.z) } else { at };
        Point::new(self.z * at.z, self.x * at.x)
    }

    /// A point of the frame, seen from outside.
    pub fn leave(&self, at: Point) -> Point {
        let at = Point::new(self.z * at.z, self.x * at.x);
        if self.facing { Point::new(at.x, at.z) } else { at }
    }

    /// Whether G2 becomes G3.
    pub fn mirrors(&self) -> bool {
        self.facing != (self.z * self.x < 0.0)
    }

    /// A segment, seen in the frame.
    pub fn enter_segment(&self, segment: &Segment) -> Segment {
        let bend = segment
            .bend
            .map(|bend| Bend { center: self.enter(bend.center), ccw: bend.ccw != self.mirrors() });
        Segment { start: self.enter(segment.start), end: self.enter(segment.end), bend }
    }
}
