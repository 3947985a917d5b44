//! The smoothest spline within a tube around lines. In: lines, knots, control points that are given. Out:
//! control points whose spline lies within the tube everywhere, or none.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | q(u), P(u) | mm | the lines, and how far the spline may lead away from them |
//! | e(u) | mm | x(u) − q(u) |
//! | uₖ, δₖ | mm | places where the spline is held, and their share of the way |
//! | h | mm | width of the interval between knots |
//! | g | – | how firmly the first spline is held in an interval |
//! | νₖ, fₖ | – | weight of the wall at a place; how firmly it holds, from 1 |
//!
//! ```text
//! least ½∫|x⁗|² du  with |e(uₖ)| ≤ R = 0.9 P                                                     (M187)
//! first    x nearest to q:  ½∫|x⁗|² + ½ Σ gδₖ/h⁸ |e|²,  g from 1 up where it is not in the tube
//! then     ½∫|x⁗|² − Σ νₖwₖ log(1 − |e|²/R²),  wₖ = δₖ R²/h⁸,  by steps with the matrix
//!          ∫B⁗B⁗ + Σ fₖνₖwₖ (2/(R² − |e|²) + 4|e|²/(R² − |e|²)²) B B
//! |e| ≤ max(|e(uₖ)|, |e(uₖ₊₁)|) + (uₖ₊₁ − uₖ)²/8 max |x″| ≤ P between two of them                (M188)
//! ```
//! The matrix is that of Newton's step with the curvature of the walls the same in all directions, so the
//! axes share it. A step ends at 0.9 of the way to the nearest wall: after every one of them the spline is in
//! the tube. Where a step would have led through the wall, the place holds the more firmly in the next ones;
//! where not, its wall counts half as much from then on. So one narrow place does not keep the rest from
//! being smooth. Nor would the first spline do with one g for all: near a corner intervals are narrow
//! and 1/h⁸ is large; to be nearer there by a millionth of the tube, it would leave it everywhere else.
//!
//! Since x(u) stays within P of q(u), neither is anywhere farther than P from the other.
//!
//! Source: barrier methods of convex programming; smoothing splines.

use core::ops::Range;

use super::lines::{Held, Lines, dot, less, norm};
use super::spline::{DEGREE, Knots, Row, Vector, weighted};

/// R in P: what is left is for what lies between the places.
const TUBE: f64 = 0.9;
/// Most splines of which one is to be in the tube. As long as none is, every g is so much for the second one,
/// and so much more for the third;
const TRIES: usize = 6;
const NEARER: f64 = 100.0;
/// then that of an interval in which the one before is not, and of those beside it, grows by so much times
/// |e|²/R².
const RISES: f64 = 10.0;
/// The first spline may come so near to a wall.
const INSIDE: f64 = 0.9999;
/// Share of the way to the nearest wall that a step may take.
const SHY: f64 = 0.9;
/// ν at first and at last,
const WALL: [f64; 2] = [0.5, 5e-3];
/// and what it is multiplied by where a step is free.
const FALLS: f64 = 0.5;
/// Where it is not, the wall holds more firmly, by so many times what was too much, and by so much at most.
const FIRMER: f64 = 1.5;
const FIRMEST: f64 = 20.0;
/// Steps at least and at most.
const STEPS: [usize; 2] = [7, 16];
/// A step that is half free and makes the spline smoother by less than this share is the last.
const ENOUGH: f64 = 0.02;

/// A place where the spline is held.
struct Place {
    held: Held,
    interval: usize,
    row: Row,
    target: Vector,
    /// R, and δ/h⁸.
    radius: f64,
    weight: f64,
}

/// The tube around lines, for splines on knots.
pub(super) struct Tube {
    pub(super) knots: Knots,
    places: Vec<Place>,
    /// ∫|x⁗|² as squares: interval, row, weight; the matrix of their sum.
    bending: Vec<(usize, Row, f64)>,
    stiffness: Vec<Row>,
}

impl Tube {
    pub(super) fn new(lines: &Lines, places: &[f64], least: f64) -> Tube {
        let knots = Knots::new(places);
        let held = lines.held(places, least);
        let place = |n: usize| {
            let Held { u, line, within } = held[n];
            let interval = knots.holding(u);
            let [before, after] = [n.max(1) - 1, (n + 1).min(held.len() - 1)].map(|n| held[n].u);
            // A place between two lines or intervals is held as the narrower one asks for.
            let radius = TUBE * within.min(held[n.max(1) - 1].within);
            let weight = 0.5 * (after - before) / knots.width(interval).powi(8);
            let (row, target) = (knots.values(interval, u), lines.at(line, u));
            Place { held: held[n], interval, row, target, radius, weight }
        };
        let bending = (0..knots.intervals()).flat_map(|k| {
            let ([a, b], h) = (knots.fourth(k), knots.width(k));
            let mix = |sign: f64| core::array::from_fn(|m| a[m] + sign * b[m]);
            [(k, mix(1.0), h / 4.0), (k, mix(-1.0), h / 12.0)]
        });
        let (places, bending) = ((0..held.len()).map(place).collect(), bending.collect::<Vec<_>>());
        let mut stiffness = vec![[0.0; DEGREE + 1]; knots.controls()];
        bending.iter().for_each(|(k, row, weight)| stiffen(&mut stiffness, *k, row, *weight));
        Tube { knots, places, bending, stiffness }
    }

    /// Control points of a spline in the tube, the first of them as known; the first `given` of these stay,
    /// and the last point is the end of the lines. `guide` tells how far off the lines it goes at first.
    pub(super) fn spline(
        &self,
        known: &[Vector],
        given: usize,
        guide: impl Fn(f64, &Vector) -> Vector,
    ) -> Option<Vec<Vector>> {
        let count = self.knots.controls();
        let mut controls = vec![self.places.last()?.target; count];
        controls.get_mut(..known.len())?.copy_from_slice(known);
        let off = self.places.iter().map(|place| guide(place.held.u, &place.target)).collect::<Vec<_>>();
        self.follow(&mut controls, &(known.len()..count - 1), &off)?;
        self.relax(&mut controls, &(given..count - 1))?;
        self.holds(&controls).then_some(controls)
    }

    /// The smoothest of the splines nearest to the lines, or so far off them, that lies in the tube.
    fn follow(&self, controls: &mut [Vector], free: &Range<usize>, guides: &[Vector]) -> Option<()> {
        let mut firm = vec![1.0; self.knots.intervals()];
        for n in 0..TRIES {
            let (mut system, _) = self.bent(controls);
            for (place, guide) in self.places.iter().zip(guides) {
                let (off, weight) = (less(&place.off(controls), guide), firm[place.interval] * place.weight);
                system.add(place.interval, &place.row, weight, &off, weight);
            }
            go(controls, &system.solved(free)?, free, 1.0);
            let mut rises = vec![1.0_f64; firm.len()];
            for place in &self.places {
                let off = norm(&place.off(controls)) / place.radius;
                if off >= INSIDE {
                    let around = place.interval.saturating_sub(1)..(place.interval + 2).min(rises.len());
                    rises[around].iter_mut().for_each(|own| *own = own.max(RISES * off * off));
                }
            }
            if rises.iter().all(|rise| *rise == 1.0) {
                return Some(());
            }
            firm.iter_mut().zip(rises).for_each(|(firm, rise)| *firm *= if n < 2 { NEARER } else { rise });
        }
        None
    }

    /// Makes a spline in the tube smoother (M187).
    fn relax(&self, controls: &mut [Vector], free: &Range<usize>) -> Option<()> {
        let wall = Wall { nu: WALL[0], firm: 1.0, off: [0.0; 3], way: [0.0; 3], pull: 0.0, stiff: 0.0 };
        let mut walls = vec![wall; self.places.len()];
        let (mut before, mut share) = (f64::INFINITY, 0.0);
        for step in 0..STEPS[1] {
            let (mut system, bent) = self.bent(controls);
            if step >= STEPS[0] && share > 0.5 && bent > (1.0 - ENOUGH) * before {
                break;
            }
            // One loop for each, so that places do not wait for the divisions of those before them.
            let places = || self.places.iter();
            places().zip(&mut walls).for_each(|(place, wall)| wall.off = place.off(controls));
            places().zip(&mut walls).for_each(|(place, wall)| wall.pulls(place));
            for (place, wall) in places().zip(&walls) {
                system.add(place.interval, &place.row, wall.stiff, &wall.off, wall.pull);
            }
            let step = system.solved(free)?;
            (before, share) = (bent, 1.0);
            places().zip(&mut walls).for_each(|(place, wall)| wall.way = place.sum(&step));
            for (place, wall) in places().zip(&mut walls) {
                let own = SHY * to_wall(&wall.off, &wall.way, place.radius);
                wall.met_at(own);
                share = own.min(share);
            }
            go(controls, &step, free, share);
        }
        Some(())
    }

    /// A system that holds the bending alone; ∫|x⁗|².
    fn bent(&self, controls: &[Vector]) -> (System, f64) {
        let mut system = System { columns: self.stiffness.clone(), sides: vec![[0.0; 3]; controls.len()] };
        let mut sum = 0.0;
        for (k, row, weight) in &self.bending {
            let fourth = weighted(row, &controls[*k..=k + DEGREE]);
            sum += weight * dot(&fourth, &fourth);
            system.pull(*k, row, &fourth, *weight);
        }
        (system, sum)
    }

    /// Whether the spline lies within the tube everywhere (M188).
    fn holds(&self, controls: &[Vector]) -> bool {
        let mut before = norm(&self.places[0].off(controls));
        self.places.windows(2).all(|pair| {
            let here = norm(&pair[1].off(controls));
            let bend = self.knots.second(pair[0].interval, controls).iter().map(norm).fold(0.0, f64::max);
            let apart = pair[1].held.u - pair[0].held.u;
            let most = before.max(here) + 0.125 * apart * apart * bend;
            before = here;
            most <= pair[0].held.within
        })
    }
}

/// ν and f at a place, e there and what a step adds to it; how strongly it pulls back, and how stiff it is.
#[derive(Clone, Copy)]
struct Wall {
    nu: f64,
    firm: f64,
    off: Vector,
    way: Vector,
    pull: f64,
    stiff: f64,
}

impl Wall {
    fn pulls(&mut self, place: &Place) {
        let square = place.radius * place.radius;
        let left = square - dot(&self.off, &self.off);
        self.pull = 2.0 * self.nu * place.weight * square / left;
        self.stiff = self.firm * self.pull * (1.0 + 2.0 * (square - left) / left);
    }

    /// A step may take this share at the place. Nobody can foretell which of both it is: both are computed.
    fn met_at(&mut self, share: f64) {
        let firmer = self.firm * (FIRMER / share).min(FIRMEST);
        let (looser, lower) = ((0.5 * self.firm).max(1.0), (FALLS * self.nu).max(WALL[1]));
        let met = share < 1.0;
        self.firm = if met { firmer } else { looser };
        self.nu = if met { self.nu } else { lower };
    }
}

impl Place {
    /// Σ of control points, or of steps of them, as they count here.
    fn sum(&self, controls: &[Vector]) -> Vector {
        weighted(&self.row, &controls[self.interval..=self.interval + DEGREE])
    }

    /// e.
    fn off(&self, controls: &[Vector]) -> Vector {
        less(&self.sum(controls), &self.target)
    }
}

/// Share of a way at which |off + share way| is the radius.
fn to_wall(off: &Vector, way: &Vector, radius: f64) -> f64 {
    let (a, b) = (dot(way, way), dot(off, way));
    let left = radius * radius - dot(off, off);
    // The larger root of a s² + 2 b s = left, in the form that does not cancel.
    let root = libm::sqrt(b * b + a * left);
    let (above, below) = if b > 0.0 { (left, b + root) } else { (root - b, a) };
    let share = above / below;
    if b > 0.0 || a > 0.0 { share } else { f64::INFINITY }
}

/// Goes a share of a step.
fn go(controls: &mut [Vector], step: &[Vector], free: &Range<usize>, share: f64) {
    for (control, step) in controls[free.clone()].iter_mut().zip(&step[free.clone()]) {
        control.iter_mut().zip(step).for_each(|(control, step)| *control += share * step);
    }
}

/// Adds a square of a row to a matrix.
fn stiffen(columns: &mut [Row], k: usize, row: &Row, stiff: f64) {
    let shares = row.map(|own| stiff * own);
    for (b, column) in columns[k..=k + DEGREE].iter_mut().enumerate() {
        for (own, share) in column.iter_mut().zip(&shares[b..]) {
            *own += share * row[b];
        }
    }
}

/// A symmetric band and a right side for each axis.
struct System {
    /// The diagonal, and what stands below it.
    columns: Vec<Row>,
    sides: Vec<Vector>,
}

impl System {
    /// A square of a row: how stiff it is, where it is off, how strongly it pulls back.
    fn add(&mut self, k: usize, row: &Row, stiff: f64, off: &Vector, pull: f64) {
        stiffen(&mut self.columns, k, row, stiff);
        self.pull(k, row, off, pull);
    }

    fn pull(&mut self, k: usize, row: &Row, off: &Vector, pull: f64) {
        for (side, own) in self.sides[k..=k + DEGREE].iter_mut().zip(row) {
            let share = pull * own;
            side.iter_mut().zip(off).for_each(|(side, off)| *side -= share * off);
        }
    }

    /// The step of the free unknowns, by Cholesky, and 0 of the others; none where the matrix is not
    /// positive.
    fn solved(mut self, free: &Range<usize>) -> Option<Vec<Vector>> {
        // What a column takes off each of those behind it.
        let mut taken = vec![[[0.0; DEGREE + 1]; DEGREE + 1]; self.columns.len()];
        for k in free.clone() {
            let (mut column, mut side) = (self.columns[k], self.sides[k]);
            for m in 1..=DEGREE.min(k - free.start) {
                let (share, known) = (self.columns[k - m][m], self.sides[k - m]);
                column.iter_mut().zip(&taken[k - m][m]).for_each(|(own, taken)| *own -= taken);
                side.iter_mut().zip(known).for_each(|(side, known)| *side -= share * known);
            }
            let pivot = libm::sqrt(column[0]);
            // No number where the matrix is not positive.
            if pivot.is_nan() || pivot == 0.0 {
                return None;
            }
            column[0] = pivot;
            column[1..].iter_mut().for_each(|own| *own /= pivot);
            for m in 1..=DEGREE {
                for n in m..=DEGREE {
                    taken[k][m][n - m] = column[m] * column[n];
                }
            }
            (self.columns[k], self.sides[k]) = (column, side.map(|side| side / pivot));
        }
        for k in free.clone().rev() {
            let (column, mut side) = (&self.columns[k], self.sides[k]);
            for m in (1..=DEGREE).take_while(|m| k + m < free.end) {
                let known = self.sides[k + m];
                side.iter_mut().zip(known).for_each(|(side, known)| *side -= column[m] * known);
            }
            self.sides[k] = side.map(|side| side / column[0]);
        }
        self.sides[..free.start].fill([0.0; 3]);
        self.sides[free.end..].fill([0.0; 3]);
        Some(self.sides)
    }
}
