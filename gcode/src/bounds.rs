//! The most that a word may ask for. What a user can set is in [`Limits`](crate::Limits).

/// Largest number of an N or O word.
pub(crate) const LAST_NUMBER: u32 = 99_999_999;
/// Passes of a cycle, spring passes not counted.
pub(crate) const MOST_PASSES: f64 = 10_000.0;
/// Spring passes of a threading cycle.
pub(crate) const MOST_SPRINGS: i64 = 1000;
/// Pecks and columns of a grooving cycle.
pub(crate) const MOST_PECKS: f64 = 100_000.0;
/// Blocks of a contour.
pub(crate) const MOST_BLOCKS: u32 = 10_000;
/// Highest speed of the spindle at constant surface speed where none is given, 1/min.
pub(crate) const NO_HIGHEST_SPEED: f64 = 1e30;
