//! Metric trapezoidal threads, ISO 2901 … 2904 (DIN 103). In: nominal diameter and pitch in mm, classes. Out:
//! limits in mm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | a_c | mm | clearance at the crests, by pitch |
//! | es | µm | deviation of the pitch diameter of the screw, position c or e |
//!
//! ```text
//! d2 = D2 = d − P/2,  D1 = d − P,  d3 = d − P − 2 a_c,  D4 = d + 2 a_c                              (M141)
//! d_max = d,  d2_max = d2 − |es|,  d3_max = d3,  T_d3 = 1.25 T_d2 + |es|, a half of 1.25 T_d2 to the even µm
//! D1_min = D1,  D2_min = D2,  D_min = D4, each from there up
//! ```
//!
//! T_d2 and T_D2 are those of M threads: the same T_d2(6) and the same steps of R40 (`grades.rs`). Major
//! diameter of the screw and minor diameter of the nut have grade 4 alone. With several starts the tolerance
//! of d2 and D2, and nothing else, is 1.12, 1.25, 1.4 or, from five starts on, 1.6 times as wide.

use std::fmt;

use crate::{
    grades::{anchor, range},
    iso_m::{lead, write_classes},
    limits::{Limits, Size, Unit},
    profile::Profile,
    rounding::{even, half_up},
    thread::Described,
};

/// What ISO 2901 and ISO 2903 have for a pitch: P and a_c in mm; |es| of c and e, T_d(4), T_D1(4) in µm.
struct Row {
    pitch: f64,
    a_c: f64,
    c: Option<f64>,
    e: f64,
    td: f64,
    td1: f64,
}

const fn row(pitch: f64, a_c: f64, c: Option<f64>, e: f64, td: f64, td1: f64) -> Row {
    Row { pitch, a_c, c, e, td, td1 }
}

/// ISO 2901, table 1 (a_c) and ISO 2903, tables of deviations and of T_d and T_D1. Position c is here where a
/// public source has it.
const TABLE: [Row; 22] = [
    row(1.5, 0.15, Some(140.0), 67.0, 150.0, 190.0),
    row(2.0, 0.25, Some(150.0), 71.0, 180.0, 236.0),
    row(3.0, 0.25, Some(170.0), 85.0, 236.0, 315.0),
    row(4.0, 0.25, Some(190.0), 95.0, 300.0, 375.0),
    row(5.0, 0.25, Some(212.0), 106.0, 335.0, 450.0),
    row(6.0, 0.5, Some(236.0), 118.0, 375.0, 500.0),
    row(7.0, 0.5, None, 125.0, 425.0, 560.0),
    row(8.0, 0.5, Some(265.0), 132.0, 450.0, 630.0),
    row(9.0, 0.5, None, 140.0, 500.0, 670.0),
    row(10.0, 0.5, None, 150.0, 530.0, 710.0),
    row(12.0, 0.5, None, 170.0, 600.0, 800.0),
    row(14.0, 1.0, None, 180.0, 670.0, 900.0),
    row(16.0, 1.0, None, 190.0, 710.0, 1000.0),
    row(18.0, 1.0, None, 200.0, 800.0, 1120.0),
    row(20.0, 1.0, None, 212.0, 850.0, 1180.0),
    row(22.0, 1.0, None, 224.0, 900.0, 1250.0),
    row(24.0, 1.0, None, 236.0, 950.0, 1320.0),
    row(28.0, 1.0, None, 250.0, 1060.0, 1500.0),
    row(32.0, 1.0, None, 265.0, 1120.0, 1600.0),
    row(36.0, 1.0, None, 280.0, 1250.0, 1800.0),
    row(40.0, 1.0, None, 300.0, 1320.0, 1900.0),
    row(44.0, 1.0, None, 315.0, 1400.0, 2000.0),
];

/// Published limits of P = 12 have this |es| in T_d3, and that of the table in d2, µm.
const E_OF_12_IN_TD3: f64 = 160.0;

/// A position of the pitch diameter of a screw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Position {
    C,
    E,
}

/// A trapezoidal thread; mm.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Trapezoidal {
    pub(crate) d: f64,
    pub(crate) pitch: f64,
    pub(crate) starts: u32,
    pub(crate) external: Option<(u8, Position)>,
    pub(crate) internal: Option<u8>,
}

/// Pitches of the standard, mm.
pub(crate) fn pitches() -> impl Iterator<Item = f64> {
    TABLE.iter().map(|row| row.pitch)
}

/// |es| in µm; none where no public source has it.
pub(crate) fn deviation(position: Position, pitch: f64) -> Option<f64> {
    let row = TABLE.iter().find(|row| row.pitch == pitch)?;
    match position {
        Position::C => row.c,
        Position::E => Some(row.e),
    }
}

impl Trapezoidal {
    fn row(&self) -> &'static Row {
        TABLE.iter().find(|row| row.pitch == self.pitch).expect("names are checked when they are read")
    }

    /// Tolerance of the pitch diameter so many steps of R40 from T_d2(6), mm.
    fn tolerance(&self, steps: i32) -> f64 {
        let range = range(self.d).expect("names are checked when they are read");
        anchor(range, self.pitch).step(steps).whole() / 1e3
    }

    /// How much wider several starts make that of d2 and D2.
    fn wider(&self) -> f64 {
        match self.starts {
            1 => 1.0,
            2 => 1.12,
            3 => 1.25,
            4 => 1.4,
            _ => 1.6,
        }
    }

    fn screw(&self, grade: u8, position: Position) -> Vec<(Size, f64)> {
        let (row, um) = (self.row(), |mm: f64| half_up(mm, 3));
        let es = deviation(position, self.pitch).expect("names are checked when they are read") / 1e3;
        let es_of_root = match position {
            Position::E if self.pitch == 12.0 => E_OF_12_IN_TD3 / 1e3,
            _ => es,
        };
        // Grades 6 … 9 of a screw, 7 … 9 of a nut: four steps of R40 from one to the next.
        let td2 = self.tolerance(4 * (i32::from(grade) - 6));
        let d2_max = self.d - self.pitch / 2.0 - es;
        let d3_max = self.d - self.pitch - 2.0 * row.a_c;
        vec![
            (Size::MajorMax, self.d),
            (Size::MajorMin, um(self.d - row.td / 1e3)),
            (Size::PitchMax, um(d2_max)),
            (Size::PitchMin, um(d2_max - um(td2 * self.wider()))),
            (Size::MinorMax, um(d3_max)),
            (Size::MinorMin, um(d3_max - even(1.25 * td2, 3) - es_of_root)),
        ]
    }

    fn nut(&self, grade: u8) -> Vec<(Size, f64)> {
        let (row, um) = (self.row(), |mm: f64| half_up(mm, 3));
        let td2 = self.tolerance(5 + 4 * (i32::from(grade) - 6));
        vec![
            (Size::MajorMin, um(self.d + 2.0 * row.a_c)),
            (Size::PitchMax, um(self.d - self.pitch / 2.0 + um(td2 * self.wider()))),
            (Size::PitchMin, um(self.d - self.pitch / 2.0)),
            (Size::MinorMax, um(self.d - self.pitch + row.td1 / 1e3)),
            (Size::MinorMin, um(self.d - self.pitch)),
        ]
    }
}

impl Described for Trapezoidal {
    fn standard(&self) -> &'static str {
        "ISO 2903 Tr"
    }

    fn limits(&self) -> Limits {
        let external = self.external.map(|(grade, position)| self.screw(grade, position));
        let internal = self.internal.map(|grade| self.nut(grade));
        Limits::new(Unit::Mm, external.as_deref(), internal.as_deref())
    }

    fn profile(&self) -> Profile {
        Profile {
            flank_deg: [15.0; 2],
            pitch_mm: self.pitch,
            starts: self.starts,
            major_mm: self.d,
            pitch_diameter_mm: self.d - self.pitch / 2.0,
            minor_mm: self.d - self.pitch,
            taper: 0.0,
            left_hand: false,
        }
    }

    fn note(&self) -> &'static str {
        "Major and minor diameter of a screw always have position h, those of a nut H; only d2 lies at c or e. \
         D_max is not limited."
    }
}

impl fmt::Display for Trapezoidal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Tr{}x{}", self.d, lead(self.pitch, self.starts))?;
        if self.starts > 1 {
            write!(f, "P{}", self.pitch)?;
        }
        let external = self
            .external
            .map(|(grade, position)| format!("{grade}{}", if position == Position::C { 'c' } else { 'e' }));
        write_classes(f, external, self.internal.map(|grade| format!("{grade}H")))
    }
}
