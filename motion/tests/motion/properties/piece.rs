//! Random pieces (M84, M85): ends met with their derivatives, bounds that hold and are nearly reached, limits
//! kept.

use super::draw::{limits, magnitude, signed, times};
use motion::{FeedBlock, Limits, Path};
use proptest::prelude::*;

const AXES: usize = 3;

type Hermite = [[f64; AXES]; 4];

/// What a piece is made of: both ends and its length.
#[derive(Clone, Copy, Debug)]
struct Drawn {
    ends: [Hermite; 2],
    length: f64,
}

impl Drawn {
    fn path(&self) -> Path<AXES> {
        Path::piece(&self.ends[0], &self.ends[1], self.length).expect("it has a length")
    }
}

/// Any ends at all, of the size of the piece, far from the zero of the axes.
fn any_ends() -> impl Strategy<Value = Drawn> {
    let end = || prop::array::uniform4(prop::array::uniform3(-1.0..1.0_f64));
    (end(), end(), magnitude(1e-3, 50.0), prop::array::uniform3(-500.0..500.0_f64)).prop_map(
        |(start, end, length, zero)| {
            let scaled = |end: Hermite| {
                let power = |n: usize| length.powi(1 - n as i32);
                let mut scaled: Hermite = std::array::from_fn(|n| end[n].map(|p| p * power(n)));
                scaled[0] = std::array::from_fn(|i| scaled[0][i] + zero[i]);
                scaled
            };
            Drawn { ends: [scaled(start), scaled(end)], length }
        },
    )
}

/// A wave of an axis: amplitude, rate, phase.
type Waves = [(f64, f64, f64); AXES];

/// Ends of a smooth curve: waves by its length, slow against that of the piece.
fn smooth() -> impl Strategy<Value = Drawn> {
    let wave = || (signed(0.1, 2.0), 0.05..0.6_f64, 0.0..6.3_f64);
    (wave(), wave(), wave(), magnitude(1e-2, 20.0)).prop_map(|(a, b, c, length)| {
        let waves: Waves = [a, b, c];
        let at = |s: f64| -> Hermite {
            std::array::from_fn(|n| {
                waves.map(|(size, rate, phase)| {
                    let quarter = std::f64::consts::FRAC_PI_2 * n as f64;
                    let power = (rate / length).powi(n as i32);
                    size * length * power * libm::sin(rate * s / length + phase + quarter)
                })
            })
        };
        Drawn { ends: [at(0.0), at(length)], length }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn m84_a_piece_meets_both_ends_with_three_derivatives(drawn in any_ends()) {
        let (path, length) = (drawn.path(), drawn.length);
        for (s, end) in [(0.0, drawn.ends[0]), (length, drawn.ends[1])] {
            let at = path.at(s);
            for n in 0..4 {
                let scale = length.powi(1 - n as i32);
                for i in 0..AXES {
                    let right = if n == 0 { end[0][i] - drawn.ends[0][0][i] } else { end[n][i] };
                    prop_assert!((at[n][i] - right).abs() <= 1e-11 * scale, "p{n} of {i}: {} for {right}", at[n][i]);
                }
            }
        }
    }

    #[test]
    fn m84_each_derivative_is_that_of_the_one_before(drawn in any_ends(), share in 0.01..0.99_f64) {
        let path = drawn.path();
        let (s, h) = (share * drawn.length, 1e-5 * drawn.length);
        let (before, at, after) = (path.at(s - h), path.at(s), path.at(s + h));
        for n in 0..4 {
            for i in 0..AXES {
                let slope = (after[n][i] - before[n][i]) / (2.0 * h);
                let scale = drawn.length.powi(-(n as i32));
                // Derivatives of these ends are a few thousands, two orders further a million.
                prop_assert!((slope - at[n + 1][i]).abs() < 1e-3 * scale, "p{} of {i}: {slope} for {at:?}", n + 1);
            }
        }
    }

    /// Nothing exceeds the bounds, whatever the ends; where the curve is smooth they are reached but for 1
    /// per cent.
    #[test]
    fn m85_bounds_hold_and_are_nearly_reached((drawn, is_smooth) in prop_oneof![
        any_ends().prop_map(|drawn| (drawn, false)), smooth().prop_map(|drawn| (drawn, true)),
    ]) {
        let path = drawn.path();
        let [p2, p3, p4] = path.bend();
        let bounds = [path.shares(), p2, p3, p4];
        let mut most = [[0.0_f64; AXES]; 4];
        for s in times(drawn.length, 1000) {
            for (n, row) in path.at(s)[1..].iter().enumerate() {
                for (most, p) in most[n].iter_mut().zip(row) {
                    *most = most.max(p.abs());
                }
            }
        }
        for n in 0..4 {
            let rounding = 1e-11 * drawn.length.powi(-(n as i32));
            for i in 0..AXES {
                let (most, bound) = (most[n][i], bounds[n][i]);
                prop_assert!(most <= bound + rounding, "p{} of {i} is {most}, bound {bound}", n + 1);
                prop_assert!(!is_smooth || bound <= 1.01 * most + rounding, "p{}: {bound} for {most}", n + 1);
            }
        }
    }

    #[test]
    fn the_box_of_a_piece_fits(drawn in any_ends()) {
        let path = drawn.path();
        let [low, high] = path.bounds();
        let (mut least, mut most) = ([f64::INFINITY; AXES], [f64::NEG_INFINITY; AXES]);
        for s in times(drawn.length, 5000) {
            let [p, ..] = path.at(s);
            for i in 0..AXES {
                (least[i], most[i]) = (least[i].min(p[i]), most[i].max(p[i]));
            }
        }
        // Between samples it turns back by a share of its size.
        let missed = 1e-5 * drawn.length + 1e-9;
        for i in 0..AXES {
            prop_assert!(low[i] <= least[i] + 1e-12 && most[i] - 1e-12 <= high[i]);
            prop_assert!(least[i] - low[i] < missed && high[i] - most[i] < missed);
        }
    }

    /// From rest to rest as fast as the limits of the piece allow.
    #[test]
    fn m66_no_axis_exceeds_its_limits_on_a_piece(
        drawn in prop_oneof![any_ends(), smooth()], axes in prop::array::uniform3(limits()), feed in magnitude(1e-2, 1.0),
    ) {
        let path = drawn.path();
        let along = path.limits(&axes);
        let block = FeedBlock::plan(path.length(), 0.0, feed * along.v, 0.0, &along).expect("from rest to rest");
        for t in times(block.duration(), 500) {
            for (sample, limits) in path.follow(&block.at(t)).into_iter().zip(&axes) {
                let Limits { v, a, j, dj } = *limits;
                let rounding = 1.0 + 1e-6;
                let kept = sample.v.abs() <= v * rounding && sample.a.abs() <= a * rounding;
                let kept = kept && sample.j.abs() <= j * rounding && sample.dj.abs() <= dj * rounding;
                prop_assert!(kept, "{sample:?} of {limits:?} at {t}");
            }
        }
    }

    /// Beside a circle no further than Hermite's remainder, (L/R)⁸ R/(8! 2⁸) for an axis, and joined to the
    /// next piece without a jump.
    #[test]
    fn m84_pieces_of_a_circle(radius in magnitude(0.01, 1e3), angle in magnitude(1e-3, 0.5), from in 0.0..6.3_f64) {
        let at = |phi: f64| -> Hermite {
            let (sin, cos) = libm::sincos(phi);
            let power = |n: i32| radius.powi(1 - n);
            [[cos, sin, 0.0], [-sin, cos, 0.0], [-cos, -sin, 0.0], [sin, -cos, 0.0]]
                .iter().enumerate().map(|(n, p)| p.map(|p| p * power(n as i32)))
                .collect::<Vec<_>>().try_into().expect("four rows")
        };
        let piece = |from: f64, to: f64| {
            Path::piece(&at(from), &at(to), radius * (to - from)).expect("it has a length")
        };
        let path = piece(from, from + angle);
        let remainder = radius * (angle.powi(8) / (40_320.0 * 256.0) * 1.01 + 1e-14);
        for s in times(path.length(), 100) {
            let (p, right) = (path.at(s)[0], at(from + s / radius)[0]);
            for i in 0..2 {
                prop_assert!((at(from)[0][i] + p[i] - right[i]).abs() <= remainder, "{p:?} for {right:?}");
            }
            prop_assert_eq!(p[2], 0.0);
        }
        let next = piece(from + angle, from + 1.5 * angle);
        let shorter = next.length();
        for (n, jump) in path.jumps(&next).iter().enumerate() {
            prop_assert!(jump.iter().all(|jump| jump.abs() <= 1e-12 * shorter.powi(-(n as i32))), "{jump:?}");
        }
    }
}

#[test]
fn what_is_no_piece_is_none() {
    let start = [[0.0; 2], [1.0, 0.0], [0.0; 2], [0.0; 2]];
    let end = [[1.0, 0.0], [1.0, 0.0], [0.0; 2], [0.0; 2]];
    let straight = Path::piece(&start, &end, 1.0).expect("it has a length");
    assert!(straight.bend().iter().flatten().all(|p| *p < 1e-11) && !straight.is_line());
    for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(Path::piece(&start, &end, length).is_none(), "{length}");
    }
    let beyond = [[f64::NAN, 0.0], [1.0, 0.0], [0.0; 2], [0.0; 2]];
    assert!(Path::piece(&start, &beyond, 1.0).is_none());
}
