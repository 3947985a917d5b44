//! What a gauge asks of a thread. In: sizes of a drawing, the name of a thread (`named.rs`) or what a
//! person writes (`text.rs`), mm and degrees. Out: heights over the line on which a GO gauge is measured.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | y | mm | radius of a screw; minus the radius of a nut: material lies below, the tool comes from above |
//! | P, w | mm | distance of grooves along the axis; width of a groove at the pitch line |
//! | α₁, α₂ | deg | flank of the groove on the side of lower Z, and of higher Z, to a plane across the axis |
//! | t₁, t₂, T | – | their tangents, and t₁ + t₂ |
//! | s | – | slope of the cone: change of y along Z |
//! | h | mm | y − y_go(z): height over the pitch line of the GO gauge |
//!
//! ```text
//! (M150) y_go(z) = y_go + s (z − z₀): d2_max/2 of a screw, −D2_min/2 of a nut;   w = P/2 (1 − s² t₁ t₂)
//! ```
//! On a cone, w is measured parallel to the axis at the height that the pitch line has in the middle of the
//! groove; along the cone that is half of the pitch.

mod named;
mod text;

use std::fmt;

use metrology::Side;

/// What is asked of a thread. Diameters in mm; `None` is not looked at.
#[derive(Clone, Debug, PartialEq)]
pub struct Nominal {
    /// Its name, for people.
    pub name: String,
    /// Screw or nut.
    pub side: Side,
    /// Flanks of the groove towards lower and higher Z, degrees to a plane across the axis.
    pub flank_deg: [f64; 2],
    /// Distance of grooves along the axis, mm.
    pub pitch_mm: f64,
    /// Number of grooves beside each other.
    pub starts: u32,
    /// Whether Z grows with the angle of the spindle along the groove; else it falls.
    pub grows: bool,
    /// Smallest and largest pitch diameter; on a cone at `plane_mm`.
    pub pitch_diameter_mm: [f64; 2],
    /// Smallest and largest diameter of the crest: major of a screw, minor of a nut.
    pub crest_mm: [Option<f64>; 2],
    /// Diameter that the groove has to reach for a GO gauge: largest flat minor of a screw, smallest major of
    /// a nut.
    pub root_go_mm: Option<f64>,
    /// Smallest and largest diameter of the root.
    pub root_mm: [Option<f64>; 2],
    /// Change of diameter along Z.
    pub taper: f64,
    /// Where along Z the diameters of a cone hold, mm.
    pub plane_mm: f64,
    /// Length of the GO gauge, mm.
    pub gauge_mm: f64,
    /// Of a nut that a tapered tap cuts: how far from its point the tap has the pitch diameter that the nut
    /// has at its plane, mm.
    pub tap_mm: Option<f64>,
    /// Of a blunt start: turns behind the face of the part, at Z 0, up to which the ridge has to be gone, and
    /// from which on it has to be whole.
    pub blunt_turns: Option<[f64; 2]>,
    /// What its standard asks besides, and no gauge looks at; for people.
    pub left_out: &'static [&'static str],
}

/// Why no gauge can be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NominalError {
    /// Pitch, diameters or length are not positive numbers, or the limits are the wrong way round.
    Sizes,
    /// The flanks are not between 0 and 80°, or both so steep that a gauge would not be held by them.
    Flanks,
    /// The name says neither screw nor nut.
    Side,
    /// Its standard sets no limits that are known.
    NoLimits,
}

impl fmt::Display for NominalError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            NominalError::Sizes => "a gauge needs a pitch, a length and a range of pitch diameters above 0",
            NominalError::Flanks => "a gauge needs flanks of 0 to 80°, 4° or more between them",
            NominalError::Side => "a gauge is for a screw or for a nut, and the name says neither",
            NominalError::NoLimits => "no gauge: no limits of the pitch diameter are known for this thread",
        })
    }
}

impl std::error::Error for NominalError {}

impl NominalError {
    /// What to write.
    #[must_use]
    pub fn help(self) -> &'static str {
        match self {
            NominalError::Side => {
                "add the class of one of them, as in M20x2-6g or M20x2-6H, or external or internal"
            }
            NominalError::NoLimits | NominalError::Sizes | NominalError::Flanks => {
                "give your limits by numbers, as in P2 D2 18.503..18.663 A60 external"
            }
        }
    }
}

/// Turns behind the face within which a blunt start is over.
const MOST_BLUNT: f64 = 4.0;
/// Least angle between the flanks, degrees.
const LEAST_DEG: f64 = 4.0;

impl Nominal {
    /// Whether a gauge can be made of it.
    ///
    /// # Errors
    /// See [`NominalError`].
    pub fn check(&self) -> Result<(), NominalError> {
        let [low, high] = self.pitch_diameter_mm;
        let sizes = [self.pitch_mm, low, high, self.gauge_mm];
        let sound = sizes.iter().all(|mm| mm.is_finite() && *mm > 0.0) && low <= high && self.starts > 0;
        let tap = self.tap_mm.is_none_or(|mm| mm.is_finite() && mm > 0.0);
        let blunt =
            self.blunt_turns.is_none_or(|[gone, whole]| 0.0 < gone && gone < whole && whole <= MOST_BLUNT);
        if !sound
            || !tap
            || !blunt
            || !self.plane_mm.is_finite()
            || self.taper.is_nan()
            || self.taper.abs() > 1.0
        {
            return Err(NominalError::Sizes);
        }
        let flanks = self.flank_deg.iter().all(|deg| (0.0..=80.0).contains(deg));
        if !flanks || self.flank_deg.iter().sum::<f64>() < LEAST_DEG {
            return Err(NominalError::Flanks);
        }
        Ok(())
    }

    /// Advance along Z in a turn of the spindle, mm, signed.
    pub(crate) fn advance_mm(&self) -> f64 {
        let lead_mm = self.lead_mm();
        if self.grows { lead_mm } else { -lead_mm }
    }

    /// Advance in a turn, mm.
    pub(crate) fn lead_mm(&self) -> f64 {
        self.pitch_mm * f64::from(self.starts)
    }

    /// t₁ and t₂.
    pub(crate) fn tangents(&self) -> [f64; 2] {
        self.flank_deg.map(|deg| libm::tan(deg.to_radians()))
    }

    /// T, tangents of both flanks together.
    #[must_use]
    pub fn tangent(&self) -> f64 {
        self.tangents().iter().sum()
    }

    /// w, mm.
    pub(crate) fn width_mm(&self) -> f64 {
        let [t1, t2] = self.tangents();
        let s = 0.5 * self.taper;
        0.5 * self.pitch_mm * (1.0 - s * s * t1 * t2)
    }

    /// y of a diameter, mm.
    pub(crate) fn y_mm(&self, diameter_mm: f64) -> f64 {
        0.5 * self.sign() * diameter_mm
    }

    /// 1 of a screw, −1 of a nut.
    #[must_use]
    pub fn sign(&self) -> f64 {
        match self.side {
            Side::External => 1.0,
            Side::Internal => -1.0,
        }
    }

    /// y_go(z), mm.
    pub(crate) fn line_mm(&self, z_mm: f64) -> f64 {
        self.y_mm(self.go_mm()) + 0.5 * self.sign() * self.taper * (z_mm - self.plane_mm)
    }

    /// The limit of the pitch diameter that GO holds, mm.
    pub(crate) fn go_mm(&self) -> f64 {
        self.pitch_diameter_mm[if self.side == Side::External { 1 } else { 0 }]
    }

    /// The limit of the pitch diameter that NO-GO holds, mm.
    pub(crate) fn no_go_mm(&self) -> f64 {
        self.pitch_diameter_mm[if self.side == Side::External { 0 } else { 1 }]
    }

    /// h of a diameter, mm.
    pub(crate) fn height_mm(&self, diameter_mm: f64) -> f64 {
        self.y_mm(diameter_mm) - self.y_mm(self.go_mm())
    }

    /// The diameter of a height, mm; on a cone, at its plane.
    pub(crate) fn diameter_mm(&self, height_mm: f64) -> f64 {
        self.go_mm() + 2.0 * self.sign() * height_mm
    }

    /// Whether a tip at a place can have cut something of the thread: it is less than the height of the
    /// triangle of the flanks over the pitch line.
    #[must_use]
    pub fn is_near(&self, place: &crate::Place) -> bool {
        self.over_mm(place) < self.pitch_mm / self.tangent()
    }

    /// How far a tip stands over the pitch line of the GO gauge, mm: h of (M150).
    #[must_use]
    pub fn over_mm(&self, place: &crate::Place) -> f64 {
        self.sign() * place.radius_mm - self.line_mm(place.z_mm)
    }

    /// The heights between which flanks touch a GO gauge: as deep as it reaches, as high as there is
    /// material.
    pub(crate) fn flank_heights_mm(&self, crest_mm: Option<f64>) -> [f64; 2] {
        let share = |share: f64| share * self.pitch_mm / self.tangent();
        let crest = crest_mm.or(self.crest_mm[if self.side == Side::External { 1 } else { 0 }]);
        let root = self.root_go_mm.map_or(-share(0.25), |mm| self.height_mm(mm));
        let crest = crest.map_or(share(0.375), |mm| self.height_mm(mm));
        [root, crest.max(root + share(0.05))]
    }
}
