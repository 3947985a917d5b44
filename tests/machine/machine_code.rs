//! Machine code that no part program of this release makes: arcs, coolant, pauses, from a `.mc` file to the
//! summary.
#![allow(clippy::unwrap_used)]

use std::path::PathBuf;

use crate::shop::Place;
use machine::Machine;
use protocol::{
    Arc, Code, Feed, Item, PerAxis, Plane, Position, SpindleMode, SpindleSpeed, code_file::CodeFile,
};
use rig::observe::Outcome;

fn point(x: f64, z: f64) -> PerAxis<Position> {
    let mut point = [Position(0); 8];
    (point[0], point[2]) = (Position::from_mm(x), Position::from_mm(z));
    point
}

/// A corner of 2 mm radius about X 18, Z −2, with a pause before it in line 5 and coolant on.
fn program(place: &Place) -> PathBuf {
    let feed = Feed::PerRevolution(0.2);
    let corner = Arc {
        plane: Plane::Zx,
        target: point(20.0, -2.0),
        center: [Position::from_mm(-2.0), Position::from_mm(18.0)],
        turns: 1,
    };
    let codes = [
        Code::Spindle { mode: SpindleMode::Clockwise, speed: SpindleSpeed::Rpm(600.0) },
        Code::Coolant { mist: false, flood: true },
        Code::Line { target: point(10.0, 0.0), feed: Feed::Rapid },
        Code::Line { target: point(18.0, 0.0), feed },
        Code::Pause,
        Code::Arc { arc: corner, feed },
        Code::Line { target: point(20.0, -4.0), feed },
        Code::End,
    ];
    let items = (1..).zip(codes).map(|(line, code)| Item { line, code }).collect();
    let mut bytes = Vec::new();
    CodeFile::new("corner.ngc", &Machine::default().identity(), items).write(&mut bytes).unwrap();
    place.write("corner.mc", bytes)
}

#[test]
fn arcs_and_pauses_are_the_same_over_processes_and_in_one() {
    let place = Place::new();
    let program = program(&place);
    let inside = place.run_inside(&program, None);
    let over_processes = place.run(&program, "processes", &["--trace", "none"]);
    let page = std::fs::read_to_string(place.at("processes/report.html")).unwrap();
    assert!(page.contains("corner.mc") && !page.contains("<h2>The program</h2>"), "machine code is no text");
    for summary in [&inside, &over_processes] {
        assert_eq!((summary.outcome, summary.moves.count), (Outcome::Completed, 4));
        assert_eq!((summary.pauses.len(), summary.pauses[0].line), (1, 5));
        assert!((summary.pauses[0].waited_s - 1.0).abs() < 0.02, "{:?}", summary.pauses);
    }
    assert_eq!(inside.trace_hash, over_processes.trace_hash);
}

#[test]
fn a_pause_is_named_at_the_end_of_the_run() {
    let place = Place::new();
    let program = program(&place).display().to_string();
    let answer = place.ask(&["run", &program, "--in-process", "--trace", "none"]);
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    assert!(answer.stdout.contains("pause     line 5: cycle start after 1.0 s"), "{}", answer.stdout);
}

#[test]
fn an_arc_beyond_the_travel_of_a_machine_that_has_changed_is_refused() {
    let place = Place::new();
    let program = program(&place).display().to_string();
    let changed = machine::SMALL_LATHE.replacen("travel_mm = [-5.0, 120.0]", "travel_mm = [-5.0, 19.0]", 1);
    let changed = changed.replacen("home_mm = 60.0", "home_mm = 15.0", 1);
    let machine = place.write("changed.toml", changed).display().to_string();
    let answer = place.ask(&["run", &program, "--machine", &machine]);
    assert_eq!(answer.status, Some(2), "{}", answer.stdout);
    assert!(answer.stderr.contains("an arc that leaves its travel"), "{}", answer.stderr);
    assert!(answer.stderr.contains("line 6"), "{}", answer.stderr);
}
