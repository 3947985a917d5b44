//! Limits of the feed over a stretch of path, from bounds of its derivatives in every axis (M55, M66).
//! In: bounds of |pₙ| in 1/mmⁿ⁻¹, limits of the axes in mm/sⁿ. Out: limits of s in mm/sⁿ.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | k₁ … k₄ | 1/mmⁿ⁻¹ | bounds of \|p₁\| … \|p₄\| of one axis over the stretch; K₂, K₃ those of all axes together |
//! | v | mm/s | a speed, at most that which may be asked for, and what the bends allow |
//! | A′, J′, D′ | mm/sⁿ | what the bends leave of the limits of an axis at that speed |
//! | ε, T | mm, s | chord error of a cycle, its time |
//! | x, f, g | – | how far a pulse of jerk has come, 0 … 1; its acceleration and jerk, as shares of their peaks |
//!
//! ```text
//! v ≤ V/k₁,  v² ≤ 0.7 A/k₂,  v³ ≤ 0.75 J/k₃,  v⁴ ≤ 0.75 D/k₄,  v² ≤ 8 ε/|k₂| T²
//! A′ = A − k₂v²,  J′ = J − k₃v³,  D′ = D − k₄v⁴
//! a ≤ A′/k₁,  3K₂va ≤ 0.8 J′,  3K₂a² + 6K₃v²a ≤ 0.6 D′,  4K₂vj ≤ 0.4 D′         the least J′, D′ of all axes
//! j ≤ (J′ − 0.66 · 3k₂va)/k₁
//! d ≤ (D′ − 0.57 · 4k₂vj − 0.93 (3k₂a² + 6k₃v²a))/k₁                                              (M66)
//! ```
//! Every term of M55 then fits beside the others, whatever their signs, because their peaks do not come
//! together. Where a pulse of sin² jerk between no acceleration and its peak has come to x,
//!
//! ```text
//! f = x − sin 2πx/2π,  g = sin² πx,  jerk rate |sin 2πx| of its peak
//! η f + γ g ≤ 1              if γ ≤ 1 − 0.66 η, η ≤ 0.8
//! η f + ζ g + δ |sin 2πx| ≤ 1  if δ ≤ 1 − 0.93 η − 0.57 ζ, η ≤ 0.7, ζ ≤ 0.4                        (M181)
//! ```
//! What γ and δ may be are least values of functions that are linear in η and ζ, so concave; planes that lie
//! below them at the corners lie below them all over. Where an acceleration goes from one sign to the other,
//! |a| is at most f times what it becomes, or 1 − f times what it was.
//!
//! K₂ and K₃ do not depend on the direction in which the axes lie, so a bow allows the same acceleration all
//! along; which share of it bends the path in which axis is left to j and d.

use super::allowance::Allowance;
use crate::blend::Blend;
use crate::limits::Limits;
use crate::path::Path;
use crate::sample::Sample;

/// Share of the acceleration that a bend may take, and of jerk and jerk rate.
const BEND: [f64; 2] = [0.7, 0.75];
/// Shares of what it leaves: for the acceleration in jerk, in jerk rate, for jerk in jerk rate.
const ACCELERATION: [f64; 2] = [0.8, 0.6];
const JERK: f64 = 0.4;
const _: () = assert!(ACCELERATION[0] <= 0.8 && ACCELERATION[1] <= 0.7 && JERK <= 0.4, "where M181 holds");
/// How much of the peaks of other terms is left when jerk and jerk rate are at theirs (M181).
const BESIDE_JERK: f64 = 0.66;
const BESIDE_RATE: [f64; 2] = [0.93, 0.57];

/// How often `k` fits into a limit.
fn over(limit: f64, k: f64) -> f64 {
    if k > 0.0 { limit / k } else { f64::INFINITY }
}

pub(super) fn norm<const N: usize>(k: &[f64; N]) -> f64 {
    k.iter().map(|k| k * k).sum::<f64>().sqrt()
}

/// Bounds of |p₁| … |p₄| of every axis over a stretch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bend<const N: usize>(pub(super) [[f64; N]; 4]);

impl<const N: usize> Bend<N> {
    /// Of a path by itself.
    pub(crate) fn of(path: &Path<N>) -> Bend<N> {
        Bend(path.most())
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
            // bend of the path: at x from the corner the first has come to |Δ₁|/2 (1 − x/r) at most, and what
            // p₁ was at the corner has changed by k₂x.
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
        let together = self.together();
        if self.0[1..].iter().flatten().all(|k| *k == 0.0) {
            return Allowance::flat(&self.left(axes, v, together));
        }
        Allowance::new(v, |v| self.left(axes, v, together))
    }

    /// Limits of s up to its highest speed (M66).
    pub(crate) fn limits(&self, axes: &[Limits; N], asked: f64, chord_v2: f64) -> Limits {
        self.left(axes, self.top(axes, asked, chord_v2), self.together())
    }

    /// What the bends add at most to v, a, j, d of an axis, and what its direction turns on the way `s`, in a
    /// motion along the path of at most these values (M55).
    pub(super) fn adds(&self, axis: usize, &Sample { s, v, a, j, dj }: &Sample) -> [f64; 4] {
        let Bend([_, k2, k3, k4]) = self;
        let [k2, k3, k4] = [k2[axis], k3[axis], k4[axis]];
        let v2 = v * v;
        [
            k2 * s * v,
            k2 * (v2 + s * a),
            k2 * (3.0 * v * a + s * j) + k3 * v2 * v,
            k2 * (4.0 * v * j + 3.0 * a * a + s * dj) + 6.0 * k3 * v2 * a + k4 * v2 * v2,
        ]
    }

    /// K₂ and K₃.
    fn together(&self) -> [f64; 2] {
        let Bend([_, k2, k3, _]) = self;
        [norm(k2), norm(k3)]
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

    /// What the bends leave at a speed up to the highest one (M66).
    fn left(&self, axes: &[Limits; N], v: f64, [second, third]: [f64; 2]) -> Limits {
        let Bend([k1, k2, k3, k4]) = self;
        let (v2, v3) = (v * v, v * v * v);
        let moving = |i: &usize| k1[*i] > 0.0 || k2[*i] > 0.0;
        let (mut a, mut least_j, mut least_d) = (f64::INFINITY, f64::INFINITY, f64::INFINITY);
        let mut left = [[0.0; 2]; N];
        for i in (0..N).filter(moving) {
            left[i] = [axes[i].j - k3[i] * v3, axes[i].dj - k4[i] * v2 * v2];
            (least_j, least_d) = (least_j.min(left[i][0]), least_d.min(left[i][1]));
            a = a.min(over(axes[i].a - k2[i] * v2, k1[i]));
        }
        if second > 0.0 || third > 0.0 {
            // 3K₂a² + 6K₃v²a = W: the root of a quadratic.
            let (even, square) = (6.0 * third * v2, 3.0 * second);
            let most = ACCELERATION[1] * least_d;
            let root = 2.0 * most / (even + (even * even + 4.0 * square * most).sqrt());
            a = a.min(over(ACCELERATION[0] * least_j, 3.0 * second * v)).min(root);
        }
        let mut limits = Limits { v, a, j: over(JERK * least_d, 4.0 * second * v), dj: f64::INFINITY };
        for i in (0..N).filter(moving) {
            limits.j = limits.j.min(over(left[i][0] - BESIDE_JERK * 3.0 * k2[i] * v * a, k1[i]));
        }
        for i in (0..N).filter(moving) {
            let [by_acceleration, by_jerk] =
                [(3.0 * k2[i] * a + 6.0 * k3[i] * v2) * a, 4.0 * k2[i] * v * limits.j];
            let taken = BESIDE_RATE[0] * by_acceleration + BESIDE_RATE[1] * by_jerk;
            limits.dj = limits.dj.min(over(left[i][1] - taken, k1[i]));
        }
        limits
    }
}

#[cfg(test)]
mod tests {
    use super::{BESIDE_JERK, BESIDE_RATE, Bend};
    use crate::blend::Blend;
    use crate::chain::SAME;
    use crate::path::Path;
    use core::f64::consts::PI;
    use testing::Seed;

    /// Beside the peaks of any pulse, at the corners of what M181 holds for, and within.
    #[test]
    fn m181_peaks_of_a_pulse_fit_beside_each_other() {
        const STEPS: u32 = 20_000;
        for k in 0..=STEPS {
            let x = f64::from(k) / f64::from(STEPS);
            let (sin, cos) = libm::sincos(PI * x);
            let (f, g, rate) = (x - sin * cos / PI, sin * sin, (2.0 * sin * cos).abs());
            for share in [0.0, 0.3, 0.7, 1.0] {
                let eta = 0.8 * share;
                let gamma = 1.0 - BESIDE_JERK * eta;
                assert!(eta * f + gamma * g <= 1.0, "{eta} of the acceleration beside jerk at {x}");
                for jerk in [0.0, 0.5, 1.0] {
                    let (eta, zeta) = (0.7 * share, 0.4 * jerk);
                    let delta = 1.0 - BESIDE_RATE[0] * eta - BESIDE_RATE[1] * zeta;
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
}
