//! How the angle of the spindle is read: errors of the disc of its encoder, the instant of sampling, the
//! latch at the index. In: true angle in turns and speed in 1/min. Out: the angle that is sampled and the one
//! that is latched, in turns, and by how many counts the disc is ahead.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | q, n | turns, 1/s | true angle, and its speed |
//! | N | – | lines of the encoder |
//! | k, a, phi | –, turns, rad | an error of the disc: how often a turn, size, phase; once a turn it is eccentricity |
//! | d | s | how long before the axes the spindle is sampled |
//! | j, u | s, – | largest jitter of the latch; a number of −1 … 1 that the seed has for each index |
//!
//! ```text
//! count = floor(4 N (p + Σ a sin(2π k p + phi)) + offset),   p = q − d n                        (M113, M115)
//! latched at p = (whole turn) + u j n                                                               (M114)
//! ```
//! The index is a mark of the same disc, so it comes where it comes whatever the disc is off there. It is
//! latched by hardware, not by the sample.

use core::f64::consts::TAU;

use crate::config::SpindleTrain;
use crate::seed::Seed;

/// Seconds of arc in a turn.
const TURN_ARCSEC: f64 = 1_296_000.0;

/// How one encoder is read.
#[derive(Clone, Debug)]
pub(crate) struct Reading {
    errors: Vec<Harmonic>,
    delay_s: f64,
    jitter_s: f64,
    seed: Seed,
}

/// An error that comes back so often a turn.
#[derive(Clone, Copy, Debug)]
struct Harmonic {
    per_turn: f64,
    counts: f64,
    phase: f64,
}

impl Reading {
    /// Of an encoder with so many counts a turn; its phases and its jitter come from the seed.
    pub(crate) fn new(train: &SpindleTrain, counts_per_turn: f64, seed: &Seed) -> Reading {
        let mut phases = seed.branch(0);
        let error = |[per_turn, arcsec]: &[f64; 2]| Harmonic {
            per_turn: *per_turn,
            counts: arcsec / TURN_ARCSEC * counts_per_turn,
            phase: TAU * phases.fraction(),
        };
        Reading {
            errors: train.encoder_error_arcsec.iter().map(error).collect(),
            delay_s: train.encoder_delay_s,
            jitter_s: train.index_jitter_s,
            seed: seed.branch(1),
        }
    }

    /// The angle that is sampled with the axes.
    pub(crate) fn sampled(&self, turns: f64, rpm: f64) -> f64 {
        turns - self.delay_s * (rpm / 60.0)
    }

    /// The angle that is latched at the index of this number, at a whole number of turns.
    pub(crate) fn latched(&self, turn: f64, rpm: f64, number: u64) -> f64 {
        let chance = 2.0 * self.seed.branch(number).fraction() - 1.0;
        turn + chance * self.jitter_s * (rpm / 60.0)
    }

    /// Counts that the disc is ahead at an angle.
    pub(crate) fn ahead(&self, turns: f64) -> f64 {
        let in_turn = turns - turns.floor();
        let error = |error: &Harmonic| error.counts * libm::sin(TAU * error.per_turn * in_turn + error.phase);
        self.errors.iter().map(error).sum()
    }
}
