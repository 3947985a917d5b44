//! GOTO, WHILE, M98, G65, M99.

use super::recorded::{errors, fanuc, moves, outcome, run};
use gcode::{Options, Program, Skips};

#[test]
fn goto_looks_forward_then_from_the_top() {
    assert_eq!(moves("GOTO 20\nG04 U1.\nN20 G04 U2."), ["dwell 2"]);
    let text = "O1\nN10 #1=#1+1\nG04 U#1\nIF [#1 LT 3] GOTO 10";
    assert_eq!(moves(text), ["dwell 1", "dwell 2", "dwell 3"]);
    assert_eq!(errors("GOTO 30"), [(1, "unknown-label")]);
    assert_eq!(errors("GOTO 9.5\nN10"), [(1, "bad-value")]);
}

#[test]
fn computed_goto() {
    assert_eq!(moves("#1=2\nGOTO [#1*10]\nN10 G04 U1.\nN20 G04 U2."), ["dwell 2"]);
}

#[test]
fn loops_inside_each_other() {
    let text = "#1=0\nWHILE [#1 LT 2] DO 1\n#2=0\nWHILE [#2 LT 2] DO 2\nG04 U[#1*10+#2+1]\n#2=#2+1\nEND 2\n#1=#1+1\nEND 1";
    assert_eq!(moves(text), ["dwell 1", "dwell 2", "dwell 11", "dwell 12"]);
}

#[test]
fn a_loop_that_does_not_begin_is_passed_over() {
    assert_eq!(moves("WHILE [1 EQ 2] DO 1\nG04 U1.\nEND 1\nG04 U2."), ["dwell 2"]);
}

#[test]
fn goto_leaves_a_loop() {
    let text = "#1=0\nDO 1\n#1=#1+1\nIF [#1 GT 2] GOTO 9\nG04 U#1\nEND 1\nN9\nDO 1\nG04 U9.\nGOTO 99\nEND 1\nN99 G04 U10.";
    assert_eq!(moves(text), ["dwell 1", "dwell 2", "dwell 9", "dwell 10"]);
}

#[test]
fn crossed_and_unfinished_loops_are_refused() {
    assert_eq!(errors("WHILE [1 EQ 1] DO 1"), [(1, "bad-loop")]);
    assert_eq!(errors("END 2"), [(1, "bad-loop")]);
    assert_eq!(errors("DO 1\nDO 2\nEND 1\nEND 2")[0], (2, "bad-loop"));
    assert_eq!(errors("DO 4\nEND 4")[0], (1, "bad-loop"));
}

#[test]
fn subprograms_in_both_spellings() {
    let text = |call: &str| format!("O1\n{call}\nG04 U9.\nM30\nO1000 (GROOVE)\nG04 U1.\nM99");
    assert_eq!(moves(&text("M98 P1000 L2")), ["dwell 1", "dwell 1", "dwell 9"]);
    assert_eq!(moves(&text("M98 P21000")), ["dwell 1", "dwell 1", "dwell 9"]);
    assert_eq!(moves(&text("M98 P0021000")), ["dwell 1", "dwell 1", "dwell 9"]);
    assert_eq!(moves(&text("M98 P1000")), ["dwell 1", "dwell 9"]);
}

#[test]
fn m99_returns_to_a_block_of_the_caller() {
    let text = "M98 P1000\nG04 U1.\nN50 G04 U2.\nM30\nO1000\nM99 P50";
    assert_eq!(moves(text), ["dwell 2"]);
}

#[test]
fn labels_belong_to_their_program() {
    let text = "N10 M98 P1000\nGOTO 20\nN20 M30\nO1000\nGOTO 10\nG04 U1.\nN10 G04 U2.\nM99";
    assert_eq!(moves(text), ["dwell 2"]);
    assert_eq!(errors("GOTO 10\nM30\nO1000\nN10 M99"), [(1, "unknown-label")]);
}

#[test]
fn subprograms_in_files_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("O2000.nc"), "%\nO2000\nG04 U1.\nM98 P3000\nM99\n%\n").unwrap();
    std::fs::write(folder.path().join("o3000.ngc"), "G04 U2.\nM99\n").unwrap();
    let options = Options { subroutine_folders: vec![folder.path().to_owned()], ..fanuc() };
    let outcome = run(Program::from_text("O1", "M98 P2000 L2\nM30\n", &options));
    assert!(outcome.errors.is_empty(), "{:?}", outcome.errors);
    assert_eq!(outcome.sink.moves, ["dwell 1", "dwell 2", "dwell 1", "dwell 2"]);
    assert_eq!(errors("M98 P4000"), [(1, "no-subroutine")]);
}

#[test]
fn calls_and_idle_loops_end() {
    assert_eq!(errors("M98 P1000\nM30\nO1000\nM98 P1000\nM99")[0], (4, "calls-too-deep"));
    let mut options = fanuc();
    options.limits.blocks_without_motion = 1000;
    let outcome = run(Program::from_text("O1", "N1 #1=#1+1\nGOTO 1\n", &options));
    assert!(outcome.errors.iter().any(|error| error.code == "endless-loop"), "{:?}", outcome.errors);
}

#[test]
fn a_program_needs_its_end() {
    assert_eq!(outcome("O1\nG00 X1.\n").errors[0].code, "no-program-end");
    assert_eq!(outcome("O1\nG00 X1.\nO2\nM30\n").errors[0].code, "no-program-end");
    assert_eq!(outcome("O1\nM98 P2\nM30\nO2\nG00 X1.\n").errors[0].code, "no-program-end");
    let endless = outcome("O1\nG00 X1.\nM99\n");
    assert!(endless.errors.is_empty());
    assert_eq!(endless.warnings[0].code, "no-effect");
}

#[test]
fn optional_blocks_have_nine_switches() {
    let text = "/G04 U1.\n/1 G04 U2.\n/2N5 G04 U3.\n/9 G04 U4.\nG04 U5.\nM30\n";
    let moves = |switches: &[u8]| {
        let options = Options { skips: Skips::of(switches.iter().copied()), ..fanuc() };
        run(Program::from_text("O1", text, &options)).sink.moves
    };
    assert_eq!(moves(&[]), ["dwell 1", "dwell 2", "dwell 3", "dwell 4", "dwell 5"]);
    assert_eq!(moves(&[1]), ["dwell 3", "dwell 4", "dwell 5"]);
    assert_eq!(moves(&[2, 9]), ["dwell 1", "dwell 2", "dwell 5"]);
    assert_eq!(moves(&[0, 10]).len(), 5);
}

#[test]
fn a_switch_in_the_middle_of_a_block_leaves_out_what_follows() {
    let text = "N1 /G04 U1.\nG04 /2 U2. (and a remark)\nG04 U3. /3 M08\nM30\n";
    let calls = |switches: &[u8]| {
        let options = Options { skips: Skips::of(switches.iter().copied()), ..fanuc() };
        let outcome = run(Program::from_text("O1", text, &options));
        (outcome.sink.moves, outcome.errors.len())
    };
    assert_eq!(calls(&[]), (vec!["dwell 1".into(), "dwell 2".into(), "dwell 3".into()], 0));
    assert_eq!(calls(&[1, 3]).0, ["dwell 2", "dwell 3"]);
    assert_eq!(calls(&[2]).1, 1, "G04 without a time");
    for line in ["/0 G04 U1.", "/12 G04 U1.", "N5 /0 G04 U1.", "G04 U1. /0 M08"] {
        assert_eq!(errors(&format!("{line}\n")), [(1, "bad-value")], "{line}");
    }
    for line in ["G00 X10/2", "G00 X10. /", "G00 X10. / (nothing)"] {
        assert_eq!(errors(&format!("{line}\n")), [(1, "bad-character")], "{line}");
    }
}

#[test]
fn the_last_line_of_a_tape_may_lack_its_end() {
    for end in ["M30%", "M30 %", "M98 P2\nM30\nO2\nM99%"] {
        let outcome = outcome(&format!("O1\nG00 X1.\n{end}"));
        assert!(outcome.errors.is_empty(), "{end}: {:?}", outcome.errors);
    }
    assert_eq!(errors("G00 X1.%\n"), [(1, "bad-character")]);
    assert_eq!(errors("M30%X1.\n"), [(1, "bad-character")]);
}

#[test]
fn a_number_behind_other_words_numbers_the_block_and_nothing_finds_it() {
    let outcome = outcome("O1\nG04 U1. N20\nGOTO 20\nM30\n");
    assert_eq!(outcome.warnings.iter().map(|warning| warning.code).collect::<Vec<_>>(), ["no-effect"]);
    assert_eq!(outcome.errors[0].code, "unknown-label");
    assert_eq!(errors("N10 G04 U1. N20\n"), [(1, "misplaced-line-number")]);
}
