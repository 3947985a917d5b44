//! A stretch of path with one set of limits, and which neighbours are one. In: stretches in the order of the
//! path. Out: their caps, and the speeds at which one can be entered (M24, M26).

use super::allowance::Allowance;
use super::{Feed, LEAST_FEED, MOST_RATIO, Ratios};
use crate::limits::Limits;

/// Caps that differ by less are one.
const ALIKE: f64 = 1e-3;
/// A faster stretch between slower ones is kept apart if at least this ratio of feeds is reached in it.
const WORTH: f64 = 1.2;
/// Two stretches are joined if both are shorter than this share of such a ramp, so that a law passes a dozen.
const FINE: f64 = 0.25;

/// A stretch of path with one set of limits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Section {
    /// What is left of it, mm.
    pub(super) length: f64,
    pub(super) feed: Feed,
    /// Limits of s; `v` is the highest feed the path allows.
    pub(super) limits: Allowance,
    /// Of the stretches that were joined to it, the limits at their feed that were the loosest.
    pub(super) loosest: Limits,
    /// The machine stops at its end.
    pub(super) stops: bool,
    /// Highest feed at the end: what the path allows, and what is programmed.
    pub(super) exit_hard: f64,
    pub(super) exit_soft: f64,
    /// How often something else had been asked for when they were found.
    pub(super) asked: u32,
}

impl Section {
    /// A stretch alone, before the look-ahead has seen it.
    pub(super) fn new(length: f64, feed: Feed, limits: Allowance, stops: bool) -> Section {
        let loosest = limits.up_to(feed.highest());
        Section { length, feed, limits, loosest, stops, exit_hard: 0.0, exit_soft: 0.0, asked: 0 }
    }

    /// The feed asked for, within what the path allows: an override above 0 leaves the least feed; a spindle
    /// too slow for it leaves 0.
    pub(super) fn cap(&self, ratios: &Ratios) -> f64 {
        let asked = match self.feed {
            Feed::Rapid => ratios.rapid * self.limits.v,
            Feed::PerSecond(feed) if ratios.feed > 0.0 => (ratios.feed * feed).max(LEAST_FEED),
            Feed::PerSecond(_) => 0.0,
            Feed::PerRevolution(feed, _) => ratios.turns * feed,
        };
        if asked < LEAST_FEED { 0.0 } else { asked.min(self.limits.v) }
    }

    /// The feed that an override can make of it: what is joined must not depend on one that happens to be 0.
    /// The spindle counts as long as it turns.
    fn highest(&self, ratios: &Ratios) -> f64 {
        let asked = match self.feed {
            Feed::PerRevolution(feed, _) if ratios.turns > 0.0 => MOST_RATIO * ratios.turns * feed,
            Feed::PerSecond(feed) => MOST_RATIO * feed,
            _ => f64::INFINITY,
        };
        asked.min(self.limits.v)
    }

    /// It and the next one as one.
    pub(super) fn with(&self, next: &Section) -> Section {
        Section {
            length: self.length + next.length,
            feed: self.feed.lower(next.feed),
            limits: self.limits.min(&next.limits),
            loosest: if self.loosest.a > next.loosest.a { self.loosest } else { next.loosest },
            ..*next
        }
    }

    /// The highest entry up to `top` from which the speed `exit` is reached at the end; `least` if it is not
    /// above that.
    pub(super) fn entry(&self, exit: f64, top: f64, least: f64) -> f64 {
        // One way tells whether the search can be of use.
        let may = top > least && (exit >= least || self.limits.way(exit, least) < self.length);
        if may { least.max(self.limits.reach(exit, top, self.length)) } else { least }
    }

    /// Whether one law may pass both.
    pub(super) fn goes_on(&self, next: &Section) -> bool {
        !self.stops && self.feed.same_kind(next.feed)
    }
}

/// Whether two neighbours are better one section: ramps between both feeds take a much longer way than both.
pub(super) fn joins(last: &Section, zone: &Section, ratios: &Ratios) -> bool {
    // Feeds per revolution cannot be told from each other's limits while nothing turns.
    let blind = matches!(last.feed, Feed::PerRevolution(..)) && ratios.turns <= 0.0;
    if !last.goes_on(zone) || blind && last.feed != zone.feed {
        return false;
    }
    let (a, b) = (last.highest(ratios), zone.highest(ratios));
    let (low, high) = (a.min(b), a.max(b));
    if high <= low * (1.0 + ALIKE) {
        // Alike in feed. A long stretch with room for ramps is not tied to tighter limits than its own.
        let own = [last.loosest, zone.limits.up_to(low)];
        let (tied, own) = if own[0].a > own[1].a { (last, own[0]) } else { (zone, own[1]) };
        let limits = last.limits.min(&zone.limits);
        let both = limits.up_to(low);
        let loses = own.a > 1.5 * both.a || own.j > 1.5 * both.j;
        return !loses || tied.length <= FINE * limits.way(0.0, low);
    }
    // They would lie in the faster one, within its own limits.
    let faster = if a >= b { last } else { zone };
    let ramps = FINE * faster.limits.way(low, high.min(WORTH * low));
    last.length + zone.length <= ramps
}
