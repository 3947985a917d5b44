//! What a refused block leaves behind: its feed, the contour that it named, and nothing that others are
//! blamed for.

use super::recorded::{errors, moves, outcome, sound};

const CONTOUR: &str = "N10 G00 X20.\nG01 Z-10. F0.1\nX30.\nZ-20.\nN20 X43.\n";

#[test]
fn a_refused_roughing_makes_one_error() {
    for cycle in [
        "G71 P10 Q20 U0.4 W0.1 F0.3",
        "G71 P10 Q20 U0.4 D-1. F0.3",
        "G71 P10 Q20 U0.4 H2. D1.",
        "M58 G71 P10 Q20 D1.",
    ] {
        let text = format!("S500 M03\nG00 X44. Z3.\n{cycle}\n{CONTOUR}G01 Z-30. F0.2\nG00 X60.");
        assert_eq!(errors(&text).iter().map(|(line, _)| *line).collect::<Vec<_>>(), [3], "{cycle}");
    }
    let inside = CONTOUR.replace("X30.", "M98 P1");
    let text = format!("S500 M03\nG00 X44. Z3.\nG71 P10 Q20 U0.4 D1. F0.3\n{inside}G00 X60.");
    assert_eq!(errors(&text), [(6, "bad-contour")], "and not the lines behind it");
}

#[test]
fn the_feed_of_a_refused_block_counts_for_those_after_it() {
    assert_eq!(errors("S500 M03\nG00 X44. Z3.\nG01 X40. Q3. F0.2\nZ-5.\nX44."), [(3, "unused-word")]);
    assert_eq!(errors("S500 M03\nG00 X44. Z3.\nM58 G01 X40. F0.2\nZ-5."), [(3, "unknown-m-code")]);
    assert_eq!(errors("S500 M03\nG88 Z-5. R2. F1.\nG01 Z-5."), [(2, "not-available")]);
}

#[test]
fn a_missing_feed_is_missed_once() {
    let zero = outcome("S500 M03\nG00 X44. Z3.\nG01 X40. F0.\nM30\n").errors;
    assert!(zero[0].message.contains("F is 0") && zero[0].help.contains("G98 and G99"), "{zero:?}");
    assert_eq!(errors("S500 M03\nG00 X44. Z3.\nG01 X40.\nZ-5.\nX44."), [(3, "no-feed")]);
}

#[test]
fn driven_tools_and_measuring_are_refused_with_the_reason() {
    for (text, reason) in [
        ("G88 X-10. R2. F1.5", "driven tools"),
        ("G36 X40.", "measures a tool"),
        ("G87 X10. R2. F0.1", "driven tools"),
    ] {
        let outcome = outcome(&format!("S500 M03\n{text}\nM30\n"));
        let [error] = outcome.errors.as_slice() else { panic!("{text}: {:?}", outcome.errors) };
        assert_eq!((error.line, error.code), (2, "not-available"), "{text}");
        assert!(error.message.contains(reason), "{}", error.message);
    }
}

#[test]
fn gears_and_smoothing_are_read_and_do_nothing() {
    let outcome = outcome("S500 M41\nG08 P1\nG05.1 Q1\nG00 X40.\nM30\n");
    assert!(outcome.errors.is_empty(), "{:?}", outcome.errors);
    assert_eq!(outcome.sink.moves, ["G0 20 0"]);
    let warned: Vec<_> = outcome.warnings.iter().map(|warning| (warning.line, warning.code)).collect();
    assert_eq!(warned, [(1, "no-effect"), (2, "no-effect"), (3, "no-effect")]);
}

#[test]
fn a_line_at_an_angle_takes_one_coordinate() {
    // tan 150° = -0.57735: ten along Z- are 5.7735 up
    let start = "S500 M03 F0.1\nG00 X20. Z0.\n";
    assert_eq!(moves(&format!("{start}G01 Z-10. ,A150."))[1], "G1 15.7735 -10");
    assert_eq!(moves(&format!("{start}G01 Z-10. A150."))[1], "G1 15.7735 -10");
    assert_eq!(moves(&format!("{start}G01 W-10. A-30."))[1], "G1 15.7735 -10", "the same line");
    assert_eq!(moves(&format!("{start}G01 X40. A135."))[1], "G1 20 -10");
    assert_eq!(moves(&format!("{start}G01 X40. A90."))[1], "G1 20 0");
    assert_eq!(moves(&format!("{start}G01 Z-10. A180."))[1], "G1 10 -10");
    // with a corner: the same as by coordinates
    assert_eq!(
        moves(&format!("{start}G01 Z-10. ,R1.\nX40. A135.\nZ-30.")),
        moves(&format!("{start}G01 Z-10. ,R1.\nX40. Z-20.\nZ-30."))
    );
    let refused = |text: &str| errors(&format!("{start}{text}"));
    assert_eq!(refused("G01 X40. Z-10. A135."), [(3, "missing-word")]);
    assert_eq!(refused("G01 Z-10. A90."), [(3, "bad-value")]);
    assert_eq!(refused("G01 X40. A180."), [(3, "bad-value")]);
    assert_eq!(refused("G01 Z-10. A150"), [(3, "no-decimal-point")]);
    assert_eq!(refused("G00 Z-10. A150."), [(3, "not-available")]);
}

#[test]
fn bores_come_back_at_the_feed_or_with_the_spindle_at_rest() {
    let start = "S500 M03 F0.1\nG00 X0. Z5.\n";
    assert_eq!(
        moves(&format!("{start}G89 Z-10. R2. P500")),
        ["G0 0 5", "G0 0 5", "G0 0 2", "G1 0 -10", "dwell 0.5", "G1 0 2", "G0 0 5"]
    );
    assert_eq!(errors(&format!("{start}G89 X-10. R2.")), [(3, "not-available")]);
    let bored = sound(&format!("{start}G86 Z-10. R2."));
    assert_eq!(bored.moves, ["G0 0 5", "G0 0 5", "G0 0 2", "G1 0 -10", "G0 0 2", "G0 0 5"]);
    let again = ["StopSpindle", "StartSpindle(Clockwise)"];
    assert!(bored.others.windows(2).any(|calls| calls == again), "{:?}", bored.others);
}

/// A pocket counts with its depth below its rim, however high that stands above the start; so does an arc
/// between its ends.
#[test]
fn a_contour_of_too_many_passes_is_refused_before_the_first_one() {
    for (cycle, contour) in [
        ("G72 W2. R0.5\nG72 P1 Q2 U0.4 W0.1 F0.3", "N1 G00 Z-9999999999999\nG01 X40. F0.1\nN2 Z2.5"),
        ("G71 U0.5 R0.5\nG71 P1 Q2 F0.3", "N1 G00 X40.\nG02 Z-40000. R20010. F0.1\nN2 G01 X50."),
    ] {
        let text = format!("S500 M03\nG00 X50. Z5.\n{cycle}\n{contour}\nM30\n");
        let outcome = outcome(&text);
        let [error] = outcome.errors.as_slice() else { panic!("{:?}", outcome.errors) };
        assert_eq!((error.line, error.code), (4, "bad-value"), "{error:?}");
        assert!(error.message.contains("more than 10000 passes"), "{}", error.message);
    }
}
