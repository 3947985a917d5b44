//! Where a subroutine is that a line calls, or the block that it leads to. In: a line, a place in it, the
//! lines of its program, folders with other files. Out: a file, and a line of it from 0.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use gcode::Dialect;

use crate::hover::codes;
use crate::scan::{self, Kind, Token, label_of, scan};

/// What is looked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    /// A subroutine, or a program that M98 or G65 calls.
    Label(String),
    /// A block N.
    Block(u32),
}

/// What a place of a line leads to.
pub(crate) fn target(line: &str, byte: usize, dialect: Dialect) -> Option<Target> {
    let tokens = scan(line, dialect);
    let at = scan::at(&tokens, byte)?;
    let text = |token: &Token| &line[token.at.clone()];
    let codes = codes(line, &tokens);
    let has = |names: &[&str]| codes.iter().any(|code| names.contains(&code.as_str()));
    let token = &tokens[at];
    let number = || text(token)[1..].trim().parse::<u32>().ok();
    match token.kind {
        Kind::Label => Some(Target::Label(label_of(text(token)).0)),
        Kind::Word('P') if has(&["M98", "G65", "G66"]) => {
            let number = number()?;
            let repeats = tokens.iter().any(|token| token.kind == Kind::Word('L'));
            // Without L the digits of M98 before the last four say how often.
            let both = dialect != Dialect::Linuxcnc && has(&["M98"]) && !repeats && number > 9999;
            Some(Target::Label(if both { number % 10_000 } else { number }.to_string()))
        }
        Kind::Word('P') if dialect != Dialect::Linuxcnc && has(&["M97"]) => number().map(Target::Block),
        Kind::Word('P' | 'Q') if dialect != Dialect::Linuxcnc && has(&["G70", "G71", "G72", "G73"]) => {
            number().map(Target::Block)
        }
        Kind::Word('Q') if has(&["G70", "G71", "G71.1", "G71.2", "G72", "G72.1", "G72.2"]) => {
            Some(Target::Label(number()?.to_string()))
        }
        Kind::Number if at > 0 && text(&tokens[at - 1]).eq_ignore_ascii_case("GOTO") => {
            text(token).trim().parse().ok().map(Target::Block)
        }
        _ => None,
    }
}

/// The line at which it begins; the block N nearest behind a line, as a jump looks for it.
pub(crate) fn find(lines: &[Arc<str>], target: &Target, from: u32, dialect: Dialect) -> Option<u32> {
    let begins = |line: &str| match target {
        Target::Label(label) => {
            let first = first(line, dialect, |kind| kind == Kind::Label);
            first.map(label_of).is_some_and(|(found, word)| {
                found == *label && (word == "sub" || word.is_empty() || dialect != Dialect::Linuxcnc)
            })
        }
        Target::Block(number) => {
            let first = first(line, dialect, |kind| kind == Kind::Word('N'));
            first.is_some_and(|text| text[1..].trim().parse() == Ok(*number))
        }
    };
    let letter = if matches!(target, Target::Label(_)) { ['o', 'O'] } else { ['n', 'N'] };
    let numbered = || (0_u32..).zip(lines).filter(|(_, line)| line.contains(letter));
    let mut found = numbered().filter(|(_, line)| begins(line)).map(|(number, _)| number);
    match target {
        Target::Label(_) => found.next(),
        Target::Block(_) => {
            let all: Vec<u32> = found.collect();
            all.iter().find(|number| **number >= from).or(all.first()).copied()
        }
    }
}

/// The first piece of a line, if it is one of a kind.
fn first(line: &str, dialect: Dialect, is: impl Fn(Kind) -> bool) -> Option<&str> {
    let tokens = scan(line, dialect);
    let first = tokens.into_iter().find(|token| token.kind != Kind::Sign)?;
    is(first.kind).then(|| &line[first.at])
}

/// The file that a subroutine is in, which is not in its program.
pub(crate) fn file(label: &str, folders: &[PathBuf], dialect: Dialect) -> Option<PathBuf> {
    if label.contains(['/', '\\']) || label.starts_with('.') {
        return None;
    }
    let names = match dialect {
        Dialect::Linuxcnc => vec![format!("{label}.ngc")],
        Dialect::Fanuc | Dialect::FanucMill => gcode::program_files(label.parse().ok()?).collect(),
    };
    let named = |name: &String| folders.iter().map(|folder| folder.join(name)).find(|path| path.is_file());
    names.iter().find_map(named)
}

/// The path of a document, if it is a file.
pub(crate) fn path_of(uri: &str) -> Option<PathBuf> {
    let path = uri.strip_prefix("file://")?;
    let mut bytes = Vec::new();
    let mut rest = path.as_bytes();
    while let Some((c, behind)) = rest.split_first() {
        let code = behind.get(..2).and_then(|code| std::str::from_utf8(code).ok());
        match code.and_then(|code| u8::from_str_radix(code, 16).ok()).filter(|_| *c == b'%') {
            Some(byte) => {
                bytes.push(byte);
                rest = &behind[2..];
            }
            None => {
                bytes.push(*c);
                rest = behind;
            }
        }
    }
    String::from_utf8(bytes).ok().map(PathBuf::from)
}

/// The name of a file as documents have it.
pub(crate) fn uri_of(path: &Path) -> String {
    let plain = |c: &u8| c.is_ascii_alphanumeric() || b"/-_.~".contains(c);
    let bytes = path.to_string_lossy().into_owned().into_bytes();
    let text = bytes.iter().map(|c| if plain(c) { char::from(*c).to_string() } else { format!("%{c:02X}") });
    format!("file://{}", text.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::{Target, find, path_of, target, uri_of};
    use gcode::Dialect;
    use std::path::Path;

    #[test]
    fn calls_and_jumps_lead_somewhere() {
        let label = |label: &str| Some(Target::Label(label.into()));
        for (line, at, dialect, wanted) in [
            ("o<bolts> call [1]", 3, Dialect::Linuxcnc, label("bolts")),
            ("M98 P0200 L2", 5, Dialect::Linuxcnc, label("200")),
            ("G71 Q100 D1", 5, Dialect::Linuxcnc, label("100")),
            ("M98 P21000", 6, Dialect::Fanuc, label("1000")),
            ("M98 P21000 L3", 6, Dialect::Fanuc, label("21000")),
            ("G65 P9100 A1.", 6, Dialect::Fanuc, label("9100")),
            ("G65 P12000 A1.", 6, Dialect::Fanuc, label("12000")),
            ("G66 P9100 A1.", 6, Dialect::FanucMill, label("9100")),
            ("M97 P100 L2", 6, Dialect::FanucMill, Some(Target::Block(100))),
            ("G71 P10 Q20 U1.", 9, Dialect::Fanuc, Some(Target::Block(20))),
            ("IF [#1 EQ 2] GOTO 90", 19, Dialect::Fanuc, Some(Target::Block(90))),
            ("G0 X1", 4, Dialect::Linuxcnc, None),
        ] {
            assert_eq!(target(line, at, dialect), wanted, "{line}");
        }
        let lines: Vec<_> = ["N90", "o<Bolts> call", "o<bolts> sub", "N0090 G0"].map(Into::into).into();
        assert_eq!(find(&lines, &Target::Label("bolts".into()), 0, Dialect::Linuxcnc), Some(2));
        assert_eq!(find(&lines, &Target::Block(90), 1, Dialect::Fanuc), Some(3));
        assert_eq!(find(&lines, &Target::Block(90), 9, Dialect::Fanuc), Some(0));
    }

    #[test]
    fn names_of_documents() {
        let path = Path::new("/a b/ä%.ngc");
        assert_eq!(uri_of(path), "file:///a%20b/%C3%A4%25.ngc");
        assert_eq!(path_of(&uri_of(path)).as_deref(), Some(path));
        assert_eq!(path_of("untitled:1"), None);
    }
}
