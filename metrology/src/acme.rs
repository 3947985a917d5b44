//! Acme threads for general purpose, ASME B1.5. In: size in inches, threads per inch, class 2G, 3G or 4G.
//! Out: limits in inches, four places.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | D, P | in | basic major diameter, pitch = 1/n |
//! | A, T | in | allowance and tolerance of the pitch diameter |
//! | c | in | clearance at the crests: 0.020 with 10 threads per inch or fewer, 0.010 with more |
//!
//! ```text
//! A = (0.008, 0.006, 0.004) D^½,  T = (0.030, 0.014, 0.010) P^½ + (0.006, 0.0028, 0.002) D^½      (M144)
//! screw: d_max = D,  T_d = 0.05 P, at least 0.005;  d2_max = D − P/2 − A;  d3_max = D − P − c,  T_d3 = 1.5 T
//! nut: D_min = D + c, tolerance c;  D2_min = D − P/2, tolerance T;
//!     D1_min = D − P, tolerance 0.05 P, at least 0.005
//! ```
//!
//! Rounding: P/2, P, A and T to four places each; d3_min = d3_max − 1.5 T with T as it is; a half to the even
//! one.

use std::fmt;

use crate::{
    limits::{Limits, Size, Unit},
    name::InchSize,
    profile::Profile,
    rounding::even,
    thread::Described,
};

/// An Acme thread; in.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Acme {
    pub(crate) size: InchSize,
    pub(crate) tpi: f64,
    /// 2, 3 or 4.
    pub(crate) class: u8,
}

impl Described for Acme {
    fn standard(&self) -> &'static str {
        "ASME B1.5 ACME"
    }

    fn limits(&self) -> Limits {
        let (d, pitch) = (self.size.inches(), 1.0 / self.tpi);
        let (allowance, by_pitch, by_diameter) = match self.class {
            2 => (0.008, 0.03, 0.006),
            3 => (0.006, 0.014, 0.0028),
            _ => (0.004, 0.01, 0.002),
        };
        let four = |value: f64| even(value, 4);
        let clearance = if self.tpi <= 10.0 { 0.02 } else { 0.01 };
        let crest = (0.05 * pitch).max(0.005);
        let tolerance = by_pitch * pitch.sqrt() + by_diameter * d.sqrt();
        let d2 = four(d - four(pitch / 2.0));
        let d2_max = four(d2 - four(allowance * d.sqrt()));
        let d3_max = four(d - four(pitch) - clearance);
        let screw = [
            (Size::MajorMax, four(d)),
            (Size::MajorMin, four(d - crest)),
            (Size::PitchMax, d2_max),
            (Size::PitchMin, four(d2_max - four(tolerance))),
            (Size::MinorMax, d3_max),
            (Size::MinorMin, four(d3_max - 1.5 * tolerance)),
        ];
        let nut = [
            (Size::MajorMax, four(d + 2.0 * clearance)),
            (Size::MajorMin, four(d + clearance)),
            (Size::PitchMax, four(d2 + four(tolerance))),
            (Size::PitchMin, d2),
            (Size::MinorMax, four(d - pitch + crest)),
            (Size::MinorMin, four(d - pitch)),
        ];
        Limits::new(Unit::Inch, Some(&screw), Some(&nut))
    }

    fn profile(&self) -> Profile {
        let (d, pitch) = (25.4 * self.size.inches(), 25.4 / self.tpi);
        Profile {
            flank_deg: [14.5; 2],
            pitch_mm: pitch,
            starts: 1,
            major_mm: d,
            pitch_diameter_mm: d - pitch / 2.0,
            minor_mm: d - pitch,
            taper: 0.0,
            left_hand: false,
        }
    }

    fn note(&self) -> &'static str {
        "By the formulas of the standard. Special pitches are often sold with the allowance of the standard size of \
         the same pitch."
    }
}

impl fmt::Display for Acme {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}-{} ACME-{}G", self.size, self.tpi, self.class)
    }
}
