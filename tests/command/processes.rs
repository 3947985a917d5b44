//! A run over processes: who takes part, what it leaves behind, how it is repeated, and how Ctrl-C ends it.

use std::{
    collections::BTreeSet,
    io::{BufRead, BufReader},
};

use crate::shop::{Answer, Place, alive, example, name_spaces, scenario, shared_memory, signal, until};
use protocol::Axis;
use rig::{
    observe::{Outcome, Summary},
    trace::{self, Row},
};

const NAMES: [&str; 5] = ["interpreter", "interpolator", "regulator-x", "regulator-z", "sim-plant"];

/// What a run folder has to hold.
fn is_complete(place: &Place, folder: &str, program: &str, scenario: bool) {
    let mut files = vec!["summary.json", "journal.bin", "trace.mcap", "report.html", program, "machine.toml"];
    files.extend(scenario.then_some("scenario.toml"));
    for file in files {
        let path = place.at(folder).join(file);
        let length = path.metadata().map_or(0, |found| found.len());
        assert!(length > 0, "{} is missing or empty", path.display());
    }
    let page = std::fs::read_to_string(place.at(folder).join("report.html")).expect("just seen");
    // What the plotting library could fetch for maps is inside its script, and stays there.
    let outside_scripts = page.split("<script").map(|part| part.rsplit("</script>").next().unwrap_or(part));
    let markup: String = outside_scripts.collect();
    let away = ["<link", "src=\"http", "url(http", "@import"];
    assert!(!away.iter().any(|link| markup.contains(link)), "the report opens without a network");
    assert!(!page.contains("<script src") && markup.len() > 5000, "{} bytes of markup", markup.len());
}

#[test]
fn a_run_is_five_processes_and_can_be_repeated_from_its_folder() {
    let place = Place::new();
    let path = scenario("override-in-pass").display().to_string();
    let summary = place.run(&example("m20x2"), "run", &["--scenario", &path, "--seed", "7"]);
    let names: BTreeSet<_> = summary.processes.iter().map(|process| process.name.as_str()).collect();
    assert!(names.is_superset(&NAMES.into()), "{names:?}");
    let pids: BTreeSet<_> = summary.processes.iter().map(|process| process.pid).collect();
    assert_eq!(pids.len(), summary.processes.len(), "every process is one of its own");
    assert!(summary.processes.iter().all(|process| process.exit == Some(0)), "{:?}", summary.processes);
    for channel in &summary.channels {
        let nobody_at_the_panel = channel.name == "operator";
        assert!((channel.sent == 0) == nobody_at_the_panel && channel.lost == 0, "{channel:?}");
    }
    let sent = |name: &str| summary.channels.iter().find(|channel| channel.name == name).map(|one| one.sent);
    assert_eq!(sent("drive-command/x"), Some(summary.cycles), "{:?}", summary.channels);
    is_complete(&place, "run", "m20x2.ngc", true);
    assert!(place.at("run/scenario.toml").exists());
    let written: Summary = Summary::read(&place.at("run/summary.json")).expect("it was just written");
    assert_eq!(written, summary, "--json prints what is written");

    let repeated = place.run(&place.at("run"), "again", &[]);
    assert_eq!(repeated.trace_hash, summary.trace_hash);
    assert_eq!(repeated.seed, 7);
    is_complete(&place, "again", "m20x2.ngc", true);
    let left = (name_spaces(&place), shared_memory(&place, &BTreeSet::new()), alive(&place));
    assert_eq!(left, (vec![], vec![], false), "nothing is left of the processes");
}

#[test]
fn a_run_folder_left_where_it_is_made_is_numbered() {
    let place = Place::new();
    for n in 1..3 {
        let program = example("m20x2").display().to_string();
        let answer = place.ask(&["run", &program, "--in-process", "--trace", "none"]);
        assert_eq!(answer.status, Some(0), "{}", answer.stderr);
        assert!(place.at(&format!("runs/m20x2-{n}/summary.json")).exists());
    }
}

#[test]
fn machine_code_runs_like_the_program_it_was_made_of() {
    let place = Place::new();
    let program = example("m20x2").display().to_string();
    let compiled = place.ask(&["compile", &program, "-o", "m20x2.mc"]);
    assert_eq!(compiled.status, Some(0), "{}", compiled.stderr);
    let from_code = place.run(&place.at("m20x2.mc"), "code", &["--trace", "none"]);
    let from_text = place.run_inside(&example("m20x2"), None);
    assert_eq!(from_code.trace_hash, from_text.trace_hash);
    assert!(place.at("code/m20x2.mc").exists());
}

/// Bytes of a trace that ends in the thread of `interrupted`.
const IN_THE_PASS: u64 = 3_000_000;

/// Starts a run of one long thread, sends it signals and hears what the launcher says to each, and gives the
/// answer. The first comes when the trace has so many bytes: 3 MB are 13 s, the thread begins after 8 s and
/// takes 270 s, and the spindle is slow, so it still turns when the next comes.
fn interrupted(place: &Place, more: &[&str], bytes: u64, signals: &[(&str, &str)]) -> (Answer, Summary) {
    let text = "G18 G21 G90 G8\nM3 S300\nG0 X20 Z150\nG0 X9\nG33 Z-1350 K2\nG0 X20\nG0 Z150\nM5\nM2\n";
    let machine = place.ask(&["machine"]).stdout;
    let machine = machine.replace("[-400.0", "[-2000.0").replace("ramp_rpm_s = 800.0", "ramp_rpm_s = 50.0");
    place.write("long.toml", machine);
    let program = place.write("long.ngc", text);
    let mut command = place.pitchlock();
    command.arg("run").arg(&program).args(["--json", "--out", "run", "--machine", "long.toml"]).args(more);
    command.stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped());
    let mut launcher = command.spawn().expect("it starts");
    let mut lines = BufReader::new(launcher.stderr.take().expect("it is piped")).lines();
    let written = || std::fs::metadata(place.at("run/trace.mcap")).map_or(0, |file| file.len());
    until("the machine runs", || written() > bytes);
    for (name, said) in signals {
        signal(launcher.id(), name);
        let mut heard = || lines.next().expect("it says something").expect("it can be read");
        while !said.is_empty() && !heard().contains(said) {}
    }
    let mut answer = Answer::from(launcher.wait_with_output().expect("it was started here"));
    answer.stderr = lines.map(|line| line.expect("it can be read") + "\n").collect();
    let summary: Summary = serde_json::from_str(&answer.stdout)
        .unwrap_or_else(|error| panic!("{signals:?}: {error}: {} {}", answer.stdout, answer.stderr));
    let left = (name_spaces(place), shared_memory(place, &BTreeSet::new()), alive(place));
    assert_eq!(left, (vec![], vec![], false), "nothing is left of the processes");
    (answer, summary)
}

/// Where X and how fast the spindle is at the end of the trace.
fn at_the_end(place: &Place) -> (f64, f64) {
    let mut last = (f64::NAN, f64::NAN);
    let x_mm = |row: &Row| row.axis(Axis::X).map_or(f64::NAN, |axis| axis.true_mm);
    trace::read(&place.at("run/trace.mcap"), |row| last = (x_mm(&row), row.spindle_rpm)).expect("a trace");
    last
}

#[test]
fn ctrl_c_and_a_terminal_that_is_closed_stop_the_machine_and_the_folder_is_complete() {
    for signals in [&[("INT", "stopping")][..], &[("HUP", ""), ("HUP", ""), ("TERM", "stopping")]] {
        let place = Place::new();
        let (answer, summary) = interrupted(&place, &[], IN_THE_PASS, signals);
        assert_eq!(answer.status, Some(1), "a program that was not executed whole: {}", answer.stderr);
        assert_eq!((summary.outcome, summary.faults.len()), (Outcome::Stopped, 0), "{:?}", summary.faults);
        assert!(summary.processes.iter().all(|process| process.exit == Some(0)), "{:?}", summary.processes);
        assert!(summary.channels.iter().all(|channel| channel.lost == 0), "{:?}", summary.channels);
        is_complete(&place, "run", "long.ngc", false);
        let (x_mm, rpm) = at_the_end(&place);
        assert!(!summary.passes[0].complete && x_mm > 12.0 && rpm.abs() < 1.0, "{x_mm} mm, {rpm} 1/min");
    }
}

#[test]
fn ctrl_c_after_a_signal_is_an_emergency_stop_and_the_run_ends_at_rest() {
    let place = Place::new();
    let (answer, summary) =
        interrupted(&place, &[], IN_THE_PASS, &[("TERM", "stopping"), ("INT", "emergency stop")]);
    assert_eq!((answer.status, summary.outcome), (Some(1), Outcome::Faulted), "{}", answer.stderr);
    assert!(summary.faults.iter().all(|fault| fault.code == "emergency-stop"), "{:?}", summary.faults);
    assert!(summary.processes.iter().all(|process| process.exit == Some(0)), "{:?}", summary.processes);
    let (x_mm, rpm) = at_the_end(&place);
    assert!(x_mm > 12.0 && rpm.abs() < 1.0, "{x_mm} mm, {rpm} 1/min");
}

/// A machine that cannot come to rest: one of its processes is stopped, and no watchdog looks after it.
#[test]
fn a_third_ctrl_c_ends_a_machine_that_does_not_come_to_rest_and_says_so() {
    let place = Place::new();
    let frozen = ["--watchdog-s", "0", "--fell", "regulator-x:freeze@1000"];
    let signals = [("INT", "stopping"), ("INT", "emergency stop"), ("INT", "as they are")];
    let (answer, summary) = interrupted(&place, &frozen, 0, &signals);
    assert_eq!((answer.status, summary.outcome), (Some(1), Outcome::Faulted), "{}", answer.stderr);
    assert!(summary.faults.iter().any(|fault| fault.code == "broken-off"), "{:?}", summary.faults);
}
