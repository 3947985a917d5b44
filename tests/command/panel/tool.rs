//! A tool that is put in by hand: the machine waits until somebody says which one is in.

use rig::observe::Outcome;
use serde_json::{Value, json};

use super::{
    by_hand::{by_hand, ended, is_ready, refused},
    client::Panel,
    watched::{ended as run_is_over, is_repeated},
};
use crate::shop::{Place, project, until};

/// A lathe whose tools somebody puts in.
fn lathe(place: &Place) -> String {
    let lathe = project().join("examples/machines/plain-lathe.toml");
    let lathe = std::fs::read_to_string(lathe).expect("a lathe");
    let lathe = lathe.replacen("[machine]\n", "[machine]\ntool_change = \"by-hand\"\n", 1);
    let lathe = lathe + "\n[tools.1]\nname = \"turning tool\"\n[tools.3]\nname = \"threading tool\"\n";
    place.write("lathe.toml", lathe).display().to_string()
}

fn asks_for(panel: &Panel, number: u32) {
    until("a tool is wanted", || {
        let state = panel.state();
        state["mode"] == "tool-change" && state["state"] == "tool-change" && state["tool"] == number
    });
}

/// In a program: start does not go on, another tool does not, a hold does not take its place; it is a cycle
/// start, and the session is repeated.
#[test]
fn a_tool_change_waits_until_the_right_tool_is_said_to_be_in() {
    let place = Place::new();
    let lathe = lathe(&place);
    let text = "G21 G90 G8\nT1 M6\nM3 S300\nG0 X20\nT3 M6\nG0 X30\nM2\n";
    let program = place.write("tools.ngc", text).display().to_string();
    let run = ["run", &program, "--panel", "--machine", &lathe, "--out", "run", "--json", "--pace", "20"];
    let panel = Panel::start(&place, &[&run[..], &["--trace", "none"]].concat());
    panel.press("take-seat");
    asks_for(&panel, 1);
    panel.turn("tool-change", 1);
    asks_for(&panel, 3);
    let state = panel.state();
    assert_eq!(state["words"], "put in T3, threading tool, and say that it is in");
    assert!(state["spindle"]["rpm"].as_f64().is_some_and(|rpm| rpm.abs() < 5.0), "{}", state["spindle"]);
    assert_eq!(refused(&panel, "start", Value::Null).0, "not-now");
    let (code, why) = refused(&panel, "tool-change", json!(1));
    assert!(code == "not-now" && why.contains("waits for T3"), "{code}: {why}");
    panel.press("hold");
    until("it is held as well", || panel.state()["held"] == true);
    assert_eq!(panel.state()["mode"], "tool-change");
    assert_eq!(refused(&panel, "start", Value::Null).0, "not-now", "it would say that the tool is in");
    panel.turn("tool-change", 3);
    let (status, summary) = run_is_over(panel);
    assert_eq!((status, summary.outcome, summary.pauses.len()), (Some(0), Outcome::Completed, 2));
    is_repeated(&place, "run", &summary);
}

/// By hand a block asks likewise, and may be given up.
#[test]
fn a_tool_by_hand_is_changed_by_a_block() {
    let place = Place::new();
    let lathe = lathe(&place);
    let panel = by_hand(&place, &["--machine", &lathe, "--pace", "20", "--trace", "none"]);
    assert_eq!(refused(&panel, "tool-change", json!(3)).0, "not-now", "none is waited for");
    panel.turn("mdi", "T3 M6");
    asks_for(&panel, 3);
    for (word, value) in [("mdi", json!("G0 X20")), ("spindle", json!(300)), ("start", Value::Null)] {
        assert_eq!(refused(&panel, word, value).0, "not-now", "{word}");
    }
    panel.turn("tool-change", 3);
    is_ready(&panel);
    panel.turn("mdi", "T1 M6");
    asks_for(&panel, 1);
    let summary = ended(&place, panel);
    assert_eq!((summary.outcome, summary.faults.len()), (Outcome::Stopped, 0));
    is_repeated(&place, "session", &summary);
}
