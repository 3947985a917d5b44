//! The recorder and the terminal stand: a launcher that is stopped, words that nobody reads. The machine does
//! the same, and in real time what is not recorded is counted cycle by cycle.

use std::{
    fs::File,
    io::{Read as _, Write as _},
    os::unix::process::ExitStatusExt as _,
    process::{Child, Command},
    sync::{Mutex, PoisonError},
};

use rig::observe::{Outcome, Summary};

use crate::endings::{ATTEMPTS, PIPE, command, ends, runs, slow_machine, summary, was_busy};
use crate::shop::{Place, children, signal, until, wait_s};

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

/// One such run at a time: two would be late by each other.
static ALONE: Mutex<()> = Mutex::new(());

/// A run in real time whose launcher stands for so long, and goes on then.
fn stood_in_real_time(place: &Place, text: &str, scenario: &str, stopped_s: f64) -> Summary {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let scenario = place.write("scenario.toml", scenario);
    let (mut command, _unread) = unread(command(place, text, &slow_machine()));
    command.args(["--clock", "real", "--scenario"]).arg(scenario);
    let mut launcher = command.spawn().expect("it starts");
    runs(place);
    signal(launcher.id(), "STOP");
    wait_s(stopped_s);
    signal(launcher.id(), "CONT");
    assert!(ends(&mut launcher, 60.0), "it does not end");
    let summary = summary(&place.at("run"));
    // Whoever gets no processor for a second of the machine is killed, which is told; nobody else may be.
    let all_ended = summary.processes.iter().all(|process| process.exit == Some(0));
    assert!(was_busy(&summary) || all_ended, "{:?} {:?}", summary.processes, summary.faults);
    summary
}

/// Whether each cycle was recorded or counted as lost, and some were lost.
fn has_a_gap(place: &Place, summary: &Summary) -> bool {
    let truth = summary.channels.iter().find(|channel| channel.name == "truth").expect("it is counted");
    let kept = std::fs::read_to_string(place.at("run/arrivals.txt")).expect("it is there");
    let all = kept.lines().find_map(|line| line.strip_prefix("until ")?.parse::<u64>().ok());
    assert_eq!(all, Some(summary.cycles + truth.lost), "{truth:?}");
    truth.lost > 0
}

#[test]
fn in_real_time_a_launcher_that_stood_loses_records_and_nothing_else() {
    let stopped_s = stopped_s(6.5);
    let text = format!("G18 G21 G90 G8 G94\nG0 X50 Z90\nG4 P{:.1}\nG1 X49 F600\nM2\n", stopped_s + 2.5);
    let attempt = || {
        let place = Place::new();
        let summary = stood_in_real_time(&place, &text, "", stopped_s);
        assert!(was_busy(&summary) || summary.outcome == Outcome::Completed, "{:?}", summary.faults);
        has_a_gap(&place, &summary) && !was_busy(&summary)
    };
    assert!((0..ATTEMPTS).any(|_| attempt()), "answers were late each time the launcher stood");
}

/// The queues hold 4.1 s; the launcher stands for longer, and what happens in the gap is known.
fn in_the_gap(dwell_s: f64, event: &str, is_told: impl Fn(&Summary) -> bool) {
    let text = format!("G18 G21 G90 G8 G94\nG0 X50 Z90\nG4 P{dwell_s}\nM2\n");
    let attempt = || {
        let place = Place::new();
        let summary = stood_in_real_time(&place, &text, event, 6.5);
        // What stopped the machine before is told first.
        let known = was_busy(&summary) || is_told(&summary);
        assert!(known, "{:?} {:?}", summary.outcome, summary.faults);
        has_a_gap(&place, &summary) && !was_busy(&summary)
    };
    assert!((0..ATTEMPTS).any(|_| attempt()), "answers were late each time the launcher stood");
}

#[test]
fn a_program_that_ends_while_the_launcher_stands_has_come_to_its_end() {
    in_the_gap(4.9, "", |summary| summary.outcome == Outcome::Completed && summary.faults.is_empty());
}

#[test]
fn a_trip_while_the_launcher_stands_is_told() {
    let event = "[[event]]\nat = { time_s = 5.5 }\ndrive_fault = \"z\"\n";
    in_the_gap(60.0, event, |summary| {
        let Some(first) = summary.faults.first() else { return false };
        assert!(first.text.contains("cycles before are not recorded"), "{}", first.text);
        (first.source.as_str(), first.code.as_str()) == ("regulator-z", "drive-fault")
    });
}

#[test]
fn a_stop_while_the_launcher_stands_is_told() {
    let event = "[[event]]\nat = { time_s = 5.5 }\nstop = true\n";
    in_the_gap(60.0, event, |summary| summary.outcome == Outcome::Stopped && summary.faults.is_empty());
}

/// A run whose standard output is not read, once nothing is left to do for it but to print.
fn unprinted(place: &Place) -> (Child, std::io::PipeReader) {
    let (unread, mut full) = std::io::pipe().expect("a pipe");
    full.write_all(&[b'x'; PIPE]).expect("it holds that much");
    let text = "G18 G21 G90 G94\nG0 X50 Z90\nG1 X49 F600\nM2\n";
    let mut command = command(place, text, machine::SMALL_LATHE);
    let launcher = command.stdout(full).spawn().expect("it starts");
    let is_free = || File::open(place.at("run")).is_ok_and(|folder| folder.try_lock().is_ok());
    until("the folder is whole and free", || place.at("run/report.html").exists() && is_free());
    assert_eq!(summary(&place.at("run")).outcome, Outcome::Completed);
    assert!(place.at("run/arrivals.txt").exists() && !place.at("run/summary.json.new").exists());
    assert!(children(&launcher).is_empty(), "no machine is left");
    (launcher, unread)
}

/// Whoever prints waits for a reader; nothing else does, the folder least of all, and Ctrl-C ends it.
#[test]
fn a_summary_that_nobody_reads_holds_up_neither_folder_nor_ctrl_c() {
    let place = Place::new();
    let (mut launcher, unread) = unprinted(&place);
    assert!(launcher.try_wait().expect("a child").is_none(), "it waits for a reader");
    let replayed = place.ask(&["replay", "run"]);
    assert_eq!(replayed.status, Some(0), "{}", replayed.stderr);
    signal(launcher.id(), "INT");
    assert!(ends(&mut launcher, 30.0), "Ctrl-C does nothing");
    assert_eq!(launcher.wait().expect("a child").signal(), Some(2), "what was not printed is no success");
    drop(unread);

    let (mut launcher, mut late) = unprinted(&place);
    let mut read = String::new();
    late.read_to_string(&mut read).expect("text");
    assert_eq!(launcher.wait().expect("a child").code(), Some(0));
    let printed: Summary = serde_json::from_str(read.trim_start_matches('x')).expect("all of it");
    assert_eq!(printed.trace_hash, summary(&place.at("run")).trace_hash);
}
