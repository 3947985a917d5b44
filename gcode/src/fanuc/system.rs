//! G-code system B in lathe programs: its codes become those of system A, which all else knows. In: a G code,
//! the line that it stands in. Out: the code of system A.
//!
//! | B | A | | B | A |
//! |---|---|---|---|---|
//! | G77 G78 G79 | G90 G92 G94, the cycles | | G90 | nothing: X and Z are absolute |
//! | G94 G95 | G98 G99, the feed | | G92 | G50 |
//! | G33 | G32 | | G98 | nothing: holes end where they began |
//!
//! A program is one of system B from the first code on that system A does not have, from a G94 that cuts no
//! face, from a G90, G92 or G94 beside a move, which in system A are moves themselves, and from a G92 with a
//! point and S but no lead: what stands in front of such a code in its line is of system B, too. What only
//! system A means by G98 and G99, and by cycles of G90, G92 and G94, decides for A.

use crate::codes::G;
use crate::problem::{Blame, Problem, Span};

/// What the codes of a program have told so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum System {
    /// They are the same in both.
    #[default]
    Open,
    /// System A, by this code.
    A(G),
    /// System B.
    B,
}

/// Codes that system A does not have.
const ONLY_B: [G; 6] = [G(330), G(770), G(780), G(790), G(910), G(950)];
/// Codes of system B that are cycles in system A, and codes of both that move something: one block has one
/// of them.
const CYCLES_OF_A: [G; 3] = [G(900), G(920), G(940)];
const MOVES: [G; 7] = [G(0), G(10), G(20), G(30), G(280), G(300), G(530)];
/// Codes that are something else in both.
const DIFFER: [G; 5] = [G(900), G(920), G(940), G(980), G(990)];

impl System {
    /// The code of system A for a code in a line; `None` if it says what is so without it.
    ///
    /// # Errors
    /// Codes of both systems are mixed; incremental coordinates by G91, and the way back to R by G99.
    pub(super) fn read(&mut self, code: G, text: &[u8], span: Span) -> Result<Option<G>, Box<Problem>> {
        let only_b = ONLY_B.contains(&code);
        if !only_b && !DIFFER.contains(&code) {
            return Ok(Some(code));
        }
        match *self {
            System::A(first) if only_b => return Err(mixed(code, first, span)),
            System::Open if only_b || is_b(code, text) => *self = System::B,
            System::Open if matches!(code, G(980 | 990)) || has_point(text) => *self = System::A(code),
            _ => {}
        }
        if *self != System::B {
            return Ok(Some(code));
        }
        match code {
            G(910 | 990) => Err(refused(code, span)),
            code => Ok(in_system_a(code)),
        }
    }
}

/// The code of system A for one of system B; `None` for one that says what is so without it, and for those
/// that are refused.
#[must_use]
pub fn in_system_a(code: G) -> Option<G> {
    Some(match code {
        G(900 | 910 | 980 | 990) => return None,
        G(330) => G(320),
        G(770) => G(900),
        G(780) => G(920),
        G(790) => G(940),
        G(920) => G(500),
        G(940) => G(980),
        G(950) => G(990),
        code => code,
    })
}

/// Codes of system A as messages name them, and what they are in system B.
const NAMES: [(&str, &str); 7] = [
    ("G32", "G33"),
    ("G50", "G92"),
    ("G90", "G77"),
    ("G92", "G78"),
    ("G94", "G79"),
    ("G98", "G94"),
    ("G99", "G95"),
];

/// A message in the words of a program of system B.
pub(super) fn in_its_words(text: String) -> String {
    // What tells of the systems or of both dialects has the names of each.
    if text.contains("system B") || text.contains("FANUC") { text } else { in_system_b(&text) }
}

fn in_system_b(text: &str) -> String {
    let mut named = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find('G') {
        let (before, code) = rest.split_at(at);
        named.push_str(before);
        let end = 1 + code[1..].find(|c: char| !c.is_ascii_digit()).unwrap_or(code.len() - 1);
        let is_whole =
            !code[end..].starts_with('.') || !code[end + 1..].starts_with(|c: char| c.is_ascii_digit());
        let other = NAMES.iter().find(|(name, _)| is_whole && *name == &code[..end]);
        named.push_str(other.map_or(&code[..end], |(_, name)| name));
        rest = &code[end..];
    }
    named + rest
}

/// Whether the codes of a lathe program tell that it is one of system B.
#[must_use]
pub fn is_system_b<'a>(lines: impl Iterator<Item = &'a str>) -> bool {
    let mut system = System::Open;
    for line in lines {
        for code in codes(line.as_bytes()) {
            let _ = system.read(code, line.as_bytes(), Span::default());
            match system {
                System::Open => {}
                System::A(_) => return false,
                System::B => return true,
            }
        }
    }
    false
}

/// Whether a code that differs is of system B by what stands beside it, in whichever order.
fn is_b(code: G, text: &[u8]) -> bool {
    let is_feed = |code: G| code == G(940) && !has_point(text);
    let is_beside_a_move =
        |code: G| CYCLES_OF_A.contains(&code) && codes(text).any(|other| MOVES.contains(&other));
    let is_origin = |code: G| code == G(920) && has_word(text, b's') && !has_word(text, b'f');
    let tells = |code: G| is_feed(code) || is_beside_a_move(code) || is_origin(code) && has_point(text);
    tells(code) || codes(text).any(|other| ONLY_B.contains(&other) || tells(other))
}

/// The bytes of a line without its comments, blanks and signs that change nothing.
fn words(text: &[u8]) -> impl Iterator<Item = u8> + '_ {
    let mut depth = 0_u32;
    text.iter().filter_map(move |byte| match byte {
        b'(' => {
            depth += 1;
            None
        }
        b')' => {
            depth = depth.saturating_sub(1);
            None
        }
        b'+' => None,
        _ => (depth == 0 && !byte.is_ascii_whitespace()).then(|| byte.to_ascii_lowercase()),
    })
}

/// The G codes of a line that are written as plain numbers.
fn codes(text: &[u8]) -> impl Iterator<Item = G> + '_ {
    let mut words = words(text).peekable();
    std::iter::from_fn(move || {
        loop {
            words.by_ref().find(|byte| *byte == b'g')?;
            let (mut tenths, mut is_number) = (0_u16, false);
            while let Some(digit) = words.next_if(u8::is_ascii_digit) {
                let digit = 10 * u16::from(digit - b'0');
                (tenths, is_number) = (tenths.saturating_mul(10).saturating_add(digit), true);
            }
            if words.next_if_eq(&b'.').is_some()
                && let Some(digit) = words.next_if(u8::is_ascii_digit)
            {
                tenths = tenths.saturating_add(u16::from(digit - b'0'));
            }
            if is_number {
                return Some(G(tenths));
            }
        }
    })
}

/// Whether a line has a point to go to.
fn has_point(text: &[u8]) -> bool {
    words(text).any(|byte| matches!(byte, b'x' | b'z' | b'u' | b'w'))
}

/// Whether a line has a letter.
fn has_word(text: &[u8], letter: u8) -> bool {
    words(text).any(|byte| byte == letter)
}

fn mixed(code: G, first: G, span: Span) -> Box<Problem> {
    let message = format!("{code} belongs to G-code system B, and {first} above was one of system A");
    let help = "write G90 G92 G94 for the cycles G77 G78 G79, G32 for G33, G98 G99 for the feeds G94 G95, U and W for \
                X and Z under G91";
    Problem::error("not-available", Blame::Span(span), message, help)
}

fn refused(code: G, span: Span) -> Box<Problem> {
    let (message, help) = match code {
        G(910) => {
            ("G91 is not available: X and Z are absolute", "write U and W for what is to be incremental")
        }
        _ => (
            "G99 of G-code system B is not available: holes end where they began",
            "leave it out, and begin at R; for the feed per revolution write G95",
        ),
    };
    Problem::error("not-available", Blame::Span(span), message, help)
}

#[cfg(test)]
mod tests {
    use super::in_system_b;

    #[test]
    fn messages_name_the_codes_of_the_program() {
        assert_eq!(in_system_b("G32 does not use K, G99."), "G33 does not use K, G95.");
        assert_eq!(in_system_b("G33.1 G1 G92.1 G9 G"), "G33.1 G1 G92.1 G9 G");
        assert_eq!(in_system_b("G98 and G94, G90"), "G94 and G79, G77");
    }
}
