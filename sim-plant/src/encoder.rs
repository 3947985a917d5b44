//! Faults of the spindle encoder that a scenario brings: counts that come from nowhere or go astray, an index
//! that is not seen. In: the values of an event, then the cycle. Out: what to add to the counter, and whether
//! the index is seen. The spindle itself knows nothing of it: what is true stays true.

use serde::Deserialize;

use crate::scenario::{Action, check_duration};

/// Most counts of a glitch.
const MOST: i64 = 1_000_000_000;

/// `encoder_glitch_counts`
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a number of counts, or { counts, for_s }")]
pub(crate) enum RawGlitch {
    Lasting(i64),
    Passing(RawPassingGlitch),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawPassingGlitch {
    counts: i64,
    for_s: f64,
}

impl RawGlitch {
    pub(crate) fn check(&self) -> Result<Action, String> {
        const KEY: &str = "encoder_glitch_counts";
        let (counts, for_s) = match self {
            RawGlitch::Lasting(counts) => (*counts, None),
            RawGlitch::Passing(glitch) => (glitch.counts, Some(glitch.for_s)),
        };
        check_duration(KEY, for_s)?;
        if counts == 0 || !(-MOST..=MOST).contains(&counts) {
            return Err(format!("{KEY} = {counts}: must lie between -{MOST} and {MOST}, and not be 0"));
        }
        Ok(Action::Glitch { counts, for_s })
    }
}

/// `index_lost`
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected true, or { for_s }")]
pub(crate) enum RawIndexLost {
    Once(bool),
    Passing(RawPassingIndexLost),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RawPassingIndexLost {
    for_s: f64,
}

impl RawIndexLost {
    pub(crate) fn check(&self) -> Result<Action, String> {
        let for_s = match self {
            RawIndexLost::Once(true) => None,
            RawIndexLost::Once(false) => {
                return Err(
                    "index_lost: write true or { for_s }; without an event every index is seen".to_owned()
                );
            }
            RawIndexLost::Passing(lost) => Some(lost.for_s),
        };
        check_duration("index_lost", for_s)?;
        Ok(Action::IndexLost { for_s })
    }
}

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
}

impl Disturbance {
    /// None yet; for a scenario of so many events.
    pub(crate) fn none(events: usize) -> Disturbance {
        Disturbance { shift: 0, returns: Vec::with_capacity(events), lose_next: false, blind_until: 0 }
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

    /// What the counter shows too much, counts.
    pub(crate) fn shift(&self) -> i64 {
        self.shift
    }

    /// Whether an index that passes in a cycle is seen; asked once for each.
    pub(crate) fn sees_index(&mut self, cycle: u64) -> bool {
        let lost = std::mem::take(&mut self.lose_next);
        !lost && cycle >= self.blind_until
    }
}
