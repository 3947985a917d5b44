//! G-code system B: what a program of it means, and where systems are mixed.

use super::recorded::{errors, moves, outcome};

#[test]
fn a_program_of_system_b_does_what_the_same_one_of_system_a_does() {
    let pairs = [
        (
            "G21 G90 G95\nG92 S3000\nG96 S200 M03\nG00 X44. Z2.\nG01 X40. F0.2\nZ-10.",
            "G21 G99\nG50 S3000\nG96 S200 M03\nG00 X44. Z2.\nG01 X40. F0.2\nZ-10.",
        ),
        ("G94\nS500 M03\nG00 X44. Z2.\nG01 Z-5. F120.", "G98\nS500 M03\nG00 X44. Z2.\nG01 Z-5. F120."),
        (
            "G90 G95 S500 M03\nG00 X44. Z2.\nG77 X40. Z-10. F0.2\nX36.\nG00 X50.\nG79 X10. Z-1. F0.1\nG00 X60.",
            "G99 S500 M03\nG00 X44. Z2.\nG90 X40. Z-10. F0.2\nX36.\nG00 X50.\nG94 X10. Z-1. F0.1\nG00 X60.",
        ),
        (
            "G95 S500 M03\nG00 X24. Z3.\nG78 X19.4 Z-13. F1.5\nX19.\nG00 X30. Z3.\nG00 X18.9\nG33 Z-13. F1.5\nG00 X30.",
            "G99 S500 M03\nG00 X24. Z3.\nG92 X19.4 Z-13. F1.5\nX19.\nG00 X30. Z3.\nG00 X18.9\nG32 Z-13. F1.5\nG00 X30.",
        ),
        (
            "G95 S500 M03\nG90 G00 X0 Z3.\nG98 G83 Z-13. R2. Q3000 F0.1\nG80\nG94 G01 Z2. F100.\n(G91) G01 Z4.",
            "G99 S500 M03\nG00 X0 Z3.\nG83 Z-13. R2. Q3000 F0.1\nG80\nG98 G01 Z2. F100.\nG01 Z4.",
        ),
        // What is a move in system A stands beside one.
        (
            "G90 G00 X44. Z2. S500 M03\nG94 G01 Z-5. F120.\nG92 X50. Z-4. S2000\nG00 X60.",
            "G98 G00 X44. Z2. S500 M03\nG01 Z-5. F120.\nG50 X50. Z-4. S2000\nG00 X60.",
        ),
        (
            "G92 X100. Z60. S2000\nS500 M03\nG90 G28 X120. Z70.\nG00 X44. Z2.",
            "G50 X100. Z60. S2000\nS500 M03\nG28 X120. Z70.\nG00 X44. Z2.",
        ),
    ];
    for (b, a) in pairs {
        assert_eq!(errors(b), [], "{b}");
        assert_eq!(moves(b), moves(a), "{b}");
        let warned = outcome(b).warnings;
        assert!(warned.iter().all(|one| !one.message.contains("system A")), "{b}: {warned:?}");
    }
}

#[test]
fn programs_of_system_a_are_read_as_before() {
    for text in [
        "G21 G98\nS500 M03\nG00 X44. Z2.\nG90 X40. Z-10. F100.\nG00 X60.",
        "G90\nS500 M03\nG00 X44. Z2.\nG94 X10. Z-1. F0.1\nX8.\nG00 X60.",
        "S500 M03\nG00 X24. Z3.\nG92 X19.4 Z-13. F1.5 (G78, G95)\nG00 X60.",
        "M03\nG00 X24. Z3.\nG92 X19.4 Z-13. F1.5 S500\nG00 X60.",
        "S500 M03\nG00 X44. Z2.\ng + 0090 x + 40. z-10. F0.2\nG00 X60.",
    ] {
        assert_eq!(errors(text), [], "{text}");
        assert!(moves(text).len() > 3, "{text}");
    }
}

#[test]
fn systems_that_are_mixed_and_what_is_incremental_are_refused_by_name() {
    for (text, line, reason) in [
        ("G99 S500 M03\nG00 X44. Z2.\nG95 F0.2", 3, "G99 above"),
        ("S500 M03\nG00 X44. Z2.\nG90 X40. Z-10. F0.2\nG78 X30. Z-10. F1.5", 4, "G90 above"),
        ("S500 M03\nG00 X44. Z2.\nG90 X40. Z-10. F0.2\nG90 G00 X30.", 4, "exclude each other"),
        ("G95\nS500 M03\nG00 X44. Z2.\nG91 G00 X-4.", 4, "G91"),
        // Messages have the words of the program.
        ("G95 S500 M03\nG00 X44. Z2.\nG33 Z-10. K1.5 F1.5", 3, "G33 does not use K"),
        ("G95\nS500 M03\nG00 X0 Z2.\nG99 G83 Z-13. R2. F0.1", 4, "G99 of G-code system B"),
    ] {
        let outcome = outcome(text);
        let first = outcome.errors.first().expect(text);
        let code = match reason {
            "exclude each other" => "modal-group",
            "G33 does not use K" => "unused-word",
            _ => "not-available",
        };
        assert_eq!((first.line, first.code), (line, code), "{text}");
        assert!(first.message.contains(reason), "{text}: {}", first.message);
    }
}
