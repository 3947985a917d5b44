//! Runs of a mill whose processes are all killed in seeded cycles, gone on with by `run RUN_DIR --resume`:
//! with the move that was broken off, from above; a tool that was changed comes down as deep as the one
//! before.

use std::path::Path;

use rig::observe::{Outcome, Summary};
use serde_json::Value;
use testing::Seed;

use crate::{resume::killed, shop::Place};

/// A slot with corners that are rounded, a circle, a hole; another tool and a line.
const PROGRAM: &str = "G17 G21 G90 G94 G64 P0.01\nT1 M6 G43\nM3 S3000\nG0 X30 Y0\nG0 Z3\nG1 Z-2 F400\nG1 X-30 F900\nG1 Y20\nG1 X30\n\
    G3 X30 Y20 I-10 J0\nG0 Z5\nG98 G83 X-40 Y-30 Z-8 R2 Q3 F300\nG80\nG0 Z20\nM5\nT2 M6 G43\nM3 S4000\nM8\nG0 X-50 Y-40\nG0 Z3\n\
    G1 Z-1.5 F300\nG1 X50 F900\nG1 Z2\nG0 Z20\nM9\nM5\nM2\n";
const KILLS: u64 = 5;

fn ready(place: &Place, z_mm: f64) -> String {
    place.write("mill.toml", machine::SMALL_MILL);
    place.write("shop.tbl", format!("T1 P1 Z{z_mm:.3} D6\nT2 P2 Z2.0 D6\n"));
    place.write("plate.ngc", PROGRAM).display().to_string()
}

#[test]
fn a_mill_whose_processes_are_killed_finishes_its_program() {
    let place = Place::new();
    let program = ready(&place, 1.0);
    let shop = ["--machine", "mill.toml", "--tools", "shop.tbl"];
    let whole =
        place.run(Path::new(&program), "whole", &[&["--in-process", "--trace", "none"], &shop[..]].concat());
    assert_eq!(whole.outcome, Outcome::Completed, "{:?}", whole.faults);
    let (mut random, mut gone_on) = (Seed::new(242), 0);
    for number in 0..testing::count("PITCHLOCK_CUTS", KILLS) {
        let at = random.within(1..whole.cycles);
        let how: &[&str] = if number % 4 == 0 { &[] } else { &["--in-process"] };
        if !killed(&place, at, &[how, &[program.as_str()], &shop].concat()) {
            continue;
        }
        place.clear("on");
        let answer = place.ask(&["run", "run", "--resume", "--out", "on", "--trace", "none"]);
        if answer.stderr.contains("came to its end") {
            continue;
        }
        assert_eq!(answer.status, Some(0), "cycle {at}: {}", answer.stderr);
        let on = Summary::read(&place.at("on/summary.json")).expect("it has one");
        assert_eq!((on.outcome, &on.faults[..]), (Outcome::Completed, &[][..]), "cycle {at}");
        let contour_um = on.moves.contour_max_um;
        assert!(contour_um < 20.0, "cycle {at}: {contour_um} um from the path");
        gone_on += 1;
    }
    assert!(gone_on > 0, "all came to their end");
}

/// What it says, and where a longer tool goes.
#[test]
fn a_tool_of_a_mill_that_was_changed_comes_down_as_deep_as_the_one_before() {
    let place = Place::new();
    let program = ready(&place, 1.0);
    let scenario = "[[event]]\nat = { line = 8 }\nabort = true\n";
    let scenario = place.write("abort.toml", scenario).display().to_string();
    let first = place.ask(&[
        "run",
        &program,
        "--in-process",
        "--machine",
        "mill.toml",
        "--tools",
        "shop.tbl",
        "--scenario",
        &scenario,
        "--trace",
        "none",
        "--out",
        "first",
    ]);
    assert_eq!(first.status, Some(1), "{}", first.stderr);
    let told = |more: &[&str]| {
        let answer = place.ask(&[&["run", "first", "--resume", "--dry-run", "--json"], more].concat());
        assert_eq!(answer.status, Some(0), "{}", answer.stderr);
        let told: Value = serde_json::from_str(&answer.stdout).expect("one document");
        let way = told["way"].as_array().expect("a list").iter().map(|move_| move_.to_string());
        way.collect::<Vec<_>>()
    };
    let way = told(&[]);
    let [up, over, down] = &way[..] else { panic!("{way:?}") };
    assert!(up.contains("Z 45.000 mm") && over.contains("Z 45.000 mm"), "{way:?}");
    assert!(down.contains("Z -1.000 mm of the machine, 400 mm/min"), "{way:?}");
    let new = place.write("new.tbl", "T1 P1 Z1.5 D6\nT2 P2 Z2.0 D6\n").display().to_string();
    let way = told(&["--tools", &new]);
    assert!(
        way.last().is_some_and(|down| down.contains("Z -0.500 mm of the machine, 400 mm/min")),
        "{way:?}"
    );
    assert_eq!(way.len(), 3, "{way:?}");
    let on = place.ask(&["run", "first", "--resume", "--tools", &new, "--out", "on", "--trace", "none"]);
    assert_eq!(on.status, Some(0), "{}", on.stderr);
    assert_eq!(Summary::read(&place.at("on/summary.json")).expect("it has one").outcome, Outcome::Completed);
}
