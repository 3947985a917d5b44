//! The frame of the cuts: which way a contour is turned so that it runs towards −Z with the tool on its +X
//! side.
//!
//! Turning and facing, outside and inside, towards the chuck and away from it differ by a change of axes and
//! signs alone. [`Frame::enter`] leads into the frame, [`Frame::leave`] back.

use libm::atan2;
use std::f64::consts::PI;

use super::contour::{Bend, NEAR, Point, Segment};

/// Chords that stand for a segment where it is looked at.
const CHORDS: u32 = 16;

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
    /// The frame to rough a contour in that the tool comes to from `start`. Passes run in the sense of the
    /// contour. The tool is on that side where `start` is, seen from the beginning of the contour in the
    /// direction of infeed. If both are level, it is where the area lies that the contour and the ways from
    /// `start` and back to it enclose.
    pub(crate) fn of(contour: &[Segment], start: Point, facing: bool) -> Frame {
        let frame = Frame::along(contour, facing);
        let above = contour.first().map_or(0.0, |first| frame.enter(start).x - frame.enter(first.start).x);
        let up = if above.abs() > NEAR { above } else { frame.enclosed(contour, start) };
        Frame { x: if up < 0.0 { -1.0 } else { 1.0 }, ..frame }
    }

    /// The frame to finish a contour in. The tool is on that side of it where `start` is, the contour made
    /// longer straight on at both ends; if `start` is on it, where the area of [`Frame::of`] lies.
    pub(crate) fn beside(contour: &[Segment], start: Point, facing: bool) -> Frame {
        let frame = Frame::along(contour, facing);
        let framed: Vec<Segment> = contour.iter().map(|segment| frame.enter_segment(segment)).collect();
        let up = sight(&framed, frame.enter(start))
            .map_or_else(|| frame.enclosed(contour, start), |turned_left| -turned_left);
        Frame { x: if up < 0.0 { -1.0 } else { 1.0 }, ..frame }
    }

    /// Where the tool goes down from to the beginning of a contour that has been turned into this frame: at
    /// the X of `start`, no farther along than the beginning, so that the first rapid runs along Z.
    pub(crate) fn above(&self, framed: &[Segment], start: Point) -> Point {
        let start = self.enter(start);
        framed.first().map_or(start, |first| Point::new(start.z.max(first.start.z), start.x))
    }

    /// The frame in which a contour runs towards −Z.
    fn along(contour: &[Segment], facing: bool) -> Frame {
        let mut frame = Frame { facing, z: 1.0, x: 1.0 };
        if let (Some(first), Some(last)) = (contour.first(), contour.last())
            && frame.enter(last.end).z > frame.enter(first.start).z
        {
            frame.z = -1.0;
        }
        frame
    }

    /// Twice the area that a contour and the ways from `start` and back to it enclose; positive if travel is
    /// clockwise around it: towards −Z below it.
    fn enclosed(&self, contour: &[Segment], start: Point) -> f64 {
        let (mut area, mut at) = (0.0, Point::default());
        for next in contour.iter().map(|segment| segment.start).chain(contour.last().map(|last| last.end)) {
            let next = self.enter(next) - self.enter(start);
            area += at.cross(next);
            at = next;
        }
        -area
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

/// The angle by which the sight of a monotone contour turns, as seen from `at`, when one walks along it from
/// infinity to infinity, the contour made longer straight on at both ends: positive if `at` is on its left.
/// `None` if `at` is on it. Radians.
pub(crate) fn sight(contour: &[Segment], at: Point) -> Option<f64> {
    let (first, last) = (contour.first()?, contour.last()?);
    let (mut turned, mut seen) = (0.0, first.direction(first.start) * -1.0);
    let mut look = |next: Point| {
        let angle = atan2(seen.cross(next), seen.dot(next));
        turned += angle;
        seen = next;
        (next.length() > NEAR && PI - angle.abs() > NEAR).then_some(())
    };
    look(first.start - at)?;
    for segment in contour.iter().filter(|segment| segment.chord() > NEAR) {
        let chords = if segment.bend.is_some() { CHORDS } else { 1 };
        for n in 1..chords {
            let z = segment.start.z + (segment.end.z - segment.start.z) * f64::from(n) / f64::from(chords);
            look(Point::new(z, segment.x_at(z)) - at)?;
        }
        look(segment.end - at)?;
    }
    look(last.direction(last.end))?;
    Some(turned)
}
