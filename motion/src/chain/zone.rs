//! Limits of the feed over a stretch of path, from bounds of its derivatives in every axis (M55, M66).
//! In: bounds of |pₙ| in 1/mmⁿ⁻¹, limits of the axes in mm/sⁿ. Out: limits of s in mm/sⁿ.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | k₁ … k₄ | 1/mmⁿ⁻¹ | bounds of \|p₁\| … \|p₄\| of one axis over the stretch |
//! | v | mm/s | highest feed there: that which may be asked for, or what the bends allow |
//! | A′, J′, D′ | mm/sⁿ | what the bends leave at that feed |
//!
//! ```text
//! v ≤ V/k₁,  v² ≤ A/2k₂,  v³ ≤ J/2k₃,  v⁴ ≤ D/2k₄,  v² ≤ 8 ε/|k₂| T²      ε: chord error of a cycle T
//! A′ = A − k₂v²,  J′ = J − k₃v³,  D′ = D − k₄v⁴
//! a ≤ A′/k₁,  a ≤ J′/6k₂v,  a² ≤ D′/12k₂,  a ≤ D′/24k₃v²
//! j ≤ (J′ − 3k₂va)/k₁,  j ≤ D′/16k₂v
//! d ≤ (D′ − 4k₂vj − 3k₂a² − 6k₃v²a)/k₁                                                            (M66)
//! ```
//! Every term of M55 then fits beside the others, whatever their signs. A slow feed leaves nearly all of the
//! limits to changes of feed; only where the path itself asks for a share is it taken.

use crate::blend::Blend;
use crate::limits::Limits;
use crate::path::Path;

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
            // A corner alone turns p₁ between both directions; jumps of curvature add to it.
            let beyond = (turn[i] - 0.5 * blend.corner()[i].abs()).max(0.0);
            shares[i] = shares[i].max(other[i]) + beyond;
        }
        for (own, peaks) in own.iter_mut().zip(&peaks) {
            own.iter_mut().zip(peaks).for_each(|(own, peak)| *own += peak);
        }
        self
    }

    /// Limits of s (M66); `asked` is the highest feed that can be asked for, `chord_v2` = 8 ε/T².
    pub(crate) fn limits(&self, axes: &[Limits; N], asked: f64, chord_v2: f64) -> Limits {
        let Bend([k1, k2, k3, k4]) = self;
        let over = |limit: f64, k: f64| if k > 0.0 { limit / k } else { f64::INFINITY };
        let mut v = asked;
        let mut curvature = 0.0;
        for (i, axis) in axes.iter().enumerate() {
            v = v.min(over(axis.v, k1[i]));
            if k2[i] > 0.0 || k3[i] > 0.0 {
                curvature += k2[i] * k2[i];
                v = v
                    .min((over(axis.a, 2.0 * k2[i])).sqrt())
                    .min(libm::cbrt(over(axis.j, 2.0 * k3[i])))
                    .min(over(axis.dj, 2.0 * k4[i]).sqrt().sqrt());
            }
        }
        if curvature > 0.0 {
            v = v.min((chord_v2 / curvature.sqrt()).sqrt());
        }
        let left = |i: usize| {
            let (v2, axis) = (v * v, &axes[i]);
            (axis.a - k2[i] * v2, axis.j - k3[i] * v2 * v, axis.dj - k4[i] * v2 * v2)
        };
        let moving = |i: &usize| k1[*i] > 0.0 || k2[*i] > 0.0;
        let mut limits = Limits { v, ..Limits::NONE };
        for i in (0..N).filter(moving) {
            let (a, j, d) = left(i);
            limits.a = limits
                .a
                .min(over(a, k1[i]))
                .min(over(j, 6.0 * k2[i] * v))
                .min(over(d, 12.0 * k2[i]).sqrt())
                .min(over(d, 24.0 * k3[i] * v * v));
        }
        let a = limits.a;
        for i in (0..N).filter(moving) {
            let (_, j, d) = left(i);
            limits.j = limits.j.min(over(j - 3.0 * k2[i] * v * a, k1[i])).min(over(d, 16.0 * k2[i] * v));
        }
        let j = limits.j;
        for i in (0..N).filter(moving) {
            let (_, _, d) = left(i);
            let taken = k2[i] * (4.0 * v * j + 3.0 * a * a) + 6.0 * k3[i] * v * v * a;
            limits.dj = limits.dj.min(over(d - taken, k1[i]));
        }
        limits
    }
}
