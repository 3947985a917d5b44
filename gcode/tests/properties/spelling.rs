//! Spelling does not matter: a block that is printed from what was read of it does the same, and so does one
//! with other cases, blanks, zeros, signs, and its words in another order.

use std::fs;
use std::path::Path;

use gcode::{Dialect, Options, alone};
use proptest::prelude::*;

use crate::blocks::{Effect, block, effect};

/// A program with every line printed that says the same wherever it stands: no parameters, no O words, no
/// M99.
fn reprinted(text: &str) -> String {
    let options = Options::default();
    let line = |line: &str| {
        let lower = line.to_ascii_lowercase();
        let fixed = lower.contains(['#', 'o', '%', '/']) || lower.contains("99");
        let read = if fixed { None } else { alone::line(line.as_bytes(), &options).ok() };
        read.map_or_else(|| line.to_owned(), |read| read.to_string())
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n") + "\n"
}

#[test]
fn programs_that_are_printed_and_read_again_do_the_same() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/conformance/programs");
    let (mut programs, mut lines) = (0, 0);
    for entry in fs::read_dir(folder).expect("the programs are there").flatten() {
        let path = entry.path();
        if path.extension().is_none_or(|ending| ending != "ngc") {
            continue;
        }
        let text = String::from_utf8_lossy(&fs::read(&path).expect("it can be read")).into_owned();
        let again = reprinted(&text);
        programs += 1;
        lines += text.lines().zip(again.lines()).filter(|(one, other)| one != other).count();
        assert_eq!(effect(Dialect::Linuxcnc, &text), effect(Dialect::Linuxcnc, &again), "{}", path.display());
    }
    assert!(programs > 100 && lines > 1000, "{programs} programs, {lines} lines");
}

/// Another spelling of a word, chosen by bits.
fn respelled(word: &str, bits: u32) -> String {
    let (letter, number) =
        word.split_at(word.find(|c: char| c.is_ascii_digit() || "+-.".contains(c)).unwrap_or(0));
    let letter = if bits & 1 == 0 { letter.to_ascii_lowercase() } else { letter.to_owned() };
    let (sign, digits) = match number.strip_prefix('-') {
        Some(digits) => ("-", digits),
        None if bits & 2 == 0 => ("+", number),
        None => ("", number),
    };
    let zeros = if bits & 4 == 0 { "00" } else { "" };
    let behind = if bits & 8 == 0 && digits.contains('.') { "000" } else { "" };
    let blank = if bits & 16 == 0 { " " } else { "" };
    format!("{letter}{blank}{sign}{blank}{zeros}{digits}{blank}{behind}")
}

/// Lines of words in another spelling and order.
fn program_respelled(lines: &[Vec<String>], bits: &[u32]) -> String {
    let mut bits = bits.iter().cycle().copied();
    let mut next = || bits.next().unwrap_or(0);
    let mut text = String::new();
    for words in lines {
        let mut words: Vec<(u32, String)> =
            words.iter().map(|word| (next(), respelled(word, next()))).collect();
        words.sort();
        let gap = if next() & 1 == 0 { "" } else { " \t" };
        text.push_str(&words.into_iter().map(|(_, word)| word).collect::<Vec<_>>().join(gap));
        text.push('\n');
    }
    text
}

/// Leaves out the lines that are refused.
fn sound(dialect: Dialect, mut lines: Vec<Vec<String>>, begin: &str) -> Option<(Vec<Vec<String>>, Effect)> {
    for _ in 0..8 {
        let effect = effect(dialect, &text(begin, &plain(&lines)));
        if effect.errors.is_empty() {
            return Some((lines, effect));
        }
        let first = begin.lines().count() as u32 + 1;
        let mut at = first;
        lines.retain(|_| {
            at += 1;
            effect.errors.iter().all(|(line, _)| *line != at - 1)
        });
    }
    None
}

fn plain(lines: &[Vec<String>]) -> String {
    lines.iter().map(|words| words.join(" ") + "\n").collect()
}

fn text(begin: &str, lines: &str) -> String {
    format!("{begin}\n{lines}M30\n")
}

fn same(dialect: Dialect, begin: &str, lines: Vec<Vec<String>>, bits: &[u32]) -> Result<(), TestCaseError> {
    let Some((lines, whole)) = sound(dialect, lines, begin) else { return Ok(()) };
    let other = program_respelled(&lines, bits);
    let again = effect(dialect, &text(begin, &other));
    prop_assert_eq!(&whole, &again, "{}\n{}", plain(&lines), other);
    if dialect == Dialect::Linuxcnc {
        let again = effect(dialect, &text(begin, &reprinted(&other)));
        prop_assert_eq!(&whole, &again, "{}\n{}", plain(&lines), reprinted(&other));
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn spelling_and_order_do_not_matter(
        lines in prop::collection::vec(block(Dialect::Linuxcnc), 1..8), bits in prop::collection::vec(any::<u32>(), 30),
    ) {
        same(Dialect::Linuxcnc, "F100 S100 M3\nG0 X31 Y11 Z23", lines, &bits)?;
    }

    #[test]
    fn spelling_and_order_do_not_matter_to_fanuc(
        lines in prop::collection::vec(block(Dialect::Fanuc), 1..8), bits in prop::collection::vec(any::<u32>(), 30),
    ) {
        same(Dialect::Fanuc, "F.1 S100 M03\nG00 X50. Z5.", lines, &bits)?;
    }

    #[test]
    fn spelling_and_order_do_not_matter_to_a_fanuc_mill(
        lines in prop::collection::vec(block(Dialect::FanucMill), 1..8), bits in prop::collection::vec(any::<u32>(), 30),
    ) {
        same(Dialect::FanucMill, "F100. S100 M03\nG00 X31. Y11. Z23.", lines, &bits)?;
    }

    /// A number that is printed with all its digits is the same number again.
    #[test]
    fn numbers_are_read_as_they_are_printed(value in prop_oneof![-1e6..1e6f64, -1.0..1.0, -1e-6..1e-6, -1e15..1e15]) {
        for dialect in Dialect::ALL {
            let options = Options { dialect, ..Options::default() };
            let read = alone::value(value.to_string().as_bytes(), &options);
            prop_assert_eq!(read.ok().flatten(), Some(value));
        }
    }
}
