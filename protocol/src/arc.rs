//! An arc of machine code: where it ends and about what it turns. Its start is the end of the item before.
//!
//! In: the start. Out: the path (M56), or why there is none; the box that the machine has to have room for.
//! Positions are absolute, X of a lathe a radius, mm or counts of 1e-9 mm (degrees for a rotary axis).
//!
//! Start and end need not have quite the same distance from the centre, because programs round. What
//! RS274/NGC lets pass, in inches, too, is made: the radii may differ by [`Arc::DIFFERENCE_MM`], or by
//! [`Arc::DIFFERENCE_SHARE`] of the radius if that is more, at most by [`Arc::DIFFERENCE_MOST_MM`]. The path
//! goes over from one to the other evenly.

use motion::Path;
use serde::{Deserialize, Serialize};

use crate::{
    refused::{Refused, finite},
    units::{AXES, Axis, PerAxis, Position},
};

/// The plane in which an arc turns, named by its first and its second axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Plane {
    /// G17.
    Xy,
    /// G18.
    Zx,
    /// G19.
    Yz,
}

impl Plane {
    /// Every plane in the order of the wire.
    pub const ALL: [Plane; 3] = [Plane::Xy, Plane::Zx, Plane::Yz];

    /// First and second axis.
    pub fn axes(self) -> [Axis; 2] {
        match self {
            Plane::Xy => [Axis::X, Axis::Y],
            Plane::Zx => [Axis::Z, Axis::X],
            Plane::Yz => [Axis::Y, Axis::Z],
        }
    }
}

/// An arc in a plane. Axes outside of the plane go evenly from their start to their target meanwhile (helix).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Arc {
    /// In which it turns.
    pub plane: Plane,
    /// Absolute end point of every axis.
    pub target: PerAxis<Position>,
    /// Absolute centre: first, second axis of the plane.
    pub center: [Position; 2],
    /// Positive: from the first axis of the plane towards the second, as G3; negative: the other way. ±1 is
    /// at most one whole turn, each one more a whole turn more. Start and end at one place make a whole turn.
    /// Never 0.
    pub turns: i32,
}

impl Arc {
    /// Difference of the radii at both ends that is always allowed, mm.
    pub const DIFFERENCE_MM: f64 = 0.08;
    /// Difference allowed as a share of the radius.
    pub const DIFFERENCE_SHARE: f64 = 0.001;
    /// Difference that is never exceeded, mm.
    pub const DIFFERENCE_MOST_MM: f64 = 7.5;
    /// Most turns, either way.
    pub const MOST_TURNS: u32 = 10_000;
    /// Smallest and largest radius, mm.
    pub const RADIUS_MM: [f64; 2] = [1e-6, 1e6];

    /// Refuses what no start makes an arc of.
    ///
    /// # Errors
    /// Names the field.
    pub fn check(&self) -> Result<(), Refused> {
        if !(1..=Arc::MOST_TURNS).contains(&self.turns.unsigned_abs()) {
            return Err(Refused::OutOfRange("turns of an arc"));
        }
        radius(self.seen_from_center(&self.target)).map(|_| ())
    }

    /// The path from a start, in the order of the wire.
    ///
    /// # Errors
    /// As [`Arc::check`]; the radii at start and end differ by more than is allowed.
    pub fn path(&self, from: &PerAxis<Position>) -> Result<Path<AXES>, Refused> {
        self.check()?;
        let (start, end) = (self.seen_from_center(from), self.seen_from_center(&self.target));
        let (r0, r1) = (radius(start)?, radius(end)?);
        let share = (Arc::DIFFERENCE_SHARE * r0.max(r1)).min(Arc::DIFFERENCE_MOST_MM);
        if (r1 - r0).abs() > Arc::DIFFERENCE_MM.max(share) {
            return Err(Refused::OutOfRange("difference of the radii of an arc"));
        }
        let plane = self.plane.axes().map(Axis::index);
        let drift = std::array::from_fn(|axis| match plane.contains(&axis) {
            true => 0.0,
            false => self.target[axis].mm_from(from[axis]),
        });
        Path::arc(plane, start, end, self.turns, drift, &Axis::METRIC)
            .ok_or(Refused::OutOfRange("radius of an arc"))
    }

    /// The box that holds the whole arc from a start: lowest and highest position of every axis, quadrants
    /// included.
    ///
    /// # Errors
    /// As [`Arc::path`].
    pub fn bounds(&self, from: &PerAxis<Position>) -> Result<[PerAxis<Position>; 2], Refused> {
        let bounds = self.path(from)?.bounds();
        Ok(bounds.map(|corner| std::array::from_fn(|i| from[i].moved(corner[i]))))
    }

    /// A point of the plane from the centre: first, second axis, mm.
    fn seen_from_center(&self, point: &PerAxis<Position>) -> [f64; 2] {
        let [first, second] = self.plane.axes();
        let [first_center, second_center] = self.center;
        [point[first.index()].mm_from(first_center), point[second.index()].mm_from(second_center)]
    }
}

fn radius([first, second]: [f64; 2]) -> Result<f64, Refused> {
    let [least, most] = Arc::RADIUS_MM;
    match finite((first * first + second * second).sqrt(), "radius of an arc")? {
        radius if (least..=most).contains(&radius) => Ok(radius),
        _ => Err(Refused::OutOfRange("radius of an arc")),
    }
}
