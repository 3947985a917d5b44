//! Depths of cut that are thinner than any chip.

use gcode::{Options, Program};

use super::recorded::{Outcome, fanuc, outcome, run};

/// What is said of thin cuts, as line, message and remedy.
fn said(outcome: &Outcome) -> Vec<(u32, &str, &str)> {
    assert!(outcome.errors.is_empty(), "{:?}", outcome.errors);
    let thin = outcome.warnings.iter().filter(|one| one.code == "unlikely-cut");
    thin.map(|one| (one.line, one.message.as_str(), one.help.as_str())).collect()
}

const START: &str = "G97 S500 M03\nG00 X40. Z2.\n";

#[test]
fn both_readings_of_a_word_without_a_point_are_told() {
    let contour = "N10 G00 X20.\nG01 Z-5. F0.2\nN20 X40.\n";
    for (text, letter, other) in [
        (format!("G71 P10 Q20 U0.2 W0.1 D2 F0.2\n{contour}"), 'D', "D2. for 2 mm"),
        (format!("G72 P10 Q20 U0.2 W0.1 D2 F0.2\n{contour}"), 'D', "D2. for 2 mm"),
        ("G83 Z-0.3 R1. Q6 F0.1\n".into(), 'Q', "Q6. for 6 mm"),
        ("G74 R0.1\nG74 Z-0.3 Q6 F0.1\n".into(), 'Q', "Q6000 for 6 mm"),
        ("G75 R0.1\nG75 X39.7 Z1. P5 Q500 F0.1\n".into(), 'P', "P5000 for 5 mm"),
        ("G75 X39.7 I2 F0.1\n".into(), 'I', "I2. for 2 mm"),
        ("G76 X36. Z-20. K0.2 D5 F2. A60\n".into(), 'D', "D5. for 5 mm"),
        ("G76 P021060 Q50 R0.03\nG76 X36. Z-20. P200 Q5 F2.\n".into(), 'Q', "Q5000 for 5 mm"),
    ] {
        let found = outcome(&format!("{START}{text}M30\n"));
        let said = said(&found);
        let [(_, message, help)] = said[..] else { panic!("{text}: {said:?}") };
        assert!(message.contains("thinner than any chip (") && help.contains(other), "{message}: {help}");
        let at = found.warnings.iter().find(|one| one.code == "unlikely-cut").expect("it was there");
        assert!(at.text[at.span.clone()].starts_with(letter), "{text}: {at:?}");
    }
}

#[test]
fn inches_are_told_in_inches_and_what_cuts_is_let_alone() {
    let found = outcome("G20 G97 S500 M03\nG00 X2. Z0.1\nG83 Z-0.01 R0.05 Q3 F0.004\nM30\n");
    let said = said(&found);
    let [(3, message, help)] = said[..] else { panic!("{said:?}") };
    assert!(message.starts_with("a peck is 0.0003 inch, "), "{message}");
    assert_eq!(help, "write Q3. for 3 inch, or give at least 0.001 inch");
    let good = "G83 Z-20. R1. Q6000 F0.1\nG80\nG00 Z2.\nG75 R0.1\nG75 X30. Z1. P500 Q500 F0.1\n\
                G76 P021060 Q50 R0.03\nG76 X36. Z-20. P1227 Q350 F2.\nG74 R0.1\nG74 Z1.995 Q20 F0.1\n";
    assert_eq!(self::said(&outcome(&format!("{START}{good}M30\n"))), []);
}

#[test]
fn on_mills_and_in_the_other_language_once() {
    let mill = Options { dialect: gcode::Dialect::FanucMill, ..fanuc() };
    let text = "G90 G00 X0. Y0. Z5.\nS800 M03\nG99 G83 X1. Z-0.1 R1. Q6 F100.\nX2.\nX3. Q6\nM30\n";
    let found = run(Program::from_text("O1", text, &mill));
    let lines = said(&found).iter().map(|(line, ..)| *line).collect::<Vec<_>>();
    assert_eq!(lines, [3, 5]);
    for text in [
        "G18 S300 M3 F100\nG0 X20 Z2\nG83 Y-0.1 R0.5 Q0.002\nX21\n",
        "G18 S300 M3 F100\nG0 X20 Z2\nG76 P1 Z-20 I-1 J0.005 K0.1\n",
        "G18 S300 M3 F100\no1 sub\nG0 X19.99\nG1 Z0\nG1 X20\no1 endsub\nG71 Q1 X20 Z2 I0.002\n",
    ] {
        let found = run(Program::from_text("A", format!("{text}M2\n"), &Options::default()));
        let said = said(&found);
        assert!(
            matches!(said[..], [(_, message, _)] if message.contains("thinner than any chip")),
            "{said:?}"
        );
    }
}
