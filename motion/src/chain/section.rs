//! The look-ahead: stretches of path with their limits, and the feeds at their borders (M24, M26). In:
//! stretches in the order of the path, the ratios that overrides ask for. Out: the highest feed at the end of
//! each stretch from which everything ahead can still be kept.
//!
//! At a border there is no acceleration, so a ramp lies within one section. Stretches that are short against
//! a ramp are therefore joined: the section has the lowest feed and the lowest limits of its parts, and loses
//! next to nothing because no ramp would have fitted into the part that was faster.
//!
//! Two passes run side by side. The hard one keeps what the path allows and never changes with an override;
//! it is what makes every state of the machine one from which it can stop. The soft one keeps the programmed
//! feeds, too.

use std::collections::VecDeque;

use super::allowance::Allowance;
use super::{Feed, LEAST_FEED, Ratios, SAME};
use crate::limits::Limits;

/// Most sections ahead.
pub(super) const SECTIONS: usize = 4096;
/// Caps that differ by less are one.
const ALIKE: f64 = 1e-3;
/// A faster stretch between slower ones is kept apart if at least this ratio of feeds is reached in it.
const WORTH: f64 = 1.2;
/// A faster stretch beside a rest is kept apart if a ramp in it comes to this share of the slower feed.
const REACHED: f64 = 0.5;

/// What is promised is kept with this share to spare, so that no rounding breaks it.
const SURE: f64 = 1e-9;

/// A stretch of path with one set of limits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Section {
    /// What is left of it, mm.
    pub(super) length: f64,
    pub(super) feed: Feed,
    /// Limits of s; `v` is the highest feed the path allows.
    pub(super) limits: Allowance,
    /// The machine stops at its end.
    pub(super) stops: bool,
    /// Highest feed at the end: what the path allows, and what is programmed.
    pub(super) exit_hard: f64,
    pub(super) exit_soft: f64,
    /// The highest feed of the stretches that were joined; 0 for one alone.
    pub(super) most: f64,
}

impl Section {
    /// A stretch alone, before the look-ahead has seen it.
    pub(super) fn new(length: f64, feed: Feed, limits: Allowance, stops: bool) -> Section {
        Section { length, feed, limits, stops, exit_hard: 0.0, exit_soft: 0.0, most: 0.0 }
    }

    /// The feed asked for, within what the path allows; 0 for one that is too slow to be one.
    pub(super) fn cap(&self, ratios: &Ratios) -> f64 {
        let asked = match self.feed {
            Feed::Rapid => ratios.rapid * self.limits.v,
            Feed::PerSecond(feed) => ratios.feed * feed,
            Feed::PerRevolution(feed, _) => ratios.turns * feed,
        };
        if asked < LEAST_FEED { 0.0 } else { asked.min(self.limits.v) }
    }

    /// The feed without overrides: what is joined must not depend on one that happens to be 0. The spindle
    /// counts as long as it turns.
    fn nominal(&self, ratios: &Ratios) -> f64 {
        match self.feed {
            Feed::PerSecond(feed) => feed.min(self.limits.v),
            Feed::PerRevolution(feed, _) if ratios.turns > 0.0 => (ratios.turns * feed).min(self.limits.v),
            _ => self.limits.v,
        }
    }

    /// The nominal feed of its fastest stretch.
    fn fastest(&self, ratios: &Ratios) -> f64 {
        self.most.max(self.nominal(ratios))
    }
}

/// The sections ahead; the front one is that in which the machine is.
#[derive(Clone, Debug)]
pub(super) struct Sections {
    ring: VecDeque<Section>,
    /// The machine has entered the front section: nothing is joined to it.
    entered: bool,
    /// Index of the first section whose exit may have changed.
    changed: Option<usize>,
    total: f64,
}

impl Sections {
    pub(super) fn new() -> Sections {
        Sections { ring: VecDeque::new(), entered: false, changed: None, total: 0.0 }
    }

    /// Takes the memory of all the sections that there may be, and writes to it.
    pub(super) fn take_memory(&mut self) {
        self.ring = VecDeque::with_capacity(SECTIONS);
        self.ring.resize(SECTIONS, Section::new(0.0, Feed::Rapid, Allowance::flat(&Limits::NONE), true));
        self.ring.clear();
    }

    pub(super) fn len(&self) -> usize {
        self.ring.len()
    }

    pub(super) fn get(&self, k: usize) -> Option<&Section> {
        self.ring.get(k)
    }

    pub(super) fn front(&self) -> Option<&Section> {
        self.ring.front()
    }

    /// Appends a stretch; if it may, joins it to the last section where they are better one, and both to the
    /// one before.
    pub(super) fn push(&mut self, zone: Section, ratios: &Ratios, joins: bool) {
        self.total += zone.length;
        self.ring.push_back(zone);
        while joins && self.join_last(ratios) {}
        self.touch(self.ring.len().saturating_sub(2));
    }

    /// Joins the last two sections if they are better one.
    fn join_last(&mut self, ratios: &Ratios) -> bool {
        let count = self.ring.len();
        if count < 2 || self.entered && count == 2 {
            return false;
        }
        let (last, zone) = (&self.ring[count - 2], &self.ring[count - 1]);
        // What was promised to the section before must still hold when this one grows.
        let promised = if count > 2 { self.ring[count - 3].exit_hard } else { 0.0 };
        let rests = count == 2 || self.ring[count - 3].stops;
        if last.stops || keeps_to_rest(last, zone, ratios, rests) || !joins(last, zone, ratios, promised) {
            return false;
        }
        self.ring[count - 2] = joined(last, zone, ratios);
        self.ring.pop_back();
        true
    }

    fn touch(&mut self, k: usize) {
        self.changed = Some(self.changed.map_or(k, |changed| changed.min(k)));
    }

    /// The ratios changed: every soft exit may be another.
    pub(super) fn touch_all(&mut self) {
        self.changed = Some(0);
    }

    /// The last section ends the path.
    pub(super) fn stop_at_end(&mut self) {
        if let Some(last) = self.ring.back_mut() {
            last.stops = true;
        }
    }

    /// Backward pass of the look-ahead; true if something changed. It ends where nothing changes any more.
    pub(super) fn look_ahead(&mut self, ratios: &Ratios) -> bool {
        let Some(changed) = self.changed.take() else { return false };
        for k in (0..self.ring.len()).rev() {
            let section = &self.ring[k];
            let (hard, soft) = match self.ring.get(k + 1) {
                Some(next) if !section.stops => {
                    let top = section.limits.v.min(next.limits.v);
                    let cap = section.cap(ratios).min(next.cap(ratios));
                    let [hard, soft] = [next.exit_hard.min(top), next.exit_soft.min(cap)];
                    let entry = next.limits.reach(hard, top, next.length);
                    let alike = (hard, top) == (soft, cap);
                    (
                        stop_or(entry, hard, top, next),
                        if alike { entry } else { next.limits.reach(soft, cap, next.length) },
                    )
                }
                _ => (0.0, 0.0),
            };
            let same = section.exit_hard == hard && section.exit_soft == soft;
            let section = &mut self.ring[k];
            (section.exit_hard, section.exit_soft) = (hard, soft);
            if same && k <= changed {
                break;
            }
        }
        true
    }

    /// Goes on by `way` mm, within the front section or across its end. A rest of it below [`SAME`] is
    /// none: the next one begins so much earlier, so that what many sections leave does not add up.
    pub(super) fn go(&mut self, way: f64) {
        let mut left = way;
        while let Some(front) = self.ring.front_mut() {
            self.entered = true;
            if left < front.length - SAME {
                front.length -= left;
                break;
            }
            let short = (front.length - left).max(0.0);
            left = (left - front.length).max(0.0);
            self.ring.pop_front();
            if let Some(next) = self.ring.front_mut() {
                next.length += short;
            }
            self.changed = self.changed.map(|changed| changed.saturating_sub(1));
        }
        self.total -= way;
        if self.ring.is_empty() {
            self.clear();
        }
    }

    /// What is left of all sections, mm.
    pub(super) fn total(&self) -> f64 {
        self.total
    }

    pub(super) fn clear(&mut self) {
        self.ring.clear();
        (self.entered, self.changed, self.total) = (false, None, 0.0);
    }
}

/// Highest entry from which a section can be kept: that from which its exit is reached, or a stop. That may
/// be nearer than an exit a little below the entry: (F − e/2) T(e) rises with e, then falls.
fn stop_or(entry: f64, exit: f64, top: f64, section: &Section) -> f64 {
    let (limits, length) = (&section.limits, section.length);
    // One way tells whether the search for it can be of use.
    let stop_is_nearer = exit > 0.0 && entry < top && limits.way(0.0, entry) < length;
    if stop_is_nearer { entry.max(limits.reach(0.0, top, length)) } else { entry }
}

/// Two neighbours as one section.
fn joined(last: &Section, zone: &Section, ratios: &Ratios) -> Section {
    Section {
        length: last.length + zone.length,
        feed: last.feed.lower(zone.feed),
        limits: last.limits.min(&zone.limits),
        stops: zone.stops,
        most: last.fastest(ratios).max(zone.fastest(ratios)),
        ..*last
    }
}

/// Whether the faster one of two neighbours lies between the slower one and a rest, and is long enough for
/// most of a ramp between both: that then has all the limits of the faster one. `rests`: the machine does so
/// before `last`.
fn keeps_to_rest(last: &Section, zone: &Section, ratios: &Ratios, rests: bool) -> bool {
    let (a, b) = (last.fastest(ratios), zone.fastest(ratios));
    let low = last.nominal(ratios).min(zone.nominal(ratios));
    let alone = |faster: &Section| faster.limits.reach(0.0, low, faster.length) >= REACHED * low;
    rests && a > b * (1.0 + ALIKE) && alone(last) || zone.stops && b > a * (1.0 + ALIKE) && alone(zone)
}

/// Whether two neighbours are better one section, which can still be entered with the feed `promised`.
///
/// They are if ramps between both feeds take as long a way as both. A faster stretch behind a longer section
/// waits for what follows: more of its kind makes it long enough, or a slower one takes it in. A section that
/// hides a faster stretch is itself a slow one: it takes nothing in that is as fast as this and long.
fn joins(last: &Section, zone: &Section, ratios: &Ratios, promised: f64) -> bool {
    // Feeds per revolution cannot be told from each other's limits while nothing turns.
    let blind = matches!(last.feed, Feed::PerRevolution(..)) && ratios.turns <= 0.0;
    if !last.feed.same_kind(zone.feed) || blind && last.feed != zone.feed {
        return false;
    }
    if promised > 0.0 {
        let both = joined(last, zone, ratios);
        let entry = promised * (1.0 + SURE);
        if entry > both.limits.v || both.limits.way(0.0, entry) > both.length {
            return false;
        }
    }
    let low = last.nominal(ratios).min(zone.nominal(ratios));
    let (a, b) = (last.fastest(ratios), zone.fastest(ratios));
    let high = a.max(b);
    if high <= low * (1.0 + ALIKE) {
        // Alike in feed. A long stretch with room for ramps is not tied to tighter limits than its own.
        let own = [last, zone].map(|section| section.limits.up_to(low));
        let (tied, own) = if own[0].a > own[1].a { (last, own[0]) } else { (zone, own[1]) };
        let limits = last.limits.min(&zone.limits);
        let both = limits.up_to(low);
        let loses = own.a > 1.5 * both.a || own.j > 1.5 * both.j;
        return !loses || tied.length <= 2.0 * limits.way(0.0, low);
    }
    // They would lie in the faster one, within its own limits.
    let faster = if a >= b { last } else { zone };
    let ramps = 2.0 * faster.limits.way(low, high.min(WORTH * low));
    let slow = zone.nominal(ratios) <= low * (1.0 + ALIKE);
    last.length + zone.length <= ramps || slow && a >= b && last.length <= ramps
}
