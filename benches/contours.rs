//! How long contours take that CAM systems write as lines. `cargo bench --bench contours` prints, for each of
//! them, the time that `pitchlock check` foretells at 6 m/min on the small mill, beside length by feed: with
//! several tolerances P of G64, with Q, and with coordinates of three decimals.
//!
//! The contours are made here, so anybody can make them again: circles in chords of equal and unequal
//! lengths, a Lissajous curve in space, an involute gear, a trochoid, lines over a triangle mesh, strokes
//! like letters, a zigzag. Chords lie within so many micrometres of their curve.
//!
//! A second table has the least time within the same limits on the path that interpreter and chain make of
//! the lines where every corner is rounded (`optimum/mod.rs`), from grids of two steps, and how many times
//! longer the chain takes, which stops where that is faster.
//!
//! `LINUXCNC=/path/to/linuxcnc cargo bench --bench contours` compares with LinuxCNC's planner instead, from a
//! checkout of its release 2.9 (`linuxcnc/mod.rs`). `FOLLOWED=10 cargo bench --bench contours` runs them with
//! ten seeds and says how far the slides are from the contours (`followed/mod.rs`).
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

use machine::Machine;
use motion::chain::{Ask, Block, Chain, Corner, Feed, Ratios, Settings};
use motion::{Limits, Path};
use protocol::Code;
use testing::Seed;

use optimum::{Caps, least_time, places};

mod followed;
mod linuxcnc;
mod optimum;

const FEED_MM_MIN: f64 = 6000.0;
/// Travel of every axis, so that all contours fit, mm.
const TRAVEL_MM: [f64; 2] = [-2000.0, 2000.0];
/// Words of G64 that are compared.
const MODES: [&str; 5] = ["P0.005", "P0.01", "P0.02", "P0.05", "P0.01 Q0.05"];

/// What G64 P0.01 comes to at a corner, mm.
const CORNER: Corner = Corner::Curve { corner: 0.008, flat: 0.009, tip: 0.002 };
/// Step of the grid on which the least time is sought, mm, and that for contours with sharp corners.
const GRID_MM: f64 = 0.01;
const SHARP_MM: f64 = 0.0025;
const SHARP: [&str; 4] = ["gear, 2 um", "triangle mesh", "letters, 2 um", "zigzag"];

type Point = [f64; 3];

fn less(a: &Point, b: &Point) -> Point {
    std::array::from_fn(|i| a[i] - b[i])
}

fn norm(a: &Point) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Points of a curve of the parameters 0 to `to` whose chords lie within `mm` of it.
fn chords(curve: impl Fn(f64) -> Point, to: f64, mm: f64) -> Vec<Point> {
    let (mut t, mut points) = (0.0, vec![curve(0.0)]);
    while t < to {
        let from = curve(t);
        let aside = |step: f64| {
            let way = less(&curve(t + step), &from);
            let off = |share: f64| {
                let seen = less(&curve(t + share * step), &from);
                let along = (0..3).map(|i| seen[i] * way[i]).sum::<f64>() / norm(&way);
                norm(&std::array::from_fn(|i| seen[i] - along * way[i] / norm(&way)))
            };
            [0.25, 0.5, 0.75].map(off).into_iter().fold(0.0, f64::max)
        };
        let (mut low, mut high) = (1e-6, 0.5);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if aside(middle) < mm { low = middle } else { high = middle }
        }
        t += low.min(to - t + 1e-12);
        points.push(curve(t));
    }
    points
}

/// A circle of 20 mm, three times, in chords that `length` draws.
fn circle(mut length: impl FnMut() -> f64) -> Vec<Point> {
    let (mut turn, mut points) = (0.0, Vec::new());
    while turn < 3.0 * TAU {
        points.push([20.0 * libm::cos(turn), 20.0 * libm::sin(turn), 0.0]);
        turn += length() / 20.0;
    }
    points
}

fn lissajous(mm: f64) -> Vec<Point> {
    let wave = |size: f64, turns: f64| move |t: f64| size * libm::sin(turns * t);
    let (x, y, z) = (wave(30.0, 2.0), wave(20.0, 3.0), wave(5.0, 5.0));
    chords(|t| [x(t), y(t), z(t)], TAU, mm)
}

/// Twenty involute teeth of module 2.
fn gear(mm: f64) -> Vec<Point> {
    const TEETH: u32 = 20;
    let pitch = f64::from(TEETH);
    let base = pitch * libm::cos(PI / 9.0);
    let (tip, root) = (pitch + 2.0, pitch - 2.5);
    let involute = |radius: f64| {
        let tangent = ((radius / base) * (radius / base) - 1.0).max(0.0).sqrt();
        tangent - libm::atan(tangent)
    };
    let half = PI / (2.0 * pitch) + involute(pitch);
    let mut points = Vec::new();
    for tooth in 0..TEETH {
        let middle = TAU * f64::from(tooth) / pitch;
        let at = |radius: f64, turn: f64| {
            [radius * libm::cos(middle + turn), radius * libm::sin(middle + turn), 0.0]
        };
        let flank = |share: f64, side: f64| {
            let radius = base + (tip - base) * share;
            at(radius, side * (half - involute(radius)))
        };
        let (foot, top) = (PI / pitch, half - involute(tip));
        points.extend(chords(|t| at(root, -foot + (foot - half) * t), 1.0, mm));
        points.extend(chords(|t| flank(t, -1.0), 1.0, mm));
        points.extend(chords(|t| at(tip, top * (2.0 * t - 1.0)), 1.0, mm));
        points.extend(chords(|t| flank(1.0 - t, 1.0), 1.0, mm));
        points.extend(chords(|t| at(root, half + (foot - half) * t), 1.0, mm));
    }
    points
}

/// Forty loops of 1.5 mm, 0.4 mm apart.
fn trochoid(mm: f64) -> Vec<Point> {
    chords(|t| [1.5 * (1.0 - libm::cos(TAU * t)) + 0.4 * t, 1.5 * libm::sin(TAU * t), 0.0], 40.0, mm)
}

/// Eight lines to and fro over a surface of triangles of 1 mm, from edge to edge.
fn mesh() -> Vec<Point> {
    let height = |x: f64, y: f64| 4.0 * libm::sin(x / 6.0) * libm::cos(y / 8.0) + 0.02 * x * x;
    let facet = |x: f64, y: f64| {
        let (i, j) = (x.floor(), y.floor());
        let (u, v) = (x - i, y - j);
        let [low, right, up, high] =
            [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(a, b)| height(i + a, j + b));
        match u + v < 1.0 {
            true => low + u * (right - low) + v * (up - low),
            false => high + (1.0 - u) * (up - high) + (1.0 - v) * (right - high),
        }
    };
    let mut points = Vec::new();
    for line in 0..8 {
        let y = 0.3 + 0.37 * f64::from(line);
        let mut edges: Vec<f64> =
            (0..40).map(f64::from).flat_map(|x| [x, x + 1.0 - (y - y.floor())]).chain([40.0]).collect();
        if line % 2 == 1 {
            edges.reverse();
        }
        points.extend(edges.into_iter().map(|x| [x, y, facet(x, y)]));
    }
    points
}

/// Goes on from the last point, by so many mm in a direction.
fn go(points: &mut Vec<Point>, heading: f64, mm: f64) {
    let [x, y, z] = points[points.len() - 1];
    points.push([x + mm * libm::cos(heading), y + mm * libm::sin(heading), z]);
}

/// Strokes and arcs, the arcs in chords within 2 µm, with a corner now and then.
fn letters() -> Vec<Point> {
    let (mut random, mut points, mut heading) = (Seed::of_case(3), vec![[0.0; 3]], 0.0);
    for _ in 0..120 {
        if random.chance(0.4) {
            go(&mut points, heading, random.between(0.3, 3.0));
        } else {
            let (radius, sweep) = (random.between(0.3, 2.0), random.between(0.5, 3.0));
            let side = if random.chance(0.5) { 1.0 } else { -1.0 };
            let count = (sweep / (2.0 * libm::acos(1.0 - 0.002 / radius))).ceil();
            let step = 0.5 * sweep / count;
            for _ in 0..count as u32 {
                heading += side * step;
                go(&mut points, heading, 2.0 * radius * libm::sin(step));
                heading += side * step;
            }
        }
        heading += if random.chance(0.3) { random.between(-2.0, 2.0) } else { 0.0 };
    }
    points
}

/// Lines of 0.5 to 6 mm that turn by 30 to 110 degrees to and fro.
fn zigzag() -> Vec<Point> {
    let (mut random, mut points, mut heading) = (Seed::of_case(7), vec![[0.0; 3]], 0.0);
    for line in 0..300 {
        go(&mut points, heading, random.between(0.5, 6.0));
        let turn = random.between(PI / 6.0, 11.0 * PI / 18.0);
        heading += if line % 2 == 0 { turn } else { -turn };
    }
    points
}

/// The program of points, with so many decimals, at a feed.
fn program(points: &[Point], mode: &str, decimals: usize, feed_mm_min: f64) -> String {
    let mut text = format!("G21 G90 G94 G17 G64 {mode} F{feed_mm_min}\n");
    for (k, [x, y, z]) in points.iter().enumerate() {
        let code = if k == 0 { "G0" } else { "G1" };
        writeln!(text, "{code} X{x:.decimals$} Y{y:.decimals$} Z{z:.decimals$}").unwrap();
    }
    text + "M2\n"
}

/// Seconds that a program along points takes from the first of them on.
fn time(machine: &Machine, points: &[Point], mode: &str, decimals: usize, feed_mm_min: f64) -> f64 {
    let [start, whole] = [1, points.len()].map(|count| {
        let check = interpreter::check(
            "contour.ngc",
            &program(&points[..count], mode, decimals, feed_mm_min),
            machine,
        );
        assert!(check.is_good(), "{:?}", check.diagnostics);
        check.time_s
    });
    whole - start
}

/// What the interpreter makes of points with P0.01 and five decimals, as blocks of X, Y and Z.
fn blocks(points: &[Point], machine: &Machine) -> Vec<Block<3, ()>> {
    let check = interpreter::check("contour.ngc", &program(points, "P0.01", 5, FEED_MM_MIN), machine);
    let mut from = machine.home();
    let mut blocks = Vec::new();
    for item in &check.items {
        let Some(target) = item.code.target() else { continue };
        let way: Point = std::array::from_fn(|i| target[i].mm_from(from[i]));
        let path = match &item.code {
            Code::Curve { curve, .. } => {
                let [start, end] = [([0.0; 3], curve.start), (curve.way, curve.end)]
                    .map(|(place, [first, second, third])| [place, first, second, third]);
                Path::piece(&start, &end, curve.length_mm)
            }
            Code::Line { feed, .. } if *feed != protocol::Feed::Rapid => Path::line(way, &[true; 3]),
            _ => None,
        };
        let (feed, chord_mm) = (Feed::PerSecond(FEED_MM_MIN / 60.0), machine.path.chord_mm);
        let block = |path| Block { path, feed, corner: CORNER, room: TRAVEL_MM[1], chord_mm, tag: () };
        blocks.extend(path.map(block));
        from = *target;
    }
    blocks
}

/// Seconds that the chain alone takes over them.
fn planned(blocks: &[Block<3, ()>], axes: [Limits; 3], cycle_s: f64) -> f64 {
    let mut chain = Chain::growing(Settings { axes, cycle_s });
    let (mut blocks, mut time) = (blocks.iter().copied().peekable(), 0.0);
    loop {
        while chain.has_room() && blocks.peek().is_some() {
            chain.push(blocks.next().unwrap());
        }
        if chain.has_room() {
            chain.close();
        }
        let ask =
            Ask { ratios: Ratios::full(0.0), hold: false, single: false, more: blocks.peek().is_some() };
        match chain.skip(&ask) {
            Some(more) => time += more,
            None => return time,
        }
    }
}

/// Prints how much of the time the limits of the axes ask for on the path of the chain with all corners
/// rounded.
fn beside_the_least(name: &str, points: &[Point], machine: &Machine) {
    let limits = machine.limits();
    let axes = [protocol::Axis::X, protocol::Axis::Y, protocol::Axis::Z].map(|axis| limits[axis.index()]);
    let cycle_s = machine.general.interpolator_cycle_s;
    // Of the zigzag the first hundred lines, for the sake of time.
    let points = if name == "zigzag" { &points[..101] } else { points };
    let blocks = blocks(points, machine);
    let caps = Caps { feed: FEED_MM_MIN / 60.0, chord_v2: 8.0 * machine.path.chord_mm / (cycle_s * cycle_s) };
    let planned = planned(&blocks, axes, cycle_s);
    let step = if SHARP.contains(&name) { SHARP_MM } else { GRID_MM };
    let [coarse, fine] = [2.0 * step, step].map(|h| least_time(&places(&blocks, h), h, &axes, caps));
    println!("{name:<20} {planned:>8.2} {coarse:>8.2} {fine:>8.2} {:>6.2}", planned / fine);
}

fn main() {
    let mut machine = Machine::from_toml(machine::SMALL_MILL).unwrap();
    machine.axis.values_mut().for_each(|axis| axis.travel_mm = TRAVEL_MM);
    let mut random = Seed::of_case(1);
    let contours: [(&str, Vec<Point>); 13] = [
        ("circle, 0.5 to 2 mm", circle(|| random.between(0.5, 2.0))),
        ("circle, 0.2 mm", circle(|| 0.2)),
        ("circle, 0.05 mm", circle(|| 0.05)),
        ("circle, 0.02 mm", circle(|| 0.02)),
        ("Lissajous, 5 um", lissajous(0.005)),
        ("Lissajous, 2 um", lissajous(0.002)),
        ("Lissajous, 0.5 um", lissajous(0.0005)),
        ("gear, 2 um", gear(0.002)),
        ("trochoid, 5 um", trochoid(0.005)),
        ("trochoid, 1 um", trochoid(0.001)),
        ("triangle mesh", mesh()),
        ("letters, 2 um", letters()),
        ("zigzag", zigzag()),
    ];
    if let Some(sources) = std::env::var_os("LINUXCNC") {
        return linuxcnc::beside(sources.as_ref(), &contours, &machine);
    }
    if let Some(seeds) = std::env::var_os("FOLLOWED") {
        let seeds =
            seeds.to_str().and_then(|seeds| seeds.parse().ok()).expect("FOLLOWED is a number of seeds");
        return followed::beside(seeds, &contours, &machine);
    }
    print!("{:<20} {:>6} {:>8}", "contour", "lines", "way/feed");
    MODES.iter().for_each(|mode| print!(" {mode:>12}"));
    println!(" {:>14}", "P0.01, 3 dec.");
    for (name, points) in &contours {
        let way: f64 = points.windows(2).map(|pair| norm(&less(&pair[1], &pair[0]))).sum();
        print!("{name:<20} {:>6} {:>8.2}", points.len() - 1, 60.0 * way / FEED_MM_MIN);
        MODES.iter().for_each(|mode| print!(" {:>12.2}", time(&machine, points, mode, 5, FEED_MM_MIN)));
        println!(" {:>14.2}", time(&machine, points, "P0.01", 3, FEED_MM_MIN));
    }
    println!("\n{:<20} {:>8} {:>8} {:>8} {:>6}", "P0.01", "planned", "2 h", "h", "ratio");
    // Known: 20/F + F/A + A/J + J/D of the X axis, 0.268 s.
    beside_the_least("a line of 20 mm", &[[0.0; 3], [20.0, 0.0, 0.0]], &machine);
    contours.iter().for_each(|(name, points)| beside_the_least(name, points, &machine));
}
