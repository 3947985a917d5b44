//! Random paths (M55–M58): derivatives are derivatives, circles stay round, ends are met, axes keep their
//! limits.

use super::draw::{keeps, limits, magnitude, signed, times};
use core::f64::consts::TAU;
use motion::{FeedBlock, Limits, Path, Sample};
use proptest::prelude::*;

/// Axes of the plane as on a lathe, Z and X, with Y beside them and a rotary axis.
const AXES: usize = 4;
const PLANE: [usize; 2] = [2, 0];
const METRIC: [bool; AXES] = [true, true, true, false];

/// An arc as its test draws it: radii at both ends, mm, angle of the start, sweep, rad, sense and whole
/// turns; drift of Y, mm, and of the rotary axis, degrees.
#[derive(Clone, Copy, Debug)]
struct Drawn {
    r: [f64; 2],
    from: f64,
    sweep: f64,
    turns: i32,
    drift: [f64; 2],
}

impl Drawn {
    fn ends(&self) -> [[f64; 2]; 2] {
        let to = self.from + self.sweep * f64::from(self.turns.signum());
        [(self.r[0], self.from), (self.r[1], to)].map(|(r, angle)| {
            let (sin, cos) = libm::sincos(angle);
            [r * cos, r * sin]
        })
    }

    fn path(&self) -> Path<AXES> {
        let [start, end] = self.ends();
        let drift = [0.0, self.drift[0], 0.0, self.drift[1]];
        Path::arc(PLANE, start, end, self.turns, drift, &METRIC).expect("it has a radius")
    }

    /// Position in the plane as seen from the centre.
    fn place(&self, p: [f64; AXES]) -> [f64; 2] {
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
            drift: [0.0; 2],
        },
    )
}

/// Arcs whose other axes go along: helices flat and steep, rotary axes slow and fast.
fn helices(mismatch: f64) -> impl Strategy<Value = Drawn> {
    (arcs(mismatch), prop::array::uniform2(signed(1e-2, 1e3)))
        .prop_map(|(drawn, drift)| Drawn { drift, ..drawn })
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
        prop_assert_eq!(path.at(0.0)[0], [0.0; AXES]);
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
    fn m56_each_derivative_is_that_of_the_one_before(drawn in helices(0.1), share in 0.01..0.99_f64) {
        let path = drawn.path();
        let radius = path.length() / (drawn.sweep + TAU * f64::from(drawn.turns.abs() - 1));
        let (s, h) = (share * path.length(), 1e-4 * radius);
        let (before, at, after) = (path.at(s - h), path.at(s), path.at(s + h));
        for n in 0..4 {
            for i in 0..AXES {
                let slope = (after[n][i] - before[n][i]) / (2.0 * h);
                let scale = radius.powi(-(n as i32)) * path.shares()[i].max(1.0);
                prop_assert!((slope - at[n + 1][i]).abs() < 1e-6 * scale, "p{} of {i}: {slope} for {at:?}", n + 1);
            }
        }
    }

    /// M55 against differences in time, along a law with all of its derivatives. Units of time are those of
    /// the arc.
    #[test]
    fn m55_the_axes_follow_the_law(
        drawn in helices(0.01), share in 0.2..0.8_f64, law in prop::array::uniform4(-1.0..1.0_f64),
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
        for i in 0..AXES {
            let r = r * path.shares()[i].max(1.0);
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
        drawn in prop_oneof![arcs(0.01), helices(0.01)],
        axes in prop::array::uniform4(limits()), feed in magnitude(1e-2, 1.0),
    ) {
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
        let Limits { v, a, j, dj } = drawn.path().limits(&[axis; AXES]);
        let c = 1.0 / drawn.r[0];
        let terms = Limits {
            v,
            a: a + c * v * v,
            j: j + 3.0 * c * v * a + c * c * v * v * v,
            dj: dj + c * (4.0 * v * j + 3.0 * a * a) + 6.0 * c * c * v * v * a + c * c * c * v * v * v * v,
        };
        prop_assert!(keeps(&terms, &axis), "{terms:?} of {axis:?}");
    }

    /// The way of a helix is that of its metric axes: their speed along it is 1, and every axis meets its
    /// end.
    #[test]
    fn m56_a_helix_drifts_evenly(drawn in helices(0.0), share in 0.0..=1.0_f64) {
        let path = drawn.path();
        let flat = drawn.r[0] * (drawn.sweep + TAU * f64::from(drawn.turns.abs() - 1));
        prop_assert!((path.length() / libm::hypot(flat, drawn.drift[0]) - 1.0).abs() < 1e-9);
        let [p, p1, p2, p3, p4] = path.at(share * path.length());
        prop_assert!((libm::hypot(libm::hypot(p1[0], p1[2]), p1[1]) - 1.0).abs() < 1e-12);
        for (i, drift) in [(1, drawn.drift[0]), (3, drawn.drift[1])] {
            prop_assert!((p[i] / (share * drift) - 1.0).abs() < 1e-12 || share == 0.0);
            prop_assert_eq!((p2[i], p3[i], p4[i]), (0.0, 0.0, 0.0));
        }
    }

    /// Shares and bend bound the derivatives, and a circle reaches them.
    #[test]
    fn m56_the_bounds_of_the_derivatives_hold(drawn in helices(0.1), share in 0.0..=1.0_f64) {
        let path = drawn.path();
        let [_, derivatives @ ..] = path.at(share * path.length());
        let [p2, p3, p4] = path.bend();
        for (values, bounds) in derivatives.iter().zip([path.shares(), p2, p3, p4]) {
            for (value, bound) in values.iter().zip(bounds) {
                prop_assert!(value.abs() <= bound * (1.0 + 1e-12), "{value} above {bound} of {path:?}");
            }
        }
        let circle = Drawn { r: [drawn.r[0]; 2], ..drawn }.path();
        let [_, at @ ..] = circle.at(share * circle.length());
        for (values, bounds) in at[1..].iter().zip(circle.bend()) {
            prop_assert!((libm::hypot(values[0], values[2]) / bounds[0] - 1.0).abs() < 1e-9);
        }
    }

    /// What jumps is the difference of the derivatives on both sides.
    #[test]
    fn jumps_are_differences(
        drawn in prop::array::uniform2(helices(0.01)), line in prop::array::uniform4(-9.0..9.0_f64),
    ) {
        let line = Path::line(line, &METRIC).expect("it has a length");
        let paths = [drawn[0].path(), line, drawn[1].path()];
        for (before, behind) in [(0, 1), (1, 2), (0, 2), (1, 1)].map(|(a, b)| (paths[a], paths[b])) {
            let jumps = before.jumps(&behind);
            let (end, start) = (before.at(before.length()), behind.at(0.0));
            for n in 0..3 {
                for i in 0..AXES {
                    prop_assert_eq!(jumps[n][i], start[n + 1][i] - end[n + 1][i]);
                }
            }
        }
    }

    /// Nothing of the path lies outside its box, and the box is no larger than the path.
    #[test]
    fn the_box_fits(drawn in prop_oneof![arcs(0.0), helices(0.0)]) {
        const POINTS: u32 = 2000;
        let path = drawn.path();
        let [low, high] = path.bounds();
        let mut reached = [[f64::INFINITY; AXES], [f64::NEG_INFINITY; AXES]];
        for s in times(path.length(), POINTS) {
            let p = path.at(s)[0];
            for i in 0..AXES {
                prop_assert!(low[i] - 1e-9 <= p[i] && p[i] <= high[i] + 1e-9, "{p:?} beyond {low:?} {high:?}");
                reached[0][i] = reached[0][i].min(p[i]);
                reached[1][i] = reached[1][i].max(p[i]);
            }
        }
        let step = (drawn.sweep + TAU * f64::from(drawn.turns.abs() - 1)) / f64::from(POINTS);
        let missed = step * step * drawn.r[0] + 1e-9;
        for i in 0..AXES {
            prop_assert!(reached[0][i] - low[i] < missed && high[i] - reached[1][i] < missed);
        }
    }
}

#[test]
fn a_line_shares_its_way_among_the_axes() {
    let path = Path::line([0.6, 0.0, -0.8], &[true; 3]).expect("it has a length");
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
    assert!(Path::line([0.0; 3], &[true; 3]).is_none());
}

#[test]
fn ends_at_one_place_make_whole_turns() {
    for (turns, length) in [(1, TAU), (-1, TAU), (3, 3.0 * TAU)] {
        let circle = Path::<2>::arc([0, 1], [1.0, 0.0], [1.0, 0.0], turns, [0.0; 2], &[true; 2])
            .expect("it has a radius");
        assert!((circle.length() - length).abs() < 1e-12, "{turns}");
        let [low, high] = circle.bounds();
        assert!((low[0] + 2.0).abs() < 1e-12 && high[0].abs() < 1e-12);
        // One count of rounding in the end makes no other arc of it.
        for rounded in [-1e-9, 1e-9] {
            let other = Path::<2>::arc([0, 1], [1.0, 0.0], [1.0, rounded], turns, [0.0; 2], &[true; 2])
                .expect("it has a radius");
            assert!((other.length() - length).abs() < 1e-8, "{turns} {rounded}");
        }
    }
    let [_, y] = Path::<2>::arc([0, 1], [1.0, 0.0], [-1.0, 0.0], -1, [0.0; 2], &[true; 2])
        .expect("a radius")
        .at(1e-3)[1];
    assert!(y < 0.0, "negative turns go from the second axis to the first");
}

/// A rotary axis goes along with linear ones, and makes the way where it moves alone.
#[test]
fn a_rotary_axis_makes_the_length_only_alone() {
    let along = Path::line([3.0, 0.0, 4.0, 90.0], &METRIC).expect("it has a length");
    assert_eq!((along.length(), along.shares()[3], along.bend()), (5.0, 18.0, [[0.0; AXES]; 3]));
    let limits = along.limits(&[Limits { v: 36.0, a: 1e3, j: 1e5, dj: 1e7 }; AXES]);
    assert_eq!(limits.v, 2.0, "36 degrees per second at 18 degrees in each millimetre");
    let alone = Path::line([0.0, 0.0, 0.0, -90.0], &METRIC).expect("it has a length");
    assert_eq!((alone.length(), alone.at(45.0)[0][3]), (90.0, -45.0));
}

/// A quarter of a helix of 10 mm that climbs as far as it goes: half of everything is left of the limits of
/// the plane.
#[test]
fn m58_a_steep_helix() {
    let climb = 5.0 * core::f64::consts::PI;
    let (start, end) = ([10.0, 0.0], [0.0, 10.0]);
    let helix = Path::arc(PLANE, start, end, 1, [0.0, climb, 0.0, 0.0], &METRIC).expect("it has a radius");
    let share = 0.5_f64.sqrt();
    assert!((helix.length() - climb / share).abs() < 1e-12);
    let [_, p1, p2, ..] = helix.at(0.0);
    assert!((p1[0] - share).abs() < 1e-15 && (p1[1] - share).abs() < 1e-15 && (p2[2] + 0.05).abs() < 1e-15);
    let wide = Limits { v: 1e9, a: 1e9, j: 1e12, dj: 1e15 };
    let y = Limits { v: 1.0, a: 2.0, j: 3.0, dj: 4.0 };
    let slow = helix.limits(&[wide, y, wide, wide]);
    for (bound, own) in [(slow.v, y.v), (slow.a, y.a), (slow.j, y.j), (slow.dj, y.dj)] {
        assert!((bound * share / own - 1.0).abs() < 1e-12, "{slow:?}");
    }
    let x = helix.limits(&[Limits { v: 1e9, a: 100.0, j: 1e12, dj: 1e15 }, wide, wide, wide]);
    assert!((x.v - (100.0_f64 / 2.0 / 0.05).sqrt()).abs() < 1e-9, "half of 100 = 0.05 v²: {x:?}");
}

#[test]
fn what_is_no_arc_is_none() {
    let arc = |start, end, turns| Path::arc(PLANE, start, end, turns, [0.0; AXES], &METRIC);
    assert!(arc([0.0, 0.0], [1.0, 0.0], 1).is_none());
    assert!(arc([1.0, 0.0], [0.0, 0.0], 1).is_none());
    assert!(arc([1.0, 0.0], [f64::NAN, 0.0], 1).is_none());
    assert!(arc([1.0, 0.0], [0.0, 1.0], 0).is_none());
    let quarter = |plane, drift| Path::arc(plane, [1.0, 0.0], [0.0, 1.0], 1, drift, &METRIC);
    assert!(quarter([2, 2], [0.0; AXES]).is_none());
    assert!(quarter([2, AXES], [0.0; AXES]).is_none());
    assert!(quarter(PLANE, [0.1, 0.0, 0.0, 0.0]).is_none(), "the plane does not drift");
    assert!(quarter(PLANE, [0.0, f64::NAN, 0.0, 0.0]).is_none());
    assert!(Path::line([f64::NAN, 0.0, 0.0, 0.0], &METRIC).is_none());
    assert!(Path::line([1.0, 0.0, 0.0, f64::INFINITY], &METRIC).is_none());
}

#[test]
fn a_turn_beside_the_rounding_of_an_encoder_has_a_length() {
    let turn = Path::line([6e-6, 9.0], &[true, false]).expect("a line");
    assert!((turn.length() - 9.0).abs() < 1e-9);
    let slow = Path::line([0.5, 90.0], &[true, false]).expect("a line");
    assert_eq!(slow.length(), 0.5, "what is a way stays one");
}
