//! What is refused, and where it is said to be.

use super::recorded::{errors, outcome};
use proptest::prelude::*;

#[test]
fn unknown_and_unavailable_codes_are_named() {
    assert_eq!(errors("G63"), [(1, "unknown-g-code")]);
    assert_eq!(errors("G68"), [(1, "not-available")]);
    assert_eq!(errors("G66.1 P100"), [(1, "not-available")]);
    assert_eq!(errors("G87 Z-10."), [(1, "not-available")]);
    assert_eq!(errors("G17"), [(1, "not-available")]);
    assert_eq!(errors("M12"), [(1, "unknown-m-code")]);
}

#[test]
fn what_a_corner_word_does_wrong_is_said_with_its_comma() {
    let outcome = outcome("G00 X10. ,C2.\nM30\n");
    assert_eq!(outcome.errors[0].message, "G0 does not use ,C");
}

#[test]
fn every_word_is_used() {
    assert_eq!(errors("G00 X10. K3."), [(1, "unused-word")]);
    assert_eq!(errors("M08 X10. P2"), [(1, "unused-word")]);
    assert_eq!(errors("G00 Y10."), [(1, "not-available")]);
    assert_eq!(errors("G00 X10. U2."), [(1, "repeated-word")]);
    assert_eq!(errors("G00 X10. X2."), [(1, "repeated-word")]);
    assert_eq!(errors("G00 G01 X10."), [(1, "modal-group")]);
    assert_eq!(errors("G04 M98 P10"), [(1, "modal-group")]);
    assert_eq!(errors("#1=2 (TWO) X10."), [(1, "unused-word")]);
    assert_eq!(errors("GOTO 10 G01\nN10"), [(1, "unused-word")]);
    assert_eq!(errors("G50"), [(1, "missing-word")]);
    assert_eq!(errors("G52 U1."), [(1, "unused-word")]);
}

#[test]
fn numbers_that_need_no_point_or_a_point() {
    assert_eq!(errors("T0101.5"), [(1, "bad-value")]);
    assert_eq!(errors("M98 P1.5"), [(1, "bad-value")]);
    assert_eq!(errors("G02 X10. Z-5. R-5."), [(1, "bad-value")]);
}

#[test]
fn corners_need_a_move_behind_them() {
    let errors = |text: &str| errors(&format!("S500 M03 F0.1\nG00 X20. Z0.\n{text}"));
    assert_eq!(errors("G01 Z-20. ,C2.\nG00 X40."), [(3, "bad-corner")]);
    assert_eq!(errors("G01 Z-20. ,C2."), [(3, "bad-corner")]);
    assert_eq!(errors("G01 Z-20. ,C2.\nX21."), [(3, "bad-corner")]);
    assert_eq!(errors("G01 Z-20. C2.\nX10."), [(3, "bad-corner")]);
    assert_eq!(errors("G01 X30. Z-20. C2.\nX40."), [(3, "bad-value")]);
}

#[test]
fn the_place_is_pointed_at() {
    let outcome = outcome("O1\nN10 G00 X20. Q5.\nM30\n");
    let text = outcome.errors[0].render(false);
    assert!(text.starts_with("O0001.nc:2:14: error[unused-word]"), "{text}");
}

#[test]
fn several_errors_of_one_program() {
    assert_eq!(
        errors("G63\nG00 X1.\nM12\nG00 Q1"),
        [(1, "unknown-g-code"), (3, "unknown-m-code"), (4, "unused-word")]
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    /// Whatever is written, there is an answer.
    #[test]
    fn no_text_brings_it_down(lines in proptest::collection::vec(
        "[/]?(N[1-9])?[ ]?((G(0[0-4]|28|32|50|65|7[0-6]|9[0-9])|M(0[0-9]|98|99|30)|[A-Z,#][-]?[0-9.#\\[\\]]{1,5}|IF|GOTO|WHILE|DO|END|THEN|=|\\[|\\]|[(]A[)]|EQ|SIN)[ ]?){0,7}",
        0..12)) {
        let mut options = super::recorded::fanuc();
        options.limits.blocks_without_motion = 200;
        options.limits.call_depth = 5;
        let mut program = gcode::Program::from_text("O1", lines.join("\n"), &options);
        let mut record = super::recorded::Record::default();
        for _ in 0..3000 {
            if matches!(program.step(&mut record), Ok(gcode::Step::Ended)) {
                break;
            }
        }
    }
}
