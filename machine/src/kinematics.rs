//! Kinematics, one function each way: where the axes stand for a programmed point, and which point they stand
//! at. In and out: mm, and degrees for A, B, C. The point is that of the tool in the coordinates of the
//! machine; X of a lathe is a radius, and the point of a positioner is where its axes stand: what a beam
//! meets there depends on the part, and seams ask `shape`. No state, no clock: the planner and the readers of
//! programs ask the same two functions.
//!
//! A machine whose axes are no coordinates of the tool (a robot, a tilting head) gets its arm in the two
//! matches here.
use protocol::{Axis, PerAxis, units::AXES};

use crate::{Kinematics, Machine, POSITIONER_AXES};

/// A programmed point: X, Y, Z in mm, A, B, C in degrees.
pub type Point = [f64; 6];

/// The coordinates of a [`Point`], in order.
pub const COORDINATES: [Axis; 6] = [Axis::X, Axis::Y, Axis::Z, Axis::A, Axis::B, Axis::C];

/// A point that the machine cannot go to for want of an axis.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the point has {axis} {at} {unit}, and this machine has no axis {axis}: leave the word out, or describe the axis \
     in [axis.{name}] of the machine file",
    unit = axis.unit(), name = axis.name()
)]
pub struct MissingAxis {
    /// The axis.
    pub axis: Axis,
    /// Where it would have to stand, mm or degrees.
    pub at: f64,
}

impl Kinematics {
    /// Where the axes stand for a programmed point; those of no use in this kinematics stand at 0.
    pub fn axes(self, point: &Point) -> PerAxis<f64> {
        let mut axes = [0.0; AXES];
        match self {
            Kinematics::Lathe | Kinematics::Mill | Kinematics::Positioner => {
                for (axis, at) in COORDINATES.into_iter().zip(point) {
                    axes[axis.index()] = *at;
                }
            }
        }
        axes
    }

    /// The point at which the axes stand: the inverse of [`Kinematics::axes`].
    pub fn point(self, axes: &PerAxis<f64>) -> Point {
        match self {
            Kinematics::Lathe | Kinematics::Mill | Kinematics::Positioner => {
                COORDINATES.map(|axis| axes[axis.index()])
            }
        }
    }

    /// The axes such a machine needs, those it may have besides, and the rule in words.
    pub(crate) fn axis_set(self) -> (&'static [Axis], &'static [Axis], &'static str) {
        match self {
            Kinematics::Lathe => (
                &[Axis::X, Axis::Z],
                &[Axis::C],
                "a lathe needs [axis.x] and [axis.z], and may have [axis.c]",
            ),
            Kinematics::Positioner => (
                &POSITIONER_AXES,
                &[],
                "a positioner has [axis.x], [axis.y], [axis.a] and [axis.c], and no others",
            ),
            Kinematics::Mill => (
                &[Axis::X, Axis::Y, Axis::Z],
                &[Axis::A, Axis::B, Axis::C],
                "a mill needs [axis.x], [axis.y] and [axis.z], and may have [axis.a], [axis.b] and [axis.c]",
            ),
        }
    }
}

impl Machine {
    /// Where the axes of this machine stand for a programmed point.
    ///
    /// # Errors
    /// [`MissingAxis`] names the first axis that the machine does not have and that would not stand at 0.
    pub fn axes_at(&self, point: &Point) -> Result<PerAxis<f64>, MissingAxis> {
        let axes = self.general.kinematics.axes(point);
        let missing = |axis: &Axis| axes[axis.index()] != 0.0 && !self.axis.contains_key(axis);
        match Axis::ALL.into_iter().find(missing) {
            Some(axis) => Err(MissingAxis { axis, at: axes[axis.index()] }),
            None => Ok(axes),
        }
    }
}
