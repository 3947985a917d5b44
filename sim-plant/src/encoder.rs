//! Faults of the spindle encoder that a scenario brings: counts that come from nowhere or go astray, a
//! counter that stands, noise, eccentricity, an index that is not seen. In: the values of an event, then in
//! each cycle what a sound encoder would show. Out: what this one shows. The spindle itself knows nothing of
//! it: what is true stays true.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | q | turns | true angle |
//! | a, n | counts | amplitude of the eccentricity; largest noise |
//!
//! ```text
//! count = floor(4 lines q + offset + a sin(2π q)) + shift + one of −n … n
//! ```
//! A counter that stands has lost what it did not count: it goes on from where it stood.

use core::f64::consts::TAU;

use protocol::Cycle;

use crate::seed::Seed;

/// How the encoder is disturbed in the present cycle.
#[derive(Clone, Debug)]
pub(crate) struct Disturbance {
    /// What the counter shows too much.
    shift: i64,
    /// Cycles in which counts come back, and how many. Room for every event of the scenario.
    returns: Vec<(u64, i64)>,
    /// The next index is not seen.
    lose_next: bool,
    /// First cycle in which an index is seen again.
    blind_until: u64,
    /// First cycle in which the counter counts again, and what it showed last.
    stands_until: u64,
    shown: i64,
    /// Largest noise, and amplitude of the eccentricity, counts.
    noise: u32,
    eccentricity: f64,
}

impl Disturbance {
    /// None yet.
    pub(crate) fn none() -> Disturbance {
        Disturbance {
            shift: 0,
            returns: Vec::new(),
            lose_next: false,
            blind_until: 0,
            stands_until: 0,
            shown: 0,
            noise: 0,
            eccentricity: 0.0,
        }
    }

    /// For a scenario of so many events.
    pub(crate) fn make_room(&mut self, events: usize) {
        self.returns.reserve(events);
    }

    /// The counter jumps; back in the cycle `until`, if there is one.
    pub(crate) fn jump(&mut self, counts: i64, until: Option<u64>) {
        self.shift += counts;
        self.returns.extend(until.map(|until| (until, counts)));
    }

    /// The next index is not seen, or none before the cycle `until`.
    pub(crate) fn lose_index(&mut self, until: Option<u64>) {
        match until {
            Some(until) => self.blind_until = self.blind_until.max(until),
            None => self.lose_next = true,
        }
    }

    /// Goes on to a cycle.
    pub(crate) fn advance(&mut self, cycle: u64) {
        let shift = &mut self.shift;
        self.returns.retain(|(until, counts)| {
            let over = cycle >= *until;
            *shift -= if over { *counts } else { 0 };
            !over
        });
    }

    /// The counter stands before the cycle `until`, or for good; no index is seen meanwhile.
    pub(crate) fn stand(&mut self, until: Option<u64>) {
        self.stands_until = until.unwrap_or(u64::MAX);
    }

    /// From now on the counter is off by up to so many counts.
    pub(crate) fn be_noisy(&mut self, counts: u32) {
        self.noise = counts;
    }

    /// From now on the encoder is eccentric, with an amplitude in counts.
    pub(crate) fn be_eccentric(&mut self, counts: f64) {
        self.eccentricity = counts;
    }

    /// Counts that an eccentric encoder is ahead at an angle in turns.
    pub(crate) fn ahead(&self, turns: f64) -> f64 {
        if self.eccentricity == 0.0 {
            return 0.0;
        }
        self.eccentricity * libm::sin(TAU * (turns - turns.floor()))
    }

    /// What the counter shows in a cycle, for what a sound one would show.
    pub(crate) fn show(&mut self, cycle: Cycle, count: i64) -> i64 {
        if cycle.0 < self.stands_until {
            self.shift = self.shown - count;
        }
        self.shown = count + self.shift;
        self.shown + self.stray(cycle.0)
    }

    /// What is latched at an index that passes in a cycle; `None` if it is not seen. Asked once for each.
    pub(crate) fn latch(&mut self, cycle: Cycle, count: i64) -> Option<i64> {
        let lost = std::mem::take(&mut self.lose_next);
        let seen = !lost && cycle.0 >= self.blind_until.max(self.stands_until);
        // Another stray than that of the count of this cycle.
        seen.then(|| count + self.shift + self.stray(!cycle.0))
    }

    /// A number of counts from −n to n that looks random.
    fn stray(&self, number: u64) -> i64 {
        if self.noise == 0 {
            return 0;
        }
        let most = i64::from(self.noise);
        (Seed(number).fraction() * (2 * most + 1) as f64) as i64 - most
    }
}
