//! LinuxCNC's own trajectory planner over the same contours, from sources that the user has: `run` compiles
//! them with `driver.c`. In: contours, the machine. Out: a table, and the programs in a folder that it names.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use machine::Machine;
use protocol::Axis;

use super::{FEED_MM_MIN, Point, program, time};

/// What LinuxCNC uses in effect at cycles of 1 ms, where an axis of 3 m/s² turns its acceleration on within
/// one: jerk, mm/s³, and how fast that changes, mm/s⁴.
const JERK_MM_S3: f64 = 2.5e6;
const JERK_RATE_MM_S4: f64 = 5e9;
/// The decimals of coordinates, as for the tables of [`super`].
const DECIMALS: usize = 5;
/// A line whose time is known: LinuxCNC uses half of the acceleration where G64 holds.
const KNOWN_MM: f64 = 20.0;
const KNOWN_S: f64 = KNOWN_MM / 100.0 + 100.0 / 1500.0;

/// What the driver found about one program: s, the largest share of any axis in its limits of acceleration
/// and of jerk, the largest distance between lines and path, µm.
struct Found {
    time_s: f64,
    acceleration: f64,
    jerk: f64,
    aside_um: f64,
}

impl Found {
    /// A row of the driver, whose first line says what stands where.
    fn of_row(row: &str) -> Found {
        let columns: Vec<f64> = row.split_whitespace().map_while(|word| word.parse().ok()).collect();
        let most = |of: std::ops::Range<usize>| columns[of].iter().copied().fold(0.0, f64::max);
        Found { time_s: columns[0], acceleration: most(6..9), jerk: most(9..12), aside_um: most(12..14) }
    }
}

/// A program with the limits of the axes as the driver reads them.
fn with_limits(points: &[Point], machine: &Machine) -> String {
    let mut text = String::new();
    let limits = machine.limits();
    for axis in [Axis::X, Axis::Y, Axis::Z] {
        let of = limits[axis.index()];
        writeln!(text, "; limits {axis:?} {} mm/s {} mm/s2 {} mm/s3", of.v, of.a, of.j).unwrap();
    }
    text + &program(points, "P0.01", DECIMALS, FEED_MM_MIN)
}

/// Writes the programs, and gives their paths.
fn written(contours: &[(&str, Vec<Point>)], machine: &Machine) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("contours");
    fs::create_dir_all(&folder).unwrap();
    println!("programs in {}", folder.display());
    let write = |(name, points): &(&str, Vec<Point>)| {
        let path = folder.join(format!("{}.ngc", name.replace(", ", "-").replace(' ', "-")));
        fs::write(&path, with_limits(points, machine)).unwrap();
        path
    };
    contours.iter().map(write).collect()
}

/// What LinuxCNC's planner makes of the programs.
fn found(sources: &Path, programs: &[PathBuf]) -> Vec<Found> {
    let run = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/linuxcnc/run");
    let out = Command::new(run).arg(sources).args(programs).output().unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let text = String::from_utf8(out.stdout).unwrap();
    let rows: Vec<Found> = text.lines().skip(1).map(Found::of_row).collect();
    assert_eq!(rows.len(), programs.len(), "{text}");
    rows
}

/// Prints how long LinuxCNC takes, how hard it moves, and how long pitchlock takes with the limits of the
/// machine and with the jerk that LinuxCNC uses in effect.
pub(crate) fn beside(sources: &Path, contours: &[(&str, Vec<Point>)], machine: &Machine) {
    let mut loose = machine.clone();
    loose.axis.values_mut().for_each(|axis| {
        (axis.jerk_mm_s3, axis.jerk_rate_mm_s4) = (JERK_MM_S3, JERK_RATE_MM_S4);
    });
    let known = [("a line of 20 mm", vec![[0.0; 3], [KNOWN_MM, 0.0, 0.0]])];
    let line = &found(sources, &written(&known, machine))[0];
    assert!((line.time_s - KNOWN_S).abs() < 0.0015, "LinuxCNC: {} s for a line of {KNOWN_S} s", line.time_s);
    println!(
        "{:<20} {:>9} {:>6} {:>6} {:>7} {:>10} {:>6} {:>9} {:>6}",
        "contour", "LinuxCNC", "a/A", "j/J", "off, um", "pitchlock", "ratio", "its jerk", "ratio"
    );
    for ((name, points), row) in contours.iter().zip(found(sources, &written(contours, machine))) {
        let [ours, at_its_jerk] =
            [machine, &loose].map(|machine| time(machine, points, "P0.01", DECIMALS, FEED_MM_MIN));
        println!(
            "{name:<20} {:>9.2} {:>6.2} {:>6.1} {:>7.1} {ours:>10.2} {:>6.2} {at_its_jerk:>9.2} {:>6.2}",
            row.time_s,
            row.acceleration,
            row.jerk,
            row.aside_um,
            ours / row.time_s,
            at_its_jerk / row.time_s
        );
    }
}
