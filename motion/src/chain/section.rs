//! The look-ahead: stretches of path with their limits, and the feeds at their borders (M24, M26). In:
//! stretches in the order of the path, the ratios that overrides ask for. Out: the highest feed at the end of
//! each stretch from which everything ahead can still be kept.
//!
//! ```text
//! exit(k) = max over m of the speed that the way of sections k + 1 … k + m can join with exit(k + m)  (M196)
//! ```
//! within the lowest limits and feeds of these sections, m ≤ 12, or with rest. At an exit there is no
//! acceleration; a ramp may pass several sections. When the machine enters those that its law passes
//! (`span.rs`), they become one. Stretches that are very short against a ramp are joined beforehand: before
//! anything relies on their borders.
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
/// Two stretches are joined if both are shorter than this share of such a ramp, so that a law passes a dozen.
const FINE: f64 = 0.25;
/// Most sections that a change of speed may cross.
pub(super) const MOST_CROSSED: usize = 256;
/// Most sections that a law passes.
const MOST_JOINED: usize = 12;

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
}

impl Section {
    /// A stretch alone, before the look-ahead has seen it.
    pub(super) fn new(length: f64, feed: Feed, limits: Allowance, stops: bool) -> Section {
        Section { length, feed, limits, stops, exit_hard: 0.0, exit_soft: 0.0 }
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

    /// It and the next one as one.
    fn with(&self, next: &Section) -> Section {
        Section {
            length: self.length + next.length,
            feed: self.feed.lower(next.feed),
            limits: self.limits.min(&next.limits),
            ..*next
        }
    }

    /// The highest entry up to `top` from which the speed `exit` is reached at the end; `least` if it is not
    /// above that.
    fn entry(&self, exit: f64, top: f64, least: f64) -> f64 {
        // One way tells whether the search can be of use.
        let may = top > least && (exit >= least || self.limits.way(exit, least) < self.length);
        if may { least.max(self.limits.reach(exit, top, self.length)) } else { least }
    }

    /// Whether one law may pass both.
    fn goes_on(&self, next: &Section) -> bool {
        !self.stops && self.feed.same_kind(next.feed)
    }
}

/// The sections ahead; the front one is that in which the machine is.
#[derive(Clone, Debug)]
pub(super) struct Sections {
    ring: VecDeque<Section>,
    /// The last stretch, as long as more may be joined to it: nothing counts on it yet.
    open: Option<Section>,
    /// Index of the first section whose exit may have changed.
    changed: Option<usize>,
    /// Something else is asked for since the exits were found.
    asked: bool,
    total: f64,
}

impl Sections {
    pub(super) fn new() -> Sections {
        Sections { ring: VecDeque::new(), open: None, changed: None, asked: false, total: 0.0 }
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

    /// Appends a stretch. It becomes known when the next one is not joined to it, or by [`Sections::show`].
    pub(super) fn push(&mut self, zone: Section, ratios: &Ratios) {
        let open = match self.open.take() {
            Some(open) if joins(&open, &zone, ratios) => open.with(&zone),
            open => {
                self.open = open;
                self.show();
                zone
            }
        };
        self.open = Some(open);
        if open.stops {
            self.show();
        }
    }

    /// The last stretch is known: nothing is joined to it any more.
    pub(super) fn show(&mut self) {
        if let Some(open) = self.open.take() {
            self.total += open.length;
            self.ring.push_back(open);
            self.touch(self.ring.len().saturating_sub(2));
        }
    }

    /// All sections but the last `behind` become one.
    pub(super) fn join_front(&mut self, behind: usize) {
        while self.ring.len() > behind + 1 {
            if let (Some(front), Some(next)) = (self.ring.pop_front(), self.ring.front_mut()) {
                *next = front.with(next);
                self.changed = self.changed.map(|changed| changed.saturating_sub(1));
            }
        }
    }

    /// Section `k` without the first `gone` mm, then it and the next as one, and so on, as far as a law from
    /// the speed `v` may pass them.
    pub(super) fn from(&self, k: usize, gone: f64, v: f64, ratios: &Ratios) -> impl Iterator<Item = Section> {
        let first = self.ring.get(k).map(|first| Section { length: first.length - gone, ..*first });
        let mut behind = k + 1;
        let spans = core::iter::successors(first, move |span: &Section| {
            let next = self.ring.get(behind).filter(|next| span.goes_on(next))?;
            behind += 1;
            Some(span.with(next)).filter(|span| v <= span.limits.v * (1.0 + SAME))
        });
        spans.take(MOST_JOINED).map(|span| Section {
            exit_hard: span.exit_hard.min(span.limits.v),
            exit_soft: span.exit_soft.min(span.cap(ratios)),
            ..span
        })
    }

    fn touch(&mut self, k: usize) {
        self.changed = Some(self.changed.map_or(k, |changed| changed.min(k)));
    }

    /// The ratios changed: every soft exit may be another.
    pub(super) fn touch_all(&mut self) {
        (self.changed, self.asked) = (Some(0), true);
    }

    /// The last section ends the path.
    pub(super) fn stop_at_end(&mut self) {
        self.show();
        if let Some(last) = self.ring.back_mut() {
            last.stops = true;
        }
    }

    /// Backward pass of the look-ahead; true if something changed. It ends where nothing changes any more.
    /// What the path allows only grows, because what is known of it stays.
    ///
    /// A few sections beyond many, and beyond the next `near` mm, wait for more.
    pub(super) fn look_ahead(&mut self, ratios: &Ratios, near: f64) -> bool {
        let Some(changed) = self.changed else { return false };
        let fresh = self.ring.len() - changed.min(self.ring.len());
        if !self.asked && changed > 2 * MOST_JOINED && fresh < MOST_JOINED {
            let beyond: f64 = self.ring.iter().rev().take(fresh).map(|section| section.length).sum();
            if self.total - beyond > near {
                return false;
            }
        }
        self.changed = None;
        let mut alike = 0; // Sections in a row that are as they were.
        for k in (0..self.ring.len()).rev() {
            let [hard, soft] = self.exits(k, ratios);
            let section = &mut self.ring[k];
            alike = if section.exit_hard == hard && section.exit_soft == soft { alike + 1 } else { 0 };
            (section.exit_hard, section.exit_soft) = (hard, soft);
            if alike >= MOST_JOINED && k <= changed {
                break;
            }
        }
        self.asked = false;
        true
    }

    /// The exits of section `k` from those ahead (M196). What was found before still holds, the soft one if
    /// nothing else is asked for: it is where the search begins.
    fn exits(&self, k: usize, ratios: &Ratios) -> [f64; 2] {
        let section = &self.ring[k];
        let (mut hard, mut soft) = (section.exit_hard, if self.asked { 0.0 } else { section.exit_soft });
        if section.stops {
            return [0.0; 2];
        }
        let (own_top, own_cap) = (section.limits.v, section.cap(ratios));
        for span in self.from(k + 1, 0.0, 0.0, ratios) {
            let (top, cap) = (own_top.min(span.limits.v), own_cap.min(span.cap(ratios)));
            if top <= hard && cap <= soft {
                break;
            }
            hard = span.entry(span.exit_hard.min(top), top, hard);
            // A stop may be nearer than an exit a little below the entry: (F − e/2) T(e) rises with e, then
            // falls.
            hard = span.entry(0.0, top, hard);
            soft = span.entry(span.exit_soft.min(cap), cap, soft);
        }
        [hard, soft]
    }

    /// Goes on by `way` mm, within the front section or across its end. A rest of it below [`SAME`] is
    /// none: the next one begins so much earlier, so that what many sections leave does not add up.
    pub(super) fn go(&mut self, way: f64) {
        let mut left = way;
        while let Some(front) = self.ring.front_mut() {
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
        if self.ring.is_empty() && self.open.is_none() {
            self.clear();
        }
    }

    /// What is left of all sections, mm.
    pub(super) fn total(&self) -> f64 {
        self.total
    }

    pub(super) fn clear(&mut self) {
        self.ring.clear();
        (self.open, self.changed, self.asked, self.total) = (None, None, false, 0.0);
    }
}

/// Whether two neighbours are better one section: ramps between both feeds take a much longer way than both.
fn joins(last: &Section, zone: &Section, ratios: &Ratios) -> bool {
    // Feeds per revolution cannot be told from each other's limits while nothing turns.
    let blind = matches!(last.feed, Feed::PerRevolution(..)) && ratios.turns <= 0.0;
    if !last.goes_on(zone) || blind && last.feed != zone.feed {
        return false;
    }
    let low = last.nominal(ratios).min(zone.nominal(ratios));
    let (a, b) = (last.nominal(ratios), zone.nominal(ratios));
    let high = a.max(b);
    if high <= low * (1.0 + ALIKE) {
        // Alike in feed. A long stretch with room for ramps is not tied to tighter limits than its own.
        let own = [last, zone].map(|section| section.limits.up_to(low));
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
