//! How the bytes of a program are text.
//!
//! In: the first bytes of a file, or a line. Out: UTF-8. A byte order mark says UTF-8 or UTF-16; without one
//! a line is UTF-8, or else CP1252, which Windows writes in the west and in which Latin-1 reads the same.

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

/// A file in UTF-16 with its mark, as UTF-8.
pub(super) fn from_utf16(file: &[u8], word: fn([u8; 2]) -> u16) -> String {
    let words = file.as_chunks::<2>().0.iter().skip(1).map(|bytes| word(*bytes));
    char::decode_utf16(words).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
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
