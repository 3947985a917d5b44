//! What of the faults of a run has been seen. In: each recorded control cycle. Out: what is new, and whether
//! the record has a gap before it.

use protocol::PerAxis;

/// Faults seen last, by their numbers.
#[derive(Clone, Default)]
pub(super) struct Latched {
    pub(super) axes: PerAxis<u32>,
    pub(super) machine: u32,
    /// The control cycle that comes next, if none is missing.
    next_cycle: u64,
}

impl Latched {
    /// How much of the record is missing before a cycle, in words: what is first seen there may be older.
    pub(super) fn gap(&mut self, cycle: u64) -> Option<String> {
        let missing = cycle.saturating_sub(std::mem::replace(&mut self.next_cycle, cycle.saturating_add(1)));
        (missing > 0).then(|| format!("first seen here: the {missing} cycles before are not recorded"))
    }
}
