//! The lower edge of what a tool sweeps that is no ball, seen along its straight path: how high it stands
//! over the plane that it touches, by half of the distance between neighbouring paths. Lengths in mm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | c, a | mm | radius of the corner of the tool, and of the circle on which the corner has its centre |
//! | β | rad | angle in the tangent plane between the path and the steepest slope θ |
//! | B, H | mm | half axes of the ellipse as which that circle is seen along the path, B without its skew |
//! | m | – | slope of the edge against the plane |
//!
//! ```text
//! B = a cos β,  H = a sin θ
//! δ/2 = B² m/(H² + B² m²)^½ + c m/(1 + m²)^½
//! h = H (1 − H/(H² + B² m²)^½) + c (1 − 1/(1 + m²)^½)                                               (M177)
//! ```
//! Of a flat end (c = 0) h = H (1 − (1 − δ²/(4 B²))^½): two places of the rim at the same height are
//! 2 B sin φ apart across the path, whatever the skew of the ellipse. Of a bull nose that is so where the
//! path climbs or is level.
//!
//! Source: projection of a circle, and the line at the distance c from an ellipse.

/// Steps of a bisection.
const HALVINGS: usize = 44;

/// The edge that a circle with a round corner sweeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Swept {
    /// B.
    pub(super) wide: f64,
    /// H.
    pub(super) high: f64,
    /// c.
    pub(super) corner: f64,
}

impl Swept {
    /// Curvature where it touches the plane, 1/mm.
    pub(super) fn curvature(&self) -> f64 {
        1.0 / (self.wide * self.wide / self.high + self.corner)
    }

    /// Farthest that it reaches to a side, mm.
    pub(super) fn reach(&self) -> f64 {
        self.wide + self.corner
    }

    /// Its height at a distance from the place of contact, mm; all of it where it does not reach so far.
    pub(super) fn height(&self, half_mm: f64) -> f64 {
        self.until(|[beside, _]| beside < half_mm)[1]
    }

    /// The distance from the place of contact at which it has a height, mm; as far as it reaches where it is
    /// not so high.
    pub(super) fn half(&self, height_mm: f64) -> f64 {
        self.until(|[_, height]| height < height_mm)[0]
    }

    /// The first place that is not short of something: beside the contact, and high.
    fn until(&self, is_short: impl Fn([f64; 2]) -> bool) -> [f64; 2] {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if is_short(self.at(middle)) { low = middle } else { high = middle }
        }
        self.at(0.5 * (low + high))
    }

    /// Beside the contact and high, where m/(1 + m) is a share.
    fn at(&self, share: f64) -> [f64; 2] {
        let Swept { wide, high, corner } = *self;
        // Sine and cosine of the edge's slope, and those by which the ellipse has the same slope.
        let (rise, run) = (share, 1.0 - share);
        let round = libm::hypot(rise, run);
        let ellipse = libm::hypot(high * run, wide * rise);
        // 1 − cos = sin²/(1 + cos), without the difference of two numbers that are nearly the same.
        let versine = |sine: f64, cosine: f64| sine * sine / (1.0 + cosine);
        [
            wide * wide * rise / ellipse + corner * rise / round,
            high * versine(wide * rise / ellipse, high * run / ellipse)
                + corner * versine(rise / round, run / round),
        ]
    }
}
