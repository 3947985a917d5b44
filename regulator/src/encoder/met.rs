//! What an index says of the counts since the one before (M71). In: what was counted since, and where the
//! index was latched. Out: the counts that are missing, or that it cannot be.

use protocol::Fault;

use super::EncoderFault;

/// A spindle that meets its index again so many counts from where it was has lost counts; farther off it has
/// met something else.
const LOST_COUNTS: i64 = 8;

/// Counts too many or too few since the index before, in the direction of the spindle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Missed {
    pub(super) counts: i64,
    pub(super) forward: bool,
}

/// What has been seen so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub(super) count: i64,
    pub(super) change: Option<i64>,
    /// By how much that differed from the one before.
    pub(super) trend: i64,
    /// Measurements are missing before the next.
    pub(super) gap: bool,
    pub(super) index_number: u64,
    /// Count at the last index.
    pub(super) index: Option<i64>,
    /// Lowest and highest count since the last index, or since the start.
    pub(super) low: i64,
    pub(super) high: i64,
}

impl Seen {
    /// At an index that was latched at the count `at`, of an encoder with so many counts a turn; `turns` is 1
    /// unless a cycle is longer than a turn. Indexes that were not seen lie whole turns in between.
    pub(super) fn at_index(&self, at: i64, turns: u64, turn: i64) -> Result<Option<Missed>, EncoderFault> {
        let Some(from) = self.index else { return Ok(None) };
        let turned = at.saturating_sub(from).saturating_abs();
        let unseen = turned.saturating_add(turn / 2) / turn;
        let missed = turned.saturating_sub(turn.saturating_mul(unseen.max(turns.min(1 << 20) as i64)));
        let within = |high: i64, low: i64| high.saturating_sub(low) <= 1;
        let forth = within(self.high, self.count) && within(from, self.low);
        let back = within(self.count, self.low) && within(self.high, from);
        match turned {
            0..=1 => Ok(None),
            _ if forth || back || turned > turn / 2 => {
                Ok(Some(Missed { counts: missed, forward: at > from }))
            }
            // Met lower than it was, counts are missing forwards; met higher, they are missing backwards.
            ..=LOST_COUNTS => Ok(Some(Missed { counts: -turned, forward: at < from })),
            _ => Err(EncoderFault { fault: Fault::EncoderPlausibility, counts: turned }),
        }
    }

    /// How far the count went from the last index, or since the start.
    pub(super) fn turned(&self) -> i64 {
        match self.index {
            Some(index) => self.high.saturating_sub(index).max(index.saturating_sub(self.low)),
            None => self.high.saturating_sub(self.low),
        }
    }
}
