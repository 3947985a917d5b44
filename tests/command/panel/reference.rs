//! A machine whose axes are to be referenced: what is refused before, Home, and what goes on behind it.

use rig::observe::{Outcome, Summary};
use serde_json::json;

use super::{
    by_hand::{by_hand, does, ended, is_ready, refused, stands},
    client::Panel,
    watched::is_repeated,
};
use crate::shop::{Place, project, signal, until};

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
    let way_ends = || {
        let state = panel.state();
        let end = state["trail"]["points"].as_array().and_then(|all| all.last()).cloned().unwrap_or_default();
        let apart = |axis: usize| {
            let [at, end] =
                [&state["axes"][axis]["measured_mm"], &end[0][axis]].map(serde_json::Value::as_f64);
            at.zip(end).map_or(f64::INFINITY, |(at, end)| (at - end).abs())
        };
        apart(0).max(apart(1))
    };
    until("its way is drawn to where it is measured", || way_ends() < 0.05);
    assert_eq!(panel.state()["done"], serde_json::Value::Null);
    does(&panel, "home", "x");
    assert_eq!((referenced(&panel), stands(&panel)[0]), ([true, false], 60.0));
    let (code, why) = refused(&panel, "mdi", json!("G0 X20"));
    assert!(code == "not-referenced" && why.starts_with("Z is not referenced"), "{code}: {why}");
    let (code, why) = refused(&panel, "home", json!("X"));
    assert!(code == "not-referenced" && why.starts_with("Z is not referenced"), "{code}: {why}");
    let (code, why) = refused(&panel, "home", json!("Q"));
    assert_eq!((code.as_str(), why.as_str()), ("bad-block", "this machine has no axis Q: X, Z"));
    let (code, why) = refused(&panel, "jog", json!({ "axis": "Z", "mm_min": 100_000, "way": "-" }));
    assert!(code == "bad-block" && why.contains("100000 is no feed of this jog"), "{code}: {why}");
    // It may be held on its way.
    panel.turn("home", "Z");
    let mut state = json!(null);
    until("it goes", || {
        state = panel.state();
        state["axes"][1]["speed_mm_s"].as_f64().is_some_and(|speed| speed > 1.0)
    });
    let words = state["words"].as_str().unwrap_or_default();
    assert!(words.starts_with("reference run of Z: ") && state["left_s"].is_null(), "{state}");
    assert_eq!(state["axes"][1]["to_go_mm"].is_null(), !words.ends_with("goes home"), "{state}");
    panel.press("hold");
    until("it is held", || panel.state()["mode"] == "held");
    until("it says so", || panel.state()["words"] == "held in the reference run of Z; start goes on with it");
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
    let alone = ["run", "session/by-hand.mc", "--machine", &lathe];
    let answer = place.ask(&alone);
    let remedy = "run the folder instead: pitchlock run session";
    assert!(answer.status == Some(2) && answer.stderr.contains(remedy), "{}", answer.stderr);
}

/// What moves nothing and does the same wherever the axes are is done before; the way to the switch ends
/// there.
#[test]
fn before_its_reference_runs_a_machine_does_what_moves_nothing_and_jogs_up_to_its_switch() {
    let place = Place::new();
    let panel = by_hand(&place, &["--machine", &lathe(&place), "--pace", "20", "--trace", "none"]);
    for block in ["G97 S300 M3", "M8", "G55", "G4 P0.1"] {
        does(&panel, "mdi", block);
    }
    until("it turns", || panel.state()["spindle"]["rpm"].as_f64().is_some_and(|rpm| rpm > 290.0));
    let state = panel.state();
    assert_eq!(state["coolant"], "flood");
    assert!(state["by_hand"]["in_force"].as_str().is_some_and(|words| words.contains("G55")), "{state}");
    does(&panel, "spindle", json!(0));
    for block in ["G0 X20", "G91 G1 Z-1 F100", "G10 L20 P1 X0", "G92 X3", "G28"] {
        let (code, why) = refused(&panel, "mdi", json!(block));
        assert!(
            code == "not-referenced" && why.contains("X and Z are not referenced"),
            "{block}: {code}: {why}"
        );
    }
    for block in ["#1=#5420", "#<a>=[2*#<_z>]", "#2=#5021", "(debug, X is at #5420)", "#3=#<_abs_x>"] {
        let (code, why) = refused(&panel, "mdi", json!(block));
        let says =
            why.starts_with("this reads where the axes are, and nobody knows that: X and Z are not ref");
        assert!(code == "not-referenced" && says, "{block}: {code}: {why}");
    }
    let by_x = "G96 turns the spindle by where X is, and nobody knows that: press Home of X first, or give";
    let (code, why) = refused(&panel, "mdi", json!("G96 S150 M3"));
    assert!(code == "not-referenced" && why.starts_with(by_x), "{code}: {why}");
    assert_eq!(panel.state()["by_hand"]["in_force"], state["by_hand"]["in_force"], "nothing of them is left");
    does(&panel, "mdi", "#1=20");
    // Each press goes some way, and the last of them ends at the switch.
    let towards = json!({ "axis": "X", "mm_min": 1200, "way": "+" });
    let at_the_switch = || {
        let answer = panel.ask(&json!({ "id": 1, "do": "jog", "as": "test", "value": towards }));
        is_ready(&panel);
        answer["why"].as_str().map(str::to_owned)
    };
    let why = (0..100).find_map(|_| at_the_switch()).expect("it comes to its switch");
    assert_eq!(why, "X stands on its switch: jog the other way, or press Home");
    // The switch is at 72.5, where X believes to be 2.25 mm lower.
    let [x, _] = stands(&panel);
    assert!((70.2..72.0).contains(&x), "{x}");
    does(&panel, "jog", json!({ "axis": "X", "mm_min": 600, "way": "-" }));
    assert!(stands(&panel)[0] < x);
    does(&panel, "home", "X");
    does(&panel, "mdi", "G96 S150 M3");
    assert_eq!(refused(&panel, "mdi", json!("#1=#5420")).0, "not-referenced", "Z is still lost");
    does(&panel, "mdi", "M5");
    does(&panel, "home", "Z");
    does(&panel, "mdi", "#2=#5420");
    does(&panel, "mdi", "G0 X#1");
    let summary = ended(&place, panel);
    assert_eq!((summary.outcome, summary.references.len()), (Outcome::Stopped, 2));
    is_repeated(&place, "session", &summary);
}

/// However fast the machine is, the panel has its last state: the fault, its cycle, and that nobody knows any
/// more where the axes are.
#[test]
fn a_fault_of_a_run_reaches_the_panel_at_any_pace() {
    let place = Place::new();
    let sound = std::fs::read_to_string(lathe(&place)).expect("it was written");
    let dead = sound.replacen("[plant.axis.z]", "[plant.axis.z]\nreference_fault = \"switch-open\"", 1);
    let dead = place.write("dead.toml", dead).display().to_string();
    for pace in ["30", "200", "1000", "max"] {
        let panel = by_hand(&place, &["--machine", &dead, "--pace", pace, "--trace", "none"]);
        does(&panel, "home", "X");
        assert_eq!(referenced(&panel), [true, false]);
        panel.turn("feed-override", 60.0);
        panel.turn("home", "Z");
        until("it is off", || panel.state()["mode"] == "off");
        let state = panel.state();
        let summary = Summary::read(&place.at("session/summary.json")).expect("a summary");
        assert_eq!(state["faults"][0]["code"], "switch-not-found", "pace {pace}: {state}");
        assert_eq!(state["faults"].as_array().map(Vec::len), Some(summary.faults.len()), "pace {pace}");
        assert_eq!(state["cycle"].as_u64(), Some(summary.cycles - 1), "pace {pace}");
        assert_eq!(state["knobs"]["feed_pct"], 100.0, "pace {pace}: the next run begins so");
        assert_eq!(
            (referenced(&panel), &state["outcome"]),
            ([false, false], &json!("faulted")),
            "pace {pace}"
        );
        signal(panel.launcher.id(), "INT");
        assert_eq!(panel.ends().status, Some(0));
        std::fs::remove_dir_all(place.at("session")).expect("it left its folder");
    }
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
        (
            "position_mm = 75",
            "position_mm = -4.9",
            "axis.x.reference.search_mm_s = 40: an axis that backs off stands before its switch",
        ),
        (
            "position_mm = 75",
            "position_deg = 75",
            "axis.x.reference.position_deg = 75: X is measured in mm: write position_mm",
        ),
    ] {
        refused(&lathe.replacen(from, to, 1), why);
    }
    let [index, switch] = [("switch", "index_mm = 75"), ("index", "switch_mm = 75")].map(|(method, key)| {
        let lathe = lathe.replacen("switch-and-index", method, 1).replacen("home_off_mm = 2.25", key, 1);
        assert!(lathe.contains(key));
        lathe
    });
    let why = "plant.axis.x.index_mm: the axis is not referenced by any index: choose a method";
    refused(&index, why);
    refused(&switch, "plant.axis.x.switch_mm: the axis is not referenced by any switch: choose a method");
    let dead = |fault: &str| format!("reference_fault = \"{fault}\"");
    let dead =
        lathe.replacen("switch-and-index", "switch", 1).replacen("home_off_mm = 2.25", &dead("no-index"), 1);
    refused(&dead, "plant.axis.x.reference_fault: the axis is not referenced by any index");
    let why = "from home_mm the next index may be a whole turn away";
    refused(&near_its_end.replacen("switch-and-index", "index", 1), why);
}
