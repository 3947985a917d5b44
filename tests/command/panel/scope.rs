//! The scope: every control cycle is in it, its files hold them bit for bit and are opened again, and what it
//! refuses.

use std::fs;

use serde_json::json;

use super::{client::Panel, playback::THREAD};
use crate::shop::{Place, until};

/// The lines of a trace from a cycle on.
fn from_cycle(text: &str, cycle: u64) -> Vec<&str> {
    let is_later = |line: &&str| line.split(',').next().and_then(|cell| cell.parse().ok()) >= Some(cycle);
    text.lines().skip(1).filter(is_later).collect()
}

/// A run that goes on while it is watched: what the scope has of it is what its trace has, without a gap. Its
/// file is opened again, and has the same.
#[test]
fn every_cycle_of_a_run_is_in_the_scope_and_in_its_files() {
    let place = Place::new();
    fs::write(place.at("thread.ngc"), THREAD).expect("room");
    let arguments = ["panel", "thread.ngc", "--pace", "4", "--trace", "full-csv", "--out", "made"];
    let panel = Panel::start(&place, &arguments);
    panel.press("take-seat");
    panel.press("start");
    until("it is over", || panel.state()["outcome"] == "completed");
    let trace = fs::read_to_string(place.at("made/trace.csv")).expect("a trace");
    until("its last cycles have come", || {
        let kept = panel.file("/api/scope.csv?from=0&to=9999999");
        kept.ends_with(trace.lines().last().map(|line| format!("{line}\n")).unwrap_or_default().as_bytes())
    });
    let kept = String::from_utf8(panel.file("/api/scope.csv?from=0&to=9999999")).expect("text");
    assert_eq!(kept.lines().next(), trace.lines().next());
    let first = kept.lines().nth(1).and_then(|line| line.split(',').next()?.parse().ok()).expect("a cycle");
    assert!(first < 200, "{first}");
    assert!(from_cycle(&kept, first) == from_cycle(&trace, first), "not every cycle is there as it was");
    let part = String::from_utf8(panel.file("/api/scope.csv?from=1000&to=1009")).expect("text");
    assert!(part.lines().skip(1).eq(trace.lines().skip(1001).take(10)), "{part}");
    fs::write(place.at("saved.mcap"), panel.file("/api/scope.mcap?from=0&to=9999999")).expect("room");
    let again = Panel::start(&place, &["panel", "saved.mcap"]);
    until("all of it is there", || {
        again.state()["mode"] == "playback"
            && again.request("GET /api/scope.csv?from=0&to=9", "", "").0 == 200
            && again.file("/api/scope.csv?from=0&to=9999999") == kept.as_bytes()
    });
}

#[test]
fn the_scope_refuses_what_it_cannot_show() {
    let place = Place::new();
    fs::write(place.at("part.csv"), "cycle,t_s\n1,2\n").expect("room");
    let answer = place.ask(&["panel", "part.csv"]);
    assert!(answer.status == Some(2) && answer.stderr.contains("part.csv"), "{}", answer.stderr);
    let panel = Panel::start(&place, &["panel", "--trace", "none"]);
    let file = "GET /api/scope.csv?from=0&to=9";
    assert_eq!(panel.bare(file, "", "").0, 401);
    assert_eq!(panel.request(file, "", "").0, 404, "nothing has run");
    for wrong in ["", "?from=0", "?from=0&to=-1", "?from=0&to=1&more=1", "?to=1&from=0", "?from=0&to=1e9"] {
        assert_eq!(panel.request(&format!("GET /api/scope.csv{wrong}"), "", "").0, 400, "{wrong}");
    }
    assert_eq!(panel.request("POST /api/scope.csv?from=0&to=9", "", "").0, 405);
    let mut socket = panel.socket();
    let mut told = |scope: serde_json::Value| {
        socket.say(&json!({ "scope": scope }));
        loop {
            let news = socket.next().expect("it lives");
            if let Some(scope) = news.get("scope") {
                break scope.clone();
            }
        }
    };
    let asked = json!({ "signals": ["z_true"], "x": "time", "mode": "roll", "span": 1, "points": 500 });
    assert_eq!(told(asked.clone()), "set");
    // More than eight scopes at once are not drawn; one that is closed makes room.
    let mut others: Vec<_> = (0..8).map(|_| panel.socket()).collect();
    let refused = others.iter_mut().map(|socket| {
        socket.say(&json!({ "scope": asked }));
        std::iter::from_fn(|| socket.next()).find_map(|news| news.get("scope").cloned()).expect("an answer")
    });
    let refused: Vec<_> = refused.filter(|told| told["refused"] == "too-many").collect();
    assert_eq!(refused.len(), 1);
    let mut wrong = asked;
    wrong["points"] = json!(1_000_000);
    assert_eq!(told(wrong)["refused"], "bad-value");
    assert_eq!(told(json!(null)), "set");
    panel.is_well();
}
