//! Fundamental deviations of metric threads, ISO 965-1: how far the zone of a tolerance position lies from
//! the basic profile. In: pitch in mm, position. Out: µm, 0 or more: down for a screw, up for a nut.
//!
//! They follow 50 + 11 P (e), 30 + 11 P (f) and 15 + 11 P (g, G) with a rounding of their own, so the table
//! of the standard is here. Positions a, b, c and d, and those of coated threads, are not.

/// Pitch in mm and |es| of e, f, g in µm; g is also EI of G. ISO 965-1, table of fundamental deviations; as
/// transcribed in two public programs, which agree.
const TABLE: [(f64, [f64; 3]); 25] = [
    (0.2, [45.0, 32.0, 17.0]),
    (0.25, [45.0, 33.0, 18.0]),
    (0.3, [46.0, 33.0, 18.0]),
    (0.35, [46.0, 34.0, 19.0]),
    (0.4, [48.0, 34.0, 19.0]),
    (0.45, [48.0, 35.0, 20.0]),
    (0.5, [50.0, 36.0, 20.0]),
    (0.6, [53.0, 36.0, 21.0]),
    (0.7, [56.0, 38.0, 22.0]),
    (0.75, [56.0, 38.0, 22.0]),
    (0.8, [60.0, 38.0, 24.0]),
    (1.0, [60.0, 40.0, 26.0]),
    (1.25, [63.0, 42.0, 28.0]),
    (1.5, [67.0, 45.0, 32.0]),
    (1.75, [71.0, 48.0, 34.0]),
    (2.0, [71.0, 52.0, 38.0]),
    (2.5, [80.0, 58.0, 42.0]),
    (3.0, [85.0, 63.0, 48.0]),
    (3.5, [90.0, 70.0, 53.0]),
    (4.0, [95.0, 75.0, 60.0]),
    (4.5, [100.0, 80.0, 63.0]),
    (5.0, [106.0, 85.0, 71.0]),
    (5.5, [112.0, 90.0, 75.0]),
    (6.0, [118.0, 95.0, 80.0]),
    (8.0, [140.0, 118.0, 100.0]),
];

/// A tolerance position; of a nut only the last two, in capitals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Position {
    E,
    F,
    G,
    H,
}

impl Position {
    /// From its letter in lower case.
    pub(crate) fn of(letter: char) -> Option<Position> {
        match letter {
            'e' => Some(Position::E),
            'f' => Some(Position::F),
            'g' => Some(Position::G),
            'h' => Some(Position::H),
            _ => None,
        }
    }

    /// Its letter in lower case.
    pub(crate) fn letter(self) -> char {
        match self {
            Position::E => 'e',
            Position::F => 'f',
            Position::G => 'g',
            Position::H => 'h',
        }
    }

    /// Its deviation, µm.
    ///
    /// # Panics
    /// If the pitch is none of [`pitches`].
    pub(crate) fn deviation(self, pitch: f64) -> f64 {
        let row = TABLE.iter().find(|(at, _)| *at == pitch).expect("names are checked when they are read");
        let [e, f, g] = row.1;
        match self {
            Position::E => e,
            Position::F => f,
            Position::G => g,
            Position::H => 0.0,
        }
    }
}

/// Pitches of ISO 261 that have tolerances, mm.
pub(crate) fn pitches() -> impl Iterator<Item = f64> {
    TABLE.iter().map(|(pitch, _)| *pitch)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The formulas of the standard, to what its rounding makes of them.
    #[test]
    fn the_table_lies_about_its_formulas() {
        for (pitch, row) in TABLE.iter().filter(|(pitch, _)| (1.0..8.0).contains(pitch)) {
            for (at, base) in row.iter().zip([50.0, 30.0, 15.0]) {
                let formula = base + 11.0 * pitch;
                assert!((at - formula).abs() <= 2.6, "P {pitch}: {at} and {formula}");
            }
        }
    }
}
