//! Which law s(t) follows next. In: the state of the machine on its path, the sections ahead, what the
//! operator asks for. Out: a law that has been checked (`law.rs`).
//!
//! | in hand | when | follows |
//! |---|---|---|
//! | rest | blocks are known and asked for | a block law over one or more sections (M23, `span.rs`) |
//! | block law | it is faster than what is asked for now; its pulse of jerk is over, or has just begun and is folded | a change of speed (M64) |
//! | block law | the look-ahead sees further; it runs at constant speed | a block law over one or more sections |
//! | any | it is over | a block law over one or more sections, or rest |
//!
//! A change of speed may cross sections. It keeps the tightest limits of all of them and the top feed at
//! every border, and where it ends the rest of the path can still be kept; else the law in hand goes on,
//! which can.

use super::ahead::{AT_ONCE, MOST_CROSSED, SECTIONS};
use super::law::{Fold, Law, Promise};
use super::{Ask, Chain, SAME};
use crate::change::SpeedChange;
use crate::feed::FeedBlock;
use crate::limits::Limits;
use crate::sample::Sample;

/// Most laws in one cycle: blocks last at least a sixteenth of it, and have three sections at most.
const MOST_LAWS: usize = 64;
/// Cycles for which a chain at rest waits for more blocks before it sets off with what it has.
const PATIENCE: u32 = 8;
/// A chain at rest waits for more blocks until it knows so many stopping distances.
const WAYS_KNOWN: f64 = 3.0;
/// Where fewer stopping distances are known, stretches do not wait for others, nor exits for more of them.
const WAYS_SHOWN: f64 = 6.0;

impl<const N: usize, T: Copy> Chain<N, T> {
    /// Goes on by one cycle of time.
    pub(super) fn steer(&mut self, ask: &Ask) {
        self.take(ask);
        let mut left = self.settings.cycle_s;
        let mut refused = false;
        for law in 0..MOST_LAWS {
            let near = self.ways(WAYS_SHOWN);
            self.run_dry(ask, left, near);
            self.stale |= self.sections.look_ahead(&self.ratios, near, if law == 0 { AT_ONCE } else { 0 });
            let cap = self.cap(ask);
            let slow = !refused && self.law.goal(self.t) > cap * (1.0 + SAME);
            let follows = self.overlap(ask, left);
            let over = self.law.duration() - follows.map_or(0.0, |(_, time)| time);
            let takes_over = match self.law {
                Law::Rest if cap > 0.0 && self.may_start() => self.t,
                Law::Rest => return,
                law if slow && self.tail.is_none() && law.folds(self.t).is_some() => self.t,
                _ if slow => self.law.settled(self.t),
                _ if self.stale => self.law.level(self.t),
                _ => over,
            }
            .min(over);
            if takes_over - self.t > left {
                self.t += left;
                return;
            }
            left -= (takes_over - self.t).max(0.0);
            self.t = self.t.max(takes_over);
            self.drop_tail();
            if let Some((next, time)) = follows.filter(|_| self.t >= over) {
                self.overtake(next, time, ask);
                continue;
            }
            refused = !self.decide(ask, slow && self.t < over);
            if ask.single && self.rests() {
                return;
            }
        }
        self.t = (self.t + left).min(self.law.duration());
    }

    /// Goes on to the end of the law in hand, or only so far that it does not come near the end of what is
    /// known while more may follow; the time it took.
    pub(super) fn leap(&mut self, ask: &Ask) -> f64 {
        self.take(ask);
        let near = self.ways(WAYS_SHOWN);
        self.run_dry(ask, 0.0, near);
        self.stale |= self.sections.look_ahead(&self.ratios, near, SECTIONS);
        if self.stale && !self.rests() && self.law.level(self.t) <= self.t {
            self.decide(ask, false);
        }
        let level = self.law.level(self.t);
        let until = match self.law {
            Law::Rest => self.t,
            _ if self.stale => level,
            law => law.duration(),
        };
        let until = if self.closed || level >= until {
            until
        } else {
            let speed = self.law.at(level).v.max(f64::MIN_POSITIVE);
            until.min(level + 0.5 * (self.sections.total() - self.law.at(level).s) / speed)
        };
        let follows = if until == self.law.duration() { self.overlap(ask, until) } else { None };
        let until = until - follows.map_or(0.0, |(_, time)| time);
        let left = (until - self.t).max(0.0);
        self.t += left;
        self.drop_tail();
        match follows {
            Some((next, time)) => self.overtake(next, time, ask),
            None => _ = self.decide(ask, false),
        }
        left
    }

    fn take(&mut self, ask: &Ask) {
        if ask.ratios != self.ratios {
            self.ratios = ask.ratios;
            self.sections.touch_all();
        }
        self.stale |= ask.single != self.single;
        self.single = ask.single;
    }

    /// The feed asked for where the machine is.
    pub(super) fn cap(&self, ask: &Ask) -> f64 {
        match self.sections.front() {
            Some(front) if !ask.hold => front.cap(&self.ratios),
            _ => 0.0,
        }
    }

    /// The way of so many stopping distances from where the machine is, from the start of the law in hand,
    /// mm; without end at rest.
    fn ways(&self, count: f64) -> f64 {
        let now = self.law.at(self.t);
        match self.sections.front() {
            Some(front) if !self.rests() => {
                now.s + count * front.limits.way(0.0, self.law.goal(self.t).max(now.v))
            }
            _ => f64::INFINITY,
        }
    }

    /// Ends the chain if what is known of it is about to be used up.
    fn run_dry(&mut self, ask: &Ask, left: f64, near: f64) {
        if self.closed {
            return;
        }
        if self.sections.total() <= near {
            self.sections.show();
        }
        let dry = match (&self.law, self.sections.front()) {
            (Law::Rest, _) => self.quiet > PATIENCE,
            (_, None) => true,
            (law, Some(_)) => {
                let last = self.sections.len() == 1;
                !ask.more && self.sections.total() <= self.ways(WAYS_KNOWN)
                    || last && self.pieces.pending() > 0 && law.level(self.t) >= law.duration() - left
            }
        };
        if dry {
            self.starved = true;
            self.close();
        }
    }

    /// Whether enough is known to set off from rest: what follows no more than the path makes it slower.
    fn may_start(&self) -> bool {
        let Some(front) = self.sections.front() else { return false };
        let fastest = || front.limits.reach(front.exit_soft, front.cap(&self.ratios), front.length);
        let way = || front.limits.way(0.0, fastest());
        self.closed || !self.has_room() || self.sections.total() > WAYS_KNOWN * way()
    }

    /// Replaces the law in hand at its time `t`; false if it has to go on.
    fn decide(&mut self, ask: &Ask, slow: bool) -> bool {
        if slow {
            return self.slow_down(self.cap(ask));
        }
        let over = !self.rests() && self.t >= self.law.duration();
        let now = self.law.at(self.t);
        let (v, gone) = if over { (self.law.end_speed(), self.law.way()) } else { (now.v, now.s) };
        self.stale = false;
        if !over && !self.rests() {
            // A law that is good stays unless a better one can be released.
            let ends = self.sections.front().is_none_or(|front| front.length - gone <= SAME);
            if !ends && let Some((count, block)) = self.plan(0, v, ask, gone) {
                let behind = self.sections.len() - count;
                self.leave(gone);
                self.follow(block, behind, ask);
            }
            return true;
        }
        self.leave(gone);
        (self.law, self.t) = (Law::Rest, 0.0);
        if v == 0.0 {
            // Where it stands at the end of a block, the law that follows is one of the next block.
            self.place(0.0);
        }
        if self.sections.front().is_none() {
            return true;
        }
        let cap = self.cap(ask);
        if ask.single && over && v == 0.0 && self.at_block_end() {
            return true;
        }
        if v > cap * (1.0 + SAME)
            && let Some(change) = self.change(v, 0.0, cap, 0.0)
        {
            self.law = Law::Change(change);
        } else if cap > 0.0 || v > 0.0 {
            match self.plan(0, v, ask, 0.0) {
                Some((count, block)) => self.follow(block, self.sections.len() - count, ask),
                None => {
                    self.rejected = true;
                    self.law = self.change(v, 0.0, 0.0, 0.0).map_or(Law::Rest, Law::Change);
                }
            }
        }
        true
    }

    /// Follows a block law that passes all sections but the last `behind`. At its highest speed it is planned
    /// again if it may become faster yet: what bends leave for that is less, so it takes another ramp.
    pub(super) fn follow(&mut self, block: FeedBlock, behind: usize, ask: &Ask) {
        self.sections.join_front(behind);
        let cap = self.cap(ask);
        self.stale = block.accel().dv() > 0.0 && block.cruise_time() > 0.0 && block.peak_feed() < cap;
        (self.law, self.t) = (Law::Block(block), 0.0);
    }

    /// Replaces the law in hand by a change to the speed `cap`; false if the path ahead does not allow it.
    fn slow_down(&mut self, cap: f64) -> bool {
        if let Some(block) = self.law.folds(self.t).copied() {
            let Sample { s, v, a, .. } = Fold::at_end(&block, self.t);
            let Some(change) = self.change(v, a, cap, s) else { return false };
            let fold = Law::Fold(Fold::new(block, self.t, change));
            let kept = self.sections.front().is_some_and(|front| {
                let (start, way) = (block.at(0.0).v, fold.way());
                let limits = front.limits.up_to(fold.peak_speed());
                fold.keeps(&Promise { start, acceleration: 0.0, end: cap, way, limits })
            });
            if kept {
                self.law = fold;
            }
            return kept;
        }
        let Sample { s, v, a, .. } = self.law.at(self.t);
        let Some(change) = self.change(v, a, cap, s) else { return false };
        if self.is_later(&change, cap, s) {
            return false;
        }
        self.leave(s);
        (self.law, self.t) = (Law::Change(change), 0.0);
        true
    }

    /// Whether a change that leaves the front section with its limits ends later than one that waits for
    /// those of the next: the block law in hand goes on to the border.
    fn is_later(&self, change: &SpeedChange, target: f64, gone: f64) -> bool {
        let (Law::Block(_), Some(front), Some(next)) =
            (&self.law, self.sections.front(), self.sections.get(1))
        else {
            return false;
        };
        if front.stops || gone + change.distance() <= front.length {
            return false;
        }
        let start = self.law.end_speed();
        let limits = next.limits.up_to(start.max(target));
        let there = SpeedChange::plan(start, 0.0, target, &limits).duration();
        change.duration() > self.law.duration() - self.t + there
    }

    /// Leaves `gone` mm of the law behind.
    pub(super) fn leave(&mut self, gone: f64) {
        self.along += gone;
        self.sections.go(gone);
    }

    /// Whether the machine is where a block ends: at the end of the front one, or at its start, when the one
    /// before has been left behind.
    fn at_block_end(&self) -> bool {
        let ends = |length: f64| (length - self.along).abs() <= SAME;
        self.along.abs() <= SAME || self.pieces.front().is_some_and(|front| ends(front.length()))
    }

    /// A change to the speed `target` that begins `gone` mm behind the start of the front section; `None` if
    /// the path ahead does not allow it.
    fn change(&self, v: f64, a: f64, target: f64, gone: f64) -> Option<SpeedChange> {
        let front = self.sections.front()?;
        // What still speeds up is taken back no more slowly than the law in hand would: who asks for less
        // never makes it faster.
        let most = front.limits.v.min(self.law.peak_speed()) * (1.0 + SAME);
        let mut limits = front.limits.up_to(v.max(target));
        for _ in 0..MOST_CROSSED {
            if a.abs() > limits.a * (1.0 + SAME) {
                return None;
            }
            let change = SpeedChange::plan(v, a, target, &limits);
            let tightest = self.crossed(&change, target, gone)?;
            let tighter = limits.min(&tightest);
            if tighter == limits {
                let top = change.at(change.top());
                if top.v > v.max(target) && (top.v > most || gone + top.s > front.length) {
                    return None;
                }
                let limits = Limits { v: top.v, ..limits };
                let (end, way) = (target, change.distance());
                let promise = Promise { start: v, acceleration: a, end, way, limits };
                return Law::Change(change).keeps(&promise).then_some(change);
            }
            limits = tighter;
        }
        None
    }

    /// The tightest limits of the sections that a change crosses; `None` if it would break the top feed of
    /// one of them, or leave a state from which the rest cannot be kept.
    fn crossed(&self, change: &SpeedChange, target: f64, gone: f64) -> Option<Limits> {
        let mut limits = Limits::NONE;
        let mut left = gone + change.distance();
        let mut border = -gone;
        let mut fastest = change.peak().v.max(target);
        for k in 0..MOST_CROSSED {
            let section = self.sections.get(k)?;
            limits = limits.min(&section.limits.up_to(fastest));
            limits.v = f64::INFINITY;
            if left <= section.length {
                let keeps = self.sections.from(k, left, target, &self.ratios).any(|joined| {
                    let fits = |exit: f64| joined.limits.way(target, exit) <= joined.length;
                    target <= joined.exit_hard || fits(joined.exit_hard) || fits(0.0)
                });
                let keeps = keeps && target <= section.limits.v * (1.0 + SAME);
                return keeps.then_some(limits);
            }
            left -= section.length;
            border += section.length;
            let next = self.sections.get(k + 1)?;
            if section.stops {
                return None;
            }
            let own = next.limits.up_to(fastest);
            if limits.min(&own) != limits {
                fastest = fastest.min(change.most_at(border).max(target));
            }
            if fastest > next.limits.v && change.speed_at(border) > next.limits.v * (1.0 + SAME) {
                return None;
            }
        }
        None
    }
}
