//! Buttress threads in inches, ANSI B1.9 (ASME B1.9): flanks of 7 and 45 degrees, engaged over 0.6 of the
//! pitch. In: size in inches, threads per inch, class. Out: limits in inches, four places.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | D, p | in | basic major diameter, pitch = 1/n |
//! | D_m | in | the mean of the range in which the standard has D: its tolerances are by ranges |
//! | T, G | in | tolerance of a class; allowance of the screw, that of class 3 |
//!
//! ```text
//! T = 0.002 D_m^⅓ + 0.0173 p^½ for class 2, ⅔ of it for class 3, if 10 p engage;  G = T of class 3   (M262)
//! screw: d_max = D − G,  d2_max = D − 0.6 p − G,  each with T;  d3_max = D − 1.32542 p − G,
//!     d3_min = d2_min − 0.80803 p
//! nut: D_min = D + 0.12542 p,  D_max = D2_max + 0.80803 p;
//!     D2_min = D − 0.6 p,  D1_min = D − 1.2 p,  each with T
//! ```
//! The clearance flank, of 45 degrees, faces the end from which the thread is screwed on; of a PUSH-BUTT the
//! pressure flank, of 7, does. Source of the formulas: Machinery's Handbook 27, p. 1853 to 1855.

use std::fmt;

use crate::{
    limits::{Limits, Size, Unit},
    name::InchSize,
    profile::Profile,
    rounding::even,
    thread::Described,
};

/// Upper ends of the ranges of D, and their means, in.
const RANGES: [[f64; 2]; 8] =
    [[0.7, 0.6], [1.0, 0.85], [1.5, 1.25], [2.5, 2.0], [4.0, 3.25], [6.0, 5.0], [10.0, 8.0], [16.0, 13.0]];
/// Sizes of the standard that names have here, in.
pub(crate) const SIZES: std::ops::RangeInclusive<f64> = 0.5..=12.0;

/// A buttress thread; in.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Buttress {
    pub(crate) size: InchSize,
    pub(crate) tpi: f64,
    /// The pressure flank faces the end from which it is screwed on.
    pub(crate) push: bool,
    /// Class of the screw: 2 or 3.
    pub(crate) external: Option<u8>,
    /// Class of the nut: 2 or 3.
    pub(crate) internal: Option<u8>,
}

impl Buttress {
    /// T of a class, four places (M262).
    fn tolerance(&self, class: u8) -> f64 {
        let d = self.size.inches();
        let mean = RANGES.iter().find(|[end, _]| d <= *end).map_or(d, |[_, mean]| *mean);
        let second = 0.002 * libm::cbrt(mean) + 0.0173 / self.tpi.sqrt();
        even(if class == 3 { second / 1.5 } else { second }, 4)
    }

    fn screw(&self, class: u8) -> [(Size, f64); 6] {
        let (d, p) = (self.size.inches(), 1.0 / self.tpi);
        let (t, g) = (self.tolerance(class), self.tolerance(3));
        let four = |value: f64| even(value, 4);
        let (d_max, d2_max) = (four(d - g), four(d - 0.6 * p - g));
        let d2_min = four(d2_max - t);
        [
            (Size::MajorMax, d_max),
            (Size::MajorMin, four(d_max - t)),
            (Size::PitchMax, d2_max),
            (Size::PitchMin, d2_min),
            (Size::MinorMax, four(d - 1.32542 * p - g)),
            (Size::MinorMin, four(d2_min - 0.80803 * p)),
        ]
    }

    fn nut(&self, class: u8) -> [(Size, f64); 6] {
        let (d, p, t) = (self.size.inches(), 1.0 / self.tpi, self.tolerance(class));
        let four = |value: f64| even(value, 4);
        let (d2, d1) = (four(d - 0.6 * p), four(d - 1.2 * p));
        [
            (Size::MajorMax, four(d2 + t + 0.80803 * p)),
            (Size::MajorMin, four(d + 0.12542 * p)),
            (Size::PitchMax, four(d2 + t)),
            (Size::PitchMin, d2),
            (Size::MinorMax, four(d1 + t)),
            (Size::MinorMin, d1),
        ]
    }
}

impl Described for Buttress {
    fn standard(&self) -> &'static str {
        "ASME B1.9 BUTT"
    }

    fn limits(&self) -> Limits {
        let external = self.external.map(|class| self.screw(class));
        let internal = self.internal.map(|class| self.nut(class));
        let some = |sizes: &Option<[(Size, f64); 6]>| sizes.as_ref().map(|sizes| sizes.to_vec());
        Limits::new(Unit::Inch, some(&external).as_deref(), some(&internal).as_deref())
    }

    fn profile(&self) -> Profile {
        let (d, p) = (25.4 * self.size.inches(), 25.4 / self.tpi);
        // A thread begins at its higher end along Z: the ridge faces it where the groove is lower.
        let flank_deg = if self.push { [7.0, 45.0] } else { [45.0, 7.0] };
        Profile {
            flank_deg,
            pitch_mm: p,
            starts: 1,
            major_mm: d,
            pitch_diameter_mm: d - 0.6 * p,
            minor_mm: d - 1.2 * p,
            taper: 0.0,
            left_hand: false,
        }
    }

    fn note(&self) -> &'static str {
        "Tolerances are those of an engaged length of 10 pitches. Flanks are towards lower and higher Z of a groove that is cut \
         from the end at which the thread is screwed on."
    }
}

impl fmt::Display for Buttress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let push = if self.push { "PUSH-" } else { "" };
        write!(f, "{}-{} {push}BUTT-", self.size, self.tpi)?;
        let classes = self.external.map(|class| format!("{class}A")).into_iter();
        let classes: Vec<String> = classes.chain(self.internal.map(|class| format!("{class}B"))).collect();
        f.write_str(&classes.join("/"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Machinery's Handbook 27, p. 1854, table 4: tolerances of class 2 by threads per inch, for each range
    /// from 0.5 in on, 0 where it has none.
    #[test]
    fn tolerances_are_those_of_the_table() {
        for (tpi, row) in [
            (20.0, [0.0056, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
            (16.0, [0.0060, 0.0062, 0.0065, 0.0068, 0.0073, 0.0, 0.0, 0.0]),
            (12.0, [0.0067, 0.0069, 0.0071, 0.0075, 0.0080, 0.0084, 0.0, 0.0]),
            (10.0, [0.0, 0.0074, 0.0076, 0.0080, 0.0084, 0.0089, 0.0095, 0.0102]),
        ] {
            for (printed, [end, _]) in row.into_iter().zip(RANGES).filter(|(printed, _)| *printed > 0.0) {
                let name = format!("{}-{tpi} BUTT-2A", end.min(*SIZES.end()));
                let thread: crate::Thread = name.parse().expect("a buttress thread");
                let screw = thread.limits().external.expect("a screw");
                let inch = |size| screw.sizes().find(|(of, _)| *of == size).expect("it is limited").1;
                let t = inch(Size::PitchMax) - inch(Size::PitchMin);
                assert!((t - printed).abs() < 1e-9, "{name}: {t}, printed {printed}");
            }
        }
    }
}
