//! Programs that are begun at a line by `pitchlock run PROGRAM --from LINE`: what is told before anything
//! moves, threads that lie where the whole program cuts them, and what is refused.

use std::path::Path;

use rig::observe::{Outcome, PartVerdict, Summary};
use serde_json::Value;

use crate::shop::{Place, project};

/// Turned, then three passes of a thread, each in lines of its own; line 17 begins the second.
const PROGRAM: &str = "(thread, M20x2-6g)\nG18 G21 G90 G8 G94 G97\n#1 = 9.91\nT1\nM3 S800\nG0 X[#1] Z1\nG1 Z-16 F600\nG1 X12\n\
    G0 Z8\nT3\nM3 S900\nG0 X11 Z8\nG0 X9.3\nG33 Z-14 K2\nG0 X11\nG0 Z8\nG0 X8.8\nG33 Z-14 K2\nG0 X11\nG0 Z8\nM8\n(MSG, the last)\n\
    G0 X8.4255\nG33 Z-14 K2\nG0 X11\nG0 X20\nM5\nM2\n";
/// As near lies a pass to where the whole program cuts it, um.
const SAME_GROOVE_UM: f64 = 1.5;

#[test]
fn a_thread_that_is_begun_in_its_middle_lies_where_the_whole_program_cuts_it() {
    let place = Place::new();
    let program = place.write("screw.ngc", PROGRAM);
    let inside = ["--in-process", "--trace", "none"];
    let whole = place.run(&program, "whole", &inside);
    assert_eq!((whole.from_line, whole.passes.len()), (None, 3));
    let told = place.ask(&["run", "screw.ngc", "--from", "17", "--dry-run"]);
    for words in [
        "with 1 pass of a thread, before line 17, none of them executed",
        "words     G0 G18 G21 G90 G94 G8 G54 F600 S900",
        "variables #1 = 9.91",
        "way       to X 11.000 Z 8.000 mm of the machine (X a radius), rapid",
        "begins    at line 17\n",
        "in force  tool 3, spindle 900.0 1/min, coolant off",
    ] {
        assert!(
            told.status == Some(0) && told.stdout.contains(words),
            "{words}: {}{}",
            told.stdout,
            told.stderr
        );
    }
    assert!(!place.at("runs").exists(), "a dry run writes nothing");
    for (line, passes, coolant) in [("14", 3, false), ("17", 2, false), ("18", 2, false), ("24", 1, true)] {
        let begun = place.run(&program, "begun", &[&inside[..], &["--from", line]].concat());
        assert_eq!((begun.from_line, begun.passes.len()), (line.parse().ok(), passes), "line {line}");
        // Nobody has judged what was cut before.
        assert!(begun.part.verdict == PartVerdict::None && begun.gauge.is_none(), "{:?}", begun.part);
        assert_eq!(begun.messages.len(), usize::from(line != "24"), "line {line}: {:?}", begun.messages);
        for (pass, of) in begun.passes.iter().zip(&whole.passes[3 - passes..]) {
            let law = |pass: &rig::observe::PassReport| {
                (pass.pass, pass.line, pass.c0_deg, pass.delta_c_deg, pass.delta_x_mm, pass.thread_end_deg)
            };
            assert_eq!(law(pass), law(of), "line {line}");
            let apart_um = (pass.tool.phase_um - of.tool.phase_um).abs();
            assert!(apart_um <= SAME_GROOVE_UM, "line {line}, pass {}: {apart_um:.3} um", pass.pass);
        }
        let json = place.ask(&["run", "screw.ngc", "--from", line, "--dry-run", "--json"]);
        let document: Value = serde_json::from_str(&json.stdout).expect("one document");
        assert_eq!(
            document["in_force"].as_str().expect("words").contains("coolant on"),
            coolant,
            "{document}"
        );
        assert_eq!((&document["tool"], &document["variables"]["#1"]), (&3.into(), &9.91.into()));
    }
}

#[test]
fn processes_and_repetitions_begin_at_the_same_line() {
    let place = Place::new();
    let program = place.write("screw.ngc", PROGRAM);
    let hash = |run: &Summary| (run.from_line, run.trace_hash.clone());
    let inside = place.run(&program, "inside", &["--in-process", "--trace", "none", "--from", "23"]);
    let processes = place.run(&program, "processes", &["--from", "23"]);
    assert_eq!(hash(&processes), hash(&inside));
    let again = place.run(Path::new("processes"), "again", &["--trace", "none"]);
    assert_eq!(hash(&again), hash(&inside));
    let replayed = place.ask(&["replay", "processes"]);
    assert_eq!(replayed.status, Some(0), "{}{}", replayed.stdout, replayed.stderr);
    // The whole program of the same folder is another run.
    let whole = place.run(Path::new("processes"), "whole", &["--trace", "none", "--from", "1"]);
    assert!(whole.passes.len() == 3 && whole.outcome == Outcome::Completed);
}

#[test]
fn what_cannot_be_begun_is_refused_and_nothing_is_written() {
    let place = Place::new();
    place.write("screw.ngc", PROGRAM);
    let abort = "[[event]]\nat = { pass = 2, z_mm = -5.0 }\nabort = true\n";
    place.write("abort.toml", abort);
    let job = project().join("examples/shape/wave.toml").display().to_string();
    let mill = project().join("examples/machines/small-mill.toml").display().to_string();
    for (arguments, words) in [
        (&["run", "screw.ngc", "--from", "28"][..], "from line 28 on nothing moves any more"),
        (&["run", "screw.ngc", "--from", "99"], "comes to its end before line 99"),
        (&["run", "screw.ngc", "--from", "0"], "0 is not in 1.."),
        (&["run", "screw.ngc", "--dry-run"], "add --resume, or --from LINE"),
        (&["run", "screw.ngc", "--from", "17", "--resume"], "cannot be used with"),
        (&["run", &job, "--machine", &mill, "--from", "3"], "has no lines to begin at"),
    ] {
        let refused = place.ask(arguments);
        let said = refused.status == Some(2) && refused.stderr.contains(words);
        assert!(said && !place.at("runs").exists(), "{arguments:?}: {}", refused.stderr);
    }
    let broken =
        ["run", "screw.ngc", "--in-process", "--trace", "none", "--from", "13", "--scenario", "abort.toml"];
    assert_eq!(place.ask(&[&broken[..], &["--out", "broken"]].concat()).status, Some(1));
    let refused = place.ask(&["run", "broken", "--resume"]);
    assert!(
        refused.status == Some(2) && refused.stderr.contains("was begun at line 13"),
        "{}",
        refused.stderr
    );
}
