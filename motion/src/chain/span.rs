//! How many sections the next law passes. In: a speed without acceleration, the sections ahead with their
//! exits. Out: a law that ends without acceleration at the end of one of them.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | v | mm/s | the speed at the start of section 1 |
//! | e(m) | mm/s | the exit of section m: the highest speed from which all ahead can be kept (M196) |
//! | t(m), u | s, mm/s | time of the fastest law over sections 1 … m as one, and the speed at its end, e(m) at most |
//! | t₁(i) | s | time of the fastest law over section i alone, from e(i − 1) to e(i); from v for the first |
//! | d(u, e) | mm | way of the fastest ramp (M22) |
//!
//! ```text
//! m that makes  t(m) − Σ t₁(i) + d(u, e) (e − u)/e(e + u)  least,  i = 1 … m,  m ≤ 12              (M197)
//! ```
//! Sections as one have the lowest limits of all of them. So a law over many is slower where one of them is
//! much tighter than the others, a law over few where they are too short for its ramps. The sum is the time
//! of a machine that is as fast as it may be at each border, and so the same measure for every m; the last
//! term is what a ramp from u to e takes longer than e itself. Whichever m is taken, the law keeps every
//! limit: the choice is one of time alone.

use super::ahead::MOST_CROSSED;
use super::allowance::Allowance;
use super::law::{Law, Promise};
use super::section::Section;
use super::{Ask, Chain, SAME};
use crate::feed::FeedBlock;
use crate::limits::Limits;
use crate::reach::reach;
use crate::search;

/// How many sections a law passes, and the law.
pub(super) type Span = (usize, FeedBlock);

/// Times that differ by less are one, s.
const SAME_S: f64 = 1e-9;
/// Relative excess over a hard exit that rounding may leave, when a law is replaced just where it was to
/// brake.
const ROUNDED: f64 = 1e-8;

impl<const N: usize, T: Copy> Chain<N, T> {
    /// The law that follows from the speed `v`, `gone` mm behind the start of section `k`; `None` if none
    /// keeps its limits.
    pub(super) fn plan(&self, k: usize, v: f64, ask: &Ask, gone: f64) -> Option<Span> {
        let cap = |section: &Section| if ask.hold { 0.0 } else { section.cap(&self.ratios) };
        let over = |(n, section): (usize, Section)| {
            Some((n + 1, self.block(&section, v, cap(&section), ask.single, gone)?))
        };
        let joined = || self.sections.from(k, gone, v, &self.ratios).enumerate();
        let best = self.best(k, v, cap, gone);
        joined().nth(best).and_then(over).or_else(|| joined().find_map(over))
    }

    /// m − 1 of (M197).
    fn best(&self, k: usize, v: f64, cap: impl Fn(&Section) -> f64, gone: f64) -> usize {
        let (mut best, mut least, mut alone, mut before) = (0, f64::INFINITY, 0.0, v);
        for (n, joined) in self.sections.from(k, gone, v, &self.ratios).enumerate() {
            let (Some(own), next) = (self.sections.get(k + n), self.sections.get(k + n + 1)) else { break };
            // At the end of what is known the machine need not stop: more may follow.
            if n > 0 && next.is_none() && !self.closed {
                break;
            }
            let (cap, exit, limits) = (cap(&joined), own.exit_soft, &joined.limits);
            if cap <= 0.0 || n > 0 && v > cap * (1.0 + SAME) {
                break;
            }
            let length = if n == 0 { joined.length } else { own.length };
            let one = own.limits.time(length, [before, own.cap(&self.ratios), exit]);
            alone += one.unwrap_or(2.0 * length / (before + exit));
            before = exit;
            let most = exit.min(cap);
            let end = if most > v { limits.reach(v, most, joined.length) } else { most };
            let Some(time) = limits.time(joined.length, [v, cap, end]) else { continue };
            let late = if end < exit {
                next.map_or(limits, |next| &next.limits).way(end, exit) * (exit - end) / (exit * (exit + end))
            } else {
                0.0
            };
            if time - alone + late < least - SAME_S {
                (best, least) = (n, time - alone + late);
            }
            if n == 0 && v.min(end) >= cap * (1.0 - SAME_S) {
                break;
            }
        }
        best
    }

    /// The law to the end of a section, or of several as one, from the speed `v`, `gone` mm behind the start
    /// of the law in hand.
    fn block(&self, front: &Section, v: f64, cap: f64, single: bool, gone: f64) -> Option<FeedBlock> {
        let limits = &front.limits;
        let (mut length, mut exit) = (front.length, front.exit_soft);
        if single {
            let stopping = limits.way(v, 0.0);
            let way = self.block_end(gone, stopping);
            if way < length + SAME {
                if stopping <= way {
                    (length, exit) = (way.min(length), 0.0);
                }
            } else {
                exit = exit.min(reach(0.0, exit, way - length, &self.tightest(gone + way, exit)));
            }
        }
        let plan = |exit: f64| limits.block(length, [v, cap.max(v).max(exit), exit], self.settings.cycle_s);
        let (block, limits) =
            plan(exit).or_else(|| plan(nearest_exit(v, exit, front.exit_hard, length, limits)))?;
        let [end, way] = [block.end_feed(), block.length()];
        let promise = Promise { start: v, acceleration: 0.0, end, way, limits };
        Law::Block(block).keeps(&promise).then_some(block)
    }

    /// Way to the first end of a block that is at least `least` mm ahead, `gone` mm behind the start of the
    /// law in hand, mm.
    fn block_end(&self, gone: f64, least: f64) -> f64 {
        let mut way = -self.along - gone;
        for piece in self.pieces.ahead() {
            way += piece.length();
            if way > SAME && way >= least {
                break;
            }
        }
        way
    }

    /// The tightest limits on the next `way` mm up to a speed.
    fn tightest(&self, way: f64, v: f64) -> Limits {
        let (mut limits, mut gone) = (Limits::NONE, 0.0);
        for section in (0..MOST_CROSSED).map_while(|k| self.sections.get(k)) {
            limits = limits.min(&section.limits.up_to(v));
            gone += section.length;
            if gone >= way {
                break;
            }
        }
        limits
    }
}

/// The exit nearest to `exit` that a way of `length` allows, at most `hard` when it brakes.
///
/// A ramp down to a little less takes a longer way than one down to much less: (F − e/2) T(e) rises with e,
/// then falls. Where no exit between the speed and the hard one can be reached, one below it can.
fn nearest_exit(v: f64, exit: f64, hard: f64, length: f64, limits: &Allowance) -> f64 {
    if exit > v {
        return limits.reach(v, exit, length);
    }
    // The override fell too late for the feed of the next section: as slow as can be.
    let above = v - search::largest(v - exit, length, |e| limits.way(v - e, v));
    if above <= hard * (1.0 + ROUNDED) {
        return above;
    }
    search::largest(hard.min(v), length, |exit| limits.way(exit, v))
}
