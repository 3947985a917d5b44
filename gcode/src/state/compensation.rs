//! G41 and G42: the tool beside the contour.

use crate::canon::{Plane, Pose};
use crate::codes::G;
use crate::geometry::track::{Point, Side};

/// G40, G41, G42.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Compensation {
    pub(crate) tool: Option<Cutter>,
    /// From the programmed point to the centre of the tool, as a unit vector; `None` before the entry move.
    pub(crate) normal: Option<Point>,
    /// G40 has ended a contour: the next move must be straight.
    pub(crate) leaving: bool,
}

/// What is at work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cutter {
    pub(crate) side: Side,
    /// ≥ 0, program units.
    pub(crate) radius: f64,
    /// 0 for a mill, else where the tip of a turning tool lies (9: in its centre).
    pub(crate) orientation: u8,
}

impl Cutter {
    /// From the centre of the nose to the point that the offsets of the tool measure, in radii: Z and X.
    fn tip(&self) -> Point {
        match self.orientation {
            1 => [1.0, -1.0],
            2 => [-1.0, -1.0],
            3 => [-1.0, 1.0],
            4 => [1.0, 1.0],
            5 => [1.0, 0.0],
            6 => [0.0, -1.0],
            7 => [-1.0, 0.0],
            8 => [0.0, 1.0],
            _ => [0.0, 0.0],
        }
    }

    /// The measured point when the centre of the tool is at `center`.
    pub(crate) fn tip_of(&self, center: Point) -> Point {
        let tip = self.tip();
        [center[0] + self.radius * tip[0], center[1] + self.radius * tip[1]]
    }

    /// The measured point when the tool touches the contour at `p` from `n`.
    pub(crate) fn tip_at(&self, p: Point, n: Point) -> Point {
        self.tip_of([p[0] + self.radius * n[0], p[1] + self.radius * n[1]])
    }
}

impl Compensation {
    /// Whether G41 or G42 is in force, also with a radius of 0.
    pub(crate) fn is_on(&self) -> bool {
        self.tool.is_some()
    }

    /// G40, G41 or G42. A negative diameter changes sides.
    pub(crate) fn code(&self) -> G {
        match self.tool {
            None => G(400),
            Some(Cutter { side: Side::Left, .. }) => G(410),
            Some(Cutter { side: Side::Right, .. }) => G(420),
        }
    }

    /// Where the centre of the tool is if `position` is the programmed point.
    pub(crate) fn center(&self, position: &Pose, plane: Plane) -> Pose {
        let mut center = *position;
        if let Compensation { tool: Some(cutter), normal: Some(n), .. } = self {
            let (first, second, _) = plane.axes();
            center[first] += cutter.radius * n[0];
            center[second] += cutter.radius * n[1];
        }
        center
    }

    /// A straight move has been made: arcs may follow.
    pub(crate) fn straight_made(&mut self) {
        self.leaving = false;
    }
}
