//! A smooth junction of two path elements: a bump of compact support that makes the path C³ (M59–M62). In:
//! jumps of the derivatives of p(s) at the junction, half the width of the bump, mm; way from the junction,
//! mm. Out: what the bump adds to p and its derivatives, its peaks, how far it leads away from the path.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | p(s), pₙ | mm, mm^(1−n) | position of the axes along the path and its derivatives by s, of N axes each |
//! | Δ1, Δ2, Δ3 | mm^(1−n) | jumps of p₁, p₂, p₃ at the junction: corner, change of curvature, of its rate |
//! | u | mm | way from the junction, negative before it |
//! | r | mm | half the width of the bump: it is 0 for \|u\| ≥ r |
//! | h, g | 1/mm | kernels, even, of integral 1: h ≥ 0; g has no second moment |
//! | H(u), u₊ | –, mm | unit step; u where it is positive, else 0 |
//! | x, w | – | \|u\|/r, and what is left of it to the end of the bump, 1 − x |
//! | z | rad | phase π w: 0 at the ends of the bump, π at the junction |
//! | Iₙ(z) | – | n-th integral of 1 − cos z from 0; I₋₁ = sin z, I₋₂ = cos z |
//!
//! ```text
//! p̃(s) = p(s) + Δ1 B1(u) + Δ2 B2(u) + Δ3 B3(u)                                                 (M59)
//! h = (1 − 2x²)/r up to x = ½, 2w²/r beyond,  g = (1 + α cos(π u/r) + β cos(2π u/r))/(2r)
//! B1″ = h (beside the corner itself),  B2″ = B3‴ = ∫g − H(u)                                    (M60)
//! α = 1 + β,  β = 2π²/9 − 4/3:  ∫g = 1,  ∫u² g = 0,  g(±r) = 0
//! B1 = r (7/48 − x/2 + x²/2 − x⁴/6) up to x = ½, r w⁴/6 beyond
//! B3^(n) = (−sgn u)ⁿ (r/π)^(4−n)/(2r) (α I₄₋ₙ(z) − β I₄₋ₙ(2z)/2^(4−n)),  B2 = B3′               (M61)
//! |p̃ − p| ≤ |Δ1| max B1 + |Δ2| max |B2| + |Δ3| max |B3|                                         (M62)
//! ```
//!
//! Each bump is a truncated power smoothed by its kernel, less that power: u₊ by h, u₊²/2 and u₊³/6 by g.
//! Smoothing a cubic adds its second derivative times half the second moment of the kernel; the bumps 2 and 3
//! end only because g has none. g dips below 0 for that, so ∫g leaves 0 … 1 by 5 %.
//!
//! h is the moving average over r of one over r/2 of one over r/2, a quadratic spline: of all kernels of this
//! width it has the least |h″|, 4/r³. With the average over r in it, it is a partition of unity: corners of
//! one size, r or an n-th part of r apart, overlap to a constant curvature. The path between lines is a
//! polynomial of degree 4 between the places where an h or its half begins, so its bounds can be had exactly.
//!
//! Source: smoothing by convolution with a compact kernel; the kernels and the closed forms are derived here.

use core::f64::consts::PI;

use crate::search::largest;

const BETA: f64 = 2.0 * PI * PI / 9.0 - 4.0 / 3.0;
const ALPHA: f64 = 1.0 + BETA;

/// Largest |B1^(n)| r^(n−1), n from 0.
const MOST_B1: [f64; 5] = [7.0 / 48.0, 0.5, 1.0, 2.0, 4.0];
/// Largest |B3^(n)| r^(n−3), n from 0; those of B2^(n) r^(n−2) are one further. Rounded up.
const MOST_B3: [f64; 6] = [0.001_739_508_832, 0.004_747_708_858, 0.061_551_505_66, 0.5, ALPHA, 4.932_940_760];

/// Half widths below this are none, mm: a thousandth of the count in which positions are sent.
const LEAST_HALF: f64 = 1e-12;

/// What is added to a path around a junction.
///
/// ```
/// use motion::{Blend, Path};
/// // A right-angled corner at (1, 0), rounded over 0.1 mm before and behind it.
/// let [x, y] = [[1.0, 0.0], [0.0, 1.0]].map(|way| Path::line(way, &[true; 2]).expect("it has a length"));
/// let blend = Blend::new(x.jumps(&y), 0.1);
/// let (mut before, mut behind) = (x.at(x.length()), y.at(0.0));
/// blend.add(-1e-12, &mut before);
/// blend.add(0.0, &mut behind);
/// assert!((before[1][0] - 0.5).abs() < 1e-9 && (behind[1][0] - 0.5).abs() < 1e-9); // half turned
/// assert!((behind[2][1] - 10.0).abs() < 1e-9); // Δ1/r
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend<const N: usize> {
    jumps: [[f64; N]; 3],
    half: f64,
    /// Only p₁ jumps.
    corner: bool,
}

impl<const N: usize> Blend<N> {
    /// No bump: nothing is added anywhere.
    pub const NONE: Blend<N> = Blend { jumps: [[0.0; N]; 3], half: 0.0, corner: true };

    /// The bump for `jumps` of p₁, p₂, p₃ (mm⁰ … 1/mm², behind the junction less before it), over `half` mm
    /// on either side. A `half` that is not finite or below 1e-12 mm makes no bump; [`Blend::half`] is 0
    /// then.
    #[must_use]
    pub fn new(jumps: [[f64; N]; 3], half: f64) -> Blend<N> {
        if !half.is_finite() || half < LEAST_HALF {
            return Blend::NONE;
        }
        Blend { jumps, half, corner: jumps[1..].iter().flatten().all(|jump| *jump == 0.0) }
    }

    /// Half the width of the bump, mm: it reaches from −`half()` to `half()` about the junction. 0: none.
    #[must_use]
    pub fn half(&self) -> f64 {
        self.half
    }

    /// Jump of p₁.
    pub(crate) fn corner(&self) -> &[f64; N] {
        &self.jumps[0]
    }

    /// Whether only p₁ jumps.
    pub(crate) fn corner_only(&self) -> bool {
        self.corner
    }

    /// Adds the bump at `u` mm from the junction to `p`, position and derivatives 1 … 4 by s as `Path::at`
    /// gives them (M59): of the element before the junction for u < 0, of the one behind it for u ≥ 0.
    /// Nothing for |u| ≥ half.
    ///
    /// Beside arcs and curves one sine and cosine.
    pub fn add(&self, u: f64, p: &mut [[f64; N]; 5]) {
        let within = u.abs() < self.half;
        let [d1, d2, d3] = &self.jumps;
        if within && self.corner {
            for (derivative, b1) in p.iter_mut().zip(bump(u, self.half)) {
                derivative.iter_mut().zip(d1).for_each(|(axis, d1)| *axis += d1 * b1);
            }
        } else if within {
            for (derivative, [b1, b2, b3]) in p.iter_mut().zip(bumps(u, self.half)) {
                for (i, axis) in derivative.iter_mut().enumerate() {
                    *axis += d1[i] * b1 + d2[i] * b2 + d3[i] * b3;
                }
            }
        }
    }

    /// Bounds of the derivatives 1 … 4 of the bump itself on every axis, mm⁰ … 1/mm³: what the path may have
    /// more of each because of it. A corner has no p₂ of its own, so all of the rounded corner's is in here.
    ///
    /// The bump turns p₁ from that before the junction to that behind it; that of a corner alone lies between
    /// both.
    #[must_use]
    pub fn peaks(&self) -> [[f64; N]; 4] {
        let [d1, d2, d3] = &self.jumps;
        let r = self.half;
        if r == 0.0 {
            return [[0.0; N]; 4];
        }
        let mut scale = 1.0;
        core::array::from_fn(|n| {
            let [b1, b2, b3] =
                [MOST_B1[n + 1], MOST_B3[n + 2] * r, MOST_B3[n + 1] * r * r].map(|b| b * scale);
            scale /= r;
            core::array::from_fn(|i| d1[i].abs() * b1 + d2[i].abs() * b2 + d3[i].abs() * b3)
        })
    }

    /// How far a bump of this half width leads away from the path at most, mm, as Euclidean distance (M62).
    #[must_use]
    pub fn deviation(jumps: &[[f64; N]; 3], half: f64) -> f64 {
        deviation(jumps.map(|jump| norm(&jump)), half)
    }

    /// The largest half width up to `cap` whose deviation is at most `tolerance`, both mm and finite (M62). 0
    /// if that is below 1e-12 mm.
    #[must_use]
    pub fn half_within(jumps: &[[f64; N]; 3], tolerance: f64, cap: f64) -> f64 {
        let sizes = jumps.map(|jump| norm(&jump));
        let alone = tolerance / (MOST_B1[0] * sizes[0]) * (1.0 - 4.0 * f64::EPSILON);
        let half = largest(cap.min(alone), tolerance, |half| deviation(sizes, half));
        if half < LEAST_HALF { 0.0 } else { half }
    }
}

fn norm<const N: usize>(vector: &[f64; N]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// M62 of the sizes of the jumps.
fn deviation([d1, d2, d3]: [f64; 3], r: f64) -> f64 {
    r * (d1 * MOST_B1[0] + r * (d2 * MOST_B3[1] + r * d3 * MOST_B3[0]))
}

/// What a corner of size 1 leads away from the path at a way `u` from it, mm: B1 (M61). It grows with `r`, at
/// least in proportion to it.
pub(crate) fn aside(u: f64, r: f64) -> f64 {
    let x = u.abs() / r;
    if x >= 1.0 {
        return 0.0;
    }
    let square = if x < 0.5 { x * x } else { (1.0 - x) * (1.0 - x) };
    if x < 0.5 {
        r * (7.0 / 48.0 - 0.5 * x + square * (0.5 - square / 6.0))
    } else {
        r * square * square / 6.0
    }
}

/// B1 at `u` within ±`r`, and its derivatives 1 … 4 (M61).
pub(crate) fn bump(u: f64, r: f64) -> [f64; 5] {
    let along = if u < 0.0 { 1.0 } else { -1.0 };
    let (x, rate) = (u.abs() / r, 1.0 / r);
    if x < 0.5 {
        let square = x * x;
        let turned = 0.5 - x * (1.0 - square * (2.0 / 3.0));
        let [bent, slope] = [(1.0 - 2.0 * square) * rate, 4.0 * x * rate * rate];
        return [aside(u, r), along * turned, bent, along * slope, -4.0 * rate * rate * rate];
    }
    let w = 1.0 - x;
    let square = w * w;
    let [bent, slope] = [2.0 * square * rate, 4.0 * w * rate * rate];
    [aside(u, r), along * square * w * (2.0 / 3.0), bent, along * slope, 4.0 * rate * rate * rate]
}

/// B1, B2, B3 at `u` within ±`r`, and their derivatives 1 … 4 (M61): one row of three for each derivative.
fn bumps(u: f64, r: f64) -> [[f64; 3]; 5] {
    let z = PI * (1.0 - u.abs() / r);
    let (sin, cos) = libm::sincos(z);
    let once = integrals(z, sin, cos);
    let twice = integrals(2.0 * z, 2.0 * sin * cos, 1.0 - 2.0 * sin * sin);
    // Entry k of all tables belongs to Iₙ with n = 4 − k.
    let q = r / PI;
    let along = if u < 0.0 { 1.0 } else { -1.0 };
    let mut scale = q * q * q * q / (2.0 * r);
    let mut halving = 1.0 / 16.0;
    let tables: [f64; 6] = core::array::from_fn(|k| {
        let entry = (ALPHA * once[k] - BETA * twice[k] * halving) * scale;
        scale *= along / q;
        halving *= 2.0;
        entry
    });
    let corner = bump(u, r);
    core::array::from_fn(|n| [corner[n], tables[n + 1], tables[n]])
}

/// I₄ … I₋₁ at a phase z of which sine and cosine are known.
fn integrals(z: f64, sin: f64, cos: f64) -> [f64; 6] {
    let pulse = 1.0 - cos;
    let first = z - sin;
    let second = z * z / 2.0 - pulse;
    let third = z * z * z / 6.0 - first;
    let fourth = z * z * z * z / 24.0 - second;
    [fourth, third, second, first, pulse, sin]
}

#[cfg(test)]
mod tests {
    use super::{MOST_B1, MOST_B3, bumps};

    /// Largest magnitude of every entry over the support, of half width r.
    fn most(r: f64) -> [[f64; 3]; 5] {
        const POINTS: i32 = 20_000;
        let mut most = [[0.0_f64; 3]; 5];
        for k in -POINTS..=POINTS {
            let row = bumps(r * f64::from(k) / f64::from(POINTS), r);
            for (n, values) in row.iter().enumerate() {
                for (b, value) in values.iter().enumerate() {
                    most[n][b] = most[n][b].max(value.abs());
                }
            }
        }
        most
    }

    #[test]
    fn m61_the_named_peaks_are_those_of_the_bumps() {
        for r in [1.0, 0.02] {
            let scaled = |constant: f64, power: i32| constant * f64::powi(r, power);
            for (n, seen) in most(r).into_iter().enumerate() {
                let power = n as i32;
                let bounds = [
                    scaled(MOST_B1[n], 1 - power),
                    scaled(MOST_B3[n + 1], 2 - power),
                    scaled(MOST_B3[n], 3 - power),
                ];
                for (b, (seen, bound)) in seen.into_iter().zip(bounds).enumerate() {
                    assert!(seen <= bound * (1.0 + 1e-12), "B{}^({n}): {seen} above {bound}", b + 1);
                    assert!(seen >= bound * (1.0 - 1e-6), "B{}^({n}): {seen} far below {bound}", b + 1);
                }
            }
        }
    }

    #[test]
    fn m60_the_integral_of_the_kernel_leaves_its_range_by_five_percent() {
        let least = (1..10_000).map(|k| bumps(-f64::from(k) / 1e4, 1.0)[2][1]).fold(0.0, f64::min);
        assert!((least + 0.046_898_07).abs() < 1e-7, "{least}");
    }

    #[test]
    fn m61_all_ends_at_the_ends_but_the_highest_derivatives() {
        for u in [-1.0, 1.0] {
            let ends = bumps(u, 1.0);
            for (n, row) in ends[..4].iter().enumerate() {
                assert!(row.iter().all(|value| value.abs() < 1e-14), "derivative {n} at {u}: {row:?}");
            }
        }
    }
}
