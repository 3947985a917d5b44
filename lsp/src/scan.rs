//! A line taken apart for people who look at it: what stands where. In: a line of either dialect. Out:
//! tokens, by bytes. Nothing is judged here; that is what the readers of `gcode` do.

use std::ops::Range;

use gcode::Dialect;

/// What stands at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A letter and its number, if it has one: `G01`, `X`, `P1000`.
    Word(char),
    /// `#5220`, `#<depth>`.
    Parameter,
    /// `o100 sub`, `O1000`.
    Label,
    /// `(MSG, text)`, `; text`.
    Comment,
    /// `SIN`, `GOTO`, `EQ`.
    Name,
    /// A number that belongs to nothing else: in an expression, or behind GOTO.
    Number,
    /// A bracket, a sign, a stroke.
    Sign,
}

/// A piece of a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Token {
    pub(crate) kind: Kind,
    pub(crate) at: Range<usize>,
}

/// The token at a byte; where two meet, the one that begins there, and at the end of a line the last one.
pub(crate) fn at(tokens: &[Token], byte: usize) -> Option<usize> {
    let holds = tokens.iter().position(|token| token.at.contains(&byte));
    holds.or_else(|| tokens.iter().position(|token| token.at.end == byte))
}

/// What is a name and not a row of words.
const NAMES: [&str; 44] = [
    "ABS",
    "ACOS",
    "AND",
    "ASIN",
    "ATAN",
    "BCD",
    "BIN",
    "COS",
    "DO",
    "END",
    "EQ",
    "EXISTS",
    "EXP",
    "FIX",
    "FUP",
    "GE",
    "GOTO",
    "GT",
    "IF",
    "LE",
    "LN",
    "LT",
    "MOD",
    "NE",
    "OR",
    "POW",
    "ROUND",
    "SIN",
    "SQRT",
    "TAN",
    "THEN",
    "WHILE",
    "XOR",
    "BREAK",
    "CALL",
    "CONTINUE",
    "ELSE",
    "ELSEIF",
    "ENDIF",
    "ENDREPEAT",
    "ENDSUB",
    "ENDWHILE",
    "REPEAT",
    "RETURN",
];

/// The pieces of a line, in order.
pub(crate) fn scan(line: &str, dialect: Dialect) -> Vec<Token> {
    let bytes = line.as_bytes();
    let mut tokens = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let (kind, end) = match bytes[at] {
            c if c.is_ascii_whitespace() || !c.is_ascii() => {
                at += 1;
                continue;
            }
            b'(' => (Kind::Comment, line[at..].find(')').map_or(line.len(), |end| at + end + 1)),
            b';' => (Kind::Comment, line.len()),
            b'#' => match bytes.get(at + 1) {
                Some(b'<') => (Kind::Parameter, line[at..].find('>').map_or(line.len(), |end| at + end + 1)),
                Some(c) if c.is_ascii_digit() => (Kind::Parameter, digits(bytes, at + 1)),
                _ => (Kind::Sign, at + 1),
            },
            b'o' | b'O' if tokens.iter().all(|token: &Token| token.kind == Kind::Sign) => {
                (Kind::Label, label(line, at, dialect))
            }
            c if c.is_ascii_alphabetic() => letters(line, at),
            b'@' | b'^' | b'$' => (Kind::Word(char::from(bytes[at])), number(bytes, at + 1)),
            c if c.is_ascii_digit() || c == b'.' => (Kind::Number, number(bytes, at)),
            _ => (Kind::Sign, at + 1),
        };
        tokens.push(Token { kind, at: at..end });
        at = end;
    }
    tokens
}

/// A name, or a letter with the number behind it.
fn letters(line: &str, at: usize) -> (Kind, usize) {
    let bytes = line.as_bytes();
    let run = bytes[at..].iter().take_while(|c| c.is_ascii_alphabetic()).count();
    if run > 1 && NAMES.iter().any(|name| name.eq_ignore_ascii_case(&line[at..at + run])) {
        return (Kind::Name, at + run);
    }
    (Kind::Word(char::from(bytes[at].to_ascii_uppercase())), number(bytes, at + 1))
}

/// The end of a number that may begin here; blanks before and in it mean nothing.
fn number(bytes: &[u8], from: usize) -> usize {
    let mut end = from;
    let mut at = from;
    while let Some(c) = bytes.get(at) {
        let is_sign = (*c == b'-' || *c == b'+') && end == from;
        if c.is_ascii_digit() || *c == b'.' || is_sign {
            end = at + 1;
        } else if !c.is_ascii_whitespace() {
            break;
        }
        at += 1;
    }
    // A sign before what is no number belongs to that.
    if bytes[from..end].iter().any(u8::is_ascii_digit) { end } else { from }
}

fn digits(bytes: &[u8], from: usize) -> usize {
    from + bytes[from..].iter().take_while(|c| c.is_ascii_digit()).count()
}

/// The end of a label with the word behind it.
fn label(line: &str, at: usize, dialect: Dialect) -> usize {
    let rest = &line[at + 1..];
    let blanks = rest.len() - rest.trim_start().len();
    let begin = at + 1 + blanks;
    let end = match line.as_bytes().get(begin) {
        Some(b'<') => line[begin..].find('>').map_or(line.len(), |end| begin + end + 1),
        Some(b'#') => digits(line.as_bytes(), begin + 1),
        _ => digits(line.as_bytes(), begin),
    };
    if dialect != Dialect::Linuxcnc {
        return end;
    }
    let blanks = line[end..].len() - line[end..].trim_start().len();
    let word = line[end + blanks..].bytes().take_while(u8::is_ascii_alphabetic).count();
    if word > 0 { end + blanks + word } else { end }
}

/// The label and the word of a token that is one, in small letters without blanks: `100` and `sub`.
pub(crate) fn label_of(text: &str) -> (String, String) {
    let text: String = text.chars().skip(1).filter(|c| !c.is_whitespace()).collect::<String>().to_lowercase();
    let begins = |c: char| c.is_ascii_alphabetic();
    let end = match text.strip_prefix('<') {
        Some(rest) => rest.find('>').map_or(text.len(), |end| end + 2),
        None => text.find(begins).unwrap_or(text.len()),
    };
    let (label, word) = text.split_at(end);
    let label = label.trim_matches(['<', '>']);
    let number = label.trim_start_matches('0');
    let label = if number.is_empty() && !label.is_empty() { "0" } else { number };
    (label.to_owned(), word.to_owned())
}

#[cfg(test)]
mod tests {
    use super::{Kind, at, label_of, scan};
    use gcode::Dialect;

    fn pieces(line: &str, dialect: Dialect) -> Vec<&str> {
        scan(line, dialect).into_iter().map(|token| &line[token.at]).collect()
    }

    #[test]
    fn lines_are_taken_apart() {
        let ngc = Dialect::Linuxcnc;
        assert_eq!(
            pieces("/N10g0 x1 0.5Y-[#<a b>+2] (c) ;d", ngc),
            ["/", "N10", "g0", "x1 0.5", "Y", "-", "[", "#<a b>", "+", "2", "]", "(c)", ";d"]
        );
        assert_eq!(pieces("  o<bolts> call [sin[#1]]", ngc)[..3], ["o<bolts> call", "[", "sin"]);
        assert_eq!(
            pieces("IF[#1EQ2]GOTO10", Dialect::Fanuc),
            ["IF", "[", "#1", "EQ", "2", "]", "GOTO", "10"]
        );
        assert_eq!(pieces("O1000(A)", Dialect::Fanuc), ["O1000", "(A)"]);
        assert_eq!(pieces("G71P10Q20U-.5", Dialect::Fanuc), ["G71", "P10", "Q20", "U-.5"]);
        let broken = "(ä G1";
        assert_eq!(scan(broken, ngc)[0].kind, Kind::Comment);
    }

    #[test]
    fn labels_and_their_words() {
        for (text, label, word) in [
            ("o100 sub", "100", "sub"),
            ("O <Bolts> CALL", "bolts", "call"),
            ("O0010", "10", ""),
            ("o0", "0", ""),
        ] {
            assert_eq!(label_of(text), (label.to_owned(), word.to_owned()));
        }
    }

    #[test]
    fn where_two_words_meet_the_one_that_begins_there_is_meant() {
        let tokens = scan("g0x50", Dialect::Linuxcnc);
        assert_eq!(
            [0, 1, 2, 4, 5].map(|byte| at(&tokens, byte)),
            [Some(0), Some(0), Some(1), Some(1), Some(1)]
        );
        assert_eq!(at(&tokens, 9), None);
    }
}
