//! The block that a mill cuts. In: two opposite corners, in a comment or a file. Out: [`Corners`], mm.

use super::{PartError, place};

/// The corners of a block, mm: in the coordinates of the program.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corners {
    /// Least X, Y and Z.
    pub low_mm: [f64; 3],
    /// Largest X, Y and Z.
    pub high_mm: [f64; 3],
}

impl Corners {
    /// From two opposite corners, in any order.
    pub(super) fn of(one: [f64; 3], other: [f64; 3]) -> Result<Corners, PartError> {
        for mm in one.into_iter().chain(other) {
            place("corner", mm)?;
        }
        let corners = Corners {
            low_mm: [0, 1, 2].map(|i| one[i].min(other[i])),
            high_mm: [0, 1, 2].map(|i| one[i].max(other[i])),
        };
        for (low, high) in corners.low_mm.into_iter().zip(corners.high_mm) {
            if low >= high {
                return Err(PartError::Value {
                    what: "corner",
                    value: low,
                    allowed: "it has no thickness there",
                });
            }
        }
        Ok(corners)
    }

    /// The same elsewhere along X and Y.
    #[must_use]
    pub fn moved(mut self, by_mm: [f64; 2]) -> Corners {
        for (i, by) in by_mm.into_iter().enumerate() {
            self.low_mm[i] += by;
            self.high_mm[i] += by;
        }
        self
    }
}

/// The corners of a comment: X, Y and Z of one, then of the other.
pub(super) fn said<'a>(
    words: impl Iterator<Item = &'a str>,
    unit_mm: f64,
) -> Result<[[f64; 3]; 2], PartError> {
    let mut corners = [[None; 3]; 2];
    for word in words {
        let wrong = || PartError::Word(word.into());
        let letter = word.chars().next().map(|letter| letter.to_ascii_uppercase()).ok_or_else(wrong)?;
        let number: f64 =
            word.get(letter.len_utf8()..).and_then(|text| text.parse().ok()).ok_or_else(wrong)?;
        let axis = ['X', 'Y', 'Z'].iter().position(|axis| *axis == letter).ok_or_else(wrong)?;
        let free = corners.iter_mut().map(|corner| &mut corner[axis]).find(|mm| mm.is_none());
        *free.ok_or_else(wrong)? = Some(number * unit_mm);
    }
    let [[Some(x0), Some(y0), Some(z0)], [Some(x1), Some(y1), Some(z1)]] = corners else {
        return Err(PartError::Missing("second X, Y or Z"));
    };
    Ok([[x0, y0, z0], [x1, y1, z1]])
}
