//! The edge of a threading tool, in the plane of X and Z. In: a height over its lowest point, mm. Out: how
//! far it reaches from the middle of its tip to either side, mm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | α | deg | angle of a flank to a plane across the axis |
//! | f, ρ | mm | flat at the tip, corners not counted; radius of the corners |
//! | v, x(v) | mm | height over the tip; reach to the side of a flank |
//!
//! ```text
//! (M151) x(v) = f/2 + (v (2ρ − v))^½                         v < v_α = ρ (1 − sin α), on the corner
//!        x(v) = f/2 + ρ cos α + (v − v_α) tan α              above, on the flank
//! ```
//! A tool with a round nose has f = 0. x is concave: it never grows slower than on the flank. The same edge
//! over the distance x from its middle:
//!
//! ```text
//! (M160) v(x) = 0                                      |x| < f/2
//!        v(x) = ρ − (ρ² − u²)^½,  u = |x| − f/2        u < ρ cos α, on the corner
//!        v(x) = v_α + (u − ρ cos α)/tan α              above; infinite on a flank across the axis
//! ```

/// The edge of a tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Flanks towards lower and higher Z, degrees to a plane across the axis, 0 to below 90.
    pub flank_deg: [f64; 2],
    /// Flat at the tip between the corners, mm.
    pub flat_mm: f64,
    /// Radius of the nose, or of each corner, mm.
    pub nose_mm: f64,
}

impl Edge {
    /// An edge whose tip is so wide where its flanks would meet it without corners, mm.
    #[must_use]
    pub fn of_width(flank_deg: [f64; 2], width_mm: f64, nose_mm: f64) -> Edge {
        let corners = flank_deg.map(|deg| nose_mm * libm::tan((0.5 * (90.0 - deg)).to_radians()));
        Edge { flank_deg, flat_mm: (width_mm - corners[0] - corners[1]).max(0.0), nose_mm }
    }

    /// v(x) (M160): the height over the tip at a distance from its middle, positive towards higher Z, mm.
    #[must_use]
    pub fn height_mm(&self, x_mm: f64) -> f64 {
        let [lower, higher] = self.flanks();
        if x_mm < 0.0 { lower.height_mm(-x_mm) } else { higher.height_mm(x_mm) }
    }

    /// Both flanks, ready to be evaluated.
    pub(crate) fn flanks(&self) -> [Flank; 2] {
        self.flank_deg.map(|deg| {
            let (sin, cos) = libm::sincos(deg.to_radians());
            Flank {
                nose_mm: self.nose_mm,
                half_mm: 0.5 * self.flat_mm,
                corner_mm: self.nose_mm * (1.0 - sin),
                beside_mm: 0.5 * self.flat_mm + self.nose_mm * cos,
                tangent: sin / cos,
            }
        })
    }
}

/// One side of an edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flank {
    nose_mm: f64,
    half_mm: f64,
    /// v_α, and x there.
    corner_mm: f64,
    beside_mm: f64,
    /// tan α.
    pub(crate) tangent: f64,
}

impl Flank {
    /// x(v) for v ≥ 0 (M151).
    pub(crate) fn reach_mm(&self, v: f64) -> f64 {
        if v < self.corner_mm {
            self.half_mm + (v * (2.0 * self.nose_mm - v)).max(0.0).sqrt()
        } else {
            self.beside_mm + (v - self.corner_mm) * self.tangent
        }
    }

    /// v(x) for x ≥ 0 (M160).
    fn height_mm(&self, x: f64) -> f64 {
        let corner = x - self.half_mm;
        if corner <= 0.0 {
            0.0
        } else if x < self.beside_mm {
            self.nose_mm - (self.nose_mm * self.nose_mm - corner * corner).max(0.0).sqrt()
        } else if x == self.beside_mm {
            self.corner_mm
        } else {
            self.corner_mm + (x - self.beside_mm) / self.tangent
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Edge;

    #[test]
    fn the_height_is_the_inverse_of_the_reach() {
        for (width_mm, nose_mm) in [(0.0, 0.0), (0.0, 0.2), (0.6, 0.05)] {
            let edge = Edge::of_width([30.0, 3.0], width_mm, nose_mm);
            for v in [1e-6, 0.01, 0.04, 0.1, 0.7] {
                let [lower, higher] = edge.flanks().map(|flank| flank.reach_mm(v));
                for x in [-lower, higher] {
                    assert!((edge.height_mm(x) - v).abs() < 1e-9, "{edge:?}: {v} at {x}");
                }
            }
        }
        let straight = Edge { flank_deg: [0.0; 2], flat_mm: 1.0, nose_mm: 0.0 };
        assert_eq!([0.4, 0.6].map(|x| straight.height_mm(x)), [0.0, f64::INFINITY]);
    }
}
