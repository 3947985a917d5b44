//! Chords along a way: the fewest points whose straight joins lie within a tolerance of it. In: pieces of a
//! way, one behind the other, from any zero; mm and degrees; how a distance is measured. Out: points on the
//! way, each the end of a chord as long as the tolerance lets it be, and the length of the way under it.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | l | mm | length of the way under a chord |
//! | d | mm | farthest that the way lies from its chord; that of an arc is l²/8R (M44) |
//!
//! From a try, the next is l (δ/d)^½, as d grows with l². Pieces are held only as far as one chord may reach.

use std::collections::VecDeque;

use motion::Path;
use protocol::{Axis, PerAxis, units::AXES};
use shape::{Clock, Drives, Positioner, SeamPath};

/// Most pieces under one chord. On a straight way a chord ends there.
const MOST_PIECES: usize = 64;
/// Places between the ends of what a chord takes of a piece. Between them a way can be 2 % farther away.
const PLACES: u32 = 8;
const BETWEEN: f64 = 0.98;
/// A chord is long enough if it needs this share of the tolerance.
const ENOUGH: f64 = 0.9;
/// Most tries for one chord.
const TRIES: u32 = 12;
/// Directions that differ by less are one, in every axis.
const SMOOTH: f64 = 1e-6;
/// No chord is shorter, mm, whatever the tolerance; but the last of a way may be.
const LEAST_MM: f64 = 1e-4;
/// Most chords of one way.
pub(super) const MOST: u64 = 5_000_000;
/// What is left of a way is nothing below this, mm.
const NOTHING_MM: f64 = 1e-9;

/// A piece of the way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    /// From its start,
    pub(super) path: Path<AXES>,
    /// which is here.
    pub(super) from: PerAxis<f64>,
    /// The parameter along it, where it is one of a trace.
    pub(super) clock: Option<Clock>,
}

/// How the distance of a way from a chord is measured.
#[derive(Clone, Copy, Debug)]
pub(super) enum Measure<'a> {
    /// Between places of the axes.
    Space,
    /// Where the chord leads the beam, from where it is on the seam.
    Beam {
        /// The seam,
        seam: SeamPath<'a>,
        /// on this positioner,
        positioner: Positioner,
        /// under a beam that stands here.
        beam: [f64; 2],
    },
}

impl Piece {
    fn at(&self, s: f64) -> PerAxis<f64> {
        let [gone, ..] = self.path.at(s);
        std::array::from_fn(|i| self.from[i] + gone[i])
    }
}

/// Chords of a way.
#[derive(Clone, Debug)]
pub(super) struct Chords<'a> {
    tolerance_mm: f64,
    measure: Measure<'a>,
    pieces: VecDeque<Piece>,
    /// Where on the first of them the next chord begins, mm.
    start: f64,
    /// Length under the last chord, mm.
    step: f64,
    /// Chords that may still be made; none where one did not lead on.
    left_to_make: u64,
}

impl<'a> Chords<'a> {
    pub(super) fn new(tolerance_mm: f64, measure: Measure<'a>) -> Chords<'a> {
        Chords { tolerance_mm, measure, pieces: VecDeque::new(), start: 0.0, step: 1.0, left_to_make: MOST }
    }

    /// Goes on along `piece`. The ends of chords that are certain now go to `point`.
    pub(super) fn push(&mut self, piece: Piece, point: &mut impl FnMut(&PerAxis<f64>, f64)) {
        let joins = |last: &Piece| last.path.jumps(&piece.path)[0].iter().all(|jump| jump.abs() < SMOOTH);
        if !self.pieces.back().is_some_and(joins) {
            self.finish(point);
        }
        self.pieces.push_back(piece);
        while !self.is_endless() && (self.left() > 2.0 * self.step || self.pieces.len() > MOST_PIECES) {
            let chord = self.chord();
            if chord >= self.left() && self.pieces.len() <= MOST_PIECES {
                break;
            }
            self.advance(chord, point);
        }
    }

    /// The rest of the way, to its very end.
    pub(super) fn finish(&mut self, point: &mut impl FnMut(&PerAxis<f64>, f64)) {
        while !self.is_endless() && self.left() > NOTHING_MM {
            self.advance(self.chord(), point);
        }
        self.pieces.clear();
        self.start = 0.0;
    }

    /// Whether no end of the chords is in sight. None is made then.
    pub(super) fn is_endless(&self) -> bool {
        self.left_to_make == 0
    }

    /// Length of the way that is held, mm.
    fn left(&self) -> f64 {
        self.pieces.iter().map(|piece| piece.path.length()).sum::<f64>() - self.start
    }

    /// Length of the way under the next chord, mm; no more than is held.
    fn chord(&self) -> f64 {
        let left = self.left();
        let wanted = BETWEEN * self.tolerance_mm;
        let (mut length, mut good) = (self.step.min(left), None::<f64>);
        for _ in 0..TRIES {
            let off = self.off(length);
            if off <= wanted {
                good = Some(good.map_or(length, |good| good.max(length)));
                if length >= left || off >= ENOUGH * wanted {
                    break;
                }
            }
            let next = length * libm::sqrt(0.95 * wanted / off).clamp(0.1, 4.0);
            // Between a chord that is good and one that is too long there may be no better one.
            if good.is_some_and(|good| next <= good) {
                break;
            }
            length = next.min(left);
        }
        good.unwrap_or(length).max(LEAST_MM).min(left)
    }

    /// How far the way lies from a chord over `length`, mm.
    fn off(&self, length: f64) -> f64 {
        let Some(first) = self.pieces.front() else { return 0.0 };
        let from = first.at(self.start);
        let to = self.at(length);
        let (mut before, mut most) = (-self.start, 0.0_f64);
        for piece in &self.pieces {
            let low = (-before).max(0.0);
            let high = (length - before).min(piece.path.length());
            if high <= low {
                break;
            }
            for k in 1..=PLACES {
                let s = low + (high - low) * f64::from(k) / f64::from(PLACES);
                most = most.max(self.measure.apart(piece, s, [&from, &to]));
            }
            before += piece.path.length();
        }
        most
    }

    /// The way `length` mm behind its start.
    fn at(&self, length: f64) -> PerAxis<f64> {
        let mut s = self.start + length;
        let mut last = [0.0; AXES];
        for piece in &self.pieces {
            let whole = piece.path.length();
            last = piece.at(s.min(whole));
            if s <= whole {
                break;
            }
            s -= whole;
        }
        last
    }

    /// Ends a chord.
    fn advance(&mut self, length: f64, point: &mut impl FnMut(&PerAxis<f64>, f64)) {
        let start = self.start + length;
        if !(start > self.start && start.is_finite()) {
            self.left_to_make = 0;
            return;
        }
        self.left_to_make = self.left_to_make.saturating_sub(1);
        point(&self.at(length), length);
        self.start = start;
        self.step = length;
        while let Some(first) = self.pieces.front()
            && (self.start > first.path.length()
                || (self.start == first.path.length() && self.pieces.len() > 1))
        {
            self.start -= first.path.length();
            self.pieces.pop_front();
        }
    }
}

impl Measure<'_> {
    /// How far a piece at `s` lies from the chord between two points, mm.
    fn apart(&self, piece: &Piece, s: f64, [from, to]: [&PerAxis<f64>; 2]) -> f64 {
        let at = piece.at(s);
        let along: PerAxis<f64> = std::array::from_fn(|i| to[i] - from[i]);
        let out: PerAxis<f64> = std::array::from_fn(|i| at[i] - from[i]);
        let dot = |a: &PerAxis<f64>, b: &PerAxis<f64>| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let square = dot(&along, &along);
        let share = if square > 0.0 { (dot(&out, &along) / square).clamp(0.0, 1.0) } else { 0.0 };
        let on = |share: f64| -> PerAxis<f64> { std::array::from_fn(|i| from[i] + share * along[i]) };
        match (self, piece.clock) {
            (Measure::Beam { seam, positioner, beam }, Some(clock)) => {
                let point = seam.place(clock.parameter(s))[0].map(|p| p.value());
                let off = |share: f64| {
                    let [x, y, _] = positioner.forward(point, &drives(&on(share)));
                    [x - beam[0], y - beam[1]]
                };
                nearest(off, share)
            }
            _ => {
                let near = on(share);
                let off: PerAxis<f64> = std::array::from_fn(|i| at[i] - near[i]);
                libm::sqrt(dot(&off, &off))
            }
        }
    }
}

/// The drives of a positioner.
fn drives(at: &PerAxis<f64>) -> Drives {
    let [x, y, alpha, beta] = [Axis::X, Axis::Y, Axis::A, Axis::C].map(|axis| at[axis.index()]);
    Drives { x, y, alpha: alpha.to_radians(), beta: beta.to_radians() }
}

/// How near to 0 a way in the plane comes beside `share`: it is straight there but for what is looked for.
fn nearest(off: impl Fn(f64) -> [f64; 2], share: f64) -> f64 {
    const ASIDE: f64 = 1e-3;
    let [[x, y], [further_x, further_y]] = [off(share), off(share + ASIDE)];
    let [u, v] = [(further_x - x) / ASIDE, (further_y - y) / ASIDE];
    let square = u * u + v * v;
    let onwards = if square > 0.0 { -(x * u + y * v) / square } else { 0.0 };
    let [x, y] = off(share + onwards);
    libm::hypot(x, y)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// A line along X from 0, mm.
    fn line(length: f64) -> Option<Piece> {
        let mut end = [0.0; AXES];
        end[0] = length;
        Some(Piece { path: Path::line(end, &[true; AXES])?, from: [0.0; AXES], clock: None })
    }

    #[test]
    fn chords_of_a_way_without_an_end_end() {
        for length in [1e15, 1e150, 1e300, f64::INFINITY] {
            let Some(piece) = line(length) else { continue };
            let (mut chords, mut made) = (Chords::new(1e-3, Measure::Space), 0_u64);
            chords.push(piece, &mut |_, _| made += 1);
            chords.finish(&mut |_, _| made += 1);
            assert!(made <= MOST);
        }
        let (mut chords, mut made) = (Chords::new(1e-3, Measure::Space), 0);
        chords.push(line(100.0).unwrap(), &mut |_, _| made += 1);
        chords.finish(&mut |_, _| made += 1);
        assert!(made > 0 && !chords.is_endless());
    }
}
