//! Tool noses, inches, and the other dialect where both say the same.

use super::recorded::{fanuc, linuxcnc, moves, run};
use gcode::canon::Units;
use gcode::files::ToolTable;
use gcode::{Dialect, Options, Program};

fn with_tools(options: Options) -> Options {
    Options { tools: ToolTable::parse("tools", "T1 D1.6 Q2\n").expect("a table"), ..options }
}

#[test]
fn the_nose_is_compensated_in_g70_as_in_plain_moves() {
    let contour = "N10 G42 G00 X20. Z1.\nN20 G01 Z-10. F0.1\nN30 X30. W-5.\nN40 Z-20.\nN50 G40 X42.\n";
    let start = "T0101\nS500 M03\nG00 X44. Z3.\n";
    let plain = format!("{start}{contour}M30\n");
    let cycle = format!("{start}G71 U2. R0.5\nG71 P10 Q50 U0.4 W0.1 F0.3\n{contour}G70 P10 Q50\nM30\n");
    let run = |text: String| {
        let outcome = run(Program::from_text("O1", text, &with_tools(fanuc())));
        assert!(outcome.errors.is_empty(), "{:?}", outcome.errors);
        outcome.sink.moves
    };
    let (plain, cycle) = (run(plain), run(cycle));
    assert_eq!(plain[1..], cycle[cycle.len() - plain.len()..cycle.len() - 1]);
    assert_ne!(plain[2], "G1 10 -10", "the cone moves its beginning");
}

#[test]
fn the_nose_is_compensated_as_in_the_other_dialect() {
    let there = "G18 G7 G95\nT1 M6 G43\nS500 M3\nG0 X44 Z3\nG42 G0 X20 Z1\nG1 Z-10 F0.1\nX30 Z-15\nZ-20\nG40 X42\nM2\n";
    let here =
        "T0101\nS500 M03\nG00 X44. Z3.\nG42 G00 X20. Z1.\nG01 Z-10. F0.1\nX30. Z-15.\nZ-20.\nG40 X42.\nM30\n";
    let moves = |text, dialect| {
        let options = with_tools(Options { dialect, ..Options::default() });
        let outcome = run(Program::from_text("O1", text, &options));
        assert!(outcome.errors.is_empty(), "{:?}", outcome.errors);
        outcome.sink.moves
    };
    assert_eq!(moves(here, Dialect::Fanuc), moves(there, Dialect::Linuxcnc));
}

/// A contour for a tool whose radius nobody has said is cut beside where it should be, without a word.
#[test]
fn compensation_of_nothing_is_warned_of() {
    let warned = |text: &str, options: &Options| {
        let outcome = run(Program::from_text("O1", text, options));
        assert!(outcome.errors.is_empty(), "{:?}", outcome.errors);
        let of = |found: &gcode::Diagnostic| (found.line, found.column, found.help.contains("--tools"));
        outcome.warnings.iter().filter(|found| found.code == "no-radius").map(of).collect::<Vec<_>>()
    };
    let here = "T0101\nS500 M03\nG42 G01 X40. Z2. F0.2\nG40 G00 X50.\nM30\n";
    assert_eq!(warned(here, &fanuc()), [(3, 1, true)]);
    assert_eq!(warned(here, &with_tools(fanuc())), []);
    let there = "G18\nS500 M3 F100\nT1 M6\nG42\nG1 X40 Z2\nG40\nG0 X50\nM2\n";
    let table =
        Options { tools: ToolTable::parse("tools", "T1 Z3\n").expect("a table"), ..Options::default() };
    assert_eq!(warned(there, &table), [(4, 1, false)]);
    assert_eq!(warned(there, &with_tools(Options::default())), []);
    let point = "G18\nS500 M3 F100\nG42.1 D0\nG1 X40 Z2\nG40\nG0 X50\nM2\n";
    assert_eq!(warned(point, &Options::default()), [(3, 7, false)]);
}

#[test]
fn inches_keep_their_place() {
    assert_eq!(moves("G00 X50.8 Z25.4\nG20\nU1.\nG04 U1."), ["G0 25.4 25.4", "G0 1.5 1", "dwell 1"]);
    let options = Options { machine_units: Units::Inch, units: Units::Inch, ..fanuc() };
    let outcome = run(Program::from_text("O1", "G00 X20000 W-10000\nM30\n", &options));
    assert_eq!(outcome.sink.moves, ["G0 1 -1"]);
}

#[test]
fn inch_threads_are_the_same_in_both_dialects() {
    let here =
        moves("G20 G97 S400 M03\nG00 X1.2 Z0.3\nG76 P010060 Q0 R0\nG76 X0.8989 Z-1. P0505 Q0120 F0.0769");
    let there = linuxcnc("G20 G97 S400 M3\nG0 X1.2 Z0.3\nG76 P0.0769 Z-1 I-0.2001 J0.024 K0.101 R2 Q30 H1");
    assert_eq!(here[1], there[1]);
}

#[test]
fn g09_stops_its_own_move_of_a_compensated_contour() {
    let contour = |stop: &str| {
        let text =
            format!("T0101\nS500 M03\nG42 G00 X20. Z1.\nG01 Z-10. F0.1\n{stop}Z-20.\nX30.\nG40 X42.\nM30\n");
        let outcome = run(Program::from_text("O1", text, &with_tools(fanuc())));
        assert!(outcome.errors.is_empty(), "{:?}", outcome.errors);
        outcome.sink.moves
    };
    let mut expected = contour("");
    expected.insert(4, "Continuous(0.0)".into());
    expected.insert(3, "ExactStop".into());
    assert_eq!(contour("G09 "), expected);
}

/// Controls with more than 99 offsets have three digits for them.
#[test]
fn an_offset_may_have_three_digits() {
    let table = ToolTable::parse("tools", "T1 Z0\nT13 Z-5\nT2 Z-1\n").expect("a table");
    let at = |text: &str| {
        let options = Options { tools: table.clone(), ..fanuc() };
        let outcome = run(Program::from_text("O1", text, &options));
        let errors: Vec<_> = outcome.errors.iter().map(|error| (error.line, error.code)).collect();
        (outcome.sink.moves, errors)
    };
    let (long, short) = (at("T13002\nG00 Z10.\nM30\n"), at("T1302\nG00 Z10.\nM30\n"));
    assert_eq!(long, short);
    assert_eq!(long.1, []);
    assert_eq!(at("T130020\nM30\n").1, [(1, "bad-value")]);
    assert_eq!(at("G97 S500 M03 P12\nM30\n").1, [(1, "not-available")], "another spindle");
    assert_eq!(at("G97 S500 M03 P11\nG00 X50.\nM05 P11\nM30\n").1, [], "the main spindle");
    assert_eq!(at("G97 S500 M03 P11\nG00 X50.\nM05 P12\nM30\n").1, [(3, "not-available")], "another spindle");
}

#[test]
fn g49_of_a_line_of_safe_codes_does_nothing() {
    let outcome = run(Program::from_text("O1", "G21 G40 G49 G80 G99\nG00 X40. Z2.\nM30\n", &fanuc()));
    assert_eq!(outcome.sink.moves, ["G0 20 2"]);
    let told: Vec<_> = outcome.warnings.iter().map(|warning| (warning.line, warning.code)).collect();
    assert_eq!(told, [(1, "no-effect")]);
}
