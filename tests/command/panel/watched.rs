//! A machine that is watched does the same as one that is not; and what was pressed belongs to its run.

use rig::observe::{Outcome, Summary};
use serde_json::{Value, json};
use testing::Seed;

use super::{browser::Browser, client::Panel};
use crate::shop::{Place, example, signal, until, wait_s};

/// Starts a run with a panel.
fn watched(place: &Place, program: &str, out: &str, more: &[&str]) -> Panel {
    let mut arguments = vec!["run", program, "--panel", "--json", "--trace", "none", "--out", out];
    arguments.extend(more);
    Panel::start(place, &arguments)
}

/// The summary that it ends with.
pub(super) fn ended(panel: Panel) -> (Option<i32>, Summary) {
    let answer = panel.ends();
    let summary = serde_json::from_str(&answer.stdout);
    (answer.status, summary.unwrap_or_else(|error| panic!("{error}: {}", answer.stdout)))
}

/// The run folder repeated over processes and in one, without anybody at the panel: the same; and replayed.
pub(super) fn is_repeated(place: &Place, out: &str, first: &Summary) {
    for more in [&["--trace", "none"][..], &["--trace", "none", "--in-process"]] {
        let mut command = place.pitchlock();
        place.clear("again");
        command.args(["run", out, "--json", "--out", "again"]).args(more);
        let answer = crate::shop::Answer::from(command.output().expect("it runs"));
        let again: Summary = serde_json::from_str(&answer.stdout).unwrap_or_else(|error| {
            let pressed = std::fs::read_to_string(place.at(out).join("presses.toml"));
            panic!("{error}: {} {pressed:?}", answer.stderr)
        });
        assert_eq!((&again.trace_hash, again.cycles), (&first.trace_hash, first.cycles), "{more:?}");
        assert_eq!(again.outcome, first.outcome);
    }
    let replayed = place.ask(&["replay", out]);
    assert_eq!(replayed.status, Some(0), "{}", replayed.stderr);
}

#[test]
fn a_run_with_three_who_watch_one_of_them_frozen_is_the_same() {
    let place = Place::new();
    let program = example("m20x2").display().to_string();
    let alone = place.run_inside(&example("m20x2"), None);
    let panel = watched(&place, &program, "watched", &["--pace", "20"]);
    let (frozen, mut one, mut other) = (panel.socket(), panel.socket(), panel.socket());
    let mut cycles = [-1, -1];
    for (socket, newest) in [&mut one, &mut other].into_iter().zip(&mut cycles) {
        for _ in 0..25 {
            let news = socket.next().expect("it lives");
            if let Some(cycle) = news["cycle"].as_i64() {
                assert!(cycle > *newest, "time goes on");
                *newest = cycle;
            }
        }
    }
    assert!(cycles.iter().all(|cycle| *cycle > 0), "{cycles:?}");
    let (status, summary) = ended(panel);
    assert_eq!((status, &summary.trace_hash), (Some(0), &alone.trace_hash));
    assert!(summary.channels.iter().all(|channel| channel.lost == 0), "{:?}", summary.channels);
    assert!(!place.at("watched/presses.toml").exists(), "nobody pressed anything");
    is_repeated(&place, "watched", &alone);
    drop(frozen);
}

#[test]
fn a_panel_that_is_killed_or_stopped_costs_the_machine_nothing_and_comes_back() {
    let place = Place::new();
    let alone = place.run_inside(&example("m20x2"), None);
    let mut seed = Seed::new(20);
    let panel = watched(&place, &example("m20x2").display().to_string(), "run", &["--pace", "3"]);
    let mut before = 0;
    for moment in 0..20 {
        let mut server = None;
        until("the panel is there", || {
            server = panel.server();
            server.is_some()
        });
        let server = server.expect("just seen");
        wait_s(f64::from(seed.below(200) as u32) * 1e-3);
        if moment % 3 == 2 {
            signal(server, "STOP");
            wait_s(0.3);
            signal(server, "CONT");
        } else {
            signal(server, "KILL");
            until("another one is there", || panel.server().is_some_and(|now| now != server));
        }
        // It shows where things are, on the same address, with the same secret.
        until("it shows the run", || panel.state()["cycle"].as_u64().is_some_and(|cycle| cycle > before));
        let state = panel.state();
        before = state["cycle"].as_u64().expect("just seen");
        assert!(state["program"]["text"].is_string() && state["trail"]["points"].is_array());
    }
    let (status, summary) = ended(panel);
    assert_eq!((status, &summary.trace_hash), (Some(0), &alone.trace_hash));
}

/// Browsers that are killed, and some that stand for a while, at seeded moments: the run is the same, and
/// the next one shows where things are.
#[test]
fn a_browser_that_is_killed_or_stopped_costs_the_machine_nothing() {
    let place = Place::new();
    let alone = place.run_inside(&example("m20x2"), None);
    let mut seed = Seed::new(21);
    let moments = testing::count("PITCHLOCK_BROWSERS", 2);
    // So that all moments lie in the run: some fourteen seconds, or three minutes.
    let pace = if moments > 2 { "0.3" } else { "4" };
    let panel = watched(&place, &example("m20x2").display().to_string(), "run", &["--pace", pace]);
    let url = format!("http://{}/#{}", panel.address, panel.token);
    let mut before = 0;
    for moment in 0..moments {
        let Some(mut browser) = Browser::open(&place, &url, 1000 + moment as u32) else { return };
        browser.until_text("link", "live");
        until("it shows the run", || browser.value("state.cycle").as_u64() > Some(before));
        wait_s(f64::from(seed.below(200) as u32) * 1e-3);
        if moment % 2 == 1 {
            signal(browser.process.id(), "STOP");
            wait_s(0.3);
            signal(browser.process.id(), "CONT");
            before = panel.state()["cycle"].as_u64().expect("a cycle");
            until("it goes on", || browser.value("state.cycle").as_u64() > Some(before));
        }
        before = panel.state()["cycle"].as_u64().expect("a cycle");
        signal(browser.process.id(), "KILL");
    }
    let (status, summary) = ended(panel);
    assert_eq!((status, &summary.trace_hash), (Some(0), &alone.trace_hash));
}

/// Thirty things at random, then everything back to where the program comes to its end, or its end at once.
/// A run may be over before that.
#[test]
fn a_session_of_random_presses_is_repeated_from_its_run_folder() {
    for case in 0..testing::count("PITCHLOCK_SESSIONS", 2) {
        let place = Place::new();
        let mut seed = Seed::of_case(case);
        let panel = watched(&place, &example("m20x2").display().to_string(), "session", &["--pace", "5"]);
        panel.press("take-seat");
        let mut cycles = Vec::new();
        for _ in 0..30 {
            wait_s(f64::from(seed.below(60) as u32) * 1e-3);
            let (word, value) = random(&mut seed);
            cycles.extend(panel.pressed_in_time(word, value));
        }
        let mut aborted = false;
        if case % 2 == 1 {
            let cycle = panel.pressed_in_time("abort", None);
            aborted = cycle.is_some();
            cycles.extend(cycle);
        } else {
            let back =
                ["spindle-override", "feed-override", "rapid-override"].map(|knob| (knob, Some(json!(100))));
            for (word, value) in
                back.into_iter().chain([("single-block", Some(json!(false))), ("start", None)])
            {
                cycles.extend(panel.pressed_in_time(word, value));
            }
        }
        assert!(cycles.is_sorted_by(|one, next| one < next), "one press a cycle, in their order: {cycles:?}");
        let (_, summary) = ended(panel);
        assert!(summary.faults.is_empty(), "{case}: {:?}", summary.faults);
        assert!(summary.outcome == Outcome::Completed || aborted, "{case}: {:?}", summary.outcome);
        let kept = std::fs::read_to_string(place.at("session/presses.toml")).expect("what was pressed");
        assert!(cycles.len() > 10 && kept.matches("[[event]]").count() >= cycles.len(), "{case}: {kept}");
        for cycle in cycles {
            assert!(kept.contains(&format!("at = {{ cycle = {} }}", cycle + 1)), "{cycle}: {kept}");
        }
        is_repeated(&place, "session", &summary);
        // A repeated session can be repeated.
        let again = place.at("again").display().to_string();
        let mut command = place.pitchlock();
        command.args(["run", &again, "--json", "--out", "third", "--trace", "none", "--in-process"]);
        let answer = crate::shop::Answer::from(command.output().expect("it runs"));
        let third: Summary = serde_json::from_str(&answer.stdout).expect("a summary");
        assert_eq!(third.trace_hash, summary.trace_hash);
    }
}

/// Something to press. No knob stands at 0 for ever: what follows turns it back.
fn random(seed: &mut Seed) -> (&'static str, Option<Value>) {
    let pct = |seed: &mut Seed, most: f64| Some(json!((seed.between(0.0, most) * 1e3).round() / 1e3));
    match seed.below(8) {
        0 => ("hold", None),
        1 | 2 => ("start", None),
        3 => ("spindle-override", pct(seed, 120.0)),
        4 => ("feed-override", pct(seed, 200.0)),
        5 => ("rapid-override", pct(seed, 100.0)),
        6 => ("single-block", Some(json!(true))),
        _ => ("single-block", Some(json!(false))),
    }
}

/// A pause waits for who stands at the panel, however long; alone it would end after a second.
#[test]
fn a_pause_waits_for_start_and_a_hold_for_whoever_pressed_it() {
    let place = Place::new();
    let program = place.write("pause.ngc", "G21 G90 G8\nG0 X20\n(MSG, measure the bore)\nM0\nG0 X30\nM2\n");
    let panel = watched(&place, &program.display().to_string(), "run", &["--pace", "40"]);
    panel.press("take-seat");
    until("it is a pause", || panel.state()["state"] == "paused");
    let state = panel.state();
    assert_eq!(
        (state["line"].as_u64(), state["messages"][0]["text"].as_str()),
        (Some(4), Some("measure the bore"))
    );
    assert_eq!(state["prompt"], "measure the bore", "what the pause is for is said beside it");
    let since = state["time_s"].as_f64().expect("a time");
    until("three seconds are over", || panel.state()["time_s"].as_f64().is_some_and(|now| now > since + 3.0));
    panel.press("hold");
    until("it is held", || panel.state()["state"] == "held");
    let since = panel.state()["time_s"].as_f64().expect("a time");
    // Where nobody stood at the panel it would be stopped after 60 s.
    until("seventy more", || panel.state()["time_s"].as_f64().is_some_and(|now| now > since + 70.0));
    panel.press("start");
    let (status, summary) = ended(panel);
    assert_eq!((status, summary.outcome, summary.warnings.len()), (Some(0), Outcome::Completed, 0));
    is_repeated(&place, "run", &summary);
}

/// The key of the optional stop is on at the beginning; turned off at the first M1 it lets the second one
/// pass, and the session is repeated as it was.
#[test]
fn an_optional_stop_that_is_turned_off_is_passed() {
    let place = Place::new();
    let text = "G21 G90 G8\nG0 X20\nM1\nG0 X30\nM1\nG0 X25\nM2\n";
    let program = place.write("optional.ngc", text).display().to_string();
    let panel = watched(&place, &program, "run", &["--pace", "5"]);
    panel.press("take-seat");
    until("it waits at the first", || panel.state()["state"] == "paused");
    assert_eq!(panel.state()["optional_stop"], true);
    panel.turn("optional-stop", false);
    until("it is seen", || panel.state()["optional_stop"] == false);
    assert_eq!(panel.state()["state"], "paused", "it waits until somebody goes on");
    panel.press("start");
    let (status, summary) = ended(panel);
    assert_eq!((status, summary.outcome, summary.pauses.len()), (Some(0), Outcome::Completed, 1));
    assert_eq!(summary.pauses[0].line, 3);
    is_repeated(&place, "run", &summary);
}

/// Where the index goes by in a pass the groove is seen: one lead of 2 mm from turn to turn. Where a block
/// leads, what is left of the program, and the pass in hand are known meanwhile.
#[test]
fn what_is_to_come_and_the_groove_are_seen() {
    let place = Place::new();
    let panel = watched(&place, &example("m20x2").display().to_string(), "run", &["--pace", "4"]);
    let number = |value: &Value| value.as_f64().unwrap_or_else(|| panic!("{value} is no number"));
    let (mut state, mut left) = (Value::Null, f64::INFINITY);
    until("a pass is on the helix", || {
        state = panel.state();
        let now = state["left_s"].as_f64().unwrap_or(left);
        assert!(now <= left + 1e-9, "less and less is left: {now} behind {left}");
        left = now;
        let z = &state["axes"][1];
        z["state"] == "locked" && z["to_go_mm"].as_f64().is_some_and(|to_go| to_go < -5.0)
    });
    let z = &state["axes"][1];
    assert!(number(&z["speed_mm_s"]) < 0.0 && number(&z["load_pct"]) < 100.0, "{z}");
    let cutting = &state["cutting"];
    assert_eq!((&cutting["pass"], &cutting["end"]), (&state["pass"], &json!("now")));
    assert_eq!(cutting["depth_mm"], state["depth_mm"]);
    assert!(left > 1.0 && left < number(&state["program"]["time_s"]), "{left} s are left");
    until("three passes are over", || panel.state()["passes"].as_array().is_some_and(|all| all.len() >= 3));
    let state = panel.state();
    let points = state["trail"]["points"].as_array().expect("there is a way").clone();
    let turns: Vec<f64> =
        points.iter().filter(|point| point[1] == 3).map(|point| number(&point[0][1])).collect();
    assert!(turns.len() > 20, "{turns:?}");
    let leads: Vec<f64> = turns.windows(2).map(|two| two[0] - two[1]).filter(|way| *way > 0.0).collect();
    let whole = leads.iter().filter(|lead| (**lead - 2.0).abs() < 0.01).count();
    assert!(whole > 2 * leads.len() / 3, "on the helix each turn is one lead: {leads:?}");
    assert!(state["way"].as_array().is_some_and(|way| way.len() > 50));
    let passes = state["passes"].as_array().expect("there are passes");
    assert!(passes.iter().all(|pass| number(&pass["depth_mm"]) > 0.0));
    panel.press("take-seat");
    panel.press("abort");
    let (status, summary) = ended(panel);
    assert_eq!((status, summary.outcome), (Some(1), Outcome::Stopped));
}

#[test]
fn ctrl_c_beside_a_panel_is_part_of_the_session() {
    let place = Place::new();
    let panel = watched(&place, &example("m20x2").display().to_string(), "run", &["--pace", "10"]);
    panel.press("take-seat");
    panel.turn("spindle-override", 80.0);
    until("a pass is cut", || panel.state()["state"] == "threading");
    signal(panel.launcher.id(), "INT");
    let (status, summary) = ended(panel);
    assert_eq!((status, summary.outcome), (Some(1), Outcome::Stopped));
    is_repeated(&place, "run", &summary);
}

#[test]
fn a_program_is_started_as_often_as_somebody_presses_start() {
    let place = Place::new();
    let program = place.write("short.ngc", "G21 G90 G8\nG0 X20 Z10\nG0 X30\nM2\n");
    let panel =
        Panel::start(&place, &["panel", &program.display().to_string(), "--trace", "none", "--pace", "20"]);
    assert_eq!(panel.state()["state"], "ready");
    assert!(!place.at("runs").exists(), "nothing has moved");
    panel.press("take-seat");
    let hold = panel.ask(&json!({ "id": 1, "do": "hold", "as": "test" }));
    assert_eq!(hold["refused"], "not-running");
    for number in 1..3 {
        panel.press("start");
        let summary = place.at(&format!("runs/short-{number}/summary.json"));
        until("the run is over", || summary.exists() && panel.state()["state"] == "ready");
        let state = panel.state();
        assert_eq!(state["outcome"], "completed");
        let report = place.at(&format!("runs/short-{number}/report.html"));
        let told = std::path::Path::new(state["part"]["report"].as_str().expect("a path"));
        assert_eq!((&state["part"]["verdict"], place.at("").join(told)), (&json!("none"), report));
        assert_eq!(panel.state()["seat"], "test", "who holds the keys goes on holding them");
    }
    let hash = |number: u32| {
        let path = place.at(&format!("runs/short-{number}/summary.json"));
        Summary::read(&path).expect("a summary").trace_hash
    };
    assert_eq!(hash(1), hash(2));
    signal(panel.launcher.id(), "INT");
    let answer = panel.ends();
    // A panel that stays prints nothing, which would wait for a reader.
    assert_eq!((answer.status, answer.stdout.as_str()), (Some(0), ""));
    let said = std::fs::read_to_string(place.at("said.txt")).expect("it is there");
    assert_eq!(said.matches("completed: ").count(), 2, "{said}");
}

/// Zero of the program, and the table of its systems, are told as they are in the block in hand. Keys are
/// shown behind a run as the next one has them.
#[test]
fn zero_is_told_as_it_is_in_force_and_keys_as_the_next_run_has_them() {
    let place = Place::new();
    let text = "G21 G90 G8\nG10 L2 P2 Z-50\nG54\nG0 X20 Z10\nM0\nG55\nM0\nG0 Z12\nG54 G92 Z100\nM0\nM2\n";
    let program = place.write("zero.ngc", text).display().to_string();
    let panel = Panel::start(&place, &["panel", &program, "--trace", "none", "--pace", "20"]);
    let loaded = panel.state()["program"].clone();
    assert!(["passes", "time_s", "folder"].iter().all(|name| loaded.get(name) == Some(&Value::Null)));
    panel.press("take-seat");
    panel.press("start");
    for (line, system, z) in [(5, "G54", 0.0), (7, "G55", -50.0), (10, "G54", -138.0)] {
        until("it waits, with that system", || {
            let state = panel.state();
            state["state"] == "paused" && state["line"] == line && state["offsets"]["in_force"] == system
        });
        let state = panel.state();
        assert_eq!(state["origin_mm"][1], z, "line {line}");
        assert_eq!(state["offsets"]["systems"][1]["Z"], -50.0);
        if line < 10 {
            panel.press("start");
        }
    }
    panel.turn("single-block", true);
    until("it is seen", || panel.state()["single_block"] == true);
    panel.press("abort");
    until("it is off", || panel.state()["mode"] == "off");
    let state = panel.state();
    assert_eq!((&state["single_block"], &state["optional_stop"]), (&json!(false), &json!(true)));
    signal(panel.launcher.id(), "INT");
    assert_eq!(panel.ends().status, Some(0));
}

#[test]
fn what_is_wrong_is_said_before_what_is_warned_of() {
    let place = Place::new();
    let program = place.write("bad.ngc", "G21 G18 G90\nG1 X30 F100\nG1 Z-999\nM2\n").display().to_string();
    let said = place.ask(&["run", &program]).stderr;
    let at = |what: &str| said.find(what).unwrap_or_else(|| panic!("no {what}: {said}"));
    assert!(at("error[") < at("warning["), "{said}");
}

#[test]
fn what_is_not_there_is_said_before_there_is_a_panel() {
    let place = Place::new();
    let program = example("m20x2").display().to_string();
    place.write("other.txt", "");
    for (asked, said) in [
        (&["run", &program, "--panel", "--in-process"][..], "leave out --in-process"),
        (&["run", &program, "--port", "80"], "add --panel"),
        (&["panel", &program, "--panel"], "leave it out"),
        (&["panel", "nowhere.ngc"], "nowhere.ngc"),
        (&["panel", &program, "--out", "."], "other files are in this folder already"),
        (&["panel", &program, "--listen", "192.0.2.1"], "--listen 192.0.2.1"),
    ] {
        let answer = place.ask(asked);
        assert_eq!(answer.status, Some(2), "{asked:?}: {}", answer.stderr);
        assert!(answer.stderr.contains(said), "{asked:?}: {}", answer.stderr);
        assert!(!answer.stderr.contains("panel: http"), "{asked:?}");
    }
    let document = place.ask(&["panel", &program, "--json", "--listen", "192.0.2.1"]);
    let document: Value = serde_json::from_str(&document.stdout).expect("one document");
    assert!(document["error"].is_string(), "{document}");
}
