//! Reference runs as commands tell of them: before a run, behind it, in its journal; a run that was broken
//! off.

use rig::observe::Summary;
use serde_json::Value;

use crate::shop::{Place, project};

/// The lathe of the examples that has them.
fn lathe() -> String {
    project().join("examples/machines/referenced-lathe.toml").display().to_string()
}

const PART: &str = "G21 G90 G8 G18\nG0 X20 Z10\nG1 X19 F600\nG0 X20\nM2\n";

#[test]
fn a_check_and_a_line_to_begin_at_say_which_runs_come_first() {
    let place = Place::new();
    let (program, lathe) = (place.write("part.ngc", PART).display().to_string(), lathe());
    let check = place.ask(&["check", &program, "--machine", &lathe]);
    let [x, z] = ["reference X by switch and index at 110 mm", "reference Z by switch and index at 190 mm"];
    let at = |text: &str, words: &str| text.find(words).unwrap_or_else(|| panic!("{words}: {text}"));
    assert!(at(&check.stdout, x) < at(&check.stdout, z), "in their order: {}", check.stdout);
    let json = place.ask(&["check", &program, "--machine", &lathe, "--json"]);
    let json: Value = serde_json::from_str(&json.stdout).expect("a document");
    let axes: Vec<_> =
        json["references"].as_array().expect("a list").iter().map(|one| &one["axis"]).collect();
    assert_eq!(axes, ["x", "z"]);
    let plain = place.ask(&["check", &program, "--json"]);
    assert!(!plain.stdout.contains("references") && !plain.stdout.is_empty(), "{}", plain.stdout);
    let begins = ["run", &program, "--machine", &lathe, "--from", "3", "--dry-run"];
    let dry = place.ask(&begins);
    assert_eq!(dry.status, Some(0), "{}", dry.stderr);
    assert!(at(&dry.stdout, x) < at(&dry.stdout, "way       to X"), "{}", dry.stdout);
    let dry = place.ask(&[&begins[..], &["--json"]].concat());
    let dry: Value = serde_json::from_str(&dry.stdout).expect("a document");
    assert_eq!(
        (&dry["references"][1]["axis"], &dry["references"][1]["position_mm"]),
        (&"z".into(), &190.0.into())
    );
}

#[test]
fn what_each_run_found_is_in_the_summary_the_last_words_and_the_report() {
    let place = Place::new();
    let (program, lathe) = (place.write("part.ngc", PART).display().to_string(), lathe());
    let ran = place.ask(&["run", &program, "--machine", &lathe, "--out", "run", "--trace", "none"]);
    assert_eq!(ran.status, Some(0), "{}", ran.stderr);
    let summary = Summary::read(&place.at("run/summary.json")).expect("a summary");
    let [x, z] = &summary.references[..] else { panic!("{:?}", summary.references) };
    // It was switched on so far beside where it believed to be: to a count.
    assert!((x.shift_mm + 0.737).abs() < 2e-3 && (z.shift_mm - 12.4).abs() < 2e-3, "{x:?}, {z:?}");
    assert_eq!((x.position_mm, z.position_mm), (110.0, 190.0));
    assert!(x.cycle < z.cycle && z.cycle < summary.cycles, "{x:?}, {z:?}");
    assert!(x.cycles > 2000 && z.cycles > 2000 && z.cycle - z.cycles >= x.cycle, "{x:?}, {z:?}");
    for (axis, shift) in [("X", "-0.73"), ("Z", "+12.")] {
        let told = format!("reference {axis} by switch and index at 1");
        let line = ran.stdout.lines().find(|line| line.starts_with(&told));
        assert!(line.is_some_and(|line| line.contains(&format!("shifted by {shift}"))), "{}", ran.stdout);
    }
    let page = std::fs::read_to_string(place.at("run/report.html")).expect("a report");
    assert!(page.contains("Reference runs") && page.contains("-0.73"), "it has a table of them");
    let journal = |out: &str| {
        let told = place.ask(&["journal", out, "--json"]);
        serde_json::from_str::<Value>(&told.stdout).expect("a document")["unreferenced"].clone()
    };
    assert_eq!(journal("run"), Value::Array(Vec::new()));
    // Behind a dead switch nobody knows where X is, nor Z behind it.
    let dead = std::fs::read_to_string(&lathe).expect("a lathe");
    let dead = dead.replacen("[plant.axis.x]", "[plant.axis.x]\nreference_fault = \"switch-open\"", 1);
    let dead = place.write("dead.toml", dead).display().to_string();
    let ran = place.ask(&["run", &program, "--machine", &dead, "--out", "dead", "--trace", "none"]);
    assert_eq!(ran.status, Some(1), "{}", ran.stderr);
    assert_eq!(journal("dead"), serde_json::json!(["x", "z"]));
    let told = place.ask(&["journal", "dead"]).stdout;
    assert!(told.contains("reference not known of X, Z: its run has not been made"), "{told}");
    let summary = Summary::read(&place.at("dead/summary.json")).expect("a summary");
    assert!(
        summary.references.is_empty() && summary.faults[0].code == "switch-not-found",
        "{:?}",
        summary.faults
    );
}

#[test]
fn a_run_that_was_broken_off_is_not_gone_on_with_and_a_line_to_begin_at_is_named() {
    let place = Place::new();
    let (program, lathe) = (place.write("part.ngc", PART).display().to_string(), lathe());
    let lost = place.write("lost.toml", "[[event]]\nat = { cycle = 12000 }\npower_lost = true\n");
    let lost = lost.display().to_string();
    let ran = ["run", &program, "--machine", &lathe, "--out", "run", "--trace", "none", "--scenario", &lost];
    assert_eq!(place.ask(&ran).status, Some(1));
    let before = std::fs::read(place.at("run/summary.json")).expect("a summary");
    for more in [&[][..], &["--dry-run"]] {
        let told = place.ask(&[&["run", "run", "--resume", "--out", "on"], more].concat());
        let why =
            "X has a reference run ([axis.x.reference]), and nobody knows where it stands behind a break";
        assert!(told.status == Some(2) && told.stderr.contains(why), "{}", told.stderr);
        assert!(told.stderr.contains("--from LINE") && told.stdout.is_empty(), "{}", told.stderr);
        assert!(!place.at("on").exists(), "nothing is written");
    }
    assert_eq!(std::fs::read(place.at("run/summary.json")).expect("it is there"), before);
    let begun = ["run", &program, "--machine", &lathe, "--from", "3", "--out", "on", "--trace", "none"];
    let begun = place.ask(&begun);
    assert_eq!(begun.status, Some(0), "{}", begun.stderr);
    assert_eq!(Summary::read(&place.at("on/summary.json")).expect("a summary").references.len(), 2);
}
