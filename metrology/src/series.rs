//! The series of ASME B1.1 that give a size its pitch: coarse (UNC), fine (UNF), extra fine (UNEF). In: size
//! in inches. Out: threads per inch.

/// A series of diameters and pitches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Series {
    /// Coarse.
    C,
    /// Fine.
    F,
    /// Extra fine.
    Ef,
    /// Constant pitch: any size.
    N,
    /// Special: any size and pitch.
    S,
}

/// Sizes in inches with their threads per inch, ASME B1.1, tables of standard series.
const COARSE: [(f64, f64); 33] = [
    (0.073, 64.0),
    (0.086, 56.0),
    (0.099, 48.0),
    (0.112, 40.0),
    (0.125, 40.0),
    (0.138, 32.0),
    (0.164, 32.0),
    (0.19, 24.0),
    (0.216, 24.0),
    (0.25, 20.0),
    (0.3125, 18.0),
    (0.375, 16.0),
    (0.4375, 14.0),
    (0.5, 13.0),
    (0.5625, 12.0),
    (0.625, 11.0),
    (0.75, 10.0),
    (0.875, 9.0),
    (1.0, 8.0),
    (1.125, 7.0),
    (1.25, 7.0),
    (1.375, 6.0),
    (1.5, 6.0),
    (1.75, 5.0),
    (2.0, 4.5),
    (2.25, 4.5),
    (2.5, 4.0),
    (2.75, 4.0),
    (3.0, 4.0),
    (3.25, 4.0),
    (3.5, 4.0),
    (3.75, 4.0),
    (4.0, 4.0),
];

const FINE: [(f64, f64); 24] = [
    (0.06, 80.0),
    (0.073, 72.0),
    (0.086, 64.0),
    (0.099, 56.0),
    (0.112, 48.0),
    (0.125, 44.0),
    (0.138, 40.0),
    (0.164, 36.0),
    (0.19, 32.0),
    (0.216, 28.0),
    (0.25, 28.0),
    (0.3125, 24.0),
    (0.375, 24.0),
    (0.4375, 20.0),
    (0.5, 20.0),
    (0.5625, 18.0),
    (0.625, 18.0),
    (0.75, 16.0),
    (0.875, 14.0),
    (1.0, 12.0),
    (1.125, 12.0),
    (1.25, 12.0),
    (1.375, 12.0),
    (1.5, 12.0),
];

/// Up to and with these sizes in inches extra fine has these threads per inch; it begins at No. 12 and goes
/// on by sixteenths.
const EXTRA_FINE: [(f64, f64); 5] = [(0.375, 32.0), (0.5, 28.0), (0.6875, 24.0), (1.0, 20.0), (1.6875, 18.0)];

/// Sizes are decimal fractions and sums; nearer than this they are the same, in.
const SAME: f64 = 1e-9;

impl Series {
    /// Series with the letters behind `UN` or `UNR`.
    pub(crate) const ALL: [(&str, Series); 5] =
        [("EF", Series::Ef), ("C", Series::C), ("F", Series::F), ("S", Series::S), ("", Series::N)];

    /// Its letters.
    pub(crate) fn letters(self) -> &'static str {
        Series::ALL.iter().find(|(_, series)| *series == self).map_or("", |(letters, _)| *letters)
    }

    /// Whether a size has one pitch in it.
    pub(crate) fn gives_the_pitch(self) -> bool {
        matches!(self, Series::C | Series::F | Series::Ef)
    }

    /// The threads per inch of a size in inches; none if it is not of the series, or has no pitch of its own.
    pub(crate) fn threads_per_inch(self, inches: f64) -> Option<f64> {
        let exact = |table: &[(f64, f64)]| {
            table.iter().find(|(size, _)| (size - inches).abs() < SAME).map(|(_, tpi)| *tpi)
        };
        match self {
            Series::C => exact(&COARSE),
            Series::F => exact(&FINE),
            Series::Ef => {
                let sixteenths = 16.0 * inches;
                let listed = (inches - 0.216).abs() < SAME
                    || inches >= 0.25 && (sixteenths - sixteenths.round()).abs() < SAME;
                let row = EXTRA_FINE.iter().find(|(up_to, _)| inches <= up_to + SAME);
                row.filter(|_| listed).map(|(_, tpi)| *tpi)
            }
            Series::N | Series::S => None,
        }
    }
}
