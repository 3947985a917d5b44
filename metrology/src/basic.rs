//! Threads of which basic sizes are known and limits are not: Rd (DIN 405), BSW (BS 84), worms of a module
//! (DIN 3975) or of a diametral pitch. In: sizes of the name. Out: basic diameters.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | d, P | mm or in | nominal diameter, pitch |
//! | m, z1 | mm, – | axial module of a worm, its number of threads |
//! | γ, α_ax | deg | its lead angle, the angle of its flanks in an axial plane |
//!
//! ```text
//! Rd: d2 = d − P/2, P = 25.4/n
//! BSW: h = 0.640327 P;  d2 = d − h,  d3 = d − 2 h
//! worm: pitch π m, lead π m z1; d the reference diameter, da = d + 2 m, df = d − 2.5 m, depth 2.25 m;
//!     tan γ = m z1/d, tan α_ax = tan 20° / cos γ; of a diametral pitch m = 25.4/DP                    (M147)
//! ```

use std::fmt;

use crate::{
    limits::{Limits, Size, Unit},
    name::InchSize,
    profile::Profile,
    rounding::{even, half_up},
    thread::Described,
};

/// Rd, DIN 405.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Round {
    /// mm.
    pub(crate) d: f64,
    /// Threads per inch.
    pub(crate) tpi: f64,
}

impl Described for Round {
    fn standard(&self) -> &'static str {
        "DIN 405 Rd"
    }

    fn limits(&self) -> Limits {
        let d2 = half_up(self.d - 12.7 / self.tpi, 3);
        Limits::new(Unit::Mm, Some(&[(Size::Major, self.d), (Size::Pitch, d2)]), Some(&[(Size::Pitch, d2)]))
    }

    fn profile(&self) -> Profile {
        let pitch = 25.4 / self.tpi;
        Profile {
            flank_deg: [15.0; 2],
            pitch_mm: pitch,
            starts: 1,
            major_mm: self.d,
            pitch_diameter_mm: self.d - pitch / 2.0,
            minor_mm: self.d - pitch,
            taper: 0.0,
            left_hand: false,
        }
    }

    fn note(&self) -> &'static str {
        "Basic sizes: tolerances of DIN 405 are not known here."
    }
}

impl fmt::Display for Round {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Rd{} x 1/{}", self.d, self.tpi)
    }
}

/// BSW, BS 84.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Whitworth {
    pub(crate) size: InchSize,
    pub(crate) tpi: f64,
}

impl Described for Whitworth {
    fn standard(&self) -> &'static str {
        "BS 84 BSW"
    }

    fn limits(&self) -> Limits {
        let (d, h) = (self.size.inches(), 0.640327 / self.tpi);
        let sizes = [(Size::Major, d), (Size::Pitch, d - h), (Size::Minor, d - 2.0 * h)];
        let sizes = sizes.map(|(size, inches)| (size, even(inches, 4)));
        Limits::new(Unit::Inch, Some(&sizes), Some(&sizes))
    }

    fn profile(&self) -> Profile {
        let (d, pitch) = (25.4 * self.size.inches(), 25.4 / self.tpi);
        Profile {
            flank_deg: [27.5; 2],
            pitch_mm: pitch,
            starts: 1,
            major_mm: d,
            pitch_diameter_mm: d - 0.640327 * pitch,
            minor_mm: d - 2.0 * 0.640327 * pitch,
            taper: 0.0,
            left_hand: false,
        }
    }

    fn note(&self) -> &'static str {
        "Basic sizes: no published table was found to hold tolerances of BS 84 against."
    }
}

impl fmt::Display for Whitworth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "BSW {}-{}", self.size, self.tpi)
    }
}

/// Angle of the flanks of a worm across its thread, degrees.
const NORMAL_DEG: f64 = 20.0;

/// A worm of a module, DIN 3975, or of a diametral pitch.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Worm {
    /// Axial module, mm.
    pub(crate) module: f64,
    /// The diametral pitch that it was named by, 1/in.
    pub(crate) diametral: Option<f64>,
    /// Number of threads, z1.
    pub(crate) starts: u32,
    /// Reference diameter, mm.
    pub(crate) d: f64,
}

impl Worm {
    fn pitch(&self) -> f64 {
        core::f64::consts::PI * self.module
    }

    /// γ and α_ax, degrees.
    fn angles_deg(&self) -> [f64; 2] {
        let gamma = libm::atan(self.module * f64::from(self.starts) / self.d);
        let axial = libm::atan(libm::tan(NORMAL_DEG.to_radians()) / libm::cos(gamma));
        [gamma, axial].map(f64::to_degrees)
    }
}

impl Described for Worm {
    fn standard(&self) -> &'static str {
        "DIN 3975 worm"
    }

    fn limits(&self) -> Limits {
        let Worm { module, starts, d, .. } = *self;
        let sizes = [
            (Size::Lead, self.pitch() * f64::from(starts)),
            (Size::Pitch, d),
            (Size::Tip, d + 2.0 * module),
            (Size::Root, d - 2.5 * module),
            (Size::Depth, 2.25 * module),
        ];
        let [gamma, axial] = self.angles_deg().map(|deg| half_up(deg, 6));
        let mut sizes = sizes.map(|(size, mm)| (size, half_up(mm, 4))).to_vec();
        sizes.extend([(Size::LeadAngle, gamma), (Size::AxialAngle, axial)]);
        Limits::new(Unit::Mm, Some(&sizes), None)
    }

    fn profile(&self) -> Profile {
        Profile {
            flank_deg: [self.angles_deg()[1]; 2],
            pitch_mm: self.pitch(),
            starts: self.starts,
            major_mm: self.d + 2.0 * self.module,
            pitch_diameter_mm: self.d,
            minor_mm: self.d - 2.5 * self.module,
            taper: 0.0,
            left_hand: false,
        }
    }

    fn note(&self) -> &'static str {
        "Nominal sizes, with a clearance of a quarter of the module; worms have no limits by a name. The flanks have 20 \
         degrees across the thread."
    }
}

impl fmt::Display for Worm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.diametral {
            Some(pitch) => write!(f, "worm DP{pitch} z1={} d{}", self.starts, self.d),
            None => write!(f, "module worm m{} z1={} d{}", self.module, self.starts, self.d),
        }
    }
}
