//! Work by hand: what is refused and why, jogs whose panel dies, sessions that are repeated from their
//! folders.

use rig::observe::{Outcome, Summary};
use serde_json::{Value, json};
use testing::Seed;

use super::{client::Panel, watched::is_repeated};
use crate::shop::{Place, signal, until};

/// A machine that is switched on for work by hand.
pub(super) fn by_hand(place: &Place, more: &[&str]) -> Panel {
    let mut arguments = vec!["panel", "--out", "session"];
    arguments.extend(more);
    let panel = Panel::start(place, &arguments);
    assert_eq!(panel.state()["mode"], "off");
    panel.press("take-seat");
    panel.press("by-hand");
    is_ready(&panel);
    panel
}

pub(super) fn is_ready(panel: &Panel) {
    until("the machine waits for a block", || {
        let state = panel.state();
        state["mode"] == "ready" && state["by_hand"]["waits"] == true
    });
}

/// Asks, and waits until the machine has done it.
pub(super) fn does(panel: &Panel, word: &str, value: impl Into<Value>) -> u64 {
    let cycle = panel.turn(word, value);
    until("the block has begun", || panel.state()["cycle"].as_u64().is_some_and(|now| now > cycle));
    is_ready(panel);
    cycle
}

/// What a request is refused by, and why.
pub(super) fn refused(panel: &Panel, word: &str, value: Value) -> (String, String) {
    let answer = panel.ask(&json!({ "id": 1, "do": word, "as": "test", "value": value }));
    let text =
        |name: &str| answer[name].as_str().unwrap_or_else(|| panic!("{word} {value}: {answer}")).to_owned();
    (text("refused"), text("why"))
}

/// Commanded X and Z, mm of the machine.
pub(super) fn stands(panel: &Panel) -> [f64; 2] {
    let state = panel.state();
    [0, 1].map(|axis: usize| state["axes"][axis]["commanded_mm"].as_f64().expect("a place"))
}

/// Switches the machine off, ends the command and reads the summary.
pub(super) fn ended(place: &Place, panel: Panel) -> Summary {
    panel.press("abort");
    until("it is off", || panel.state()["mode"] == "off");
    signal(panel.launcher.id(), "INT");
    assert_eq!(panel.ends().status, Some(0));
    Summary::read(&place.at("session/summary.json")).expect("a summary")
}

/// Whoever has loaded a program types its language; what is in force stays from block to block.
#[test]
fn blocks_are_in_the_dialect_of_the_program_that_is_loaded() {
    let place = Place::new();
    let text = "O0100\nG99 G97 S700 M03\nG00 X24. Z6.\nG32 Z-12. F1.5\nG00 X30.\nM30\n";
    let program = place.write("part.nc", text).display().to_string();
    let panel = by_hand(&place, &[&program, "--pace", "20", "--trace", "none"]);
    let in_force = || panel.state()["by_hand"]["in_force"].as_str().expect("words").to_owned();
    assert_eq!(in_force(), "FANUC: G0 G18 G21 G99 G54 T0 F0 S0");
    does(&panel, "mdi", "G98 G01 X100. F6000.");
    does(&panel, "mdi", "#500=35");
    does(&panel, "mdi", "Z#500");
    assert_eq!(in_force(), "FANUC: G1 G18 G21 G98 G54 T0 F6000 S0");
    assert_eq!(stands(&panel), [50.0, 35.0]);
    let summary = ended(&place, panel);
    is_repeated(&place, "session", &summary);
}

#[test]
fn blocks_and_steps_do_what_they_say_and_what_is_refused_says_why() {
    let place = Place::new();
    let panel = by_hand(&place, &["--pace", "20", "--trace", "none"]);
    let [x, z] = stands(&panel);
    does(&panel, "jog", json!({ "axis": "Z", "mm_min": 3000, "step_mm": -12.5 }));
    does(&panel, "jog", json!({ "axis": "x", "mm_min": 1200, "step_mm": -0.001 }));
    let near = |one: [f64; 2], other: [f64; 2]| {
        assert!(one.iter().zip(other).all(|(one, other)| (one - other).abs() < 1e-6), "{one:?} {other:?}");
    };
    near(stands(&panel), [x - 0.001, z - 12.5]);
    // A block goes from where the jogs have led.
    does(&panel, "mdi", "(50 % of 3) G91 G0 Z-1.5 ; 100 %");
    near(stands(&panel), [x - 0.001, z - 14.0]);
    assert!(panel.state()["by_hand"]["in_force"].as_str().is_some_and(|words| words.contains("G91")));
    // Touching off: here X is 20 in diameter, and a block that says so goes nowhere; one to 30 goes 5 mm.
    does(&panel, "mdi", "G90 G7");
    does(&panel, "touch-off", json!({ "axis": "X", "value": 20 }));
    let [x, _] = stands(&panel);
    let origin = panel.state()["origin_mm"][0].as_f64().expect("an origin");
    assert!((origin - (x - 10.0)).abs() < 1e-6, "{origin}: X 20 lies where X stands, at {x}");
    does(&panel, "mdi", "G0 X30");
    near(stands(&panel), [x + 5.0, z - 14.0]);
    does(&panel, "spindle", json!(-400));
    until("it turns", || panel.state()["spindle"]["rpm"].as_f64().is_some_and(|rpm| rpm < -390.0));
    does(&panel, "spindle", json!(0));
    let before = panel.state()["by_hand"]["in_force"].clone();
    for (word, value, code, why) in [
        ("mdi", json!("G1 X"), "bad-block", "a value is missing"),
        ("mdi", json!("(50 %)\n%\nG0 X0"), "bad-block", "a % stands before and behind a program"),
        ("mdi", json!("G0 Z-1\nG0 Z-1000000"), "bad-block", "travel"),
        ("mdi", json!("G91 G1 Z1 F0"), "bad-block", "F is 0"),
        ("mdi", json!("G33 Z-20 K2"), "bad-block", "spindle"),
        ("jog", json!({ "axis": "Z", "mm_min": 600, "step_mm": 1e4 }), "bad-block", "travel"),
        ("jog", json!({ "axis": "Y", "mm_min": 600, "step_mm": 1 }), "bad-block", "no axis"),
        ("jog", json!({ "axis": "Z", "mm_min": 1e5, "way": "+" }), "bad-block", "no feed"),
        ("jog", json!({ "axis": "Z", "mm_min": 1 }), "bad-value", "way"),
        ("jog-on", Value::Null, "not-now", "no jog"),
        ("start", Value::Null, "not-now", "nothing is held"),
        ("by-hand", Value::Null, "not-now", "is on"),
        ("home", Value::Null, "bad-value", "name of an axis"),
        ("home", json!("C"), "bad-block", "no axis"),
    ] {
        let (told, reason) = refused(&panel, word, value.clone());
        assert!(told == code && reason.contains(why), "{word} {value}: {told}: {reason}");
    }
    assert_eq!(panel.state()["by_hand"]["in_force"], before, "what is refused changes nothing");
    near(stands(&panel), [x + 5.0, z - 14.0]);
    // While a block is in hand no other is taken; a hold stops it, and start goes on.
    panel.turn("mdi", "G91 G1 Z-30 F600");
    assert_eq!(refused(&panel, "mdi", json!("G0 Z1")).0, "not-now");
    panel.press("hold");
    until("it is held", || panel.state()["mode"] == "held");
    panel.press("start");
    is_ready(&panel);
    near(stands(&panel), [x + 5.0, z - 44.0]);
    // Home is where the machine file says, whatever is in force; there it is refused.
    does(&panel, "mdi", "G20 G91");
    does(&panel, "home", "z");
    near(stands(&panel), [x + 5.0, machine::Machine::default().axis[&protocol::Axis::Z].home_mm]);
    assert_eq!(refused(&panel, "home", json!("Z")).1, "Z stands at its home");
    let summary = ended(&place, panel);
    assert_eq!((summary.outcome, summary.faults.len()), (Outcome::Stopped, 0));
    is_repeated(&place, "session", &summary);
    let pressed = std::fs::read_to_string(place.at("session/presses.toml")).expect("what was pressed");
    assert!(
        pressed.contains("# G10 L20 P1 X20.000000\n") && pressed.contains("# G91 G1 Z-30 F600\n"),
        "{pressed}"
    );
}

/// What a block says is told when the machine has come so far, and with the session.
#[test]
fn messages_of_a_block_are_told_and_stand_in_the_summary() {
    let place = Place::new();
    let panel = by_hand(&place, &["--pace", "20", "--trace", "none"]);
    does(&panel, "mdi", "#1=[2+3]\n(debug, five is #1)\nG91 G0 Z-1\n(MSG, measure)\nG0 Z1");
    let told = |messages: &[(u64, String)]| {
        let texts: Vec<_> = messages.iter().map(|(_, text)| text.as_str()).collect();
        assert_eq!(texts, ["five is 5.000000", "measure"]);
        assert!(messages[0].0 < messages[1].0, "one before it moves, one behind");
    };
    let seen = panel.state()["messages"].as_array().cloned().expect("messages");
    let of = |message: &Value| {
        (message["cycle"].as_u64().unwrap_or(0), message["text"].as_str().unwrap_or("").into())
    };
    told(&seen.iter().map(of).collect::<Vec<_>>());
    assert_eq!(panel.state()["blocks"], true, "their lines are numbers of blocks");
    let summary = ended(&place, panel);
    told(&summary.messages.iter().map(|told| (told.cycle, told.text.clone())).collect::<Vec<_>>());
    is_repeated(&place, "session", &summary);
}

/// A thread cut by a block, with the override turned in it; another one held in a pass; a tap; one that is
/// ended in a pass. Each pass is measured as in a program, and the session is repeated.
#[test]
fn threads_and_taps_are_cut_by_blocks_and_the_session_is_repeated() {
    let place = Place::new();
    let panel = by_hand(&place, &["--pace", "20", "--trace", "none"]);
    let thread = "G76 P2 Z-12 I-2.18 J1.6 K2.969 R2 Q29.5 H1";
    let in_pass = |number: u64| {
        until("a pass is cut", || {
            let state = panel.state();
            state["state"] == "threading" && state["pass"].as_u64() >= Some(number)
        });
    };
    for block in ["G7 G18 G21 G90", "M3 S500", "G0 X22 Z5"] {
        does(&panel, "mdi", block);
    }
    panel.turn("mdi", thread);
    in_pass(2);
    assert_eq!(refused(&panel, "mdi", json!("G0 X40")).0, "not-now");
    panel.turn("spindle-override", 80);
    is_ready(&panel);
    let first = panel.state()["passes"].as_array().cloned().expect("passes");
    assert!(first.len() > 3, "{first:?}");
    for pass in &first {
        assert!(pass["end"] == "complete" && pass["helix_um"].as_f64() < Some(5.0), "{pass}");
    }
    does(&panel, "mdi", "G0 Z5");
    // Its passes go on counting.
    panel.turn("mdi", thread);
    in_pass(first.len() as u64 + 1);
    panel.press("hold");
    until("it is held", || panel.state()["state"] == "held");
    panel.press("start");
    is_ready(&panel);
    for block in ["G0 X30", "G0 Z5", "G0 X0", "G33.1 Z-6 K1", "G0 X22"] {
        does(&panel, "mdi", block);
    }
    let passes = panel.state()["passes"].as_array().map_or(0, Vec::len);
    assert!(passes > 2 * first.len(), "{passes}");
    panel.turn("mdi", thread);
    in_pass(passes as u64 + 1);
    let summary = ended(&place, panel);
    assert_eq!((summary.outcome, summary.faults.len()), (Outcome::Stopped, 0));
    is_repeated(&place, "session", &summary);
    let again = Summary::read(&place.at("again/summary.json")).expect("a summary");
    assert!(summary.passes.len() >= passes, "{} of {passes}", summary.passes.len());
    assert_eq!(json!(summary.passes), json!(again.passes));
}

/// What a session may do, at random: steps, blocks, touches, the spindle, overrides.
fn random(seed: &mut Seed) -> (&'static str, Value) {
    let blocks =
        ["G91 G0 Z-0.5", "G91 G1 X0.25 F800", "G4 P0.05", "G90", "G18 G91 G3 X0.4 Z0.4 R0.4 F500", "T3 M6"];
    let axis = ["X", "Z"][seed.below(2)];
    let rpm = [0.0, 300.0, -200.0][seed.below(3)];
    let step = f64::from(seed.below(2000) as u32) * 1e-3 - 1.0;
    match seed.below(9) {
        0..3 => ("jog", json!({ "axis": axis, "mm_min": 900, "step_mm": step + 0.0005 })),
        3..5 => ("mdi", json!(blocks[seed.below(blocks.len())])),
        5 => ("touch-off", json!({ "axis": axis, "value": step })),
        6 => ("spindle", json!(rpm)),
        7 => ("offset", json!({ "of": "G54", "add": { axis: step } })),
        _ => ("feed-override", json!(50 + seed.below(100))),
    }
}

/// Thirty things at random, with jogs that go on while they are confirmed among them.
#[test]
fn a_session_by_hand_is_repeated_from_its_run_folder() {
    for case in 0..testing::count("PITCHLOCK_SESSIONS", 2) {
        let place = Place::new();
        let mut seed = Seed::of_case(case);
        let panel = by_hand(&place, &["--pace", "2", "--trace", "none"]);
        let [_, z] = stands(&panel);
        does(&panel, "mdi", "G91 G0 X-10 Z-20");
        for number in 0..30 {
            let (word, value) = random(&mut seed);
            if word == "feed-override" {
                panel.turn(word, value);
            } else {
                does(&panel, word, value);
            }
            if number % 10 == 5 {
                let way = if stands(&panel)[1] > z - 20.0 { "-" } else { "+" };
                panel.turn("jog", json!({ "axis": "Z", "mm_min": 600, "way": way }));
                for _ in 0..seed.below(12) {
                    panel.ask(&json!({ "id": 1, "do": "jog-on", "as": "test" }));
                }
                panel.press("let-go");
                is_ready(&panel);
            }
        }
        let summary = ended(&place, panel);
        assert!(summary.faults.is_empty(), "{case}: {:?}", summary.faults);
        is_repeated(&place, "session", &summary);
    }
}

/// Cycles in which Z is led somewhere, from a trace of every cycle.
fn moving(place: &Place) -> Vec<u64> {
    let text = std::fs::read_to_string(place.at("session/trace.csv")).expect("a trace");
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let head: Vec<_> = lines.next().expect("a head").split(',').collect();
    let column = head.iter().position(|name| name.starts_with("z_velocity")).expect("a column of Z");
    let speed = |line: &str| line.split(',').nth(column).and_then(|cell| cell.parse::<f64>().ok());
    let moves = lines.enumerate().filter(|(_, line)| speed(line).is_some_and(|speed| speed != 0.0));
    moves.map(|(cycle, _)| cycle as u64).collect()
}

/// The server of the panel is killed while a key is pressed, at seeded moments; and the seat is taken over.
#[test]
fn a_jog_ends_with_the_panel_that_pressed_it_and_with_the_seat() {
    let place = Place::new();
    let panel = by_hand(&place, &["--pace", "1", "--trace", "full-csv"]);
    let mut seed = Seed::new(21);
    let mut ends = Vec::new();
    for moment in 0..6 {
        let way = if moment % 2 == 0 { "-" } else { "+" };
        panel.turn("jog", json!({ "axis": "Z", "mm_min": 900, "way": way }));
        let mut last = 0;
        for _ in 0..2 + seed.below(12) {
            let answer = panel.ask(&json!({ "id": 1, "do": "jog-on", "as": "test" }));
            last = answer["cycle"].as_u64().unwrap_or(last);
        }
        if moment % 3 == 2 {
            panel.ask(&json!({ "id": 1, "do": "take-seat", "as": "other" }));
            assert_eq!(refused(&panel, "jog-on", Value::Null).0, "not-your-seat");
        } else {
            let server = panel.server().expect("it is there");
            signal(server, "KILL");
            until("another one is there", || panel.server().is_some_and(|now| now != server));
        }
        is_ready(&panel);
        ends.push(last);
        panel.press("take-seat");
    }
    let summary = ended(&place, panel);
    assert!(summary.faults.is_empty(), "{:?}", summary.faults);
    let moving = moving(&place);
    for last in ends.iter().filter(|last| **last > 0) {
        let stands = (*last..).find(|cycle| moving.binary_search(cycle).is_err()).unwrap_or(u64::MAX);
        assert!(stands <= last + 300, "its last sign was in {last}, and it stands from {stands} on");
    }
    assert!(ends.iter().filter(|last| **last > 0).count() > 3, "{ends:?}");
    assert!(!moving.is_empty());
}

/// What a killed panel leaves goes with the next one; that of one that lives stays, and so does whatever else
/// has such a name.
#[test]
fn what_a_killed_panel_leaves_is_swept_by_the_next() {
    let place = Place::new();
    let left = || {
        let entries = std::fs::read_dir(place.path()).expect("a folder").flatten();
        let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
        let mut names: Vec<_> = names.filter(|name| name.starts_with("pitchlock-by-hand-")).collect();
        names.sort();
        names
    };
    let start = || Panel::start(&place, &["panel", "--trace", "none"]);
    let end = |panel: Panel, name: &str| {
        signal(panel.launcher.id(), name);
        panel.ends()
    };
    let lives = start();
    let own = left();
    assert_eq!(own.len(), 1, "{own:?}");
    let other = place.path().join("pitchlock-by-hand-other");
    std::fs::create_dir(&other).expect("room");
    std::fs::write(other.join("notes.txt"), "somebody's").expect("room");
    end(start(), "KILL");
    assert_eq!(left().len(), 3, "its own, the other one, and what the killed one has left");
    let next = start();
    let now = left();
    assert!(now.len() == 3 && own.iter().all(|name| now.contains(name)), "{now:?}");
    assert!(other.join("notes.txt").exists());
    end(next, "INT");
    end(lives, "INT");
    assert_eq!(left(), ["pitchlock-by-hand-other"]);
}
