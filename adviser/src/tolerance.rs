//! Standard tolerances of lengths, ISO 286-1: how far a size of a part may vary in a grade. In: grade IT01 …
//! IT18, nominal size in mm. Out: tolerance in µm. Source: ISO 286-1:2010, table 1. The numbers are those of
//! the standard; the formulas they were rounded from (annex A of the edition of 1988) check them in a test.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | D | mm | geometric mean of the ends of a step of sizes; of the first step (1 · 3)^½ |
//! | i, I | µm | tolerance unit up to 500 mm, and above |
//!
//! ```text
//! i = 0.45 D^⅓ + 0.001 D,  I = 0.004 D + 2.1;   IT5 … IT18 = (7, 10, 16, 25, 40, 64, 100 … 2500) × i or I
//! up to 500 mm: IT01 = 0.3 + 0.008 D,  IT0 = 0.5 + 0.012 D,  IT1 = 0.8 + 0.020 D,
//!     IT2 … IT4 between IT1 and IT5
//! above: IT1 … IT4 = (2, 2.7, 3.7, 5) × I                                                              (M94)
//! ```

use std::fmt;

/// Sizes above the last step of the table have no standard tolerance, mm.
pub const LARGEST_MM: f64 = 3150.0;
/// IT01 and IT0 end here, mm.
const FINEST_UP_TO_MM: f64 = 500.0;
/// IT14 and coarser begin above this, mm.
const COARSE_ABOVE_MM: f64 = 1.0;
const GRADES: usize = 20;
/// In the table: the grade is not defined for the size.
const NONE: f64 = f64::NAN;

/// Upper end of a step of sizes in mm, which still belongs to it, and the tolerances of IT01 … IT18 in µm.
#[rustfmt::skip]
const STEPS: [(f64, [f64; GRADES]); 21] = [
    (3.0, [0.3, 0.5, 0.8, 1.2, 2.0, 3.0, 4.0, 6.0, 10.0, 14.0, 25.0, 40.0, 60.0, 100.0, 140.0, 250.0, 400.0, 600.0, 1000.0, 1400.0]),
    (6.0, [0.4, 0.6, 1.0, 1.5, 2.5, 4.0, 5.0, 8.0, 12.0, 18.0, 30.0, 48.0, 75.0, 120.0, 180.0, 300.0, 480.0, 750.0, 1200.0, 1800.0]),
    (10.0, [0.4, 0.6, 1.0, 1.5, 2.5, 4.0, 6.0, 9.0, 15.0, 22.0, 36.0, 58.0, 90.0, 150.0, 220.0, 360.0, 580.0, 900.0, 1500.0, 2200.0]),
    (18.0, [0.5, 0.8, 1.2, 2.0, 3.0, 5.0, 8.0, 11.0, 18.0, 27.0, 43.0, 70.0, 110.0, 180.0, 270.0, 430.0, 700.0, 1100.0, 1800.0, 2700.0]),
    (30.0, [0.6, 1.0, 1.5, 2.5, 4.0, 6.0, 9.0, 13.0, 21.0, 33.0, 52.0, 84.0, 130.0, 210.0, 330.0, 520.0, 840.0, 1300.0, 2100.0, 3300.0]),
    (50.0, [0.6, 1.0, 1.5, 2.5, 4.0, 7.0, 11.0, 16.0, 25.0, 39.0, 62.0, 100.0, 160.0, 250.0, 390.0, 620.0, 1000.0, 1600.0, 2500.0, 3900.0]),
    (80.0, [0.8, 1.2, 2.0, 3.0, 5.0, 8.0, 13.0, 19.0, 30.0, 46.0, 74.0, 120.0, 190.0, 300.0, 460.0, 740.0, 1200.0, 1900.0, 3000.0, 4600.0]),
    (120.0, [1.0, 1.5, 2.5, 4.0, 6.0, 10.0, 15.0, 22.0, 35.0, 54.0, 87.0, 140.0, 220.0, 350.0, 540.0, 870.0, 1400.0, 2200.0, 3500.0, 5400.0]),
    (180.0, [1.2, 2.0, 3.5, 5.0, 8.0, 12.0, 18.0, 25.0, 40.0, 63.0, 100.0, 160.0, 250.0, 400.0, 630.0, 1000.0, 1600.0, 2500.0, 4000.0, 6300.0]),
    (250.0, [2.0, 3.0, 4.5, 7.0, 10.0, 14.0, 20.0, 29.0, 46.0, 72.0, 115.0, 185.0, 290.0, 460.0, 720.0, 1150.0, 1850.0, 2900.0, 4600.0, 7200.0]),
    (315.0, [2.5, 4.0, 6.0, 8.0, 12.0, 16.0, 23.0, 32.0, 52.0, 81.0, 130.0, 210.0, 320.0, 520.0, 810.0, 1300.0, 2100.0, 3200.0, 5200.0, 8100.0]),
    (400.0, [3.0, 5.0, 7.0, 9.0, 13.0, 18.0, 25.0, 36.0, 57.0, 89.0, 140.0, 230.0, 360.0, 570.0, 890.0, 1400.0, 2300.0, 3600.0, 5700.0, 8900.0]),
    (500.0, [4.0, 6.0, 8.0, 10.0, 15.0, 20.0, 27.0, 40.0, 63.0, 97.0, 155.0, 250.0, 400.0, 630.0, 970.0, 1550.0, 2500.0, 4000.0, 6300.0, 9700.0]),
    (630.0, [NONE, NONE, 9.0, 11.0, 16.0, 22.0, 32.0, 44.0, 70.0, 110.0, 175.0, 280.0, 440.0, 700.0, 1100.0, 1750.0, 2800.0, 4400.0, 7000.0, 11_000.0]),
    (800.0, [NONE, NONE, 10.0, 13.0, 18.0, 25.0, 36.0, 50.0, 80.0, 125.0, 200.0, 320.0, 500.0, 800.0, 1250.0, 2000.0, 3200.0, 5000.0, 8000.0, 12_500.0]),
    (1000.0, [NONE, NONE, 11.0, 15.0, 21.0, 28.0, 40.0, 56.0, 90.0, 140.0, 230.0, 360.0, 560.0, 900.0, 1400.0, 2300.0, 3600.0, 5600.0, 9000.0, 14_000.0]),
    (1250.0, [NONE, NONE, 13.0, 18.0, 24.0, 33.0, 47.0, 66.0, 105.0, 165.0, 260.0, 420.0, 660.0, 1050.0, 1650.0, 2600.0, 4200.0, 6600.0, 10_500.0, 16_500.0]),
    (1600.0, [NONE, NONE, 15.0, 21.0, 29.0, 39.0, 55.0, 78.0, 125.0, 195.0, 310.0, 500.0, 780.0, 1250.0, 1950.0, 3100.0, 5000.0, 7800.0, 12_500.0, 19_500.0]),
    (2000.0, [NONE, NONE, 18.0, 25.0, 35.0, 46.0, 65.0, 92.0, 150.0, 230.0, 370.0, 600.0, 920.0, 1500.0, 2300.0, 3700.0, 6000.0, 9200.0, 15_000.0, 23_000.0]),
    (2500.0, [NONE, NONE, 22.0, 30.0, 41.0, 55.0, 78.0, 110.0, 175.0, 280.0, 440.0, 700.0, 1100.0, 1750.0, 2800.0, 4400.0, 7000.0, 11_000.0, 17_500.0, 28_000.0]),
    (3150.0, [NONE, NONE, 26.0, 36.0, 50.0, 68.0, 96.0, 135.0, 210.0, 330.0, 540.0, 860.0, 1350.0, 2100.0, 3300.0, 5400.0, 8600.0, 13_500.0, 21_000.0, 33_000.0]),
];

/// A standard tolerance grade, finest first.
///
/// ```
/// use adviser::tolerance::Grade;
/// let grade: Grade = "IT7".parse()?;
/// assert_eq!(grade.tolerance_um(50.0)?, 25.0);
/// # Ok::<(), adviser::tolerance::ToleranceError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Grade(u8);

/// Why there is no such tolerance.
#[derive(Clone, Debug, PartialEq)]
pub enum ToleranceError {
    /// No grade of the standard; its text.
    Grade(String),
    /// No size of the standard, mm.
    Size(f64),
    /// The standard leaves this grade out for this size, mm.
    NotForSize(Grade, f64),
}

impl Grade {
    /// Every grade, finest first.
    pub fn all() -> impl Iterator<Item = Grade> {
        (0..GRADES as u8).map(Grade)
    }

    /// The tolerance of a nominal size in mm, µm. A size between two steps belongs to the lower one.
    ///
    /// # Errors
    /// [`ToleranceError`] for a size that is not above 0 and up to 3150 mm, IT01 and IT0 above 500 mm, and
    /// IT14 or coarser up to 1 mm.
    pub fn tolerance_um(self, size_mm: f64) -> Result<f64, ToleranceError> {
        let step = STEPS.iter().find(|(up_to, _)| size_mm > 0.0 && size_mm <= *up_to);
        let (_, row) = step.ok_or(ToleranceError::Size(size_mm))?;
        let found = row.get(usize::from(self.0)).copied().filter(|um| um.is_finite());
        let coarse = self.number() >= 14 && size_mm <= COARSE_ABOVE_MM;
        found.filter(|_| !coarse).ok_or(ToleranceError::NotForSize(self, size_mm))
    }

    /// The finest grade whose tolerance of a size in mm is at least `tolerance_um`; none if there is none.
    #[must_use]
    pub fn not_finer_than(tolerance_um: f64, size_mm: f64) -> Option<Grade> {
        Grade::all().find(|grade| grade.tolerance_um(size_mm).is_ok_and(|um| um >= tolerance_um))
    }

    /// The number in its name; −1 of IT01.
    fn number(self) -> i32 {
        i32::from(self.0) - 1
    }
}

impl fmt::Display for Grade {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.number() {
            -1 => f.write_str("IT01"),
            n => write!(f, "IT{n}"),
        }
    }
}

impl std::str::FromStr for Grade {
    type Err = ToleranceError;

    /// `IT7`, `it7` or `7`.
    fn from_str(text: &str) -> Result<Grade, ToleranceError> {
        let name = text.trim().to_ascii_uppercase();
        let name = if name.starts_with("IT") { name } else { format!("IT{name}") };
        Grade::all().find(|grade| grade.to_string() == name).ok_or_else(|| ToleranceError::Grade(text.into()))
    }
}

impl fmt::Display for ToleranceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ToleranceError::Grade(text) => {
                write!(f, "\"{text}\" is not a grade of ISO 286: write IT01, IT0, IT1 … IT18")
            }
            ToleranceError::Size(mm) => {
                write!(f, "ISO 286 has no tolerance for {mm} mm: sizes lie above 0 and up to {LARGEST_MM} mm")
            }
            ToleranceError::NotForSize(grade, mm) => {
                let sizes = if grade.number() < 1 {
                    format!("up to {FINEST_UP_TO_MM} mm: take IT1 or coarser")
                } else {
                    format!("above {COARSE_ABOVE_MM} mm: take IT13 or finer")
                };
                write!(f, "ISO 286 has no {grade} for {mm} mm, only {sizes}")
            }
        }
    }
}

impl std::error::Error for ToleranceError {}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tolerance units of IT5 … IT18.
    const UNITS: [f64; 14] =
        [7.0, 10.0, 16.0, 25.0, 40.0, 64.0, 100.0, 160.0, 250.0, 400.0, 640.0, 1000.0, 1600.0, 2500.0];

    /// What the formulas give for a row that ends at `up_to` and begins at `from` (M94).
    fn computed(from: f64, up_to: f64) -> [f64; GRADES] {
        let d = (from * up_to).sqrt();
        let mut row = [NONE; GRADES];
        let unit = if up_to <= 500.0 { 0.45 * libm::cbrt(d) + 0.001 * d } else { 0.004 * d + 2.1 };
        row[6..].copy_from_slice(&UNITS.map(|n| n * unit));
        if up_to <= 500.0 {
            row[..3].copy_from_slice(&[0.3 + 0.008 * d, 0.5 + 0.012 * d, 0.8 + 0.020 * d]);
            let ratio = libm::pow(row[6] / row[2], 0.25);
            (3..6).for_each(|n| row[n] = row[n - 1] * ratio);
        } else {
            row[2..6].copy_from_slice(&[2.0, 2.7, 3.7, 5.0].map(|n| n * unit));
        }
        row
    }

    /// The table was rounded from its formulas: IT5 and coarser by up to 6 % above 6 mm and by up to 16 %
    /// below, finer ones, which have few digits, by up to 29 %, above 500 mm by up to 6.5 %.
    #[test]
    fn the_table_is_what_its_formulas_give() {
        let from = std::iter::once(1.0).chain(STEPS.iter().map(|step| step.0));
        for (from, (up_to, row)) in from.zip(&STEPS) {
            for (n, (printed, computed)) in row.iter().zip(computed(from, *up_to)).enumerate() {
                let allowed = match (n, up_to) {
                    (_, 500.1..) => 0.065,
                    (0..6, _) => 0.29,
                    (_, ..=6.0) => 0.16,
                    _ => 0.06,
                };
                assert_eq!(printed.is_nan(), computed.is_nan());
                let off = (printed / computed - 1.0).abs();
                assert!(printed.is_nan() || off < allowed, "{}, {up_to}: {off}", Grade(n as u8));
            }
        }
    }

    /// Five grades coarser is ten times as much, from IT7 on: this finds a wrong digit that rounding would
    /// hide.
    #[test]
    fn five_grades_are_a_decade() {
        for (up_to, row) in STEPS {
            for n in 8..15 {
                assert_eq!(row[n + 5], 10.0 * row[n], "{} at {up_to}", Grade(n as u8));
            }
            assert!(row.is_sorted_by(|a, b| a < b || a.is_nan()), "{up_to}");
        }
        for pair in STEPS.windows(2) {
            let [(_, smaller), (_, larger)] = pair else { continue };
            let grows = |(small, large): (&f64, &f64)| large >= small || large.is_nan() || small.is_nan();
            assert!(smaller.iter().zip(larger).all(grows), "{pair:?}");
        }
    }

    #[test]
    fn the_end_of_a_step_belongs_to_it() {
        let um = |name: &str, mm: f64| name.parse::<Grade>().and_then(|grade| grade.tolerance_um(mm));
        assert_eq!([um("IT7", 3.0), um("7", 3.001)], [Ok(10.0), Ok(12.0)]);
        assert_eq!([um("it7", 18.0), um(" IT7 ", 50.0)], [Ok(18.0), Ok(25.0)]);
        assert_eq!([um("IT01", 500.0), um("IT18", 3150.0)], [Ok(4.0), Ok(33_000.0)]);
        assert_eq!([um("IT01", 1e-3), um("IT13", 1.0)], [Ok(0.3), Ok(140.0)]);
    }

    #[test]
    fn what_the_standard_leaves_out_is_refused() {
        let um = |name: &str, mm: f64| name.parse::<Grade>().and_then(|grade| grade.tolerance_um(mm));
        for (name, mm, words) in [
            ("IT19", 10.0, "IT01, IT0, IT1 … IT18"),
            ("IT-1", 10.0, "not a grade"),
            ("", 10.0, "not a grade"),
            ("IT7", 0.0, "above 0 and up to 3150 mm"),
            ("IT7", -4.0, "above 0"),
            ("IT7", 3150.1, "3150.1 mm"),
            ("IT7", f64::NAN, "NaN mm"),
            ("IT0", 500.1, "IT1 or coarser"),
            ("IT14", 1.0, "IT13 or finer"),
        ] {
            let said = um(name, mm).expect_err(name).to_string();
            assert!(said.contains(words), "{said}");
        }
    }

    #[test]
    fn a_tolerance_finds_its_grade() {
        let name = |um: f64, mm: f64| Grade::not_finer_than(um, mm).map(|grade| grade.to_string());
        assert_eq!(name(25.0, 50.0).as_deref(), Some("IT7"));
        assert_eq!(name(25.1, 50.0).as_deref(), Some("IT8"));
        assert_eq!(name(0.0, 50.0).as_deref(), Some("IT01"));
        assert_eq!(name(0.0, 600.0).as_deref(), Some("IT1"));
        assert_eq!([name(1e6, 50.0), name(1.0, 5000.0)], [None, None]);
    }
}
