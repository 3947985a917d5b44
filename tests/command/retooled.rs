//! A tool that broke in a thread is changed, and `run RUN_DIR --resume --tools NEW` goes on with the new one:
//! the axes carry it elsewhere, and the thread lies where it lay.

use std::{fs, path::PathBuf};

use rig::observe::{Outcome, PartVerdict, Summary};
use serde_json::Value;

use crate::{
    resume::killed,
    shop::{Answer, Place},
};

/// Turned by one tool, threaded by another, both with their lengths.
const PROGRAM: &str = "(thread, M20x2-6g)\nG18 G21 G90 G8 G94 G97\nT1 M6 G43\nM3 S800\nG0 X9.91 Z1\nG1 Z-16 F600\nG1 X12\nG0 Z8\n\
    T3 M6 G43\nM3 S900\nG0 X11 Z8\nG76 P2 Z-14 I-1.09 J0.8 K1.4845 R2 Q29.5 H1\nG0 X20\nM5\nM2\n";
/// The same as an example, with the table of its shop, and with that of the new insert.
const EXAMPLE: &str = include_str!("../../examples/resumed/screw.ngc");
const TABLE: &str = include_str!("../../examples/resumed/shop.tbl");
const NEW: &str = include_str!("../../examples/resumed/new.tbl");

/// Where the example is broken off.
const ABORT: &str = "{ pass = 3, z_mm = -5.0 }";

/// The new insert stands 0.11 mm farther out and 0.37 mm farther along.
const BY_MM: [f64; 2] = [0.11, 0.37];

/// The built-in lathe, and a soft material: what is cut is felt.
fn soft() -> String {
    machine::SMALL_LATHE.replace("specific_force_n_mm2 = 0.0", "specific_force_n_mm2 = 300.0")
}

/// The run of a program that is aborted where the scenario says.
fn aborted(place: &Place, text: &str, at: &str) {
    broken_off(place, text, at, "abort = true");
}

/// The same, broken off by whatever.
fn broken_off(place: &Place, text: &str, at: &str, by: &str) {
    let program = place.write("screw.ngc", text).display().to_string();
    let table = place.write("shop.tbl", TABLE).display().to_string();
    let scenario = format!("[[event]]\nat = {at}\n{by}\n");
    let scenario = place.write("abort.toml", scenario).display().to_string();
    place.write("lathe.toml", soft());
    place.clear("first");
    let asked =
        ["run", &program, "--in-process", "--tools", &table, "--scenario", &scenario, "--out", "first"];
    let first = place.ask(&[&asked[..], &["--machine", "lathe.toml", "--trace", "none", "--quiet"]].concat());
    assert_eq!(first.status, Some(1), "{}", first.stderr);
}

fn with_table(place: &Place, table: &str, more: &[&str]) -> Answer {
    let path: PathBuf = place.write("new.tbl", table);
    let path = path.display().to_string();
    place.ask(&[&["run", "first", "--resume", "--tools", &path][..], more].concat())
}

/// Where zero of the program lies for the tool of a pass, and where its groove crosses the index, mm of the
/// machine: X, Z, Z.
fn lies(summary: &Summary, pass: u32) -> [f64; 3] {
    let pass = summary.passes.iter().rfind(|other| other.pass == pass).expect("it was cut");
    let [x, z] = pass.origin_mm.expect("it is known");
    [x, z, pass.helix_at_index_mm + 1e-3 * pass.tool.phase_um]
}

#[test]
fn a_tool_that_was_changed_goes_on_in_the_groove_of_the_one_before() {
    let place = Place::new();
    aborted(&place, EXAMPLE, ABORT);
    assert!(
        include_str!("../../examples/resumed/abort.toml").contains(&format!("at = {ABORT}\nabort = true"))
    );
    let before = Summary::read(&place.at("first/summary.json")).expect("it has one");

    let told = with_table(&place, NEW, &["--dry-run"]);
    assert_eq!(told.status, Some(0), "{}", told.stderr);
    for words in
        ["X +0.110 Z +0.370 mm from the one before", "whether the new tool stands where its table says"]
    {
        assert!(told.stdout.contains(words), "{}", told.stdout);
    }
    let told = with_table(&place, NEW, &["--dry-run", "--json"]);
    let document: Value = serde_json::from_str(&told.stdout).expect("one document");
    let by_mm = document["tool_changed_mm"].as_array().expect("it is told");
    for (told, by_mm) in by_mm.iter().zip(BY_MM) {
        assert!((told.as_f64().expect("a number") - by_mm).abs() < 1e-6, "{document}");
    }

    let answer = with_table(&place, NEW, &["--out", "on", "--trace", "none"]);
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    let on = Summary::read(&place.at("on/summary.json")).expect("it has one");
    assert_eq!((on.outcome, on.passes.len(), &on.faults[..]), (Outcome::Completed, 3, &[][..]));
    assert_eq!(on.gauge.as_ref().map(|gauge| gauge.verdict), Some(PartVerdict::Good), "{:?}", on.part);
    // On the part all grooves are one; on the machine they are as far apart as the tools.
    let ([x, z, groove], [new_x, new_z, new_groove]) = (lies(&before, 2), lies(&on, 4));
    assert!((new_x - x - BY_MM[0]).abs() < 1e-6 && (new_z - z - BY_MM[1]).abs() < 1e-6);
    // Infeed along the flank moves every pass: both are held against the run of the old tool.
    place.clear("whole");
    let (program, table) = (place.at("screw.ngc"), place.at("shop.tbl").display().to_string());
    let arguments = ["--in-process", "--machine", "lathe.toml", "--tools", &table, "--trace", "none"];
    let whole = place.run(&program, "whole", &arguments);
    let [_, _, asked] = lies(&whole, 4);
    let apart_um = 1e3 * (new_groove - BY_MM[1] - asked);
    assert!(apart_um.abs() <= 1.5, "{apart_um:.2} um from where the old tool would have cut");
    assert!((groove - lies(&whole, 2)[2]).abs() < 1.5e-3 && on.thread.tool_phase_spread_um <= 1.5);
    // The simulated tool finds the groove that the old one left: it takes what that would have taken.
    let force_n = |summary: &Summary, pass: u32| {
        let pass = summary.passes.iter().rfind(|other| other.pass == pass).expect("it was cut");
        pass.cutting.as_ref().map_or(0.0, |cutting| cutting.force_max_n)
    };
    let [new_n, old_n] = [force_n(&on, 4), force_n(&whole, 4)];
    assert!(old_n > 20.0 && (new_n / old_n - 1.0).abs() < 0.05, "{new_n:.0} N, the old tool {old_n:.0} N");
    // It is made again from its folder, bit for bit.
    let again = place.ask(&["replay", "on"]);
    assert_eq!(again.status, Some(0), "{}{}", again.stdout, again.stderr);
}

/// Between the tools, on the contour of the first one, and with a table that changes nothing.
#[test]
fn a_tool_is_changed_wherever_the_run_was_broken_off() {
    let place = Place::new();
    for (at, passes) in [("{ line = 6 }", 5), ("{ line = 11 }", 5), ("{ pass = 5, z_mm = -9.0 }", 1)] {
        aborted(&place, PROGRAM, at);
        place.clear("on");
        let both = "T1 P1 X0.4 Z1.2\nT3 P3 X-0.09 Z2.37\n";
        let answer = with_table(&place, both, &["--out", "on", "--trace", "none"]);
        assert_eq!(answer.status, Some(0), "{at}: {}", answer.stderr);
        let on = Summary::read(&place.at("on/summary.json")).expect("it has one");
        let verdict = on.gauge.as_ref().map(|gauge| gauge.verdict);
        assert_eq!(
            (on.passes.len(), verdict),
            (passes, Some(PartVerdict::Good)),
            "{at}: {:?}",
            on.part.reasons
        );
        assert!(on.thread.tool_phase_spread_um <= 1.5, "{at}: {:?}", on.thread);
    }
    let told = with_table(&place, TABLE, &["--dry-run"]);
    assert!(told.stdout.contains("changes no move"), "{}", told.stdout);
}

/// The power goes again. Until the journal has seen the new tool put in, the one in the holder is the old
/// one: the way is that of the old one, however often that happens; behind it the new one is known.
#[test]
fn power_that_is_lost_again_while_a_tool_is_changed_leaves_it_known() {
    // Two millimetres shorter: where the new one is clear of its thread, the old one stands deep in it.
    let short = "T1 P1 X0.5 Z1.0\nT3 P3 X-2.2 Z2.37\n";
    let place = Place::new();
    // The regulator that would lift the tool is dead: it stays in its groove.
    broken_off(&place, PROGRAM, "{ pass = 3, z_mm = -5.0 }", "kill = \"regulator-x\"");
    let table = place.write("new.tbl", short).display().to_string();
    let first = ["first", "--resume", "--tools", &table];
    let slowly = ["--pace", "0.05"];
    let is_of_the_old_one = |folder: &str| {
        let told = place.ask(&["run", folder, "--resume", "--dry-run"]);
        assert_eq!(told.status, Some(0), "{}", told.stderr);
        for words in [
            "whether the new tool is in place already",
            "way       to X 10.800 Z",
            "X -2.000 Z +0.370 mm from the one before: put it in where the old one has come out",
        ] {
            assert!(told.stdout.contains(words), "{}", told.stdout);
        }
    };
    assert!(killed(&place, 1, &[&first[..], &slowly].concat()), "it is killed on its way");
    is_of_the_old_one("run");
    fs::rename(place.at("run"), place.at("second")).expect("room");
    assert!(killed(&place, 1, &[&["second", "--resume"][..], &slowly].concat()), "and once more");
    is_of_the_old_one("run");

    let finished = || {
        place.clear("on");
        let answer = place.ask(&["run", "run", "--resume", "--out", "on", "--trace", "none"]);
        assert!(matches!(answer.status, Some(0 | 3)), "{}", answer.stderr);
        let on = Summary::read(&place.at("on/summary.json")).expect("it has one");
        assert_eq!((on.outcome, &on.faults[..]), (Outcome::Completed, &[][..]));
        assert!(on.thread.tool_phase_spread_um <= 1.5, "{:?}", on.thread);
        let [x, z, _] = lies(&on, 5);
        assert!((x + 2.2).abs() < 1e-6 && (z - 2.37).abs() < 1e-6, "X {x} Z {z}");
        let good = on
            .resumed
            .and_then(|resumed| resumed.gauge_without_rings)
            .or(on.gauge.map(|gauge| gauge.verdict));
        assert_eq!(good, Some(PartVerdict::Good), "{:?}", on.part);
    };
    finished();
    let again = place.ask(&["replay", "on"]);
    assert_eq!(again.status, Some(0), "{}{}", again.stdout, again.stderr);

    // In its next pass the new tool is known, and nobody is asked to put it in.
    // At the pace of the machine the journal is at most some cycles behind.
    let as_in_truth = ["--pace", "1"];
    assert!(killed(&place, 3500, &[&first[..], &as_in_truth].concat()), "it is killed behind the change");
    let told = place.ask(&["run", "run", "--resume", "--dry-run"]);
    assert!(told.stdout.contains("tool      3,") && !told.stdout.contains("put it in"), "{}", told.stdout);
    finished();
}

#[test]
fn a_tool_table_that_makes_another_program_is_refused() {
    let place = Place::new();
    aborted(&place, PROGRAM, "{ pass = 3, z_mm = -5.0 }");
    for (table, words) in [
        ("T1 P1 X0.5 Z1.0\nT3 P3 X-0.2 Z9.0\n", "within 5 mm"),
        ("T1 P1 X0.5 Z1.0\n", "T3"),
        ("T1 P1\nT3 P3 Xa\n", "new.tbl"),
    ] {
        let answer = with_table(&place, table, &["--out", "on"]);
        assert!(answer.status == Some(2) && answer.stderr.contains(words), "{words}: {}", answer.stderr);
        assert!(!place.at("on").exists());
    }
    // With another nose the contour is another one, and nobody knows what of it was cut.
    let nosed = "G42 G0 X8.91 Z1\nG1 Z-5 F600\nG1 X9.91 Z-16\nG40";
    let nosed = PROGRAM.replace("G0 X9.91 Z1\nG1 Z-16 F600", nosed);
    aborted(&place, &nosed, "{ pass = 3, z_mm = -5.0 }");
    let blunt = TABLE.replace("Z1.0", "Z1.0 D1.6 Q2").replace("Z2.0", "Z2.1");
    let answer = with_table(&place, &blunt, &["--out", "on"]);
    let words = "only X and Z of its tools may differ";
    assert!(answer.status == Some(2) && answer.stderr.contains(words), "{}", answer.stderr);
}

/// A journal of which nothing is left, where another tool may be in the holder: nobody guesses which.
#[test]
fn without_a_journal_nobody_guesses_which_tool_is_in_the_holder() {
    let refused = |place: &Place, folder: &str, words: &str| {
        let path = place.at(folder).join("journal.bin");
        let length = fs::metadata(&path).expect("a journal").len() as usize;
        fs::write(&path, vec![0x5a; length]).expect("room");
        let answer = place.ask(&["run", folder, "--resume", "--out", "on"]);
        assert!(answer.status == Some(2) && answer.stderr.contains(words), "{}", answer.stderr);
        assert!(answer.stderr.contains("from its beginning") && !place.at("on").exists());
    };
    let place = Place::new();
    // Both tools turn over the same place, and it is broken off there.
    let twice =
        PROGRAM.replace("T3 M6 G43\n", "T3 M6 G43\nM3 S900\nG0 X9.91 Z1\nG1 Z-12 F600\nG1 X12\nG0 Z8\n");
    let lengths = TABLE.replace("T3 P3 X-0.2 Z2.0", "T3 P3 X0.5 Z1.0");
    let program = place.write("screw.ngc", &twice).display().to_string();
    let table = place.write("shop.tbl", &lengths).display().to_string();
    let scenario = place.write("abort.toml", "[[event]]\nat = { line = 12 }\nabort = true\n");
    let asked = ["run", &program, "--in-process", "--tools", &table, "--out", "first", "--trace", "none"];
    place.ask(&[&asked[..], &["--scenario", &scenario.display().to_string()]].concat());
    let told = place.ask(&["run", "first", "--resume", "--dry-run"]);
    assert_eq!(told.status, Some(0), "{}", told.stderr);
    refused(&place, "first", "tool 1 in line 5 and tool 3 in line 1");

    // And where it went on with another table than the run before.
    aborted(&place, PROGRAM, "{ pass = 3, z_mm = -5.0 }");
    let new = place.write("new.tbl", NEW).display().to_string();
    assert!(killed(&place, 1, &["first", "--resume", "--tools", &new, "--pace", "0.05"]), "it is killed");
    refused(&place, "run", "went on with another tool table");
}
