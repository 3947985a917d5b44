//! Tolerances of metric threads by grade, ISO 965-1. In: nominal diameter d and pitch P in mm, grade. Out:
//! µm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | T_d, T_D1 | µm | tolerance of the major diameter of a screw, of the minor diameter of a nut |
//! | T_d2, T_D2 | µm | tolerance of the pitch diameter of a screw, of a nut |
//! | d̄ | mm | geometric mean of the ends of the range of diameters that d lies in |
//!
//! ```text
//! T_d(6) = 180 P^⅔ − 3.15 P^−½;  T_D1(6) = 433 P − 190 P^1.22 up to P = 0.8, 230 P^0.7 above
//! T_d2(6) = 90 P^0.4 d̄^0.1                                                                          (M138)
//! ```
//!
//! Only grade 6 follows a formula. Its value is rounded to the nearest preferred number of R40; the other
//! grades are steps of R40 from there, and the grades of T_D2 are steps from T_d2(6) (M136). Where the tables
//! of the standard leave that, the number is here with its place. A pair of range and pitch that the tables
//! do not have has the formula with d itself and the factors of ISO 965-1, clause 13, rounded to whole µm (as
//! FED-STD-H28/21B does in its examples).

use crate::{
    limits::Side,
    rounding::{Preferred, even},
};

/// Ends of the ranges of diameters, mm: above the one, up to and with the next. ISO 965-1, clause 13.
const RANGES: [f64; 10] = [0.99, 1.4, 2.8, 5.6, 11.2, 22.4, 45.0, 90.0, 180.0, 355.0];

/// Pitches that the tables of pitch diameters have in each range, mm.
const LISTED: [&[f64]; 9] = [
    &[0.2, 0.25, 0.3],
    &[0.2, 0.25, 0.35, 0.4, 0.45],
    &[0.2, 0.25, 0.35, 0.5, 0.6, 0.7, 0.75, 0.8],
    &[0.2, 0.25, 0.35, 0.5, 0.75, 1.0, 1.25, 1.5],
    &[0.35, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5],
    &[0.35, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 3.5, 4.0, 4.5],
    &[0.35, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 5.5, 6.0],
    &[0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0],
    &[1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0],
];

/// T_d2(6) that the tables have instead of the formula: range, pitch in mm, µm.
const ANCHORS: [(usize, f64, f64); 5] =
    [(2, 0.5, 75.0), (6, 5.0, 250.0), (6, 18.0, 450.0), (8, 3.0, 250.0), (8, 4.0, 280.0)];

/// Published tolerances of M22x3, a pair that is not in the tables and follows neither rule: grade, µm.
const M22X3: [(Side, u8, f64); 3] =
    [(Side::External, 4, 118.0), (Side::External, 6, 185.0), (Side::Internal, 6, 245.0)];

/// Grades of a pitch diameter: grade, steps of R40 from T_d2(6), factor of the formula, least pitch in mm.
const PITCH_GRADES: [&[(u8, i32, f64, f64)]; 2] = [
    &[
        (3, -12, 0.5, 0.2),
        (4, -8, 0.63, 0.2),
        (5, -4, 0.8, 0.2),
        (6, 0, 1.0, 0.2),
        (7, 4, 1.25, 0.35),
        (8, 8, 1.6, 0.8),
        (9, 12, 2.0, 0.8),
    ],
    &[(4, -3, 0.85, 0.2), (5, 1, 1.06, 0.2), (6, 5, 1.32, 0.3), (7, 9, 1.7, 0.5), (8, 13, 2.12, 0.8)],
];

/// Grades of the diameter of a crest: grade, steps of R40 from grade 6, least pitch in mm.
const CREST_GRADES: [&[(u8, i32, f64)]; 2] = [
    &[(4, -8, 0.2), (6, 0, 0.2), (8, 8, 0.8)],
    &[(4, -8, 0.2), (5, -4, 0.25), (6, 0, 0.3), (7, 4, 0.5), (8, 8, 0.8)],
];

/// The range of diameters that d lies in; none outside of all.
pub(crate) fn range(d: f64) -> Option<usize> {
    let above = RANGES.iter().position(|end| d <= *end)?;
    above.checked_sub(1)
}

/// T_d2(6) of a range (M138), also for trapezoidal threads.
pub(crate) fn anchor(range: usize, pitch: f64) -> Preferred {
    let table = ANCHORS.iter().find(|(of, at, _)| *of == range && *at == pitch);
    let mean = (RANGES[range] * RANGES[range + 1]).sqrt();
    Preferred::nearest(table.map_or_else(|| pitch_formula(mean, pitch), |(_, _, um)| *um))
}

fn pitch_formula(d: f64, pitch: f64) -> f64 {
    90.0 * libm::pow(pitch, 0.4) * libm::pow(d, 0.1)
}

/// Whether there is a grade of the pitch diameter for this pitch.
pub(crate) fn has_pitch_grade(side: Side, grade: u8, pitch: f64) -> bool {
    PITCH_GRADES[side as usize].iter().any(|(of, _, _, least)| *of == grade && pitch >= *least)
}

/// Whether there is a grade of the crest for this pitch.
pub(crate) fn has_crest_grade(side: Side, grade: u8, pitch: f64) -> bool {
    CREST_GRADES[side as usize].iter().any(|(of, _, least)| *of == grade && pitch >= *least)
}

/// Grades that exist, of pitch diameter and crest.
pub(crate) fn known(side: Side) -> (Vec<u8>, Vec<u8>) {
    let pitch = PITCH_GRADES[side as usize].iter().map(|(grade, ..)| *grade);
    (pitch.collect(), CREST_GRADES[side as usize].iter().map(|(grade, ..)| *grade).collect())
}

/// Tolerance of the pitch diameter, µm: T_d2 or T_D2.
///
/// # Panics
/// If d lies in no range or the grade does not exist: names are checked when they are read.
pub(crate) fn pitch_tolerance(side: Side, grade: u8, d: f64, pitch: f64) -> f64 {
    let published = M22X3.iter().find(|(of, at, _)| d == 22.0 && pitch == 3.0 && (*of, *at) == (side, grade));
    if let Some((_, _, um)) = published {
        return *um;
    }
    let found = PITCH_GRADES[side as usize].iter().find(|(of, ..)| *of == grade);
    let (range, (_, steps, factor, _)) = range(d).zip(found).expect("names are checked when they are read");
    if LISTED[range].contains(&pitch) {
        anchor(range, pitch).step(*steps).whole()
    } else {
        even(factor * pitch_formula(d, pitch), 0)
    }
}

/// Tolerance of the crest, µm: T_d or T_D1 (M138).
///
/// # Panics
/// If the grade does not exist.
pub(crate) fn crest_tolerance(side: Side, grade: u8, pitch: f64) -> f64 {
    // T_d(8) of P = 8: 1180 where the steps give 1120.
    if (side, grade, pitch) == (Side::External, 8, 8.0) {
        return 1180.0;
    }
    let anchor = match (side, pitch) {
        (Side::External, 4.0) => 475.0,
        (Side::External, _) => 180.0 * libm::pow(pitch, 2.0 / 3.0) - 3.15 / pitch.sqrt(),
        (Side::Internal, 0.5) => 140.0,
        (Side::Internal, 1.0) => 236.0,
        (Side::Internal, 2.5) => 450.0,
        (Side::Internal, _) if pitch <= 0.8 => 433.0 * pitch - 190.0 * libm::pow(pitch, 1.22),
        (Side::Internal, _) => 230.0 * libm::pow(pitch, 0.7),
    };
    let found = CREST_GRADES[side as usize].iter().find(|(of, ..)| *of == grade);
    let (_, steps, _) = found.expect("names are checked when they are read");
    Preferred::nearest(anchor).step(*steps).whole()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cells of the tables of ISO 965-1 and DIN 13-14.
    #[test]
    fn cells_of_the_tables() {
        let td = |grade, pitch| crest_tolerance(Side::External, grade, pitch);
        assert_eq!(
            [td(4, 0.2), td(6, 0.45), td(6, 1.75), td(4, 5.5), td(8, 2.5)],
            [36.0, 100.0, 265.0, 355.0, 530.0]
        );
        let td1 = |grade, pitch| crest_tolerance(Side::Internal, grade, pitch);
        assert_eq!(
            [td1(5, 0.3), td1(7, 0.75), td1(8, 3.5), td1(4, 8.0), td1(6, 5.5)],
            [67.0, 236.0, 900.0, 630.0, 750.0]
        );
        let td2 = |grade, d, pitch| pitch_tolerance(Side::External, grade, d, pitch);
        assert_eq!([td2(3, 1.0, 0.2), td2(4, 2.0, 0.4), td2(5, 5.0, 0.8)], [24.0, 42.0, 75.0]);
        assert_eq!([td2(7, 12.0, 1.75), td2(9, 42.0, 3.0), td2(8, 200.0, 4.0)], [190.0, 400.0, 450.0]);
        let big = |grade, d, pitch| pitch_tolerance(Side::Internal, grade, d, pitch);
        assert_eq!([big(4, 1.2, 0.25), big(5, 10.0, 1.5), big(8, 64.0, 6.0)], [45.0, 140.0, 600.0]);
    }

    /// What docs/metrology.md says of a formula without the rounding of the tables.
    #[test]
    fn a_formula_alone_is_not_the_table() {
        let (mut cells, mut wrong, mut worst) = (0, 0, 0.0_f64);
        for side in [Side::External, Side::Internal] {
            for (range, pitches) in LISTED.iter().enumerate() {
                let mean = (RANGES[range] * RANGES[range + 1]).sqrt();
                for (grade, _, factor, least) in PITCH_GRADES[side as usize] {
                    for pitch in pitches.iter().filter(|pitch| *pitch >= least) {
                        let apart = pitch_tolerance(side, *grade, mean, *pitch)
                            - even(factor * pitch_formula(mean, *pitch), 0);
                        cells += 1;
                        wrong += usize::from(apart != 0.0);
                        worst = worst.max(apart.abs());
                    }
                }
            }
        }
        let said = format!("{wrong} of the {cells} tolerances of pitch diameters, by up to {worst} µm");
        assert!(include_str!("../../docs/metrology.md").contains(&said), "{said}");
    }

    /// FED-STD-H28/21B: M29x1.25-4g6h has 86.8 µm, printed as 87.
    #[test]
    fn a_pair_that_is_not_listed_takes_its_own_diameter() {
        assert_eq!(pitch_tolerance(Side::External, 4, 29.0, 1.25), 87.0);
    }
}
