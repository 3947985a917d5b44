//! Feed of one block: ramp from the entry feed, cruise, ramp to the exit feed (M22–M27).
//! In: length in mm, feeds in mm/s, limits in mm/sⁿ (or m throughout). Out: samples along the block.
//! Source: as `ramp.rs`, applied to both ends of a block.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | L | mm | length of the block |
//! | F0, F, Fe | mm/s | feed at entry, programmed feed, feed at exit |
//! | Fp | mm/s | peak feed reached, at most F |
//! | T(dF) | s | duration of the fastest ramp (M21) |
//! | d(a, b) = (a + b)/2 T(\|a − b\|) | mm | way of a ramp between two feeds, in either direction (M22) |
//! | e = Fp − max(F0, Fe) | mm/s | the unknown of the search, not Fp: short blocks have e ≪ Fp |
//!
//! ```text
//! d(F0, Fe) > L            : no profile, M24
//! d(F0, F) + d(F, Fe) ≤ L  : Fp = F, cruise for the rest
//! otherwise                : d(F0, Fp) + d(Fp, Fe) = L has one root (both terms increase with Fp)    (M23)
//! ```

use crate::limits::Limits;
use crate::ramp::Ramp;
use crate::sample::Sample;
use crate::search;
use core::fmt;

/// Relative shortfall of length accepted at a junction: feeds that passed the look-ahead as just reachable
/// must pass here too, whatever the last bit of a root does. Below 1e-9 mm for a metre.
const JUNCTION_SLACK: f64 = 1e-12;

/// Profile of one block, in the fastest ramps its limits allow.
///
/// ```
/// use motion::{FeedBlock, Limits};
/// let limits = Limits { v: 500.0, a: 2000.0, j: 50_000.0, dj: 5.0e6 };
/// let block = FeedBlock::plan(100.0, 0.0, 200.0, 50.0, &limits)?;
/// assert_eq!((block.peak_feed(), block.reaches_feed()), (200.0, true));
/// assert_eq!(block.at(0.0).s, 0.0);
/// let end = block.at(block.duration());
/// assert_eq!((end.s, end.v), (100.0, 50.0));
/// # Ok::<(), motion::Unreachable>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedBlock {
    length: f64,
    f0: f64,
    f_end: f64,
    peak_feed: f64,
    reaches_feed: bool,
    accel: Ramp,
    decel: Ramp,
    cruise: f64,
    duration: f64,
}

/// Why a block has no profile (M24).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unreachable {
    /// The block is too short to accelerate to its exit feed.
    EndFeed {
        /// Highest exit feed it can reach, mm/s.
        reachable: f64,
    },
    /// The block is too short to brake to its exit feed.
    StartFeed {
        /// Highest entry feed from which it can, mm/s.
        admissible: f64,
    },
    /// The arguments describe no block.
    Input {
        /// Which argument, and what it must be.
        reason: &'static str,
    },
}

impl fmt::Display for Unreachable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Unreachable::EndFeed { reachable } => {
                write!(f, "block too short to reach its end feed; lower the end feed to {reachable}")
            }
            Unreachable::StartFeed { admissible } => {
                write!(f, "block too short to brake to its end feed; enter it with at most {admissible}")
            }
            Unreachable::Input { reason } => write!(f, "{reason}"),
        }
    }
}

impl core::error::Error for Unreachable {}

/// Shortest length joining two feeds ≥ 0, d(a, b) of M22, mm.
///
/// # Panics
/// If a limit is not positive.
#[must_use]
pub fn junction_distance(a: f64, b: f64, limits: &Limits) -> f64 {
    joining(a.min(b), (a - b).abs(), limits)
}

/// d between `low` and `low + e` (M22).
fn joining(low: f64, e: f64, limits: &Limits) -> f64 {
    (low + 0.5 * e) * Ramp::shortest(e, limits)
}

/// Highest feed up to `cap` that a block of `length` can join with the feed `from`, as its exit or as its
/// entry: ramps are reversible. Both passes of the look-ahead are this function (M24, M26). Never below
/// `from`.
///
/// The way of a small change grows as its cube root, so steeply that the rounding of the *feed* counts: the
/// result is the last feed, as a double, whose own distance fits.
///
/// # Panics
/// If a limit is not positive.
#[must_use]
pub fn reachable_feed(from: f64, cap: f64, length: f64, limits: &Limits) -> f64 {
    from + search::largest(cap - from, length, |e| junction_distance(from, from + e, limits))
}

impl FeedBlock {
    /// Profile of a block of `length` entered at `f0` and left at `f_end` with a feed of at most `f` (M23).
    /// The feed is also held within `limits.v`. All values ≥ 0, in coherent units.
    ///
    /// # Errors
    /// [`Unreachable::EndFeed`], [`Unreachable::StartFeed`] if the block is too short to join `f0` and
    /// `f_end`; [`Unreachable::Input`] if a value is negative or not finite, a limit not positive, `f` zero,
    /// or an entry or exit feed above `f` or `limits.v`.
    pub fn plan(length: f64, f0: f64, f: f64, f_end: f64, limits: &Limits) -> Result<FeedBlock, Unreachable> {
        check(length, f0, f.min(limits.v), f_end, limits)?;
        FeedBlock::fitting(length, f0, f, f_end, limits).ok_or_else(|| {
            let feed = reachable_feed(f0.min(f_end), f0.max(f_end), length, limits);
            if f_end > f0 {
                Unreachable::EndFeed { reachable: feed }
            } else {
                Unreachable::StartFeed { admissible: feed }
            }
        })
    }

    /// The same for who does not ask why there is none.
    pub(crate) fn fitting(length: f64, f0: f64, f: f64, f_end: f64, limits: &Limits) -> Option<FeedBlock> {
        let f = f.min(limits.v);
        check(length, f0, f, f_end, limits).ok()?;
        let (low, high) = (f0.min(f_end), f0.max(f_end));
        let step = high - low;
        if joining(low, step, limits) > length * (1.0 + JUNCTION_SLACK) {
            return None;
        }
        let way = |e: f64| joining(high, e, limits) + joining(low, step + e, limits);
        // Below 1e-240 the way underflows: a block without length would seem to fit a change of feed.
        let with_slope = |e: f64| {
            let (up, up_slope) = Ramp::shortest_and_slope(e, limits);
            let (down, down_slope) =
                if step == 0.0 { (up, up_slope) } else { Ramp::shortest_and_slope(step + e, limits) };
            let (first, second) = (high + 0.5 * e, low + 0.5 * (step + e));
            (first * up + second * down, 0.5 * (up + down) + first * up_slope + second * down_slope)
        };
        let e = if length > 0.0 { search::root(f - high, length, with_slope) } else { 0.0 };
        let reaches_feed = e == f - high;
        let peak_feed = if reaches_feed { f } else { high + e };
        let ramp_from = |feed: f64| Ramp::fastest(if feed == high { e } else { step + e }, limits);
        let (accel, decel) = (ramp_from(f0), ramp_from(f_end));
        // The search ends at or just below the length: the rest, at most a rounding, is cruised.
        let rest = (length - way(e)).max(0.0);
        let cruise = if rest > 0.0 { rest / peak_feed } else { 0.0 };
        let duration = accel.duration() + cruise + decel.duration();
        Some(FeedBlock { length, f0, f_end, peak_feed, reaches_feed, accel, decel, cruise, duration })
    }

    /// Sample `t` seconds after the entry: exactly 0 at entry feed for `t` ≤ 0, exactly the length at exit
    /// feed for `t` ≥ duration.
    #[must_use]
    pub fn at(&self, t: f64) -> Sample {
        if t <= 0.0 {
            return Sample::uniform(0.0, self.f0);
        }
        let left = self.duration - t;
        if left <= 0.0 {
            Sample::uniform(self.length, self.f_end)
        } else if t < self.accel.duration() {
            Sample::uniform(self.f0 * t, self.f0) + self.accel.at(t)
        } else if left < self.decel.duration() {
            (Sample::uniform(self.f_end * left, self.f_end) + self.decel.at(left)).reversed(self.length)
        } else {
            let cruised = t - self.accel.duration();
            Sample::uniform(self.accel_length() + self.peak_feed * cruised, self.peak_feed)
        }
    }

    /// The first moment at or after `t` without jerk, s.
    pub(crate) fn settled(&self, t: f64) -> f64 {
        let braking = self.duration - self.decel.duration();
        if t < self.accel.duration() {
            self.accel.settled(t)
        } else if t <= braking {
            t
        } else {
            // The ramp at the exit runs backwards; its pulses are alike.
            braking + self.decel.settled(t - braking)
        }
    }

    /// Ends of the phases, s from the start.
    pub(crate) fn ends(&self) -> [f64; 7] {
        let (up, down) = (self.accel.duration(), self.decel.duration());
        let (t1, t2) = (self.accel.jerk_interval(), self.decel.jerk_interval());
        let braking = self.duration - down;
        [t1, up - t1, up, braking, braking + t2, self.duration - t2, self.duration]
    }

    /// Total time, s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Feed at the end, mm/s.
    #[must_use]
    pub fn end_feed(&self) -> f64 {
        self.f_end
    }

    /// Length, mm.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Highest feed of the profile, mm/s.
    #[must_use]
    pub fn peak_feed(&self) -> f64 {
        self.peak_feed
    }

    /// Whether the block is long enough for its programmed feed (held within the speed limit).
    #[must_use]
    pub fn reaches_feed(&self) -> bool {
        self.reaches_feed
    }

    /// Ramp from the entry feed up to the peak feed; its `dv` is the difference.
    #[must_use]
    pub fn accel(&self) -> &Ramp {
        &self.accel
    }

    /// Ramp at the exit, run backwards: its `dv` is peak feed minus exit feed.
    #[must_use]
    pub fn decel(&self) -> &Ramp {
        &self.decel
    }

    /// Way made while accelerating, mm.
    #[must_use]
    pub fn accel_length(&self) -> f64 {
        self.f0 * self.accel.duration() + self.accel.distance()
    }

    /// Way made while braking, mm.
    #[must_use]
    pub fn decel_length(&self) -> f64 {
        self.f_end * self.decel.duration() + self.decel.distance()
    }

    /// Time at peak feed, s.
    #[must_use]
    pub fn cruise_time(&self) -> f64 {
        self.cruise
    }

    /// Largest magnitudes over the block; `v` is the peak feed.
    #[must_use]
    pub fn peak(&self) -> Limits {
        let (a, d) = (self.accel.peak(), self.decel.peak());
        Limits { v: self.peak_feed, a: a.a.max(d.a), j: a.j.max(d.j), dj: a.dj.max(d.dj) }
    }
}

/// The contract of [`FeedBlock::plan`].
fn check(length: f64, f0: f64, f: f64, f_end: f64, limits: &Limits) -> Result<(), Unreachable> {
    let usable = |x: f64| x >= 0.0 && x.is_finite();
    let rules = [
        (limits.all_positive(), "every limit must be positive"),
        (limits.j.min(limits.dj).is_finite(), "jerk or jerk rate must be bounded"),
        (usable(length), "the length must be finite and not negative"),
        (f > 0.0 && f.is_finite(), "the feed must be finite and positive"),
        (usable(f0) && f0 <= f, "the entry feed must lie between 0 and the feed and speed limit"),
        (usable(f_end) && f_end <= f, "the exit feed must lie between 0 and the feed and speed limit"),
    ];
    rules.iter().find(|(kept, _)| !kept).map_or(Ok(()), |&(_, reason)| Err(Unreachable::Input { reason }))
}
