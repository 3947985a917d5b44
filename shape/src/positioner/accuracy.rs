//! How far errors of its drives move the beam of a positioner on the part, and what drives a wanted accuracy
//! needs. In: errors of slides in mm, of angles in rad, sizes in mm. Out: mm; symbols as in [`Positioner`].
//!
//! | symbol | meaning |
//! |---|---|
//! | m | largest error of a slide, mm |
//! | δ | largest error of an angle, rad |
//! | L | largest of \|X\|, \|Y\|, \|Z\|, \|y2\|, \|z2\|, mm |
//!
//! Equations M50–M52 after the same source as the kinematics, (8)–(10); M90, M91 are new.

use super::{Drives, Positioner};

/// Largest errors of all drives of a kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveErrors {
    /// m: of a slide, mm.
    pub linear_mm: f64,
    /// δ: of an angle, rad.
    pub angular_rad: f64,
}

impl Positioner {
    /// M50: displacement of a point by small errors of the drives, mm, to first order. The y1, x1, x2 play no
    /// part.
    #[must_use]
    pub fn linear_error(&self, point: [f64; 3], drives: &Drives, error: &Drives) -> [f64; 3] {
        let [x, y, z] = point;
        let ((sa, ca), (sb, cb)) = (libm::sincos(drives.alpha), libm::sincos(drives.beta));
        let (w, q, height) = (self.y2 - x * sb + y * cb, x * cb + y * sb, self.z2 + z);
        [
            error.x + (y * cb - x * sb) * error.beta,
            error.y + (height * ca - w * sa) * error.alpha - q * ca * error.beta,
            -(height * sa + w * ca) * error.alpha + q * sa * error.beta,
        ]
    }

    /// The same exactly: the difference of two positions.
    #[must_use]
    pub fn exact_error(&self, point: [f64; 3], drives: &Drives, error: &Drives) -> [f64; 3] {
        let off = Drives {
            x: drives.x + error.x,
            y: drives.y + error.y,
            alpha: drives.alpha + error.alpha,
            beta: drives.beta + error.beta,
        };
        let ([x, y, z], [x0, y0, z0]) = (self.forward(point, &off), self.forward(point, drives));
        [x - x0, y - y0, z - z0]
    }

    /// What is known when only a size L is: every length of the positioner and of the part is L at most. With
    /// it M52 is M51, whose factors √2 and √5 + √2 are attained.
    #[must_use]
    pub fn of_size(size_mm: f64) -> Positioner {
        Positioner { y2: size_mm, z2: size_mm, ..Positioner::default() }
    }

    /// M52: largest displacement, to first order, of any point with coordinates no larger than `largest`, in
    /// any pose, mm.
    #[must_use]
    pub fn error_bound(&self, largest: [f64; 3], errors: DriveErrors) -> [f64; 3] {
        let DriveErrors { linear_mm: m, angular_rad: d } = errors;
        let [tilt, turn] = self.arms(largest);
        [m + d * turn, m + d * (tilt + turn), d * (tilt + turn)]
    }

    /// M91: what M50 neglects, to second order, at most, mm.
    #[must_use]
    pub fn neglected(&self, largest: [f64; 3], errors: DriveErrors) -> f64 {
        let [tilt, turn] = self.arms(largest);
        errors.angular_rad * errors.angular_rad * (tilt / 2.0 + turn)
    }

    /// M90: the largest errors that drives may have so that no point with coordinates no larger than
    /// `largest` is displaced by more than `accuracy_mm` along any axis of the machine. Slides get
    /// `linear_share` of it, 0 to 1; what M50 neglects is counted.
    #[must_use]
    pub fn required(&self, largest: [f64; 3], accuracy_mm: f64, linear_share: f64) -> DriveErrors {
        let [tilt, turn] = self.arms(largest);
        let (first, second) = (tilt + turn, tilt / 2.0 + turn);
        let rest = (1.0 - linear_share) * accuracy_mm;
        let angular_rad = 2.0 * rest / (first + (first * first + 4.0 * second * rest).sqrt());
        DriveErrors { linear_mm: linear_share * accuracy_mm, angular_rad }
    }

    /// The longest arms that points have about the tilt and about the turn, mm.
    fn arms(&self, largest: [f64; 3]) -> [f64; 2] {
        let [x, y, z] = largest.map(f64::abs);
        [libm::hypot(self.z2.abs() + z, self.y2), libm::hypot(x, y)]
    }
}

impl DriveErrors {
    /// The bound as published, (9), for a part and a positioner of the size L, mm. Valid, but its factor
    /// 2 + √2 + 1/√2 is 13 % larger than what occurs.
    #[must_use]
    pub fn published_bound(self, size_mm: f64) -> [f64; 3] {
        let turned = (2.0 + 2.0_f64.sqrt() + 0.5_f64.sqrt()) * size_mm * self.angular_rad;
        [self.linear_mm + 2.0_f64.sqrt() * size_mm * self.angular_rad, self.linear_mm + turned, turned]
    }

    /// Increments of the drives whose rounding stays within these errors: mm, rad. A drive that goes to the
    /// nearest increment is off by half of one.
    #[must_use]
    pub fn increments(self) -> (f64, f64) {
        (2.0 * self.linear_mm, 2.0 * self.angular_rad)
    }
}
