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

use core::ops::Range;
use std::collections::VecDeque;

use super::allowance::Allowance;
use super::section::{Section, joins};
use super::{Feed, Ratios, SAME};
use crate::limits::Limits;

/// Most sections ahead.
pub(super) const SECTIONS: usize = 4096;
/// Most sections that a change of speed may cross.
pub(super) const MOST_CROSSED: usize = 256;
/// Most sections that a law passes.
const MOST_JOINED: usize = 12;
/// When something else is asked for, so many sections are looked at again at once, and so many of all of them
/// in every cycle from then on.
pub(super) const AT_ONCE: usize = MOST_JOINED;

/// The sections ahead; the front one is that in which the machine is.
#[derive(Clone, Debug)]
pub(super) struct Sections {
    ring: VecDeque<Section>,
    /// The last stretch, as long as more may be joined to it: nothing counts on it yet.
    open: Option<Section>,
    /// Index of the first section whose exit may have changed.
    changed: Option<usize>,
    /// How often something else was asked for.
    asked: u32,
    /// The round of all sections for the sake of that.
    round: Round,
    total: f64,
}

/// All sections are looked at again, the last one first.
#[derive(Clone, Copy, Debug, Default)]
struct Round {
    /// How often something else had been asked for when it began; when the nearest sections were looked at.
    asked: u32,
    nearest: u32,
    /// Sections that it has not come to.
    waits: usize,
}

impl Sections {
    pub(super) fn new() -> Sections {
        Sections {
            ring: VecDeque::new(),
            open: None,
            changed: None,
            asked: 0,
            round: Round::default(),
            total: 0.0,
        }
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
                self.count_down();
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

    /// One section less at the front.
    fn count_down(&mut self) {
        self.changed = self.changed.map(|changed| changed.saturating_sub(1));
        self.round.waits = self.round.waits.saturating_sub(1);
    }

    /// The ratios changed: every soft exit may be another.
    pub(super) fn touch_all(&mut self) {
        self.asked = self.asked.wrapping_add(1);
    }

    /// The last section ends the path.
    pub(super) fn stop_at_end(&mut self) {
        self.show();
        if let Some(last) = self.ring.back_mut() {
            last.stops = true;
        }
    }

    /// The look-ahead; true if the next law may be another. When something else is asked for, the nearest
    /// sections come first, then `most` of all of them in every call, the last ones first, until they have
    /// all been looked at: until then those in between have soft exits for what was asked for before.
    pub(super) fn look_ahead(&mut self, ratios: &Ratios, near: f64, most: usize) -> bool {
        let len = self.ring.len();
        let asked = self.round.nearest != self.asked;
        if asked {
            self.pass(0..len.min(AT_ONCE), 0, true, ratios);
            self.round.nearest = self.asked;
            if len <= AT_ONCE {
                self.round = Round { asked: self.asked, nearest: self.asked, waits: 0 };
            }
        }
        if self.round.waits == 0 && self.round.asked != self.asked {
            self.round = Round { asked: self.asked, waits: len, ..self.round };
        }
        let mut other = asked;
        if self.round.waits > 0 {
            let rest = self.round.waits.saturating_sub(most);
            other |= self.pass(rest..self.round.waits, rest, true, ratios);
            self.round.waits = rest;
        }
        if let Some(changed) = self.changed.filter(|changed| !self.defers(*changed, near)) {
            self.changed = None;
            other |= self.pass(0..len, changed, false, ratios) || changed < MOST_JOINED;
        }
        other
    }

    /// Whether a few new sections, beyond many and beyond the next `near` mm, wait for more.
    fn defers(&self, changed: usize, near: f64) -> bool {
        let fresh = self.ring.len() - changed.min(self.ring.len());
        let few = changed > 2 * MOST_JOINED && fresh < MOST_JOINED;
        let beyond = || self.ring.iter().rev().take(fresh).map(|section| section.length).sum::<f64>();
        few && self.total - beyond() > near
    }

    /// Looks at sections again, the last one first, `anew` because something else is asked for; true if one
    /// of the nearest has another exit. Before those from `must` on it ends where nothing changes any more,
    /// or where a round comes later. What the path allows only grows, because what is known of it stays.
    fn pass(&mut self, sections: Range<usize>, must: usize, anew: bool, ratios: &Ratios) -> bool {
        let (mut alike, mut near) = (0, false); // Sections in a row that are as they were.
        for k in sections.rev() {
            if k < must && (alike >= MOST_JOINED || self.ring[k].asked != self.asked) {
                break;
            }
            let [hard, soft] = self.exits(k, anew, ratios);
            let section = &mut self.ring[k];
            alike = if section.exit_hard == hard && section.exit_soft == soft { alike + 1 } else { 0 };
            near |= alike == 0 && k < MOST_JOINED;
            (section.exit_hard, section.exit_soft, section.asked) = (hard, soft, self.asked);
        }
        near
    }

    /// The exits of section `k` from those ahead (M196). What was found before still holds, the soft one if
    /// not `anew`: it is where the search begins.
    fn exits(&self, k: usize, anew: bool, ratios: &Ratios) -> [f64; 2] {
        let section = &self.ring[k];
        let anew = anew || section.asked != self.asked;
        let (mut hard, mut soft) = (section.exit_hard, if anew { 0.0 } else { section.exit_soft });
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
            self.count_down();
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
        (self.open, self.changed, self.round.waits, self.total) = (None, None, 0, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::{AT_ONCE, Allowance, Feed, Limits, Ratios, Section, Sections};

    /// Sections of uneven lengths and limits, as they are found with these ratios asked for one by one.
    fn ahead(asked: &[f64]) -> Sections {
        let mut sections = Sections::new();
        for k in 0..400 {
            let tight = 1.0 + f64::from(k * 7919 % 17);
            let limits = Limits { v: 200.0 / tight, a: 2e3 / tight, j: 8e4, dj: 8e6 };
            let length = 2.0 + f64::from(k * 104_729 % 13);
            let zone = Section::new(length, Feed::PerSecond(90.0), Allowance::flat(&limits), k == 399);
            sections.push(zone, &Ratios::full(0.0));
        }
        for feed in asked {
            let ratios = Ratios { feed: *feed, ..Ratios::full(0.0) };
            sections.touch_all();
            (0..=sections.len() / AT_ONCE).for_each(|_| _ = sections.look_ahead(&ratios, 0.0, AT_ONCE));
        }
        sections
    }

    /// However often something else is asked for, in a bounded number of cycles every section has the exits
    /// of a machine that was never asked for anything else.
    #[test]
    fn m196_what_is_asked_for_reaches_every_section() {
        let exits = |asked: &[f64]| -> Vec<[f64; 2]> {
            ahead(asked).ring.iter().map(|section| [section.exit_hard, section.exit_soft]).collect()
        };
        let (slow, fast) = (exits(&[0.3]), exits(&[2.0]));
        assert!(slow.len() > 5 * AT_ONCE, "{} sections", slow.len());
        assert!(slow.iter().zip(&fast).any(|(slow, fast)| fast[1] > 1.5 * slow[1]));
        assert_eq!(exits(&[2.0, 0.3]), slow);
        assert_eq!(exits(&[0.3, 0.1, 1.3, 2.0]), fast);
    }
}
