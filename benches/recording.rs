//! What it costs to know: runs with their journal and their record, and the same without, in turn. Printed
//! are the medians of the time on the wall and of the processor time of all processes, and their ratios.
//!
//! `cargo bench --bench recording`; `PITCHLOCK_RUNS=21` takes more of each.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout, clippy::disallowed_methods)] // measures time

use std::{
    fs,
    process::Command,
    time::{Duration, Instant},
};

/// Two minutes on the machine with passes, moves and a dwell.
const PROGRAM: &str = "examples/m20x2.ngc";
/// Clock ticks of /proc in a second.
const TICKS: f64 = 100.0;

/// Processor time of all children that have ended, s.
fn of_children_s() -> f64 {
    let stat = fs::read_to_string("/proc/self/stat").unwrap();
    // Behind the name, which may have blanks in it, the fields count from 3; 16 and 17 are of children.
    let fields: Vec<&str> = stat.rsplit_once(") ").unwrap().1.split(' ').collect();
    [16, 17].map(|field: usize| fields[field - 3].parse::<f64>().unwrap()).iter().sum::<f64>() / TICKS
}

/// Makes a run; wall and processor time, s.
fn run(how: &[&str]) -> [f64; 2] {
    let place = tempfile::tempdir().unwrap();
    let out = place.path().join("run");
    let (before_s, begun) = (of_children_s(), Instant::now());
    let mut command = Command::new(env!("CARGO_BIN_EXE_pitchlock"));
    command.args(["run", PROGRAM, "--quiet", "--trace", "none", "--out"]).arg(out).args(how);
    assert!(command.status().unwrap().success());
    let wall: Duration = begun.elapsed();
    [wall.as_secs_f64(), of_children_s() - before_s]
}

fn median(mut figures: Vec<f64>) -> f64 {
    figures.sort_by(f64::total_cmp);
    figures[figures.len() / 2]
}

fn main() {
    let runs = std::env::var("PITCHLOCK_RUNS").ok().map_or(11, |runs| runs.parse().unwrap());
    for (name, how) in [("in one process", &["--in-process"][..]), ("over processes", &[][..])] {
        let without = [how, &["--unkept"]].concat();
        let pairs: Vec<[[f64; 2]; 2]> = (0..runs).map(|_| [run(how), run(&without)]).collect();
        for (what, at) in [("wall", 0), ("processor", 1)] {
            let of = |which: usize| median(pairs.iter().map(|pair| pair[which][at]).collect());
            let ratio = median(pairs.iter().map(|pair| pair[0][at] / pair[1][at]).collect());
            let (with_s, without_s) = (of(0), of(1));
            println!("{name}, {what}: {with_s:.3} s with, {without_s:.3} s without, ratio {ratio:.3}");
        }
    }
}
