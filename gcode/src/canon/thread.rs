//! A threading cycle as one call: G76 of LinuxCNC, G76 and G92 of FANUC. Here are the depths of its passes
//! and the moves that LinuxCNC makes of it.
//!
//! ```text
//! (1)  depth of pass n     d_n = max(J n^(1/R), d_(n-1) + m) while that is less than K - f;
//!                          K - f if f > 0; then K, 1 + H times
//! (2)  X at depth d        x0 ± (|I| + d), + inside, - outside
//! (3)  shift of a pass     s = d tan Q, towards the end
//! (4)  along Z             from z0 shifted by s, to the end shifted back by (K - d) tan Q,
//!                          so that the last one ends at the end
//! (5)  chamfer             over E along Z from depth d - K to d, with the lead P hypot(E, K) / E along it
//! (6)  tapered thread      all X grow by T (z - z0) / (ze - z0)
//! ```
//! I crest, J first depth, K full depth, R degression, m least cut, f finishing allowance, H springs, Q angle
//! of the infeed, E chamfer, P lead, T taper.

use std::iter::{repeat_n, successors};

use super::{Call, Pose, X, Z};

/// How the depth grows from pass to pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Degression {
    /// J: depth of the first pass, > 0.
    pub first: f64,
    /// R, ≥ 1: 1 is constant depth, 2 constant area.
    pub exponent: f64,
    /// Least growth of a pass; 0 for none.
    pub least: f64,
    /// What the last cutting pass leaves for one finishing pass; 0 for none.
    pub finish: f64,
}

/// A threading cycle. Lengths in program units, X a radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadCycle {
    /// Where the tool stands: X is the drive line.
    pub from: super::Pose,
    /// Z of the end of the full depth thread.
    pub end_z: f64,
    /// X at the end minus X at the start of the thread: a tapered thread; 0 for a straight one.
    pub taper_x: f64,
    /// Lead along Z, units per revolution, > 0.
    pub lead: f64,
    /// I: drive line to crest; negative for an external thread.
    pub crest: f64,
    /// K: full depth, ≥ first depth.
    pub depth: f64,
    /// The program says where the crest is; else (G92 of FANUC) it is taken to lie half of the way in.
    pub depth_is_told: bool,
    /// Depths of the passes.
    pub degression: Degression,
    /// Q: angle of the infeed, degrees.
    pub infeed_deg: f64,
    /// H: passes at full depth after the last.
    pub springs: u32,
    /// E: length of the tapers at the ends, along Z.
    pub chamfer: f64,
    /// Taper at the start (L1, L3).
    pub chamfer_in: bool,
    /// Taper at the end (L2, L3).
    pub chamfer_out: bool,
    /// A chamfer that X cannot make in its length is as steep as X can make it; else it is an error.
    pub chamfer_yields: bool,
    /// Angle of the spindle at which the thread starts, degrees (FANUC Q); 0 is the index.
    pub start_deg: f64,
}

impl ThreadCycle {
    /// The depths of the passes below the crest, springs included (equation 1).
    ///
    /// Endless if the first depth or the exponent is not greater than 0; G76 refuses both.
    pub fn depths(&self) -> impl Iterator<Item = f64> + use<> {
        let Degression { first, exponent, least, finish } = self.degression;
        let (crest, full) = (self.crest.abs(), self.depth);
        let rough = full - finish;
        let deeper = move |(n, depth): &(f64, f64)| {
            let n = n + 1.0;
            Some((n, (first * libm::pow(n, 1.0 / exponent)).max(depth + least)))
        };
        // Both sides from the drive line: there the last digits decide as they do in LinuxCNC.
        let cuts = successors(Some((1.0, first)), deeper).map(|(_, depth)| depth);
        let cuts = cuts.take_while(move |depth| crest + depth < crest + rough);
        let before_finish = (finish > 0.0).then_some(rough);
        cuts.chain(before_finish).chain(repeat_n(full, self.springs as usize + 1))
    }

    /// The calls that stand for the cycle, one after the other.
    ///
    /// # Errors
    /// The first of `each`; nothing is sent after it.
    pub fn expand<E>(&self, each: &mut impl FnMut(Call<'static>) -> Result<(), E>) -> Result<(), E> {
        for depth in self.depths() {
            self.pass(depth, each)?;
        }
        let mut end = self.from;
        end[Z] = self.end_z;
        each(Call::StraightTraverse(end))
    }

    /// One pass: back to its start, in, along, out.
    fn pass<E>(&self, depth: f64, each: &mut impl FnMut(Call<'static>) -> Result<(), E>) -> Result<(), E> {
        let height = self.depth;
        let (infeed, full) = (self.crest.abs() + depth, height + self.crest.abs());
        let towards = if self.end_z > self.from[Z] { -1.0 } else { 1.0 };
        let slope = libm::tan(towards * self.infeed_deg.to_radians());
        let shift = (infeed - self.crest.abs()) * slope;
        let (start, end) = (self.from[Z] - shift, self.end_z + height * slope - shift);
        let chamfer = towards * self.chamfer;
        let chamfer_lead = self.lead * libm::hypot(self.chamfer, height) / self.chamfer;
        let start_deg = self.start_deg;
        let synch = |lead| Call::StartSpeedFeedSynch { lead, velocity: false, start_deg, growth: 0.0 };

        each(Call::StraightTraverse(self.clear(infeed, full, start)))?;
        if self.chamfer > 0.0 && self.chamfer_in {
            each(Call::EnableFeedOverride(false))?;
            each(synch(chamfer_lead))?;
            each(Call::StraightFeed(self.clear(infeed, height, start)))?;
            each(Call::StraightFeed(self.point(infeed, start - chamfer)))?;
            each(synch(self.lead))?;
        } else {
            each(Call::StraightTraverse(self.point(infeed, start)))?;
            each(Call::EnableFeedOverride(false))?;
            each(synch(self.lead))?;
        }
        if self.chamfer > 0.0 && self.chamfer_out {
            each(Call::StraightFeed(self.point(infeed, end + chamfer)))?;
            each(synch(chamfer_lead))?;
            each(Call::StraightFeed(self.clear(infeed, height, end)))?;
        } else {
            each(Call::StraightFeed(self.point(infeed, end)))?;
        }
        each(Call::StopSpeedFeedSynch)?;
        each(Call::StraightTraverse(self.clear(infeed, full, end)))?;
        each(Call::EnableFeedOverride(true))
    }

    /// `infeed` away from the drive line.
    fn point(&self, infeed: f64, z: f64) -> Pose {
        self.clear(infeed, 0.0, z)
    }

    /// `infeed` away from the drive line, and `back` towards it.
    fn clear(&self, infeed: f64, back: f64, z: f64) -> Pose {
        let outwards = if self.crest > 0.0 { 1.0 } else { -1.0 };
        let mut point = self.from;
        point[X] = point[X] + outwards * infeed - outwards * back;
        if self.taper_x != 0.0 {
            point[X] += self.taper_x * (z - self.from[Z]) / (self.end_z - self.from[Z]);
        }
        point[Z] = z;
        point
    }
}
