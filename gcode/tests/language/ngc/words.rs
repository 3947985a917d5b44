//! Words, comments, N, block delete, and what cannot be read.

use super::recorded::{blamed, calls, errors, messages, outcome, run};
use gcode::{Options, Program, Skips};

const TRAVERSE: &str = "StraightTraverse([1.0, -2.5, 0.0, 0.0, 0.0, 0.0])";

#[test]
fn words_may_be_written_in_many_ways() {
    for text in
        ["G0 X1 Y-2.5", "g0x1y-2.5", "G 0 0 x 0 1 . y-0 2 . 5", "\tG0\tX+1 Y-[2.5]", "N0010 X1 G0 Y-2.5 ;end"]
    {
        assert_eq!(calls(text), [TRAVERSE], "{text}");
    }
}

#[test]
fn optional_lines_are_left_out_if_they_are_switched_off() {
    let text = "/G0 X9\n / N5 G0 X8\nG0 X1 Y-2.5\nM2\n";
    let moves = |block_delete: bool| {
        let skips = Skips::of(block_delete.then_some(1));
        let options = Options { skips, ..Options::default() };
        let calls = run(Program::from_text("t", text, &options)).sink.calls;
        calls.iter().filter(|call| call.starts_with("StraightTraverse")).count()
    };
    assert_eq!((moves(false), moves(true)), (3, 1));
}

#[test]
fn entries_of_the_machine_description_are_parameters_that_nobody_sets() {
    let named = vec![("_ini[vars]depth".to_owned(), 2.5)];
    let options = Options { named, ..Options::default() };
    let text = "G0 X#<_INI[Vars]depth>\n#<_ini[vars]depth>=1\nM2\n";
    let outcome = run(Program::from_text("t", text, &options));
    assert!(outcome.sink.calls.contains(&"StraightTraverse([2.5, 0.0, 0.0, 0.0, 0.0, 0.0])".to_owned()));
    let errors: Vec<_> = outcome.errors.iter().map(|error| (error.line, error.code)).collect();
    assert_eq!(errors, [(2, "bad-parameter")]);
    assert_eq!(errors_of_setting("#<_ini[vars]width>=1"), ["bad-parameter"], "also one that is not there");
}

fn errors_of_setting(line: &str) -> Vec<&'static str> {
    errors(&format!("{line}\nM2\n")).into_iter().map(|(_, code)| code).collect()
}

#[test]
fn m19_turns_from_the_offset_of_the_machine() {
    let options = Options { orient_offset: 350.0, ..Options::default() };
    let calls = run(Program::from_text("t", "M19 R45 P1\nM2\n", &options)).sink.calls;
    assert!(calls.contains(&"OrientSpindle(35.0, 1)".to_owned()), "{calls:?}");
}

#[test]
fn comments_speak_with_the_values_of_parameters() {
    assert_eq!(messages("(MSG,load bar #1)"), ["load bar #1"]);
    assert_eq!(messages("( msg , load bar)"), [" load bar"]);
    assert_eq!(
        messages("#1=2.5 #<a b>=-1\n(debug,#1 #<ab> #<A b> #<x> #)"),
        ["2.500000 -1.000000 -1.000000 ###### #"]
    );
    assert_eq!(messages("#1=2.56\n(debug,%d#1 %f#1 %.1f#1 50% %x)"), ["3 2.5600 2.6 50% %x"]);
    assert_eq!(messages("#1=3 (debug,#1)"), ["3.000000"], "parameters are set before the comment speaks");
    assert_eq!(messages("#5599=0\n(debug,off)\n(msg,on)"), ["on"]);
    assert_eq!(calls("(print,a #1)"), ["Print(\"a 0.000000\")"]);
    assert_eq!(
        calls("(LOG,n=%d#1)\n(LogOpen,a.txt)\n(logclose)"),
        ["Log(\"LOG\", \"n=0\")", "Log(\"LOGOPEN\", \"a.txt\")", "Log(\"LOGCLOSE\", \"\")"]
    );
    assert_eq!(calls("; not shown (msg,neither)"), [""; 0]);
    assert_eq!(errors("(abort,no bar)\nM2"), [(1, "abort")]);
}

#[test]
fn a_message_that_another_comment_hides_is_reported() {
    let outcome = outcome("(msg,hello) G0 X1 (go)\nM2\n");
    assert_eq!((outcome.warnings[0].line, outcome.warnings[0].code), (1, "message-not-shown"));
}

#[test]
fn what_is_no_word_is_refused_where_it_stands() {
    for (text, code, bytes) in [
        ("$H", "bad-character", "$"),
        ("$$", "bad-character", "$"),
        ("$110=500", "bad-character", "$"),
        ("G0 X1 %", "bad-character", "%"),
        ("G0 X1 é", "bad-character", "é"),
        ("G0 \u{feff}X1", "bad-character", "\u{feff}"),
        ("G0 X1 (go to one", "unclosed-comment", "(go to one"),
        ("G0 (a (b) c)", "nested-comment", "(a (b)"),
        ("G0 N30 X2", "misplaced-line-number", "N"),
        ("G0 o1 if [1]", "misplaced-o-word", "o"),
        ("N G0", "bad-line-number", "N"),
        ("N-1 G0", "bad-line-number", "N"),
        ("G0 X1 X2", "repeated-word", "X2"),
        ("G0 G1 X1 F9", "modal-group", "G1"),
        ("G12.3", "unknown-g-code", "G12.3"),
        ("G1.05", "unknown-g-code", "G1.05"),
        ("M-3", "unknown-m-code", "M-3"),
        ("G-1", "unknown-g-code", "G-1"),
        ("G99999999999", "unknown-g-code", "G99999999999"),
        ("(a\u{1}b)", "bad-character", "?"),
    ] {
        assert_eq!(blamed(text), (1, code, bytes.to_owned()), "{text}");
    }
}

#[test]
fn bytes_that_are_not_utf_8_are_refused_outside_of_comments_with_their_column() {
    let text: &[u8] = b"G0 X1 (na\xefve)\nG0 \xff X1\nM2\n";
    let outcome = run(Program::from_reader("stdin", text, &Options::default()).unwrap());
    let places: Vec<_> = outcome.errors.iter().map(|error| (error.line, error.column, error.code)).collect();
    assert_eq!(places, [(2, 4, "bad-character")]);
}

#[test]
fn several_errors_of_a_program_are_reported_in_one_run() {
    let text = "G0 X[1/0]\nG0 Y1\nG99999\n#1=[2\nM2\n";
    assert_eq!(errors(text), [(1, "arithmetic"), (3, "unknown-g-code"), (4, "missing-bracket")]);
}

#[test]
fn a_sink_that_refuses_blames_the_line_the_call_comes_from() {
    struct Picky;
    impl gcode::Sink for Picky {
        fn call(&mut self, _: gcode::Place, call: gcode::Call<'_>) -> Result<(), Box<gcode::Problem>> {
            match call {
                gcode::Call::StraightTraverse(to) if to[0] > 5.0 => {
                    let blame = gcode::problem::Blame::Word('X');
                    Err(gcode::Problem::error("travel-limit", blame, "too far", "stay within"))
                }
                _ => Ok(()),
            }
        }
    }
    let mut program = Program::from_text("t", "G0 Y1\nG0 Y2 X7\nM2\n", &Options::default());
    let error = loop {
        if let Err(error) = program.step(&mut Picky) {
            break error;
        }
    };
    assert_eq!((error.line, error.column, &error.text[error.span.clone()]), (2, 7, "X7"));
}
