//! What was cut, held against a drawn groove. In: where the point of the tool was each time the spindle
//! went through one of some angles ([`Spot`]), mm. Out: a [`DrawnReport`]: how far the groove strays along
//! its axis and in depth, with reasons where that is more than is allowed.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | C, σ | –, ± | angle of the spindle in turns; 1 where it grows with u (M225) |
//! | φ | – | where the groove lies round the part: mean of C − σ u over all spots as deep as the root |
//! | δ | mm | how far a spot lies beside the groove along the axis |
//! | d | mm | how far it stands above the root of the groove |
//! | t | – | tangent of the flank of the tool |
//!
//! ```text
//! (M226) δ = K(a) wrap(C − σ u(a) − φ),   d = ± (r − r(a − δ));   what widens the groove has |δ| > d t
//! (M227) place: max (|δ| − d t) ≤ within, of spots that reach the root, d ≤ within, max |δ|;
//!        between the means of passes ≤ within;   depth: |min d| ≤ within at every angle of every turn
//! ```
//! Nobody measures where round the part a groove begins, so φ is free; all passes and all pieces of a chain
//! have one. An angle of a turn at which nothing was cut is as shallow as can be.

use core::f64::consts::TAU;
use std::collections::BTreeMap;

use super::{Drawn, DrawnSide};
use crate::judge::Verdict;

/// A place of the point of a tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Number of the pass.
    pub pass: u32,
    /// Number of the angle of the spindle.
    pub station: u32,
    /// Z of the program, mm.
    pub z_mm: f64,
    /// Distance from the axis, mm.
    pub radius_mm: f64,
    /// Tangent of the angle between the flank of the tool and a plane across the axis of the thread.
    pub tangent: f64,
}

/// What was found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawnReport {
    /// Whether it is as drawn.
    pub verdict: Verdict,
    /// What it is not, in words.
    pub reasons: Vec<String>,
    /// Farthest that anything was cut beside the groove along its axis, µm.
    pub place_um: f64,
    /// Least and largest height of the root over that of the drawing, µm.
    pub depth_um: [f64; 2],
    /// By how much it is longer than drawn, by a straight line through all turns, µm.
    pub lead_error_um: f64,
    /// How far the means of passes that reach the root lie apart, µm.
    pub passes_um: f64,
    /// Length that was judged, mm, and turns.
    pub length_mm: f64,
    /// Turns that were judged.
    pub turns: f64,
}

/// A spot beside the drawing.
struct Beside {
    spot: Spot,
    along: f64,
    across: f64,
    turns: f64,
    lead: f64,
    /// C − σ u.
    phase: f64,
}

/// The nearest to 0 of a number of turns and whole ones more or less.
fn wrap(turns: f64) -> f64 {
    turns - libm::round(turns)
}

/// Holds what was cut, seen at so many angles of a turn, against a drawing.
///
/// # Panics
/// If `stations` is 0.
#[must_use]
pub fn judge_drawn(drawn: &Drawn, stations: u32, spots: &[Spot]) -> DrawnReport {
    assert!(stations > 0, "a turn is seen at some angles");
    let [low, high] = drawn.ends_mm();
    let sign = drawn.turns_sign();
    let beside = |spot: &Spot| {
        let [along, across] = match drawn.side {
            DrawnSide::Face => [spot.radius_mm, spot.z_mm],
            _ => [spot.z_mm, spot.radius_mm],
        };
        let (turns, lead) = drawn.turns(along);
        let phase = f64::from(spot.station) / f64::from(stations) - sign * turns;
        (low..=high).contains(&along).then_some(Beside { spot: *spot, along, across, turns, lead, phase })
    };
    let seen: Vec<Beside> = spots.iter().filter_map(beside).collect();
    let total = drawn.turns(high).0;
    let report = DrawnReport { length_mm: high - low, turns: total, ..DrawnReport::default() };
    if seen.is_empty() {
        return report;
    }
    let height = |at: &Beside, along: f64| (at.across - drawn.root_mm(along)) * drawn.out_sign();
    let (mut sine, mut cosine) = (0.0, 0.0);
    for at in seen.iter().filter(|at| height(at, at.along) <= drawn.within_mm) {
        let (s, c) = libm::sincos(TAU * at.phase);
        (sine, cosine) = (sine + s, cosine + c);
    }
    if sine == 0.0 && cosine == 0.0 {
        let least = seen.iter().map(|at| height(at, at.along)).fold(f64::INFINITY, f64::min);
        let reason = format!("it is {:.1} µm too shallow where it is deepest", 1e3 * least);
        let depth_um = [1e3 * least; 2];
        return DrawnReport { verdict: Verdict::Bad, reasons: vec![reason], depth_um, ..report };
    }
    let phase = libm::atan2(sine, cosine) / TAU;
    Held { drawn, stations, seen, phase, total }.judged(report)
}

/// What was cut, where the groove lies round the part being known.
struct Held<'a> {
    drawn: &'a Drawn,
    stations: u32,
    seen: Vec<Beside>,
    phase: f64,
    total: f64,
}

impl Held<'_> {
    /// δ and d of (M226), mm.
    fn off(&self, at: &Beside) -> (f64, f64) {
        let off = at.lead * wrap(at.phase - self.phase);
        // Where a groove lies that is higher by u at the same angle: against the turns of the spindle.
        let off = -off * self.drawn.turns_sign();
        let [low, high] = self.drawn.ends_mm();
        let root = self.drawn.root_mm((at.along - off).clamp(low, high));
        (off, (at.across - root) * self.drawn.out_sign())
    }

    fn judged(&self, report: DrawnReport) -> DrawnReport {
        let within = self.drawn.within_mm;
        let mut passes: BTreeMap<u32, (f64, f64)> = BTreeMap::new();
        let mut cells: BTreeMap<(u32, i64), f64> = BTreeMap::new();
        let (mut place, mut worst) = (0.0, None);
        for at in &self.seen {
            let (off, height) = self.off(at);
            let wide = if height <= within { off.abs() } else { off.abs() - height * at.spot.tangent };
            if wide > place {
                (place, worst) = (wide, Some((at.spot.pass, at.along, off)));
            }
            if height <= within {
                let (n, sum) = passes.entry(at.spot.pass).or_default();
                (*n, *sum) = (*n + 1.0, *sum + off);
            }
            let cell = cells.entry((at.spot.station, self.turn(at))).or_insert(f64::INFINITY);
            *cell = cell.min(height);
        }
        let means = || passes.values().map(|(n, sum)| sum / n);
        let apart = means().fold(f64::NEG_INFINITY, f64::max) - means().fold(f64::INFINITY, f64::min);
        let lead = self.lead_error_mm();
        let (depth, shallow, missing) = self.depth_mm(&cells);
        let mut reasons = Vec::new();
        if let Some((pass, along, off)) = worst.filter(|_| place > within) {
            reasons.push(self.why(place, lead, apart, (pass, along, off)));
        } else if apart > within {
            reasons.push(format!("passes lie {:.1} µm apart", 1e3 * apart));
        }
        if let (Some(along), true) = (missing, place <= within) {
            reasons.push(format!("it is not cut at {}", self.told(along)));
        }
        let at = self.told(shallow);
        if depth[1] > within {
            reasons.push(format!("it is {:.1} µm too shallow at {at}", 1e3 * depth[1]));
        }
        if depth[0] < -within {
            reasons.push(format!("it is {:.1} µm too deep", -1e3 * depth[0]));
        }
        DrawnReport {
            verdict: if reasons.is_empty() { Verdict::Good } else { Verdict::Bad },
            reasons,
            place_um: 1e3 * place,
            depth_um: depth.map(|mm| 1e3 * mm),
            lead_error_um: 1e3 * lead,
            passes_um: 1e3 * apart,
            ..report
        }
    }

    /// Turns beyond the first crossing of an angle: its whole number.
    fn turn(&self, at: &Beside) -> i64 {
        (at.turns - self.first(at.spot.station)).round() as i64
    }

    /// u of the first crossing of an angle.
    fn first(&self, station: u32) -> f64 {
        let turns = self.drawn.turns_sign() * (f64::from(station) / f64::from(self.stations) - self.phase);
        turns - libm::floor(turns)
    }

    /// Least and largest height of the root, where it is the largest, and a place where nothing was cut.
    fn depth_mm(&self, cells: &BTreeMap<(u32, i64), f64>) -> ([f64; 2], f64, Option<f64>) {
        let mut depth = [f64::INFINITY, f64::NEG_INFINITY];
        let [low, high] = self.drawn.ends_mm();
        let (mut shallow, mut missing) = (low, None);
        let along = |turns: f64| {
            let (mut from, mut to) = (low, high);
            for _ in 0..40 {
                let middle = 0.5 * (from + to);
                if self.drawn.turns(middle).0 < turns { from = middle } else { to = middle }
            }
            0.5 * (from + to)
        };
        // A spot that is as far beside the groove as is allowed may lie beyond an end.
        let margin = 2.0 * self.drawn.within_mm / self.drawn.turns(low).1.min(self.drawn.turns(high).1);
        for station in 0..self.stations {
            let first = self.first(station);
            for turn in 0.. {
                let turns = first + turn as f64;
                if turns > self.total - margin {
                    break;
                }
                if turns < margin {
                    continue;
                }
                match cells.get(&(station, turn)) {
                    Some(height) => {
                        if *height > depth[1] {
                            (depth[1], shallow) = (*height, along(turns));
                        }
                        depth[0] = depth[0].min(*height);
                    }
                    None => missing = missing.or_else(|| Some(along(turns))),
                }
            }
        }
        (if depth[0] <= depth[1] { depth } else { [0.0; 2] }, shallow, missing)
    }

    /// By how much all turns together are longer than drawn: least squares of what each pass adds to its
    /// phase over its turns, mm.
    fn lead_error_mm(&self) -> f64 {
        let mut before: BTreeMap<u32, (f64, f64)> = BTreeMap::new();
        let (mut sums, mut lines): (BTreeMap<u32, [f64; 5]>, [f64; 2]) = (BTreeMap::new(), [0.0; 2]);
        for at in self.seen.iter().filter(|at| self.off(at).1 <= self.drawn.within_mm) {
            let (last, whole) = before.get(&at.spot.pass).copied().unwrap_or((at.phase, at.phase));
            let phase = whole + wrap(at.phase - last);
            before.insert(at.spot.pass, (at.phase, phase));
            let sum = sums.entry(at.spot.pass).or_default();
            let (u, e) = (at.turns, phase);
            for (sum, more) in sum.iter_mut().zip([1.0, u, e, u * u, u * e]) {
                *sum += more;
            }
        }
        for [n, u, e, uu, ue] in sums.into_values() {
            lines[0] += uu - u * u / n;
            lines[1] += ue - u * e / n;
        }
        let slope = if lines[0] > 1e-6 { lines[1] / lines[0] } else { 0.0 };
        let [low, high] = self.drawn.ends_mm();
        -slope * self.drawn.turns_sign() * (high - low)
    }

    /// What puts it beside the groove.
    fn why(&self, place: f64, lead: f64, apart: f64, (pass, along, off): (u32, f64, f64)) -> String {
        let [low, high] = self.drawn.ends_mm();
        // What winds the other way gains two turns in each, which is as if it were three times as long.
        if (lead - 2.0 * (high - low)).abs() < 0.2 * (high - low) {
            return "it winds the other way".into();
        }
        if lead.abs() > place {
            let way = if lead > 0.0 { "long" } else { "short" };
            return format!("lead {:.1} µm {way} over {:.1} mm", 1e3 * lead.abs(), high - low);
        }
        let at = self.told(along);
        if apart > place {
            return format!(
                "passes lie {:.1} µm apart: pass {pass} is {:.1} µm beside the groove",
                1e3 * apart,
                1e3 * off
            );
        }
        format!("pass {pass} is {:.1} µm beside the groove at {at}", 1e3 * off)
    }

    /// A place along the axis.
    fn told(&self, along_mm: f64) -> String {
        match self.drawn.on_face() {
            true => format!("diameter {:.2}", 2.0 * along_mm),
            false => format!("Z {along_mm:.2}"),
        }
    }
}
