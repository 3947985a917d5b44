//! Where a stop is faster than a rounded corner. In: two blocks and the blend that their corner may have.
//! Out: a verdict, from these two blocks and the limits of the axes alone.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | r | mm | half the width of the blend, as far as the tolerance and the shorter line allow |
//! | v | mm/s | the speed at which it is passed (M66), whichever way round |
//! | l | mm | half of a block; of a piece, twice its length |
//! | F | mm/s | the feed at its middle: the programmed one, or what the way from there allows |
//! | T(e), d(a, b) | s, mm | duration of the fastest ramp by e (M21), way of that between two feeds (M22) |
//!
//! ```text
//! t(v, r) = T(F − v) + (l − r − d(v, F))/F + r/v,  F = reach(v) on l − r                  from middle to tip
//! stop, if Σ of both sides  t(v, r) > Σ of both sides  t(0, 0)                                     (M183)
//! ```
//! r/v grows with r^¼ where the jerk rate bounds v, and what the ramp saves with v ∝ r^¾: once rounding is
//! faster, a larger tolerance only makes it more so. A stop leaves the tip where it is programmed, so no
//! tolerance is at stake. A curve has at least four pieces as long as that at its end.

use super::zone::Bend;
use super::{Block, Feed};
use crate::blend::Blend;
use crate::limits::Limits;
use crate::path::tightest;
use crate::ramp::Ramp;
use crate::reach::reach;

/// Corners whose jump of p₁ is less are rounded unasked: 6°. A contour has many, and a stop hardly ever pays.
const LEAST_TURN: f64 = 0.1;
/// A curve is so many times as long as the piece at its end, at least.
const PIECES: f64 = 4.0;

/// Whether the corner of two blocks, whose directions are `turn` apart, takes longer with this blend than
/// with a stop.
pub(super) fn stop_is_faster<const N: usize, T>(
    blocks: [&Block<N, T>; 2],
    blend: &Blend<N>,
    turn: f64,
    axes: &[Limits; N],
) -> bool {
    if turn < LEAST_TURN {
        return false;
    }
    let top = |here: usize, there: usize| {
        let bend = Bend::of(&blocks[here].path).with(blend, &blocks[there].path.shares());
        bend.top(axes, f64::INFINITY, f64::INFINITY)
    };
    let v = top(0, 1).min(top(1, 0));
    let [rounded, stopped] = [v, 0.0].map(|v| {
        let way = if v > 0.0 { blend.half() } else { 0.0 };
        blocks.iter().map(|block| half_a_block(block, v, way, axes)).sum::<f64>()
    });
    rounded > stopped
}

/// Time from the middle of a block to its end, the last `way` mm of it at the speed `v`.
fn half_a_block<const N: usize, T>(block: &Block<N, T>, v: f64, way: f64, axes: &[Limits; N]) -> f64 {
    let shares = block.path.shares();
    let limits = tightest(axes, |i| shares[i]);
    let programmed = match block.feed {
        Feed::Rapid => limits.v,
        Feed::PerSecond(feed) | Feed::PerRevolution(_, feed) => feed.min(limits.v),
    };
    let pieces = if block.path.is_piece() { PIECES } else { 1.0 };
    let length = 0.5 * pieces * block.path.length();
    let (way, v) = (way.min(length), v.min(programmed));
    let feed = reach(v, programmed, length - way, &limits);
    let ramp = Ramp::shortest(feed - v, &limits);
    let even = (length - way - 0.5 * (feed + v) * ramp).max(0.0);
    let crawl = if way > 0.0 { way / v } else { 0.0 };
    ramp + even / feed + crawl
}
