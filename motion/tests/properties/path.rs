//! Random paths (M55–M58): derivatives are derivatives, circles stay round, ends are met, axes keep their limits.

use crate::draw::{keeps, limits, magnitude, times};
use core::f64::consts::TAU;
use motion::{FeedBlock, Limits, Path, Sample};
use proptest::prelude::*;

/// Axes of the plane as on a lathe, among three of which the middle one stands.
const PLANE: [usize; 2] = [2, 0];

/// An arc as its test draws it: radii at both ends, mm, angle of the start, sweep, rad, sense and whole turns.
#[derive(Clone, Copy, Debug)]
struct Drawn {
    r: [f64; 2],
    from: f64,
    sweep: f64,
    turns: i32,
}

impl Drawn {
    fn ends(&self) -> [[f64; 2]; 2] {
        let to = self.from + self.sweep * f64::from(self.turns.signum());
        [(self.r[0], self.from), (self.r[1], to)].map(|(r, angle)| {
            let (sin, cos) = libm::sincos(angle);
            [r * cos, r * sin]
        })
    }

    fn path(&self) -> Path<3> {
        let [start, end] = self.ends();
        Path::arc(PLANE, start, end, self.turns).expect("it has a radius")
    }

    /// Position in the plane as seen from the centre.
    fn place(&self, p: [f64; 3]) -> [f64; 2] {
        let [start, _] = self.ends();
        [start[0] + p[PLANE[0]], start[1] + p[PLANE[1]]]
    }
}

/// Arcs of any size; `mismatch` is the largest relative difference of the radii.
fn arcs(mismatch: f64) -> impl Strategy<Value = Drawn> {
    let turns = prop_oneof![Just(1), Just(-1), Just(3), Just(-2)];
    (magnitude(1e-2, 1e3), -1.0..1.0_f64, 0.0..TAU, magnitude(1e-2, 0.999 * TAU), turns).prop_map(
        move |(r, differs, from, sweep, turns)| Drawn {
            r: [r, r * (1.0 + mismatch * differs)],
            from,
            sweep,
            turns,
        },
    )
}

fn within(sample: Sample, limits: &Limits) -> bool {
    let rounding = 1.0 + 1e-6;
    sample.v.abs() <= limits.v * rounding
        && sample.a.abs() <= limits.a * rounding
        && sample.j.abs() <= limits.j * rounding
        && sample.dj.abs() <= limits.dj * rounding
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn m56_a_circle_is_round_and_meets_its_end(drawn in arcs(0.0)) {
        let (path, [_, end]) = (drawn.path(), drawn.ends());
        let turned = drawn.sweep + TAU * f64::from(drawn.turns.abs() - 1);
        prop_assert!((path.length() - drawn.r[0] * turned).abs() < 1e-9);
        for s in times(path.length(), 100) {
            let [a, b] = drawn.place(path.at(s)[0]);
            prop_assert!((libm::hypot(a, b) - drawn.r[0]).abs() < 1e-9, "radius {} at {s}", libm::hypot(a, b));
            prop_assert_eq!(path.at(s)[0][1], 0.0);
        }
        let [a, b] = drawn.place(path.at(path.length())[0]);
        prop_assert!((a - end[0]).abs() < 1e-9 && (b - end[1]).abs() < 1e-9, "{a}, {b} for {end:?}");
        prop_assert_eq!(path.at(0.0)[0], [0.0; 3]);
    }

    /// The end is met whatever the radii, and the radius lies between them on the way.
    #[test]
    fn m56_a_radius_that_changes_does_so_evenly(drawn in arcs(0.1)) {
        let (path, [_, end]) = (drawn.path(), drawn.ends());
        let [a, b] = drawn.place(path.at(path.length())[0]);
        prop_assert!((a - end[0]).abs() < 1e-9 && (b - end[1]).abs() < 1e-9, "{a}, {b} for {end:?}");
        for share in [0.0, 0.3, 0.7] {
            let [a, b] = drawn.place(path.at(share * path.length())[0]);
            let r = drawn.r[0] + share * (drawn.r[1] - drawn.r[0]);
            prop_assert!((libm::hypot(a, b) - r).abs() < 1e-9);
        }
    }

    #[test]
    fn m56_each_derivative_is_that_of_the_one_before(drawn in arcs(0.1), share in 0.01..0.99_f64) {
        let path = drawn.path();
        let (s, h) = (share * path.length(), 1e-4 * drawn.r[0].min(drawn.r[1]));
        let (before, at, after) = (path.at(s - h), path.at(s), path.at(s + h));
        for n in 0..4 {
            for i in 0..3 {
                let slope = (after[n][i] - before[n][i]) / (2.0 * h);
                let scale = drawn.r[0].powi(-(n as i32));
                prop_assert!((slope - at[n + 1][i]).abs() < 1e-6 * scale, "p{} of {i}: {slope} for {at:?}", n + 1);
            }
        }
    }

    /// M55 against differences in time, along a law with all of its derivatives. Units of time are those of the arc.
    #[test]
    fn m55_the_axes_follow_the_law(
        drawn in arcs(0.01), share in 0.2..0.8_f64, law in prop::array::uniform4(-1.0..1.0_f64),
    ) {
        let (path, r, h) = (drawn.path(), drawn.r[0], 1e-4);
        let s0 = share * path.length();
        let [v, a, j, dj] = law.map(|x| x * r);
        let law = |t: f64| Sample {
            s: s0 + t * (v + t / 2.0 * (a + t / 3.0 * (j + t / 4.0 * dj))),
            v: v + t * (a + t / 2.0 * (j + t / 3.0 * dj)),
            a: a + t * (j + t / 2.0 * dj),
            j: j + t * dj,
            dj,
        };
        let [before, at, after] = [-h, 0.0, h].map(|t| path.follow(&law(t)));
        for i in 0..3 {
            let slope = |of: fn(&Sample) -> f64| (of(&after[i]) - of(&before[i])) / (2.0 * h);
            let pairs = [
                (slope(|x| x.s), at[i].v),
                (slope(|x| x.v), at[i].a),
                (slope(|x| x.a), at[i].j),
                (slope(|x| x.j), at[i].dj),
            ];
            for (n, (slope, value)) in pairs.into_iter().enumerate() {
                prop_assert!((slope - value).abs() < 1e-5 * r, "derivative {} of {i}: {slope}, {value}", n + 1);
            }
        }
    }

    #[test]
    fn m58_no_axis_exceeds_its_limits(
        drawn in arcs(0.01), x in limits(), z in limits(), feed in magnitude(1e-2, 1.0),
    ) {
        let axes = [x, Limits::NONE, z];
        let path = drawn.path();
        let along = path.limits(&axes);
        let block = FeedBlock::plan(path.length(), 0.0, feed * along.v, 0.0, &along).expect("from rest to rest");
        for t in times(block.duration(), 500) {
            let law = block.at(t);
            for (sample, limits) in path.follow(&law).into_iter().zip(&axes) {
                prop_assert!(within(sample, limits), "{sample:?} of {limits:?} at {t}, {law:?} of {along:?}");
            }
        }
    }

    /// All the terms of M57 at once, each at its worst, still fit into the bounds.
    #[test]
    fn m58_the_shares_add_up_to_the_bounds(drawn in arcs(0.0), axis in limits()) {
        let Limits { v, a, j, dj } = drawn.path().limits(&[axis; 3]);
        let c = 1.0 / drawn.r[0];
        let terms = Limits {
            v,
            a: a + c * v * v,
            j: j + 3.0 * c * v * a + c * c * v * v * v,
            dj: dj + c * (4.0 * v * j + 3.0 * a * a) + 6.0 * c * c * v * v * a + c * c * c * v * v * v * v,
        };
        prop_assert!(keeps(&terms, &axis), "{terms:?} of {axis:?}");
    }

    /// Nothing of the path lies outside its box, and the box is no larger than the path.
    #[test]
    fn the_box_fits(drawn in arcs(0.0)) {
        const POINTS: u32 = 2000;
        let path = drawn.path();
        let [low, high] = path.bounds();
        let mut reached = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for s in times(path.length(), POINTS) {
            let p = path.at(s)[0];
            for i in 0..3 {
                prop_assert!(low[i] - 1e-9 <= p[i] && p[i] <= high[i] + 1e-9, "{p:?} beyond {low:?} {high:?}");
                reached[0][i] = reached[0][i].min(p[i]);
                reached[1][i] = reached[1][i].max(p[i]);
            }
        }
        let step = path.length() / f64::from(POINTS);
        let missed = step * step / drawn.r[0] + 1e-9;
        for i in 0..3 {
            prop_assert!(reached[0][i] - low[i] < missed && high[i] - reached[1][i] < missed);
        }
    }
}

#[test]
fn a_line_shares_its_way_among_the_axes() {
    let path = Path::line([0.6, 0.0, -0.8]).expect("it has a length");
    assert!((path.length() - 1.0).abs() < 1e-15);
    let law = Sample { s: 0.5, v: 2.0, a: 3.0, j: 4.0, dj: 5.0 };
    let [x, y, z] = path.follow(&law);
    assert_eq!((x, y), (law * 0.6, law * 0.0));
    assert_eq!(z, law * -0.8);
    assert_eq!(path.bounds(), [[0.0, 0.0, -0.8], [0.6, 0.0, 0.0]]);
    let axis = |v: f64, a: f64| Limits { v, a, j: 1e5, dj: 1e7 };
    let limits = path.limits(&[axis(10.0, 5000.0), axis(1e-3, 1e-3), axis(100.0, 2000.0)]);
    assert_eq!(
        (limits.v, limits.a),
        (10.0 / 0.6, 2000.0 / 0.8),
        "the tightest axis rules, one that stands does not"
    );
    assert!(Path::<3>::line([0.0; 3]).is_none());
}

#[test]
fn ends_at_one_place_make_whole_turns() {
    for (turns, length) in [(1, TAU), (-1, TAU), (3, 3.0 * TAU)] {
        let circle = Path::<2>::arc([0, 1], [1.0, 0.0], [1.0, 0.0], turns).expect("it has a radius");
        assert!((circle.length() - length).abs() < 1e-12, "{turns}");
        let [low, high] = circle.bounds();
        assert!((low[0] + 2.0).abs() < 1e-12 && high[0].abs() < 1e-12);
        // One count of rounding in the end makes no other arc of it.
        for rounded in [-1e-9, 1e-9] {
            let other = Path::<2>::arc([0, 1], [1.0, 0.0], [1.0, rounded], turns).expect("it has a radius");
            assert!((other.length() - length).abs() < 1e-8, "{turns} {rounded}");
        }
    }
    let [_, y] = Path::<2>::arc([0, 1], [1.0, 0.0], [-1.0, 0.0], -1).expect("a radius").at(1e-3)[1];
    assert!(y < 0.0, "negative turns go from the second axis to the first");
}

#[test]
fn what_is_no_arc_is_none() {
    let arc = |start, end, turns| Path::<3>::arc(PLANE, start, end, turns);
    assert!(arc([0.0, 0.0], [1.0, 0.0], 1).is_none());
    assert!(arc([1.0, 0.0], [0.0, 0.0], 1).is_none());
    assert!(arc([1.0, 0.0], [f64::NAN, 0.0], 1).is_none());
    assert!(arc([1.0, 0.0], [0.0, 1.0], 0).is_none());
    assert!(Path::<3>::arc([2, 2], [1.0, 0.0], [0.0, 1.0], 1).is_none());
    assert!(Path::<3>::arc([2, 3], [1.0, 0.0], [0.0, 1.0], 1).is_none());
}
