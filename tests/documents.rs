//! What the README claims, a run shows: its table of figures, its sample of a summary.

mod shop;

use rig::observe::{PassReport, Summary};
use shop::{Place, example, project};

fn readme() -> String {
    std::fs::read_to_string(project().join("README.md")).expect("there is a README")
}

/// Rows of the table of figures: its cells without the marks of the table.
fn figures(readme: &str) -> Vec<Vec<String>> {
    let cells = |line: &str| line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect();
    let of_example = |line: &&str| shop::EXAMPLES.iter().any(|name| line.starts_with(&format!("| {name} |")));
    readme.lines().filter(of_example).map(cells).collect()
}

fn worst(summary: &Summary, of: impl Fn(&PassReport) -> f64) -> f64 {
    summary.passes.iter().map(of).fold(0.0, f64::max)
}

#[test]
fn the_figures_of_the_readme_are_those_of_a_run() {
    let rows = figures(&readme());
    assert_eq!(rows.len(), shop::EXAMPLES.len() * (1 + shop::SCENARIOS.len()));
    let place = Place::new();
    for row in rows {
        let scenario = Some(row[1].as_str()).filter(|name| *name != "–");
        let summary = place.run_inside(&example(&row[0]), scenario);
        let lowest = summary.passes.iter().map(|pass| pass.rpm_min).fold(f64::MAX, f64::min);
        let shown = [
            format!("{lowest:.0} … {:.0}", worst(&summary, |pass| pass.rpm_max)),
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
    let readme = readme();
    let trace =
        readme.lines().find_map(|line| line.strip_prefix("trace     ")).expect("the sample has a hash");
    let summary = Place::new().run_inside(&example("m20x2"), None);
    assert_eq!(summary.trace_hash, trace);
    let passes_and_moves =
        format!("completed: {} passes, {} moves", summary.passes.len(), summary.moves.count);
    assert!(readme.contains(&passes_and_moves), "{passes_and_moves}");
}

#[test]
fn the_sample_of_a_circle_is_that_of_a_run() {
    let place = Place::new();
    let file = |name: &str| project().join("examples").join(name).display().to_string();
    let (circle, mill) = (file("mill/circle.ngc"), file("machines/small-mill.toml"));
    let answer = place.ask(&["run", &circle, "--machine", &mill, "--in-process"]);
    let shown: Vec<&str> = answer
        .stdout
        .lines()
        .filter(|line| line.starts_with("contour") || line.starts_with("circle"))
        .collect();
    assert_eq!(shown.len(), 2, "{}", answer.stdout);
    assert!(readme().contains(&shown.join("\n")), "{shown:?}");
}
