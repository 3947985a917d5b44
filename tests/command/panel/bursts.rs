//! The panel in a terminal where things go wrong: keys that come in a burst, a terminal that is small, that
//! goes away or can show nothing, a panel that cannot begin.

use std::fs;

use ratatui::{crossterm::event::KeyCode, layout::Size};
use serde_json::{Value, json};
use terminal::Desk;

use super::{
    client::Panel,
    terminal::{Pseudo, desk, drawn, press, ready, text},
};
use crate::shop::{Place, example, signal, until};

/// Keys that come all at once, as when a connection was slow: the hold behind them is taken.
#[test]
fn a_hold_behind_many_keys_is_taken() {
    let place = Place::new();
    let program = example("m20x2").display().to_string();
    let panel =
        Panel::start(&place, &["run", &program, "--panel", "--trace", "none", "--json", "--pace", "1"]);
    let command =
        format!("PITCHLOCK_PANEL='http://{}/#{}' pitchlock panel --join", panel.address, panel.token);
    let Some(mut pseudo) = Pseudo::run(&place, &command) else { return };
    until("it is drawn", || text(&place, "picture").contains("live"));
    pseudo.types("k");
    until("the seat is taken", || panel.state()["seat"].is_string());
    pseudo.types(&("b".repeat(61) + "fffff" + "k".repeat(4).as_str() + " "));
    until("it is held", || panel.state()["held"] == true);
    let state = panel.state();
    let seen = (&state["single_block"], &state["knobs"]["feed_pct"], state["seat"].is_string());
    assert_eq!(seen, (&json!(true), &json!(50.0), true), "each key counts from the one before");
    pseudo.types("q");
    until("it is left", || !text(&place, "behind").is_empty());
}

/// A panel that cannot begin says why in the terminal, with the status that it has elsewhere.
#[test]
fn what_cannot_begin_in_a_terminal_is_told() {
    for (arguments, part) in [("nosuch.ngc", "nosuch.ngc"), ("--machine nosuch.toml", "nosuch.toml")] {
        for _ in 0..3 {
            let place = Place::new();
            let Some(_pseudo) = Pseudo::run(&place, &format!("pitchlock panel --terminal {arguments}"))
            else {
                return;
            };
            until("it has ended", || !text(&place, "behind").is_empty());
            assert_eq!(text(&place, "status").trim(), "2", "{arguments}");
            // script(1) writes it down when it comes to it.
            until("it is told", || text(&place, "picture").contains(part));
        }
    }
}

/// What keys ask for, one by one.
fn asked(desk: &mut Desk) -> Vec<(u64, String, Value)> {
    let of = |one: Value| {
        let word = one["do"].as_str().unwrap_or_default().to_owned();
        (one["id"].as_u64().expect("a number"), word, one["value"].clone())
    };
    desk.asks().into_iter().map(of).collect()
}

/// Keys that come before what the one before did is seen count from what that one asked for, until it is
/// seen or refused.
#[test]
fn a_key_counts_from_what_the_key_before_it_asked_for() {
    let mut desk = desk(ready());
    desk.hears(json!({ "cycle": 100, "knobs": { "feed_pct": 100.0 } }));
    let turns = |desk: &mut Desk, keys: &str| {
        for key in keys.chars() {
            press(desk, KeyCode::Char(key), 0);
        }
        asked(desk)
    };
    let values = |asked: &[(u64, String, Value)]| asked.iter().map(|one| one.2.clone()).collect::<Vec<_>>();
    let first = turns(&mut desk, "FFFfb1b");
    let wanted =
        [json!(110.0), json!(120.0), json!(130.0), json!(120.0), json!(true), json!(false), json!(false)];
    assert_eq!(values(&first), wanted);
    // The first of them is answered and seen: the last one is still on its way.
    desk.hears(json!({ "id": first[0].0, "cycle": 101 }));
    desk.hears(json!({ "cycle": 120, "knobs": { "feed_pct": 110.0 } }));
    assert_eq!(values(&turns(&mut desk, "F")), [json!(130.0)]);
    // One that is taken in a cycle is seen in a later one.
    let last = turns(&mut desk, "F");
    assert_eq!(values(&last), [json!(140.0)]);
    desk.hears(json!({ "id": last[0].0, "cycle": 130 }));
    desk.hears(json!({ "cycle": 130, "knobs": { "feed_pct": 110.0 } }));
    assert_eq!(values(&turns(&mut desk, "F")), [json!(150.0)]);
    desk.hears(json!({ "id": last[0].0 + 1, "cycle": 131 }));
    desk.hears(json!({ "cycle": 140, "knobs": { "feed_pct": 75.0 } }));
    let refused = turns(&mut desk, "F");
    assert_eq!(values(&refused), [json!(85.0)], "somebody else has turned it since");
    desk.hears(json!({ "id": refused[0].0, "refused": "not-your-seat", "why": "somebody holds the keys" }));
    assert_eq!(values(&turns(&mut desk, "F")), [json!(85.0)], "what was refused is not counted");
    // The keys of the machine are taken, given back, taken.
    let words: Vec<_> = turns(&mut desk, "kkk").into_iter().map(|one| one.1).collect();
    assert_eq!(words, ["take-seat", "leave-seat", "take-seat"]);
    desk.gone("it was killed");
    desk.connected();
    assert_eq!(values(&turns(&mut desk, "F")), [json!(85.0)], "nothing of before will be answered");
}

/// Where too little is seen, keys do nothing and say why, but those that bring the machine to rest.
#[test]
fn keys_that_nobody_sees_do_nothing_but_those_that_stop() {
    for (key, word) in [(' ', "hold"), ('S', "stop"), ('A', "abort"), ('E', "emergency-stop")] {
        for size in [Size::new(71, 40), Size::new(100, 19)] {
            let mut desk = desk(ready());
            // A line that was being typed is not seen either.
            press(&mut desk, KeyCode::Char('m'), 0);
            desk.is_drawn_on(size);
            for other in "ksbvFro1tjm:pw,".chars().map(KeyCode::Char).chain([KeyCode::Left, KeyCode::Left]) {
                press(&mut desk, other, 0);
                assert_eq!(asked(&mut desk), [], "{other:?}");
            }
            let rows = drawn(&desk, size.width, size.height).join(" ");
            assert!(
                ["72 by 20 characters at least", "this key acts", "here act: space hold, S stop"]
                    .iter()
                    .all(|part| rows.contains(part)),
                "{rows}"
            );
            press(&mut desk, KeyCode::Char(key), 0);
            assert_eq!(asked(&mut desk).first().map(|one| one.1.as_str()), Some(word));
            assert_eq!(press(&mut desk, KeyCode::Char('c'), 0), terminal::Act::End);
            desk.is_drawn_on(Size::new(72, 20));
            press(&mut desk, KeyCode::Char('s'), 0);
            assert_eq!(asked(&mut desk).len(), 1, "large enough");
        }
    }
}

fn typed(desk: &mut Desk, text: &str) {
    for letter in text.chars() {
        press(desk, KeyCode::Char(letter), 0);
    }
}

/// Why a block is refused is read to its end while the next one is typed, and how a part became.
#[test]
fn why_a_block_is_refused_is_read_while_the_next_one_is_typed() {
    let why = "line 1: a feed in mm/min is missing: G94 G1 needs F, as in G1 X10 F100, and none was given \
               so far; or take G95, and F in mm/rev";
    for (width, height) in [(72, 20), (110, 34)] {
        let mut desk = desk(ready());
        typed(&mut desk, "mG1 X10");
        press(&mut desk, KeyCode::Enter, 0);
        let id = asked(&mut desk)[0].0;
        desk.hears(json!({ "id": id, "refused": "bad-block", "why": why }));
        typed(&mut desk, "G1 X11");
        let rows = drawn(&desk, width, height);
        assert!(rows.iter().any(|row| row.starts_with("block> G1 X11")), "{rows:#?}");
        assert!(rows.join(" ").contains("and F in mm/rev"), "{rows:#?}");
        let part = json!({ "verdict": "bad", "words": ["M20x2-6g not good: too thin"], "report": "r" });
        desk.hears(json!({ "mode": "off", "state": "ready", "part": part }));
        let rows = drawn(&desk, width, height).join(" ");
        assert!(rows.contains("the part is not good: M20x2-6g not good: too thin"), "{rows}");
    }
}

/// The feed of jogs that keys choose is one that the machine has.
#[test]
fn the_feed_of_jogs_goes_as_high_as_the_fastest_axis() {
    let mut desk = desk(ready());
    for _ in 0..9 {
        press(&mut desk, KeyCode::Char('.'), 0);
    }
    assert!(drawn(&desk, 100, 30).iter().any(|row| row.contains("jog while pressed, 500 mm/min")));
    for _ in 0..20 {
        press(&mut desk, KeyCode::Char(','), 0);
    }
    assert!(drawn(&desk, 100, 30).iter().any(|row| row.contains("jog while pressed, 1 mm/min")));
}

/// The process of this place that joins a panel.
fn client_of(place: &Place) -> Option<u32> {
    let here = fs::canonicalize(place.at(".")).expect("it is there");
    let processes = fs::read_dir("/proc").expect("there are processes").flatten();
    processes.into_iter().find_map(|process| {
        let inside = fs::read_link(process.path().join("cwd")).is_ok_and(|of| of == here);
        let arguments = fs::read(process.path().join("cmdline")).unwrap_or_default();
        let program = arguments.split(|byte| *byte == 0).next().unwrap_or_default();
        let joins = program.ends_with(b"pitchlock") && arguments.ends_with(b"\0--join\0");
        (inside && joins).then(|| process.file_name().to_str()?.parse().ok()).flatten()
    })
}

/// The address is asked for; what stands behind # is not shown; Ctrl-C and SIGTERM end that, and the
/// terminal is as it was.
#[test]
fn an_address_is_asked_for_without_showing_its_secret() {
    let at = "http://127.0.0.1:9/#c0ffee";
    for (keys, status, part) in [
        (format!("{at}\r"), "2", "http://127.0.0.1:9/: "),
        ("127.0.0.x\u{7f}1:9#c0ffee\r".into(), "2", "127.0.0.1:9\" is not the address"),
        (format!("{at}\u{3}"), "0", "address of the panel"),
        ("TERM".into(), "0", "address of the panel"),
    ] {
        let place = Place::new();
        let Some(mut pseudo) = Pseudo::run(&place, "pitchlock panel --join") else { return };
        until("it asks", || text(&place, "picture").contains("is not shown: "));
        if keys == "TERM" {
            signal(client_of(&place).expect("it asks"), "TERM");
        } else {
            pseudo.types(&keys);
        }
        until("it has ended", || !text(&place, "behind").is_empty());
        until("it is told", || text(&place, "picture").contains(part));
        assert_eq!((text(&place, "status").trim(), text(&place, "before")), (status, text(&place, "behind")));
        assert!(!text(&place, "picture").contains("c0ffee"), "the secret is not shown");
    }
}

/// A terminal that is closed takes its client with it, which ends and does not break off.
#[test]
fn a_client_ends_with_its_terminal() {
    let place = Place::new();
    let program = example("m20x2").display().to_string();
    let panel = Panel::start(&place, &["panel", &program, "--trace", "none"]);
    // The shell stays, to write the status down.
    let command = format!(
        "trap '' HUP; PITCHLOCK_PANEL='http://{}/#{}' pitchlock panel --join",
        panel.address, panel.token
    );
    let Some(pseudo) = Pseudo::run(&place, &command) else { return };
    until("it is drawn", || text(&place, "picture").contains("live"));
    drop(pseudo);
    until("it has ended", || !text(&place, "status").is_empty());
    let status = text(&place, "status");
    assert!(["0", "1"].contains(&status.trim()), "no signal has ended it: {status}");
    assert_eq!(panel.state()["mode"], "off", "the panel goes on");
}

/// A terminal whose cursor does not move is told before it is written on.
#[test]
fn a_terminal_that_can_show_nothing_is_told() {
    let place = Place::new();
    let Some(_pseudo) = Pseudo::run(&place, "TERM=dumb pitchlock panel --join") else { return };
    until("it has ended", || !text(&place, "behind").is_empty());
    assert_eq!(text(&place, "status").trim(), "2");
    until("it is told", || text(&place, "picture").contains("TERM=dumb is a terminal"));
}
