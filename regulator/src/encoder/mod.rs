//! Supervision of the spindle encoder: what it counts has to be what a spindle can do, and every turn has its
//! index. In: one measurement per control cycle, in counts. Out: the first fault, with the counts that are
//! too few or too many.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | N | – | lines of the encoder; a turn has 4 N counts |
//! | T | s | control cycle |
//! | d, d′, d″ | count | change of the count over this cycle, over the one before, and before that |
//! | A | count/s² | fastest change of speed: ramp of the drive, and from the top speed to rest in 50 ms, or 20,000 1/min per s |
//! | r | – | ripple of the speed, 1 % |
//! | D | count | count latched at an index, minus that of the index before |
//!
//! ```text
//! glitch          |d − d′| > 3 + max(A T² + 2 r |d′|, 3/2 |d′ − d″|)                 (M70)
//! counts          |D| = 4 N; after a reversal 4 N or 0, to one count, to 8 if some are lost (M71)
//! missing index   so many turns and a margin of 8 counts or 4 N / 50 without one, whichever is more
//! stands          in a pass, the same count for as long as the pace p before takes for that margin    (M105)
//! ```
//!
//! (M70) predicts that the spindle turns on as in the cycle before. Over one cycle this is much sharper than
//! the prediction of the angle observer (M53), which lags behind a changing speed. The second difference of a
//! rounded angle is less than 2 counts off; the third is to spare. A drive that holds its ramp, a cut that
//! bogs the spindle (3 % in 15 ms is a tenth of A), and one that stops it stay below A; only a collision does
//! not. A slow spindle is stopped in less than 50 ms: 300 N·m stop 0.15 kg m² with 19,100 1/min per s. Two
//! cycles of ripple differ by 2 r |d′| at most, however often a turn it comes. A spindle that jams goes on as
//! it has begun: its speed may change by half as much again as in the cycle before.
//!
//! Fewer counts than (M70) sees are found by (M71) at the next index, one is enough: counts latched at an
//! index do not depend on the speed. They are corrected there, a sixteenth of a count a cycle, so that no
//! observer swings, as long as the sum over ten turns stays within what is tolerated; beyond it, it is a
//! fault. Where the latch jitters by J, less than 1 + 2 J counts may be nothing: they are corrected once 16
//! indexes in a row have shown them. Having turned back, the spindle meets the index it met last; then a
//! latch may differ by a count: it comes from the other side. Up to 8 counts were lost, or gained, on the
//! way, nobody knows whether forth or back: the index lies where it lay, so the count is corrected to that.
//! More than half a turn is no way back to it.
//!
//! An encoder that dies shows the same count again and again: (M70) sees that in the first cycle of a spindle
//! that turns by more than 3 + A T² counts a cycle. At a lower speed nobody can tell it from a spindle that
//! is jammed; nor after the count has slowed down to less than 70 % of its pace of the last 10 ms: then the
//! spindle is being stopped, and its last step to rest is the hardest. But nobody has to: either way a tool
//! at depth has to leave. So in a pass a count that stands (M105) is a fault, and it is believed: an axis on
//! a lead stands with it. A spindle that its drive brakes has come to rest from a pace below 3 r′ 10 ms, with
//! its ramp r′ in count/s²; that is no fault.
//!
//! A spindle that jams faster than A looks like a glitch at first. It is one that goes on to slow down, cycle
//! by cycle, and then stands: from then on the count is believed again. An encoder that dies stops at once.

mod met;

use machine::Machine;
use protocol::{Fault, Measurement, measurement::middle_of};

use met::{Missed, Seen};

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
/// A change of speed goes on so many times as fast.
const GOES_ON: f64 = 1.5;
/// Time over which the pace is a mean, s; a count that was slower than this share of it was being stopped.
const PACE_S: f64 = 0.01;
const BEING_STOPPED: f64 = 0.7;
/// How much faster than what its ramp leaves in that time a spindle must have been to be taken for stalled.
const STALLED: f64 = 3.0;
/// Cycles after which a count that has slowed down stands for good.
const STANDS: u64 = 3;
/// Turns over which corrections add up.
const TURNS: usize = 10;
/// Indexes in a row that have to show what may be jitter of the latch.
const DOUBTED: i64 = 16;
/// What is corrected in a cycle, count.
const SHARE: f64 = 1.0 / 16.0;

/// What is wrong with the encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncoderFault {
    /// One of the encoder's faults.
    pub fault: Fault,
    /// Counts too many (positive) or too few, in the direction in which the spindle turned; 0 where no number
    /// is known. A glitch is signed as the count is.
    pub counts: i64,
}

/// A count that does not change although the spindle must turn.
const STANDS_STILL: EncoderFault = EncoderFault { fault: Fault::EncoderStands, counts: 0 };

impl EncoderFault {
    /// Whether the angle is still known, but for some counts.
    pub(crate) fn is_minor(&self) -> bool {
        use Fault::{EncoderIndexMissing, EncoderPulsesGained, EncoderPulsesLost};
        matches!(self.fault, EncoderPulsesLost | EncoderPulsesGained | EncoderIndexMissing)
    }

    /// Whether it is a glitch with which the count goes on in the same direction, and slower, given its
    /// change.
    fn is_slower(&self, change: Option<i64>) -> bool {
        let slower = |change: i64| change != 0 && change.signum() == -self.counts.signum();
        self.fault == Fault::EncoderGlitch && change.is_some_and(slower)
    }
}

/// Supervises the spindle encoder. It finds one fault, and nothing after it.
#[derive(Clone, Debug)]
pub struct Encoder {
    turn: i64,
    margin: i64,
    /// A T², count.
    step: f64,
    /// Turns without an index that are let pass.
    blind_turns: f64,
    /// What of a new change goes into the pace; the pace, counts a cycle.
    fresh: f64,
    pace: f64,
    /// The pace when the count moved last; what a ramp to rest leaves of it.
    paced: f64,
    ramped: f64,
    seen: Option<Seen>,
    found: Option<EncoderFault>,
    /// What the count shows too much, as known, and how much of that is taken off.
    slip: i64,
    taken: f64,
    /// Twice the jitter of the latch, control cycles; how many indexes in a row have shown what may be it,
    /// negative for too few counts.
    jitter: f64,
    doubted: i64,
    /// What the last index was latched too high, and not corrected.
    stray: i64,
    /// Corrections of the last turns.
    recent: [i64; TURNS],
    corrected: u32,
    /// Cycles for which the count has stood still.
    still: u64,
    /// Behind a glitch: the spindle slows down, and whether that was seen.
    slows: bool,
    slowed: bool,
    /// A count that stands is that of a spindle that does.
    believed: bool,
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
            blind_turns: machine.threading.index_lost_turns,
            fresh: (machine.general.cycle_s / PACE_S).min(1.0),
            pace: 0.0,
            paced: 0.0,
            ramped: STALLED * machine.spindle.ramp_rpm_s / 60.0 * turn * PACE_S * machine.general.cycle_s,
            seen: None,
            found: None,
            slip: 0,
            taken: 0.0,
            jitter: 2.0 * machine.spindle.index_jitter_s / machine.general.cycle_s,
            doubted: 0,
            stray: 0,
            recent: [0; TURNS],
            corrected: 0,
            still: 0,
            slows: false,
            slowed: false,
            believed: false,
        }
    }

    /// The count of a measurement, corrected.
    pub fn count(&self, measurement: &Measurement) -> i64 {
        measurement.spindle_count.saturating_sub(self.taken.round() as i64)
    }

    /// The middle of that count, corrected smoothly, count.
    pub fn angle(&self, measurement: &Measurement) -> f64 {
        middle_of(measurement.spindle_count) - self.taken
    }

    /// The count latched at the last index of a measurement, corrected.
    pub fn index_count(&self, measurement: &Measurement) -> i64 {
        measurement.index_count.saturating_sub(self.slip).saturating_sub(self.stray)
    }

    /// Counts lost or gained that were corrected so far.
    pub fn corrected(&self) -> u32 {
        self.corrected
    }

    /// Most counts that may be lost or gained within ten turns, where no thread says how much they matter.
    pub fn margin(&self) -> i64 {
        self.margin
    }

    /// Cycles for which the count has stood still.
    pub fn still(&self) -> u64 {
        self.still
    }

    /// Cycles have gone by without a measurement.
    pub fn skip(&mut self) {
        if let Some(seen) = &mut self.seen {
            (seen.change, seen.trend, seen.gap) = (None, 0, true);
        }
        self.still = 0;
    }

    /// Whether the count has nothing to do with the angle any more.
    pub fn is_blind(&self) -> bool {
        let stands = self.still >= STANDS;
        match self.found.map(|found| found.fault) {
            Some(Fault::EncoderGlitch) => !(self.slowed && stands),
            Some(Fault::EncoderStands) => !self.believed,
            _ => false,
        }
    }

    /// The fault found, if any.
    pub fn fault(&self) -> Option<EncoderFault> {
        self.found
    }

    /// Takes the measurement of one control cycle, and whether a pass is in hand; so many counts may be lost
    /// or gained within ten turns.
    pub fn update(&mut self, measurement: &Measurement, tolerated: i64, in_pass: bool) {
        // A count that is off, or has no index, is followed on: what comes then is looked for as before.
        let minor = self.found.filter(|found| found.is_minor());
        if self.found.is_some() && minor.is_none() {
            return self.behind_fault(measurement.spindle_count);
        }
        let count = measurement.spindle_count;
        let Some(mut seen) = self.seen else {
            let (change, index_number, index) = (None, measurement.index_number, None);
            self.seen = Some(Seen {
                count,
                change,
                trend: 0,
                gap: false,
                index_number,
                index,
                low: count,
                high: count,
            });
            return;
        };
        let change = count.saturating_sub(seen.count);
        let glitch = seen.change.and_then(|before| self.glitch(change, before, seen.trend));
        self.still = if change == 0 { self.still + 1 } else { 0 };
        seen.trend = seen.change.map_or(0, |before| change.saturating_sub(before));
        // Behind a gap it is the change of several cycles.
        let of_cycle = (!std::mem::take(&mut seen.gap)).then_some(change);
        if let Some(change) = of_cycle {
            self.pace += self.fresh * (change.saturating_abs() as f64 - self.pace);
        }
        if change != 0 {
            // Counts that come one by one have no pace.
            self.paced = self.pace - self.fresh;
        }
        (seen.count, seen.change) = (count, of_cycle);
        (seen.low, seen.high) = (seen.low.min(count), seen.high.max(count));
        let turns = measurement.index_number.saturating_sub(seen.index_number);
        let index = match turns > 0 && minor.is_none() {
            true => seen.at_index(measurement.index_count, turns, self.turn),
            false => Ok(None),
        };
        if turns > 0 {
            self.stray = 0;
        }
        let index = index.map(|missed| missed.map(|missed| self.believed(missed)));
        if turns > 0 {
            let at = measurement.index_count.saturating_sub(self.stray);
            (seen.index_number, seen.index) = (measurement.index_number, Some(at));
            (seen.low, seen.high) = (at.min(count), at.max(count));
        }
        let index = index.and_then(|missed| missed.map_or(Ok(()), |missed| self.correct(missed, tolerated)));
        let stalled = if in_pass && self.has_stalled() { Some(STANDS_STILL) } else { None };
        self.believed = glitch.is_none();
        self.slows = glitch.is_some_and(|found| found.is_slower(of_cycle));
        self.found = glitch.or(minor).or(index.err()).or(stalled).or_else(|| self.missing(&seen));
        self.taken += (self.slip as f64 - self.taken).clamp(-SHARE, SHARE);
        self.seen = Some(seen);
    }

    /// (M105)
    fn has_stalled(&self) -> bool {
        self.paced > self.ramped && self.still as f64 * self.paced > self.margin as f64
    }

    /// Behind a fault only one thing is looked for: a spindle that goes on to slow down, and stands.
    fn behind_fault(&mut self, count: i64) {
        let Some(seen) = &mut self.seen else { return };
        let change = count.saturating_sub(std::mem::replace(&mut seen.count, count));
        let before = seen.change.replace(change).unwrap_or(0);
        self.still = if change == 0 { self.still + 1 } else { 0 };
        self.slows &=
            change.saturating_abs() <= before.saturating_abs() && change.signum() * before.signum() >= 0;
        self.slowed = self.slows && (self.slowed || change != 0);
    }

    /// Takes counts that were lost or gained into account, unless they are too many.
    fn correct(&mut self, missed: Missed, tolerated: i64) -> Result<(), EncoderFault> {
        let Missed { counts, forward } = missed;
        self.recent.rotate_left(1);
        self.recent[TURNS - 1] = counts;
        if self.recent.iter().sum::<i64>().saturating_abs() > tolerated {
            let fault = if counts < 0 { Fault::EncoderPulsesLost } else { Fault::EncoderPulsesGained };
            return Err(EncoderFault { fault, counts });
        }
        self.slip += if forward { counts } else { -counts };
        self.corrected = self.corrected.saturating_add(counts.unsigned_abs() as u32);
        Ok(())
    }

    /// The counts that are believed to be missing at a new index: what may be jitter, only after a while.
    fn believed(&mut self, missed: Missed) -> Missed {
        let counts = missed.counts;
        let jitter = self.jitter > 0.0 && counts.abs() <= 1 + (self.jitter * self.pace) as i64;
        self.doubted = match jitter && counts != 0 {
            true if self.doubted * counts.signum() > 0 => self.doubted + counts.signum(),
            true => counts.signum(),
            false => 0,
        };
        if self.doubted == 0 || self.doubted.abs() == DOUBTED {
            self.doubted = 0;
            return missed;
        }
        self.stray = if missed.forward { counts } else { -counts };
        Missed { counts: 0, ..missed }
    }

    /// (M70)
    fn glitch(&self, change: i64, before: i64, trend: i64) -> Option<EncoderFault> {
        let counts = change.saturating_sub(before);
        let goes_on =
            if counts.signum() == trend.signum() { GOES_ON * trend.saturating_abs() as f64 } else { 0.0 };
        let possible = QUANTA + goes_on.max(self.step + 2.0 * RIPPLE * (before as f64).abs());
        let beyond = counts as f64 > possible || (counts as f64) < -possible;
        let being_stopped = change == 0 && (before.saturating_abs() as f64) < BEING_STOPPED * self.pace;
        let beyond = beyond && !being_stopped;
        let glitch = EncoderFault { fault: Fault::EncoderGlitch, counts };
        beyond.then_some(if change == 0 { STANDS_STILL } else { glitch })
    }

    /// Whether an index should have come.
    fn missing(&self, seen: &Seen) -> Option<EncoderFault> {
        (seen.turned() as f64 > self.blind_turns * self.turn as f64 + self.margin as f64)
            .then_some(EncoderFault { fault: Fault::EncoderIndexMissing, counts: 0 })
    }
}
