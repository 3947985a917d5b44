//! Pieces of curves on a chain: one path without joints, as fast as the curve allows, beside lines, held and
//! stopped.

use crate::curve::Curve;
use crate::programs::{CHORD_MM, Line, N, Place, end_of};
use crate::rounded::{Rounded, distance};
use crate::stand::{CYCLE_S, Stand, ask};
use motion::Path;
use motion::chain::{Ask, Block, Corner, Feed, Ratios};
use testing::Seed;

/// Path mode of a machine that keeps to its path.
const EXACT: Corner = Corner::Exact(5e-4);

/// Paths one after the other.
fn chained(paths: &[Path<N>], feed: f64, corner: Corner) -> Vec<Line> {
    let mut at = [0.0; N];
    let block = |(number, path): (usize, &Path<N>)| {
        let tag = Place { number, start: at };
        at = std::array::from_fn(|i| at[i] + end_of(path)[i]);
        Block { path: *path, feed: Feed::PerSecond(feed), corner, room: 1.0, chord_mm: CHORD_MM, tag }
    };
    paths.iter().enumerate().map(block).collect()
}

fn pieces(curve: &Curve, length: f64, step: f64) -> Vec<Path<N>> {
    let number = (length / step).round() as u32;
    let at = |k: u32| length * f64::from(k) / f64::from(number);
    (0..number).map(|k| curve.piece(at(k), at(k + 1))).collect()
}

fn time(blocks: &[Line]) -> f64 {
    let path = Rounded::new(blocks);
    let mut stand = Stand::new(blocks);
    while stand.tick(&ask()) {
        if let Some(seen) = &stand.last {
            path.holds(seen);
        }
    }
    stand.ends();
    stand.ticks() as f64 * CYCLE_S
}

/// A whole circle in pieces of a third of its radius is as fast as the arc, whatever binds.
#[test]
fn a_circle_in_pieces_takes_the_time_of_the_arc() {
    for radius in [0.5, 3.0, 20.0, 200.0] {
        let ends = [radius, 0.0];
        let arc = Path::arc([0, 1], ends, ends, 1, [0.0; N], &[true; N]).expect("a radius");
        let circle = Curve { heading: std::f64::consts::FRAC_PI_2, ..Curve::circle(radius) };
        let pieces = pieces(&circle, arc.length(), 0.3 * radius);
        for feed in [2.0, 20.0, 100.0, 1000.0] {
            let [whole, parts] = [&[arc][..], &pieces].map(|paths| time(&chained(paths, feed, EXACT)));
            assert!(parts <= 1.05 * whole, "radius {radius}, feed {feed}: {parts} s, the arc {whole} s");
        }
    }
}

/// Shorter pieces have tighter bounds. They gain nothing worth while: those as long as their accuracy allows
/// are good.
#[test]
fn short_pieces_are_hardly_faster() {
    for seed in 0..4 {
        for (radius, feed) in [(2.0, 30.0), (2.0, 1000.0), (10.0, 100.0), (10.0, 1000.0), (40.0, 1000.0)] {
            let curve = Curve::random(&mut Seed::of_case(seed), 0.0, radius);
            let [long, short] = [0.4, 0.04]
                .map(|share| time(&chained(&pieces(&curve, 60.0 * radius, share * radius), feed, EXACT)));
            assert!(
                long <= 1.04 * short,
                "radius {radius}, feed {feed}: {long} s, {short} s in short pieces"
            );
        }
    }
}

/// Where no limit binds the feed is as programmed, along the path and of the tip in space; nothing is rounded
/// at joints.
#[test]
fn the_feed_is_constant_over_joints() {
    const FEED: f64 = 30.0;
    let curve = Curve::random(&mut Seed::of_case(7), 0.0, 15.0);
    let blocks = chained(&pieces(&curve, 600.0, 4.0), FEED, EXACT);
    let mut stand = Stand::new(&blocks);
    let (mut steady, mut reached) = (0, false);
    while stand.tick(&ask()) {
        let Some(seen) = stand.last else { continue };
        let Line { path, tag, .. } = &blocks[seen.step.tag.number];
        let [p, ..] = path.at(seen.step.along.s);
        let right = std::array::from_fn(|i| tag.start[i] + p[i]);
        assert!(distance(&right, &seen.axes.map(|axis| axis.s)) <= 1e-12, "{seen:?}");
        let pace = distance(&seen.axes.map(|axis| axis.v), &[0.0; N]);
        assert!((pace - seen.step.along.v).abs() <= 1e-6 * FEED, "{pace} for {seen:?}");
        reached |= seen.step.along.v >= FEED * (1.0 - 1e-9);
        steady += u32::from(reached && (pace / FEED - 1.0).abs() <= 1e-6);
    }
    stand.ends();
    // All of the time but for the ramps at both ends.
    let ramps = 2.0 * 0.1 / CYCLE_S;
    assert!(f64::from(steady) + ramps >= stand.ticks() as f64, "{steady} of {} cycles", stand.ticks());
}

/// Lowest speed within a hundredth of a millimetre of the end of block `number`, mm/s.
fn speed_at_end(blocks: &[Line], number: usize) -> f64 {
    let path = Rounded::new(blocks);
    let mut stand = Stand::new(blocks);
    let slow = Ask { ratios: Ratios { rapid: 0.2, feed: 0.2, turns: 2.0 }, ..ask() };
    let mut least = f64::INFINITY;
    while stand.tick(&slow) {
        let Some(seen) = &stand.last else { continue };
        path.holds(seen);
        let (at, s) = (seen.step.tag.number, seen.step.along.s);
        let length = blocks[number].path.length();
        if at == number && s > length - 0.01 || at == number + 1 && s < 0.01 {
            least = least.min(seen.step.along.v);
        }
    }
    stand.ends();
    least
}

/// A line runs into a curve: a jump of curvature is made smooth, a corner is stopped at or rounded as the
/// mode says. A small tolerance would be crawled through: a stop is faster.
#[test]
fn corners_between_pieces_and_lines() {
    let curve = Curve::random(&mut Seed::of_case(3), 0.0, 12.0);
    let parts = pieces(&curve, 24.0, 3.0);
    let [forward, ..] = curve.direction(0.0);
    let [last, ..] = curve.direction(24.0);
    let line = |way: [f64; N]| Path::line(way.map(|way| 10.0 * way), &[true; N]).expect("a way");
    let aside = [forward[1], -forward[0], forward[2]];
    for (way, corner, stops) in [
        (forward, EXACT, false),
        (forward, Corner::Blend(0.01), false),
        (forward, Corner::Stop, true),
        (aside, EXACT, true),
        (aside, Corner::Blend(0.01), true),
        (aside, Corner::Blend(1.0), false),
    ] {
        let all: Vec<Path<N>> = [line(way)].into_iter().chain(parts.clone()).collect();
        let speed = speed_at_end(&chained(&all, 20.0, corner), 0);
        assert_eq!(speed < 0.2, stops, "{speed} mm/s into the curve, {corner:?}");
    }
    let all: Vec<Path<N>> = parts.iter().copied().chain([line(last)]).collect();
    let speed = speed_at_end(&chained(&all, 20.0, EXACT), parts.len() - 1);
    assert!(speed > 0.2, "{speed} mm/s out of the curve");
}
