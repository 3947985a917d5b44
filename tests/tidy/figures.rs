//! What docs/figures.md claims, a run shows: its samples of summaries. Its table of threads is held by
//! `tests/machine/ten_seeds.rs`.

use crate::shop::{Place, example, project};

fn page() -> String {
    std::fs::read_to_string(project().join("docs/figures.md")).expect("there is a page of figures")
}

#[test]
fn the_sample_of_a_summary_is_that_of_a_run() {
    let page = page();
    let trace = page.lines().find_map(|line| line.strip_prefix("trace     ")).expect("the sample has a hash");
    let summary = Place::new().run_inside(&example("m20x2"), None);
    assert_eq!(summary.trace_hash, trace);
    let passes_and_moves =
        format!("completed: {} passes, {} moves", summary.passes.len(), summary.moves.count);
    assert!(page.contains(&passes_and_moves), "{passes_and_moves}");
}

/// The lines of a command's answer that begin so.
fn said(place: &Place, args: &[&str], beginnings: &[&str]) -> String {
    let answer = place.ask(args);
    let begins = |line: &&str| beginnings.iter().any(|beginning| line.starts_with(beginning));
    let lines: Vec<&str> = answer.stdout.lines().filter(begins).collect();
    assert_eq!(lines.len(), beginnings.len(), "{}", answer.stdout);
    lines.join("\n")
}

fn at(name: &str) -> String {
    project().join("examples").join(name).display().to_string()
}

#[test]
fn the_sample_of_a_circle_is_that_of_a_run() {
    let (circle, mill) = (at("mill/circle.ngc"), at("machines/small-mill.toml"));
    let run = ["run", &circle, "--machine", &mill, "--in-process", "--trace", "none"];
    let shown = said(&Place::new(), &run, &["contour", "circle"]);
    assert!(page().contains(&shown), "{shown}");
}

#[test]
fn the_samples_of_formulas_are_those_of_runs_and_of_compile() {
    let place = Place::new();
    let (wave, mill) = (at("shape/wave.toml"), at("machines/small-mill.toml"));
    let (seam, positioner) = (at("positioner/cylinders.toml"), at("machines/positioner.toml"));
    let run = |job: &str, machine: &str, what: &str| {
        said(&place, &["run", job, "--machine", machine, "--in-process", "--trace", "none"], &[what])
    };
    let code = place.at("wave.mc").display().to_string();
    let compile = ["compile", &wave, "--machine", &mill, "-o", &code];
    let shown = [
        run(&wave, &mill, "surface"),
        run(&seam, &positioner, "seam"),
        said(&place, &compile, &["machine code"]),
    ];
    assert!(page().contains(&shown.join("\n")), "{shown:#?}");
}
