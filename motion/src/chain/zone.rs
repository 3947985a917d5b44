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

use core::f64::consts::PI;

use crate::blend::Blend;
use crate::limits::Limits;
use crate::path::Path;

/// Samples along a stretch that two blends share.
const SAMPLES: u32 = 32;

/// Bounds of |p₁| … |p₄| of every axis over a stretch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bend<const N: usize>([[f64; N]; 4]);

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

    /// Over a line that two blends of corners share, each nearly as wide as the line is long. With x from its
    /// start, `p₂ = (Δ₀ + Δ₁)/2L + (Δ₀ − Δ₁)/2L cos(πx/L)`: where corners turn alike nothing is left of p₃ and
    /// p₄, and a finely divided curve can be as fast as the curve.
    ///
    /// A blend whose half width is L (1 + δ) differs from that: `|∂h⁽ⁿ⁾/∂ ln r|` is at most (n + 1 + π) times
    /// the most of h⁽ⁿ⁾, π^n/2L^(n+1) and for n = 0 twice that.
    pub(super) fn filled(
        path: &Path<N>,
        start: &Blend<N>,
        end: &Blend<N>,
        others: [&[f64; N]; 2],
    ) -> Bend<N> {
        let (length, shares) = (path.length(), path.shares());
        let rate = PI / length;
        let off = |blend: &Blend<N>| (blend.half() / length - 1.0).abs();
        let (before, behind) = (off(start), off(end));
        let mut bounds = [[0.0; N]; 4];
        for i in 0..N {
            let (first, second) = (start.corner()[i], end.corner()[i]);
            let swing = (first - second).abs() / (2.0 * length);
            bounds[0][i] = shares[i].max(others[0][i]).max(others[1][i]);
            bounds[1][i] = first.abs().max(second.abs()) / length;
            (bounds[2][i], bounds[3][i]) = (swing * rate, swing * rate * rate);
            let mut rounded = (before * first.abs() + behind * second.abs()) / (2.0 * length);
            for (n, bound) in bounds.iter_mut().skip(1).enumerate() {
                let most = if n == 0 { 2.0 } else { 1.0 };
                // A thousandth more for what δ² and δ³ make of it.
                bound[i] += 1.001 * rounded * most * (n as f64 + 1.0 + PI);
                rounded *= rate;
            }
        }
        Bend(bounds)
    }

    /// Over a whole line that two blends of corners share in part. Their sum is sampled: it is smaller than
    /// the sum of their bounds.
    ///
    /// Between samples h apart |f| is at most the larger of both plus h²/8 max|f″|.
    pub(super) fn shared(
        path: &Path<N>,
        start: &Blend<N>,
        end: &Blend<N>,
        others: [&[f64; N]; 2],
    ) -> Bend<N> {
        let length = path.length();
        let mut bounds = [[0.0; N]; 4];
        bounds[0] = path.shares();
        for i in 0..N {
            bounds[0][i] = bounds[0][i].max(others[0][i]).max(others[1][i]);
        }
        for k in 0..=SAMPLES {
            // Just inside the ends: the fourth derivative of a blend jumps where it begins.
            let u = (f64::from(k) / f64::from(SAMPLES)).clamp(1e-9, 1.0 - 1e-9) * length;
            let mut p = [[0.0; N]; 5];
            start.add(u, &mut p);
            end.add(u - length, &mut p);
            for n in 1..4 {
                for i in 0..N {
                    bounds[n][i] = bounds[n][i].max(p[n + 1][i].abs());
                }
            }
        }
        for blend in [start, end].into_iter().filter(|blend| blend.half() > 0.0) {
            let rate = PI / blend.half();
            let step = length / f64::from(SAMPLES);
            let ends_within = blend.half() < length * (1.0 - 1e-9);
            let mut share = (step * rate) * (step * rate) / (16.0 * blend.half());
            for (n, bound) in bounds.iter_mut().enumerate().skip(1) {
                let jump = if n == 3 && ends_within { rate * rate / (2.0 * blend.half()) } else { 0.0 };
                for (bound, corner) in bound.iter_mut().zip(blend.corner()) {
                    *bound += corner.abs() * (share + jump);
                }
                share *= rate;
            }
        }
        Bend(bounds)
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
