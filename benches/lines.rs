//! How many lines a second `pitchlock check` plans, from the text of a program to its time of motion, and
//! what memory that takes: programs of a million lines, as CAM systems write them and as they do not.
//!
//! What counts is the processor time (user and system) of the whole process, the least of three runs: what it
//! takes on a quiet computer. *Memory* is the peak of a tenth of the lines, and of all of them.
//!
//! ```text
//! cargo bench --bench lines
//! LINES=100000 cargo bench --bench lines      shorter programs
//! ```
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

use std::f64::consts::TAU;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::process::{Command, Stdio};

use spent::{peak_mib, run_s};
use testing::Seed;

mod spent;

const LINES: usize = 1_000_000;
const RUNS: usize = 3;
const MILL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/machines/small-mill.toml");

type Point = [f64; 3];
/// What is called, its path mode, its decimals, its points.
type Program = (&'static str, &'static str, usize, fn() -> Box<dyn Iterator<Item = Point>>);

const PROGRAMS: [Program; 8] = [
    ("circle of 30 mm, lines of 9 um", "P0.01", 4, || points(|n| circle(30.0, n))),
    ("Lissajous in space, lines of 0.1 mm", "P0.01", 4, || points(lissajous)),
    ("over a mesh of 1 mm, a smooth surface", "P0.01", 3, || mesh(1.0, 0.0)),
    ("over a mesh of 0.4 mm, a rough one", "P0.01", 3, || mesh(0.4, 0.3)),
    ("over a mesh of 1 mm, a rough one", "P0.01", 3, || mesh(1.0, 0.3)),
    ("random lines", "P0.01", 3, random),
    ("zigzag of 0.25 mm, Q0", "P0.01 Q0", 3, || points(zigzag)),
    ("circle of 22 mm, lines of 7 um, Q0", "P0.01 Q0", 4, || points(|n| circle(22.0, n))),
];

fn points(of: impl Fn(usize) -> Point + 'static) -> Box<dyn Iterator<Item = Point>> {
    Box::new((0..).map(of))
}

/// One of 20,000 points of a circle.
fn circle(radius: f64, n: usize) -> Point {
    let (s, c) = libm::sincos(TAU * n as f64 / 20_000.0);
    [radius * c, radius * s, -20.0]
}

fn lissajous(n: usize) -> Point {
    let t = n as f64 * 1e-3;
    [40.0 * libm::sin(3.0 * t), 30.0 * libm::sin(2.0 * t + 0.3), 5.0 * libm::sin(5.0 * t) - 20.0]
}

fn zigzag(n: usize) -> Point {
    [(n % 5000) as f64 * 0.01 - 30.0, 0.25 * (n % 2) as f64 - 20.0 + 0.05 * (n / 5000 % 200) as f64, -20.0]
}

/// There and back over a surface in triangles, 0.07 mm beside the row before: a point at every edge. `rough`:
/// height of the shorter waves, mm.
fn mesh(grid: f64, rough: f64) -> Box<dyn Iterator<Item = Point>> {
    let wave = move |i: f64, j: f64| {
        let (x, y) = (i * grid, j * grid);
        4.0 * libm::sin(x / 9.0) * libm::cos(y / 7.0) + rough * libm::sin(1.3 * x + 0.7 * y) - 15.0
    };
    // A square of the mesh is two triangles, on either side of its diagonal.
    let height = move |x: f64, y: f64| {
        let [i, j] = [x / grid, y / grid].map(f64::floor);
        let (a, b) = (x / grid - i, y / grid - j);
        let (corner, far) = (wave(i, j), wave(i + 1.0, j + 1.0));
        let (beside, first, second) =
            if a >= b { (wave(i + 1.0, j), a, b) } else { (wave(i, j + 1.0), b, a) };
        corner + first * (beside - corner) + second * (far - beside)
    };
    let half = (40.0 / grid) as i32;
    Box::new((0..).flat_map(move |row| {
        let y = f64::from(row % 1000) * 0.07 - 35.0;
        let within = y / grid - (y / grid).floor();
        (0..4 * half).map(move |n| {
            let n = if row % 2 == 0 { n } else { 4 * half - 1 - n };
            let cell = f64::from(n / 2 - half);
            let x = grid * if n % 2 == 0 { cell } else { cell + within };
            [x, y, height(x, y)]
        })
    }))
}

/// Lines of 0.05 to 0.5 mm that turn by up to 1.2 rad.
fn random() -> Box<dyn Iterator<Item = Point>> {
    let mut random = Seed::of_case(1);
    let (mut at, mut heading) = ([0.0, 0.0, -20.0], 0.0_f64);
    Box::new(std::iter::from_fn(move || {
        heading += random.between(-1.2, 1.2);
        let (s, c) = libm::sincos(heading);
        let length = random.between(0.05, 0.5);
        for (at, way) in at.iter_mut().zip([c, s]) {
            let to = *at + length * way;
            if to.abs() > 38.0 {
                heading += 1.5;
            }
            *at = to.clamp(-38.0, 38.0);
        }
        Some(at)
    }))
}

fn write((_, mode, decimals, points): &Program, lines: usize, file: &Path) -> io::Result<()> {
    let mut file = BufWriter::new(File::create(file)?);
    let mut points = points().take(lines + 1);
    let [x, y, z] = points.next().unwrap();
    writeln!(file, "G21 G90 G17 G94 G64 {mode}\nG0 X{x:.4} Y{y:.4} Z{z:.4}\nF6000")?;
    for [x, y, z] in points {
        writeln!(file, "G1 X{x:.decimals$} Y{y:.decimals$} Z{z:.decimals$}")?;
    }
    writeln!(file, "M2")?;
    file.flush()
}

fn check(program: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pitchlock"));
    command.args(["check", "--machine", MILL]).arg(program).stdin(Stdio::null());
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command
}

fn main() {
    // `cargo test --benches` asks whether a bench runs at all.
    let shortened = std::env::args().any(|argument| argument == "--test");
    let asked = std::env::var("LINES").ok().map_or(LINES, |lines| lines.parse().unwrap());
    let lines = if shortened { 1000 } else { asked };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("program.ngc");
    for program in &PROGRAMS {
        write(program, lines / 10, &file).unwrap();
        let less = peak_mib(check(&file));
        write(program, lines, &file).unwrap();
        let more = peak_mib(check(&file));
        let least_s = (0..RUNS).map(|_| run_s(check(&file))).fold(f64::INFINITY, f64::min);
        println!(
            "{:<40}{:>8.0} lines/s, {lines} in {least_s:.2} s; {less:.1} MiB, {more:.1} MiB",
            program.0,
            lines as f64 / least_s
        );
    }
}
