//! Where a chain must lead, by the rules of path modes alone: no plan, no time. In: a program. Out: the
//! position of the axes after any way on any block, mm; how far a point is from the programmed path, mm.
//!
//! Beside an arc a junction is rounded over at most half of either element, with half the tolerance and not
//! beyond the room that is left. A corner of lines is rounded as widely as all corners around it allow
//! (M172), but for a fifth of the way to a stop where laws may overlap (M194): no place where several reach
//! may be led away by more than its tolerance. No corner is rounded where a stop is faster (M183).

use crate::programs::{Line, N, end_of};
use crate::stand::{AXES, Seen};
use motion::chain::{Corner, Feed};
use motion::{Blend, Limits, Path, Ramp, junction_distance, reachable_feed};

/// A program with the blend at the end of every block.
pub(crate) struct Rounded<'a> {
    blocks: &'a [Line],
    blends: Vec<Blend<N>>,
    /// How far laws may lead off the contour at the end of every block, mm.
    spares: Vec<f64>,
    /// Way to the end of every block, mm.
    ends: Vec<f64>,
}

impl<'a> Rounded<'a> {
    pub(crate) fn new(blocks: &'a [Line]) -> Rounded<'a> {
        let mut way = 0.0;
        let ends = blocks.iter().map(|block| {
            way += block.path.length();
            way
        });
        let mut path = Rounded { blocks, blends: Vec::new(), spares: Vec::new(), ends: ends.collect() };
        let kinds: Vec<Kind> = blocks.windows(2).map(|pair| kind(&pair[0], &pair[1])).collect();
        let rooms: Vec<f64> = (0..kinds.len()).map(|k| path.room(&kinds, k)).collect();
        path.spares = kinds.iter().map(Kind::spare).collect();
        path.blends = (0..kinds.len()).map(|k| path.blend(&kinds, &rooms, k)).collect();
        path
    }

    /// The position after `s` mm on a block, in the coordinates of the program.
    pub(crate) fn at(&self, number: usize, s: f64) -> [f64; N] {
        let Line { path, tag, .. } = &self.blocks[number];
        let mut p = path.at(s);
        let mut at = 0.0;
        for k in (0..number).rev().take(CORNERS) {
            self.blends[k].add(s - at, &mut p);
            at -= self.blocks[k].path.length();
        }
        let mut at = 0.0;
        for k in (number..self.blends.len()).take(CORNERS) {
            at += self.blocks[k].path.length();
            self.blends[k].add(s - at, &mut p);
        }
        std::array::from_fn(|i| tag.start[i] + p[0][i])
    }

    /// The axes are where the way on their block says, within 1e-9 mm, or beside that by what is left of the
    /// block before: behind a stop, and within the tolerance there.
    pub(crate) fn holds(&self, seen: &Seen) {
        let number = seen.step.tag.number;
        let right = self.at(number, seen.step.along.s);
        let axes = seen.axes.map(|axis| axis.s);
        let off = distance(&right, &axes);
        let spare = number.checked_sub(1).map_or(0.0, |last| self.spares[last]);
        if off <= 1e-9 || spare == 0.0 {
            assert!(off <= 1e-9, "{off} mm beside the path: {seen:?}");
            return;
        }
        let (last, next) = (&self.blocks[number - 1], &self.blocks[number]);
        let [length, ahead] = [last, next].map(|line| line.path.length());
        let tip = next.tag.start;
        let left: [f64; N] = std::array::from_fn(|i| tip[i] + axes[i] - right[i]);
        let (mut near, mut far) = (0.0, length.min(0.25));
        for _ in 0..60 {
            let middle = 0.5 * (near + far);
            *if distance(&self.at(number - 1, length - middle), &tip) < off { &mut near } else { &mut far } =
                middle;
        }
        let beside = distance(&left, &self.at(number - 1, length - near));
        assert!(beside <= 1e-9, "{beside} mm beside what is left of the block before: {seen:?}");
        let foot = |line: &Line, guess: f64| {
            nearest(&line.path, &std::array::from_fn(|i| axes[i] - line.tag.start[i]), guess)
        };
        let contour = foot(last, length - near).min(foot(next, seen.step.along.s.min(ahead)));
        assert!(contour <= spare + 1e-9, "{contour} mm off the contour, {spare} allowed: {seen:?}");
    }
}

fn same_kind(a: Feed, b: Feed) -> bool {
    std::mem::discriminant(&a) == std::mem::discriminant(&b)
}

/// Corners that a blend may reach over on either side, and how far, mm.
const CORNERS: usize = 16;
const REACH: f64 = 4.0;

enum Kind {
    /// How far laws may lead off the contour.
    Stop(f64),
    Fixed(Blend<N>),
    /// Jump, tolerance, no other blend reaches here.
    Corner([f64; N], f64, bool),
}

impl Kind {
    fn spare(&self) -> f64 {
        if let Kind::Stop(spare) = self { *spare } else { 0.0 }
    }
}

/// Whether two lines nearly are one: seen from the start of the first, the tip is near the line to the end.
pub(crate) fn is_flat(last: &Line, next: &Line) -> bool {
    let Corner::Curve { tip, .. } = last.corner else { return false };
    let (to, on) = (end_of(&last.path), end_of(&next.path));
    let past: [f64; N] = std::array::from_fn(|i| to[i] + on[i]);
    let all = distance(&past, &[0.0; N]);
    let along = |way: &[f64; N]| (0..N).map(|i| way[i] * past[i] / all).sum::<f64>();
    let foot = past.map(|x| x / all * along(&to));
    let lines = last.path.is_line() && next.path.is_line();
    lines && along(&to) > 0.0 && along(&on) > 0.0 && distance(&to, &foot) <= tip
}

fn kind(last: &Line, next: &Line) -> Kind {
    let jumps = last.path.jumps(&next.path);
    let turn = distance(&jumps[0], &[0.0; N]);
    let tolerance = match last.corner {
        Corner::Exact(tolerance) if turn <= 1e-3 => tolerance,
        Corner::Blend(tolerance) => tolerance,
        Corner::Curve { flat, .. } if is_flat(last, next) => flat,
        Corner::Curve { corner, .. } => corner,
        Corner::Exact(_) | Corner::Stop => return Kind::Stop(0.0),
    };
    // The chord of 120°.
    if turn > 3_f64.sqrt() || !same_kind(last.feed, next.feed) {
        return Kind::Stop(0.0);
    }
    let (a, b) = (last.path.length(), next.path.length());
    // Pieces of one curve join but for rounding.
    let [_, direction, ..] = next.path.at(0.0);
    let none = |n: usize| 1e-10 * distance(&direction, &[0.0; N]) * a.min(b).powi(-(n as i32));
    let smooth = (0..3).all(|n| distance(&jumps[n], &[0.0; N]) <= none(n));
    let room = last.room.min(next.room);
    if last.path.is_line() && next.path.is_line() {
        let jump = if smooth { [0.0; N] } else { jumps[0] };
        let widest = tolerance / (7.0 / 48.0 * distance(&jump, &[0.0; N]));
        let blend = Blend::new([jump, [0.0; N], [0.0; N]], widest.min(a).min(b).min(REACH));
        let stops = widest < 1e-6_f64.min(a.min(b))
            || is_crawled_through([last, next], &jump, &blend, tolerance.min(room));
        return if stops {
            Kind::Stop(tolerance.min(room))
        } else {
            Kind::Corner(jump, tolerance, room < tolerance)
        };
    }
    if smooth {
        return Kind::Fixed(Blend::NONE);
    }
    let (spare, tolerance, cap) = (tolerance.min(room), (0.5 * tolerance).min(room), 0.5 * a.min(b));
    let half = Blend::half_within(&jumps, tolerance, cap);
    let blend = Blend::new(jumps, half);
    let stops = half < cap.min(1e-6) || is_crawled_through([last, next], &jumps[0], &blend, spare);
    if stops { Kind::Stop(spare) } else { Kind::Fixed(blend) }
}

/// Whether the halves of two blocks beside their corner take longer if it is rounded, at the constant feed
/// that its bends allow, than with a stop in it, at which laws may lead `spare` mm off. A piece stands for a
/// curve of four.
fn is_crawled_through(blocks: [&Line; 2], jump: &[f64; N], blend: &Blend<N>, spare: f64) -> bool {
    if distance(jump, &[0.0; N]) < 0.1 {
        return false;
    }
    let half = blend.half();
    let (shares, peaks) = (blocks.map(|block| block.path.shares()), blend.peaks());
    let bends = blocks.map(|block| block.path.bend());
    let allowed = bends.iter().flat_map(|own| (0..N).map(move |i| (own, i))).map(|(own, i)| {
        let (axis, [second, third, fourth]) = (&AXES[i], [0, 1, 2].map(|n| own[n][i] + peaks[n + 1][i]));
        let by_acceleration = (0.7 * axis.a / second).sqrt();
        let by_jerk = libm::cbrt(0.75 * axis.j / third);
        let by_jerk_rate = (0.75 * axis.dj / fourth).sqrt().sqrt();
        let turned = (peaks[0][i] - 0.5 * jump[i].abs()).max(0.0);
        let by_speed = axis.v / (shares[0][i].max(shares[1][i]) + turned);
        by_speed.min(by_acceleration).min(by_jerk).min(by_jerk_rate)
    });
    let crawl = allowed.fold(f64::INFINITY, f64::min);
    let sides = |crawl: f64, half: f64| {
        blocks.map(|block| {
            let limits = straight(&block.path.shares());
            let top = match block.feed {
                Feed::Rapid => limits.v,
                Feed::PerSecond(feed) | Feed::PerRevolution(_, feed) => feed.min(limits.v),
            };
            let share = if block.path.is_piece() { 2.0 } else { 0.5 };
            let (crawl, length) = (crawl.min(top), share * block.path.length());
            let half = half.min(length);
            let feed = reachable_feed(crawl, top, length - half, &limits);
            let even = (length - half - junction_distance(crawl, feed, &limits)) / feed;
            let slow = if half > 0.0 { half / crawl } else { 0.0 };
            let ramp = Ramp::fastest(feed - crawl, &limits);
            (ramp.duration() + even + slow, ramp)
        })
    };
    let [[(a, _), (b, _)], [(c, down), (d, up)]] = [sides(crawl, half), sides(0.0, 0.0)];
    let curvature: f64 = bends.iter().map(|[second, ..]| distance(second, &[0.0; N])).sum();
    let clear = blocks.map(|block| (0.5 * block.path.length()).min(0.25));
    let alike = spare / (distance(jump, &[0.0; N]) + curvature * clear[0].max(clear[1]));
    let most = reached(&down, clear[0]).min(reached(&up, clear[1]));
    a + b > c + d - most.min(reached(&down, alike) + reached(&up, alike))
}

/// When a ramp from rest has made a way, or its first pulse is over, s.
fn reached(ramp: &Ramp, way: f64) -> f64 {
    let (mut time, mut beyond) = (0.0, ramp.jerk_interval());
    for _ in 0..50 {
        let middle = 0.5 * (time + beyond);
        *if ramp.at(middle).s <= way { &mut time } else { &mut beyond } = middle;
    }
    time
}

/// Limits along a line with these shares of the axes.
fn straight(shares: &[f64; N]) -> Limits {
    let least =
        |limit: fn(&Limits) -> f64| (0..N).map(|i| limit(&AXES[i]) / shares[i]).fold(f64::INFINITY, f64::min);
    Limits {
        v: least(|axis| axis.v),
        a: least(|axis| axis.a),
        j: least(|axis| axis.j),
        dj: least(|axis| axis.dj),
    }
}

impl Rounded<'_> {
    /// The widest that the lines and corners around a corner let its blend be.
    fn widest(&self, k: usize) -> f64 {
        let shorter = self.blocks[k].path.length().min(self.blocks[k + 1].path.length());
        let back = if k < CORNERS { f64::INFINITY } else { self.ends[k] - self.ends[k - CORNERS] };
        let on = self.ends.get(k + CORNERS).map_or(f64::INFINITY, |end| end - self.ends[k]);
        shorter.max(REACH).min(back).min(on)
    }

    /// The corners that a blend at `k` may share a place with, from the nearest.
    fn neighbours<'k>(&self, kinds: &'k [Kind], k: usize) -> Vec<(f64, &'k [f64; N])> {
        let crossed = |j: usize| match &kinds[j] {
            Kind::Corner(jump, _, false) => Some(((self.ends[j] - self.ends[k]).abs(), jump)),
            _ => None,
        };
        let (back, on) = ((0..k).rev().map_while(crossed), (k..kinds.len()).map_while(crossed));
        on.take(CORNERS + 1).chain(back.take(CORNERS)).collect()
    }

    fn room(&self, kinds: &[Kind], k: usize) -> f64 {
        let Kind::Corner(jump, tolerance, false) = &kinds[k] else { return 0.0 };
        let corners = self.neighbours(kinds, k);
        let away = |r: f64| -> f64 {
            let corner = |(way, jump): &(f64, &[f64; N])| {
                let mut p = [[0.0]; 5];
                Blend::new([[1.0], [0.0], [0.0]], r).add(*way, &mut p);
                distance(jump, &[0.0; N]) * p[0][0]
            };
            corners.iter().map(corner).sum()
        };
        let alone = tolerance / (7.0 / 48.0 * distance(jump, &[0.0; N]));
        let most = self.widest(k).min(alone);
        if away(most) <= *tolerance {
            return most;
        }
        let (mut low, mut high) = (most * tolerance / away(most), most);
        for _ in 0..8 {
            let middle = (low * high).sqrt();
            if away(middle) <= *tolerance { low = middle } else { high = middle }
        }
        low
    }

    fn blend(&self, kinds: &[Kind], rooms: &[f64], k: usize) -> Blend<N> {
        let (jump, tolerance, alone) = match &kinds[k] {
            Kind::Stop(_) => return Blend::NONE,
            Kind::Fixed(blend) => return *blend,
            Kind::Corner(jump, tolerance, alone) => (*jump, tolerance, *alone),
        };
        let size = distance(&jump, &[0.0; N]);
        let (a, b) = (self.blocks[k].path.length(), self.blocks[k + 1].path.length());
        let mut half = self.widest(k).min(tolerance / (7.0 / 48.0 * size));
        half = if alone { half.min(a).min(b) } else { half.min(rooms[k]) };
        for j in (0..kinds.len()).filter(|j| *j != k) {
            let share = if kinds[j].spare() > 0.0 { 0.8 } else { 1.0 };
            half = half.min(rooms[j].max(share * (self.ends[j] - self.ends[k]).abs()));
        }
        half = half.min(self.ends[k]).min(self.ends[self.ends.len() - 1] - self.ends[k]);
        if (a - b).abs() <= 1e-3 * a.min(b) {
            let corners = self.ends[k + 1..].iter().map(|end| end - self.ends[k]);
            half = corners.take_while(|way| *way <= half * 1.001).last().unwrap_or(half).min(half);
        }
        if size == 0.0 { Blend::NONE } else { Blend::new([jump, [0.0; N], [0.0; N]], half) }
    }
}

pub(crate) fn distance(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// Distance of a point, seen from the start of a path, from the nearest point of the path near `s`: never
/// less than the true distance, because it is that of a point of the path.
pub(crate) fn nearest(path: &Path<N>, point: &[f64; N], s: f64) -> f64 {
    let clamped = |s: f64| s.clamp(0.0, path.length());
    let mut s = clamped(s);
    for _ in 0..8 {
        // Newton's step to the foot of the perpendicular: (p − x)·p₁ = 0.
        let [p, p1, p2, ..] = path.at(s);
        let dot = |a: &[f64; N], b: &[f64; N]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let off: [f64; N] = std::array::from_fn(|i| p[i] - point[i]);
        let slope = (dot(&p1, &p1) + dot(&off, &p2)).max(0.5);
        s = clamped(s - dot(&off, &p1) / slope);
    }
    distance(&path.at(s)[0], point)
}
