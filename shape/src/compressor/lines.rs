//! Lines that a spline is to follow, where its knots go, and where it is held. In: points in mm, and how far
//! the spline may lead away from each. Out: places along the lines, mm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | u | mm | way along the lines |
//! | θ | – | turn at a point: how far both directions are apart |
//! | ℓ | mm | length of a line; mean of both at a point |
//! | P | mm | how far the spline may lead away there |
//! | h(u) | mm | width of an interval between knots |
//!
//! ```text
//! h ≤ 3 P/θ, ℓ/2.5 θ, 8 mm at a point;  from there it grows by 0.3 of the way                     (M186)
//! ```
//! A spline that follows a turn θ on knots h apart leads away from it by some 0.1 θ h; and an interval holds
//! no more than 0.4 of a turn, so that what it follows is of low degree.

use super::spline::Vector;

/// Widths at a point, in P/θ,
const ROUNDED: f64 = 3.0;
/// in ℓ/θ,
const BENT: f64 = 0.4;
/// and at most, mm.
const WIDEST_MM: f64 = 8.0;
/// What the width gains with the way.
const GAIN: f64 = 0.3;
/// A spline has so many intervals at least.
const LEAST: f64 = 4.0;
/// Between neighbouring places where it is held, the arc of a line with its turns rises by this share of P.
const UNSEEN: f64 = 0.05;
/// Most places in a line for that.
const MOST_HELD: f64 = 32.0;

/// Points, one line after the other.
#[derive(Clone, Debug, Default)]
pub(super) struct Lines {
    points: Vec<Vector>,
    within: Vec<f64>,
    places: Vec<f64>,
}

/// A place where the spline is held.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    /// Way along the lines.
    pub(super) u: f64,
    /// The line on which it lies, or that begins there.
    pub(super) line: usize,
    /// How far the spline may lead away here and on the way to the next place.
    pub(super) within: f64,
}

impl Lines {
    /// From a first point.
    pub(super) fn new(from: Vector, within: f64) -> Lines {
        Lines { points: vec![from], within: vec![within], places: vec![0.0] }
    }

    /// A line on to a point; one without length is none.
    pub(super) fn push(&mut self, to: Vector, within: f64) {
        let length = norm(&less(&to, &self.last()));
        if length == 0.0 {
            return;
        }
        let end = self.total() + length;
        self.points.push(to);
        self.within.push(within);
        self.places.push(end);
    }

    /// How far the spline may lead away from the last point.
    pub(super) fn widen_last(&mut self, within: f64) {
        if let Some(last) = self.within.last_mut() {
            *last = within;
        }
    }

    /// How many lines there are.
    pub(super) fn count(&self) -> usize {
        self.points.len() - 1
    }

    /// The last point.
    pub(super) fn last(&self) -> Vector {
        self.points[self.points.len() - 1]
    }

    /// Length of all.
    pub(super) fn total(&self) -> f64 {
        self.places[self.places.len() - 1]
    }

    /// Where a line begins.
    pub(super) fn start(&self, line: usize) -> f64 {
        self.places[line]
    }

    /// Length of a line.
    pub(super) fn length(&self, line: usize) -> f64 {
        self.places[line + 1] - self.places[line]
    }

    /// Direction of a line.
    pub(super) fn direction(&self, line: usize) -> Vector {
        let length = self.length(line);
        less(&self.points[line + 1], &self.points[line]).map(|way| way / length)
    }

    /// The line that holds a place; of two the earlier one.
    pub(super) fn holding(&self, u: f64) -> usize {
        self.places.partition_point(|place| *place < u).clamp(1, self.count()) - 1
    }

    /// A point on a line.
    pub(super) fn at(&self, line: usize, u: f64) -> Vector {
        let (from, way, s) = (&self.points[line], self.direction(line), u - self.places[line]);
        core::array::from_fn(|i| from[i] + s * way[i])
    }

    /// θ at the start of a line that is not the first.
    fn turn(&self, line: usize) -> f64 {
        norm(&less(&self.direction(line), &self.direction(line - 1)))
    }

    /// How far the spline may lead away from a line.
    fn line_within(&self, line: usize) -> f64 {
        self.within[line].min(self.within[line + 1])
    }

    /// What is left of the lines from a place on, and how many are left behind.
    pub(super) fn rest(&self, u: f64) -> (Lines, usize) {
        // Of two lines that meet there the later one: the rest has no line without length.
        let line = self.places.partition_point(|place| *place <= u).clamp(1, self.count()) - 1;
        let mut rest = Lines::new(self.at(line, u), self.line_within(line));
        rest.extend(self, line);
        (rest, line)
    }

    /// The same behind so many lines, where a spline may begin.
    pub(super) fn behind(&self, count: usize, within: f64) -> Lines {
        let mut rest = Lines::new(self.points[count], within);
        rest.extend(self, count);
        rest
    }

    fn extend(&mut self, lines: &Lines, from: usize) {
        for k in from + 1..lines.points.len() {
            self.push(lines.points[k], lines.within[k]);
        }
    }

    /// Widths asked for at the points (M186); `before`: of the interval before the first point, if there is
    /// one. `share`: of P/θ and ℓ/θ.
    fn widths(&self, before: f64, share: f64) -> Vec<f64> {
        let widest = WIDEST_MM.min(self.total() / LEAST);
        let mut widths = vec![widest; self.points.len()];
        // What a blend at an end may reach is half of an interval: half of a line, then.
        widths[0] = widest.min(before).min(self.length(0));
        widths[self.count()] = widest.min(self.length(self.count() - 1));
        for (k, width) in widths.iter_mut().enumerate().take(self.count()).skip(1) {
            let mean = 0.5 * (self.length(k - 1) + self.length(k));
            let within = self.line_within(k - 1).min(self.line_within(k));
            let asked = share * (ROUNDED * within).min(BENT * mean) / self.turn(k);
            *width = width.min(asked);
        }
        for k in 1..widths.len() {
            widths[k] = widths[k].min(widths[k - 1] + GAIN * self.length(k - 1));
        }
        for k in (0..self.count()).rev() {
            widths[k] = widths[k].min(widths[k + 1] + GAIN * self.length(k));
        }
        widths
    }

    /// Where the knots go (M186) behind those that are `known`, the first of them 0.
    pub(super) fn knots(&self, known: &[f64], before: f64, share: f64) -> Vec<f64> {
        let (widths, total) = (self.widths(before, share), self.total());
        let mut knots = known.to_vec();
        let (mut u, mut line) = (knots[knots.len() - 1], 0);
        loop {
            while self.places[line + 1] < u {
                line += 1;
            }
            let from_start = widths[line] + GAIN * (u - self.places[line]);
            let from_end = widths[line + 1] + GAIN * (self.places[line + 1] - u);
            let width = from_start.min(from_end).min(WIDEST_MM);
            // What is left is one interval, or two alike.
            match total - u {
                left if left <= 1.2 * width => break,
                left if left <= 2.4 * width => u += 0.5 * left,
                _ => u += width,
            }
            knots.push(u);
        }
        knots.push(total);
        knots
    }

    /// Where a spline on knots is held: at points, knots, and between them `least` times in every interval;
    /// more often where a line is long for its turns. The first place is the start, the last one the end.
    pub(super) fn held(&self, knots: &[f64], least: f64) -> Vec<Held> {
        let mut held = Vec::new();
        let (mut line, mut k, mut u) = (0, 0, 0.0);
        while line < self.count() && k + 1 < knots.len() {
            let end = self.places[line + 1].min(knots[k + 1]);
            let (length, within) = (self.length(line), self.line_within(line));
            let turn = |line: usize| if line == 0 || line == self.count() { 0.0 } else { self.turn(line) };
            let rise = length * 0.125 * (turn(line) + turn(line + 1)).min(2.0);
            let in_line = (rise / (UNSEEN * within)).sqrt().min(MOST_HELD) / length;
            let in_interval = least / (knots[k + 1] - knots[k]);
            let count = ((end - u) * in_line.max(in_interval)).ceil().max(1.0);
            for m in 0..count as usize {
                held.push(Held { u: u + (end - u) * m as f64 / count, line, within });
            }
            u = end;
            line += usize::from(self.places[line + 1] <= u);
            k += usize::from(knots[k + 1] <= u);
        }
        held.push(Held { u, line: self.count() - 1, within: self.line_within(self.count() - 1) });
        held
    }
}

pub(super) fn less(a: &Vector, b: &Vector) -> Vector {
    core::array::from_fn(|i| a[i] - b[i])
}

pub(super) fn dot(a: &Vector, b: &Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(super) fn norm(a: &Vector) -> f64 {
    libm::sqrt(dot(a, a))
}
