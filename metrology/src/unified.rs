//! Unified inch threads: UN, UNC, UNF, UNEF, UNS, and UNR of each of ASME B1.1, UNJ of each of ASME B1.15.
//! In: size in inches, threads per inch, classes. Out: limits in inches, four places.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | D, P | in | basic major diameter, pitch = 1/n |
//! | L | in | length of engagement that tolerances are made for: D for UNC, UNF, 4-UN, 6-UN and 8-UN, 9 P for others |
//! | T | in | tolerance of the pitch diameter of class 2A |
//!
//! ```text
//! T = 0.0015 D^⅓ + 0.0015 L^½ + 0.015 P^⅔, each term to six places
//! T_d2 = 1.5 T (1A), T (2A), 0.75 T (3A);  T_D2 = 1.95 T (1B), 1.3 T (2B), 0.975 T (3B)
//! allowance of 1A and 2A: 0.3 T;  T_d = 0.06 P^⅔, 0.09 P^⅔ (1A)                                      (M142)
//! 1B, 2B below 0.25 in: T_D1 = 0.05 P^⅔ + 0.03 P/D − 0.002, within 0.25 P − 0.4 P² … 0.394 P
//!     from 0.25 in on: 0.25 P − 0.4 P² with 4 threads per inch or more, 0.15 P with fewer
//! 3B: 0.05 P^⅔ + 0.03 P/D − 0.002, within 0.23 P − 1.5 P² (13 threads per inch and finer) or 0.12 P
//!     and 0.394 P
//! d1_max = d_max − 1.226869 P, of UNR d_max − 1.19078 P                                             (M143)
//! UNJ: tolerances of UN; root radius R from 0.15011 P to 0.18042 P, so that the root is H/2 − R below the
//!     pitch line: d3_max = d2_max − H + 2 R_max,  d3_min = d2_min − H + 2 R_min,  H = 0.866025 P
//!     D1_min = D − 9/8 H, the crest of the nut clear of that root                                    (M261)
//! ```
//! D1_max of UNJ is none of these formulas, and no public table of it was found: it is not told.
//!
//! Rounding: every product to four places, a half to the even one; D2 = D − 0.649519 P and D1 = D − 1.082532
//! P to four places before anything is added. Then D1 of 1B and 2B to three places from No. 6 up (0.138 in),
//! of 3B the smallest alone; a half up.

use std::fmt;

use crate::{
    limits::{Limits, Size, Unit},
    name::InchSize,
    profile::Profile,
    rounding::{even, half_up},
    series::Series,
    thread::Described,
};

/// From this size on minor diameters of nuts have three places, in: No. 6.
const THREE_PLACES_FROM: f64 = 0.138;

/// What the root of the screw is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Root {
    /// Flat or rounded: UN.
    Flat,
    /// Rounded: UNR.
    Rounded,
    /// With a large radius, and a nut that is clear of it: UNJ.
    Large,
}

impl Root {
    /// The letter behind UN.
    fn letter(self) -> &'static str {
        match self {
            Root::Flat => "",
            Root::Rounded => "R",
            Root::Large => "J",
        }
    }
}

/// H of a pitch of one, and the radii of the root of UNJ.
const H: f64 = 0.866025;
const RADII: [f64; 2] = [0.15011, 0.18042];

/// A unified thread; in.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Unified {
    pub(crate) size: InchSize,
    pub(crate) tpi: f64,
    pub(crate) series: Series,
    pub(crate) root: Root,
    /// Class of the screw: 1, 2 or 3.
    pub(crate) external: Option<u8>,
    /// Class of the nut: 1, 2 or 3.
    pub(crate) internal: Option<u8>,
}

impl Unified {
    fn pitch(&self) -> f64 {
        1.0 / self.tpi
    }

    /// D − D1 of a pitch of one.
    fn height(&self) -> f64 {
        if self.root == Root::Large { 1.125 * H } else { 1.082532 }
    }

    /// D2 and D1, four places.
    fn basic(&self) -> [f64; 2] {
        [0.649519, self.height()].map(|depth| even(self.size.inches() - depth * self.pitch(), 4))
    }

    /// T (M142).
    fn tolerance(&self) -> f64 {
        let (d, pitch) = (self.size.inches(), self.pitch());
        let by_diameter = match self.series {
            Series::C | Series::F => true,
            Series::N => [4.0, 6.0, 8.0].contains(&self.tpi),
            Series::Ef | Series::S => false,
        };
        let engaged = if by_diameter { d } else { 9.0 * pitch };
        let terms = [0.0015 * libm::cbrt(d), 0.0015 * engaged.sqrt(), 0.015 * libm::pow(pitch, 2.0 / 3.0)];
        terms.map(|term| even(term, 6)).iter().sum()
    }

    fn screw(&self, class: u8) -> Vec<(Size, f64)> {
        let (d, pitch, t) = (self.size.inches(), self.pitch(), self.tolerance());
        let [d2, _] = self.basic();
        let (factor, crest) = match class {
            1 => (1.5, 0.09),
            2 => (1.0, 0.06),
            _ => (0.75, 0.06),
        };
        let allowance = if class == 3 { 0.0 } else { even(0.3 * t, 4) };
        let four = |value: f64| even(value, 4);
        let d_max = four(four(d) - allowance);
        let d2_max = four(d2 - allowance);
        let d2_min = four(d2_max - four(factor * t));
        let mut sizes = vec![
            (Size::MajorMax, d_max),
            (Size::MajorMin, four(d_max - four(crest * libm::pow(pitch, 2.0 / 3.0)))),
            (Size::PitchMax, d2_max),
            (Size::PitchMin, d2_min),
        ];
        match self.root {
            Root::Flat => sizes.push((Size::FlatMinorMax, four(d_max - 1.226869 * pitch))),
            Root::Rounded => sizes.push((Size::FlatMinorMax, four(d_max - 1.19078 * pitch))),
            Root::Large => {
                let [least, most] = RADII;
                sizes.extend([
                    (Size::MinorMax, four(d2_max - (H - 2.0 * most) * pitch)),
                    (Size::MinorMin, four(d2_min - (H - 2.0 * least) * pitch)),
                    (Size::RootRadiusMax, four(most * pitch)),
                    (Size::RootRadiusMin, four(least * pitch)),
                ]);
            }
        }
        sizes
    }

    /// T_D1 (M143), four places.
    fn minor_tolerance(&self, class: u8) -> f64 {
        let (d, pitch) = (self.size.inches(), self.pitch());
        let by_size = 0.05 * libm::pow(pitch, 2.0 / 3.0) + 0.03 * pitch / d - 0.002;
        let least = match class {
            3 if self.tpi >= 13.0 => 0.23 * pitch - 1.5 * pitch * pitch,
            3 => 0.12 * pitch,
            _ if self.tpi >= 4.0 => 0.25 * pitch - 0.4 * pitch * pitch,
            _ => 0.15 * pitch,
        };
        let tolerance = if class == 3 || d < 0.25 { by_size.min(0.394 * pitch).max(least) } else { least };
        even(tolerance, 4)
    }

    fn nut(&self, class: u8) -> Vec<(Size, f64)> {
        let [d2, d1] = self.basic();
        let factor = match class {
            1 => 1.95,
            2 => 1.3,
            _ => 0.975,
        };
        let four = |value: f64| even(value, 4);
        let mut sizes = vec![
            (Size::MajorMin, four(self.size.inches())),
            (Size::PitchMax, four(d2 + four(factor * self.tolerance()))),
            (Size::PitchMin, d2),
        ];
        if self.root == Root::Large {
            sizes.push((Size::MinorMin, d1));
            return sizes;
        }
        let d1_max = four(d1 + self.minor_tolerance(class));
        let coarse = self.size.inches() >= THREE_PLACES_FROM;
        let [largest, smallest] = [coarse && class != 3, coarse].map(|three| if three { 3 } else { 4 });
        sizes.extend([(Size::MinorMax, half_up(d1_max, largest)), (Size::MinorMin, half_up(d1, smallest))]);
        sizes
    }
}

impl Described for Unified {
    fn standard(&self) -> &'static str {
        if self.root == Root::Large { "ASME B1.15 UNJ" } else { "ASME B1.1 UN" }
    }

    fn limits(&self) -> Limits {
        let external = self.external.map(|class| self.screw(class));
        let internal = self.internal.map(|class| self.nut(class));
        Limits::new(Unit::Inch, external.as_deref(), internal.as_deref())
    }

    fn profile(&self) -> Profile {
        let (d, pitch) = (25.4 * self.size.inches(), 25.4 * self.pitch());
        Profile {
            flank_deg: [30.0; 2],
            pitch_mm: pitch,
            starts: 1,
            major_mm: d,
            pitch_diameter_mm: d - 0.649519 * pitch,
            minor_mm: d - self.height() * pitch,
            taper: 0.0,
            left_hand: false,
        }
    }

    fn note(&self) -> &'static str {
        if self.root == Root::Large {
            return "The root of the screw has a radius between R_min and R_max. Tolerances are those of UN with the standard \
                    length of engagement. D_max is not limited; D1_max is not known here.";
        }
        "d1_max is d_max - 1.226869 P, as older tables have it, of UNR d_max - 1.19078 P (B1.1-2003); the flat form has \
         d_max - 1.082532 P. Tolerances are those of the standard length of engagement. D_max is not limited."
    }
}

impl fmt::Display for Unified {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}-{} UN{}{}", self.size, self.tpi, self.root.letter(), self.series.letters())?;
        let classes = self.external.map(|class| format!("{class}A")).into_iter();
        let classes: Vec<String> = classes.chain(self.internal.map(|class| format!("{class}B"))).collect();
        write!(f, "-{}", classes.join("/"))
    }
}
