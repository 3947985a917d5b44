//! Offsets and tools that are typed at the panel: in the files while the machine is off, as blocks while it
//! works by hand; what is refused, and that a session with them is repeated.

use std::fs;

use rig::observe::Summary;
use serde_json::{Value, json};

use super::{
    by_hand::{by_hand, does, ended, is_ready, refused, stands},
    client::Panel,
    watched::is_repeated,
};
use crate::shop::{Place, project, signal, until};

/// A cut to a diameter with a tool that has an offset.
pub(super) const CUT: &str = "\
G18 G21 G90 G7 G94 G97
T3 M6 G43
M3 S600
G0 X30 Z3
G1 X20 F2000
G1 Z-4
G0 X40
M2
";
const VARIABLES: &str = "5220 1\n5250 200\n";
pub(super) const TOOLS: &str = "; lathe\nT1 P1 X0 Z0\nT3 P3 X-0.1 Z0.2 ;threading tool\n";

/// A cut with its tools and a parameter file, and the panel that has loaded them.
fn shop() -> (Place, Panel) {
    let place = Place::new();
    let lathe = fs::read_to_string(project().join("examples/machines/plain-lathe.toml")).expect("a lathe");
    let lathe = lathe + "\n[tools.2]\nname = \"boring bar\"\n[tools.3]\nname = \"threading tool\"\n";
    let texts = [("cut.ngc", CUT), ("tool.tbl", TOOLS), ("lathe.var", VARIABLES), ("lathe.toml", &lathe)];
    for (name, text) in texts {
        fs::write(place.at(name), text).expect("room");
    }
    let files = ["--tools", "tool.tbl", "--parameters", "lathe.var", "--machine", "lathe.toml"];
    let more = ["--trace", "none", "--pace", "max"];
    let panel = Panel::start(&place, &[&["panel", "cut.ngc"], &files[..], &more].concat());
    panel.press("take-seat");
    (place, panel)
}

/// A word of a tool; no number as long as the tool is not shown.
fn of_tool(panel: &Panel, number: i64, letter: &str) -> f64 {
    let state = panel.state();
    let tools = state["offsets"]["tool_offsets"].as_array().cloned().unwrap_or_default();
    let tool = tools.iter().find(|tool| tool["number"] == number);
    tool.and_then(|tool| tool[letter].as_f64()).unwrap_or(f64::NAN)
}

/// Runs the program, and says where X stands then: mm of the machine.
fn runs(panel: &Panel, before: u64) -> f64 {
    panel.press("start");
    until("it is over", || {
        let state = panel.state();
        let folder = state["program"]["folder"].as_str().unwrap_or_default().to_owned();
        folder.ends_with(&format!("cut-{before}"))
            && state["outcome"] == "completed"
            && state["mode"] == "off"
    });
    stands(panel)[0]
}

/// The task of a machinist: the part is 0.05 too thick, the wear is corrected, the cut is made again.
#[test]
fn wear_that_is_typed_is_in_the_file_in_the_next_cut_and_in_its_folder() {
    let (place, panel) = shop();
    let first = runs(&panel, 1);
    assert!((first - (20.0 - 0.1)).abs() < 1e-9, "X40 is a radius of 20, less the offset: {first}");
    panel.turn("offset", json!({ "of": "T3", "add": { "X": -0.025 } }));
    until("it is shown", || (of_tool(&panel, 3, "X") + 0.125).abs() < 1e-12);
    let wanted = TOOLS.replace("X-0.1 ", "X-0.125 ");
    assert_eq!(fs::read_to_string(place.at("tool.tbl")).expect("a table"), wanted, "and nothing else of it");
    let second = runs(&panel, 2);
    assert!((second - first + 0.025).abs() < 1e-9, "{first} {second}");
    // A zero as well, Z of G54, and more words of a tool at once.
    panel.turn("offset", json!({ "of": "G54", "set": { "Z": -12.5 } }));
    panel.turn("offset", json!({ "of": "t1", "set": { "X": 1.5, "D": 0.8, "Q": 2 } }));
    until("it is shown", || of_tool(&panel, 1, "Q") == 2.0);
    assert_eq!(panel.state()["offsets"]["systems"][0]["Z"], -12.5);
    assert!(fs::read_to_string(place.at("lathe.var")).expect("a file").contains("5223"));
    signal(panel.launcher.id(), "INT");
    assert_eq!(panel.ends().status, Some(0));
    let summary = Summary::read(&place.at("runs/cut-2/summary.json")).expect("a summary");
    is_repeated(&place, "runs/cut-2", &summary);
}

#[test]
fn what_no_offset_can_be_is_refused_and_changes_nothing() {
    let (place, panel) = shop();
    let set = |of: &str, words: Value| json!({ "of": of, "set": words });
    let add = |of: &str, words: Value| json!({ "of": of, "add": words });
    for (value, code, why) in [
        (set("T3", json!({ "X": -1240 })), "bad-offset", "out of every reach"),
        (set("G54", json!({ "Z": 1e5 })), "bad-offset", "out of every reach"),
        (set("T3", json!({ "Y": 1 })), "bad-offset", "no axis Y"),
        (set("T77", json!({ "X": 1 })), "bad-offset", "has no T77"),
        (set("T2", json!({ "X": 1 })), "bad-offset", "offsets set T2"),
        (set("T3", json!({ "D": 1e6 })), "bad-offset", "longest travel"),
        (set("G54", json!({ "R": 1e6 })), "bad-offset", "more than a turn"),
        (set("T3", json!({ "X": 4e-7 })), "bad-offset", "less than the files keep"),
        (add("T3", json!({ "X": -1e-9 })), "bad-offset", "less than the files keep"),
        (set("T3", json!({ "Q": 11 })), "bad-offset", "0 to 9"),
        (set("T3", json!({ "D": -1 })), "bad-offset", "a diameter is 0 or more"),
        (set("T3", json!({ "I": 400 })), "bad-offset", "more than a turn"),
        (set("T3", json!({ "R": 1 })), "bad-offset", "no word"),
        (set("G60", json!({ "X": 1 })), "bad-offset", "neither a coordinate system"),
        (set("T3", json!({ "X": 1e9 })), "bad-offset", "at most 1000000"),
        (add("T3", json!({ "X": -5 })), "bad-offset", "is no correction"),
        (add("T2", json!({ "X": 0.01 })), "bad-offset", "nothing to add to"),
        (add("G55", json!({ "R": 200 })), "bad-offset", "R400 of G55"),
        (add("T3", json!({ "Q": 1 })), "bad-offset", "cannot be added to"),
        (json!({ "of": "T3" }), "bad-value", "{of, set}"),
    ] {
        let (told, reason) = refused(&panel, "offset", value.clone());
        assert!(told == code && reason.contains(why), "{value}: {told}: {reason}");
    }
    assert_eq!(fs::read_to_string(place.at("tool.tbl")).expect("a table"), TOOLS);
    assert_eq!(fs::read_to_string(place.at("lathe.var")).expect("a file"), VARIABLES);
    // A machine without files has nowhere to keep them while it is off.
    let bare = Place::new();
    let panel = Panel::start(&bare, &["panel", "--trace", "none"]);
    panel.press("take-seat");
    for (of, option) in [("T3", "--tools"), ("G54", "--parameters")] {
        let (told, reason) = refused(&panel, "offset", set(of, json!({ "X": 1 })));
        assert!(told == "bad-offset" && reason.contains(option), "{told}: {reason}");
    }
}

/// A table with more tools than are shown: how many are left out is told; one of them can be set.
#[test]
fn what_is_left_out_of_a_long_table_is_told() {
    let place = Place::new();
    let tools: String = (1..=1005).map(|number| format!("T{number} P{number} X0.5\n")).collect();
    place.write("tool.tbl", &tools);
    let panel = Panel::start(&place, &["panel", "--tools", "tool.tbl", "--trace", "none"]);
    panel.press("take-seat");
    until("they are shown", || panel.state()["offsets"].is_object());
    let offsets = panel.state()["offsets"].clone();
    assert_eq!(
        (offsets["tool_offsets"].as_array().map(Vec::len), &offsets["tools_left_out"]),
        (Some(1000), &json!(5))
    );
    panel.turn("offset", json!({ "of": "T1003", "add": { "X": -0.025 } }));
    assert!(fs::read_to_string(place.at("tool.tbl")).expect("a table").contains("T1003 P1003 X0.475\n"));
}

/// By hand an offset is a block: it has its cycle, it acts on the next one, and it is kept when the machine
/// is switched off.
#[test]
fn an_offset_by_hand_has_its_cycle_acts_on_the_next_block_and_is_repeated() {
    let place = Place::new();
    for (name, text) in [("tool.tbl", TOOLS), ("lathe.var", "5220 1\n")] {
        fs::write(place.at(name), text).expect("room");
    }
    let files = ["--tools", "tool.tbl", "--parameters", "lathe.var"];
    let panel = by_hand(&place, &[&files[..], &["--pace", "20", "--trace", "none"]].concat());
    does(&panel, "mdi", "G7 T3 M6 G43");
    does(&panel, "mdi", "G0 X60 Z30");
    let [x, z] = stands(&panel);
    assert!((x - 29.9).abs() < 1e-9 && (z - 30.2).abs() < 1e-9, "{x} {z}");
    assert!(does(&panel, "offset", json!({ "of": "T3", "add": { "X": -0.025, "Z": 0.01 } })) > 0);
    until("it is shown", || (of_tool(&panel, 3, "X") + 0.125).abs() < 1e-9);
    does(&panel, "offset", json!({ "of": "G54", "set": { "Z": -2 } }));
    does(&panel, "mdi", "G20 G43 G0 X2 Z1");
    let [x, z] = stands(&panel);
    assert!((x - (25.4 - 0.125)).abs() < 1e-5 && (z - (25.4 + 0.21 - 2.0)).abs() < 1e-5, "{x} {z}");
    // In inches too it is set in units of the machine.
    does(&panel, "offset", json!({ "of": "T3", "set": { "X": -0.5, "D": 0.8 } }));
    until("it is shown", || (of_tool(&panel, 3, "X") + 0.5).abs() < 1e-6);
    assert!((of_tool(&panel, 3, "D") - 0.8).abs() < 1e-6);
    // Touching off into the tool: here its tip is at X 40 mm in diameter.
    does(&panel, "mdi", "G21 G43");
    let [x, _] = stands(&panel);
    does(&panel, "touch-off", json!({ "axis": "X", "value": 40, "tool": 3 }));
    until("it is shown", || (of_tool(&panel, 3, "X") - (x - 20.0)).abs() < 1e-6);
    assert_eq!(refused(&panel, "touch-off", json!({ "axis": "X", "value": 40, "tool": 9 })).0, "bad-block");
    assert_eq!(refused(&panel, "offset", json!({ "of": "T3", "set": { "U": 1 } })).0, "bad-offset");
    assert_eq!(fs::read_to_string(place.at("tool.tbl")).expect("a table"), TOOLS, "not yet");
    panel.turn("mdi", "G4 P20");
    let (told, why) = refused(&panel, "offset", json!({ "of": "T3", "set": { "X": 1 } }));
    assert!(told == "not-now" && why.contains("wait for its end"), "{told}: {why}");
    is_ready(&panel);
    let summary = ended(&place, panel);
    let kept = fs::read_to_string(place.at("tool.tbl")).expect("a table");
    assert!(kept.starts_with("; lathe\nT1 P1 X0 Z0\nT3 P3 X") && kept.contains("D0.8 ;threading"), "{kept}");
    is_repeated(&place, "session", &summary);
    let pressed = fs::read_to_string(place.at("session/presses.toml")).expect("what was pressed");
    assert!(pressed.contains("# G10 L1 P3 X-0.25 Z0.21\n"), "{pressed}");
}
