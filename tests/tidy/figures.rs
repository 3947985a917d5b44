//! What docs/figures.md claims, a run shows: its samples of summaries. Its table of threads is held by
//! `tests/machine/ten_seeds.rs`.

use crate::shop::{Place, example, project};

fn page() -> String {
    read("docs/figures.md")
}

fn read(page: &str) -> String {
    std::fs::read_to_string(project().join(page)).expect("there is a page")
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

/// Times of contours that the changelog tells are those of the table in docs/figures.md, with P0.01.
#[test]
fn the_changelog_tells_the_times_of_the_page() {
    let page = page();
    let time = |row: &str| {
        let row = page.lines().find(|line| line.starts_with(row)).expect("the table has this contour");
        let column = row.split('|').nth(6).and_then(|column| column.trim().parse::<f64>().ok());
        column.expect("seconds with P0.01")
    };
    let [gear, letters, zigzag] =
        ["| gear, 2 µm | 719 |", "| letters, 2 µm | 1027 |", "| zigzag, 30 to 110° | 300 |"].map(time);
    let told = read("CHANGELOG.md").replace("\n  ", " ");
    for words in [
        format!("a gear in lines takes {gear:.1} s"),
        format!("letters {letters:.1} instead"),
        format!("a zigzag {zigzag:.1} instead"),
    ] {
        assert!(told.contains(&words), "CHANGELOG.md lacks this: {words}");
    }
}

/// What an overlap at a right angle saves, as docs/motion.md says.
#[test]
fn a_right_angle_is_passed_so_much_earlier() {
    const SQUARES: u32 = 25;
    let (place, mill) = (Place::new(), at("machines/small-mill.toml"));
    let time_s = |name: &str, mode: &str| {
        let sides = "G1 X5\nG1 Y5\nG1 X0\nG1 Y0\n".repeat(SQUARES as usize);
        let program = format!("G17 G21 G90 G94 {mode}\nG0 X0 Y0\nG1 F6000\n{sides}M2\n");
        let program = place.write(name, program).display().to_string();
        let answer = place.ask(&["check", &program, "--machine", &mill, "--json"]);
        let line = answer.stdout.lines().find_map(|line| line.trim().strip_prefix("\"time_s\":"));
        line.and_then(|time| time.trim().trim_end_matches(',').parse::<f64>().ok()).expect("a time")
    };
    let exact = time_s("exact.ngc", "G61.1");
    let [wide, narrow] = [("wide.ngc", "G64 P0.01"), ("narrow.ngc", "G64 P0.002")]
        .map(|(name, mode)| 1e3 * (exact - time_s(name, mode)) / f64::from(4 * SQUARES - 1));
    let words =
        format!("passed {wide:.0} ms earlier than in G61.1 with P0.01, and {narrow:.0} ms with P0.002");
    assert!(read("docs/motion.md").replace('\n', " ").contains(&words), "docs/motion.md lacks this: {words}");
}
