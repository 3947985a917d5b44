//! What docs/figures.md claims, a run shows: its table of threads, its samples of summaries.

use crate::shop::{self, Place, example, project};
use rig::observe::{PassReport, Summary};

fn page() -> String {
    std::fs::read_to_string(project().join("docs/figures.md")).expect("there is a page of figures")
}

/// Rows of the table of figures: its cells without the marks of the table.
fn figures(page: &str) -> Vec<Vec<String>> {
    let cells = |line: &str| line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect();
    let of_example = |line: &&str| shop::EXAMPLES.iter().any(|name| line.starts_with(&format!("| {name} |")));
    page.lines().filter(of_example).map(cells).collect()
}

fn worst(summary: &Summary, of: impl Fn(&PassReport) -> f64) -> f64 {
    summary.passes.iter().map(of).fold(0.0, f64::max)
}

#[test]
fn the_figures_of_threads_are_those_of_runs() {
    let rows = figures(&page());
    assert_eq!(rows.len(), shop::EXAMPLES.len() * (1 + shop::SCENARIOS.len()));
    let place = Place::new();
    for row in rows {
        let scenario = Some(row[1].as_str()).filter(|name| *name != "–");
        let summary = place.run_inside(&example(&row[0]), scenario);
        let lowest = summary.passes.iter().map(|pass| pass.rpm_min).fold(f64::MAX, f64::min);
        let shown = [
            format!("{lowest:.0} … {:.0}", worst(&summary, |pass| pass.rpm_max)),
            format!("{:.2}", worst(&summary, |pass| pass.tool.helix_max_abs_um)),
            format!("{:.3}", summary.thread.tool_phase_spread_um),
            format!("{:.2}", summary.thread.tool_depth_off_um.abs()),
            format!("{:.2}", summary.thread.tool_depth_um),
            format!("{:.2}", worst(&summary, |pass| pass.helix_max_abs_um)),
            format!("{:.3}", summary.thread.phase_spread_um),
            format!("{:.3}", worst(&summary, |pass| pass.lead_error_um_per_rev.abs())),
            format!("{:.2}", worst(&summary, |pass| pass.x.thread_max_abs_um)),
        ];
        assert_eq!(row[2..], shown, "{} {}", row[0], row[1]);
    }
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
