//! Random junctions (M59–M62): smooth through the junction and at the ends of the bump, derivatives are
//! derivatives, the deviation is kept and made use of.

use super::draw::{magnitude, signed, times};
use motion::{Blend, Path};
use proptest::prelude::*;

type Jumps = [[f64; 2]; 3];

/// Jumps of a junction between paths whose radii are about `half` or more.
fn jumps(half: f64) -> impl Strategy<Value = Jumps> {
    prop::array::uniform3(prop::array::uniform2(-1.0..1.0_f64))
        .prop_map(move |[d1, d2, d3]| [d1, d2.map(|x| x / half), d3.map(|x| x / half / half)])
}

fn junctions() -> impl Strategy<Value = (Jumps, f64)> {
    magnitude(1e-3, 1e2).prop_flat_map(|half| (jumps(half), Just(half)))
}

/// A path of powers with the jumps at 0: nothing before, Δ1 u + Δ2 u²/2 + Δ3 u³/6 behind; with the bump
/// added.
fn rounded(jumps: &Jumps, half: f64, u: f64) -> [[f64; 2]; 5] {
    let [d1, d2, d3] = jumps;
    let mut p = [[0.0; 2]; 5];
    if u >= 0.0 {
        for i in 0..2 {
            p[0][i] = u * (d1[i] + u * (d2[i] / 2.0 + u * d3[i] / 6.0));
            p[1][i] = d1[i] + u * (d2[i] + u * d3[i] / 2.0);
            p[2][i] = d2[i] + u * d3[i];
            p[3][i] = d3[i];
        }
    }
    Blend::new(*jumps, half).add(u, &mut p);
    p
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

/// One path after the other, rounded where they meet; `u` from there.
fn joined(before: &Path<2>, behind: &Path<2>, blend: &Blend<2>, u: f64) -> [[f64; 2]; 5] {
    let meets = before.at(before.length())[0];
    let mut p = if u < 0.0 { before.at(before.length() + u) } else { behind.at(u) };
    if u >= 0.0 {
        p[0] = [p[0][0] + meets[0], p[0][1] + meets[1]];
    }
    blend.add(u, &mut p);
    p
}

fn arc(start: [f64; 2], end: [f64; 2], turns: i32) -> Path<2> {
    Path::arc([0, 1], start, end, turns, [0.0; 2], &[true; 2]).expect("it has a radius")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// Position and three derivatives do not jump, at the junction and at both ends of the bump.
    #[test]
    fn m59_the_path_is_smooth_to_the_third_derivative((jumps, half) in junctions()) {
        let near = 1e-9 * half;
        for place in [-half, 0.0, half] {
            let (left, right) = (rounded(&jumps, half, place - near), rounded(&jumps, half, place + near));
            for n in 0..4 {
                let scale = half.powi(1 - n as i32);
                for (left, right) in left[n].into_iter().zip(right[n]) {
                    prop_assert!((left - right).abs() < 1e-7 * scale, "p{n} from {left} to {right} at {place}");
                }
            }
        }
    }

    #[test]
    fn m61_each_derivative_is_that_of_the_one_before((jumps, half) in junctions(), share in -0.99..0.99_f64) {
        let (u, h) = (share * half, 1e-4 * half);
        prop_assume!(u.abs() > h);
        let [before, at, after] = [u - h, u, u + h].map(|u| rounded(&jumps, half, u));
        for n in 0..4 {
            let scale = half.powi(-(n as i32));
            for i in 0..2 {
                let slope = (after[n][i] - before[n][i]) / (2.0 * h);
                prop_assert!((slope - at[n + 1][i]).abs() < 1e-6 * scale, "p{}: {slope} for {at:?}", n + 1);
            }
        }
    }

    /// The bump keeps its peaks and the bound of its deviation.
    #[test]
    fn m62_the_bounds_hold((jumps, half) in junctions()) {
        let blend = Blend::new(jumps, half);
        let (peaks, deviation) = (blend.peaks(), Blend::deviation(&jumps, half));
        for u in times(2.0 * half, 999).map(|u| u - half) {
            let mut bump = [[0.0; 2]; 5];
            blend.add(u, &mut bump);
            prop_assert!(distance(bump[0], [0.0; 2]) <= deviation * (1.0 + 1e-12));
            for (values, peaks) in bump[1..].iter().zip(&peaks) {
                for (value, peak) in values.iter().zip(peaks) {
                    prop_assert!(value.abs() <= peak * (1.0 + 1e-12), "{value} above {peak} at {u}");
                }
            }
        }
    }

    /// The half width found keeps the tolerance, and none that is a little larger does.
    #[test]
    fn m62_the_tolerance_is_used((jumps, half) in junctions(), tolerance in magnitude(1e-6, 1.0)) {
        let cap = 1e3;
        let found = Blend::half_within(&jumps, tolerance, cap);
        prop_assert!(found > 0.0 && found <= cap);
        prop_assert!(Blend::deviation(&jumps, found) <= tolerance);
        prop_assert!(found == cap || Blend::deviation(&jumps, found * (1.0 + 1e-12)) > tolerance, "{found} {half}");
        let corner = [jumps[0], [0.0; 2], [0.0; 2]];
        let found = Blend::half_within(&corner, tolerance, cap);
        prop_assert!(Blend::deviation(&corner, found) <= tolerance);
        prop_assert!(found == cap || Blend::deviation(&corner, found * (1.0 + 1e-12)) > tolerance);
    }

    /// Corners of one size at a spacing of r: the second derivative is the same everywhere between them.
    #[test]
    fn m60_equal_corners_overlap_to_a_constant_curvature(
        corner in signed(1e-3, 1.0), half in magnitude(1e-3, 1e2),
    ) {
        let blend = Blend::new([[corner], [0.0], [0.0]], half);
        // Not in the middle: both fourth derivatives jump there.
        for u in times(half, 99).skip(1).take(98) {
            let mut p = [[0.0]; 5];
            blend.add(u, &mut p);
            blend.add(u - half, &mut p);
            prop_assert!((p[2][0] - corner / half).abs() < 1e-12 / half);
            prop_assert!(p[3][0].abs() < 1e-11 / (half * half) && p[4][0].abs() < 1e-10 / (half * half * half));
        }
    }

    /// From an arc into another of any curvature, tangent or not: smooth, and near the path.
    #[test]
    fn m59_arcs_join_smoothly(
        r in prop::array::uniform2(magnitude(1.0, 1e2)), angle in -3.0..3.0_f64, turns in any::<bool>(),
    ) {
        let (sin, cos) = libm::sincos(angle);
        let before = arc([r[0], 0.0], [0.0, r[0]], 1);
        let start = [r[1] * cos, r[1] * sin];
        let end = [-start[0], -start[1]];
        let behind = arc(start, end, if turns { 1 } else { -1 });
        let jumps = before.jumps(&behind);
        let (tolerance, cap) = (0.01, 0.5 * before.length().min(behind.length()));
        let half = Blend::half_within(&jumps, tolerance, cap);
        let (blend, none) = (Blend::new(jumps, half), Blend::NONE);
        let near = 1e-9 * half;
        for place in [-half, 0.0, half] {
            let [left, right] = [place - near, place + near].map(|u| joined(&before, &behind, &blend, u));
            for n in 0..4 {
                for i in 0..2 {
                    let error = (left[n][i] - right[n][i]).abs() * half.powi(n as i32 - 1);
                    prop_assert!(error < 1e-5, "p{n} jumps by {error} at {place}");
                }
            }
        }
        for u in times(2.0 * half, 200).map(|u| u - half) {
            let [plain, smooth] = [&none, &blend].map(|bump| joined(&before, &behind, bump, u)[0]);
            prop_assert!(distance(plain, smooth) <= tolerance * (1.0 + 1e-9));
        }
    }
}

/// A right angle, rounded within a tolerance: most of it is used, measured square to the legs of the corner.
#[test]
fn m62_a_right_angle_uses_its_tolerance() {
    let jumps = [[-1.0, 1.0], [0.0; 2], [0.0; 2]];
    let half = Blend::half_within(&jumps, 0.05, 10.0);
    let blend = Blend::new(jumps, half);
    let mut most = 0.0_f64;
    for u in times(2.0 * half, 10_000).map(|u| u - half) {
        let mut p = [[u.min(0.0), u.max(0.0)], [0.0; 2], [0.0; 2], [0.0; 2], [0.0; 2]];
        blend.add(u, &mut p);
        let [x, y] = p[0];
        assert!(x <= 1e-15 && y >= -1e-15, "it stays inside of the corner");
        most = most.max(x.abs().min(y.abs()));
    }
    assert!((0.6 * 0.05..=0.05).contains(&most), "{most}");
}

/// A line into a quarter of a circle that touches it: the curvature goes over, the direction hardly leaves
/// the plane's.
#[test]
fn m59_a_line_goes_over_into_a_tangent_arc() {
    let line = Path::line([10.0, 0.0], &[true; 2]).expect("it has a length");
    let arc = arc([0.0, -5.0], [5.0, 0.0], 1);
    let jumps = line.jumps(&arc);
    assert_eq!(jumps, [[0.0, 0.0], [0.0, 0.2], [-0.04, 0.0]]);
    let half = Blend::half_within(&jumps, 1e-3, 4.0);
    let blend = Blend::new(jumps, half);
    assert!((Blend::deviation(&jumps, half) - 1e-3).abs() < 1e-12);
    let curvature = |u: f64| joined(&line, &arc, &blend, u)[2][1];
    assert!(curvature(-half).abs() < 1e-12 && (curvature(0.0) - 0.1).abs() < 1e-12);
    for u in times(2.0 * half, 1000).map(|u| u - half) {
        assert!((-0.01..=0.21).contains(&curvature(u)), "{} at {u}", curvature(u));
    }
}

#[test]
fn nothing_to_round_and_nothing_to_round_with() {
    let zero = [[0.0; 2]; 3];
    assert_eq!(Blend::half_within(&zero, 0.0, 7.0), 7.0);
    assert_eq!(Blend::half_within(&zero, 0.1, 7.0), 7.0);
    assert_eq!(Blend::half_within(&[[1.0, 0.0], [0.0; 2], [0.0; 2]], 0.0, 7.0), 0.0);
    assert_eq!(Blend::half_within(&[[0.0; 2], [1.0, 0.0], [0.0; 2]], 0.0, 7.0), 0.0);
    assert_eq!(Blend::half_within(&zero, 0.1, 0.0), 0.0);
    let line = [[1.0, 2.0], [0.6, 0.8], [0.0; 2], [0.0; 2], [0.0; 2]];
    let corner = [[1.0, 1.0], [0.0; 2], [0.0; 2]];
    for half in [0.0, -1.0, 1e-300, f64::NAN, f64::INFINITY] {
        let (blend, mut p) = (Blend::new(corner, half), line);
        blend.add(0.0, &mut p);
        assert_eq!((blend.half(), p, blend.peaks()), (0.0, line, [[0.0; 2]; 4]), "{half}");
    }
    for u in [-1.0, -0.5, 0.0, 0.3, 1.0, 2.0, f64::NAN] {
        let mut p = line;
        Blend::new(zero, 1.0).add(u, &mut p);
        assert_eq!(p, line, "{u}");
    }
}
