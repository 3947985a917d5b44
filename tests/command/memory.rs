//! Ten thousand short moves: no process of the control takes more and more memory. The length of a program is
//! not felt where it is compiled, nor where it is read as machine code.

use std::{
    collections::BTreeMap,
    fmt::Write as _,
    fs,
    process::{Command, Stdio},
};

use crate::shop::{Answer, Place, children, peak_kb, until, wait_s};
use rig::observe::{Outcome, Summary};

const MOVES: usize = 10_000;
const ALLOWED_KIB: u64 = 64;

/// There and back again by two micrometres, which takes little time.
fn short_moves(moves: usize) -> String {
    let mut program = String::from("G18 G21 G90 G94 G8\nG0 X50 Z90\n");
    for n in 0..moves {
        let _ = writeln!(program, "G1 X{} F3000", if n % 2 == 0 { 50.002 } else { 50.0 });
    }
    program.push_str("M2\n");
    program
}

/// Memory of one process, KiB.
#[derive(Clone, Copy, Debug)]
struct Memory {
    /// Everything that is mapped: code, heap, stack, channels.
    mapped_kib: u64,
    /// What of it is its own and in use. Pages of a channel are not: they are mapped at the start, and first
    /// touched whenever a queue is fuller than ever before.
    own_kib: u64,
}

impl Memory {
    /// Counted page by page; `VmRSS` is only brought up to date now and then.
    fn of(pid: u32) -> Option<Memory> {
        let entry = |file: &str, key: &str| {
            let text = fs::read_to_string(format!("/proc/{pid}/{file}")).ok()?;
            let line = text.lines().find_map(|line| line.strip_prefix(key))?;
            line.trim().trim_end_matches("kB").trim().parse().ok()
        };
        let (mapped_kib, own_kib) = (entry("status", "VmSize:")?, entry("smaps_rollup", "Anonymous:")?);
        (own_kib > 0).then_some(Memory { mapped_kib, own_kib })
    }
}

#[test]
fn ten_thousand_moves_take_no_more_memory_than_the_first_quarter() {
    let place = Place::new();
    let program = place.write("short.ngc", short_moves(MOVES));
    let mut launcher = place.start(&program);
    until("the machine runs", || place.at("run/trace.mcap").exists());
    let mut samples: BTreeMap<String, Vec<Memory>> = BTreeMap::new();
    while launcher.try_wait().expect("it was started here").is_none() {
        for (name, pid) in children(&launcher) {
            if let Some(memory) = Memory::of(pid) {
                samples.entry(name).or_default().push(memory);
            }
        }
        wait_s(0.1);
    }
    let answer = Answer::from(launcher.wait_with_output().expect("it was started here"));
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    let summary: Summary = serde_json::from_str(&answer.stdout).expect("--json prints the summary");
    assert_eq!(summary.outcome, Outcome::Completed);
    assert_eq!(summary.moves.count, MOVES as u64 + 1);
    for name in ["interpolator", "regulator-x", "regulator-z", "sim-plant"] {
        let samples = &samples[name];
        let (quarter, last) = (samples[samples.len() / 4], samples[samples.len() - 2]);
        assert_eq!(last.mapped_kib, quarter.mapped_kib, "{name}: {quarter:?} {last:?}");
        assert!(last.own_kib <= quarter.own_kib + ALLOWED_KIB, "{name}: {quarter:?} {last:?}");
    }
}

/// Thirty times as many items, of which each takes half a kilobyte in memory and more.
#[test]
fn a_program_is_compiled_and_checked_item_by_item() {
    let place = Place::new();
    let peaks = [2_000, 60_000].map(|moves| {
        place.write("moves.ngc", short_moves(moves));
        ["compile moves.ngc -o moves.mc", "check moves.mc"].map(|line| {
            let (answer, kb) = peak_kb(place.pitchlock().args(line.split(' ')));
            assert_eq!(answer.status, Some(0), "{line}: {}", answer.stderr);
            kb
        })
    });
    let [short, long] = peaks;
    for (short, long) in short.into_iter().zip(long) {
        assert!(short > 0 && long < short + 6_000, "{short} kB, and {long} kB for a long program");
    }
}

/// A program in UTF-16 goes through a temporary file: as it is read in UTF-8, in as much memory.
#[test]
fn a_long_program_in_utf_16_is_read_line_by_line() {
    let place = Place::new();
    let remark = format!("({})\n", "remark ".repeat(30));
    let text =
        format!("G18 G21 G90 G94 G8\nG0 X50 Z90\n{}G1 X50.1 F3000\nX51 Y2\nM2\n", remark.repeat(40_000));
    place.write("plain.ngc", &text);
    let wide = std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(u16::to_le_bytes);
    let bytes = place.write("wide.ngc", wide.collect::<Vec<u8>>()).metadata().expect("it is there").len();
    let [(plain, less), (wide, more)] =
        ["plain.ngc", "wide.ngc"].map(|name| peak_kb(place.pitchlock().args(["check", name])));
    assert_eq!((wide.status, &wide.stdout), (plain.status, &plain.stdout));
    assert_eq!(wide.stderr, plain.stderr.replace("plain.ngc", "wide.ngc"));
    assert!(wide.status == Some(2) && wide.stderr.contains("wide.ngc:40004:"), "{}", wide.stderr);
    assert!(less > 0 && more < less + 4_000, "{less} kB, and {more} kB for {bytes} bytes of UTF-16");
}

/// A pipe is kept as a whole, so there is an end to it.
#[test]
fn more_than_64_mb_by_a_pipe_are_refused() {
    let place = Place::new();
    let mut endless = Command::new("yes");
    let mut endless = endless.arg("(remark)").stdout(Stdio::piped()).spawn().expect("it starts");
    let input = endless.stdout.take().expect("it is piped");
    let (answer, kb) = peak_kb(place.pitchlock().args(["check", "-"]).stdin(input));
    endless.kill().and_then(|()| endless.wait()).expect("it was started here");
    assert_eq!(answer.status, Some(2), "{}{}", answer.stdout, answer.stderr);
    assert!(answer.stderr.contains("has more than 64 MB"), "{}", answer.stderr);
    assert!(kb < 160_000, "{kb} kB");
}
