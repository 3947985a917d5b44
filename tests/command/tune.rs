//! `pitchlock tune`: what it proposes holds in a trial pass, what it writes is the machine file with a few
//! keys changed, and what its documentation shows is what it prints.

use std::fs;

use crate::shop::{Place, project};
use machine::{Machine, SMALL_LATHE};
use protocol::Axis;
use serde_json::Value;

/// What moves, by torque of which the motor gives 5 % more than its drive believes.
const MASS_KG: f64 = 2005.0 / 1.05;

fn found(place: &Place, arguments: &[&str]) -> Value {
    let answer = place.ask(&[&["tune", "--json"], arguments].concat());
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    serde_json::from_str(&answer.stdout).expect("one document and nothing else")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("a number, not {value}"))
}

#[test]
fn the_trial_pass_is_within_its_goals_afterwards() {
    let document = found(&Place::new(), &[]);
    let rows = document["trial"].as_array().expect("rows");
    let tuned: Vec<_> = rows.iter().filter(|row| row["axis"] == "x" && row["tuned"] == true).collect();
    assert_eq!(tuned.len(), 5);
    for row in tuned {
        let approach = number(&row["approach_max_um"]).max(-number(&row["approach_min_um"]));
        assert!(approach <= 1.5, "{row}");
        assert!(number(&row["end_um"]).abs() <= 0.3, "{row}");
        assert!(number(&row["thread_max_abs_um"]) <= 0.1, "{row}");
    }
}

#[test]
fn the_document_has_every_axis_with_its_changes() {
    let document = found(&Place::new(), &["--seed", "3", "--rpm", "600"]);
    assert_eq!((&document["version"], &document["seed"]), (&1.into(), &3.into()));
    let axes = document["axes"].as_array().expect("axes");
    assert_eq!(axes.iter().map(|axis| axis["axis"].as_str()).collect::<Vec<_>>(), [Some("x"), Some("z")]);
    for axis in axes {
        let changes = axis["changes"].as_array().expect("changes");
        let mass =
            changes.iter().find(|change| change["key"].as_str().is_some_and(|key| key.ends_with("mass_kg")));
        let mass = mass.expect("a mass");
        assert!((number(&mass["after"]) / MASS_KG - 1.0).abs() < 0.005, "{mass}");
        assert_eq!(number(&mass["before"]), 1905.0);
        let waves: Vec<_> = changes
            .iter()
            .filter(|change| change["key"].as_str().is_some_and(|key| key.ends_with("cogging, 24 a turn")))
            .collect();
        let degrees = if axis["axis"] == "x" { 150.0 } else { 40.0 };
        assert_eq!(waves.len(), 2);
        assert!((number(&waves[0]["after"]) - 0.05 / 1.05).abs() < 0.001, "{waves:?}");
        assert!((number(&waves[1]["after"]) - degrees).abs() < 1.0, "{waves:?}");
        let mode = &axis["mode"];
        let (time_s, angle) = (number(&mode["approach_s"]), number(&mode["approach_delta_c_deg"]));
        assert!((angle / (6.0 * 600.0 * 1.2 * time_s) - 1.0).abs() < 1e-9, "{mode}");
        // The bound of M8a at that time is the residual that was asked for.
        let left = motion::Stroke::new(5.0, time_s).residual_bound(number(&mode["hz"]["value"]));
        assert!((1e3 * left / 0.2 - 1.0).abs() < 1e-6, "{left}");
        assert!(number(&axis["margins"]["after"]["velocity"]["phase_margin_deg"]) >= 34.5, "{axis}");
        assert!(number(&axis["margins"]["after"]["position"]["gain_margin"]) >= 2.9, "{axis}");
    }
}

#[test]
fn the_machine_file_keeps_its_comments() {
    let place = Place::new();
    let before =
        SMALL_LATHE.replace("# the examples have the face of the part at Z 0", "# the chuck is at −400");
    place.write("mine.toml", &before);
    let answer = place.ask(&["tune", "--machine", "mine.toml", "--axis", "z", "-o", "tuned.toml"]);
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    assert!(answer.stdout.ends_with("\nwritten tuned.toml\n"), "{}", answer.stdout);
    assert_eq!(fs::read_to_string(place.at("mine.toml")).expect("it is there"), before);
    let after = fs::read_to_string(place.at("tuned.toml")).expect("it is written");
    let changed = before.lines().zip(after.lines()).filter(|(before, after)| before != after).count();
    assert!((4..=11).contains(&changed), "{changed} lines differ");
    assert_eq!(before.lines().count(), after.lines().count());
    let comments =
        |text: &str| text.lines().filter_map(|line| Some(line.split_once('#')?.1.to_owned())).collect();
    let [comments_before, comments_after]: [Vec<String>; 2] = [comments(&before), comments(&after)];
    assert_eq!(comments_before, comments_after);
    let [old, new] = [&before, &after].map(|text| Machine::from_toml(text).expect("a machine file"));
    assert_eq!(old.axis[&Axis::X], new.axis[&Axis::X]);
    assert_eq!(old.plant, new.plant);
    assert!((new.axis[&Axis::Z].mass_kg / MASS_KG - 1.0).abs() < 0.005);
}

/// A machine file that says nothing of weight, mode and cogging gets all three.
#[test]
fn keys_that_are_absent_are_written() {
    let place = Place::new();
    let is_belief = |line: &&str| {
        ["gravity_n = -700", "mode_hz = 95", "cogging = "].iter().any(|key| line.starts_with(key))
    };
    let bare: Vec<_> = SMALL_LATHE.lines().filter(|line| !is_belief(line)).collect();
    place.write("bare.toml", bare.join("\n"));
    let answer = place.ask(&["tune", "--machine", "bare.toml", "-o", "tuned.toml"]);
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    let tuned = fs::read_to_string(place.at("tuned.toml")).expect("it is written");
    let machine = Machine::from_toml(&tuned).expect("a machine file");
    for (axis, gravity_n) in [(Axis::X, -760.0 / 1.05), (Axis::Z, 0.0)] {
        let found = &machine.axis[&axis];
        assert!((found.gravity_n - gravity_n).abs() < 5.0, "{axis}: {} N", found.gravity_n);
        assert!(found.mode_hz.is_some_and(|hz| (hz - 100.0).abs() < 1.0), "{axis}: {:?}", found.mode_hz);
        assert!(matches!(found.cogging[..], [[24.0, ..]]), "{axis}: {:?}", found.cogging);
    }
}

#[test]
fn nothing_is_written_unless_asked() {
    let place = Place::new();
    let answer = place.ask(&["tune", "--axis", "x"]);
    assert!(
        answer
            .stdout
            .ends_with("nothing is written; -o OUT.toml writes the machine file with these values\n")
    );
    assert_eq!(fs::read_dir(place.path()).expect("it is a folder").count(), 0);
}

#[test]
fn the_same_seed_finds_the_same() {
    let place = Place::new();
    assert_eq!(
        found(&place, &["--axis", "x", "--seed", "5"]),
        found(&place, &["--axis", "x", "--seed", "5"])
    );
}

#[test]
fn the_page_has_everything_in_it() {
    let place = Place::new();
    let answer = place.ask(&["tune", "--axis", "x", "--page", "x.html"]);
    assert!(answer.stdout.ends_with("page    x.html\n"), "{}", answer.stdout);
    let page = fs::read_to_string(place.at("x.html")).expect("it is written");
    assert_eq!(page.matches("<figure>").count(), 5);
    for needed in
        ["What was done", "How to repeat it", "phase margin", "friction against speed", "Plotly.react"]
    {
        assert!(page.contains(needed), "{needed} is missing");
    }
}

#[test]
fn a_mill_is_tuned_without_a_trial_pass() {
    let mill = project().join("examples/machines/small-mill.toml").display().to_string();
    let answer = Place::new().ask(&["tune", "--machine", &mill, "--axis", "y"]);
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    assert!(answer.stdout.contains("no trial pass: it is a threading pass"), "{}", answer.stdout);
    assert!(!answer.stdout.contains("1/min"), "a mill approaches in no spindle angle: {}", answer.stdout);
}

#[test]
fn what_cannot_be_done_is_refused() {
    let place = Place::new();
    place.write("narrow.toml", SMALL_LATHE.replace("travel_mm = [-5.0, 120.0]", "travel_mm = [57.0, 63.0]"));
    place.write("file", "in the way");
    let cases: [(i32, &[&str], &[&str]); 8] = [
        (2, &["tune", "--axis", "y"], &["--axis y", "built-in machine file has x, z"]),
        (2, &["tune", "--axis", "spindle"], &["--axis spindle"]),
        (2, &["tune", "--phase-margin", "95"], &["--phase-margin 95", "between 10 and 80"]),
        (2, &["tune", "--residual", "nan"], &["--residual NaN", "between"]),
        (2, &["tune", "--rpm", "0"], &["--rpm 0", "between"]),
        (2, &["tune", "--machine", "none.toml"], &["none.toml"]),
        (2, &["tune", "--axis", "x", "-o", "file/below"], &["file/below"]),
        (1, &["tune", "--machine", "narrow.toml"], &["X has 3.0 mm of travel", "move it towards the middle"]),
    ];
    for (status, arguments, words) in cases {
        let answer = place.ask(arguments);
        assert_eq!(answer.status, Some(status), "{arguments:?}: {}", answer.stderr);
        assert!(words.iter().all(|word| answer.stderr.contains(word)), "{arguments:?}: {}", answer.stderr);
        assert!(answer.stdout.is_empty() && !answer.stderr.contains("panicked"), "{arguments:?}");
    }
}

/// The block below the command in `docs/tuning.md` is what the command prints.
#[test]
fn the_documentation_shows_what_is_printed() {
    let page = fs::read_to_string(project().join("docs/tuning.md")).expect("it is there");
    let answer = Place::new().ask(&["tune", "--axis", "x"]);
    let shown = format!("```text\n$ pitchlock tune --axis x\n{}```\n", answer.stdout);
    assert!(page.contains(&shown), "docs/tuning.md should have:\n{shown}");
}
