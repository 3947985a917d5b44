//! How the bytes of a program are text.
//!
//! In: the first bytes of a file, or a line. Out: UTF-8. A byte order mark says UTF-8 or UTF-16; without one
//! a line is UTF-8, or else CP1252, which Windows writes in the west and in which Latin-1 reads the same.

use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Read, Seek, Write};

/// What stands before the text.
#[derive(Clone, Copy)]
pub(super) enum ByteOrder {
    /// Nothing.
    Unmarked,
    /// Three bytes, and the text is UTF-8.
    Utf8,
    /// Two bytes, and the text is UTF-16: how two bytes make a word.
    Utf16(fn([u8; 2]) -> u16),
}

impl ByteOrder {
    /// That of a file that begins so.
    pub(super) fn of(beginning: &[u8]) -> ByteOrder {
        match beginning {
            [0xef, 0xbb, 0xbf, ..] => ByteOrder::Utf8,
            [0xff, 0xfe, ..] => ByteOrder::Utf16(u16::from_le_bytes),
            [0xfe, 0xff, ..] => ByteOrder::Utf16(u16::from_be_bytes),
            _ => ByteOrder::Unmarked,
        }
    }
}

/// The characters of CP1252 from 0x80 to 0x9f; the others are as in Latin-1. Five places are empty.
/// Source: Unicode, Mappings/VENDORS/MICSFT/WINDOWS/CP1252.TXT.
const WINDOWS: [char; 32] = [
    '€', '\u{fffd}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{fffd}', 'Ž', '\u{fffd}',
    '\u{fffd}', '‘', '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{fffd}', 'ž', 'Ÿ',
];

/// A file, or one without a name of its text if it is in UTF-16, in UTF-8.
///
/// # Errors
/// It cannot be read, or the folder for temporary files takes none.
pub(super) fn file_in_utf8(mut file: File) -> io::Result<File> {
    let mut beginning = Vec::new();
    Read::by_ref(&mut file).take(2).read_to_end(&mut beginning)?;
    file.rewind()?;
    let ByteOrder::Utf16(word) = ByteOrder::of(&beginning) else { return Ok(file) };
    let mut plain = intake::unnamed()?;
    from_utf16(BufReader::new(file), word, BufWriter::new(&plain))?;
    plain.rewind()?;
    Ok(plain)
}

/// The same of a text.
pub(super) fn text_in_utf8(text: Vec<u8>) -> Vec<u8> {
    let ByteOrder::Utf16(word) = ByteOrder::of(&text) else { return text };
    let mut plain = Vec::new();
    match from_utf16(&text[..], word, &mut plain) {
        Ok(()) => plain,
        Err(_) => text, // memory can be read and written
    }
}

/// Writes what is in UTF-16, with its mark, as UTF-8 without one. Nothing of it is kept in memory.
///
/// # Errors
/// It cannot be read or written.
fn from_utf16(file: impl BufRead, word: fn([u8; 2]) -> u16, mut to: impl Write) -> io::Result<()> {
    let mut failed = Ok(());
    let mut bytes = file.bytes().map_while(|byte| byte.map_err(|error| failed = Err(error)).ok());
    let words = std::iter::from_fn(|| Some(word([bytes.next()?, bytes.next()?])));
    for letter in char::decode_utf16(words.skip(1)) {
        let letter = letter.unwrap_or(char::REPLACEMENT_CHARACTER);
        to.write_all(letter.encode_utf8(&mut [0; 4]).as_bytes())?;
    }
    failed.and_then(|()| to.flush())
}

/// The text of a line that is not UTF-8.
pub(super) fn foreign(line: &[u8]) -> Option<String> {
    if line.is_ascii() || std::str::from_utf8(line).is_ok() {
        return None;
    }
    let character = |byte: &u8| match byte {
        0x80..0xa0 => WINDOWS[usize::from(byte - 0x80)],
        _ => char::from(*byte),
    };
    Some(line.iter().map(character).collect())
}

/// A line as text for people: what is not printable becomes `?`.
pub(super) fn printable(line: &[u8]) -> String {
    let text = foreign(line).unwrap_or_else(|| String::from_utf8_lossy(line).into_owned());
    text.chars().map(|c| if c.is_control() && c != '\t' { '?' } else { c }).collect()
}
