//! A recorded run that is played: every cycle of it as it was, at any speed, and no key acts.

use std::fs;

use serde_json::{Value, json};

use super::{by_hand::refused, client::Panel};
use crate::shop::{Place, signal, until};

/// Two passes of a thread.
pub(super) const THREAD: &str = "\
G18 G21 G90 G7 G94 G97
M3 S600
G0 X22 Z8
G76 P2 Z-6 I-2 J1.6 K2.4 R1 Q29.5
G0 X40
M2
";

/// A run with the trace of every cycle, and the panel that plays it.
pub(super) fn plays(place: &Place, more: &[&str]) -> Panel {
    fs::write(place.at("thread.ngc"), THREAD).expect("room");
    let made =
        place.ask(&["run", "thread.ngc", "--in-process", "--trace", "full-csv", "--out", "made", "--quiet"]);
    assert_eq!(made.status, Some(0), "{}", made.stderr);
    let panel = Panel::start(place, &[&["panel", "made"], more].concat());
    panel.press("take-seat");
    panel
}

/// A column of the trace, cycle by cycle.
pub(super) fn column(place: &Place, name: &str) -> Vec<f64> {
    let text = fs::read_to_string(place.at("made/trace.csv")).expect("a trace");
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let head: Vec<_> = lines.next().expect("a head").split(',').collect();
    let column = head.iter().position(|known| *known == name).unwrap_or_else(|| panic!("{name}: {head:?}"));
    let value = |line: &str| line.split(',').nth(column).and_then(|cell| cell.parse().ok());
    lines.filter_map(value).collect()
}

fn stands_at(panel: &Panel, cycle: u64) -> Value {
    until(&format!("it stands at {cycle}"), || {
        let state = panel.state();
        state["cycle"] == cycle && state["playback"]["speed"] == 0.0
    });
    panel.state()
}

/// What is shown where the player stands is what the trace of the run has of that cycle: forwards, backwards,
/// step by step, at the end.
#[test]
fn a_recording_shows_every_cycle_as_it_was() {
    let place = Place::new();
    let panel = plays(&place, &["--pace", "max"]);
    let last = column(&place, "cycle").last().copied().expect("cycles") as u64;
    let state = stands_at(&panel, last);
    assert_eq!((&state["playback"]["changed"], &state["playback"]["same"]), (&json!([]), &json!(true)));
    let [x, z, pass] = ["x_commanded", "z_commanded", "pass"].map(|name| column(&place, name));
    let cycle_s = panel.state()["machine"]["cycle_s"].as_f64().expect("a time");
    let holds = |cycle: u64| {
        let state = stands_at(&panel, cycle);
        for (axis, trace) in [&x, &z].into_iter().enumerate() {
            let (seen, wanted) = (state["axes"][axis]["commanded_mm"].as_f64(), trace[cycle as usize]);
            assert!(seen.is_some_and(|seen| (seen - wanted).abs() < 1e-9), "{cycle}: {seen:?} {wanted}");
        }
        if pass[cycle as usize] > 0.0 {
            assert_eq!(state["pass"].as_f64(), Some(pass[cycle as usize]), "{cycle}");
        }
    };
    holds(last);
    // In the second pass, a cycle on, a tenth of a second on, back into the first one, to the beginning.
    let second = pass.iter().position(|pass| *pass == 2.0).expect("a second pass") as u64 + 400;
    let first = pass.iter().position(|pass| *pass == 1.0).expect("a first pass") as u64 + 300;
    panel.turn("seek", second as f64 * cycle_s);
    holds(second);
    for steps in [1, 1, 200] {
        let before = panel.state()["cycle"].as_u64().expect("a cycle");
        panel.turn("step", steps);
        holds(before + steps);
    }
    panel.turn("seek", first as f64 * cycle_s);
    holds(first);
    assert_eq!(panel.state()["passes"], json!([]), "the first pass is not over yet");
    panel.turn("seek", 0);
    holds(0);
    // It plays, and stands where it is told to.
    panel.turn("play", 0.5);
    until("it goes on", || panel.state()["cycle"].as_u64().is_some_and(|cycle| cycle > 100));
    panel.turn("play", 0);
    until("it stands", || panel.state()["playback"]["speed"] == 0.0);
    let cycle = panel.state()["cycle"].as_u64().expect("a cycle");
    holds(cycle);
    // A panel that dies shows where the player stands when it is there again.
    signal(panel.server().expect("it is there"), "KILL");
    until("another one is there", || panel.server().is_some());
    until("it shows something", || panel.state()["cycle"].is_u64());
    holds(cycle);
}

#[test]
fn no_key_acts_on_a_recording_and_what_is_none_is_not_played() {
    let place = Place::new();
    let panel = plays(&place, &["--pace", "0.2"]);
    for (word, value) in [
        ("start", Value::Null),
        ("hold", Value::Null),
        ("by-hand", Value::Null),
        ("mdi", json!("G0 X1")),
        ("offset", json!({ "of": "G54", "set": { "X": 1 } })),
        ("feed-override", json!(50)),
    ] {
        let (told, why) = refused(&panel, word, value);
        assert!(told == "not-now" && why.contains("recording"), "{word}: {told}: {why}");
    }
    assert_eq!(panel.state()["mode"], "playback");
    for (word, value) in [("play", json!(-1)), ("play", json!(1e9)), ("step", json!(0)), ("seek", json!("x"))]
    {
        assert_eq!(refused(&panel, word, value).0, "bad-value");
    }
    for (arguments, why) in [
        (&["panel", "made", "--seed", "2"][..], "is played as it was"),
        (&["panel", "made", "--tools", "other.tbl"][..], "is played as it was"),
        (&["panel", "made", "--from", "3"][..], "is played as it was"),
        (&["panel", "made", "--clock", "real", "--pace", "2"][..], "is played as it was"),
        (&["panel", "nothing-there"], "nothing-there"),
        (&["panel", "."], "summary.json"),
    ] {
        let answer = place.ask(arguments);
        assert!(answer.status == Some(2) && answer.stderr.contains(why), "{arguments:?}: {}", answer.stderr);
    }
    // A machine is no recording.
    let machine = Panel::start(&place, &["panel", "--trace", "none"]);
    machine.press("take-seat");
    let (told, why) = refused(&machine, "play", json!(1));
    assert!(told == "not-running" && why.contains("RUN_DIR"), "{told}: {why}");
}

/// A folder that somebody has changed shows another run: which file that is stands there from the beginning,
/// and at the end that it is another one.
#[test]
fn a_folder_that_was_changed_is_played_and_that_is_told() {
    let place = Place::new();
    drop(plays(&place, &[]));
    fs::write(place.at("made/thread.ngc"), THREAD.replace("S600", "S601")).expect("room");
    let panel = Panel::start(&place, &["panel", "made", "--pace", "0.1"]);
    panel.press("take-seat");
    let playback = || panel.state()["playback"].clone();
    until("it is shown", || playback().is_object());
    assert_eq!((&playback()["changed"], &playback()["same"]), (&json!(["thread.ngc"]), &Value::Null));
    panel.turn("play", 1000);
    until("it is over", || playback()["same"] == json!(false));
}
