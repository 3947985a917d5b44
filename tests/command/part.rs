//! The part of a program: in a file beside it, in the run folder, in what `check` and `run` say.

use std::fs;

use rig::observe::Summary;

use crate::shop::Place;

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
        let answer = place.ask(&[command, "thread.ngc"]);
        for (line, code) in [(4, "rapid-in-stock"), (5, "run-in-in-stock")] {
            let place = format!("thread.ngc:{line}:1: warning[{code}]");
            assert!(answer.stderr.contains(&place), "{command}: {}", answer.stderr);
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
