//! What is asked of the feed: by the program, by the operator, by the spindle. In: feeds in mm/s or mm per
//! revolution, overrides. Out: which of two feeds is lower, and how high one may become, mm/s.

/// Highest multiple of a programmed feed that overrides can ask for.
pub const MOST_RATIO: f64 = 2.0;
/// Slowest feed, mm/s: a millimetre in a quarter of an hour. No override but 0 makes one slower; a spindle
/// that asks for less stops the feed.
pub const LEAST_FEED: f64 = 1e-3;

/// Feed of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Feed {
    /// As fast as the axes may go.
    Rapid,
    /// mm/s.
    PerSecond(f64),
    /// mm per revolution of the spindle, and the highest mm/s that this may ever be.
    PerRevolution(f64, f64),
}

/// What the operator and the spindle make of programmed feeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratios {
    /// Rapid override, 0 to 1.
    pub rapid: f64,
    /// Feed override, 0 to 2.
    pub feed: f64,
    /// Revolutions of the spindle per second, times the feed override.
    pub turns: f64,
}

impl Feed {
    /// Whether overrides act alike.
    pub(super) fn same_kind(self, other: Feed) -> bool {
        core::mem::discriminant(&self) == core::mem::discriminant(&other)
    }

    /// The lower of two feeds of a kind.
    pub(super) fn lower(self, other: Feed) -> Feed {
        match (self, other) {
            (Feed::PerSecond(a), Feed::PerSecond(b)) => Feed::PerSecond(a.min(b)),
            (Feed::PerRevolution(a, top), Feed::PerRevolution(b, other)) => {
                Feed::PerRevolution(a.min(b), top.min(other))
            }
            _ => self,
        }
    }

    /// The highest feed that can ever be asked for, mm/s.
    pub(super) fn highest(self) -> f64 {
        match self {
            Feed::Rapid => f64::INFINITY,
            Feed::PerSecond(feed) => MOST_RATIO * feed,
            Feed::PerRevolution(_, top) => top,
        }
        .max(LEAST_FEED)
    }
}

impl Ratios {
    /// Overrides at 100 per cent and a spindle that makes so many turns in a second.
    #[must_use]
    pub fn full(turns: f64) -> Ratios {
        Ratios { rapid: 1.0, feed: 1.0, turns }
    }
}
