//! What a trace keeps of a run that is longer than two minutes.

use std::fs;

use crate::shop::Place;
use rig::observe::Summary;
use rig::trace::{self, FULL, STRIDE};

/// 190 s, with a pass at their end.
const LONG: &str = "G18 G21 G90 G94 G8\nT1 M6\nM3 S600\nG0 X14 Z5\no1 repeat [4]\nG1 X12 F60\nG1 Z-20 F40\n\
                    G0 X14\nG0 Z5\no1 endrepeat\nG0 X14 Z8\nG0 X11\nG33 Z-20 K2\nG0 X14\nG0 Z8\nG1 Z0 F20\n\
                    M5\nM2\n";

/// Cycles of the rows of a trace.
fn cycles(place: &Place, out: &str) -> Vec<u64> {
    let mut cycles = Vec::new();
    trace::read(&place.at(out).join("trace.mcap"), |row| cycles.push(row.cycle)).expect("a trace");
    cycles
}

/// A table of a report, as text.
fn tools(place: &Place, out: &str) -> String {
    let page = fs::read_to_string(place.at(out).join("report.html")).expect("a report");
    let table = page.split("<h2>Tools</h2>").nth(1).and_then(|rest| rest.split("</table>").next());
    table.expect("a table of tools").to_owned()
}

#[test]
fn the_trace_of_another_run_is_not_drawn() {
    let place = Place::new();
    let program = place.write("short.ngc", "G18 G21 G90 G94 G8\nG0 X50 Z90\nG1 X49 F600\nM2\n");
    place.run(&program, "one", &["--in-process", "--trace", "csv"]);
    place.run(&program, "other", &["--in-process", "--trace", "csv", "--seed", "2"]);
    let said = || {
        let answer = place.ask(&["report", "one"]);
        assert_eq!(answer.status, Some(0), "{}", answer.stderr);
        let page = fs::read_to_string(place.at("one/report.html")).expect("a report");
        let words = ["is not the one that this run has written", "is not in its folder any more"];
        let told = words.map(|words| page.contains(words));
        assert_eq!(words.map(|words| answer.stderr.contains(words)), told, "{}", answer.stderr);
        told
    };
    assert_eq!(said(), [false, false]);
    let path = place.at("one/trace.csv");
    let mut own = fs::read(&path).expect("a trace");
    fs::copy(place.at("other/trace.csv"), &path).expect("room");
    assert_eq!(said(), [true, false]);
    // One bit is enough, and the terminal is told as well as the page.
    let at = own.len() / 2;
    own[at] ^= 1;
    fs::write(&path, &own).expect("room");
    assert_eq!(said(), [true, false]);
    fs::remove_file(&path).expect("it is ours");
    assert_eq!(said(), [false, true]);
}

#[test]
fn a_long_run_is_kept_where_it_matters() {
    let place = Place::new();
    let program = place.write("long.ngc", LONG);
    let run = |out: &str, trace: &str| place.run(&program, out, &["--in-process", "--trace", trace]);
    let (thin, full): (Summary, Summary) = (run("thin", "mcap"), run("full", "full"));
    assert_eq!(thin.trace_hash, full.trace_hash, "the hash runs over every cycle");
    assert_eq!(cycles(&place, "full"), (0..full.cycles).collect::<Vec<_>>());
    assert_eq!(tools(&place, "thin"), tools(&place, "full"));

    let kept = cycles(&place, "thin");
    let [pass] = &thin.passes[..] else { panic!("{:?}", thin.passes) };
    assert!(pass.armed_cycle > FULL && thin.cycles > FULL + 120_000, "{} cycles", thin.cycles);
    assert_eq!(kept[..FULL as usize], (0..FULL).collect::<Vec<_>>());
    let of_pass = kept.iter().filter(|cycle| (pass.armed_cycle..=pass.end_cycle).contains(cycle)).count();
    assert_eq!(of_pass as u64, pass.end_cycle - pass.armed_cycle + 1, "every cycle of a pass");
    assert!(kept.windows(2).all(|two| (1..=STRIDE).contains(&(two[1] - two[0]))), "in order, without a gap");
    assert_eq!(kept.last(), Some(&(thin.cycles - 1)));
    let rest = thin.cycles - FULL - of_pass as u64;
    let of_rest = kept.len() as u64 - FULL - of_pass as u64;
    assert!(of_rest < rest * 11 / 100, "{of_rest} of {rest}");

    let bytes = |out: &str| fs::metadata(place.at(out).join("trace.mcap")).expect("a trace").len();
    let saved = bytes("full") - bytes("thin");
    let a_row = bytes("full") / full.cycles;
    assert!(a_row < 320 && saved > (rest - of_rest) * a_row / 2, "{a_row} bytes a row, {saved} saved");
}
