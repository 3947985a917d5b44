//! Supervision of the spindle encoder: what it counts has to be what a spindle can do, and every turn has its
//! index. In: one measurement per control cycle, in counts. Out: the first fault, with the counts that are
//! too few or too many.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | N | – | lines of the encoder; a turn has 4 N counts |
//! | T | s | control cycle |
//! | d, d′ | count | change of the count over this cycle, over the one before |
//! | A | count/s² | fastest change of speed: ramp of the drive, and from the top speed to rest in 50 ms, or 20,000 1/min per s |
//! | r | – | ripple of the speed, 1 % |
//! | D | count | count latched at an index, minus that of the index before |
//!
//! ```text
//! glitch          |d − d′| > 3 + A T² + 2 r |d′|                                     (M70)
//! counts          |D| = 4 N; after a reversal 4 N or 0, to one count                 (M71)
//! missing index   more than 4 N + margin without one, margin = 8 or 4 N / 50, whichever is more
//! ```
//!
//! (M70) predicts that the spindle turns on as in the cycle before. Over one cycle this is much sharper than
//! the prediction of the angle observer (M53), which lags behind a changing speed. The second difference of a
//! rounded angle is less than 2 counts off; the third is to spare. A drive that holds its ramp, a cut that
//! bogs the spindle (3 % in 15 ms is a tenth of A), and one that stops it stay below A; only a collision does
//! not. A slow spindle is stopped in less than 50 ms: 300 N·m stop 0.15 kg m² with 19,100 1/min per s. Two
//! cycles of ripple differ by 2 r |d′| at most, however often a turn it comes.
//!
//! Fewer counts than (M70) sees are found by (M71) at the next index. Counts latched at an index do not
//! depend on the speed, so one count is enough. Having turned back, the spindle meets the index it met last;
//! then a latch may differ by a count, because it comes from the other side. More than half a turn is no way
//! back to the same index.

use machine::Machine;
use protocol::{Fault, Measurement};

/// Time in which a spindle may come to rest from its top speed, s.
const STALL_S: f64 = 0.05;
/// What a load can do to the slowest of spindles, 1/min per s.
const STALL_RPM_S: f64 = 20_000.0;
/// Ripple of the speed that is none of an encoder's faults, a share of the speed.
const RIPPLE: f64 = 0.01;
/// What a rounded angle can do to its second difference, and one count to spare.
const QUANTA: f64 = 3.0;
/// What an index may come late by: so many counts, or this share of a turn.
const MARGIN_COUNTS: i64 = 8;
const MARGIN_SHARE: i64 = 50;

/// What is wrong with the encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncoderFault {
    /// One of the encoder's faults.
    pub fault: Fault,
    /// Counts too many (positive) or too few, in the direction in which the spindle turned; 0 where no number
    /// is known. A glitch is signed as the count is.
    pub counts: i64,
}

/// Supervises the spindle encoder. It finds one fault, and nothing after it.
#[derive(Clone, Debug)]
pub struct Encoder {
    turn: i64,
    margin: i64,
    /// A T², count.
    step: f64,
    seen: Option<Seen>,
    found: Option<EncoderFault>,
}

/// What has been seen so far.
#[derive(Clone, Copy, Debug)]
struct Seen {
    count: i64,
    change: Option<i64>,
    index_number: u64,
    /// Count at the last index.
    index: Option<i64>,
    /// Lowest and highest count since the last index, or since the start.
    low: i64,
    high: i64,
}

impl Encoder {
    /// The encoder of a machine file, not seen yet.
    pub fn new(machine: &Machine) -> Encoder {
        let turn = machine.spindle_counts();
        let stall_rpm_s = (machine.spindle.max_rpm / STALL_S).max(STALL_RPM_S);
        let fastest = (machine.spindle.ramp_rpm_s + stall_rpm_s) / 60.0 * turn;
        Encoder {
            turn: turn as i64,
            margin: MARGIN_COUNTS.max(turn as i64 / MARGIN_SHARE),
            step: fastest * machine.general.cycle_s * machine.general.cycle_s,
            seen: None,
            found: None,
        }
    }

    /// The fault found, if any.
    pub fn fault(&self) -> Option<EncoderFault> {
        self.found
    }

    /// Takes the measurement of one control cycle.
    pub fn update(&mut self, measurement: &Measurement) {
        if self.found.is_some() {
            return;
        }
        let count = measurement.spindle_count;
        let Some(mut seen) = self.seen else {
            let (change, index_number, index) = (None, measurement.index_number, None);
            self.seen = Some(Seen { count, change, index_number, index, low: count, high: count });
            return;
        };
        let change = count.saturating_sub(seen.count);
        let glitch = seen.change.and_then(|before| self.glitch(change, before));
        (seen.count, seen.change) = (count, Some(change));
        (seen.low, seen.high) = (seen.low.min(count), seen.high.max(count));
        let turns = measurement.index_number.saturating_sub(seen.index_number);
        let index = if turns > 0 { self.at_index(&seen, measurement.index_count, turns) } else { None };
        if turns > 0 {
            let at = measurement.index_count;
            (seen.index_number, seen.index) = (measurement.index_number, Some(at));
            (seen.low, seen.high) = (at.min(count), at.max(count));
        }
        self.found = glitch.or(index).or_else(|| self.missing(&seen));
        self.seen = Some(seen);
    }

    /// (M70)
    fn glitch(&self, change: i64, before: i64) -> Option<EncoderFault> {
        let counts = change.saturating_sub(before);
        let possible = QUANTA + self.step + 2.0 * RIPPLE * (before as f64).abs();
        let beyond = counts as f64 > possible || (counts as f64) < -possible;
        beyond.then_some(EncoderFault { fault: Fault::EncoderGlitch, counts })
    }

    /// (M71) at an index that was latched at the count `at`; `turns` is 1 unless a cycle is longer than a
    /// turn.
    fn at_index(&self, seen: &Seen, at: i64, turns: u64) -> Option<EncoderFault> {
        let from = seen.index?;
        let turned = at.saturating_sub(from).saturating_abs();
        let missed = turned.saturating_sub(self.turn.saturating_mul(turns.min(1 << 20) as i64));
        let within = |high: i64, low: i64| high.saturating_sub(low) <= 1;
        let forth = within(seen.high, seen.count) && within(from, seen.low);
        let back = within(seen.count, seen.low) && within(seen.high, from);
        if turned <= 1 {
            return None;
        }
        if forth || back || turned > self.turn / 2 {
            let fault = if missed < 0 { Fault::EncoderPulsesLost } else { Fault::EncoderPulsesGained };
            return (missed != 0).then_some(EncoderFault { fault, counts: missed });
        }
        Some(EncoderFault { fault: Fault::EncoderPlausibility, counts: turned })
    }

    /// Whether an index should have come.
    fn missing(&self, seen: &Seen) -> Option<EncoderFault> {
        let turned = match seen.index {
            Some(index) => seen.high.saturating_sub(index).max(index.saturating_sub(seen.low)),
            None => seen.high.saturating_sub(seen.low),
        };
        (turned > self.turn + self.margin)
            .then_some(EncoderFault { fault: Fault::EncoderIndexMissing, counts: 0 })
    }
}
