//! Sizes of inch threads as they are written: `1/4`, `1 1/8`, `1-1/8`, `1.125`, `#10`, `No. 10`, and a bare
//! number that may be either. Out: inches.

use std::fmt;

use super::cursor::{Cursor, Misread};

/// A size of an inch thread, as it is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum InchSize {
    /// A number of the small sizes, 0 … 12: 0.060 + 0.013 N in.
    Number(u32),
    /// Whole inches and a fraction of an inch.
    Fraction {
        /// Whole inches.
        whole: u32,
        /// Above the line; 0 without a fraction.
        numerator: u32,
        /// Below the line.
        denominator: u32,
    },
    /// Inches.
    Decimal(f64),
}

/// Numbers of the small sizes, ASME B1.1, and the threads per inch of their coarse series.
const NUMBERS: [(u32, f64); 10] = [
    (0, 80.0),
    (1, 64.0),
    (2, 56.0),
    (3, 48.0),
    (4, 40.0),
    (5, 40.0),
    (6, 32.0),
    (8, 32.0),
    (10, 24.0),
    (12, 24.0),
];

impl InchSize {
    /// In inches.
    pub(crate) fn inches(self) -> f64 {
        match self {
            InchSize::Number(number) => 0.06 + 0.013 * f64::from(number),
            InchSize::Fraction { whole, numerator, denominator } => {
                f64::from(whole) + f64::from(numerator) / f64::from(denominator)
            }
            InchSize::Decimal(inches) => inches,
        }
    }

    /// The small size that a whole number may also be.
    pub(super) fn as_number(self) -> Option<InchSize> {
        match self {
            InchSize::Fraction { whole, numerator: 0, .. } => Some(whole),
            _ => None,
        }
        .filter(|whole| NUMBERS.iter().any(|(number, _)| number == whole))
        .map(InchSize::Number)
    }

    /// A whole number with at least the threads per inch of a small size is that small size: `10-32` is No.
    /// 10, `1-8` is one inch. Only unified threads have such sizes.
    pub(super) fn of_unified(self, tpi: f64) -> InchSize {
        match self {
            InchSize::Fraction { whole, numerator: 0, .. } if is_number(whole, tpi) => {
                InchSize::Number(whole)
            }
            other => other,
        }
    }

    /// Threads per inch of the coarse series of a small size, if these are fewer: without a number such a
    /// size would be one of inches.
    pub(super) fn coarser_than(self, tpi: f64) -> Option<f64> {
        let InchSize::Number(number) = self else { return None };
        NUMBERS.iter().find(|(of, _)| *of == number).map(|(_, coarse)| *coarse).filter(|coarse| tpi < *coarse)
    }
}

fn is_number(whole: u32, tpi: f64) -> bool {
    // 20, 28 and 32 threads per inch are also series of 1 in and more, but no number below 10 has so few.
    NUMBERS.iter().any(|(number, coarse)| *number == whole && tpi >= *coarse)
}

impl fmt::Display for InchSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            InchSize::Number(number) => write!(f, "{number}"),
            InchSize::Fraction { whole, numerator: 0, .. } => write!(f, "{whole}"),
            InchSize::Fraction { whole: 0, numerator, denominator } => write!(f, "{numerator}/{denominator}"),
            InchSize::Fraction { whole, numerator, denominator } => {
                write!(f, "{whole} {numerator}/{denominator}")
            }
            // With its point: a whole number without one may be that of a small size.
            InchSize::Decimal(inches) => write!(f, "{inches:?}"),
        }
    }
}

/// Reads a size.
pub(super) fn read(cursor: &mut Cursor<'_>) -> Result<InchSize, Misread> {
    let from = cursor.at();
    if cursor.word("#") || cursor.word("No.") || cursor.word("No") {
        cursor.spaces();
        let number = cursor.whole();
        let known = number.filter(|number| NUMBERS.iter().any(|(of, _)| of == number));
        let numbers: Vec<String> = NUMBERS.iter().map(|(number, _)| number.to_string()).collect();
        let refused = || {
            let help = format!("the small sizes are {}", numbers.join(", "));
            cursor.wrong(from, "there is no such number of a small size", help)
        };
        return known.map(InchSize::Number).ok_or_else(refused);
    }
    let size = fraction(cursor).or_else(|| cursor.number().map(InchSize::Decimal));
    let size = size.filter(|size| (0.05..=12.0).contains(&size.inches()));
    cursor.word("\"");
    size.ok_or_else(|| {
        let help = "write it as 1/4, 1 1/8, 1.125 or #10, between 0.05 and 12 in";
        cursor.wrong(from, "this is not the size of an inch thread", help)
    })
}

/// A whole number, a fraction, or both with a space or a hyphen between them.
fn fraction(cursor: &mut Cursor<'_>) -> Option<InchSize> {
    let start = cursor.clone();
    let first = cursor.whole().filter(|_| !matches!(cursor.peek(), Some('.' | ',')));
    let Some(first) = first else {
        *cursor = start;
        return None;
    };
    if let Some((numerator, denominator)) = below(cursor, first) {
        return Some(InchSize::Fraction { whole: 0, numerator, denominator });
    }
    let mut ahead = cursor.clone();
    let parted = ahead.one_of("-").is_some() || ahead.peek() == Some(' ') && ahead.spaces();
    let second = if parted { ahead.whole() } else { None };
    if let Some((numerator, denominator)) = second.and_then(|second| below(&mut ahead, second)) {
        *cursor = ahead;
        return Some(InchSize::Fraction { whole: first, numerator, denominator });
    }
    // No. 0 alone is no size in inches.
    Some(match first {
        0 => InchSize::Number(0),
        whole => InchSize::Fraction { whole, numerator: 0, denominator: 1 },
    })
}

/// The rest of a proper fraction whose numerator has been read.
fn below(cursor: &mut Cursor<'_>, numerator: u32) -> Option<(u32, u32)> {
    let mut ahead = cursor.clone();
    ahead.one_of("/")?;
    let denominator = ahead.whole().filter(|denominator| *denominator > numerator && numerator > 0)?;
    *cursor = ahead;
    Some((numerator, denominator))
}
