//! What cannot be cut is refused, with the speed and the changes that would help.

use interpreter::{Diagnostic, check};
use machine::Machine;

fn refusal(source: &str) -> Diagnostic {
    check("t", source, &Machine::plain()).diagnostics[0].clone()
}

fn thread(s: f64, words: &str) -> String {
    format!("S{s} M3\nG0 X12 Z4\n{words}\nG0 X20\nM2\n")
}

/// The S that the help names.
fn named_speed(diagnostic: &Diagnostic) -> f64 {
    let after = diagnostic.help.split("would do is S").nth(1).expect("the help names a speed");
    let digits: String = after.chars().take_while(|c| c.is_ascii_digit() || *c == '.').collect();
    digits.trim_end_matches('.').parse().expect("a number")
}

#[test]
fn the_highest_speed_that_would_do_is_named_and_does() {
    for (s, words) in [
        (3000.0, "G33 Z-20 K10"),
        (2000.0, "G33 Z1 K4"),
        (1500.0, "G76 P2 Z2 I-3 J1 K1.2"),
        (800.0, "G76 P2 Z-25 I-2 J1.199 K1.2 E.5 L1"),
        (800.0, "G76 P2 Z-25 I-2 J1.199 K1.2 E.5 L2"),
        (2500.0, "G33 X30 Z-20 K8"),
    ] {
        let diagnostic = refusal(&thread(s, words));
        assert_eq!(diagnostic.code, "pass-not-feasible", "{words}");
        let named = named_speed(&diagnostic);
        assert!(named < s);
        assert!(check("t", &thread(named, words), &Machine::plain()).is_good(), "{words} at S{named}");
        let above = thread(named + 1.0, words);
        assert!(!check("t", &above, &Machine::plain()).is_good(), "{words} above S{named}");
    }
}

#[test]
fn the_reason_is_named() {
    let speed = refusal(&thread(3000.0, "G33 Z-20 K10"));
    assert!(speed.message.contains("500 mm/s of Z, which can do 147"), "{}", speed.message);
    let length = refusal(&thread(3000.0, "G76 P2 Z3 I-2 J.999 K1"));
    assert!(length.message.contains("no thread is left"), "{}", length.message);
    assert!(length.help.contains("a start further from the part"), "{}", length.help);
}

/// A program in inches is told its E in inches.
#[test]
fn the_least_taper_is_in_units_of_the_program() {
    let words = |e: f64| format!("G76 P.0787 Z-1 I-.12 J.0472 K.0473 E{e} L2");
    let program = |e: f64| format!("G20 S800 M3\nG0 X.5 Z.2\n{}\nG0 X1\nM2\n", words(e));
    let diagnostic = refusal(&program(0.01));
    let rest = diagnostic.help.strip_prefix("make E at least ").expect("E would help");
    let least: f64 = rest.split(',').next().and_then(|number| number.parse().ok()).expect("a number");
    let check = |e: f64| check("t", &program(e), &Machine::plain());
    assert!(check(least).is_good() && !check(least - 2e-4).is_good(), "{}", diagnostic.help);
}

#[test]
fn the_least_taper_that_is_named_does() {
    for l in [1, 2] {
        let words = |e: f64| format!("G76 P2 Z-25 I-2 J1.199 K1.2 E{e} L{l}");
        let diagnostic = refusal(&thread(800.0, &words(0.5)));
        let least: f64 = diagnostic
            .help
            .split("at least ")
            .nth(1)
            .and_then(|rest| rest.split(',').next())
            .and_then(|number| number.parse().ok())
            .expect("the help names a length");
        assert!(check("t", &thread(800.0, &words(least)), &Machine::plain()).is_good());
        assert!(!check("t", &thread(800.0, &words(least - 2e-4)), &Machine::plain()).is_good());
    }
}

#[test]
fn no_speed_helps_a_thread_without_length() {
    let diagnostic = refusal("S3000 M3\nG0 X12 Z4\nG33 Z3.99999999 K10\nG0 X20\nM2\n");
    assert_eq!(diagnostic.code, "pass-not-feasible");
    assert!(diagnostic.help.contains("no spindle speed would do"), "{}", diagnostic.help);
}
