//! Coordinates without a decimal point.

use gcode::{DecimalPoint, Options, Program, Severity};

use super::recorded::{Outcome, fanuc, outcome, run};

fn read(rule: DecimalPoint, text: &str) -> Outcome {
    let options = Options { decimal_point: Some(rule), ..fanuc() };
    run(Program::from_text("O1", format!("{text}\nM30\n"), &options))
}

/// What is said, as line and severity.
fn said(outcome: &Outcome) -> Vec<(u32, Severity)> {
    let all = outcome.errors.iter().chain(&outcome.warnings);
    let of = all.inspect(|one| assert_eq!(one.code, "no-decimal-point", "{}", one.message));
    of.map(|one| (one.line, one.severity)).collect()
}

#[test]
fn a_program_without_points_is_warned_of_once_and_read_in_increments() {
    let found = outcome("G97 S500 M03\nG00 X40000 Z2000\nG01 Z-30000 F0.2\nM30\n");
    assert_eq!(said(&found), [(2, Severity::Warning)]);
    assert!(found.warnings[0].message.contains("40 mm is what most controls take it for, 40000 mm others"));
    assert_eq!(found.sink.moves[..1], ["G0 20 2"]);
}

/// The slip of an operator who thinks in mm: the tool would go to 0.04 mm.
#[test]
fn a_coordinate_that_lost_its_point_is_refused() {
    for (text, line) in [
        ("G00 X40. Z2.\nX42\nM30\n", 2),
        ("G00 X40 Z2\nG01 Z-30. F0.2\nM30\n", 1),
        ("G00 X42 Z2.\nM30\n", 1),
        ("G00 X40. Z2.\nG02 X42. Z-1. R1 F0.1\nM30\n", 2),
        ("G00 X40. Z2.\nG01 X44. F0.1 ,C1\nZ0.\nM30\n", 2),
        ("G00 X40. Z2.\nG71 U2 R1\nM30\n", 2),
    ] {
        let found = outcome(text);
        let refused = found.errors.iter().find(|error| error.code == "no-decimal-point");
        let refused = refused.unwrap_or_else(|| panic!("{text}: {:?}", found.errors));
        assert_eq!(refused.line, line, "{text}");
        assert!(refused.help.contains("machine.decimal_point"), "{}", refused.help);
        assert!(found.warnings.iter().all(|one| one.code != "no-decimal-point"), "{text}: said twice");
    }
}

/// What is refused for its point is read as it is written: nothing else is found wrong for it.
#[test]
fn coordinates_without_points_make_no_errors_behind_them() {
    let found = outcome(
        "G50 X100. Z100\nM03 S600\nG00 X42 Z2\nG71 U1.5 R1\nG71 P60 Q90 U0.5 W0.1 F0.2\nN60 G00 X20\n\
         G01 Z-15\nX30 Z-25\nN90 X42\nG70 P60 Q90\nG00 X22 Z3\nG92 X19.2 Z-12 F1.5\nX18.6\nG00 X100 Z100\nM30\n",
    );
    assert!(found.errors.len() > 3, "{:?}", found.errors);
    assert!(found.errors.iter().all(|one| one.code == "no-decimal-point"), "{:?}", found.errors);
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
}

#[test]
fn what_means_the_same_in_both_readings_is_not_asked() {
    let text = "G00 X42. Z0\nU0 W-1.\nG04 P500\nG04 X1\nG76 P021060 Q50 R30\nG76 X37.546 Z-20. P1227 Q350 F2.\n\
                #1=5\nZ#1\nM30\n";
    let found = outcome(&text.replace("G00 X42.", "G97 S500 M03\nG00 X42."));
    assert!(found.errors.is_empty() && found.warnings.is_empty(), "{:?} {:?}", found.errors, found.warnings);
}

#[test]
fn the_machine_settles_it() {
    let text = "G00 X40 Z2.";
    for (rule, to) in [(DecimalPoint::Conventional, "G0 0.02 2"), (DecimalPoint::PocketCalculator, "G0 20 2")]
    {
        let found = read(rule, text);
        assert_eq!((found.sink.moves[0].as_str(), said(&found)), (to, vec![]), "{rule:?}");
    }
    assert_eq!(said(&read(DecimalPoint::Refuse, "G00 X40 Z2")), [(1, Severity::Error)]);
    assert_eq!(said(&read(DecimalPoint::Refuse, "G00 X40. Z0")), []);
    // Steps of cycles are increments in every reading, and so is D.
    let steps = "G97 S500 M03\nG00 X40 Z2\nG75 R1\nG75 X30 Z-5 P2000 Q2500 F0.1";
    let pointed = "G97 S500 M03\nG00 X40. Z2.\nG75 R1.\nG75 X30. Z-5. P2000 Q2500 F0.1";
    let calculator = read(DecimalPoint::PocketCalculator, steps);
    assert_eq!(calculator.sink.moves, read(DecimalPoint::Conventional, pointed).sink.moves);
}

/// G10 of a mill sets a zero as a move goes to one; R of G68 is an angle.
#[test]
fn zeros_of_mills_are_asked_and_angles_are_not() {
    let mill = |text: &str| {
        let options = Options { dialect: gcode::Dialect::FanucMill, ..fanuc() };
        run(Program::from_text("O1", format!("G90\n{text}\nM30\n"), &options))
    };
    for text in ["G10 L2 P1 X1 Y2. Z3.", "G00 X5. Y5.\nG10 L2 P1 Z3", "G00 X5.\nG10 L12 P1 R4"] {
        let found = mill(text);
        assert_eq!(said(&found).last().map(|one| one.1), Some(Severity::Error), "{text}");
    }
    assert_eq!(said(&mill("G00 X5. Y5.\nG68 X0. Y0. R45\nG69")), []);
}
