//! Lines: ends, percent signs, long lines, streams, and the way back.

use super::recorded::{errors, messages, outcome, run};
use gcode::{Options, Program};

fn said(outcome: &super::recorded::Outcome) -> usize {
    outcome.sink.calls.iter().filter(|call| call.starts_with("Message")).count()
}

#[test]
fn lines_may_end_in_any_way() {
    assert_eq!(messages("(msg,a)\r\n\r\n(msg,b)"), ["a", "b"]);
    assert!(errors("M2").is_empty(), "the last line needs no end");
    assert_eq!(errors(""), [(1, "no-program-end")]);
}

#[test]
fn only_what_stands_between_percent_signs_is_the_program() {
    let outcome = outcome("\n % \n(msg,in)\n%\nG99999 nonsense\n");
    assert!(outcome.errors.is_empty());
    assert_eq!(said(&outcome), 1);
    assert!(outcome.sink.calls.contains(&"Finish".to_owned()));
    assert_eq!(errors("(msg,a)\n%\nM2\n"), [(2, "bad-character")], "a % that comes later is no end");
}

/// LinuxCNC refuses such a program: its own interpreter in its place does, too.
#[test]
fn text_above_the_first_percent_is_left_out_with_a_warning() {
    let text = "=====\nTestfile\n=====\n%\nG0 X1\nM2\n%\n";
    let outcome = outcome(text);
    assert!(outcome.errors.is_empty(), "{:?}", outcome.errors);
    assert_eq!(
        outcome.warnings.iter().map(|one| (one.line, one.code)).collect::<Vec<_>>(),
        [(1, "no-effect")]
    );
    let options = Options { stand_alone: true, ..Options::default() };
    assert!(run(Program::from_text("p", text, &options)).errors.len() > 1);
}

#[test]
fn a_line_that_is_too_long_is_refused_and_the_next_one_read() {
    for length in [5000, 70_000, 200_000] {
        let text = format!("(msg,a)\n({})\n(msg,b)\nM2\n", "x".repeat(length));
        let outcome = outcome(&text);
        let places: Vec<_> = outcome.errors.iter().map(|error| (error.line, error.code)).collect();
        assert_eq!(places, [(2, "line-too-long")], "{length}");
        assert!(outcome.errors[0].message.contains("line_length"));
        assert_eq!(said(&outcome), 2, "{length}");
    }
}

/// A loop over more text than is read at once, from every kind of input.
#[test]
fn loops_go_back_over_any_distance() {
    let body = "(a comment that fills the file)\n".repeat(10_000);
    let text = format!("o1 repeat [3]\n{body}(msg,turn)\no1 endrepeat\nG0 X[1/0]\nM2\n");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.ngc");
    std::fs::write(&path, &text).unwrap();
    let options = Options::default();
    for program in [
        Program::from_text("text", text.clone(), &options),
        Program::from_reader("stdin", text.as_bytes(), &options).unwrap(),
        Program::open(&path, &options).unwrap(),
    ] {
        let outcome = run(program);
        assert_eq!(said(&outcome), 3);
        assert_eq!(outcome.errors[0].line, 10_004);
        assert_eq!(outcome.errors[0].text, "G0 X[1/0]", "the line is read again for the diagnostic");
    }
}

#[test]
fn a_folder_is_no_program() {
    assert!(Program::open(&std::env::temp_dir(), &Options::default()).is_err());
}
