//! Kinematics of the four-axis positioner: two slides, a tilting table on them, a turntable on that. A beam
//! that stands still meets the part where the positioner brings it. In and out: mm, rad; angles are positive
//! clockwise (M46).
//!
//! | symbol | meaning |
//! |---|---|
//! | X, Y, Z | a point in the frame of the work-holder |
//! | l | direction at that point that is to look along the beam, +Z of the machine |
//! | x, y, α, β | the drives: slides, tilt about X, turn about Z |
//! | xA, yA, zA | the point in the frame of the machine |
//! | w, q | y2 − X sin β + Y cos β, X cos β + Y sin β |
//!
//! Equations M46–M52 after "Mathematical model of kinematics and requirements for drives of a precision
//! positioning system", (2)–(10), with its misprints put right.

mod accuracy;

pub use accuracy::DriveErrors;

use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Offsets of a positioner, mm: from the frame of the machine to the axis of the tilt, from there to that of
/// the turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Positioner {
    /// x1: along the tilt axis.
    pub x1: f64,
    /// y1: across it.
    pub y1: f64,
    /// z1: its height.
    pub z1: f64,
    /// x2: of the turn axis, along the tilt axis.
    pub x2: f64,
    /// y2: of the turn axis, across it.
    pub y2: f64,
    /// z2: of the face of the turntable, along the turn axis.
    pub z2: f64,
}

/// Where the drives stand: mm, rad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drives {
    /// x: slide along the tilt axis.
    pub x: f64,
    /// y: slide across it.
    pub y: f64,
    /// α: tilt.
    pub alpha: f64,
    /// β: turn.
    pub beta: f64,
}

/// The two ways to turn a direction onto the beam (M49), told by the sign of the tilt.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Branch {
    /// −π ≤ α ≤ 0: the first solution.
    #[default]
    Negative,
    /// 0 ≤ α ≤ π: the second.
    Positive,
}

impl Branch {
    /// Both.
    pub const BOTH: [Branch; 2] = [Branch::Negative, Branch::Positive];

    /// Sign of the tilt.
    #[must_use]
    pub fn sign(self) -> f64 {
        match self {
            Branch::Negative => -1.0,
            Branch::Positive => 1.0,
        }
    }
}

/// R_X of M46: a point or direction turned about X by a clockwise angle, rad.
fn about_x(angle: f64, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let (s, c) = libm::sincos(angle);
    [x, c * y + s * z, c * z - s * y]
}

/// R_Z of M46: the same about Z.
fn about_z(angle: f64, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let (s, c) = libm::sincos(angle);
    [c * x + s * y, c * y - s * x, z]
}

impl Positioner {
    /// M46, M47: where a point of the work-holder is in the frame of the machine.
    #[must_use]
    pub fn forward(&self, point: [f64; 3], drives: &Drives) -> [f64; 3] {
        let [x, y, z] = about_z(drives.beta, point);
        let [x, y, z] = about_x(drives.alpha, [x + self.x2, y + self.y2, z + self.z2]);
        [x + (drives.x + self.x1), y + (drives.y + self.y1), z + self.z1]
    }

    /// M46: how a direction of the work-holder looks in the frame of the machine.
    #[must_use]
    pub fn turned(direction: [f64; 3], drives: &Drives) -> [f64; 3] {
        let ((sa, ca), (sb, cb)) = (libm::sincos(drives.alpha), libm::sincos(drives.beta));
        let [x, y, z] = direction;
        [cb * x + sb * y, ca * cb * y - ca * sb * x + sa * z, sa * sb * x - sa * cb * y + ca * z]
    }

    /// M49: drives that bring `point` under a beam at `beam` (xA, yA) and turn `direction` onto +Z. α in −π …
    /// π, β the turn nearest to `beta_near`; where the direction is ±Z every β would do, and it is
    /// `beta_near`. The direction need not be of length 1; if it is 0 or not finite the drives are not
    /// finite.
    #[must_use]
    pub fn inverse(
        &self,
        point: [f64; 3],
        direction: [f64; 3],
        beam: [f64; 2],
        branch: Branch,
        beta_near: f64,
    ) -> Drives {
        let [lx, ly, lz] = direction;
        let (h, sign) = (libm::hypot(lx, ly), branch.sign());
        let length = h + lz.abs();
        let alpha = if length > 0.0 && length.is_finite() { libm::atan2(sign * h, lz) } else { f64::NAN };
        let beta = if h == 0.0 { beta_near } else { libm::atan2(sign * lx, -sign * ly) };
        self.under(point, beam, alpha, nearest_turn(beta, beta_near, TAU))
    }

    /// Drives at given angles that bring a point under the beam.
    fn under(&self, point: [f64; 3], beam: [f64; 2], alpha: f64, beta: f64) -> Drives {
        let [x, y, _] = self.forward(point, &Drives { x: 0.0, y: 0.0, alpha, beta });
        Drives { x: beam[0] - x, y: beam[1] - y, alpha, beta }
    }
}

/// The angle that differs from `angle` by whole turns of `turn` and lies nearest to `near`; all in one unit.
#[must_use]
pub(crate) fn nearest_turn(angle: f64, near: f64, turn: f64) -> f64 {
    angle + turn * ((near - angle) / turn).round()
}
