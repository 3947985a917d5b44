//! A run over processes: who takes part, what it leaves behind, how it is repeated, and how Ctrl-C ends it.

use std::collections::BTreeSet;

use crate::shop::{
    Answer, Place, alive, example, name_spaces, scenario, shared_memory, signal, until, wait_s,
};
use rig::observe::{Outcome, Summary};

const NAMES: [&str; 5] = ["interpreter", "interpolator", "regulator-x", "regulator-z", "sim-plant"];

/// What a run folder has to hold.
fn is_complete(place: &Place, folder: &str, scenario: bool) {
    let mut files = vec!["summary.json", "trace.mcap", "report.html", "m20x2.ngc", "machine.toml"];
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
    is_complete(&place, "run", true);
    assert!(place.at("run/scenario.toml").exists());
    let written: Summary = Summary::read(&place.at("run/summary.json")).expect("it was just written");
    assert_eq!(written, summary, "--json prints what is written");

    let repeated = place.run(&place.at("run"), "again", &[]);
    assert_eq!(repeated.trace_hash, summary.trace_hash);
    assert_eq!(repeated.seed, 7);
    is_complete(&place, "again", true);
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

#[test]
fn ctrl_c_stops_the_machine_and_the_folder_is_complete() {
    let place = Place::new();
    let launcher = place.start(&example("m20x2"));
    until("the machine runs", || place.at("run/trace.mcap").exists());
    wait_s(0.4);
    signal(launcher.id(), "INT");
    let answer = Answer::from(launcher.wait_with_output().expect("it was started here"));
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    let summary: Summary = serde_json::from_str(&answer.stdout).expect("--json prints the summary");
    assert_eq!(summary.outcome, Outcome::Stopped, "{:?}", summary.faults);
    assert!(summary.processes.iter().all(|process| process.exit == Some(0)), "{:?}", summary.processes);
    assert!(summary.channels.iter().all(|channel| channel.lost == 0), "{:?}", summary.channels);
    is_complete(&place, "run", false);
    let left = (name_spaces(&place), shared_memory(&place, &BTreeSet::new()), alive(&place));
    assert_eq!(left, (vec![], vec![], false), "nothing is left of the processes");
}
