//! The compressor: runs of short lines become pieces of a smooth curve that stays within a tolerance of them.
//! In: lines, end to end, mm, with what the path may do at their corners. Out: the same lines where they stay
//! lines, and pieces of degree 7 by length that join without a jump of their derivatives.
//!
//! | part | holds |
//! |---|---|
//! | `lines.rs` | the lines; where knots go, and where the spline is held (M186) |
//! | `spline.rs` | splines of degree 5 (M185) |
//! | `tube.rs` | the smoothest spline within the tolerance, and the proof that it is (M187, M188) |
//! | `pieces.rs` | pieces of a spline by length |
//!
//! ```text
//! lines: | corner | window: fitted; two thirds leave as pieces | the next window overlaps | corner |
//! ```
//! A run ends at a corner; there the blends of the chain round what is left, or the machine stops. It begins
//! and ends exactly in a point, in whatever direction is smoothest; along its first and last line it keeps
//! half of the tolerance, for the blend there takes the other half.
//!
//! ```text
//! a corner: θ > 2 sin 15°;  or θ > 0.1, 6P < θℓ of the shorter line, θ > 4 θ′ of both neighbours;
//!           or θ > 0.1, 80P < θℓ                                                                   (M189)
//! ```
//! A spline turns within some P/θ, whatever the lines are. Where that is short against them and nothing
//! around turns alike, or very short, what is followed is no curve but a corner, which a stop or a blend
//! passes faster.
//! Lines one behind the other that turn by less than 0.01 from where they begin are one line here, however it
//! was divided.
//!
//! A long run is fitted in windows, so memory is bounded and pieces leave as the lines come. A window goes on
//! from the derivatives of the one before, whose last third it fits again with more of the lines ahead. One
//! that cannot be fitted costs nothing: the one before it is in the tube to its end, and there lines go on.

mod lines;
mod pieces;
mod spline;
mod tube;

use lines::{Lines, less, norm};
use spline::{DEGREE, Knots, Vector};
use tube::Tube;

pub use pieces::Bow;

/// Turns by more are corners: 2 sin 15°. Turns by less than 6° are none,
const CORNER: f64 = 0.517_638_090_205_041_5;
const LEAST_CORNER: f64 = 0.1;
/// and between them those with lines longer than so many P/θ, and by so many times more than both beside
/// them, or with lines so much longer.
const TIGHT: f64 = 6.0;
const VERY_TIGHT: f64 = 80.0;
const ALONE: f64 = 4.0;
/// Lines that turn by less from where they begin are one line of a corner, as far as so many go.
const STRAIGHT: f64 = 0.01;
const PARTS: usize = 16;
/// Share of the tolerance that a spline has in its first and last line: the blend at its end has the other.
const BESIDE: f64 = 0.5;
/// A run has so many lines at least, and is so many tolerances long: blends at its ends reach over a shorter
/// one.
const LINES: usize = 4;
const SHORT: f64 = 40.0;
/// Intervals of a window, of which a third overlaps with the next one.
const WINDOW: usize = 96;
/// Lines after which it is looked whether there are enough for a window, and most lines of one.
const LOOK: usize = 32;
const MOST: usize = 4096;
/// What is tried one after the other: shares of the widths of M186, places in an interval.
const EFFORTS: [(f64, f64); 3] = [(1.0, 3.0), (0.8, 6.0), (0.6, 6.0)];
/// So many intervals at its end are laid out again.
const ENDS: usize = 4;
/// Behind the middle of the overlap a spline is led off the lines by this share of the one before at most.
const SHY: f64 = 0.95;
/// A piece that ends between two lines is so long at least, mm: much shorter ones limit the feed. So a border
/// nearer to that of an interval is there.
const LEAST_MM: f64 = 0.03;
/// Share of a piece in which it may lie on a line that is not one of its own.
const EDGE: f64 = 1e-6;
/// An interval may be wider than the last one of the window before by this.
const WIDER: f64 = 1.3;

/// What the path may do at corners of lines, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leeway {
    /// How far it may lead away from a corner.
    pub corner: f64,
    /// The same where lines nearly go on in one line.
    pub flat: f64,
    /// They do where their corner lies so near to the line past it.
    pub tip: f64,
}

/// What becomes of lines.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // there is one of it at a time
pub enum Course<'a, T> {
    /// A line stays one.
    Line(&'a T),
    /// A piece of a curve.
    Bow {
        /// The piece.
        bow: Bow,
        /// The lines along which it leads.
        over: &'a [T],
    },
}

/// A spline in hand: fitted, and left as pieces up to where the lines in hand begin.
#[derive(Clone, Debug)]
struct Fitted {
    knots: Knots,
    controls: Vec<Vector>,
    /// Intervals that have left, and the place of their end.
    left: usize,
    gone: f64,
    /// How many of the lines in hand it reaches.
    reaches: usize,
}

impl Fitted {
    /// Intervals that a spline which goes on from this one has, too, and of this one those before them.
    fn stays(&self) -> usize {
        self.knots.intervals().saturating_sub(ENDS).max(self.left)
    }

    /// The interval in the middle of those that stay.
    fn middle(&self) -> usize {
        (self.left + self.stays()) / 2
    }

    /// How far off a place on the lines in hand a spline that goes on from this one is led first: as far as
    /// this one, but less and less behind the middle, for it may lie at the wall of the tube.
    fn off(&self, u: f64, line: &Vector) -> Vector {
        let there = u + self.gone;
        let [middle, end] = [self.middle(), self.stays()].map(|k| self.knots.interval(k.max(1) - 1)[1]);
        let share = SHY * (1.0 - ((there - middle) / (end - middle)).clamp(0.0, 1.0));
        if share > 0.0 {
            let point = self.knots.point(self.knots.holding(there), there, &self.controls);
            return core::array::from_fn(|i| share * (point[i] - line[i]));
        }
        [0.0; 3]
    }

    /// The first control points of a spline on these knots that goes on from what has left, as this one does.
    fn known(&self, knots: &Knots) -> Vec<Vector> {
        let end = self.knots.interval(self.left - 1)[1];
        let first = knots.beginning(&self.knots.at(self.left - 1, end, &self.controls));
        // A control point counts over six intervals; all of them must be the same.
        let same = self.left + DEGREE..self.middle().max(self.left + DEGREE);
        first.into_iter().chain(self.controls[same].iter().copied()).collect()
    }
}

/// The turn at a point between two others: how far both directions are apart.
fn turn(from: &Vector, at: &Vector, to: &Vector) -> f64 {
    let [before, behind] = [less(at, from), less(to, at)].map(|way| {
        let length = norm(&way);
        way.map(|x| x / length)
    });
    norm(&less(&behind, &before))
}

/// Takes lines and gives back what becomes of them.
#[derive(Clone, Debug)]
pub struct Compressor<T> {
    leeway: Leeway,
    lines: Lines,
    tags: Vec<T>,
    fitted: Option<Fitted>,
    looked: usize,
    /// Whether a piece ends between two lines.
    apart: fn(&T, &T) -> bool,
    /// The last lines, which nearly are one and wait for what is behind it, each with the turn at its start.
    next: Vec<(Vector, f64, T)>,
    /// Turns at the start and at the end of the one line before, and its length.
    turns: [f64; 2],
    before: f64,
}

impl<T> Compressor<T> {
    /// Nothing in hand; the first line begins at `from`. Where two lines are `apart`, a piece ends between
    /// them.
    #[must_use]
    pub fn new(from: [f64; 3], leeway: Leeway, apart: fn(&T, &T) -> bool) -> Compressor<T> {
        let (lines, tags) = (Lines::new(from, BESIDE * leeway.corner), Vec::new());
        Compressor {
            leeway,
            lines,
            tags,
            fitted: None,
            looked: 0,
            apart,
            next: Vec::new(),
            turns: [0.0; 2],
            before: 0.0,
        }
    }

    /// Whether lines wait.
    #[must_use]
    pub fn holds(&self) -> bool {
        !self.tags.is_empty() || !self.next.is_empty()
    }

    /// A line to a point, which has a length; `out` takes what cannot change any more.
    pub fn add(&mut self, to: [f64; 3], tag: T, out: &mut impl FnMut(Course<'_, T>)) {
        let start = self.lines.last();
        let [ahead, bent] = match &self.next[..] {
            [] => [0.0; 2],
            [(at, ..)] => [turn(&start, at, &to); 2],
            [.., (from, ..), (at, ..)] => [turn(from, at, &to), turn(&start, at, &to)],
        };
        if bent > STRAIGHT || self.next.len() == PARTS {
            self.take(ahead, out);
        }
        self.next.push((to, ahead, tag));
    }

    /// What waits leaves; another line may follow as the first of a run.
    pub fn finish(&mut self, out: &mut impl FnMut(Course<'_, T>)) {
        self.take(0.0, out);
        self.end_run(out);
        self.turns = [0.0; 2];
    }

    /// The lines that wait, behind which the next one turns by `ahead`.
    fn take(&mut self, ahead: f64, out: &mut impl FnMut(Course<'_, T>)) {
        let [behind, turn] = self.turns;
        let length = self.next.last().map_or(0.0, |(end, ..)| norm(&less(end, &self.lines.last())));
        let shorter = self.before.min(length);
        let tight = turn * shorter / self.within(turn, [self.before, length]);
        let alone = tight > TIGHT && turn > ALONE * behind.max(ahead);
        if turn > CORNER || turn > LEAST_CORNER && (alone || tight > VERY_TIGHT) {
            self.end_run(out);
        }
        (self.turns, self.before) = ([turn, ahead], length);
        let mut next = core::mem::take(&mut self.next);
        next.drain(..).for_each(|(to, turn, tag)| self.append(to, turn, tag, out));
        self.next = next;
    }

    /// Another line of the run, with the turn at its start.
    fn append(&mut self, to: Vector, turn: f64, tag: T, out: &mut impl FnMut(Course<'_, T>)) {
        if !self.tags.is_empty() {
            let lengths = [self.lines.length(self.lines.count() - 1), norm(&less(&to, &self.lines.last()))];
            self.lines.widen_last(self.within(turn, lengths));
        }
        self.lines.push(to, BESIDE * self.leeway.corner);
        self.tags.push(tag);
        if self.lines.count() >= self.looked + LOOK {
            self.looked = self.lines.count();
            if self.knots(1.0).len() > WINDOW || self.lines.count() >= MOST {
                self.window(out);
            }
        }
    }

    /// The run in hand leaves.
    fn end_run(&mut self, out: &mut impl FnMut(Course<'_, T>)) {
        while !self.tags.is_empty() {
            let done = self.fitted.as_ref().is_some_and(|fitted| fitted.reaches == self.lines.count());
            let short = self.lines.total() < SHORT * self.leeway.corner;
            let few = self.fitted.is_none() && (short || self.lines.count() < LINES);
            if done {
                self.leave_rest(out);
            } else if few {
                self.leave_lines(self.lines.count(), out);
            } else if let Some(fitted) = self.fit() {
                self.fitted = Some(fitted);
                self.leave_rest(out);
            } else {
                self.give_way(out);
            }
        }
    }

    /// How far the path may lead away from a corner with this turn between lines of these lengths.
    fn within(&self, turn: f64, [before, behind]: [f64; 2]) -> f64 {
        // Twice the area over the line past it.
        let tip = turn * behind * before / (behind + before);
        if tip <= self.leeway.tip { self.leeway.flat } else { self.leeway.corner }
    }

    /// Where the knots go: those of the spline in hand stay but near its end, where it did not know what
    /// follows.
    fn knots(&self, share: f64) -> Vec<f64> {
        let Some(fitted) = &self.fitted else { return self.lines.knots(&[0.0], f64::INFINITY, share) };
        let stays = fitted.stays();
        let known = (fitted.left..stays).map(|k| fitted.knots.interval(k)[1] - fitted.gone);
        let known: Vec<f64> = std::iter::once(0.0).chain(known).collect();
        self.lines.knots(&known, WIDER * fitted.knots.width(stays - 1), share)
    }

    /// Fits a window; two thirds of it leave.
    fn window(&mut self, out: &mut impl FnMut(Course<'_, T>)) {
        self.looked = 0;
        let Some(fitted) = self.fit() else { return self.give_way(out) };
        let leaves = (2 * fitted.knots.intervals()).div_ceil(3);
        self.fitted = Some(fitted);
        self.leave(leaves, out);
    }

    /// A spline along all lines in hand.
    fn fit(&self) -> Option<Fitted> {
        EFFORTS.iter().find_map(|(share, least)| {
            let tube = Tube::new(&self.lines, &self.knots(*share), *least);
            let controls = match &self.fitted {
                None => tube.spline(&[self.lines.at(0, 0.0)], 1, |_, _| [0.0; 3])?,
                Some(before) => {
                    tube.spline(&before.known(&tube.knots), DEGREE, |u, line| before.off(u, line))?
                }
            };
            Some(Fitted { knots: tube.knots, controls, left: 0, gone: 0.0, reaches: self.lines.count() })
        })
    }

    /// What there is cannot be fitted: the spline before goes to its end, or some lines stay lines.
    fn give_way(&mut self, out: &mut impl FnMut(Course<'_, T>)) {
        if self.fitted.is_some() {
            self.leave_rest(out);
        } else {
            self.leave_lines(self.lines.count().div_ceil(4), out);
        }
        self.looked = 0;
    }

    fn leave_rest(&mut self, out: &mut impl FnMut(Course<'_, T>)) {
        let left = self.fitted.as_ref().map_or(0, |fitted| fitted.knots.intervals() - fitted.left);
        self.leave(left, out);
        self.fitted = None;
    }

    /// The first lines leave as they are.
    fn leave_lines(&mut self, count: usize, out: &mut impl FnMut(Course<'_, T>)) {
        self.tags.drain(..count).for_each(|tag| out(Course::Line(&tag)));
        self.lines = self.lines.behind(count, BESIDE * self.leeway.corner);
    }

    /// The next intervals of the spline in hand leave, and the lines along which they lead.
    fn leave(&mut self, count: usize, out: &mut impl FnMut(Course<'_, T>)) {
        let Some(fitted) = &self.fitted else { return };
        for k in fitted.left..fitted.left + count {
            let [mut begin, end] = fitted.knots.interval(k);
            let place = |u: f64| self.lines.holding(u - fitted.gone);
            for line in place(begin)..place(end) {
                let border = self.lines.start(line + 1) + fitted.gone;
                let parts = border - begin > LEAST_MM && end - border > LEAST_MM;
                if parts && (self.apart)(&self.tags[line], &self.tags[line + 1]) {
                    self.pieces(fitted, k, [begin, border], out);
                    begin = border;
                }
            }
            self.pieces(fitted, k, [begin, end], out);
        }
        let Some(fitted) = &mut self.fitted else { return };
        fitted.left += count;
        let first = if fitted.left == fitted.knots.intervals() {
            self.lines = self.lines.behind(fitted.reaches, BESIDE * self.leeway.corner);
            fitted.reaches
        } else {
            let end = fitted.knots.interval(fitted.left - 1)[1];
            let (rest, first) = self.lines.rest(end - fitted.gone);
            (self.lines, fitted.gone) = (rest, end);
            first
        };
        fitted.reaches -= first;
        self.tags.drain(..first);
    }

    /// Pieces of an interval of a spline leave, each with the lines of which it has more than a share of
    /// itself.
    fn pieces(&self, fitted: &Fitted, k: usize, part: [f64; 2], out: &mut impl FnMut(Course<'_, T>)) {
        let place = |u: f64| self.lines.holding(u - fitted.gone);
        pieces::along(&fitted.knots, k, &fitted.controls, part, &mut |bow, [begin, end]| {
            let edge = EDGE * (end - begin);
            out(Course::Bow { bow, over: &self.tags[place(begin + edge)..=place(end - edge)] });
        });
    }
}
