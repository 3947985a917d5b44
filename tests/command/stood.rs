//! The recorder and the terminal stand: a launcher that is stopped, words that nobody reads. The machine does
//! the same, and in real time what is not recorded is counted cycle by cycle.

use std::{io::Write as _, process::Command};

use rig::observe::{Outcome, Summary};

use crate::endings::{ATTEMPTS, PIPE, command, ends, runs, slow_machine, summary, was_busy};
use crate::shop::{Place, signal, wait_s};

/// How long somebody stands, s, unless `PITCHLOCK_STOPPED_S` says otherwise.
pub(crate) fn stopped_s(unless_said: f64) -> f64 {
    let said = std::env::var("PITCHLOCK_STOPPED_S").ok();
    said.map_or(unless_said, |said| said.parse().expect("a number of seconds"))
}

/// The same command with a terminal that nobody reads, and that takes nothing more.
fn unread(mut command: Command) -> (Command, std::io::PipeReader) {
    let (unread, mut full) = std::io::pipe().expect("a pipe");
    full.write_all(&[b'x'; PIPE]).expect("it holds that much");
    command.stderr(full);
    (command, unread)
}

/// In lock step the machine waits for its recorder, and no cycle of it is another one.
#[test]
fn in_lock_step_a_launcher_that_stood_changes_no_cycle() {
    let place = Place::new();
    let text = "G18 G21 G90 G8\nM3 S300\nG0 X20 Z150\nG0 X9\nG33 Z-150 K2\nG0 X20\nM5\nM2\n";
    let (mut command, _unread) = unread(command(&place, text, machine::SMALL_LATHE));
    let mut launcher = command.spawn().expect("it starts");
    runs(&place);
    signal(launcher.id(), "STOP");
    wait_s(stopped_s(1.5));
    signal(launcher.id(), "CONT");
    assert!(ends(&mut launcher, 60.0), "it does not end");
    let stood = summary(&place.at("run"));
    let program = place.at("program.ngc");
    let never =
        place.run(&program, "never", &["--in-process", "--trace", "none", "--machine", "machine.toml"]);
    assert_eq!((stood.trace_hash, stood.cycles), (never.trace_hash, never.cycles));
    assert!(stood.channels.iter().all(|channel| channel.lost == 0), "{:?}", stood.channels);
}

/// A run in real time whose launcher stands for so long, and goes on then.
fn stood_in_real_time(place: &Place, text: &str, stopped_s: f64) -> Summary {
    let (mut command, _unread) = unread(command(place, text, &slow_machine()));
    let mut launcher = command.args(["--clock", "real"]).spawn().expect("it starts");
    runs(place);
    signal(launcher.id(), "STOP");
    wait_s(stopped_s);
    signal(launcher.id(), "CONT");
    assert!(ends(&mut launcher, 60.0), "it does not end");
    let summary = summary(&place.at("run"));
    assert!(summary.processes.iter().all(|process| process.exit == Some(0)), "{:?}", summary.processes);
    assert!(was_busy(&summary) || summary.outcome == Outcome::Completed, "{:?}", summary.faults);
    summary
}

#[test]
fn in_real_time_a_launcher_that_stood_loses_records_and_nothing_else() {
    let stopped_s = stopped_s(6.5);
    let text = format!("G18 G21 G90 G8 G94\nG0 X50 Z90\nG4 P{:.1}\nG1 X49 F600\nM2\n", stopped_s + 2.5);
    let attempt = || {
        let place = Place::new();
        let summary = stood_in_real_time(&place, &text, stopped_s);
        let truth = summary.channels.iter().find(|channel| channel.name == "truth").expect("it is counted");
        // Each cycle is recorded or counted as lost.
        let kept = std::fs::read_to_string(place.at("run/arrivals.txt")).expect("it is there");
        let all = kept.lines().find_map(|line| line.strip_prefix("until ")?.parse::<u64>().ok());
        assert_eq!(all, Some(summary.cycles + truth.lost), "{truth:?}");
        !was_busy(&summary) && truth.lost > 0
    };
    assert!((0..ATTEMPTS).any(|_| attempt()), "answers were late each time the launcher stood");
}
