//! Pipe threads: G (ISO 228-1), R, Rp and Rc (ISO 7-1), in mm; NPT (ASME B1.20.1), in inches. In: nominal
//! size, class. Out: limits, and what a taper has instead.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | P, n | mm, – | pitch, threads per inch |
//! | D | in | outside diameter of the pipe (NPT) |
//! | E0, E1 | in | pitch diameter at the small end; where hand-tight engagement ends |
//! | L1, L2 | in | length of hand-tight engagement, of effective thread |
//! | L, t | mm, – | gauge length of ISO 7: small end of a screw to its gauge plane; how many turns that may be off |
//!
//! ```text
//! G: H = 0.960491 P,  h = 0.640327 P;  d2 = d − h,  d1 = d − 2 h, h to three places
//!     T_d2 of class A = T_D2, of class B twice that;  T_d = 2 T_D2                                   (M145)
//! NPT: E0 = D − (0.05 D + 1.1)/n,  E1 = E0 + L1/16,  L2 = (0.8 D + 6.8)/n;
//!     one turn is P/16 of diameter                                                                  (M146)
//! R, Rc: d2 ± t P/16 at L from the small end of a screw, at the face of a nut; Rp: D2 ± t P/16;
//!     t = 1 of a screw, 1 1/4 of a nut, 1 1/2 of both from 2 1/2 on                                  (M191)
//! ```
//!
//! Diameters and tolerances of G, D and L1 of NPT, L and the useful length of ISO 7 are tables. A taper is
//! 1:16 of diameter.

use std::fmt;

use crate::{
    limits::{Limits, Size, Unit},
    profile::Profile,
    rounding::even,
    thread::Described,
};

/// ISO 228-1, table 1: nominal size, threads per inch, d in mm. ISO 7-1 has the same ones.
const PARALLEL: [(&str, u32, f64); 24] = [
    ("1/16", 28, 7.723),
    ("1/8", 28, 9.728),
    ("1/4", 19, 13.157),
    ("3/8", 19, 16.662),
    ("1/2", 14, 20.955),
    ("5/8", 14, 22.911),
    ("3/4", 14, 26.441),
    ("7/8", 14, 30.201),
    ("1", 11, 33.249),
    ("1 1/8", 11, 37.897),
    ("1 1/4", 11, 41.910),
    ("1 1/2", 11, 47.803),
    ("1 3/4", 11, 53.746),
    ("2", 11, 59.614),
    ("2 1/4", 11, 65.710),
    ("2 1/2", 11, 75.184),
    ("2 3/4", 11, 81.534),
    ("3", 11, 87.884),
    ("3 1/2", 11, 100.330),
    ("4", 11, 113.030),
    ("4 1/2", 11, 125.730),
    ("5", 11, 138.430),
    ("5 1/2", 11, 151.130),
    ("6", 11, 163.830),
];

/// ISO 7-1, table 1: sizes of ISO 228-1, gauge length, useful length of a screw of that gauge length, mm.
const JOINTING: [(&str, f64, f64); 15] = [
    ("1/16", 4.0, 6.5),
    ("1/8", 4.0, 6.5),
    ("1/4", 6.0, 9.7),
    ("3/8", 6.4, 10.1),
    ("1/2", 8.2, 13.2),
    ("3/4", 9.5, 14.5),
    ("1", 10.4, 16.8),
    ("1 1/4", 12.7, 19.1),
    ("1 1/2", 12.7, 19.1),
    ("2", 15.9, 23.4),
    ("2 1/2", 17.5, 26.7),
    ("3", 20.6, 29.8),
    ("4", 25.4, 35.8),
    ("5", 28.6, 40.1),
    ("6", 28.6, 40.1),
];

/// Above this the tolerance of 11 threads per inch is the wider one, mm: G2, R2.
const NARROW_UP_TO: f64 = 59.614;

/// ASME B1.20.1, table 2: nominal size, threads per inch, D and L1 in inches.
const TAPER: [(&str, f64, f64, f64); 16] = [
    ("1/16", 27.0, 0.3125, 0.160),
    ("1/8", 27.0, 0.405, 0.1615),
    ("1/4", 18.0, 0.540, 0.2278),
    ("3/8", 18.0, 0.675, 0.240),
    ("1/2", 14.0, 0.840, 0.320),
    ("3/4", 14.0, 1.050, 0.339),
    ("1", 11.5, 1.315, 0.400),
    ("1 1/4", 11.5, 1.660, 0.420),
    ("1 1/2", 11.5, 1.900, 0.420),
    ("2", 11.5, 2.375, 0.436),
    ("2 1/2", 8.0, 2.875, 0.682),
    ("3", 8.0, 3.500, 0.766),
    ("3 1/2", 8.0, 4.000, 0.821),
    ("4", 8.0, 4.500, 0.844),
    ("5", 8.0, 5.563, 0.937),
    ("6", 8.0, 6.625, 0.958),
];

/// Nominal sizes of G.
pub(crate) fn parallel_sizes() -> Vec<&'static str> {
    PARALLEL.iter().map(|(size, ..)| *size).collect()
}

/// Nominal sizes of R, Rp and Rc.
pub(crate) fn jointing_sizes() -> Vec<&'static str> {
    JOINTING.iter().map(|(size, ..)| *size).collect()
}

/// Nominal sizes of NPT, with their threads per inch.
pub(crate) fn taper_sizes() -> Vec<(&'static str, f64)> {
    TAPER.iter().map(|(size, tpi, ..)| (*size, *tpi)).collect()
}

/// d, d2, d1 and P of a size of ISO 228-1, mm; the pitch to three places, as the standard has it.
fn diameters(size: &str) -> ([f64; 3], f64, u32) {
    let found = PARALLEL.iter().find(|(of, ..)| *of == size);
    let (_, tpi, d) = found.expect("names are checked when they are read");
    let pitch = even(25.4 / f64::from(*tpi), 3);
    let h = even(0.640327 * 25.4 / f64::from(*tpi), 3);
    ([*d, even(d - h, 3), even(d - 2.0 * h, 3)], pitch, *tpi)
}

fn whitworth(size: &str, taper: f64) -> Profile {
    let ([major, pitch_diameter, minor], _, tpi) = diameters(size);
    Profile {
        flank_deg: [27.5; 2],
        pitch_mm: 25.4 / f64::from(tpi),
        starts: 1,
        major_mm: major,
        pitch_diameter_mm: pitch_diameter,
        minor_mm: minor,
        taper,
        left_hand: false,
    }
}

/// G, ISO 228-1.
#[derive(Clone, Debug)]
pub(crate) struct Parallel {
    pub(crate) size: &'static str,
    /// Class of the screw, A or B, if the name has one; else A.
    pub(crate) class: Option<char>,
}

/// G1/2 and G1/2-A are one thread, though the second name speaks of the screw.
impl PartialEq for Parallel {
    fn eq(&self, other: &Parallel) -> bool {
        let class = |thread: &Parallel| thread.class.unwrap_or('A');
        self.size == other.size && class(self) == class(other)
    }
}

impl Described for Parallel {
    fn standard(&self) -> &'static str {
        "ISO 228 G"
    }

    fn limits(&self) -> Limits {
        let ([d, d2, d1], _, tpi) = diameters(self.size);
        let (t_d2, t_d1) = match tpi {
            28 => (0.107, 0.282),
            19 => (0.125, 0.445),
            14 => (0.142, 0.541),
            _ if d <= NARROW_UP_TO => (0.180, 0.640),
            _ => (0.217, 0.640),
        };
        let um = |mm: f64| even(mm, 3);
        let screw = [
            (Size::MajorMax, d),
            (Size::MajorMin, um(d - 2.0 * t_d2)),
            (Size::PitchMax, d2),
            (Size::PitchMin, um(d2 - if self.class == Some('B') { 2.0 * t_d2 } else { t_d2 })),
            (Size::MinorMax, d1),
        ];
        let nut = [
            (Size::MajorMin, d),
            (Size::PitchMax, um(d2 + t_d2)),
            (Size::PitchMin, d2),
            (Size::MinorMax, um(d1 + t_d1)),
            (Size::MinorMin, d1),
        ];
        Limits::new(Unit::Mm, Some(&screw), Some(&nut))
    }

    fn profile(&self) -> Profile {
        whitworth(self.size, 0.0)
    }

    fn note(&self) -> &'static str {
        "d3_max and D_min are basic sizes; their other limits are left to the tool. The nut has one class."
    }
}

impl fmt::Display for Parallel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "G{}-{}", self.size, self.class.unwrap_or('A'))
    }
}

/// What a name of ISO 7-1 begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Joint {
    /// A tapered screw, R.
    Screw,
    /// A parallel nut, Rp.
    ParallelNut,
    /// A tapered nut, Rc.
    TaperedNut,
}

/// R, Rp and Rc, ISO 7-1.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Jointing {
    pub(crate) size: &'static str,
    pub(crate) joint: Joint,
}

impl Described for Jointing {
    fn standard(&self) -> &'static str {
        "ISO 7 R"
    }

    fn limits(&self) -> Limits {
        let ([d, d2, d1], _, tpi) = diameters(self.size);
        let found = JOINTING.iter().find(|(of, ..)| *of == self.size);
        let (_, gauge_mm, useful_mm) = *found.expect("names are checked when they are read");
        let turns = match self.joint {
            _ if d > NARROW_UP_TO => 1.5,
            Joint::Screw => 1.0,
            Joint::ParallelNut | Joint::TaperedNut => 1.25,
        };
        let off = even(turns * 25.4 / f64::from(tpi) / 16.0, 3);
        let [most, least] = [off, -off].map(|off| even(d2 + off, 3));
        let plane = [
            (Size::Major, d),
            (Size::Pitch, d2),
            (Size::PitchMax, most),
            (Size::PitchMin, least),
            (Size::Minor, d1),
        ];
        let length = (Size::GaugeLength, gauge_mm);
        match self.joint {
            Joint::Screw => {
                let lengths = [length, (Size::EffectiveLength, useful_mm)];
                Limits::new(Unit::Mm, Some(&[&plane[..], &lengths].concat()), None)
            }
            Joint::ParallelNut => Limits::new(Unit::Mm, None, Some(&plane)),
            Joint::TaperedNut => Limits::new(Unit::Mm, None, Some(&[&plane[..], &[length]].concat())),
        }
    }

    fn profile(&self) -> Profile {
        whitworth(self.size, if self.joint == Joint::ParallelNut { 0.0 } else { 1.0 / 16.0 })
    }

    fn note(&self) -> &'static str {
        "Diameters at the gauge plane: the gauge length from the small end of a screw, the face of a nut. It may lie a turn \
         off (of a nut 1 1/4 turns, from 2 1/2 on 1 1/2), which is d2_min ... d2_max at that place."
    }
}

impl fmt::Display for Jointing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let letters = match self.joint {
            Joint::Screw => "R",
            Joint::ParallelNut => "Rp",
            Joint::TaperedNut => "Rc",
        };
        write!(f, "{letters}{}", self.size)
    }
}

/// NPT, ASME B1.20.1.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Taper {
    pub(crate) size: &'static str,
}

impl Taper {
    fn row(&self) -> (f64, f64, f64) {
        let found = TAPER.iter().find(|(of, ..)| *of == self.size);
        let (_, tpi, d, l1) = found.expect("names are checked when they are read");
        (*tpi, *d, *l1)
    }
}

impl Described for Taper {
    fn standard(&self) -> &'static str {
        "ASME B1.20.1 NPT"
    }

    fn limits(&self) -> Limits {
        let (n, d, l1) = self.row();
        let five = |value: f64| even(value, 5);
        let e0 = d - (0.05 * d + 1.1) / n;
        let (e1, turn) = (e0 + l1 / 16.0, 1.0 / n / 16.0);
        let plane = [
            (Size::HandTight, five(e1)),
            (Size::HandTightMax, five(e1 + turn)),
            (Size::HandTightMin, five(e1 - turn)),
            (Size::HandTightLength, l1),
        ];
        let mut screw = vec![(Size::SmallEnd, five(e0))];
        screw.extend(plane);
        screw.push((Size::EffectiveLength, even((0.8 * d + 6.8) / n, 4)));
        Limits::new(Unit::Inch, Some(&screw), Some(&plane))
    }

    fn profile(&self) -> Profile {
        let (n, d, l1) = self.row();
        let (pitch, e1) = (25.4 / n, 25.4 * (d - (0.05 * d + 1.1) / n + l1 / 16.0));
        // The depth of the sharp triangle lies evenly about the pitch line; truncated, h is at most 0.8 P.
        Profile {
            flank_deg: [30.0; 2],
            pitch_mm: pitch,
            starts: 1,
            major_mm: e1 + 0.8 * pitch,
            pitch_diameter_mm: e1,
            minor_mm: e1 - 0.8 * pitch,
            taper: 1.0 / 16.0,
            left_hand: false,
        }
    }

    fn note(&self) -> &'static str {
        "E1 is the pitch diameter at L1 from the small end of a screw, and at the end of a nut; it may be off by one turn, \
         which is E1_min ... E1_max at that place."
    }
}

impl fmt::Display for Taper {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "NPT {}-{}", self.size, self.row().0)
    }
}
