//! What a tap leaves: its own form, at every place where its teeth were. In: where the point of the tap was
//! at an angle of the spindle, mm. Out: places of teeth, at the angles at which they stood.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | P, T | mm, – | pitch of the thread that is asked for; tangents of both flanks together |
//! | d₂ | mm | pitch diameter of the tap |
//! | f, j | – | number of a flute and of a tooth on it, from the point on |
//! | n | – | starts |
//! | x, y | mm | how far the axis of the tap lies beside that of the hole |
//! | τ, u, a | –, mm | taper; distance of a tooth from the point; u where a tapered tap has d₂ |
//!
//! ```text
//! (M228) tooth j of flute f cuts at the angle of f/3 of a turn before: r = d₂/2 + 3 P/(8 T) + x cos (2π f/3)
//!        on a mill, whose tap turns:                          r = d₂/2 + 3 P/(8 T) + x cos C − y sin C
//!        z = z_point + P (j away − frac (n f/3) advance/|advance|);   lower by its chamfer for j < 2½
//! (M263) a tapered tap: r larger by τ (u − a)/2
//! ```
//! The teeth of a flute are a pitch apart, those of the next one a third of a lead on: with several starts
//! that is a tooth of another groove, and what counts is where it lies between two of its neighbours.
//!
//! Nobody tells what a tap is like, so it is a new one of the thread that is asked for: sharp flanks, a flat
//! of P/8, three flutes, a chamfer of two threads and a half, and a pitch diameter a third of the tolerance
//! above the least of the nut, about where a new tap of class 2 lies. A tapered one has the middle of the
//! limits a from its point, which the program has to say, and teeth up to there and some turns on. What the
//! program does is judged by what the teeth leave: a lead that is not that of the tap, taps that do not
//! follow each other, an axis beside that of the spindle.

use std::{collections::BTreeMap, f64::consts::TAU};

use gauge::{Edge, Nominal};
use protocol::{Axis, ThreadPass};

use crate::observe::planned::Planned;

/// Flutes of a tap.
pub(super) const FLUTES: usize = 3;
/// Threads on each flute of a parallel tap; of a tapered one those beyond where it has the diameter of the
/// plane, and the most of all.
const THREADS: usize = 12;
const BEYOND: usize = 6;
const MOST_THREADS: usize = 80;
/// Threads of its chamfer, and those in front of where the teeth of all flutes are whole.
const CHAMFER: f64 = 2.5;
pub(super) const PARTIAL: f64 = CHAMFER + 1.0;
/// Share of the tolerance by which a new tap is larger than the least nut.
const LARGER: f64 = 1.0 / 3.0;

/// A tap in a hole.
#[derive(Clone, Debug)]
pub(super) struct Tap {
    /// Radius of a whole tooth, and what the first one lacks, mm.
    tip_mm: f64,
    chamfer_mm: f64,
    pitch_mm: f64,
    /// 1 where Z grows out of the hole.
    away: f64,
    /// 1 where Z grows with the angle of the spindle.
    grows: f64,
    /// Grooves beside each other.
    starts: f64,
    stations: usize,
    /// Threads on a flute.
    threads: usize,
    /// By how much the radius of a tooth grows with its distance from the point, and that where `tip_mm`
    /// holds, mm.
    taper: [f64; 2],
    /// It turns, and the hole stands: a mill.
    turns: bool,
}

/// Threads on a flute of a tap for a nut.
fn threads(nominal: &Nominal) -> usize {
    let tapered = |mm: f64| ((mm / nominal.pitch_mm).ceil() as usize + BEYOND).min(MOST_THREADS);
    nominal.tap_mm.map_or(THREADS, tapered)
}

/// Places that all teeth have at an angle of the spindle.
pub(super) fn teeth(nominal: &Nominal) -> usize {
    FLUTES * threads(nominal)
}

impl Tap {
    /// The tap of a pass that returns, for a nut; none for anything that no tap cuts, and for a taper of
    /// which nobody says where the tap has its diameter.
    pub(super) fn of(nominal: &Nominal, pass: &ThreadPass, stations: usize, turns: bool) -> Option<Tap> {
        let is_known = nominal.sign() < 0.0 && (nominal.taper == 0.0 || nominal.tap_mm.is_some());
        (pass.returns() && is_known).then(|| {
            let [least, most] = nominal.pitch_diameter_mm;
            let triangle_mm = nominal.pitch_mm / nominal.tangent();
            let larger = if nominal.taper == 0.0 { LARGER } else { 0.5 };
            Tap {
                tip_mm: 0.5 * (least + larger * (most - least)) + 0.375 * triangle_mm,
                chamfer_mm: 0.625 * triangle_mm,
                pitch_mm: nominal.pitch_mm,
                away: -pass.lead_mm.signum(),
                grows: if nominal.grows { 1.0 } else { -1.0 },
                starts: f64::from(nominal.starts),
                stations,
                threads: threads(nominal),
                taper: [0.5 * nominal.taper.abs(), nominal.tap_mm.unwrap_or(0.0)],
                turns,
            }
        })
    }

    /// The edge of one of its teeth.
    pub(super) fn edge(nominal: &Nominal) -> Edge {
        Edge { flank_deg: nominal.flank_deg, flat_mm: 0.125 * nominal.pitch_mm, nose_mm: 0.0 }
    }

    /// What its teeth cut where its point is at an angle of the spindle (M228).
    pub(super) fn cuts(&self, [x, y, z]: [f64; 3], station: usize, mut each: impl FnMut(usize, f64, f64)) {
        for flute in 0..FLUTES {
            let share = flute as f64 / FLUTES as f64;
            let between = (self.starts * share).fract();
            let on = self.away * -self.grows * between;
            let before = (station + self.stations - flute * self.stations / FLUTES) % self.stations;
            let beside = if self.turns {
                let at = TAU * before as f64 / self.stations as f64;
                x * libm::cos(at) - y * libm::sin(at)
            } else {
                x * libm::cos(TAU * share)
            };
            let radius = self.tip_mm + beside;
            for tooth in 0..self.threads {
                let along = self.away * tooth as f64 - self.grows * between;
                let lacks = (1.0 - (tooth as f64 + on) / CHAMFER).clamp(0.0, 1.0) * self.chamfer_mm;
                let [grows, from_mm] = self.taper;
                let wider = grows * (self.pitch_mm * (tooth as f64 + on) - from_mm);
                each(before, radius + wider - lacks, z + self.pitch_mm * along);
            }
        }
    }
}

/// The taps of a mill by the holes that they go into: those that begin within a diameter of each other are in
/// one, which lies where the first of them begins, X and Y.
pub(super) fn holes(
    program: &BTreeMap<u32, Planned>,
    within_mm: f64,
) -> Vec<([f64; 2], BTreeMap<u32, Planned>)> {
    let mut holes: Vec<([f64; 2], BTreeMap<u32, Planned>)> = Vec::new();
    for (number, planned) in program.iter().filter(|(_, planned)| planned.pass.returns()) {
        let [x, y] = [Axis::X, Axis::Y].map(|axis| planned.pass.axis(axis).start.mm());
        let known = holes.iter_mut().find(|(at, _)| libm::hypot(at[0] - x, at[1] - y) < within_mm);
        match known {
            Some((_, passes)) => _ = passes.insert(*number, planned.clone()),
            None => holes.push(([x, y], BTreeMap::from([(*number, planned.clone())]))),
        }
    }
    holes
}
