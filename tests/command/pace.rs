//! A machine in lock step that keeps to the clock of the wall does the same as one that does not, and takes
//! its time; Ctrl-C and refusals.

use std::process::Stdio;

use rig::observe::{Outcome, Summary};

use crate::replay::THREAD;
use crate::shop::{Answer, Place, example, signal, until};

/// As many seconds on the machine for each second on the wall, and the least that a run takes by it, s.
fn takes(summary: &Summary, pace: f64) -> f64 {
    (summary.cycles - 1) as f64 * summary.cycle_s / pace
}

#[test]
fn a_run_is_the_same_at_any_pace_and_takes_its_time() {
    let place = Place::new();
    let program = place.write("thread.ngc", THREAD);
    let free = place.run_inside(&program, None);
    for (pace, number, how) in [("5", 5.0, &[][..]), ("8", 8.0, &["--in-process"]), ("1000", 1000.0, &[])] {
        let asked = [&["--trace", "none", "--pace", pace], how].concat();
        let paced = place.run(&program, "paced", &asked);
        assert_eq!((&paced.trace_hash, paced.cycles), (&free.trace_hash, free.cycles), "{asked:?}");
        assert!(paced.wall_s >= takes(&paced, number), "{asked:?}: {} s", paced.wall_s);
        assert!(paced.channels.iter().all(|channel| channel.lost == 0), "{:?}", paced.channels);
    }
    // How it was watched is no part of a run: its folder is repeated as fast as the computer can.
    let again = place.run(&place.at("paced"), "again", &["--trace", "none"]);
    assert_eq!(again.trace_hash, free.trace_hash);
    assert_eq!(place.ask(&["replay", "again"]).status, Some(0));
}

#[test]
fn a_machine_at_a_pace_obeys_ctrl_c() {
    for how in [&[][..], &["--in-process"]] {
        let place = Place::new();
        let mut command = place.pitchlock();
        command.arg("run").arg(example("m20x2")).args(["--json", "--out", "run", "--pace", "0.5"]).args(how);
        let launcher = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
        let written = || std::fs::metadata(place.at("run/trace.mcap")).map_or(0, |file| file.len());
        until("the machine runs", || written() > 100);
        signal(launcher.id(), "INT");
        let answer = Answer::from(launcher.wait_with_output().expect("it was started here"));
        assert_eq!(answer.status, Some(1), "{}", answer.stderr);
        let summary: Summary = serde_json::from_str(&answer.stdout).expect("the summary");
        assert_eq!((summary.outcome, summary.faults.len()), (Outcome::Stopped, 0), "{:?}", summary.faults);
        assert!(answer.stderr.contains("stopping") && summary.wall_s >= takes(&summary, 0.5));
    }
}

#[test]
fn a_pace_that_is_none_and_one_of_real_time_are_refused() {
    let place = Place::new();
    let program = example("m20x2").display().to_string();
    for (asked, said) in [
        (&["--pace", "0"][..], "seconds on the machine for each second on the wall, 0.05 to 1000, or max"),
        (&["--pace", "fast"], "0.05 to 1000, or max"),
        (&["--pace", "1", "--clock", "real"], "leave out --pace, or --clock real"),
    ] {
        let answer = place.ask(&[&["run", &program, "--out", "run"], asked].concat());
        assert_eq!(answer.status, Some(2), "{asked:?}");
        assert!(answer.stderr.contains(said), "{asked:?}: {}", answer.stderr);
        assert!(!place.at("run").exists(), "{asked:?}: nothing was begun");
    }
}
