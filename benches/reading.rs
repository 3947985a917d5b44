//! How fast `pitchlock canon` reads: programs of several shapes, the same moves in both dialects, and the
//! peak memory of ten million lines.
//!
//! What counts is the processor time (user and system) of the whole process, its start and printing to
//! /dev/null included: what it takes on a quiet computer, whatever else this one does.
//!
//! ```text
//! cargo bench --bench reading
//! RS274=/path/to/rs274 cargo bench --bench reading      beside LinuxCNC's stand-alone interpreter
//! ```
//! An `rs274` on the PATH is found without the variable. It prints to a file of its own choice faster than to
//! standard output, so it is given one (/dev/null). The two run in turns, so that both meet the same load.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use spent::{peak_mib, run_s};

mod spent;

/// Lines of a program of moves, turns of a loop, lines of the long program.
const MOVES: usize = 200_000;
const TURNS: usize = 83_200;
const LONG: usize = 10_000_000;

/// Runs of each program, enough for a mean of times that the kernel counts in steps of 10 ms.
const RUNS: usize = 10;

const START: &str = "G21 G90 G17 G94 F1200\n";

/// Writes a program of so many lines or turns.
type Writer = fn(usize, &mut BufWriter<File>) -> io::Result<()>;

/// A point of a spiral.
fn point(n: usize) -> [f64; 3] {
    let (s, c) = libm::sincos(n as f64 * 0.01);
    let r = 40.0 + (n % 5000) as f64 * 0.001;
    [r * c, r * s, -0.0001 * (n % 90_000) as f64]
}

/// A move of a mill.
fn milled([x, y, z]: [f64; 3]) -> String {
    format!("G1 X{x:.4} Y{y:.4} Z{z:.4}")
}

/// A move of a lathe.
fn turned([x, z, _]: [f64; 3]) -> String {
    format!("G1 X{x:.4} Z{z:.4}")
}

/// The block that goes to a point.
type Block = fn([f64; 3]) -> String;

/// A dialect as `--dialect` names it, the first lines of a program and its last one.
type Frame = [&'static str; 3];

/// Moves of a machine, and the frames that they are put into.
const DIALECTS: [(&str, Block, [Frame; 2]); 2] = [
    (
        "moves of a lathe",
        turned,
        [["linuxcnc", "G21 G90 G18 G7 G94 F1200\n", "M2"], ["fanuc", "O1000\nG21 G98 F1200.\n", "M30"]],
    ),
    (
        "moves of a mill",
        milled,
        [["linuxcnc", START, "M2"], ["fanuc-mill", "O1000\nG21 G90 G17 G94 F1200.\n", "M30"]],
    ),
];

/// A spiral in short moves.
fn spiral(of: Block, [_, begins, ends]: Frame, lines: usize, file: &mut BufWriter<File>) -> io::Result<()> {
    file.write_all(begins.as_bytes())?;
    for n in 0..lines {
        writeln!(file, "{}", of(point(n)))?;
    }
    writeln!(file, "{ends}")
}

fn moves(lines: usize, file: &mut BufWriter<File>) -> io::Result<()> {
    spiral(milled, ["linuxcnc", START, "M2"], lines, file)
}

/// The same in short arcs, with line numbers.
fn arcs(lines: usize, file: &mut BufWriter<File>) -> io::Result<()> {
    let [x, y, z] = point(0);
    writeln!(file, "{START}G1 X{x:.4} Y{y:.4} Z{z:.4}")?;
    for n in 0..lines {
        let [x, y, z] = point(n + 1);
        writeln!(file, "N{n} G3 X{x:.4} Y{y:.4} Z{z:.4} R50")?;
    }
    writeln!(file, "M2")
}

/// A loop whose turns compute a point and go there.
fn turns(count: usize, file: &mut BufWriter<File>) -> io::Result<()> {
    writeln!(file, "{START}#<turn> = 0\no100 while [#<turn> lt {count}]")?;
    file.write_all(
        b"  #1 = [40 * cos[#<turn> * 0.5] + 2 * sin[#<turn> * 3]]
  #2 = [40 * sin[#<turn> * 0.5] + #1 / 100]
  #3 = [[#<turn> mod 7] * 0.01 - sqrt[abs[#1 * #2]] / 20]
  G1 X#1 Y#2 Z[#3 - 1]
  #<turn> = [#<turn> + 1]
o100 endwhile
M2
",
    )
}

/// A loop that takes one of three branches and calls a subroutine.
fn calls(count: usize, file: &mut BufWriter<File>) -> io::Result<()> {
    writeln!(file, "{START}#<turn> = 0\n#<_depth> = 3")?;
    file.write_all(
        b"o<cut> sub\n  #<across> = [#1 + #2]\n  G1 X#<across> Y#2\no<cut> endsub [#<across> / 2]\n",
    )?;
    writeln!(file, "o100 repeat [{count}]")?;
    file.write_all(
        b"  o110 if [[#<turn> mod 3] eq 0]
    #<height> = [#<turn> * 0.001 + #<_depth>]
  o110 elseif [[#<turn> mod 3] eq 1]
    #<height> = [#<turn> * 0.002 - #<_depth>]
  o110 else
    #<height> = [#<height> / 2]
  o110 endif
  o<cut> call [#<turn> * 0.01] [#<height>]
  #<turn> = [#<turn> + 1]
o100 endrepeat
M2
",
    )
}

fn pitchlock(program: &Path, dialect: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pitchlock"));
    command.args(["canon", "--format", "linuxcnc", "--dialect", dialect]).arg(program).stdin(Stdio::null());
    command.stdout(File::create("/dev/null").unwrap()).stderr(Stdio::null());
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
    // Without a tool table some versions end at once.
    command.args(["-t", "/dev/null", "-g"]).arg(program).arg("/dev/null").stdin(Stdio::null());
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// Millions a second, of both if both are here.
fn rates(count: usize, program: &Path, rs274: Option<&Path>) -> (f64, Option<f64>) {
    let (mut ours, mut theirs) = (0.0, 0.0);
    for _ in 0..RUNS {
        ours += run_s(pitchlock(program, "linuxcnc"));
        theirs += rs274.map_or(0.0, |rs274| run_s(peer(program, rs274)));
    }
    let millions = (RUNS * count) as f64 / 1e6;
    (millions / ours, rs274.map(|_| millions / theirs))
}

/// Millions of lines a second of the same moves in each dialect.
fn dialects(lines: usize, of: Block, frames: [Frame; 2], folder: &Path) -> [f64; 2] {
    let programs = frames.map(|frame @ [dialect, ..]| {
        let path = folder.join(dialect);
        let mut file = BufWriter::new(File::create(&path).unwrap());
        spiral(of, frame, lines, &mut file).and_then(|()| file.flush()).unwrap();
        (path, dialect)
    });
    let mut times_s = [0.0; 2];
    for _ in 0..RUNS {
        for ((path, dialect), time_s) in programs.iter().zip(&mut times_s) {
            *time_s += run_s(pitchlock(path, dialect));
        }
    }
    times_s.map(|time_s| (RUNS * lines) as f64 / 1e6 / time_s)
}

/// Writes a program to a file.
fn write(count: usize, of: Writer, file: &Path) {
    let mut file = BufWriter::new(File::create(file).unwrap());
    of(count, &mut file).and_then(|()| file.flush()).unwrap();
}

fn main() {
    // `cargo test --benches` asks whether a bench runs at all.
    let shortened = std::env::args().any(|argument| argument == "--test");
    let scale = if shortened { 1000 } else { 1 };
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("program.ngc");
    let rs274 = rs274();
    let measure = |name: &str, unit: &str, count: usize, of: Writer| {
        let count = count / scale;
        write(count, of, &program);
        let (ours, theirs) = rates(count, &program, rs274.as_deref());
        let mut line = format!("{name:<18}{ours:>6.2} million {unit:<7}");
        if let Some(theirs) = theirs {
            write!(line, "   rs274 {theirs:.3} million   {:.1} times as fast", ours / theirs).unwrap();
        }
        println!("{line}");
    };
    measure("short moves", "lines/s", MOVES, moves);
    measure("arcs", "lines/s", MOVES, arcs);
    measure("while loop", "turns/s", TURNS, turns);
    measure("branches, calls", "turns/s", TURNS, calls);
    for (name, of, frames) in DIALECTS {
        let [linuxcnc, fanuc] = dialects(MOVES / scale, of, frames, folder.path());
        print!("{name:<18}{linuxcnc:>6.2} million lines/s   fanuc {fanuc:.2} million");
        println!("   {:.2} times as fast", fanuc / linuxcnc);
    }
    let count = LONG / scale;
    write(count, moves, &program);
    println!(
        "{:<18}{:>6.1} MiB at most",
        format!("{count} lines"),
        peak_mib(pitchlock(&program, "linuxcnc"))
    );
}
