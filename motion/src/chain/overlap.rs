//! A stop at a corner is no rest: the next law begins before the last one has come to its end, as far as the
//! tolerance of the corner and the limits of the axes allow. In: a law that stops at the end of a block, the
//! sections behind it. Out: the law that follows, and how long both run together.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | τ | s | the overlap; q from its beginning |
//! | r(u) | mm | what is left of the last block at the time u before its end, in the last pulse of jerk |
//! | w(q) | mm | the way on the next block, in the first pulse |
//! | d, e; Δ | – | directions of both blocks at the corner; e − d |
//! | K; R | 1/mm, mm | sum of the curvatures of both blocks; the longest way of an overlap |
//! | x | mm | the larger of w(q), r(u) where they are alike |
//! | h, k | s, rad/s | a step of the overlap, halved where a sum is near its limit; 2π over the duration of the pulse |
//!
//! ```text
//! p(q) = tip + (p of the last block − tip) + (p of the next block − tip)
//! off the contour ≤ x |Δ| + K x R ≤ tolerance                                                    (M194)
//! axis: v = d r′ + e w′,  a = −d r″ + e w″,  j = d r‴ + e w‴,  d = −d r⁗ + e w⁗,  and what the bends add
//! |f| ≤ the larger of both ends of a step + h²/8 max |f″|;  f″ of v, a, j, d: j, d, k d, k² d    (M195)
//! ```
//! Before both ways are alike the machine is off the last block by less than w turned by Δ, behind that off
//! the next one by less than r; then it passes the tip by x Δ. Both laws start and end without acceleration
//! and without jerk, so their sum does. It lies within the box of both blocks: what is left of one shrinks
//! while the way on the other grows, and both speeds grow towards their blocks.

use super::junction::Junction;
use super::law::{ACCURACY, Law};
use super::pieces::Pieces;
use super::span::Span;
use super::zone::{Bend, norm};
use super::{Ask, Chain, SAME};
use crate::feed::FeedBlock;
use crate::limits::Limits;
use crate::path::Path;
use crate::ramp::Ramp;
use crate::sample::Sample;

/// Steps in which an overlap is looked through.
const STEPS: u32 = 16;
/// How often a step is halved, where a sum is near its limit: what is left between is below [`ACCURACY`].
const MOST_HALVINGS: u32 = 7;
/// Shares of the longest overlap that are tried.
const SHARES: u32 = 8;
/// Halvings between the longest share that keeps the limits and the next.
const HALVINGS: u32 = 3;
/// The longest way of an overlap, mm.
const MOST_WAY: f64 = 0.25;
/// An overlap below this, s, is none.
const LEAST_S: f64 = 1e-5;

/// A law that has not come to its end, `time` before which the next one began.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tail {
    pub(super) law: FeedBlock,
    pub(super) time: f64,
}

impl<const N: usize, T: Copy> Chain<N, T> {
    /// The law that follows behind the stop at which that in hand ends, and how long before its end, s, at
    /// most `within` behind now.
    pub(super) fn overlap(&self, ask: &Ask, within: f64) -> Option<(Span, f64)> {
        let Law::Block(last) = &self.law else { return None };
        let left = last.duration() - self.tail.map_or(self.t, |tail| self.t.max(tail.time));
        let pulse = last.decel().jerk_interval();
        if last.end_feed() > 0.0 || ask.single || ask.hold || left - within > pulse {
            return None;
        }
        let (stop, section) = (self.sections.front()?, self.sections.get(1)?);
        let cap = section.cap(&self.ratios);
        if !stop.stops || stop.length - last.length() > SAME || cap <= 0.0 {
            return None;
        }
        let k = self.pieces.ending_at(self.along + last.length())?;
        let tip = Tip::at_end_of(&self.pieces, k)?;
        let next = self.plan(1, 0.0, ask, 0.0)?;
        let time = tip.longest(last.decel(), next.1.accel(), left, &self.settings.axes)?;
        Some((next, time))
    }

    /// Follows a law that begins `time` before the end of that in hand.
    pub(super) fn overtake(&mut self, (count, next): Span, time: f64, ask: &Ask) {
        let Law::Block(last) = self.law else { return };
        let behind = self.sections.len() - 1 - count;
        self.leave(last.length());
        (self.law, self.t) = (Law::Rest, 0.0);
        self.place(0.0);
        // The block that is left is completed when its law has come to its end.
        self.completed -= 1;
        self.follow(next, behind, ask);
        self.tail = Some(Tail { law: last, time });
    }

    /// Forgets the law before when it has come to its end: that completes its block.
    pub(super) fn drop_tail(&mut self) {
        if self.tail.take_if(|tail| self.t >= tail.time).is_some() {
            self.completed += 1;
        }
    }

    /// Where the end of the law before still leads the axes, from where it ends; the block of it.
    pub(super) fn led(&self) -> Option<(T, [Sample; N])> {
        let tail = self.tail?;
        let k = self.pieces.left_last()?;
        let Sample { s, v, a, j, dj } = tail.law.decel().at(tail.time - self.t);
        let piece = &self.pieces.ring[k];
        let length = piece.length();
        let along = Sample { s: length - s, v, a: -a, j, dj: -dj };
        let end = piece.block.path.at(length)[0];
        let mut axes = piece.block.path.follow(&along);
        axes.iter_mut().zip(end).for_each(|(axis, end)| axis.s -= end);
        Some((piece.block.tag, axes))
    }
}

/// A corner at which the machine stops, and what lies around it.
pub(super) struct Tip<const N: usize> {
    /// Directions before it and behind it.
    directions: [[f64; N]; 2],
    bends: [Bend<N>; 2],
    /// How far the axes may be off the contour, mm.
    tolerance: f64,
    /// Ways on both blocks that no blend of another corner reaches, mm.
    clear: [f64; 2],
}

impl<const N: usize> Tip<N> {
    fn at_end_of<T: Copy>(pieces: &Pieces<N, T>, k: usize) -> Option<Tip<N>> {
        let (last, next) = (pieces.ring.get(k)?, pieces.ring.get(k + 1)?);
        let Some(Junction::Stop(tolerance)) = last.junction else { return None };
        if tolerance <= 0.0 {
            return None;
        }
        let ([before, _], [_, behind]) = (pieces.reached(k), pieces.reached(k + 1));
        let clear = [last.length() - before, next.length() - behind];
        Some(Tip::between([&last.block.path, &next.block.path], tolerance, clear))
    }

    /// Between two blocks of which no blend of another corner reaches ways of `clear` mm.
    pub(super) fn between(paths: [&Path<N>; 2], tolerance: f64, clear: [f64; 2]) -> Tip<N> {
        Tip {
            directions: [paths[0].at(paths[0].length())[1], paths[1].at(0.0)[1]],
            bends: paths.map(Bend::of),
            tolerance,
            clear: clear.map(|way| way.min(MOST_WAY)),
        }
    }

    /// The longest overlap of a ramp to rest with one from rest that the tolerance allows (M194), s.
    pub(super) fn most(&self, ramps: [&Ramp; 2]) -> f64 {
        let [d, e] = &self.directions;
        let turn: [f64; N] = core::array::from_fn(|i| e[i] - d[i]);
        let bent: f64 = self.bends.iter().map(|Bend([_, k2, ..])| norm(k2)).sum();
        let alike = self.tolerance / (norm(&turn) + bent * self.clear[0].max(self.clear[1]));
        let until = |k: usize, way: f64| reached(ramps[k], way);
        let alone = until(0, self.clear[0]).min(until(1, self.clear[1]));
        alone.min(until(0, alike) + until(1, alike))
    }

    /// The longest overlap that the limits of the axes allow, too, at most `left`.
    fn longest(&self, down: &Ramp, up: &Ramp, left: f64, axes: &[Limits; N]) -> Option<f64> {
        let ramps = [down, up];
        let most = self.most(ramps).min(left);
        if most <= LEAST_S {
            return None;
        }
        let keeps = |time: f64| self.keeps(ramps, time, axes);
        let share = |k: u32| most * f64::from(k) / f64::from(SHARES);
        let k = (1..=SHARES).rev().find(|k| keeps(share(*k)))?;
        let (mut time, mut beyond) = (share(k), share((k + 1).min(SHARES)));
        for _ in 0..HALVINGS {
            let middle = 0.5 * (time + beyond);
            *if keeps(middle) { &mut time } else { &mut beyond } = middle;
        }
        (time > LEAST_S).then_some(time)
    }

    /// Whether every axis keeps its limits in an overlap of the first pulses of these ramps, the first one
    /// backwards (M195).
    fn keeps(&self, ramps: [&Ramp; 2], time: f64, axes: &[Limits; N]) -> bool {
        let step = time / f64::from(STEPS);
        let peaks = ramps.map(Ramp::peak);
        let ends = [0, 1].map(|k| {
            let Sample { s, v, a, .. } = ramps[k].at(time);
            Sample { s, v, a, j: peaks[k].j, dj: peaks[k].dj }
        });
        let between = peaks.map(|Limits { j, dj, .. }| {
            let rate = if j > 0.0 { 2.0 * dj / j } else { 0.0 };
            [j, dj, dj * rate, dj * rate * rate].map(|most| 0.125 * step * step * most)
        });
        let spare = core::array::from_fn(|i| {
            let added = [0, 1].map(|k| self.bends[k].adds(i, &ends[k]));
            let limits = [axes[i].v, axes[i].a, axes[i].j, axes[i].dj];
            core::array::from_fn(|n| limits[n] * (1.0 + ACCURACY) - added[0][n] - added[1][n])
        });
        let between = core::array::from_fn(|i| {
            let [d, e] = self.directions.map(|direction| direction[i].abs());
            core::array::from_fn(|n| d * between[0][n] + e * between[1][n])
        });
        let stands = |i: usize| {
            let spare: &[f64; 4] = &spare[i];
            self.directions.iter().all(|way| way[i] == 0.0) && spare.iter().all(|spare| *spare >= 0.0)
        };
        let stands = core::array::from_fn(stands);
        let look = Look { directions: &self.directions, ramps, time, spare, between, stands };
        let mut sums = look.at(0.0);
        (1..=STEPS).all(|k| {
            let q = step * f64::from(k);
            let before = core::mem::replace(&mut sums, look.at(q));
            look.keeps([q - step, q], [&before, &sums], 0)
        })
    }
}

/// v, a, j, d of every axis.
type Sums<const N: usize> = [[f64; 4]; N];

/// An overlap that is looked through.
struct Look<'a, const N: usize> {
    directions: &'a [[f64; N]; 2],
    ramps: [&'a Ramp; 2],
    time: f64,
    /// What bends leave of the limits.
    spare: Sums<N>,
    /// h²/8 max |f″| for a whole step.
    between: Sums<N>,
    /// Axes that do not move, and need not be looked at.
    stands: [bool; N],
}

impl<const N: usize> Look<'_, N> {
    fn at(&self, q: f64) -> Sums<N> {
        let (r, w) = (self.ramps[0].at(self.time - q), self.ramps[1].at(q));
        core::array::from_fn(|i| {
            if self.stands[i] {
                return [0.0; 4];
            }
            let [d, e] = self.directions.map(|direction| direction[i]);
            [d * r.v + e * w.v, e * w.a - d * r.a, d * r.j + e * w.j, e * w.dj - d * r.dj]
        })
    }

    /// Whether all sums are kept from one time to another, a step halved `halvings` times.
    fn keeps(&self, times: [f64; 2], sums: [&Sums<N>; 2], halvings: u32) -> bool {
        let share = 0.25_f64.powi(halvings as i32);
        let mut sure = true;
        for (i, (spare, between)) in self.spare.iter().zip(&self.between).enumerate() {
            if self.stands[i] {
                continue;
            }
            for n in 0..4 {
                let most = sums[0][i][n].abs().max(sums[1][i][n].abs());
                if most > spare[n] {
                    return false;
                }
                sure &= most + share * between[n] <= spare[n];
            }
        }
        if sure || halvings == MOST_HALVINGS {
            return sure;
        }
        let middle = 0.5 * (times[0] + times[1]);
        let here = self.at(middle);
        self.keeps([times[0], middle], [sums[0], &here], halvings + 1)
            && self.keeps([middle, times[1]], [&here, sums[1]], halvings + 1)
    }
}

/// Time in which a ramp from rest makes a way, at most its first pulse, s.
fn reached(ramp: &Ramp, way: f64) -> f64 {
    let pulse = ramp.jerk_interval();
    if ramp.at(pulse).s <= way {
        return pulse;
    }
    let (mut time, mut beyond) = (0.0, pulse);
    for _ in 0..20 {
        let middle = 0.5 * (time + beyond);
        *if ramp.at(middle).s <= way { &mut time } else { &mut beyond } = middle;
    }
    time
}

#[cfg(test)]
mod tests {
    use super::{Bend, Tip};
    use crate::chain::SAME;
    use crate::limits::Limits;
    use crate::path::Path;
    use crate::ramp::Ramp;
    use crate::sample::Sample;
    use core::f64::consts::PI;
    use testing::Seed;

    const AXES: [Limits; 2] = [
        Limits { v: 150.0, a: 2000.0, j: 80_000.0, dj: 8.0e6 },
        Limits { v: 200.0, a: 1500.0, j: 100_000.0, dj: 4.0e6 },
    ];
    const CYCLES: u32 = 400;

    fn distance([x, y]: [f64; 2]) -> f64 {
        (x * x + y * y).sqrt()
    }

    /// A line, or an arc, whose direction at its start is `heading`.
    fn path(random: &mut Seed, heading: f64) -> Path<2> {
        let length = random.scale(0.02, 20.0);
        let radius = random.scale(0.3, 100.0);
        if random.chance(0.5) {
            let way = [length * libm::cos(heading), length * libm::sin(heading)];
            return Path::line(way, &[true; 2]).expect("a line");
        }
        let sweep = (length / radius).min(3.0);
        let place = |turn: f64| [radius * libm::sin(turn), -radius * libm::cos(turn)];
        Path::arc([0, 1], place(heading), place(heading + sweep), 1, [0.0; 2], &[true; 2]).expect("an arc")
    }

    /// Largest share of a limit that an axis comes to while both ramps run, how far it is off the nearer
    /// block at most, and how near it comes to the tip, mm.
    fn run(paths: &[Path<2>; 2], ramps: [&Ramp; 2], time: f64) -> [f64; 3] {
        let (mut share, mut off, mut tip) = (0.0_f64, 0.0_f64, f64::INFINITY);
        let length = paths[0].length();
        let end = paths[0].at(length)[0];
        let mut before = [0.0; 2];
        for k in 0..=CYCLES {
            let q = time * f64::from(k) / f64::from(CYCLES);
            let (r, w) = (ramps[0].at(time - q), ramps[1].at(q));
            let last = paths[0].follow(&Sample { s: length - r.s, v: r.v, a: -r.a, j: r.j, dj: -r.dj });
            let next = paths[1].follow(&w);
            let mut at = [0.0; 2];
            for i in 0..2 {
                let Sample { s, v, a, j, dj } = last[i] + next[i];
                at[i] = s - end[i];
                let limits = &AXES[i];
                let shares = [v / limits.v, a / limits.a, j / limits.j, dj / limits.dj];
                share = shares.iter().fold(share, |share, other| share.max(other.abs()));
            }
            // Of the tip from the chord since the last cycle.
            let way = [at[0] - before[0], at[1] - before[1]];
            let foot = -(at[0] * way[0] + at[1] * way[1]) / distance(way).powi(2).max(f64::MIN_POSITIVE);
            let foot = if k == 0 { 0.0 } else { foot.clamp(-1.0, 0.0) };
            tip = tip.min(distance([at[0] + foot * way[0], at[1] + foot * way[1]]));
            before = at;
            let from = |k: usize, s: f64, [x, y]: [f64; 2]| {
                let [p, ..] = paths[k].at(s.clamp(0.0, paths[k].length()));
                distance([at[0] - p[0] + x, at[1] - p[1] + y])
            };
            let steps = (0..=20).map(|step| f64::from(step) / 10.0);
            let nearest = steps
                .map(|share| from(0, length - share * r.s, end).min(from(1, share * w.s, [0.0; 2])))
                .fold(f64::INFINITY, f64::min);
            off = off.max(nearest);
        }
        [share, off, tip]
    }

    /// At corners of lines and arcs, however they lie and however long the ramps are: no axis passes a limit,
    /// and the machine is off the contour and passes the tip within the tolerance.
    #[test]
    fn m195_an_overlap_keeps_the_limits_and_the_tolerance() {
        let (mut overlaps, mut used, mut full) = (0, 0, 0);
        for case in 0..300 {
            let mut random = Seed::of_case(case);
            let heading = random.between(0.0, 2.0 * PI);
            let last = path(&mut random, heading);
            let direction = last.at(last.length())[1];
            let turn = random.between(-PI, PI);
            let next = path(&mut random, libm::atan2(direction[1], direction[0]) + turn);
            let tolerance = random.scale(1e-4, 0.02);
            let paths = [last, next];
            let ramp = |random: &mut Seed, path: &Path<2>| {
                let bend = Bend::of(path);
                let top = bend.limits(&AXES, random.scale(1.0, 100.0), f64::INFINITY);
                let speed = crate::reach::reach(0.0, top.v, 0.5 * path.length(), &top);
                Ramp::fastest(speed, &top)
            };
            let ramps = [ramp(&mut random, &paths[0]), ramp(&mut random, &paths[1])];
            let tip =
                Tip::between([&paths[0], &paths[1]], tolerance, [0, 1].map(|k: usize| paths[k].length()));
            let Some(time) = tip.longest(&ramps[0], &ramps[1], f64::INFINITY, &AXES) else { continue };
            let [share, off, nearest] = run(&paths, [&ramps[0], &ramps[1]], time);
            assert!(share <= 1.0 + SAME, "{share} of a limit in case {case}, overlap {time}");
            assert!(off <= tolerance * (1.0 + SAME), "{off} mm off in case {case}, {tolerance} allowed");
            assert!(nearest <= tolerance * (1.0 + SAME), "{nearest} mm from the tip in case {case}");
            overlaps += 1;
            used += u32::from(nearest > 0.9 * tolerance);
            full += u32::from(share > 0.9);
        }
        assert!(
            overlaps > 250 && used > 5 && full > 100,
            "{overlaps} overlaps, {used} to the tolerance, {full}"
        );
    }
}
