//! The units of the wire: cycles, positions, axes.

use serde::{Deserialize, Serialize};
use zerocopy::{FromBytes, Immutable, IntoBytes};

/// A control cycle, counted from the start of the machine. Time exists in no other form inside a module.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Serialize,
    Deserialize,
    IntoBytes,
    FromBytes,
    Immutable,
)]
#[repr(C)]
pub struct Cycle(pub u64);

impl Cycle {
    /// Whether a message of this cycle follows one of the cycle `last`: it is newer, and at most so many
    /// cycles ahead, or the one before it was as far ahead (`ahead` remembers it). One flipped bit of a cycle
    /// makes nobody wait for the cycle that it shows; a gap is believed when the second message says so.
    ///
    /// ```
    /// use protocol::Cycle;
    /// let mut ahead = None;
    /// let mut follows = |cycle, last| Cycle(cycle).follows(Cycle(last), 8, &mut ahead);
    /// assert!(follows(101, 100) && !follows(101, 101) && follows(109, 101));
    /// assert!(!follows(5000, 109) && follows(110, 109)); // a damaged one
    /// assert!(!follows(5000, 110) && follows(5001, 110)); // a gap
    /// ```
    pub fn follows(self, last: Cycle, most: u64, ahead: &mut Option<Cycle>) -> bool {
        if self <= last {
            return false;
        }
        let confirmed = ahead.is_some_and(|ahead| self > ahead && self <= ahead.after(most));
        let follows = self <= last.after(most) || confirmed;
        *ahead = if follows { None } else { Some(self) };
        follows
    }

    /// The cycle `n` cycles later, or the last one that has a number: a damaged message may name that one.
    ///
    /// ```
    /// use protocol::Cycle;
    /// assert_eq!((Cycle(7).after(3), Cycle(u64::MAX - 1).after(3)), (Cycle(10), Cycle(u64::MAX)));
    /// ```
    pub fn after(self, n: u64) -> Cycle {
        Cycle(self.0.saturating_add(n))
    }
}

/// A position of an axis: a signed count of 1e-9 mm, of 1e-9 degrees for a rotary axis. Integers cannot
/// drift, and this quantum is what jerk at 2.5 kHz needs (M31–M35). X of a lathe is a radius.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Serialize,
    Deserialize,
    IntoBytes,
    FromBytes,
    Immutable,
)]
#[repr(C)]
pub struct Position(pub i64);

impl Position {
    /// Counts in one millimetre.
    pub const PER_MM: f64 = 1e9;

    /// Nearest count to a position in mm. Saturates beyond ±9.2e9 mm; NaN gives 0.
    pub fn from_mm(mm: f64) -> Position {
        Position((mm * Self::PER_MM).round() as i64)
    }

    /// The position in mm.
    pub fn mm(self) -> f64 {
        self.0 as f64 / Self::PER_MM
    }

    /// The position `mm` further, to the nearest count; saturates.
    pub fn moved(self, mm: f64) -> Position {
        Position(self.0.saturating_add(Position::from_mm(mm).0))
    }

    /// `self - origin` in mm, exact however far both are from zero.
    pub fn mm_from(self, origin: Position) -> f64 {
        let apart = match self.0.checked_sub(origin.0) {
            Some(apart) => apart as f64,
            None => (i128::from(self.0) - i128::from(origin.0)) as f64,
        };
        apart / Self::PER_MM
    }
}

/// How many axes a message has room for.
pub const AXES: usize = 8;

/// One value for each axis a machine can have; which exist is said by the machine file.
pub type PerAxis<T> = [T; AXES];

/// An axis of the machine, an index into [`PerAxis`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[repr(u8)]
#[allow(missing_docs)]
pub enum Axis {
    X,
    Y,
    Z,
    A,
    B,
    C,
    U,
    V,
}

impl Axis {
    /// Every axis in the order of the wire.
    pub const ALL: PerAxis<Axis> = [Axis::X, Axis::Y, Axis::Z, Axis::A, Axis::B, Axis::C, Axis::U, Axis::V];

    /// Which axes make the length of a path, and so its feed: the linear ones. Where only rotary axes move,
    /// they do.
    ///
    /// ```
    /// use protocol::Axis;
    /// assert_eq!(Axis::METRIC, Axis::ALL.map(|axis| !axis.is_rotary()));
    /// ```
    pub const METRIC: PerAxis<bool> = [true, true, true, false, false, false, true, true];

    /// Index into [`PerAxis`].
    pub fn index(self) -> usize {
        self as usize
    }

    /// The lower-case letter, as machine files and channel names spell it.
    pub fn name(self) -> &'static str {
        ["x", "y", "z", "a", "b", "c", "u", "v"][self.index()]
    }

    /// Whether the axis turns: positions in degrees, not in mm.
    pub fn is_rotary(self) -> bool {
        matches!(self, Axis::A | Axis::B | Axis::C)
    }

    /// The unit of its positions.
    pub fn unit(self) -> &'static str {
        if self.is_rotary() { "deg" } else { "mm" }
    }

    /// The axis of a letter in either case.
    pub fn from_name(name: &str) -> Option<Axis> {
        Axis::ALL.into_iter().find(|axis| axis.name().eq_ignore_ascii_case(name))
    }
}

impl std::fmt::Display for Axis {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.name().to_ascii_uppercase())
    }
}
