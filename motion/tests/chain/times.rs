//! Time of motion: single moves against the fastest ones with rectangular jerk, a finely divided contour
//! against its feed and against stops.
//!
//! A sin² pulse has the mean of half its peak, so a move from rest to rest takes the time of the fastest one
//! with rectangular jerk at half the jerk (M27). That one has a closed form, by way L and limits V, A, J:
//!
//! ```text
//! peak feed F:  L = 2 F sqrt(F/J) below F = A²/J, L = F²/A + F A/J above it, at most V
//! ramp:         t = 2 sqrt(F/J) or F/A + A/J;  T = t + L/F
//! ```

use crate::programs::{N, through};
use crate::rounded::distance;
use crate::stand::{AXES, CYCLE_S, Stand, ask};
use motion::chain::{Ask, Corner, Feed, Ratios};
use motion::{Binding, FeedBlock, Limits, Path, Ramp};
use testing::Seed;

/// Duration of the fastest move over `way` mm with rectangular jerk, s.
fn rectangular(way: f64, limits: &Limits) -> f64 {
    let Limits { v, a, j, .. } = *limits;
    let by_jerk = libm::cbrt(way * way * j / 4.0);
    let rise = a * a / j;
    let peak = if by_jerk <= rise { by_jerk } else { 0.5 * ((rise * rise + 4.0 * a * way).sqrt() - rise) };
    let peak = peak.min(v);
    let ramp = if peak <= rise { 2.0 * (peak / j).sqrt() } else { peak / a + a / j };
    ramp + way / peak
}

#[test]
fn m27_moves_take_the_time_of_the_fastest_at_half_the_jerk() {
    let mut random = Seed::of_case(27);
    let mut compared = [0; 3];
    for _ in 0..200_000 {
        let limits = Limits {
            v: random.scale(1.0, 1e3),
            a: random.scale(10.0, 1e4),
            j: random.scale(1e3, 1e6),
            dj: random.scale(1e6, 1e10),
        };
        let way = random.scale(1e-3, 1e3);
        let block = FeedBlock::plan(way, 0.0, limits.v, 0.0, &limits).expect("a way from rest to rest");
        let (_, binding) = Ramp::peak_jerk(block.peak_feed(), &limits);
        if binding == Binding::Jerk {
            let fastest = rectangular(way, &Limits { j: 0.5 * limits.j, ..limits });
            let apart = (block.duration() / fastest - 1.0).abs();
            assert!(apart <= 1e-6, "{} s, not {fastest}: {way} mm {limits:?}", block.duration());
            // Each kind of move: without constant acceleration, without cruise, with both.
            let kind = if block.reaches_feed() { 2 } else { usize::from(block.accel().lambda() < 0.5) };
            compared[kind] += 1;
        }
    }
    assert!(compared.iter().all(|kind| *kind > 1000), "{compared:?}");
}

#[test]
fn m27_a_chain_of_one_move_takes_it_too() {
    for way in [[0.01, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 40.0, 0.0], [200.0, -100.0, 50.0]] {
        let blocks = through(&[[0.0; N], way], Feed::Rapid, Corner::Stop);
        let limits = blocks[0].path.limits(&AXES);
        let length = blocks[0].path.length();
        let mut stand = Stand::new(&blocks);
        stand.run(&ask());
        let block = FeedBlock::plan(length, 0.0, limits.v, 0.0, &limits).expect("from rest to rest");
        let made = stand.ticks() as f64 * CYCLE_S;
        assert!((made - block.duration() - 0.5 * CYCLE_S).abs() <= CYCLE_S, "{made} s for {way:?}");
    }
}

/// A closed smooth curve in so many steps of nearly `step` mm, radius 60 to 100 mm.
fn curve(parts: u32, step: f64) -> Vec<[f64; N]> {
    let (mut at, mut heading) = ([0.0; N], 0.0_f64);
    let mut points = vec![at];
    for k in 0..parts {
        let along = step * f64::from(k);
        heading += step / (80.0 + 20.0 * libm::sin(along / 50.0));
        let (sin, cos) = libm::sincos(heading);
        at = [at[0] + step * cos, at[1] + step * sin, 0.0];
        points.push(at);
    }
    points
}

/// Time of motion by the cycles of a chain, and by blocks that stop at their ends, s.
fn times(points: &[[f64; N]], feed: f64, corner: Corner) -> (f64, f64) {
    let blocks = through(points, Feed::PerSecond(feed), corner);
    let mut stand = Stand::new(&blocks);
    stand.run(&ask());
    stand.ends();
    assert_eq!(stand.starved(), 0);
    let stopping = blocks.iter().map(|block| {
        let path: &Path<N> = &block.path;
        let limits = path.limits(&AXES);
        let plan = FeedBlock::plan(path.length(), 0.0, feed.min(limits.v), 0.0, &limits);
        plan.expect("from rest to rest").duration()
    });
    (stand.ticks() as f64 * CYCLE_S, stopping.sum())
}

#[test]
fn a_contour_of_twenty_thousand_lines_runs_at_its_feed() {
    const FEED: f64 = 50.0;
    const STEP: f64 = 0.2;
    let points = curve(20_000, STEP);
    let length = 20_000.0 * STEP;
    let (blended, stopping) = times(&points, FEED, Corner::Blend(0.01));
    assert!(blended <= 1.02 * length / FEED, "{blended} s for {length} mm");
    assert!(blended >= length / FEED, "{blended} s is faster than the feed");
    let factor = stopping * FEED / length;
    assert!((stopping / blended / factor - 1.0).abs() <= 0.02, "{} of {factor}", stopping / blended);
    assert!(factor > 5.0, "stops cost only a factor of {factor}");
}

#[test]
fn exact_stops_cost_what_the_blocks_cost_one_by_one() {
    let (made, stopping) = times(&curve(1000, 0.2), 50.0, Corner::Stop);
    assert!((made - stopping).abs() <= CYCLE_S, "{made} s, not {stopping}");
}

/// What is joined must depend neither on an override that is 0 nor on a spindle that does not turn yet.
#[test]
fn a_feed_per_revolution_is_as_fast_as_the_same_per_second() {
    // Long edges between tight turns.
    let mut points = vec![[0.0; N]];
    for edge in 0..8 {
        let (sin, cos) = libm::sincos(f64::from(edge) * 1.0);
        for length in [0.05, 30.0, 0.05] {
            let at = points[points.len() - 1];
            points.push([at[0] + length * cos, at[1] + length * sin, 0.0]);
        }
    }
    let cycles = |feed: Feed, wait: u64| {
        let blocks = through(&points, feed, Corner::Blend(0.02));
        let mut stand = Stand::new(&blocks);
        let standing = Ask { ratios: Ratios { rapid: 0.0, feed: 0.0, turns: 0.0 }, ..ask() };
        while stand.ticks() < wait {
            stand.tick(&standing);
        }
        stand.run(&ask());
        stand.ends();
        stand.ticks() - wait
    };
    let by_second = cycles(Feed::PerSecond(100.0), 0);
    // 2.4 s at the feed; the tight turns must not slow down the edges between them.
    assert!(by_second < 1900, "{by_second} cycles");
    assert_eq!(cycles(Feed::PerSecond(100.0), 5), by_second);
    assert_eq!(cycles(Feed::PerRevolution(10.0, 200.0), 0), by_second);
    assert_eq!(cycles(Feed::PerRevolution(10.0, 200.0), 5), by_second);
    assert_eq!(cycles(Feed::Rapid, 5), cycles(Feed::Rapid, 0));
}

/// A curve that gets tighter block by block must not be as slow as its tightest part all along.
#[test]
fn a_spiral_takes_as_long_inwards_as_outwards() {
    let mut inwards = Vec::new();
    let mut angle = 0.0;
    for k in 0..4000 {
        let radius = 60.0 * libm::pow(0.05, f64::from(k) / 4000.0);
        inwards.push([radius * libm::cos(angle), radius * libm::sin(angle), 0.0]);
        angle += 0.2 / radius;
    }
    let mut outwards = inwards.clone();
    outwards.reverse();
    let [inn, out] = [&inwards, &outwards].map(|points| times(points, 150.0, Corner::Blend(0.01)).0);
    assert!((inn / out - 1.0).abs() < 0.05, "{inn} s inwards, {out} s outwards");
}

/// A line that hardly has a length, between long ones: what it costs stays with it.
#[test]
fn a_stub_does_not_slow_its_neighbours() {
    let curve = |stub: f64| {
        let (mut points, mut heading) = (vec![[0.0; N]], 0.0_f64);
        for i in 0..40 {
            let length = if i == 20 && stub > 0.0 { stub } else { 1.0 };
            heading += 0.05;
            let last = points[points.len() - 1];
            points.push([last[0] + length * libm::cos(heading), last[1] + length * libm::sin(heading), 0.0]);
        }
        times(&points, 50.0, Corner::Blend(0.01)).0
    };
    let free = curve(0.0);
    for stub in [0.1, 1e-2, 1e-3, 1e-4, 1e-5] {
        let time = curve(stub);
        assert!(time < 1.25 * free, "{time} s with a stub of {stub} mm, {free} s without");
    }
}

/// A long line behind a short one, or before it: the short one has the feed of the corner, the long one its
/// own. Both together take hardly longer than with a stop between them.
#[test]
fn a_long_line_does_not_run_at_the_feed_of_a_corner() {
    for corner in [Corner::Blend(0.01), Corner::Blend(0.1)] {
        for k in 0..=100 {
            let first = 0.01 * libm::pow(100.0, f64::from(k) / 100.0);
            for (along, to) in
                [([0.0, first, 0.0], [0.0, first, 160.0]), ([first, 0.0, 0.0], [160.0, 160.0, 0.0])]
            {
                let points = [[0.0; N], along, to];
                let mut back = points;
                back.reverse();
                for (points, feed) in [(points, 20.0), (points, 1e3), (back, 20.0), (back, 1e3)] {
                    let (blended, stopping) = times(&points, feed, corner);
                    assert!(
                        blended <= 1.05 * stopping,
                        "{blended} s, not {stopping}, at {feed} of {points:?}"
                    );
                }
            }
        }
    }
}

/// Lines of random lengths that turn by up to 2 rad: a stop in every corner is hardly ever faster.
#[test]
fn rounded_corners_are_as_fast_as_stops() {
    const CONTOURS: u64 = 400;
    let mut slower = 0;
    for number in 0..CONTOURS {
        let mut random = Seed::of_case(1100 + number);
        let (short, more) = (random.scale(0.05, 2.0), random.scale(1.0, 10.0));
        let (sharp, lines) = (random.scale(0.1, 2.0), 2 + random.next() % 20);
        let (mut heading, mut points) = (random.between(0.0, 6.0), vec![[0.0; N]]);
        for _ in 0..lines {
            let (last, length) = (points[points.len() - 1], short * random.scale(1.0, more));
            points.push([last[0] + length * libm::cos(heading), last[1] + length * libm::sin(heading), 0.0]);
            heading += sharp * random.between(0.5, 1.0) * if random.chance(0.5) { 1.0 } else { -1.0 };
        }
        let (blended, stopping) = times(&points, 100.0, Corner::Blend(random.scale(0.002, 0.1)));
        assert!(blended <= 1.3 * stopping, "{blended} s, {stopping} with stops: {number}");
        slower += u64::from(blended > 1.02 * stopping + CYCLE_S);
    }
    assert!(slower <= CONTOURS / 50, "{slower} of {CONTOURS} are slower");
}

/// An even division is that of a program: its points are rounded, its lines equal within a millionth.
#[test]
fn an_even_division_stays_one_when_it_is_rounded() {
    let points: Vec<[f64; N]> = (0..2000)
        .map(|k| 0.01 * f64::from(k))
        .map(|turn| [20.0 * libm::cos(turn), 20.0 * libm::sin(turn), 0.0])
        .collect();
    let rounded: Vec<[f64; N]> = points.iter().map(|point| point.map(|x| (x * 1e6).round() / 1e6)).collect();
    let [exact, rounded] = [points, rounded].map(|points| times(&points, 100.0, Corner::Blend(0.01)).0);
    assert!(rounded <= 1.05 * exact, "{rounded} s for rounded points, {exact} s for exact ones");
}

/// A closed wave in chords of `step` mm and up to `more` times that.
pub(crate) fn wave(random: &mut Seed, step: f64, more: f64) -> Vec<[f64; N]> {
    let (waves, size) = (f64::from(2 + (random.next() % 4) as u32), random.between(0.5, 4.0));
    let (mut turn, mut points) = (0.0, Vec::new());
    while turn < std::f64::consts::TAU {
        let radius = 20.0 + size * libm::sin(waves * turn);
        points.push([radius * libm::cos(turn), radius * libm::sin(turn), 2.0 * libm::sin(2.0 * turn)]);
        turn += step * random.between(1.0, more) / 25.0;
    }
    points
}

#[test]
fn a_larger_tolerance_is_never_slower() {
    for number in 0..20 {
        let mut random = Seed::of_case(700 + number);
        let (step, more) = (random.scale(0.05, 1.0), random.scale(1.0, 3.0));
        let points = wave(&mut random, step, more);
        let mut before = f64::INFINITY;
        for tolerance in [0.002, 0.005, 0.01, 0.02, 0.05, 0.1] {
            let (time, _) = times(&points, 100.0, Corner::Blend(tolerance));
            assert!(
                time <= 1.02 * before,
                "{time} s within {tolerance} mm, {before} s within less: {number}"
            );
            before = time;
        }
    }
}

/// Uneven chords have bends of any tightness, one after the other: ramps pass several of them. If each lay
/// within one section, these contours would take 2.3 times as long as by their feed.
#[test]
fn ramps_pass_uneven_bends() {
    let (mut made, mut least) = (0.0, 0.0);
    for number in 0..20 {
        let mut random = Seed::of_case(900 + number);
        let (step, more) = (random.scale(0.2, 1.0), random.between(2.0, 4.0));
        let points = wave(&mut random, step, more);
        let way: f64 = points.windows(2).map(|pair| distance(&pair[0], &pair[1])).sum();
        let (time, _) = times(&points, 100.0, Corner::Blend(0.01));
        (made, least) = (made + time, least + way / 100.0);
    }
    assert!(made < 2.2 * least, "{made} s, {least} s by the feed");
}

#[test]
fn finer_chords_are_never_slower() {
    for number in 0..10 {
        let mut before = f64::INFINITY;
        for step in [1.6, 0.8, 0.4, 0.2, 0.1] {
            let points = wave(&mut Seed::of_case(800 + number), step, 1.5);
            let (time, _) = times(&points, 100.0, Corner::Blend(0.01));
            assert!(
                time <= 1.02 * before,
                "{time} s in chords of {step} mm, {before} s in twice that: {number}"
            );
            before = time;
        }
    }
}

/// What a CAM system writes: uneven chords, rounded to a thousandth. On the mean of six contours: widths are
/// whole numbers of lines, so one may be a tenth faster or slower.
#[test]
fn uneven_lines_of_three_decimals_are_nearly_as_fast_as_even_ones() {
    let curve = |case: u64, more: f64, decimals: f64| {
        let mut random = Seed::of_case(case);
        let mut points = wave(&mut random, 0.2 * 2.0 / (1.0 + more), more);
        points.iter_mut().flatten().for_each(|x| *x = (*x * decimals).round() / decimals);
        times(&points, 100.0, Corner::Blend(0.01)).0
    };
    let mean = |more: f64, decimals: f64| {
        (900..906).map(|case| curve(case, more, decimals) / curve(case, 2.0, 1e9)).sum::<f64>() / 6.0
    };
    let (even, rounded) = (mean(1.0, 1e9), mean(2.0, 1e3));
    assert!(even >= 1.0 / 1.1, "even lines take {even} of the time of uneven ones");
    assert!(rounded <= 1.05, "three decimals take {rounded} of the time of nine");
}
