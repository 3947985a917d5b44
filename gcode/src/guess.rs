//! Which language a program is written in, by what only one of the two has.
//!
//! In: the beginning of its text. Out: the dialect that more of its lines can only be, where the first of
//! them stands, and why. A program without such a line means the same in both, or is neither.

use crate::options::Dialect;
use crate::text::readable;

/// What a line gave away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Guess {
    /// The dialect.
    pub dialect: Dialect,
    /// The line, from 1.
    pub line: u32,
    /// What stands there.
    pub why: &'static str,
}

/// What a line has if no comment is looked at.
pub(crate) struct Words<'a> {
    /// In lower case, without blanks and comments.
    pub(crate) text: &'a [u8],
    /// Whether a line before it moves at a feed.
    pub(crate) feeds: bool,
}

type Sign = (Dialect, &'static str, fn(&Words) -> bool);

const SIGNS: [Sign; 20] = [
    (Dialect::Linuxcnc, "a named parameter, #<...>", |words| words.has(b"#<")),
    (Dialect::Linuxcnc, "an O word with what it does", |words| {
        words.text.starts_with(b"o<")
            || words.behind_number(b'o').is_some_and(|rest| rest.first().is_some_and(u8::is_ascii_alphabetic))
    }),
    (Dialect::Linuxcnc, "G7 or G8", |words| words.has_code(b'g', &[7, 8])),
    (Dialect::Linuxcnc, "G33 with K", |words| words.has_code(b'g', &[33]) && !words.has_lead_by_f()),
    (Dialect::Linuxcnc, "M6", |words| words.has_code(b'm', &[6]) && !words.has_tool_and_offset()),
    (Dialect::Linuxcnc, "G64 P", |words| words.has_code(b'g', &[64]) && words.has_word(b'p')),
    (Dialect::Fanuc, "O with the number of a program", |words| {
        words.behind_number(b'o').is_some_and(<[u8]>::is_empty) || words.behind_number(b':').is_some()
    }),
    (Dialect::Fanuc, "GOTO", |words| words.has(b"goto")),
    (Dialect::Fanuc, "DO and a number", |words| words.has(b"]do") || words.starts_with_number(b"do")),
    (Dialect::Fanuc, "G50 S", |words| words.has_code(b'g', &[50]) && words.has_word(b's')),
    (Dialect::Fanuc, "G32", |words| words.has_code(b'g', &[32])),
    (Dialect::Fanuc, "G92 S", |words| words.has_code(b'g', &[92]) && words.has_only_a_speed()),
    (Dialect::Fanuc, "G33 with F", |words| words.has_code(b'g', &[33]) && words.has_lead_by_f()),
    (Dialect::Fanuc, "G92 with a lead", |words| words.has_code(b'g', &[92]) && words.has_end_and_feed()),
    (Dialect::Fanuc, "G90 or G94 with an end and a feed, and nothing that moves at a feed before", |words| {
        let moves = words.feeds || words.has_code(b'g', &[0, 1, 2, 3]);
        words.has_code(b'g', &[90, 94]) && words.has_end_and_feed() && !moves
    }),
    (Dialect::Fanuc, "G76 with P of six digits", |words| {
        words.has_code(b'g', &[76]) && words.values(b'p').any(|digits| digits.len() == 6)
    }),
    (Dialect::Fanuc, "a T word of four digits", |words| words.has_tool_and_offset()),
    (Dialect::Fanuc, "U or W", |words| words.has_word(b'u') || words.has_word(b'w')),
    (Dialect::Fanuc, "[BILLET", |words| words.text.starts_with(b"[billet")),
    (Dialect::Fanuc, "G71 or G72 without Q", |words| {
        words.has_code(b'g', &[71, 72]) && !words.has_word(b'q') && !words.has(b"q[") && !words.has(b"q#")
    }),
];

/// What tells programs of mills apart. Either of the two has M6 there.
const SIGNS_OF_MILL: [Sign; 12] = [
    SIGNS[0],
    SIGNS[1],
    SIGNS[2],
    (Dialect::Linuxcnc, "G64 P", |words| words.has_code(b'g', &[64]) && words.has_word(b'p')),
    (Dialect::FanucMill, "O with the number of a program", |words| {
        words.behind_number(b'o').is_some_and(<[u8]>::is_empty) || words.behind_number(b':').is_some()
    }),
    (Dialect::FanucMill, "GOTO", |words| words.has(b"goto")),
    (Dialect::FanucMill, "THEN", |words| words.has(b"]then")),
    (Dialect::FanucMill, "DO and a number", |words| words.has(b"]do") || words.starts_with_number(b"do")),
    (Dialect::FanucMill, "G54.1 or G154", |words| {
        words.values(b'g').any(|digits| matches!(digits, b"54.1" | b"154"))
    }),
    (Dialect::FanucMill, "G65 or G66", |words| words.has_code(b'g', &[65, 66])),
    (Dialect::FanucMill, "[BILLET", |words| words.text.starts_with(b"[billet")),
    (Dialect::FanucMill, "M97", |words| words.has_code(b'm', &[97])),
];

/// What a program of a mill is written in; `None` if nothing says so.
pub fn guess_of_mill(text: &[u8]) -> Option<Guess> {
    by(&SIGNS_OF_MILL, text)
}

/// What a program of a lathe is written in; `None` if nothing says so.
pub fn guess(text: &[u8]) -> Option<Guess> {
    by(&SIGNS, text)
}

fn by(signs: &[Sign], text: &[u8]) -> Option<Guess> {
    let (mut bare, mut found, mut feeds) = (Vec::new(), Vec::<(Guess, u32)>::new(), false);
    for (line, number) in readable(text).lines().zip(1..) {
        without_comments(line.as_bytes(), &mut bare);
        let words = Words { text: &bare, feeds };
        feeds |= words.has_code(b'g', &[1, 2, 3]);
        let Some((dialect, why, _)) = signs.iter().find(|(.., is_there)| is_there(&words)) else { continue };
        match found.iter_mut().find(|(guess, _)| guess.dialect == *dialect) {
            Some((_, lines)) => *lines += 1,
            None => found.push((Guess { dialect: *dialect, line: number, why }, 1)),
        }
    }
    // Of as many lines the dialect that came first: the last of equals is the greatest.
    found.into_iter().rev().max_by_key(|(_, lines)| *lines).map(|(guess, _)| guess)
}

/// A line in lower case, without blanks, comments, N, and the slash of an optional block.
pub(crate) fn without_comments(line: &[u8], bare: &mut Vec<u8>) {
    bare.clear();
    let mut depth = 0;
    for byte in line {
        match byte {
            b'(' => depth += 1,
            b')' => depth = (depth - 1).max(0),
            b';' if depth == 0 => break,
            _ if depth > 0 || byte.is_ascii_whitespace() => {}
            _ => bare.push(byte.to_ascii_lowercase()),
        }
    }
    let slash = usize::from(bare.starts_with(b"/"));
    let mut from = slash;
    if bare.get(from) == Some(&b'n') {
        from += 1;
        from += bare[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    }
    if bare.starts_with(b"%o") {
        // `%O1200 SHAFT`: what follows the number is a name.
        from += 1;
        let digits = bare[2..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        bare.truncate(2 + digits);
    }
    bare.drain(..from);
}

impl<'a> Words<'a> {
    pub(crate) fn has(&self, part: &[u8]) -> bool {
        self.text.windows(part.len()).any(|window| window == part)
    }

    /// What follows a letter that stands first and has whole digits behind it.
    fn behind_number(&self, letter: u8) -> Option<&'a [u8]> {
        let rest = self.text.strip_prefix(&[letter])?;
        let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
        (digits > 0).then(|| &rest[digits..])
    }

    fn starts_with_number(&self, word: &[u8]) -> bool {
        self.text.strip_prefix(word).is_some_and(|rest| rest.first().is_some_and(u8::is_ascii_digit))
    }

    /// The numbers, as written, of the words of a letter. Letters inside of names and expressions do not
    /// begin words.
    pub(crate) fn values(&self, letter: u8) -> impl Iterator<Item = &'a [u8]> {
        let text = self.text;
        let begins = move |at: usize| {
            let before = at.checked_sub(1).map_or(b'0', |before| text[before]);
            text[at] == letter && (before.is_ascii_digit() || matches!(before, b'.' | b']'))
        };
        (0..text.len()).filter(move |at| begins(*at)).map(move |at| {
            let rest = &text[at + 1..];
            let end = rest.iter().take_while(|byte| byte.is_ascii_digit() || b".+-".contains(byte)).count();
            &rest[..end]
        })
    }

    fn has_tool_and_offset(&self) -> bool {
        self.values(b't').any(|digits| digits.len() == 4 && digits.iter().all(u8::is_ascii_digit))
    }

    fn has_word(&self, letter: u8) -> bool {
        self.values(letter).any(|number| !number.is_empty())
    }

    fn has_end_and_feed(&self) -> bool {
        (self.has_word(b'x') || self.has_word(b'z')) && self.has_word(b'f')
    }

    /// F where LinuxCNC's G33 needs K.
    fn has_lead_by_f(&self) -> bool {
        self.has_word(b'f') && !self.has_word(b'k')
    }

    /// S, and no point.
    fn has_only_a_speed(&self) -> bool {
        self.has_word(b's') && !b"xyzabc".iter().any(|letter| self.has_word(*letter))
    }

    fn has_code(&self, letter: u8, codes: &[u16]) -> bool {
        let number = |digits: &[u8]| std::str::from_utf8(digits).ok()?.parse::<u16>().ok();
        self.values(letter).any(|digits| number(digits).is_some_and(|number| codes.contains(&number)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_tell_the_dialects_apart() {
        let fanuc = [
            "%\nO1000\nG21",
            ":1000 (SHAFT)\nG21",
            "(ANY)\nG50 S2000\n",
            "N10 G00 T0101",
            "G00 X10. Z2.\nU4.",
            "N5 IF [#1 EQ 2] GOTO 10",
            "WHILE [#1 LT 3] DO 1",
            "G71 U2. R0.5",
            "T0101 M06",
            "G97 S800 M03\nG92 X22.9 Z-18. F1.5",
            "G00 X32. Z5.\nG90 X28. Z-20. F0.2",
            "G76 P021060 Q50 R0.03",
            "%O1200 (A PART)\nG90 G95",
            "%O1200(A PART)\nG33 Z-17.3 F1.5\nG0 X18.\nG33 Z-17.3 F1.5",
            "G21 G90 G95\nN60 G92 S500",
            "%O1200 SHAFT 5\nG90 G95",
        ];
        let linuxcnc = [
            "o100 sub\n",
            "o<turn> call [3]",
            "#<depth> = 2",
            "G7\n",
            "T1 M6",
            "G64 P0.01",
            "G33 Z-10 K1",
            "O10 while [1]",
        ];
        let neither = ["G0 X10 Z5\nG1 Z-5 F100\nM2\n", "(O1000 GOTO U2)\n;T0101\n", "", "\u{0}\u{ff}"];
        for (texts, dialect) in
            [(&fanuc[..], Some(Dialect::Fanuc)), (&linuxcnc, Some(Dialect::Linuxcnc)), (&neither, None)]
        {
            for text in texts {
                assert_eq!(guess(text.as_bytes()).map(|guess| guess.dialect), dialect, "{text}");
            }
        }
    }

    #[test]
    fn programs_of_mills() {
        let of_mill = |text: &str| guess_of_mill(text.as_bytes()).map(|guess| guess.dialect);
        assert_eq!(of_mill("%\nO1000\nT1 M06\nT2 M06\n"), Some(Dialect::FanucMill));
        assert_eq!(of_mill("T1 M6\nG54.1 P2\n"), Some(Dialect::FanucMill));
        assert_eq!(of_mill("T1 M6\nG64 P0.01\n"), Some(Dialect::Linuxcnc));
        assert_eq!(of_mill("T1 M6\nG0 X1\n"), None);
    }

    #[test]
    fn more_lines_count_and_the_first_of_them_is_told() {
        let found = guess(b"(A PART)\nG21\nN10 T0202\no100 sub").expect("a sign");
        assert_eq!((found.dialect, found.line), (Dialect::Fanuc, 3));
        let found = guess(b"O1000\nG7\nG33 Z-10 K1").expect("a sign");
        assert_eq!((found.dialect, found.line, found.why), (Dialect::Linuxcnc, 2, "G7 or G8"));
    }
}
