//! The compressor: whatever the lines are, what leaves is within the tolerance of them, both ways, and
//! smooth.

use motion::Path;
use shape::{Bow, Compressor, Course, Leeway};
use testing::{Seed, count};

type Point = [f64; 3];

const LEEWAY: Leeway = Leeway { corner: 0.008, flat: 0.009, tip: 0.002 };

fn apart(a: &Point, b: &Point) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// How far a point is beside a line.
fn beside(point: &Point, [from, to]: [&Point; 2]) -> f64 {
    let (mut along, mut square) = (0.0, 0.0);
    for i in 0..3 {
        along += (point[i] - from[i]) * (to[i] - from[i]);
        square += (to[i] - from[i]) * (to[i] - from[i]);
    }
    let share = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
    apart(point, &std::array::from_fn(|i| from[i] + share * (to[i] - from[i])))
}

/// What became of lines: whole lines by their number, or pieces with the lines along which each leads.
#[derive(Debug)]
enum Out {
    Line(usize),
    Bow(Box<Bow>, Vec<usize>),
}

fn compressed(points: &[Point], leeway: Leeway) -> Vec<Out> {
    parted(points, leeway, |_, _| false)
}

fn parted(points: &[Point], leeway: Leeway, apart: fn(&usize, &usize) -> bool) -> Vec<Out> {
    let mut all = Vec::new();
    let mut out = |course: Course<'_, usize>| {
        all.push(match course {
            Course::Line(line) => Out::Line(*line),
            Course::Bow { bow, over } => Out::Bow(Box::new(bow), over.to_vec()),
        });
    };
    let mut compressor = Compressor::new(points[0], leeway, apart);
    for (line, point) in points.iter().enumerate().skip(1) {
        compressor.add(*point, line, &mut out);
    }
    compressor.finish(&mut out);
    assert!(!compressor.holds());
    all
}

/// Places of a piece.
fn places(bow: &Bow, count: u32) -> Vec<Point> {
    let path = Path::piece(&bow.start, &bow.end, bow.length).expect("a piece");
    let place = |k: u32| {
        let [gone, ..] = path.at(bow.length * f64::from(k) / f64::from(count));
        std::array::from_fn(|i| bow.start[0][i] + gone[i])
    };
    (0..=count).map(place).collect()
}

/// Holds that what leaves begins where the lines do, goes on without a gap or a jump of three derivatives
/// inside of a curve, stays within `most` of the lines it leads along, passes every point within `most`, and
/// ends where the lines end. How many pieces.
fn holds(points: &[Point], outs: &[Out], most: f64) -> usize {
    let (mut at, mut next, mut pieces) = (points[0], 1, 0);
    let mut before: Option<&Bow> = None;
    let mut nearest = vec![f64::INFINITY; points.len()];
    for out in outs {
        match out {
            Out::Line(line) => {
                assert!(apart(&at, &points[line - 1]) < 1e-12, "line {line} begins elsewhere");
                (at, next, before) = (points[*line], line + 1, None);
                (nearest[line - 1], nearest[*line]) = (0.0, 0.0);
            }
            Out::Bow(bow, over) => {
                let bow: &Bow = bow;
                assert!(
                    over[0] <= next + 1 && over.windows(2).all(|pair| pair[1] == pair[0] + 1),
                    "{over:?} {next}"
                );
                assert!(apart(&at, &bow.start[0]) < 1e-9, "a gap at {at:?}");
                // A run begins in a point; there blends round what jumps.
                let begins = apart(&bow.start[0], &points[over[0] - 1]) < 1e-12;
                if let Some(before) = before.filter(|_| !begins) {
                    for (n, (end, start)) in before.end.iter().zip(&bow.start).enumerate().skip(1) {
                        let size = apart(end, &[0.0; 3]) + bow.length.min(before.length).powi(1 - n as i32);
                        assert!(apart(end, start) <= 1e-7 * size, "p{n} jumps at {at:?}: {end:?} {start:?}");
                    }
                }
                let (first, last) = (over[0], over[over.len() - 1]);
                for place in places(bow, 24) {
                    let off = (first..=last).map(|k| beside(&place, [&points[k - 1], &points[k]]));
                    let off = off.fold(f64::INFINITY, f64::min);
                    assert!(off <= most, "{off} beside lines {first} to {last}");
                }
                let fine = places(bow, 64);
                for k in first - 1..=last {
                    let off = fine.windows(2).map(|pair| beside(&points[k], [&pair[0], &pair[1]]));
                    nearest[k] = off.fold(nearest[k], f64::min);
                }
                let turn =
                    Path::piece(&bow.start, &bow.end, bow.length).expect("a piece").at(0.37 * bow.length);
                assert!((apart(&turn[1], &[0.0; 3]) - 1.0).abs() < 1e-4, "not by its length: {:?}", turn[1]);
                (at, next, before, pieces) = (bow.end[0], last + 1, Some(bow), pieces + 1);
                if apart(&at, &points[last]) > 1e-12 {
                    next = last;
                } else {
                    at = points[last];
                }
            }
        }
    }
    assert_eq!((at, next), (points[points.len() - 1], points.len()), "all lines are gone, the end is exact");
    let missed = nearest.iter().enumerate().find(|(_, off)| **off > most);
    assert!(missed.is_none(), "a point is passed by at {missed:?}");
    pieces
}

/// Lines that wander, turn sharply now and then, and are of all lengths.
fn wander(random: &mut Seed) -> Vec<Point> {
    let lines = 2 + random.below(400);
    let (short, long) = (random.scale(1e-3, 0.5), random.scale(1.0, 100.0));
    let (smooth, sharp) = (random.scale(1e-3, 0.3), if random.chance(0.5) { 0.0 } else { 0.1 });
    let decimals = 10_f64.powi(3 + random.below(6) as i32);
    let (mut points, mut heading, mut climb) = (vec![[0.0; 3]], 0.0, 0.0);
    let drift = random.signed() * smooth;
    for _ in 0..lines {
        let length = short * random.scale(1.0, long);
        heading +=
            drift + smooth * random.signed() + if random.chance(sharp) { 3.0 * random.signed() } else { 0.0 };
        climb = (climb + 0.5 * smooth * random.signed()).clamp(-0.7, 0.7);
        let [x, y, z] = points[points.len() - 1];
        let (flat, rise) = (libm::cos(climb), libm::sin(climb));
        let to = [
            x + length * flat * libm::cos(heading),
            y + length * flat * libm::sin(heading),
            z + length * rise,
        ];
        let to = to.map(|mm| (mm * decimals).round() / decimals);
        if to != points[points.len() - 1] {
            points.push(to);
        }
    }
    points
}

#[test]
fn random_lines_are_left_by_the_tolerance_at_most_both_ways() {
    let (mut curves, mut lines) = (0, 0);
    for case in 0..count("PITCHLOCK_CURVES", 60) {
        let mut random = Seed::of_case(case);
        let points = wander(&mut random);
        if points.len() < 3 {
            continue;
        }
        let p = random.scale(0.002, 0.1);
        let leeway = Leeway { corner: 0.8 * p, flat: 0.9 * p, tip: 0.2 * p };
        let outs = compressed(&points, leeway);
        curves += holds(&points, &outs, leeway.flat * (1.0 + 1e-9));
        lines += points.len();
    }
    assert!(curves > lines / 10, "{curves} pieces of {lines} lines: hardly anything was smoothed");
}

/// A circle of 20 mm in chords.
fn circle(length: impl Fn(usize) -> f64) -> Vec<Point> {
    let (mut turn, mut points) = (0.0, Vec::new());
    while turn < 6.0 {
        points.push([20.0 * libm::cos(turn), 20.0 * libm::sin(turn), 0.0]);
        turn += length(points.len()) / 20.0;
    }
    points
}

#[test]
fn chords_of_a_circle_become_nearly_a_circle() {
    let points = circle(|_| 0.2);
    let outs = compressed(&points, LEEWAY);
    assert!(holds(&points, &outs, LEEWAY.flat) < points.len() / 6, "a piece is long where it may be");
    let mut fourth = 0.0_f64;
    for out in &outs {
        let Out::Bow(bow, _) = out else { panic!("{out:?}") };
        let path = Path::piece(&bow.start, &bow.end, bow.length).expect("a piece");
        for k in 0..=8 {
            let [_, _, second, _, jerk] = path.at(bow.length * f64::from(k) / 8.0);
            let bend = apart(&second, &[0.0; 3]);
            assert!((bend - 0.05).abs() < 0.01, "{bend} 1/mm");
            fourth = fourth.max(apart(&jerk, &[0.0; 3]));
        }
    }
    // That of a circle is 1/20³; of chords rounded one by one it is hundreds.
    assert!(fourth < 0.05, "{fourth} 1/mm3");
}

#[test]
fn uneven_chords_cost_little_more_than_even_ones() {
    let uneven = circle(|k| if k % 3 == 0 { 0.4 } else { 0.13 });
    let outs = compressed(&uneven, LEEWAY);
    holds(&uneven, &outs, LEEWAY.flat);
    let fourth = outs.iter().filter_map(|out| match out {
        Out::Bow(bow, _) => Path::piece(&bow.start, &bow.end, bow.length),
        Out::Line(_) => None,
    });
    let most = fourth.map(|path| apart(&path.bend()[2], &[0.0; 3])).fold(0.0, f64::max);
    assert!(most < 0.2, "{most} 1/mm3");
}

#[test]
fn corners_and_a_few_lines_stay_as_they_are() {
    let square = [[0.0; 3], [10.0, 0.0, 0.0], [10.0, 10.0, 0.0], [0.0, 10.0, 0.0], [0.0; 3]];
    let outs = compressed(&square, LEEWAY);
    assert!(matches!(outs[..], [Out::Line(1), Out::Line(2), Out::Line(3), Out::Line(4)]), "{outs:?}");
    let bent = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.1, 0.0], [3.0, 0.3, 0.0]];
    assert!(matches!(compressed(&bent, LEEWAY)[..], [Out::Line(1), Out::Line(2), Out::Line(3)]));
}

#[test]
fn a_run_of_a_hundred_thousand_lines_leaves_as_it_comes() {
    let mut compressor = Compressor::new([0.0; 3], LEEWAY, |_, _| false);
    let (mut waits, mut most, mut pieces) = (0_usize, 0, 0);
    for k in 1..=100_000_usize {
        waits += 1;
        let t = k as f64 * 0.004;
        let to = [40.0 * libm::sin(t), 40.0 * (1.0 - libm::cos(t)), 1e-4 * k as f64];
        compressor.add(to, k, &mut |course| {
            if let Course::Bow { over, .. } = course {
                (waits, pieces) = (k + 1 - over[0], pieces + 1);
            }
        });
        most = most.max(waits);
    }
    assert!(most <= 4200 && pieces > 1500, "{most} lines waited, {pieces} pieces");
}

/// A piece ends where lines are apart, or within 0.03 mm of there, and the curve goes on as if it did not.
#[test]
fn pieces_end_between_lines_that_are_apart() {
    let mut t = 0.0;
    let mut points: Vec<Point> = Vec::new();
    for k in 0..1000 {
        points.push([20.0 * libm::cos(t), 20.0 * libm::sin(t), 0.0]);
        t += 0.0025 * (1.0 + 0.2 * libm::sin(f64::from(k)));
    }
    let outs = parted(&points, LEEWAY, |a, b| a / 7 != b / 7);
    holds(&points, &outs, LEEWAY.flat);
    let (mut borders, mut mixed) = (0, 0);
    for out in &outs {
        let Out::Bow(bow, over) = out else { continue };
        let (first, last) = (over[0], over[over.len() - 1]);
        for line in (first..last).filter(|line| line / 7 != (line + 1) / 7) {
            let ends = [&bow.start[0], &bow.end[0]].map(|end| apart(end, &points[line]));
            assert!(ends[0].min(ends[1]) < 0.03 + LEEWAY.corner, "{ends:?} at line {line}");
            mixed += 1;
        }
        borders += usize::from(last % 7 == 6 && apart(&bow.end[0], &points[last]) < LEEWAY.corner);
    }
    assert!(borders > 100 && mixed < 20, "{borders} borders, {mixed} beside one");
}

/// A corner ends a run that it does not fit into: one of 20° between lines of 5 mm in steps of 0.2 mm.
#[test]
fn a_corner_that_stands_alone_ends_a_run() {
    let leg = |k: usize, [x, y]: [f64; 2], turn: f64| {
        let way = 0.2 * k as f64;
        [x + way * libm::cos(turn), y + way * libm::sin(turn), 0.0]
    };
    for (turn, runs) in [(0.02, 1), (0.35, 2)] {
        let mut points: Vec<Point> = (0..=25).map(|k| leg(k, [0.0; 2], 0.0)).collect();
        points.extend((1..=25).map(|k| leg(k, [5.0, 0.0], turn)));
        let outs = compressed(&points, LEEWAY);
        holds(&points, &outs, LEEWAY.flat);
        let corner =
            |out: &&Out| matches!(out, Out::Bow(bow, _) if apart(&bow.end[0], &[5.0, 0.0, 0.0]) < 1e-12);
        assert_eq!(outs.iter().filter(corner).count() + 1, runs, "{turn}");
    }
}

/// Lines of 0.1 mm with three decimals, along a wave, with a corner that they cut in two 0.05 mm apart: there
/// the intervals are a thirtieth of those elsewhere, and all of it is a curve.
#[test]
fn one_narrow_place_leaves_the_rest_a_curve() {
    for case in 0..20 {
        let mut random = Seed::of_case(case);
        let (wave, swing) = (random.between(1.5, 4.0), random.between(0.3, 0.9));
        let turns = [random.between(0.2, 0.45), random.between(0.2, 0.45)];
        let (mut points, mut heading, [mut x, mut y]) = (vec![[0.0; 3]], 0.0, [0.0; 2]);
        for k in 0..700_u32 {
            heading += 0.1 * swing / wave * libm::cos(0.1 * f64::from(k) / wave);
            heading += if k == 400 { turns[0] } else { 0.0 };
            heading += if k == 401 { turns[1] } else { 0.0 };
            let length = if k == 400 { 0.05 } else { 0.1 };
            (x, y) = (x + length * libm::cos(heading), y + length * libm::sin(heading));
            points.push([x, y, 0.0].map(|mm| (1e3 * mm).round() / 1e3));
        }
        let outs = compressed(&points, LEEWAY);
        holds(&points, &outs, LEEWAY.flat);
        let lines = outs.iter().filter(|out| matches!(out, Out::Line(_))).count();
        assert!(lines <= 2, "case {case}: {lines} lines stay lines");
    }
}
