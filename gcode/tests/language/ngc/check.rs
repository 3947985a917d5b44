//! Blocks that are refused as a whole: words nobody uses, words that are missing, codes that contradict.

use super::recorded::{blamed, errors};

#[test]
fn a_word_that_nothing_uses_is_refused_by_name() {
    for letter in "DEHIJKLPQR$".chars() {
        let text = format!("G0 X1 {letter}0\nM2\n");
        assert_eq!(blamed(&text), (1, "unused-word", format!("{letter}0")), "{text}");
    }
    for letter in "UVW".chars() {
        assert_eq!(blamed(&format!("G0 {letter}1\nM2\n")), (1, "not-available", format!("{letter}1")));
    }
}

#[test]
fn every_code_uses_only_its_own_words() {
    let cases = [
        ("G4 P1", "P"),
        ("G33 Z1 K1", "KQ$"),
        ("G43 H0", "H"),
        ("G64 P0.1 Q0.1", "PQR"),
        ("G96 D1 S1", "D$"),
        ("M19 R1 P1 Q1", "RPQ$"),
        ("M61 Q0", "Q"),
        ("M62 P1", "P"),
        ("M66 P1 L3 Q1", "PELQ"),
        ("M67 E1 Q1", "EQ"),
        ("M51 P1", "P$"),
        ("M50 P1", "P"),
        ("G92 X1", ""),
        ("G28", ""),
        ("G54", ""),
        ("M3", "$"),
        ("M7", ""),
        ("M48", ""),
    ];
    for (block, used) in cases {
        for letter in "DEHIJKLPQR$".chars().filter(|letter| !used.contains(*letter)) {
            let text = format!("M3 S1\n{block} {letter}1\nM2\n");
            assert_eq!(blamed(&text), (2, "unused-word", format!("{letter}1")), "{text}");
        }
    }
}

#[test]
fn the_help_names_the_codes_that_use_the_word() {
    let outcome = super::recorded::outcome("G0 X1 E1\nM2\n");
    assert!(outcome.errors[0].help.contains("G70, G76, M66, M67 and M68"), "{}", outcome.errors[0].help);
}

#[test]
fn a_code_without_a_word_it_needs_is_refused() {
    for block in [
        "G4", "G96", "M61", "M62", "M63", "M64", "M65", "M67 Q1", "M68 E1", "G33 Z1", "G33.1 Z1", "G10 L2",
        "G43.2",
    ] {
        let found = errors(&format!("M3 S1\n{block}\nM2\n"));
        assert_eq!(found, [(2, "missing-word")], "{block}");
    }
}

#[test]
fn axis_words_need_a_motion_code() {
    assert_eq!(blamed("X1 Y2\nM2\n"), (1, "no-motion-mode", "X1".into()));
    assert_eq!(blamed("G0 X1\nG80\nY2\nM2\n"), (3, "no-motion-mode", "Y2".into()));
    assert_eq!(errors("G0 X1\nY2\nM2\n"), []);
    assert_eq!(errors("G80 X1\nM2\n").len(), 1);
    assert_eq!(errors("G80 G0 X1\nM2\n"), []);
}

#[test]
fn codes_that_contradict_are_refused() {
    for block in [
        "G92 X1 G0",
        "G28 G1 X1",
        "G10 L2 P1 X1 G0",
        "G43.1 Z1 G0",
        "M3 M70",
        "M7 M9",
        "M7 M8",
        "G4 P1 M64 P1",
        "G4 P1 G2 X1 I1 P1",
        "G53 X1",
        "G53 G2 X1 I1",
        "G91 G53 G0 X1",
        "G53 G0 @1",
        "G33 Z1 K1 F1",
        "G20 G21",
        "G54 G55",
        "M0 M1",
        "G43 G49",
    ] {
        assert_eq!(errors(&format!("M3 S1 F10\n{block}\nM2\n")).len(), 1, "{block}");
    }
}

#[test]
fn values_out_of_range_are_refused() {
    for block in [
        "M19 R361",
        "M19 R-1",
        "M19 P3",
        "M19 P0.5",
        "M19 R1 Q0",
        "G4 P-1",
        "S1 $1",
        "M3 $2",
        "G10 L1 P1 Q10",
    ] {
        assert_eq!(errors(&format!("{block}\nM2\n")), [(1, "bad-value")], "{block}");
    }
}

#[test]
fn nothing_of_a_refused_block_is_executed() {
    let outcome = super::recorded::outcome("M3 S100 M8 G0 X1 Q1\nM2\n");
    assert!(!outcome.sink.calls.iter().any(|call| call.contains("StartSpindle") || call.contains("FloodOn")));
}
