//! Jobs on the command line: each command that takes a program takes a job, and a run of one can be repeated.

use std::path::Path;

use crate::shop::{Answer, Place, project};

/// Answer of a command that must do what was asked.
fn accepts(place: &Place, arguments: &[&str]) -> Answer {
    let answer = place.ask(arguments);
    assert_eq!(answer.status, Some(0), "{arguments:?}: {}", answer.stderr);
    answer
}

fn shape(name: &str) -> String {
    project().join("examples/shape").join(name).display().to_string()
}

fn mill() -> String {
    project().join("examples/machines/small-mill.toml").display().to_string()
}

/// The line of the summary that names the trace.
fn trace(answer: &Answer) -> String {
    let line = answer.stdout.lines().find(|line| line.starts_with("trace"));
    line.unwrap_or_else(|| panic!("{}", answer.stdout)).to_owned()
}

#[test]
fn a_run_of_a_job_can_be_repeated_from_its_folder_and_from_its_machine_code() {
    let place = Place::new();
    let (job, machine) = (shape("contour.toml"), mill());
    let quick = ["--in-process", "--trace", "none"];
    let run = |program: &str, out: &str| {
        let arguments = [&["run", program, "--machine", &machine, "--out", out][..], &quick].concat();
        trace(&accepts(&place, &arguments))
    };
    let first = run(&job, "first");
    assert!(Path::new(&place.at("first/contour.toml")).exists(), "the folder keeps the job");
    let again = accepts(&place, &[&["run", "first", "--out", "again"][..], &quick].concat());
    assert_eq!(trace(&again), first);
    accepts(&place, &["compile", &job, "--machine", &machine, "-o", "contour.mc"]);
    assert_eq!(run("contour.mc", "compiled"), first);
}

#[test]
fn check_says_what_a_job_is_and_canon_prints_it() {
    let place = Place::new();
    let said = accepts(&place, &["check", &shape("wave.toml"), "--machine", &mill()]).stdout;
    for words in [
        "z = 0.02*x^2 + 8*sin(x/15)*cos(y/20)",
        "173 lines along X, zigzag",
        "ridges of at most 9.92 µm",
        "about 8",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    let printed = accepts(&place, &["canon", &shape("inline.ngc")]).stdout;
    assert!(printed.contains("JOB(\"z = \"6*cos(x/14)*cos(y/12)\"\")\n"), "{printed}");
    let comments = accepts(&place, &["canon", "--format", "linuxcnc", &shape("inline.ngc")]).stdout;
    assert!(comments.contains("COMMENT(\"@ x = [-20, 20]\")\n") && !comments.contains("JOB"), "{comments}");
}

#[test]
fn a_job_that_would_hide_the_machine_file_of_its_run_folder_is_refused() {
    let place = Place::new();
    let job = std::fs::read_to_string(shape("contour.toml")).expect("it is shipped");
    place.write("machine.toml", job);
    let answer = place.ask(&["run", "machine.toml", "--machine", &mill(), "--in-process", "--out", "run"]);
    assert_eq!(answer.status, Some(2));
    assert!(answer.stderr.contains("rename the job"), "{}", answer.stderr);
}
