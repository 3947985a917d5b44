//! How fast `pitchlock canon` reads: lines per second of short moves, turns per second of a loop with expressions,
//! and the peak memory of ten million lines. The whole process is timed, printing to /dev/null included.
//!
//! ```text
//! cargo bench --bench reading
//! RS274=/path/to/rs274 cargo bench --bench reading      beside LinuxCNC's stand-alone interpreter
//! ```
//! An `rs274` on the PATH is found without the variable. It prints to a file of its own choice faster than to standard
//! output, so it is given one (/dev/null).
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use protocol::ipc::time::{Moment, sleep_until};

/// Lines of the program of moves, turns of the loop, lines of the long program.
const MOVES: usize = 200_000;
const TURNS: usize = 83_200;
const LONG: usize = 10_000_000;

/// Runs of each program; the fastest counts, as it was disturbed least.
const RUNS: usize = 5;

/// A spiral in short moves.
fn moves(lines: usize, file: &Path) {
    let mut file = BufWriter::new(File::create(file).unwrap());
    writeln!(file, "G21 G90 G17 G94 F1200").unwrap();
    for n in 0..lines {
        let (s, c) = libm::sincos(n as f64 * 0.01);
        let r = 40.0 + (n % 5000) as f64 * 0.001;
        writeln!(file, "G1 X{:.4} Y{:.4} Z{:.4}", r * c, r * s, -0.0001 * (n % 90_000) as f64).unwrap();
    }
    writeln!(file, "M2").unwrap();
}

/// A loop whose turns compute a point and go there.
fn turns(count: usize, file: &Path) {
    let mut text = String::from("G21 G90 G17 G94 F1200\n#<turn> = 0\n");
    writeln!(text, "o100 while [#<turn> lt {count}]").unwrap();
    text.push_str("  #1 = [40 * cos[#<turn> * 0.5] + 2 * sin[#<turn> * 3]]\n");
    text.push_str("  #2 = [40 * sin[#<turn> * 0.5] + #1 / 100]\n");
    text.push_str("  #3 = [[#<turn> mod 7] * 0.01 - sqrt[abs[#1 * #2]] / 20]\n");
    text.push_str("  G1 X#1 Y#2 Z[#3 - 1]\n  #<turn> = [#<turn> + 1]\no100 endwhile\nM2\n");
    fs::write(file, text).unwrap();
}

fn pitchlock(program: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pitchlock"));
    command.args(["canon", "--format", "linuxcnc"]).arg(program).stdout(File::create("/dev/null").unwrap());
    command
}

/// LinuxCNC's interpreter, if there is one here.
fn rs274() -> Option<PathBuf> {
    let named = std::env::var_os("RS274").map(PathBuf::from);
    let path = std::env::var_os("PATH").unwrap_or_default();
    let found = std::env::split_paths(&path).map(|folder| folder.join("rs274")).find(|file| file.is_file());
    named.or(found)
}

fn peer(program: &Path, rs274: &Path) -> Command {
    let mut command = Command::new(rs274);
    command.arg("-g").arg(program).arg("/dev/null").stdin(Stdio::null());
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// Seconds of the fastest run.
fn fastest_s(mut command: impl FnMut() -> Command) -> f64 {
    let once = |mut command: Command| {
        let begun = Moment::now();
        let status = command.status().unwrap();
        assert!(status.success(), "{command:?}: {status}");
        begun.elapsed().as_secs_f64()
    };
    (0..RUNS).map(|_| once(command())).fold(f64::INFINITY, f64::min)
}

/// Peak of the resident memory of a process that is run to its end, MiB, read while it runs.
fn peak_mib(mut command: Command) -> f64 {
    let mut process = command.spawn().unwrap();
    let file = format!("/proc/{}/status", process.id());
    let mut peak_kib = 0.0_f64;
    while process.try_wait().unwrap().is_none() {
        let status = fs::read_to_string(&file).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap_or_default();
        let kib = line.trim().trim_end_matches(" kB").parse().unwrap_or(0.0);
        peak_kib = peak_kib.max(kib);
        sleep_until(Moment::now().after(Duration::from_millis(5)));
    }
    assert!(process.wait().unwrap().success());
    peak_kib / 1024.0
}

fn main() {
    // `cargo test --benches` asks whether a bench runs at all.
    let shortened = std::env::args().any(|argument| argument == "--test");
    let scale = if shortened { 1000 } else { 1 };
    let folder = tempfile::tempdir().unwrap();
    let rs274 = rs274();
    println!("                        pitchlock canon         rs274");
    for (name, unit, count, write) in [
        ("short moves", "lines", MOVES / scale, moves as fn(usize, &Path)),
        ("while loop", "turns", TURNS / scale, turns),
    ] {
        let program = folder.path().join("program.ngc");
        write(count, &program);
        let rate = |seconds: f64| count as f64 / seconds / 1e6;
        let ours = rate(fastest_s(|| pitchlock(&program)));
        let theirs = rs274.as_ref().map(|rs274| rate(fastest_s(|| peer(&program, rs274))));
        let theirs = theirs.map_or("not here".into(), |rate| format!("{rate:.2} million {unit}/s"));
        println!("{name:<20}{ours:>8.2} million {unit}/s  {theirs}");
    }
    let program = folder.path().join("long.ngc");
    moves(LONG / scale, &program);
    println!("{} lines{:>16.1} MiB at most", LONG / scale, peak_mib(pitchlock(&program)));
}
