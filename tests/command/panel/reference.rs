//! A machine whose axes are to be referenced: what is refused before, Home, and what goes on behind it.

use rig::observe::{Outcome, Summary};
use serde_json::json;

use super::{
    by_hand::{by_hand, does, ended, is_ready, refused, stands},
    client::Panel,
    watched::is_repeated,
};
use crate::shop::{Place, project, until};

/// A lathe with a switch at each axis and an index behind it, which stands elsewhere than it believes.
fn lathe(place: &Place) -> String {
    let lathe = project().join("examples/machines/plain-lathe.toml");
    let lathe = std::fs::read_to_string(lathe).expect("a lathe");
    let reference = |axis: &str, mm: f64| {
        let method = "method = \"switch-and-index\"\nsearch_mm_s = 40\nlatch_mm_s = 2";
        format!("\n[axis.{axis}.reference]\n{method}\nposition_mm = {mm}\n\n")
    };
    let lathe = lathe
        .replacen("[axis.z]", &format!("{}[axis.z]", reference("x", 75.0)), 1)
        .replacen("[spindle]", &format!("{}[spindle]", reference("z", 120.0)), 1)
        .replacen("[plant.axis.x]", "[plant.axis.x]\nhome_off_mm = 2.25", 1)
        .replacen("[plant.axis.z]", "[plant.axis.z]\nhome_off_mm = -3.5", 1);
    place.write("lathe.toml", lathe).display().to_string()
}

/// Which axes are referenced.
fn referenced(panel: &Panel) -> [bool; 2] {
    let state = panel.state();
    [0, 1].map(|axis: usize| state["axes"][axis]["referenced"] == true)
}

#[test]
fn before_its_reference_runs_a_machine_only_jogs_and_a_session_with_them_is_repeated() {
    let place = Place::new();
    let lathe = lathe(&place);
    let panel = by_hand(&place, &["--machine", &lathe, "--pace", "20", "--trace", "none"]);
    assert_eq!(referenced(&panel), [false, false]);
    let before = stands(&panel);
    for (word, value) in [
        ("mdi", json!("G0 X20")),
        ("jog", json!({ "axis": "Z", "mm_min": 600, "step_mm": -1 })),
        ("touch-off", json!({ "axis": "X", "value": 20 })),
    ] {
        let (code, why) = refused(&panel, word, value);
        assert!(code == "not-referenced" && why.contains("X and Z are not referenced"), "{code}: {why}");
    }
    assert_eq!(stands(&panel), before);
    does(&panel, "jog", json!({ "axis": "Z", "mm_min": 600, "way": "-" }));
    assert!(stands(&panel)[1] < before[1], "it jogs");
    does(&panel, "home", "x");
    assert_eq!((referenced(&panel), stands(&panel)[0]), ([true, false], 60.0));
    let (code, why) = refused(&panel, "mdi", json!("G0 X20"));
    assert!(code == "not-referenced" && why.starts_with("Z is not referenced"), "{code}: {why}");
    let (code, why) = refused(&panel, "home", json!("X"));
    assert!(code == "not-referenced" && why.starts_with("Z is not referenced"), "{code}: {why}");
    // It may be held on its way.
    panel.turn("home", "Z");
    until("it goes", || panel.state()["axes"][1]["speed_mm_s"].as_f64().is_some_and(|speed| speed > 1.0));
    panel.press("hold");
    until("it is held", || panel.state()["mode"] == "held");
    assert_eq!(refused(&panel, "home", json!("X")).0, "not-now");
    panel.press("start");
    is_ready(&panel);
    assert_eq!((referenced(&panel), stands(&panel)[1]), ([true, true], 100.0));
    does(&panel, "mdi", "G21 G90 G8 G0 X20 Z10");
    does(&panel, "home", "Z");
    assert_eq!(stands(&panel)[1], 100.0, "from now on it just goes there");
    let summary = ended(&place, panel);
    assert_eq!((summary.outcome, summary.faults.len()), (Outcome::Stopped, 0));
    is_repeated(&place, "session", &summary);
}

/// A program begins with them, of one process and of many; a run that broke off is not gone on with.
#[test]
fn a_program_is_run_behind_its_reference_runs() {
    let place = Place::new();
    let lathe = lathe(&place);
    let text = "G21 G90 G8 G18\nG0 X20 Z10\nM2\n";
    let program = place.write("part.ngc", text).display().to_string();
    let run = |out: &str, more: &[&str]| {
        let args = ["run", &program, "--machine", &lathe, "--out", out, "--trace", "none", "--json"];
        let answer = place.ask(&[&args[..], more].concat());
        assert_eq!(answer.status, Some(0), "{}", answer.stderr);
        serde_json::from_str::<Summary>(&answer.stdout).expect("a summary")
    };
    let (many, one) = (run("many", &[]), run("one", &["--in-process"]));
    assert_eq!((many.outcome, &many.trace_hash), (Outcome::Completed, &one.trace_hash));
    assert!(many.cycles > 8000, "four ways of each axis: {} cycles", many.cycles);
    assert!(many.moves.contour_max_um < 100.0, "it is where it is led: {} µm", many.moves.contour_max_um);
    let again = place.ask(&["replay", "many"]);
    assert_eq!(again.status, Some(0), "{}", again.stderr);
}

#[test]
fn a_reference_that_cannot_be_is_refused_by_its_key() {
    let place = Place::new();
    let lathe = std::fs::read_to_string(lathe(&place)).expect("it was written");
    let refused = |lathe: &str, why: &str| {
        let file = place.write("wrong.toml", lathe).display().to_string();
        let program = place.write("part.ngc", "M2\n").display().to_string();
        let answer = place.ask(&["run", &program, "--machine", &file, "--out", "wrong"]);
        assert!(answer.status == Some(2) && answer.stderr.contains(why), "{why}: {}", answer.stderr);
    };
    let near_its_end = lathe.replacen("home_mm = 60", "home_mm = 119", 1);
    assert_ne!(near_its_end, lathe);
    for (from, to, why) in [
        ("latch_mm_s = 2", "latch_mm_s = 0", "axis.x.reference.latch_mm_s = 0: must lie between"),
        ("search_mm_s = 40", "search_mm_s = 0", "axis.x.reference.search_mm_s = 0: must not be 0"),
        (
            "position_mm = 75",
            "position_mm = 119.9",
            "axis.x.reference.search_mm_s = 40: an axis that searches",
        ),
        ("position_mm = 75", "position_mm = 500", "axis.x.reference.position_mm = 500: must lie between"),
        ("switch-and-index", "feeling", "unknown variant"),
        ("home_off_mm = 2.25", "switch_hysteresis_mm = 0.001", "plant.axis.x.switch_hysteresis_mm = 0.001"),
    ] {
        refused(&lathe.replacen(from, to, 1), why);
    }
    let why = "from home_mm the next index may be a whole turn away";
    refused(&near_its_end.replacen("switch-and-index", "index", 1), why);
}
