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
//! How deep it has to go for a groove of a width, and what it cuts on its way there:
//!
//! ```text
//! (M200) x₁(v) + x₂(v) = w on both flanks:  v = (w − Σ (f/2 + ρ cos α − v_α tan α))/(tan α₁ + tan α₂)
//! (M201) A(v) = Σ f v/2 + (ρ² arccos(1 − v/ρ) − (ρ − v)(v (2ρ − v))^½)/2                  v < v_α
//!        A(v) = A(v_α) + Σ (f/2 + ρ cos α)(v − v_α) + (v − v_α)² tan α/2                  above
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

    /// How far the tip has to stand below a line for the edge to be so wide there, mm (M200); none where its
    /// corners alone are as wide.
    #[must_use]
    pub fn depth_mm(&self, width_mm: f64) -> Option<f64> {
        let flanks = self.flanks();
        let at_tip: f64 = flanks.iter().map(|flank| flank.beside_mm - flank.corner_mm * flank.tangent).sum();
        let depth = (width_mm - at_tip) / flanks.iter().map(|flank| flank.tangent).sum::<f64>();
        flanks.iter().all(|flank| depth >= flank.corner_mm).then_some(depth)
    }

    /// Area between the tip and a line across the edge, so far over the tip, mm² (M201).
    #[must_use]
    pub fn area_mm2(&self, over_mm: f64) -> f64 {
        self.flanks().iter().map(|flank| flank.area_mm2(over_mm)).sum()
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

    /// The area beside the middle of the tip, mm² (M201).
    fn area_mm2(&self, v: f64) -> f64 {
        let (radius, on_corner) = (self.nose_mm, v.min(self.corner_mm));
        let segment = match radius > 0.0 {
            true => {
                let angle = libm::acos(1.0 - on_corner / radius);
                let chord = (on_corner * (2.0 * radius - on_corner)).max(0.0).sqrt();
                0.5 * (radius * radius * angle - (radius - on_corner) * chord)
            }
            false => 0.0,
        };
        let above = (v - self.corner_mm).max(0.0);
        self.half_mm * on_corner + segment + (self.beside_mm + 0.5 * above * self.tangent) * above
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
        assert_eq!(straight.area_mm2(0.5), 0.5);
        assert_eq!([0.4, 0.6].map(|x| straight.height_mm(x)), [0.0, f64::INFINITY]);
    }

    #[test]
    fn depth_and_area_are_those_of_the_reach() {
        for (width_mm, nose_mm) in [(0.0, 0.0), (0.0, 0.2), (0.6, 0.05), (0.3, 0.0)] {
            let edge = Edge::of_width([30.0, 3.0], width_mm, nose_mm);
            let wide = |v: f64| edge.flanks().iter().map(|flank| flank.reach_mm(v)).sum::<f64>();
            let depth = edge.depth_mm(1.7).expect("its corners are smaller");
            assert!((wide(depth) - 1.7).abs() < 1e-12, "{edge:?}");
            // The middle of each of many strips.
            let strips = 200_000;
            let strip = depth / f64::from(strips);
            let sum: f64 = (0..strips).map(|n| wide((f64::from(n) + 0.5) * strip) * strip).sum();
            assert!((edge.area_mm2(depth) - sum).abs() < 1e-6, "{edge:?}: {sum}");
            assert_eq!(
                edge.depth_mm(0.5 * wide(0.0).min(nose_mm)),
                (width_mm + nose_mm == 0.0).then_some(0.0)
            );
        }
    }
}
