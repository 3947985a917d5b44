//! A program that is begun at a line from the panel: what is shown before, that it is so, that it is
//! repeated.

use rig::observe::{Outcome, Summary};
use serde_json::{Value, json};

use super::{
    browser::{Browser, FITS},
    by_hand::refused,
    client::Panel,
    watched::is_repeated,
};
use crate::shop::{Place, signal, until};

/// Turned, then two passes of a thread in lines of their own; line 12 begins the second.
pub(super) const PROGRAM: &str = "G18 G21 G90 G8 G94 G97\nT3\nM3 S900\nG0 X11 Z8\n#1 = 9.3\nG0 X[#1]\nG33 Z-14 K2\nG0 X11\n\
    G0 Z8\n(the second)\nF90\nG0 X8.8\nG33 Z-14 K2\nG0 X11\nG0 X20\nM5\nM2\n";

fn is_off(panel: &Panel) {
    until("it is off", || panel.state()["mode"] == "off");
}

/// Chosen, shown, taken back, chosen again, begun there, repeated; and the next start is one from the
/// beginning.
#[test]
fn a_line_is_chosen_shown_and_begun_at_and_the_session_is_repeated() {
    let place = Place::new();
    place.write("screw.ngc", PROGRAM);
    let panel = Panel::start(&place, &["panel", "screw.ngc", "--trace", "none", "--pace", "20"]);
    assert_eq!(panel.state()["from"], Value::Null);
    panel.press("take-seat");
    assert_eq!(panel.turn("from", 12), 0);
    let from = panel.state()["from"].clone();
    assert_eq!((&from["from"], &from["line"], &from["passes_before"]), (&json!(12), &json!(12), &json!(1)));
    assert_eq!(from["words"], "G0 G18 G21 G90 G94 G8 G54 F90 S900", "{from}");
    assert_eq!(from["variables"], json!({ "#1": 9.3 }), "{from}");
    let in_force = from["in_force"].as_str().expect("words");
    assert!(in_force.starts_with("tool 3, spindle 900.0 1/min, coolant off"), "{in_force}");
    assert!(from["way"][0].as_str().is_some_and(|way| way.contains("rapid")), "{from}");
    // What cannot be begun at changes nothing.
    let (code, why) = refused(&panel, "from", json!(4000));
    assert!(code == "bad-line" && why.contains("earlier line"), "{code}: {why}");
    assert_eq!(panel.state()["from"], from);
    panel.turn("from", Value::Null);
    assert_eq!(panel.state()["from"], Value::Null);
    panel.turn("from", 12);
    panel.press("start");
    // Right behind it, and while it runs.
    for _ in 0..2 {
        let (code, why) = refused(&panel, "from", json!(4));
        assert!(code == "not-now" && why.contains("while it is off"), "{code}: {why}");
        until("it runs", || panel.state()["mode"] == "auto");
    }
    panel.turn("feed-override", 80);
    is_off(&panel);
    assert_eq!(panel.state()["from"], Value::Null, "the next start is one from the beginning");
    panel.press("start");
    until("another one is over", || {
        let state = panel.state();
        state["program"]["folder"] == "runs/screw-2" && state["outcome"] == "completed"
    });
    signal(panel.launcher.id(), "INT");
    assert_eq!(panel.ends().status, Some(0));
    let summary =
        |run: &str| Summary::read(&place.at(&format!("runs/{run}/summary.json"))).expect("a summary");
    let (begun, whole) = (summary("screw-1"), summary("screw-2"));
    assert_eq!((begun.outcome, begun.from_line, begun.passes.len()), (Outcome::Completed, Some(12), 1));
    assert_eq!((whole.outcome, whole.from_line, whole.passes.len()), (Outcome::Completed, None, 2));
    let law = |summary: &Summary| {
        let pass = summary.passes.last().expect("a pass").clone();
        (pass.pass, pass.line, pass.c0_deg, pass.delta_c_deg, pass.delta_x_mm, pass.thread_end_deg)
    };
    assert_eq!(law(&begun), law(&whole), "the pass is the one of the whole program");
    is_repeated(&place, "runs/screw-1", &begun);
}

/// A program that was changed meanwhile is not begun by what was shown of another one.
#[test]
fn a_program_that_was_changed_is_not_begun_at_a_line_that_was_chosen_before() {
    // What is in force there, and what comes behind it.
    for changed in [PROGRAM.replace("F90", "F70"), PROGRAM.replace("M2", "G4 P0.1\nM2")] {
        assert_ne!(changed, PROGRAM);
        let place = Place::new();
        place.write("screw.ngc", PROGRAM);
        let panel = Panel::start(&place, &["panel", "screw.ngc", "--trace", "none", "--from", "12"]);
        panel.press("take-seat");
        assert_eq!(panel.state()["from"]["from"], 12, "chosen by the command line");
        place.write("screw.ngc", changed);
        panel.press("start");
        until("it was not run", || {
            panel.state()["words"].as_str().is_some_and(|words| words.contains("is not what was shown"))
        });
        let state = panel.state();
        assert_eq!((&state["mode"], &state["from"]), (&json!("off"), &Value::Null));
        assert!(!place.at("runs").exists(), "nothing was begun");
    }
}

/// Without a program there is no line.
#[test]
fn work_by_hand_has_no_line_to_begin_at() {
    let place = Place::new();
    let panel = Panel::start(&place, &["panel", "--trace", "none"]);
    panel.press("take-seat");
    let (code, why) = refused(&panel, "from", json!(4));
    assert!(code == "not-running" && why.contains("no program is loaded"), "{code}: {why}");
}

/// A line of the program is pressed, chosen, shown with what is in force there, and begun at.
#[test]
fn a_browser_begins_at_a_line() {
    let place = Place::new();
    place.write("screw.ngc", PROGRAM);
    let panel = Panel::start(&place, &["panel", "screw.ngc", "--trace", "none", "--pace", "5"]);
    let url = format!("http://{}/#{}", panel.address, panel.token);
    let Some(mut browser) = Browser::open(&place, &url, 1200) else { return };
    browser.until_text("text", "the second");
    browser.click("#take");
    browser.until_text("seat", "You hold the keys");
    browser.until_text("mode", "off");
    browser.click("#text div:nth-child(12)");
    browser.until_text("from-here", "Begin at line 12");
    browser.click("#from-here");
    browser.until_text("from-line", "Start begins at line 12");
    browser.until_text("from-told", "tool 3, spindle 900.0 1/min");
    let key = "document.querySelector('[data-do=start]').textContent";
    assert_eq!(browser.value(key), "Start at line 12");
    browser.picture("panel-from", ".text");
    assert_eq!(browser.value(FITS), true);
    browser.click("#from-start");
    until("it is taken back", || browser.value("document.getElementById('from').hidden") == true);
    browser.click("#from-here");
    browser.until_text("from-line", "Start begins at line 12");
    browser.click("[data-do=start]");
    browser.until_text("from-line", "Begun at line 12");
    browser.until_text("words", "completed");
    assert_eq!(browser.value(key), "Start");
    let summary = Summary::read(&place.at("runs/screw-1/summary.json")).expect("a summary");
    assert_eq!(summary.from_line, Some(12));
}
