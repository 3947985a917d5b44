//! The part of a program: in a file beside it, in the run folder, in what `check` and `run` say.

use std::fs;

use machine::SMALL_MILL;
use rig::observe::Summary;

use crate::shop::{Place, project};

const PROGRAM: &str =
    "G18 G21 G90 G8 G97 G94\nS600 M3\nG0 X12 Z8\nG0 X9.5\nG33 Z-12 K2\nG0 X12\nG0 Z60\nM5\nM2\n";
const BAR: &str = "[part]\nstock = \"bar\"\ndiameter_mm = 20\nlength_mm = 40\n";

fn contact_deg(place: &Place, folder: &str) -> f64 {
    let summary = Summary::read(&place.at(folder).join("summary.json")).expect("a summary");
    summary.passes.iter().map(|pass| pass.tool.contact_deg).fold(0.0, f64::max)
}

#[test]
fn a_file_beside_the_program_is_kept_and_used_again() {
    let place = Place::new();
    place.write("thread.ngc", PROGRAM);
    let run = |program: &str, out: &str| {
        let answer = place.ask(&["run", program, "--in-process", "--trace", "none", "--out", out]);
        assert_eq!((answer.status, answer.stderr.as_str()), (Some(0), ""), "{}", answer.stdout);
    };
    run("thread.ngc", "without");
    // A bar whose face lies 5 mm behind that of the machine file.
    place.write("thread.toml", format!("{BAR}face_mm = -5\n"));
    run("thread.ngc", "with");
    assert!(contact_deg(&place, "with") < contact_deg(&place, "without") - 800.0);
    fs::remove_file(place.at("thread.toml")).expect("it was there");
    run("with", "again");
    assert_eq!(contact_deg(&place, "again"), contact_deg(&place, "with"));
    assert!(place.at("again/thread.toml").is_file());
}

#[test]
fn what_should_not_happen_to_the_part_is_said_at_its_line() {
    let place = Place::new();
    place.write("thread.ngc", PROGRAM.replace("Z8", "Z-1"));
    place.write("thread.toml", BAR);
    for command in ["check", "run"] {
        let more: &[&str] = if command == "run" { &["--in-process", "--out", "run"] } else { &[] };
        let answer = place.ask(&[&[command, "thread.ngc"], more].concat());
        for (line, code) in [(4, "rapid-in-stock"), (5, "run-in-in-stock")] {
            let place = format!("thread.ngc:{line}:1: warning[{code}]");
            assert!(answer.stderr.contains(&place), "{command}: {}", answer.stderr);
        }
        if command == "run" {
            let folder = place.at("run");
            let summary = Summary::read(&folder.join("summary.json")).expect("a summary");
            let told: Vec<_> =
                summary.program_warnings.iter().map(|one| (one.line, one.code.as_str())).collect();
            assert_eq!(told, [(4, "rapid-in-stock"), (5, "run-in-in-stock")]);
            let page = fs::read_to_string(folder.join("report.html")).expect("a report");
            assert!(page.contains("Careful, line 4: the rapid goes through the stock at "));
            assert!(answer.stdout.contains("checked   thread.ngc:4: rapid-in-stock: "), "{}", answer.stdout);
        }
        // The thread begins where Z has not reached its lead, and is spoilt there.
        let status = if command == "check" { 0 } else { 3 };
        assert_eq!(answer.status, Some(status), "{}{}", answer.stdout, answer.stderr);
    }
}

#[test]
fn a_file_that_cannot_be_understood_is_refused_with_its_name_and_a_remedy() {
    let place = Place::new();
    place.write("thread.ngc", PROGRAM);
    for (text, words) in [
        ("[part]\nstock = \"bar\"\ndiameter_mm = 40\nlenght_mm = 60\n", "unknown field `lenght_mm`"),
        (
            "[part]\nstock = \"tube\"\ndiameter_mm = 40\nlength_mm = 60\n",
            "inner diameter of the stock is missing",
        ),
        ("[prat]\nstock = \"bar\"\n", "there is no [part] in it"),
    ] {
        place.write("thread.toml", text);
        for command in ["check", "run"] {
            let answer = place.ask(&[command, "thread.ngc"]);
            assert_eq!(answer.status, Some(2), "{text}{}", answer.stderr);
            for said in ["thread.toml", words, "help: "] {
                assert!(answer.stderr.contains(said), "{said}: {}", answer.stderr);
            }
        }
    }
    assert!(!place.at("runs").exists(), "nothing was run");
}

/// A block of a mill, in the file beside the program: warned of (in and out again), kept in the summary,
/// drawn.
#[test]
fn the_block_of_a_mill_is_warned_of_and_drawn() {
    let place = Place::new();
    let machine = project().join("examples/machines/small-mill.toml").display().to_string();
    let program = "G17 G21 G90 G94\nG10 L2 P1 X-20 Y-10 Z0\nS3000 M3\nG0 X-10 Y20 Z5\nG0 Z-2\nG1 X60 F1200\nG0 Z5\nG0 X20 Y5\n\
                   G0 Z-1\nG0 Z50\nM5\nM2\n";
    place.write("part.ngc", program.replace("S3000", "T1 M6 S3000"));
    place.write("tools.tbl", "T1 P1 D8\n");
    place.write("part.toml", "[part]\nstock = \"block\"\nfrom_mm = [0, 0, -10]\nto_mm = [50, 40, 0]\n");
    let answer = place.ask(&[
        "run",
        "part.ngc",
        "--machine",
        &machine,
        "--tools",
        "tools.tbl",
        "--in-process",
        "--out",
        "run",
    ]);
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    assert_eq!(answer.stderr.matches("warning[rapid-in-stock]").count(), 2, "{}", answer.stderr);
    assert!(answer.stderr.contains("part.ngc:9"), "{}", answer.stderr);
    let summary = Summary::read(&place.at("run/summary.json")).expect("a summary");
    let block = summary.stock.and_then(|stock| stock.block_mm);
    assert_eq!(block, Some([[-20.0, -10.0, -10.0], [30.0, 30.0, 0.0]]), "X and Y of the machine");
    let page = fs::read_to_string(place.at("run/report.html")).expect("a report");
    assert!(page.contains("The stock is the block that the program describes"));

    place.write("part.toml", BAR);
    let answer = place.ask(&["check", "part.ngc", "--machine", &machine, "--tools", "tools.tbl"]);
    assert_eq!(answer.status, Some(2), "{}", answer.stderr);
    assert!(answer.stderr.contains("a mill cuts a block and nothing else"), "{}", answer.stderr);
}

/// A tool of which nobody said how wide it is: what is left of the block is not known, and that is said once.
#[test]
fn a_tool_without_a_width_is_told_where_the_part_is_lost_sight_of() {
    let place = Place::new();
    place.write("mill.toml", SMALL_MILL);
    let cuts = "G01 Z-2. F100.\nX20.\nG00 Z5.\nT88 M06\nG01 Z-2.\nG00 X0.\nM30\n";
    place.write(
        "part.nc",
        format!(
            "%\nO1000\n(part, block X0 Y0 Z-10 X50 Y40 Z0)\nT77 M06\nS1000 M03\nG00 X10. Y10. Z5.\n{cuts}"
        ),
    );
    let answer = place.ask(&["check", "part.nc", "--machine", "mill.toml"]);
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    assert_eq!(answer.stderr.matches("[stock-unknown]").count(), 1, "{}", answer.stderr);
    assert!(answer.stderr.contains("part.nc:7:1: warning[stock-unknown]: nobody said how wide tool 77 is"));
    place.write("tool.tbl", "T77 P77 D6\nT88 P88 D6\n");
    let answer = place.ask(&["check", "part.nc", "--machine", "mill.toml", "--tools", "tool.tbl"]);
    assert!(answer.stderr.contains("part.nc:12:1: warning[rapid-in-stock]"), "{}", answer.stderr);
}
