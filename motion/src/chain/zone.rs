//! Limits of the feed over a stretch of path, from bounds of its derivatives in every axis (M55, M66).
//! In: bounds of |pₙ| in 1/mmⁿ⁻¹, limits of the axes in mm/sⁿ. Out: limits of s in mm/sⁿ.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | k₁ … k₄ | 1/mmⁿ⁻¹ | bounds of \|p₁\| … \|p₄\| of one axis over the stretch |
//! | v | mm/s | a speed, at most that which may be asked for, and what the bends allow |
//! | A′, J′, D′ | mm/sⁿ | what the bends leave of the limits of an axis at that speed |
//! | ε, T | mm, s | chord error of a cycle, its time |
//! | x, f, g | – | how far a pulse of jerk has come, 0 … 1; its acceleration and jerk, as shares of their peaks |
//!
//! ```text
//! v ≤ V/k₁,  v² ≤ 0.7 A/k₂,  v³ ≤ 0.65 J/k₃,  v⁴ ≤ 0.65 D/k₄,  v² ≤ 8 ε/|k₂| T²
//! A′ = A − k₂v²,  J′ = J − k₃v³,  D′ = D − k₄v⁴
//! a ≤ A′/k₁,  3k₂va ≤ 0.8 J′,  e = 3k₂a² + 6k₃v²a ≤ 0.7 D′
//! k₁j ≤ J′ − 0.66 · 3k₂va
//! k₁d ≤ D′ − 0.93 e − 0.57 · 4k₂vj,  4k₂vj ≤ 0.4 D′,  or with e ≤ 0.4 D′ 0.615 and 0.6 for both    (M66)
//! ```
//! What one takes of them the others lose. Of the accelerations in a row, each with the shortest pulse of
//! jerk, j = 2a/t and d = 2πa/t², that is taken whose ramp from rest to v takes least time; then d and j are
//! as large as they may be beside it                                                                (M193)
//!
//! Every term of M55 then fits beside the others, whatever their signs, because their peaks do not come
//! together. Where a pulse of sin² jerk between no acceleration and its peak has come to x,
//!
//! ```text
//! f = x − sin 2πx/2π,  g = sin² πx,  jerk rate |sin 2πx| of its peak
//! η f + γ g ≤ 1              if γ ≤ 1 − 0.66 η, η ≤ 0.8
//! η f + ζ g + δ |sin 2πx| ≤ 1  if δ ≤ 1 − 0.93 η − 0.57 ζ, η ≤ 0.7, ζ ≤ 0.4;
//!                                 or δ ≤ 1 − 0.93 η − 0.615 ζ, η ≤ 0.4, ζ ≤ 0.6                    (M181)
//! ```
//! What γ and δ may be are least values of functions that are linear in η and ζ, so concave; planes that lie
//! below them at the corners lie below them all over. Where an acceleration goes from one sign to the other,
//! |a| is at most f times what it becomes, or 1 − f times what it was.

use core::f64::consts::PI;

use super::SAME;
use super::allowance::Allowance;
use crate::blend::Blend;
use crate::limits::Limits;
use crate::path::Path;
use crate::ramp::Ramp;

/// Share of the acceleration that a bend may take, and of jerk and jerk rate.
const BEND: [f64; 2] = [0.7, 0.65];
/// Share of the jerk that it leaves which the acceleration may take.
const ACCELERATION: f64 = 0.8;
/// How much of the peaks of other terms is left when jerk and jerk rate are at theirs (M181).
const BESIDE_JERK: f64 = 0.66;
const BESIDE_RATE: f64 = 0.93;
/// The same of jerk beside jerk rate, with the shares of the acceleration and of jerk up to which it holds.
const RATES: [Beside; 2] =
    [Beside { jerk: 0.57, even: 0.7, most: 0.4 }, Beside { jerk: 0.615, even: 0.4, most: 0.6 }];
/// Accelerations in a row: the next is less by this factor; how many.
const LESS: f64 = 0.84;
const TRIES: usize = 12;

/// One of the two planes of M181.
#[derive(Clone, Copy)]
struct Beside {
    jerk: f64,
    even: f64,
    most: f64,
}

/// What one axis has for changes of feed at a speed, and what each of them takes of it (M66).
#[derive(Clone, Copy, Default)]
struct Left {
    k1: f64,
    /// A′, J′, D′.
    limits: [f64; 3],
    /// 3k₂v, 3k₂, 6k₃v², 4k₂v.
    terms: [f64; 4],
}

impl Left {
    /// The highest acceleration.
    fn most(&self) -> f64 {
        let [a, j, d] = self.limits;
        let [cross, square, even, _] = self.terms;
        let most = over(a, self.k1).min(over(ACCELERATION * j, cross));
        if square == 0.0 && even == 0.0 {
            return most;
        }
        // 3k₂a² + 6k₃v²a = 0.7 D′: the root of a quadratic.
        let taken = RATES[0].even * d;
        most.min(2.0 * taken / (even + (even * even + 4.0 * square * taken).sqrt()))
    }

    /// Jerk beside an acceleration.
    fn jerk(&self, a: f64) -> f64 {
        over(self.limits[1] - BESIDE_JERK * self.terms[0] * a, self.k1)
    }

    /// What an acceleration leaves of the jerk rate, and the planes that hold beside it.
    fn rate(&self, a: f64) -> (f64, impl Iterator<Item = &'static Beside>) {
        let [_, square, even, _] = self.terms;
        let (taken, whole) = ((square * a + even) * a, self.limits[2]);
        let holds = move |plane: &&Beside| taken <= plane.even * whole * (1.0 + SAME);
        (whole - BESIDE_RATE * taken, RATES.iter().filter(holds))
    }

    /// 1/t of the shortest pulse to an acceleration, 1/s.
    fn pulse(&self, a: f64) -> f64 {
        let (left, planes) = self.rate(a);
        let by_rate = planes.map(|plane| {
            // k₁ 2πa/t² + β 4k₂v 2a/t = what is left.
            let (square, even) = (2.0 * PI * self.k1 * a, plane.jerk * self.terms[3] * 2.0 * a);
            let root = 2.0 * left / (even + (even * even + 4.0 * square * left).sqrt());
            root.min(over(plane.most * self.limits[2], self.terms[3] * 2.0 * a))
        });
        by_rate.fold(0.0, f64::max).min(self.jerk(a) / (2.0 * a))
    }

    /// Jerk rate beside acceleration and jerk.
    fn beside(&self, a: f64, j: f64) -> f64 {
        let (left, planes) = self.rate(a);
        let taken = self.terms[3] * j;
        let holds = |plane: &&Beside| taken <= plane.most * self.limits[2] * (1.0 + SAME);
        planes.filter(holds).map(|plane| over(left - plane.jerk * taken, self.k1)).fold(0.0, f64::max)
    }

    /// Jerk beside acceleration and jerk rate.
    fn under(&self, a: f64, d: f64) -> f64 {
        let (left, planes) = self.rate(a);
        let most = |plane: &Beside| {
            let rest = (left - self.k1 * d) / plane.jerk;
            over(rest.min(plane.most * self.limits[2]), self.terms[3])
        };
        planes.map(most).fold(0.0, f64::max).min(self.jerk(a))
    }
}

/// How often `k` fits into a limit.
fn over(limit: f64, k: f64) -> f64 {
    if k > 0.0 { limit / k } else { f64::INFINITY }
}

fn norm<const N: usize>(k: &[f64; N]) -> f64 {
    k.iter().map(|k| k * k).sum::<f64>().sqrt()
}

/// Bounds of |p₁| … |p₄| of every axis over a stretch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bend<const N: usize>(pub(super) [[f64; N]; 4]);

impl<const N: usize> Bend<N> {
    /// Of a path by itself.
    pub(crate) fn of(path: &Path<N>) -> Bend<N> {
        let [second, third, fourth] = path.bend();
        Bend([path.shares(), second, third, fourth])
    }

    /// With what a blend adds; `other` are the shares on the far side of its junction.
    pub(super) fn with(mut self, blend: &Blend<N>, other: &[f64; N]) -> Bend<N> {
        if blend.half() <= 0.0 {
            return self;
        }
        let [turn, peaks @ ..] = blend.peaks();
        let [shares, own @ ..] = &mut self.0;
        for i in 0..N {
            // A corner alone turns p₁ between both directions; jumps of curvature add to it, and so does the
            // bend of the path: at x from the corner the first has come to |Δ₁|/2 (1 − x/r) at most, and what p₁
            // was at the corner has changed by k₂x.
            let corner = 0.5 * blend.corner()[i].abs();
            let beyond = (turn[i] - corner).max(0.0);
            let bent = corner.min(0.125 * own[0][i] * blend.half());
            shares[i] = shares[i].max(other[i]) + beyond + bent;
        }
        for (own, peaks) in own.iter_mut().zip(&peaks) {
            own.iter_mut().zip(peaks).for_each(|(own, peak)| *own += peak);
        }
        self
    }

    /// Limits of s at every speed (M66, M179); `asked` is the highest feed that can be asked for, `chord_v2`
    /// = 8 ε/T².
    pub(super) fn allowance(&self, axes: &[Limits; N], asked: f64, chord_v2: f64) -> Allowance {
        let v = self.top(axes, asked, chord_v2);
        if self.0[1..].iter().flatten().all(|k| *k == 0.0) {
            return Allowance::flat(&self.left(axes, v));
        }
        Allowance::new(v, |v| self.left(axes, v))
    }

    /// Limits of s up to its highest speed (M66).
    pub(crate) fn limits(&self, axes: &[Limits; N], asked: f64, chord_v2: f64) -> Limits {
        self.left(axes, self.top(axes, asked, chord_v2))
    }

    /// The highest speed (M66).
    pub(super) fn top(&self, axes: &[Limits; N], asked: f64, chord_v2: f64) -> f64 {
        let Bend([k1, k2, k3, k4]) = self;
        let mut v = asked;
        for (i, axis) in axes.iter().enumerate() {
            v = v.min(over(axis.v, k1[i]));
            if k2[i] > 0.0 || k3[i] > 0.0 {
                v = v
                    .min(over(BEND[0] * axis.a, k2[i]).sqrt())
                    .min(libm::cbrt(over(BEND[1] * axis.j, k3[i])))
                    .min(over(BEND[1] * axis.dj, k4[i]).sqrt().sqrt());
            }
        }
        v.min(over(chord_v2, norm(k2)).sqrt())
    }

    /// What the bends leave at a speed up to the highest one (M66, M193).
    fn left(&self, axes: &[Limits; N], v: f64) -> Limits {
        let Bend([k1, k2, k3, k4]) = self;
        let v2 = v * v;
        let mut left = [Left::default(); N];
        let mut moving = 0;
        for i in (0..N).filter(|i| k1[*i] > 0.0 || k2[*i] > 0.0) {
            let Limits { a, j, dj, .. } = axes[i];
            left[moving] = Left {
                k1: k1[i],
                limits: [a - k2[i] * v2, j - k3[i] * v2 * v, dj - k4[i] * v2 * v2],
                terms: [3.0 * k2[i] * v, 3.0 * k2[i], 6.0 * k3[i] * v2, 4.0 * k2[i] * v],
            };
            moving += 1;
        }
        let left = &left[..moving];
        let least = |of: &dyn Fn(&Left) -> f64| left.iter().map(of).fold(f64::INFINITY, f64::min);
        let most = least(&Left::most);
        let (mut best, mut time) =
            (Limits { v, a: most, j: f64::INFINITY, dj: f64::INFINITY }, f64::INFINITY);
        let bends = left.iter().any(|axis| axis.terms.iter().any(|term| *term > 0.0));
        let mut a = most;
        for _ in 0..if bends { TRIES } else { 0 } {
            let pulse = least(&|axis| axis.pulse(a));
            let there = Limits { v, a, j: 2.0 * a * pulse, dj: 2.0 * PI * a * pulse * pulse };
            let takes = if pulse > 0.0 { Ramp::shortest(v, &there) } else { f64::INFINITY };
            if takes > time {
                break;
            }
            (best, time, a) = (there, takes, a * LESS);
        }
        if time < f64::INFINITY {
            best.dj = least(&|axis| axis.beside(best.a, best.j)).max(best.dj);
            best.j = least(&|axis| axis.under(best.a, best.dj)).max(best.j);
        } else {
            best.j = least(&|axis| axis.jerk(most));
            best.dj = least(&|axis| axis.beside(most, best.j));
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::{ACCELERATION, BESIDE_JERK, BESIDE_RATE, Bend, RATES, SAME};
    use crate::blend::Blend;
    use crate::limits::Limits;
    use crate::path::Path;
    use core::f64::consts::PI;
    use testing::Seed;

    /// Acceleration, jerk and jerk rate of a pulse that has come to x, as shares of their peaks.
    fn pulse(x: f64) -> [f64; 3] {
        let (sin, cos) = libm::sincos(PI * x);
        [x - sin * cos / PI, sin * sin, (2.0 * sin * cos).abs()]
    }

    /// Beside the peaks of any pulse, at the corners of what M181 holds for, and within.
    #[test]
    fn m181_peaks_of_a_pulse_fit_beside_each_other() {
        const STEPS: u32 = 20_000;
        for k in 0..=STEPS {
            let x = f64::from(k) / f64::from(STEPS);
            let [f, g, rate] = pulse(x);
            for share in [0.0, 0.3, 0.7, 1.0] {
                let eta = ACCELERATION * share;
                let gamma = 1.0 - BESIDE_JERK * eta;
                assert!(eta * f + gamma * g <= 1.0, "{eta} of the acceleration beside jerk at {x}");
                for (plane, jerk) in RATES.iter().flat_map(|plane| [0.0, 0.5, 1.0].map(|jerk| (plane, jerk)))
                {
                    let (eta, zeta) = (plane.even * share, plane.most * jerk);
                    let delta = 1.0 - BESIDE_RATE * eta - plane.jerk * zeta;
                    let sum = eta * f + zeta * g + delta * rate;
                    assert!(sum <= 1.0, "{eta} of acceleration, {zeta} of jerk at {x}: {sum}");
                }
            }
        }
    }

    /// However two arcs meet in a blended corner: no axis has a larger share in the way than is told.
    #[test]
    fn m66_shares_of_a_corner_between_arcs_are_bounds() {
        for case in 0..2000 {
            let mut random = Seed::of_case(case);
            let (radius, from) = (random.between(1.0, 50.0), random.between(0.0, 6.3));
            let arc = |from: f64, radius: f64, sweep: f64| {
                let place = |angle: f64| [radius * libm::cos(angle), radius * libm::sin(angle)];
                Path::arc([0, 1], place(from), place(from + sweep), 1, [0.0; 2], &[true; 2]).expect("an arc")
            };
            let (sweep, turn) = (random.between(0.1, 2.0), random.between(-0.1, 0.1));
            let paths = [
                arc(from, radius, sweep),
                arc(from + sweep + turn, random.between(0.8, 1.25) * radius, random.between(0.1, 2.0)),
            ];
            let jumps = paths[0].jumps(&paths[1]);
            let shorter = paths[0].length().min(paths[1].length());
            let blend = Blend::new(jumps, Blend::half_within(&jumps, 0.2, 0.5 * shorter));
            let bound = |here: usize| Bend::of(&paths[here]).with(&blend, &paths[1 - here].shares()).0[0];
            for (here, side) in [(0, -1.0), (1, 1.0)] {
                for step in 1..=100 {
                    let from_corner = side * blend.half() * f64::from(step) / 100.0;
                    let mut p =
                        paths[here].at(if here == 0 { paths[0].length() + from_corner } else { from_corner });
                    blend.add(from_corner, &mut p);
                    for (p1, share) in p[1].iter().zip(bound(here)) {
                        assert!(p1.abs() <= share * (1.0 + SAME), "{p1} over {share} in case {case}");
                    }
                }
            }
        }
    }

    /// Whatever the bends of a stretch, and whichever of its limits a pulse uses up: every axis keeps its own
    /// with all terms of M55 of one sign; and some limit is used up.
    #[test]
    fn m193_pulses_within_what_bends_leave_keep_the_limits_of_the_axes() {
        for case in 0..2000 {
            let mut random = Seed::of_case(case);
            let mut ten = |low: f64, high: f64| libm::exp10(random.between(low, high));
            let axes =
                [(); 2].map(|()| Limits { v: 300.0, a: ten(3.0, 4.0), j: ten(4.5, 6.0), dj: ten(6.5, 8.5) });
            let bounds = [ten(-3.0, 1.0), ten(-3.0, 2.0), ten(-3.0, 3.0)];
            let bend = Bend([[1.0, ten(-2.0, 0.0)], [bounds[0]; 2], [bounds[1]; 2], [bounds[2]; 2]]);
            let top = bend.top(&axes, 300.0, f64::INFINITY);
            for v in [top, 0.7 * top, 0.4 * top] {
                let left = bend.left(&axes, v);
                assert!(left.all_positive(), "{left:?} of {bend:?}");
                let mut used = 0.0_f64;
                for step in 0..=200 {
                    let [f, g, rate] = pulse(f64::from(step) / 200.0);
                    let (a, j, d) = (left.a * f, left.j * g, left.dj * rate);
                    for (i, axis) in axes.iter().enumerate() {
                        let Bend([k1, k2, k3, k4]) = &bend;
                        let [k1, k2, k3, k4] = [k1[i], k2[i], k3[i], k4[i]];
                        let shares = [
                            (k1 * a + k2 * v * v) / axis.a,
                            (k1 * j + 3.0 * k2 * v * a + k3 * v * v * v) / axis.j,
                            (k1 * d
                                + 4.0 * k2 * v * j
                                + (3.0 * k2 * a + 6.0 * k3 * v * v) * a
                                + k4 * v * v * v * v)
                                / axis.dj,
                        ];
                        let most = shares.into_iter().fold(0.0, f64::max);
                        assert!(most <= 1.0 + SAME, "{shares:?} at {v} in case {case}: {left:?}");
                        used = used.max(most);
                    }
                }
                assert!(used > 0.9, "{used} of a limit at {v} in case {case}: {left:?}");
            }
        }
    }
}
