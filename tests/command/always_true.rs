//! A run folder says the truth, whatever happens to its disk: what a full one costs is the trace.

use std::{fs, os::unix::fs::FileExt as _, process::Stdio};

use rig::observe::{Outcome, Summary};

use crate::shop::{Answer, Place, can_be_private, example, private, until, wait_s};

/// The disk is full after a part of the trace; the summary is there, whole, and what became of the run is
/// told.
#[test]
fn a_full_disk_costs_the_trace_and_not_the_summary() {
    if !can_be_private("a_full_disk_costs_the_trace_and_not_the_summary") {
        return;
    }
    let program = example("m20x2").display().to_string();
    // Whoever runs it, one recorder writes the trace: in processes one of them is enough.
    for (kb, trace, hows) in [
        (300, "mcap", &["--in-process", ""][..]),
        (300, "csv", &["--in-process"]),
        (2000, "mcap", &["--in-process"]),
    ] {
        for how in hows {
            let place = Place::new();
            fs::create_dir(place.at("disk")).expect("a folder");
            let script = format!(
                "mount -t tmpfs -o size={kb}k tmpfs disk; \"$0\" run {program} --json {how} --trace {trace} --out disk/run
                 status=$?; rm -rf run; cp -r disk/run . ; exit $status"
            );
            let answer = Answer::from(private(&place, &script).output().expect("sh"));
            assert_eq!(answer.status, Some(1), "{}", answer.stderr);
            assert!(answer.stderr.contains("the run goes on without a trace"), "{}", answer.stderr);
            let written = Summary::read(&place.at("run/summary.json")).expect("a whole summary");
            assert_eq!(written.outcome, Outcome::Completed);
            // The room of the trace is that of the rest: the journal knows the end, the run is made again.
            assert!(!place.at("run").join(format!("trace.{trace}")).exists());
            let known = place.ask(&["journal", "run"]);
            assert!(known.stdout.contains("the program came to its end"), "{}", known.stdout);
            let again = place.ask(&["replay", "run"]);
            assert_eq!(again.status, Some(0), "{}{}", again.stdout, again.stderr);
            let printed: Summary = serde_json::from_str(&answer.stdout).expect("--json prints it");
            assert_eq!(printed, written);
        }
    }
}

/// Without room for the summary nothing is run.
#[test]
fn a_disk_without_room_for_the_summary_is_refused_before_the_run() {
    if !can_be_private("a_disk_without_room_for_the_summary_is_refused_before_the_run") {
        return;
    }
    let place = Place::new();
    fs::create_dir(place.at("disk")).expect("a folder");
    let program = example("m20x2").display().to_string();
    let script = format!(
        "mount -t tmpfs -o size=64k tmpfs disk; \"$0\" run {program} --in-process --trace none --out disk/run"
    );
    let answer = Answer::from(private(&place, &script).output().expect("sh"));
    assert_eq!(answer.status, Some(1), "{}", answer.stderr);
    assert!(answer.stderr.contains("summary.json: no room for"), "{}", answer.stderr);
}

/// A program that is changed into another sound one is not taken for what was checked.
#[test]
fn a_program_that_is_replaced_while_it_runs_is_noticed() {
    let place = Place::new();
    let program =
        format!("G18 G21 G90 G94 G64\nG0 X50 Z90\n{}M2\n", "G1 X50.1 F3000\nG1 X50.0 F3000\n".repeat(2_000));
    let path = place.write("long.ngc", &program);
    let mut command = place.pitchlock();
    command.arg("run").arg(&path).args(["--json", "--in-process", "--out", "run"]);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    until("the machine runs", || place.at("run/trace.mcap").exists());
    wait_s(0.02);
    let copy = place.at("run/long.ngc");
    // One move less, at its end, and as long as before.
    let move_s = program.rfind("G1").expect("a move");
    let file = fs::File::options().write(true).open(&copy).expect("it is there");
    file.write_all_at(&b"\n".repeat("G1 X50.0 F3000".len()), move_s as u64).expect("room");
    let answer = Answer::from(child.wait_with_output().expect("it was started here"));
    assert_eq!(answer.status, Some(1), "{}", answer.stderr);
    let summary: Summary = serde_json::from_str(&answer.stdout).expect("the summary");
    let codes: Vec<&str> = summary.faults.iter().map(|fault| fault.code.as_str()).collect();
    assert!(codes.contains(&"program-changed"), "{codes:?}");
}

/// What cannot be printed is no success, whatever was to be printed.
#[test]
fn results_that_cannot_be_printed_are_an_error() {
    let place = Place::new();
    place.write("short.ngc", "G18 G21 G90 G94 G8\nG0 X50 Z90\nM2\n");
    let run = ["run", "short.ngc", "--json", "--in-process", "--trace", "none", "--out", "run"];
    for words in [&run[..], &["check", "short.ngc"], &["machine"], &["canon", "short.ngc"]] {
        let full = fs::File::options().write(true).open("/dev/full").expect("every system has one");
        let answer = Answer::from(place.pitchlock().args(words).stdout(full).output().expect("it starts"));
        assert_ne!(answer.status, Some(0), "{words:?}: {}", answer.stderr);
        assert!(answer.stderr.contains("No space left on device"), "{words:?}: {}", answer.stderr);
        place.clear("run");
        let fine = place.pitchlock().args(words).output().expect("it starts");
        assert!(fine.status.success(), "{words:?}");
    }
}
