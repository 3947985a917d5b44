//! The nominal profile of a thread: what its limits are measured on. In mm and degrees.
//!
//! ```text
//! H = P / (tan α₁ + tan α₂): height of the triangle of the flanks                                     (M137)
//! ```

/// The nominal profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile {
    /// Angle of each flank to a plane across the axis, degrees.
    pub flank_deg: [f64; 2],
    /// Axial distance from one groove to the next, mm.
    pub pitch_mm: f64,
    /// Number of grooves that run beside each other; 1 or more.
    pub starts: u32,
    /// Major diameter of the basic profile, mm; of a taper at the gauge plane.
    pub major_mm: f64,
    /// Pitch diameter of the basic profile, mm; of a taper at the gauge plane.
    pub pitch_diameter_mm: f64,
    /// Minor diameter of the basic profile, mm; of a taper at the gauge plane.
    pub minor_mm: f64,
    /// Change of diameter per length; 0 for a cylinder.
    pub taper: f64,
    /// Whether it is left-hand.
    pub left_hand: bool,
}

impl Profile {
    /// Advance per revolution, mm.
    #[must_use]
    pub fn lead_mm(&self) -> f64 {
        self.pitch_mm * f64::from(self.starts)
    }

    /// Height of the triangle of the flanks, H in mm (M137).
    #[must_use]
    pub fn triangle_mm(&self) -> f64 {
        self.pitch_mm / self.flank_deg.map(|deg| libm::tan(deg.to_radians())).iter().sum::<f64>()
    }
}
