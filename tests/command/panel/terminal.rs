//! The panel in a terminal: its keys are requests of the API, its picture is what a run shows, it runs a
//! program to its end in a pseudo-terminal and gives that back as it was.

use std::{
    fs,
    io::Write as _,
    process::{Child, Command, Stdio},
    time::Duration,
};

use ratatui::{
    Terminal,
    backend::TestBackend,
    crossterm::event::{KeyCode, KeyEvent, KeyModifiers},
};
use rig::observe::{Outcome, Summary};
use serde_json::{Value, json};
use terminal::{Act, Desk, Does, KEYS};

use super::client::Panel;
use crate::shop::{Place, example, project, until};

/// A desk that sees a state.
pub(super) fn desk(state: Value) -> Desk {
    let mut desk = Desk::new("terminal-1", false);
    desk.connected();
    desk.hears(state);
    desk
}

/// What is drawn, row by row.
pub(super) fn drawn(desk: &Desk, width: u16, height: u16) -> Vec<String> {
    let mut screen = Terminal::new(TestBackend::new(width, height)).expect("it needs no terminal");
    screen.draw(|frame| terminal::draw(frame, desk)).expect("it is drawn");
    let cells = screen.backend().buffer().content().chunks(usize::from(width));
    cells.map(|row| row.iter().map(|cell| cell.symbol()).collect::<String>().trim_end().to_owned()).collect()
}

pub(super) fn press(desk: &mut Desk, code: KeyCode, ms: u64) -> Act {
    let modifiers = if code == KeyCode::Char('c') { KeyModifiers::CONTROL } else { KeyModifiers::NONE };
    desk.key(&KeyEvent::new(code, modifiers), Duration::from_millis(ms))
}

fn types(desk: &mut Desk, text: &str) {
    text.chars().for_each(|letter| {
        press(desk, KeyCode::Char(letter), 0);
    });
    press(desk, KeyCode::Enter, 0);
}

pub(super) fn ready() -> Value {
    json!({ "mode": "ready", "seat": "somebody", "tool": 3, "single_block": false, "optional_stop": true,
        "knobs": { "spindle_pct": 100.0, "feed_pct": 195.0, "rapid_pct": 5.0 }, "playback": { "speed": 1.0 },
        "machine": { "kinematics": "lathe", "axes": ["X", "Z"], "fastest_jog": [480.0, 500.0] } })
}

/// The table of the page has every key with its request, and no other; and each is one that the panel takes.
#[test]
fn every_key_is_the_request_that_the_page_says() {
    let page = fs::read_to_string(project().join("docs/panel.md")).expect("the page");
    let chapter = page
        .split("\n## In a terminal\n")
        .nth(1)
        .expect("a chapter")
        .split("\n## ")
        .next()
        .unwrap_or_default();
    let rows = chapter.lines().filter(|line| line.starts_with("| `")).map(|line| {
        let cells: Vec<_> =
            line.trim_matches('|').split(" | ").map(|cell| cell.trim().trim_matches('`')).collect();
        (cells[0].to_owned(), cells[1].to_owned())
    });
    let asked = |key: &terminal::Key| {
        let mut desk = desk(ready());
        let act = press(&mut desk, key.code, 0);
        match key.does {
            Does::Block => types(&mut desk, "G0 X1"),
            Does::Order => types(&mut desk, "home Z"),
            // A tap moves nothing: the repeat does.
            Does::Jog(..) => {
                press(&mut desk, key.code, 500);
            }
            _ => {}
        }
        let documents = desk.asks();
        documents.iter().for_each(|document| {
            panel::pressed(document.to_string().as_bytes())
                .unwrap_or_else(|why| panic!("{document}: {}", why.why));
        });
        let asks = documents.iter().map(|document| match &document["value"] {
            Value::Null => document["do"].as_str().unwrap_or_default().to_owned(),
            value => format!("{} {value}", document["do"].as_str().unwrap_or_default()),
        });
        let asks = asks.collect::<Vec<_>>().join(", ");
        match (asks.as_str(), act) {
            ("", Act::Stay) => "–".to_owned(),
            ("", act) => format!("{act:?}").to_lowercase(),
            _ => asks,
        }
    };
    let handled: Vec<_> = KEYS.iter().map(|key| (key.name.to_owned(), asked(key))).collect();
    assert_eq!(rows.collect::<Vec<_>>(), handled);
    // All of them are shown, but those of an axis that is not there.
    let shown = drawn(&desk(ready()), 100, 40).join(" ");
    for key in KEYS.iter().filter(|key| !matches!(key.does, Does::Jog(2, _))) {
        assert!(shown.contains(&format!("{} ", key.name)), "{}: {shown}", key.name);
    }
}

/// A key of an axis is a jog while it repeats, and a step where a length is chosen.
#[test]
fn the_key_of_an_axis_jogs_while_it_repeats_or_makes_one_step() {
    let mut desk = desk(ready());
    let asked = |desk: &mut Desk| {
        desk.asks().iter().map(|one| format!("{} {}", one["do"], one["value"])).collect::<Vec<_>>()
    };
    let mut all = Vec::new();
    for ms in 0..900 {
        if ms == 0 || (400..=520).contains(&ms) && ms % 30 == 10 {
            press(&mut desk, KeyCode::Left, ms);
        }
        desk.beat(Duration::from_millis(ms));
        all.extend(asked(&mut desk));
    }
    assert_eq!(all[0], r#""jog" {"axis":"Z","mm_min":500.0,"way":"-"}"#, "no faster than it may");
    assert_eq!(all.last().map(String::as_str), Some(r#""let-go" null"#));
    assert!(all.len() > 5 && all[1..all.len() - 1].iter().all(|one| one == r#""jog-on" null"#), "{all:?}");
    // A jog that the machine refuses is not confirmed.
    press(&mut desk, KeyCode::Up, 1000);
    press(&mut desk, KeyCode::Up, 1030);
    let id = desk.asks()[0]["id"].clone();
    desk.hears(json!({ "id": id, "refused": "not-your-seat", "why": "somebody holds the keys" }));
    desk.beat(Duration::from_millis(1060));
    assert_eq!(asked(&mut desk), [""; 0]);
    assert!(drawn(&desk, 100, 30).iter().any(|row| row.contains("somebody holds the keys")));
    for _ in 0..3 {
        press(&mut desk, KeyCode::Char('j'), 1100);
    }
    press(&mut desk, KeyCode::Down, 1200);
    assert_eq!(asked(&mut desk), [r#""jog" {"axis":"X","mm_min":600.0,"step_mm":-0.1}"#]);
    desk.hears(json!({ "mode": "jog" }));
    press(&mut desk, KeyCode::Down, 1230);
    assert_eq!(asked(&mut desk), [""; 0], "a repeat while the axis goes is no further step");
}

/// States of a real run: a pass with the running line, what it has measured, messages, a fault with its
/// remedy.
#[test]
fn what_is_drawn_is_what_a_run_shows() {
    let place = Place::new();
    let scenario = "[[event]]\nat = { pass = 3, z_mm = -6.0 }\ndrive_fault = \"z\"\n";
    let scenario = place.write("fault.toml", scenario).display().to_string();
    let program = example("m20x2").display().to_string();
    let panel =
        Panel::start(&place, &["panel", &program, "--trace", "none", "--pace", "4", "--scenario", &scenario]);
    let mut seen = panel.state();
    let loaded = drawn(&desk(seen.clone()), 110, 34);
    assert!(
        loaded[0].starts_with("live  nobody holds the keys  ") && loaded[0].contains("m20x2.ngc"),
        "{loaded:#?}"
    );
    assert!(loaded[1].starts_with("off ") && loaded[1].contains("start starts it"), "{loaded:#?}");
    panel.press("take-seat");
    panel.press("start");
    until("the second pass is cut", || {
        seen = panel.state();
        seen["state"] == "threading" && seen["pass"] == 2 && seen["cutting"].is_object()
    });
    for (width, height) in [(110, 34), (80, 24)] {
        let rows = drawn(&desk(seen.clone()), width, height);
        let has = |part: &str| assert!(rows.iter().any(|row| row.contains(part)), "{part}: {rows:#?}");
        has("test holds the keys: you watch");
        has("auto        pass 2");
        has(&format!(">{:>5} ", seen["line"].as_u64().expect("a line")));
        let z = &seen["axes"][1];
        let of_work = z["measured_mm"].as_f64().expect("mm") - seen["origin_mm"][1].as_f64().expect("mm");
        has(&format!("Z         {of_work:>10.3}"));
        has(&format!("{:.3} deep", seen["depth_mm"].as_f64().expect("mm")));
        has("override  spindle 100 %");
        has("no emergency stop");
    }
    let rows = drawn(&desk(seen.clone()), 110, 34);
    let first = &seen["passes"][0];
    let row = format!(
        "{:<6}{:>8.3}",
        first["pass"].as_u64().expect("a number"),
        first["depth_mm"].as_f64().expect("mm")
    );
    assert!(rows.iter().any(|line| line.starts_with(&row) && line.contains("complete")), "{row}: {rows:#?}");
    until("it is over", || {
        seen = panel.state();
        seen["mode"] == "off"
    });
    assert!(["ended", "ready"].contains(&seen["state"].as_str().expect("a state")), "not what was before");
    let rows = drawn(&desk(seen.clone()), 110, 34).join("\n");
    let fault = &seen["faults"][0];
    assert!(rows.contains(&format!("{}: ", fault["code"].as_str().expect("a code"))), "{rows}");
    let remedy = fault["remedy"].as_str().expect("a remedy").chars().take(80).collect::<String>();
    assert!(!remedy.is_empty() && rows.contains(&remedy), "{remedy}: {rows}");
    assert!(drawn(&desk(seen), 40, 10)[0].contains("72 by 20"), "too small");
}

/// A shell in a pseudo-terminal, with its keyboard.
pub(super) struct Pseudo(Child);

impl Drop for Pseudo {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Pseudo {
    /// Runs a command, and keeps what was set before and behind it.
    pub(super) fn run(place: &Place, command: &str) -> Option<Pseudo> {
        let there =
            Command::new("script").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
        if !there.is_ok_and(|status| status.success()) {
            eprintln!("left out: the panel in a pseudo-terminal: there is no script(1) on this computer");
            return None;
        }
        let binary = place.pitchlock().get_program().to_string_lossy().into_owned();
        let shell = format!(
            "stty rows 34 cols 110; stty -g > before; {}; echo $? > status; stty -g > behind",
            command.replace("pitchlock", &binary)
        );
        let plain = place.pitchlock();
        let mut script = Command::new("script");
        script.args(["-qfec", &shell, "/dev/null"]).current_dir(place.at(".")).env("SHELL", "/bin/sh");
        script.env("TERM", "xterm").envs(plain.get_envs().filter_map(|(name, value)| Some((name, value?))));
        let picture = fs::File::create(place.at("picture")).expect("room");
        let script = script.stdin(Stdio::piped()).stdout(picture).stderr(Stdio::null()).spawn();
        Some(Pseudo(script.expect("it starts")))
    }

    pub(super) fn types(&mut self, keys: &str) {
        let keyboard = self.0.stdin.as_mut().expect("it is piped");
        // One that has ended takes no key.
        let _ = keyboard.write_all(keys.as_bytes()).and_then(|()| keyboard.flush());
    }
}

pub(super) fn text(place: &Place, name: &str) -> String {
    String::from_utf8_lossy(&fs::read(place.at(name)).unwrap_or_default()).into_owned()
}

/// Keys alone: the seat, start, to the end of the program, left. Then the terminal is as it was.
#[test]
fn a_terminal_runs_a_program_to_its_end_and_is_given_back() {
    let place = Place::new();
    place.write("screw.ngc", super::from::PROGRAM);
    let command = "pitchlock panel screw.ngc --terminal --trace none --pace 20";
    let Some(mut pseudo) = Pseudo::run(&place, command) else { return };
    until("it is drawn", || text(&place, "picture").contains("live"));
    pseudo.types("ks");
    until("the run is over", || place.at("runs/screw-1/summary.json").is_file());
    until("it is left", || {
        pseudo.types("q");
        place.at("behind").is_file()
    });
    until("it is written", || !text(&place, "behind").is_empty());
    assert_eq!((text(&place, "status").trim(), text(&place, "before")), ("0", text(&place, "behind")));
    let picture = text(&place, "picture");
    let other = picture.find("\u{1b}[?1049h").expect("it takes the other screen");
    let back = picture.rfind("\u{1b}[?1049l").expect("and gives it back");
    assert!(
        other < back && picture.rfind("\u{1b}[?25h") > picture.rfind("\u{1b}[?25l"),
        "the cursor is there"
    );
    assert!(picture[back..].contains("passes"), "then it is said what came of it: {}", &picture[back..]);
    let summary = Summary::read(&place.at("runs/screw-1/summary.json")).expect("a summary");
    assert_eq!((summary.outcome, summary.passes.len()), (Outcome::Completed, 2));
}

/// Whether a process has this folder for its own.
fn somebody_works_in(place: &Place) -> bool {
    let here = fs::canonicalize(place.at(".")).expect("it is there");
    let processes = fs::read_dir("/proc").expect("there are processes").flatten();
    processes.into_iter().any(|process| fs::read_link(process.path().join("cwd")).is_ok_and(|of| of == here))
}

/// Ctrl-C stops the run, and once more ends the command; so does a terminal that is gone in whatever way.
#[test]
fn a_run_is_stopped_by_its_terminal_and_by_its_death() {
    for kills in [false, true] {
        let place = Place::new();
        let command = format!("pitchlock panel {} --terminal --trace none", example("m20x2").display());
        let Some(mut pseudo) = Pseudo::run(&place, &command) else { return };
        until("it is drawn", || text(&place, "picture").contains("live"));
        pseudo.types("ks");
        until("it runs", || place.at("runs/m20x2-1/journal.bin").is_file());
        if kills {
            pseudo.0.kill().expect("it lives");
        } else {
            pseudo.types("\u{3}");
        }
        until("it is over", || place.at("runs/m20x2-1/summary.json").is_file());
        if !kills {
            until("it is left", || {
                pseudo.types("q");
                place.at("behind").is_file()
            });
        }
        let summary = Summary::read(&place.at("runs/m20x2-1/summary.json")).expect("a summary");
        assert_eq!(summary.outcome, Outcome::Stopped);
        until("nobody is left", || !somebody_works_in(&place));
    }
}

/// Joined by its address; the run that is held by its keys goes on when it is left, and the seat stays taken.
#[test]
fn a_panel_is_joined_by_a_terminal_and_left() {
    let place = Place::new();
    let program = example("m20x2").display().to_string();
    let panel =
        Panel::start(&place, &["run", &program, "--panel", "--trace", "none", "--json", "--pace", "2"]);
    let command =
        format!("PITCHLOCK_PANEL='http://{}/#{}' pitchlock panel --join", panel.address, panel.token);
    let Some(mut pseudo) = Pseudo::run(&place, &command) else { return };
    until("it is drawn", || text(&place, "picture").contains("live"));
    pseudo.types("k f:spindle-override 80\r");
    until("they are pressed", || {
        let state = panel.state();
        state["held"] == true && state["knobs"]["feed_pct"] == 90.0 && state["knobs"]["spindle_pct"] == 80.0
    });
    pseudo.types("q");
    until("it is left", || !text(&place, "behind").is_empty());
    assert_eq!(text(&place, "status").trim(), "0");
    let state = panel.state();
    assert!(state["seat"].as_str().is_some_and(|name| name.starts_with("terminal-")), "{}", state["seat"]);
    panel.press("take-seat");
    panel.press("start");
    let (status, summary) = super::watched::ended(panel);
    assert_eq!((status, summary.outcome), (Some(0), Outcome::Completed));
    assert!(!text(&place, "picture").contains("#"), "the secret is not shown");
}

/// Without a terminal it says so, and what else there is.
#[test]
fn what_is_no_terminal_is_told() {
    let place = Place::new();
    for (arguments, part) in [
        (&["panel", "--terminal"][..], "need a terminal"),
        (&["panel", "--join"][..], "need a terminal"),
        (&["panel", "--terminal", "--json"][..], "leave it out"),
        (&["panel", "--terminal", "--join"][..], "cannot be used with"),
        (&["panel", "--join", "part.ngc"][..], "cannot be used with"),
        (&["panel", "--join", "--pace", "2"][..], "cannot be used with"),
        (&["panel", "--port", "7000", "--join"][..], "cannot be used with"),
    ] {
        let answer = place.ask(arguments);
        assert!(answer.status == Some(2) && answer.stderr.contains(part), "{arguments:?}: {}", answer.stderr);
    }
}

/// A document that is not of a panel, fields of other kinds, any size: it is drawn, and a key does no harm.
#[test]
fn any_document_is_drawn_at_any_size() {
    let place = Place::new();
    let panel = Panel::start(&place, &["panel", &example("m20x2").display().to_string(), "--trace", "none"]);
    let whole = panel.state();
    let mut seed = testing::Seed::new(20);
    for _ in 0..400 {
        let mut state = whole.clone();
        for _ in 0..3 {
            broken(&mut state, &mut seed);
        }
        let mut desk = desk(state);
        desk.hears(json!({ "id": seed.below(3), "why": "\u{1b}[2Jnone\r\n" }));
        press(&mut desk, KEYS[seed.below(KEYS.len())].code, 0);
        let (width, height) = (1 + seed.below(160) as u16, 1 + seed.below(60) as u16);
        let rows = drawn(&desk, width, height);
        assert!(rows.iter().all(|row| !row.contains(|letter: char| letter.is_control())), "{rows:?}");
    }
}

/// One of the values in it is another one.
fn broken(value: &mut Value, seed: &mut testing::Seed) {
    let inside = match value {
        Value::Object(fields) => fields.values_mut().collect(),
        Value::Array(all) => all.iter_mut().collect(),
        _ => Vec::new(),
    };
    let which = seed.below(inside.len().max(1));
    let inside = inside.into_iter().nth(which);
    match inside {
        Some(inside) if seed.below(4) > 0 => broken(inside, seed),
        _ => {
            let others = [
                Value::Null,
                json!(-1e300),
                json!(u64::MAX),
                json!("\u{7}text\u{1b}[31m of a \u{202e}terminal\n"),
                json!([[], {}]),
                json!({ "speed": {}, "text": "a\tb\u{0}", "axes": ["X", 7] }),
            ];
            *value = others[seed.below(others.len())].clone();
        }
    }
}
