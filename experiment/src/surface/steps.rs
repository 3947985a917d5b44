//! Steps along a work, and how far they miss it. In: a work, a correction, a step of the parameter. Out:
//! deviations in mm, feed in shares of the one that is asked for.
//!
//! | figure | of what |
//! |---|---|
//! | next point | a step that starts on the work: height over the surface where it ends, along Z |
//! | accumulated | steps added up from the first on, each with the ratio of its reference point: the same height |
//! | over a step | distance from the surface, along its normal, on the straight way of a step that starts on the work |
//! | plan | a step that starts on the work: how far aside of the path it ends, seen from above |

use shape::{Correction, FOLLOWERS, leader, master_feed};

use super::work::Work;

/// Places on the way of a step that are looked at.
const PLACES: u32 = 8;

/// Intervals of the midpoint rule in a step: its arc is known to 1e-7 of itself.
const ARC: u32 = 64;

/// Rounds in which a step of the master and the ratios over it are brought together.
const FEED_ROUNDS: u32 = 4;

/// Largest magnitudes over a work, mm.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Misses {
    pub(super) next: f64,
    /// Along the normal.
    pub(super) next_normal: f64,
    pub(super) accumulated: f64,
    pub(super) over_step: f64,
    pub(super) plan: f64,
}

/// One step from a place of the parameter to the next.
pub(super) struct Step {
    from: [f64; 3],
    exact: [f64; 3],
    pub(super) made: [f64; 3],
}

impl Step {
    /// The step of a correction from `t` to `t + h`; X leads or the largest way.
    pub(super) fn of(work: &Work, correction: Correction, t: f64, h: f64, x_leads: bool) -> Step {
        let (from, to) = (work.point(t), work.point(t + h));
        let exact = [0, 1, 2].map(|axis| to[axis] - from[axis]);
        let leader = if x_leads { 0 } else { leader(exact) };
        let mut made = exact;
        let ratios = work.place(t).ratios(leader, correction, exact);
        for (axis, ratio) in FOLLOWERS[leader].into_iter().zip(ratios) {
            made[axis] = ratio * exact[leader];
        }
        Step { from, exact, made }
    }

    /// Where a share of it ends.
    fn at(&self, share: f64) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.from[axis] + share * self.made[axis])
    }

    /// Height over the surface at its end, along Z and along the normal, mm.
    pub(super) fn next(&self, work: &Work) -> [f64; 2] {
        work.over(self.at(1.0))
    }

    fn over_step(&self, work: &Work) -> f64 {
        let shares = (1..=PLACES).map(|n| f64::from(n) / f64::from(PLACES));
        shares.map(|share| work.over(self.at(share))[1].abs()).fold(0.0, f64::max)
    }

    /// Distance of its end from where it has to end, seen from above, across the exact step.
    fn plan(&self) -> f64 {
        let ([x, y, _], [ex, ey, _]) = (self.made, self.exact);
        let length = libm::hypot(ex, ey);
        if length > 0.0 { ((x - ex) * ey - (y - ey) * ex).abs() / length } else { libm::hypot(x, y) }
    }
}

/// Starts of the whole steps of a work.
fn starts(work: &Work, h: f64) -> impl Iterator<Item = f64> {
    let [from, to] = work.text.t;
    let steps = ((to - from) / h + 1e-9).floor() as u32;
    (0..steps).map(move |n| from + h * f64::from(n))
}

/// All steps of a work; the deviation accumulated after each, over the parameter, comes with the largest
/// ones.
pub(super) fn misses(
    work: &Work,
    correction: Correction,
    h: f64,
    x_leads: bool,
) -> (Misses, Vec<(f64, f64)>) {
    let mut most = Misses::default();
    let mut reached = work.point(work.text.t[0]);
    let mut accumulated = Vec::new();
    for t in starts(work, h) {
        let step = Step::of(work, correction, t, h, x_leads);
        reached = [0, 1, 2].map(|axis| reached[axis] + step.made[axis]);
        let off = work.over(reached)[0];
        accumulated.push((t + h, off));
        let [next, normal] = step.next(work);
        most.next = most.next.max(next.abs());
        most.next_normal = most.next_normal.max(normal.abs());
        most.accumulated = most.accumulated.max(off.abs());
        most.over_step = most.over_step.max(step.over_step(work));
        most.plan = most.plan.max(step.plan());
    }
    (most, accumulated)
}

/// Error of the next point over the parameter, mm.
pub(super) fn next_points(work: &Work, correction: Correction, h: f64, x_leads: bool) -> Vec<(f64, f64)> {
    starts(work, h).map(|t| (t, Step::of(work, correction, t, h, x_leads).next(work)[0])).collect()
}

/// Feed along a work, over the parameter: way on the work in a cycle, over the way `l` that is asked for,
/// minus 1. The step of the master is that of M45, with the ratios of the correction over that same step.
pub(super) fn feed(work: &Work, correction: Correction, l: f64, x_leads: bool) -> Vec<(f64, f64)> {
    let [mut t, end] = work.text.t;
    let mut errors = Vec::new();
    loop {
        let place = work.place(t);
        let tangent = place.path.each_ref().map(|axis| axis.derivative(1));
        let leader = if x_leads { 0 } else { leader(tangent) };
        let slope = FOLLOWERS[leader].map(|axis| tangent[axis] / tangent[leader]);
        let mut next = reach(work, t, leader, master_feed(l, slope).copysign(tangent[leader]));
        for _ in 0..FEED_ROUNDS {
            let exact = [0, 1, 2].map(|axis| work.point(next)[axis] - work.point(t)[axis]);
            let ratios = place.ratios(leader, correction, exact);
            next = reach(work, t, leader, master_feed(l, ratios).copysign(tangent[leader]));
        }
        // A step of no way forwards would go on for ever.
        if next >= end || next <= t || !next.is_finite() {
            return errors;
        }
        errors.push((t, arc(work, t, next) / l - 1.0));
        t = next;
    }
}

/// The parameter at which the leader has made a way of `h` from `t` on, by Newton's method.
fn reach(work: &Work, t: f64, leader: usize, h: f64) -> f64 {
    let from = work.point(t)[leader];
    let mut to = t;
    for _ in 0..20 {
        let axis = work.path(to)[leader];
        let missed = from + h - axis.value();
        to += missed / axis.derivative(1);
        if missed.abs() < 1e-13 {
            break;
        }
    }
    to
}

/// Length of the work between two places of its parameter, mm.
fn arc(work: &Work, from: f64, to: f64) -> f64 {
    let speed = |t: f64| {
        let squares = work.path(t).map(|axis| axis.derivative(1) * axis.derivative(1));
        squares.iter().sum::<f64>().sqrt()
    };
    let width = (to - from) / f64::from(ARC);
    let middles = (0..ARC).map(|n| from + width * (f64::from(n) + 0.5));
    middles.map(speed).sum::<f64>() * width
}
