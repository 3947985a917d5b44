//! Habits of posts and machinists that mean one thing only, though a manual does not have them.

use super::recorded::{errors, fanuc, moves, outcome, run, sound};
use gcode::Program;
use gcode::files::ToolTable;

/// The moves of a program with a nose of 0.8 mm.
fn with_nose(text: &str) -> Vec<String> {
    let mut options = fanuc();
    options.tools = ToolTable::parse("tools", "T1 D1.6 Q2\nT2 D0.8 Q3\n").expect("a table");
    let outcome = run(Program::from_text("O1", format!("{text}\nM30\n"), &options));
    assert!(outcome.errors.is_empty(), "{:?}", outcome.errors);
    outcome.sink.moves
}

/// The speeds that a program sets.
fn speeds(text: &str) -> Vec<String> {
    let others = sound(text).others;
    others.into_iter().filter(|call| call.starts_with("SetSpindleSpeed")).collect()
}

#[test]
fn g97_without_s_keeps_the_speed_that_the_spindle_has() {
    // 100 m/min at a diameter of 40 mm: 796 rpm
    let text = "G50 S2500\nG96 S100 M03\nG00 X40. Z2.\nG97";
    assert_eq!(speeds(text), ["SetSpindleSpeed(100.0)", "SetSpindleSpeed(796.0)"]);
    assert_eq!(speeds("G50 S500\nG96 S100 M03\nG00 X40. Z2.\nG97")[1], "SetSpindleSpeed(500.0)");
    assert_eq!(
        speeds("G20 G50 S2500\nG96 S300 M03\nG00 X2. Z.1\nG97")[1],
        "SetSpindleSpeed(573.0)",
        "300 ft/min at 2 inch"
    );
    assert_eq!(errors("G96 S100 M03\nG00 X0. Z2.\nG97"), [(3, "missing-word")]);
}

#[test]
fn g90_alone_is_no_cycle_and_g92_s_is_a_highest_speed() {
    let outcome = outcome("G90 G54\nG00 X40. Z2.\nX30.\nM30\n");
    assert!(outcome.errors.is_empty(), "{:?}", outcome.errors);
    assert_eq!(outcome.sink.moves, ["G0 20 2", "G0 15 2"]);
    assert_eq!(outcome.warnings.iter().map(|warning| warning.code).collect::<Vec<_>>(), ["no-effect"]);
    let bounded = |text| sound(text).others.into_iter().find(|call| call.starts_with("SetSpindleMode"));
    assert_eq!(bounded("G92 S1800\nG96 S100 M03"), bounded("G50 S1800\nG96 S100 M03"));
    assert_eq!(errors("G90 R1."), [(1, "missing-word")]);
}

#[test]
fn a_program_may_have_the_number_0_and_a_tool_may_have_m06() {
    assert_eq!(moves("O0000\nG00 X40. Z2."), ["G0 20 2"]);
    assert_eq!(sound("O0000\nT0101 M06\nG00 X40.").others, sound("O0000\nT0101\nG00 X40.").others);
}

#[test]
fn a_dwell_may_have_its_seconds_in_p() {
    assert_eq!(moves("G04 P1.5\nG04 P1500\nG04 X1.5"), ["dwell 1.5"; 3]);
}

#[test]
fn v_moves_nothing_and_may_stand_in_a_way_home() {
    assert_eq!(moves("G00 X40. Z2.\nG28 U0. V0. W0."), moves("G00 X40. Z2.\nG28 U0. W0."));
    assert_eq!(errors("G28 U0. V1."), [(1, "not-available")]);
}

#[test]
fn g40_and_the_end_of_an_offset_in_one_block() {
    let start = "T0101\nS500 M03\nG00 X44. Z3.\nG42 G01 X20. Z1. F0.1\nZ-20.\nX44.\n";
    assert_eq!(
        with_nose(&format!("{start}G00 G40 X60. Z10. T0100")),
        with_nose(&format!("{start}G40\nT0100\nG00 X60. Z10."))
    );
    assert_eq!(errors(&format!("{start}T0100")), [(7, "compensation-on")]);
}

#[test]
fn from_g42_to_g41_is_by_g40() {
    let start = "T0101\nS500 M03\nG00 X44. Z3.\nG42 G01 X20. Z1. F0.1\nZ-20.\nX44.\nG00 X60. Z5.\n";
    let bore = "X10. Z3.\nG01 Z-5.\nG40 X4.";
    let changed = with_nose(&format!("{start}G41 {bore}"));
    assert_eq!(changed, with_nose(&format!("{start}G40\nG41 {bore}")));
    assert_ne!(changed, with_nose(&format!("{start}{bore}")));
}

#[test]
fn roughing_under_g42_is_roughing() {
    let contour = "N10 G00 X20. Z2.\nN20 G01 Z-10. F0.1\nN30 X30.\nN40 Z-20.\nN50 X43.\n";
    let program = |before: &str, after: &str| {
        with_nose(&format!(
            "T0101\nS500 M03\nG00 X60. Z10.\n{before}G00 X44. Z3.\nG71 U2. R0.5\n\
             G71 P10 Q50 U0.4 W0.1 F0.3\n{contour}{after}G70 P10 Q50\n"
        ))
    };
    let under = program("G42\n", "");
    let (plain, switched) = (program("", ""), program("", "G42\n"));
    let end = |moves: &[String]| moves[moves.len() - 7..].to_vec();
    assert_eq!(end(&under), end(&switched), "G70 is compensated");
    assert_ne!(end(&under), end(&plain));
    assert_eq!(under[2..9], plain[2..9], "passes are not");
    let warned = outcome(&format!(
        "S500 M03\nG00 X44. Z3.\nG42\nG71 U2. R0.5\nG71 P10 Q50 U0.4 W0.1 F0.3\n{contour}G40\nM30\n"
    ));
    assert!(warned.errors.is_empty(), "{:?}", warned.errors);
    assert!(warned.warnings.iter().any(|warning| (warning.line, warning.code) == (5, "no-effect")));
}

#[test]
fn g70_may_have_the_words_of_its_roughing() {
    let contour = "N10 G00 X20.\nN20 G01 Z-10. F0.1\nN30 X43.\n";
    let start = format!("S500 M03\nG00 X44. Z3.\nG71 P10 Q30 U0.4 W0.1 D2. F0.3\n{contour}");
    let outcome = outcome(&format!("{start}G70 P10 Q30 U0.4 D2. F0.05\nM30\n"));
    assert!(outcome.errors.is_empty(), "{:?}", outcome.errors);
    assert_eq!(outcome.sink.moves, moves(&format!("{start}G70 P10 Q30 F0.05")));
    assert!(outcome.warnings.iter().any(|warning| (warning.line, warning.code) == (7, "no-effect")));
    assert_eq!(errors(&format!("{start}G70 P10 Q30 R1.")), [(7, "unused-word")]);
}

/// The beginning of an NCT program: the sign of the tape and the number of the program in one line.
#[test]
fn the_sign_of_the_tape_may_stand_in_front_of_the_number() {
    let found = outcome("%O1200 (A PART)\nG00 X40. Z2.\nM30\n%\n");
    assert!(found.errors.is_empty(), "{:?}", found.errors);
    assert_eq!(found.sink.moves, ["G0 20 2"]);
    assert_eq!(outcome("G00 X40. Z2.\n%O1200\nM30\n").errors.len(), 1, "and nowhere else");
}

/// `;` ends a block; other controls have remarks behind it.
#[test]
fn text_behind_a_semicolon_is_a_remark_and_a_block_is_not() {
    let found = outcome("; Written by hand\nO1000\nG00 X40. Z2.; first\nX30.; (and back)\nM30\n");
    assert!(found.errors.is_empty(), "{:?}", found.errors);
    assert_eq!(found.sink.moves, ["G0 20 2", "G0 15 2"]);
    assert_eq!(
        found.warnings.iter().map(|one| (one.line, one.code)).collect::<Vec<_>>(),
        [(3, "no-effect"), (4, "no-effect")]
    );
    for block in ["G00 X40.; G00 X30.", "G00 X40.;X30.", "G00 X40.; GOTO 10", "G00 X40.; #1=2", "; N10"] {
        assert_eq!(errors(block), [(1, "bad-character")], "{block}");
    }
}

/// Controls read nothing above the first %.
#[test]
fn text_above_the_first_percent_is_left_out_with_a_warning() {
    let found = outcome("PROGRAM SHAFT\nDRAWING 44, 12.03.2026\n\n%\nO1000\nG00 X40. Z2.\nM30\n%\nG00 X0.\n");
    assert!(found.errors.is_empty(), "{:?}", found.errors);
    assert_eq!(found.sink.moves, ["G0 20 2"]);
    let [warning] = &found.warnings[..] else { panic!("{:?}", found.warnings) };
    assert_eq!((warning.line, warning.code), (1, "no-effect"));
    assert!(warning.message.contains("lines 1 to 2"), "{}", warning.message);
    // What may be a block is not left out, and the % that ends a program begins none.
    assert_eq!(errors("G00 X50.\n%\nG00 X40. Z2.")[0], (2, "bad-character"));
    assert_eq!(outcome("(SHAFT)\nO1000\nG00 X40. Z2.\nM30\n%\n").sink.moves, ["G0 20 2"]);
}
