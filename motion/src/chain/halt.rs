//! Where a stop is faster than a rounded corner. In: two blocks and the blend that their corner may have.
//! Out: a verdict, from these two blocks and the limits of the axes alone.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | r | mm | half the width of the blend, as far as the tolerance and the shorter line allow |
//! | v | mm/s | the speed at which it is passed (M66), whichever way round |
//! | l | mm | half of a block; of a piece, twice its length |
//! | F | mm/s | the feed at its middle: the programmed one, or what the way from there allows |
//! | τ | s | how long the laws around the stop overlap as far as the tolerance goes (M194), half of a block being clear |
//! | T(e), d(a, b) | s, mm | duration of the fastest ramp by e (M21), way of that between two feeds (M22) |
//!
//! ```text
//! t(v, r) = T(F − v) + (l − r − d(v, F))/F + r/v,  F = reach(v) on l − r                  from middle to tip
//! stop, if Σ of both sides  t(v, r) > Σ of both sides  t(0, 0) − τ                                 (M183)
//! ```
//! r/v grows with r^¼ where the jerk rate bounds v, and what the ramp saves with v ∝ r^¾: once rounding is
//! faster, a larger tolerance only makes it more so, τ being a matter of milliseconds. A curve has at least
//! four pieces as long as that at its end.

use super::overlap::Tip;
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
/// with a stop, at which the axes may be `spare` mm off the contour.
pub(super) fn stop_is_faster<const N: usize, T>(
    blocks: [&Block<N, T>; 2],
    blend: &Blend<N>,
    turn: f64,
    spare: f64,
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
    let rounded = blocks.iter().map(|block| half_a_block(block, v, blend.half(), axes).0).sum::<f64>();
    let [(last, down), (next, up)] = blocks.map(|block| half_a_block(block, 0.0, 0.0, axes));
    let stopped = last + next;
    if rounded > stopped || rounded < stopped - down.jerk_interval() {
        return rounded > stopped;
    }
    let clear = blocks.map(|block| 0.5 * block.path.length());
    let tip = Tip::between(blocks.map(|block| &block.path), spare, clear);
    rounded > stopped - tip.most([&down, &up])
}

/// Time from the middle of a block to its end, the last `way` mm of it at the speed `v`, s; the ramp to that.
fn half_a_block<const N: usize, T>(block: &Block<N, T>, v: f64, way: f64, axes: &[Limits; N]) -> (f64, Ramp) {
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
    let ramp = Ramp::fastest(feed - v, &limits);
    let even = (length - way - 0.5 * (feed + v) * ramp.duration()).max(0.0);
    let crawl = if way > 0.0 { way / v } else { 0.0 };
    (ramp.duration() + even / feed + crawl, ramp)
}
