//! Runs of lines become curves: which of them do, what a curve keeps of its lines, and how far the whole path
//! leads away from the program.

use interpreter::Check;
use motion::Path;
use protocol::{Axis, Code, Feed, PerAxis, Position, units::AXES};
use testing::{Seed, count};

use crate::mill::{good_on, mill, mill_with_c};

/// Points of a wave of 40 mm, 0.1 mm apart.
fn wave() -> Vec<[f64; 2]> {
    (0..=400).map(|k| f64::from(k) * 0.1).map(|x| [x, 3.0 * libm::sin(x / 3.0)]).collect()
}

/// A program along points, with words for its start and something before a line or two.
fn program(start: &str, points: &[[f64; 2]], between: &[(usize, &str)]) -> String {
    let mut text = format!("G21 G90 G17 G94 S1000 M3 {start}\nG0 X{} Y{} Z-50\n", points[0][0], points[0][1]);
    for (k, [x, y]) in points.iter().enumerate().skip(1) {
        between.iter().filter(|(at, _)| *at == k).for_each(|(_, words)| text += &format!("{words}\n"));
        text += &format!("G1 X{x:.6} Y{y:.6}\n");
    }
    text + "M2\n"
}

fn curves(check: &Check) -> usize {
    check.items.iter().filter(|item| matches!(item.code, Code::Curve { .. })).count()
}

/// Every feed of the program, where it ends, and the line that it is from.
fn feeds(check: &Check) -> Vec<(u32, Feed, PerAxis<Position>)> {
    let feed = |item: &protocol::Item| {
        let feed = item.code.feed().filter(|feed| *feed != Feed::Rapid)?;
        Some((item.line, feed, *item.code.target()?))
    };
    check.items.iter().filter_map(feed).collect()
}

#[test]
fn a_run_of_lines_becomes_a_few_pieces_that_end_where_it_ends() {
    let check = good_on(&mill(), &program("G64 P0.01 F1000", &wave(), &[]));
    let feeds = feeds(&check);
    assert!(feeds.len() == curves(&check) && feeds.len() < 100, "{} of 400 lines", feeds.len());
    let (line, feed, target) = feeds[feeds.len() - 1];
    let [x, y] = wave()[400];
    assert_eq!((line, feed), (402, Feed::PerMinute(1000.0)));
    assert_eq!(target[0], Position::from_mm(x));
    assert!((target[1].mm() - y).abs() < 1e-6, "six decimals");
    assert!(feeds.windows(2).all(|pair| pair[0].0 <= pair[1].0), "lines of the program in order");
}

/// Another F and a message end a piece, not the run: every piece has the feed of its lines, and the message
/// its place among them.
#[test]
fn another_f_or_a_message_ends_a_piece_and_not_the_run() {
    let words = |k: usize| if k % 20 == 10 { "F1000" } else { "F990" };
    let changes: Vec<(usize, &str)> = (10..400).step_by(10).map(|k| (k, words(k))).collect();
    let one = good_on(&mill(), &program("G64 P0.01 F990", &wave(), &[]));
    let check = good_on(&mill(), &program("G64 P0.01 F990", &wave(), &changes));
    let feeds = feeds(&check);
    assert_eq!(feeds.len(), curves(&check));
    assert!(feeds.len() <= curves(&one) + changes.len(), "{} and {}", feeds.len(), curves(&one));
    // The wave begins with F990, and changes at x = 0.9, 1.9 …; a piece that ends within 0.03 mm has the
    // lower one.
    for (_, feed, target) in &feeds {
        let tens = target[0].mm() + 0.1 - 1e-6;
        let near = (tens - tens.round()).abs() < 0.05;
        let asked = if (tens as u32).min(39) % 2 == 1 { 1000.0 } else { 990.0 };
        assert!(near || *feed == Feed::PerMinute(asked), "{feed:?} to {tens}");
    }
    for at in [2, 200, 390] {
        let told = good_on(&mill(), &program("G64 P0.01 F990", &wave(), &[(at, "(MSG, here)")]));
        assert!(curves(&told) <= curves(&one) + 1, "{at}");
        let [message] = &told.messages[..] else { panic!("{:?}", told.messages) };
        let mut steps = 0;
        let before = told.items.iter().take_while(|item| {
            steps += item.steps();
            steps <= message.after
        });
        let end = before.filter_map(|item| item.code.target()).last().expect("a move before it");
        let there = 0.1 * (at - 1) as f64;
        assert!((end[0].mm() - there).abs() < 0.04, "told at {} instead of {there}", end[0].mm());
    }
}

#[test]
fn what_is_to_be_exact_stays_lines() {
    for start in ["G64 P0.01 Q0 F1000", "G61 F1000", "G61.1 F1000", "G64 P0.0004 F1000"] {
        assert_eq!(curves(&good_on(&mill(), &program(start, &wave(), &[]))), 0, "{start}");
    }
    let text = program("G64 P0.01 F1000", &wave(), &[]).replace("G1 X", "G0 X");
    assert_eq!(curves(&good_on(&mill(), &text)), 0, "rapids");
    let few = good_on(&mill(), &program("G64 P0.01 F1000", &wave()[..4], &[]));
    assert_eq!((curves(&few), feeds(&few).len()), (0, 3), "a few lines");
}

#[test]
fn another_axis_ends_a_run() {
    let mut text = program("G64 P0.01 F1000", &wave(), &[]);
    assert!(curves(&good_on(&mill_with_c(), &text)) > 0);
    for (k, line) in text.clone().lines().filter(|line| line.starts_with("G1")).enumerate() {
        text = text.replacen(&format!("{line}\n"), &format!("{line} C{}\n", k % 90), 1);
    }
    assert_eq!(curves(&good_on(&mill_with_c(), &text)), 0);
}

#[test]
fn lines_at_the_end_of_travel_stay() {
    let mut machine = mill();
    let high = wave().iter().map(|[_, y]| *y).fold(0.0, f64::max);
    machine.axis.get_mut(&Axis::Y).expect("a mill has Y").travel_mm[1] = high + 0.001;
    let check = good_on(&machine, &program("G64 P0.01 F1000", &wave(), &[]));
    let most = |target: &PerAxis<Position>| target[1].mm();
    let near: Vec<bool> = check
        .items
        .iter()
        .filter(|item| item.code.target().is_some_and(|target| most(target) > high - 0.005))
        .map(|item| matches!(item.code, Code::Line { .. }))
        .collect();
    assert!(near.len() > 2 && near.iter().all(|line| *line), "{near:?}");
    assert!(curves(&check) > 0, "elsewhere they are smoothed");
}

#[test]
fn another_feed_ends_a_run() {
    let check = good_on(&mill(), &program("G64 P0.01 F1000", &wave(), &[(200, "F300"), (220, "F2000")]));
    let at = |target: &PerAxis<Position>| target[0].mm();
    let (mut seen, mut from) = ([0, 0, 0], 0.0);
    for (_, feed, target) in feeds(&check) {
        let to = at(&target);
        let part = usize::from(from > 19.85) + usize::from(from > 21.85);
        assert_eq!(feed, Feed::PerMinute([1000.0, 300.0, 2000.0][part]), "from {from} to {to}");
        assert!(to < [19.95, 21.95, 41.0][part], "to {to}");
        seen[part] += 1;
        from = to;
    }
    assert!(seen.iter().all(|count| *count > 1), "{seen:?}");
    let turns = program("G64 P0.01 F1000", &wave(), &[(200, "G95 F0.2")]);
    assert!(curves(&good_on(&mill(), &turns)) > 0);
}

/// Offsets move a curve as a whole: every number of it but its places is the same to the last bit.
#[test]
fn a_curve_elsewhere_is_the_same_curve() {
    let here = good_on(&mill(), &program("G64 P0.01 F1000", &wave(), &[]));
    let there = good_on(&mill(), &program("G10 L2 P1 X0.0371 Y-0.0213\nG64 P0.01 F1000", &wave(), &[]));
    let bends = |check: &Check| -> Vec<_> {
        let bend = |item: &protocol::Item| match item.code {
            Code::Curve { curve, .. } => Some((curve.way, curve.start, curve.end, curve.length_mm)),
            _ => None,
        };
        check.items.iter().filter_map(bend).collect()
    };
    assert!(!bends(&here).is_empty());
    assert_eq!(bends(&here), bends(&there));
}

#[test]
fn a_message_stands_where_it_stands_in_the_program() {
    let check = good_on(&mill(), &program("G64 P0.01 F1000", &wave(), &[(200, "(MSG, half of it)")]));
    let message = &check.messages[0];
    let before: u64 =
        check.items.iter().filter(|item| item.line < message.line).map(protocol::Item::steps).sum();
    assert_eq!(message.after, before);
    assert!(curves(&check) > 0);
}

/// Places along a path that starts at `from`, mm.
fn places(from: &PerAxis<Position>, path: &Path<AXES>) -> Vec<[f64; 3]> {
    let count = (path.length() / 0.01).ceil().clamp(4.0, 4000.0);
    let place = |k: u32| {
        let [gone, ..] = path.at(path.length() * f64::from(k) / count);
        std::array::from_fn(|i| from[i].mm() + gone[i])
    };
    (0..=count as u32).map(place).collect()
}

fn beside(point: &[f64; 3], from: &[f64; 3], to: &[f64; 3]) -> f64 {
    let (mut along, mut square) = (0.0, 0.0);
    for i in 0..3 {
        along += (point[i] - from[i]) * (to[i] - from[i]);
        square += (to[i] - from[i]) * (to[i] - from[i]);
    }
    let share = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
    (0..3).map(|i| point[i] - from[i] - share * (to[i] - from[i])).map(|off| off * off).sum::<f64>().sqrt()
}

/// Of random programs, merged and smoothed: the path of the items lies within P of the lines of the program,
/// and the points of the program within P of that path, each beside its own lines.
#[test]
fn the_path_of_random_programs_stays_within_p_of_the_program() {
    let mut smoothed = 0;
    for case in 0..count("PITCHLOCK_CURVES", 40) {
        let mut random = Seed::of_case(case);
        let p = random.scale(0.003, 0.05);
        let (short, long, bend) =
            (random.scale(0.005, 0.3), random.scale(1.0, 30.0), random.scale(0.01, 0.3));
        let (mut at, mut heading, mut points) = ([0.0_f64; 2], 0.0, vec![[0.0; 3]]);
        for _ in 0..300 {
            heading += bend * random.signed() + if random.chance(0.04) { 2.5 * random.signed() } else { 0.0 };
            if at[0].abs().max(at[1].abs()) > 100.0 {
                heading = libm::atan2(-at[1], -at[0]);
            }
            let length = short * random.scale(1.0, long);
            at = [at[0] + length * libm::cos(heading), at[1] + length * libm::sin(heading)];
            let rounded = at.map(|mm| (mm * 1e4).round() / 1e4);
            points.push([rounded[0], rounded[1], -50.0]);
        }
        points[0][2] = -50.0;
        let flat: Vec<[f64; 2]> = points.iter().map(|[x, y, _]| [*x, *y]).collect();
        let check = good_on(&mill(), &program(&format!("G64 P{p:.6} F3000"), &flat, &[]));
        smoothed += curves(&check);
        let (mut here, mut begun, most) = (mill().home(), 1_usize, p + 1e-5);
        let mut passed = vec![f64::INFINITY; points.len()];
        for item in &check.items {
            let Some(target) = item.code.target() else { continue };
            let path = match &item.code {
                Code::Curve { curve, .. } => {
                    Some(curve.path(&here).expect("it leads on from the item before"))
                }
                Code::Line { feed, .. } if *feed != Feed::Rapid => {
                    Path::line(std::array::from_fn(|i| target[i].mm_from(here[i])), &Axis::METRIC)
                }
                _ => None,
            };
            // Point k ends line k + 2 of the program. A piece may begin within a line that is a hundred.
            let (first, ends) = (begun.saturating_sub(100).max(1), item.line.saturating_sub(2) as usize);
            let way = path.map(|path| places(&here, &path)).unwrap_or_default();
            for place in &way {
                let off = (first..=ends).map(|k| beside(place, &points[k - 1], &points[k]));
                let off = off.fold(f64::INFINITY, f64::min);
                assert!(off <= most, "case {case}: {off} of {p} beside lines {first} to {ends} at {place:?}");
            }
            for pair in way.windows(2) {
                for k in first - 1..=ends {
                    passed[k] = passed[k].min(beside(&points[k], &pair[0], &pair[1]));
                }
            }
            (here, begun) = (*target, ends.max(1));
        }
        let missed = passed.iter().enumerate().find(|(_, off)| **off > most);
        assert!(missed.is_none(), "case {case}: past a point by more than {p}: {missed:?}");
    }
    assert!(smoothed > 1000, "{smoothed} pieces");
}
