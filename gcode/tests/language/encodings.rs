//! Ways in which a text is written: encodings, byte order marks, ends of lines, padding.

use gcode::{Diagnostic, Dialect, Options, Program};

use crate::driven::driven;
use crate::fanuc::recorded::Record;

/// A loop back to the first line but one, and a word that is wrong.
const TEXT: &str = "(Wälle Ø3)\nN1 #1=[#1+1]\nG00 X10. Z#1\nIF [#1 LT 3.] GOTO 1\nG00 X20. (Maß) ÄZ1.\nM30\n";

/// The moves, and what is wrong.
fn run(bytes: &[u8]) -> (Vec<String>, Vec<Diagnostic>) {
    let options = Options { dialect: Dialect::Fanuc, ..Options::default() };
    let outcome = driven(Program::from_text("O1", bytes, &options), Record::default());
    let read = Program::from_reader("O1", bytes, &options).expect("a temporary file");
    let spooled = driven(read, Record::default());
    assert_eq!(outcome.sink.moves, spooled.sink.moves, "from memory as from a file");
    assert_eq!(outcome.errors, spooled.errors);
    (outcome.sink.moves, outcome.errors)
}

/// Every character is one that CP1252 has at the place that Latin-1 has it at.
fn latin(text: &str) -> Vec<u8> {
    text.chars().map(|c| u8::try_from(u32::from(c)).expect("Latin-1")).collect()
}

fn utf_16(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
    text.encode_utf16().flat_map(bytes).collect()
}

#[test]
fn the_same_program_in_every_encoding() {
    let plain = run(TEXT.as_bytes());
    assert_eq!(plain.0, ["G0 5 1", "G0 5 2", "G0 5 3"]);
    assert_eq!(plain.1.len(), 1, "{:?}", plain.1);
    let wrong = &plain.1[0];
    assert_eq!((wrong.line, wrong.code, &wrong.text[wrong.span.clone()]), (5, "bad-character", "Ä"));
    let with_mark = |mark: &[u8], text: Vec<u8>| [mark, &text].concat();
    for (name, bytes) in [
        ("UTF-8 with its mark", with_mark(b"\xef\xbb\xbf", TEXT.into())),
        ("CP1252", latin(TEXT)),
        ("UTF-16, low byte first", with_mark(b"\xff\xfe", utf_16(TEXT, u16::to_le_bytes))),
        ("UTF-16, high byte first", with_mark(b"\xfe\xff", utf_16(TEXT, u16::to_be_bytes))),
    ] {
        assert_eq!(run(&bytes), plain, "{name}");
        assert_eq!(gcode::readable(&bytes), TEXT, "{name}");
    }
}

#[test]
fn what_only_windows_has_between_latin_letters() {
    let (moves, errors) = run(b"(5 \x80, \x84quoted\x93)\nG00 X10. Z1.\nM30\n");
    assert_eq!((moves, errors.len()), (vec!["G0 5 1".to_owned()], 0));
    assert_eq!(gcode::readable(b"\x80 \x84a\x93"), "€ „a“\n");
}

#[test]
fn lines_end_in_feeds_returns_or_both_and_padding_is_nothing() {
    let tape = format!("%\nO0001\n{TEXT}%\n");
    let plain = run(tape.as_bytes());
    assert_eq!(plain.0.len(), 3);
    for ends in ["\r\n", "\n\r\r", "\r\r\n", "\r"] {
        let text = tape.replace('\n', ends);
        assert_eq!(run(text.as_bytes()), plain, "{ends:?}");
    }
    let padded = format!("{}{}\u{7f}\0\n\u{1a}", "\0".repeat(300), tape.replace('\n', "\0\n\u{7f}"));
    assert_eq!(run(padded.as_bytes()), plain);
    let (_, inside) = run(b"G00 X1\x000.\nM30\n");
    assert_eq!((inside[0].line, inside[0].code), (1, "bad-character"), "NUL is none inside of a word");
}

#[test]
fn a_long_program_in_another_encoding_finds_its_lines_again() {
    // longer than any buffer, and the jump goes over all of it
    let filling = "(Füllung, die nichts tut)\n".repeat(20_000);
    let text = format!("N1 #1=[#1+1]\n{filling}G00 X10. Z#1\nIF [#1 LT 2.] GOTO 1\nM30\n");
    let plain = run(text.as_bytes());
    assert_eq!((&plain.0[..], plain.1.len()), (&["G0 5 1".to_owned(), "G0 5 2".to_owned()][..], 0));
    assert_eq!(run(&latin(&text)), plain);
    assert_eq!(run(&[b"\xff\xfe", &utf_16(&text, u16::to_le_bytes)[..]].concat()), plain);
}
