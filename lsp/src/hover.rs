//! What a word means: the rows of the language pages that tell of it. In: a line, a place in it, a dialect.
//! Out: text in Markdown, or nothing.

use std::ops::Range;

use gcode::{
    Dialect,
    codes::{G, M},
};

use crate::pages::{Row, below, rows};
use crate::scan::{self, Kind, Token, label_of, scan};

/// What stands at a byte of a line, and what it means; `modal` is the code that is in force, where the block
/// has none of its own.
pub fn meaning(
    line: &str,
    byte: usize,
    dialect: Dialect,
    modal: Option<&str>,
) -> Option<(Range<usize>, String)> {
    let tokens = scan(line, dialect);
    let token = &tokens[scan::at(&tokens, byte)?];
    let text = &line[token.at.clone()];
    let told = match token.kind {
        Kind::Word(letter @ ('G' | 'M')) => {
            code(letter, text, dialect).and_then(|row| titled(&name(letter, text)?, row))
        }
        Kind::Word(letter) => Some(word(letter, &codes(line, &tokens), dialect, modal)),
        Kind::Parameter => parameter(text, dialect).and_then(|row| titled(text, row)),
        Kind::Label => label(text, dialect),
        Kind::Comment => comment(text).and_then(|row| titled(row.cells[0].trim_matches('`'), row)),
        Kind::Name => named(text, dialect).and_then(|row| titled(&text.to_uppercase(), row)),
        Kind::Number | Kind::Sign => None,
    }?;
    Some((token.at.clone(), told))
}

fn titled(title: &str, row: &Row) -> Option<String> {
    Some(format!("**{title}**  \n{}", row.told()))
}

const fn page(dialect: Dialect) -> &'static str {
    match dialect {
        Dialect::Linuxcnc => "gcode.md",
        Dialect::Fanuc => "gcode-fanuc.md",
        Dialect::FanucMill => "gcode-fanuc-mill.md",
    }
}

/// `G76` of `g 076`.
pub(crate) fn name(letter: char, text: &str) -> Option<String> {
    let number: String = text.chars().skip(1).filter(|c| !c.is_whitespace()).collect();
    let number: f64 = number.parse().ok()?;
    let tenths = (number * 10.0).round();
    if !(0.0..=f64::from(u16::MAX)).contains(&tenths) {
        return None;
    }
    Some(if letter == 'G' { G(tenths as u16).to_string() } else { M((tenths / 10.0) as u16).to_string() })
}

/// The row of a code.
fn code(letter: char, text: &str, dialect: Dialect) -> Option<&'static Row> {
    let name = name(letter, text)?;
    let tables: &[&str] = if letter == 'G' { &["G codes", "Refused by name"] } else { &["M codes"] };
    // M codes of lathes are also those of mills.
    let pages = [page(dialect), "gcode-fanuc.md"];
    let pages = if dialect == Dialect::FanucMill && letter == 'M' { &pages[..] } else { &pages[..1] };
    let mut rows = pages.iter().flat_map(|page| tables.iter().flat_map(|table| below(page, table)));
    rows.find(|row| row.names().any(|one| one == name))
}

/// The codes of a block.
pub(crate) fn codes(line: &str, tokens: &[Token]) -> Vec<String> {
    let of = |token: &Token| match token.kind {
        Kind::Word(letter @ ('G' | 'M')) => name(letter, &line[token.at.clone()]),
        _ => None,
    };
    tokens.iter().filter_map(of).collect()
}

/// What a letter means: to the codes of its block, and in itself.
fn word(letter: char, codes: &[String], dialect: Dialect, modal: Option<&str>) -> String {
    let of: Vec<&str> = codes.iter().map(String::as_str).chain(modal).collect();
    let told = match dialect {
        Dialect::Linuxcnc => of_linuxcnc(letter, &of),
        Dialect::Fanuc | Dialect::FanucMill => of_fanuc(letter, &of, dialect),
    };
    [vec![format!("**{letter}**")], told].concat().join("  \n")
}

fn of_linuxcnc(letter: char, codes: &[&str]) -> Vec<String> {
    let mut told = Vec::new();
    let belongs = |row: &&Row| row.has(0, letter);
    for name in codes {
        let Some(first) = name.chars().next() else { continue };
        let Some(row) = code(first, name, Dialect::Linuxcnc) else { continue };
        let below = row.leads().into_iter().flat_map(|(page, section)| below(page, section));
        let own: Vec<String> = below.filter(belongs).map(Row::told).collect();
        let column = row.head.iter().position(|head| *head == "words").and_then(|at| row.cells.get(at));
        match (own.is_empty(), column) {
            (false, _) => told.extend(own.into_iter().map(|own| format!("of {name}: {own}"))),
            (true, Some(words)) if words.contains(letter) => told.push(format!("{name} takes: {words}")),
            _ => {}
        }
    }
    told.extend(below("gcode.md", "Other words").filter(belongs).map(Row::told));
    told
}

/// The first of the codes that has a meaning of its own for the letter tells it; else it is what it is
/// everywhere.
fn of_fanuc(letter: char, codes: &[&str], dialect: Dialect) -> Vec<String> {
    let tables = [(page(dialect), "Words of the codes"), ("gcode-fanuc.md", "Words of calls")];
    let own = |name: &&str| {
        let rows = tables.iter().flat_map(|(page, section)| below(page, section));
        let mut rows = rows.filter(|row| row.names().any(|one| one == *name) && row.has(1, letter));
        rows.next().map(|row| format!("of {name}: {}", row.meaning()))
    };
    if let Some(own) = codes.iter().find_map(own) {
        return vec![own];
    }
    let numbers = below("gcode-fanuc.md", "Numbers").filter(|row| !row.cells[0].contains(" of "));
    let numbers = numbers.filter(|_| dialect == Dialect::Fanuc);
    let rows = below(page(dialect), "Other words").chain(numbers);
    rows.filter(|row| row.has(0, letter)).map(Row::told).collect()
}

/// The row of a parameter: the one that names it, or the narrowest range that holds it.
fn parameter(text: &str, dialect: Dialect) -> Option<&'static Row> {
    let tables = match dialect {
        Dialect::Linuxcnc => {
            [("gcode-parameters.md", "What tells the state"), ("gcode-parameters.md", "Parameters")]
        }
        Dialect::Fanuc | Dialect::FanucMill => [("gcode-fanuc.md", "Macros"); 2],
    };
    let mut rows = tables.into_iter().flat_map(|(page, section)| below(page, section));
    if let Some(name) = text.strip_prefix("#<") {
        let name: String = name.chars().filter(|c| !c.is_whitespace()).collect::<String>().to_lowercase();
        let kind = if name.starts_with('_') { "#<_name>" } else { "#<name>" };
        let said = format!("#<{name}");
        let mut all = rows.collect::<Vec<_>>().into_iter();
        return all
            .clone()
            .find(|row| row.cells[0].contains(&said))
            .or_else(|| all.find(|row| row.cells[0].contains(kind)));
    }
    let number: u32 = text.strip_prefix('#')?.parse().ok()?;
    let width = |row: &Row| {
        ranges(&row.cells.join(" "))
            .into_iter()
            .filter(|range| range.contains(&number))
            .map(|r| r.len())
            .min()
    };
    rows.by_ref()
        .filter_map(|row| Some((width(row)?, row)))
        .min_by_key(|(width, _)| *width)
        .map(|(_, row)| row)
}

/// The numbers behind `#` of a text, and the ranges that `to` makes of two.
fn ranges(text: &str) -> Vec<Range<u32>> {
    let mut ranges: Vec<Range<u32>> = Vec::new();
    let mut to = false;
    for word in text.split([' ', '`', ',', ';']).filter(|word| !word.is_empty()) {
        match word.strip_prefix('#').and_then(|number| number.parse::<u32>().ok()) {
            Some(number) if to => {
                if let Some(last) = ranges.last_mut() {
                    last.end = last.end.max(number + 1);
                }
            }
            Some(number) => ranges.push(number..number + 1),
            None => {}
        }
        to = word == "to";
    }
    ranges
}

fn label(text: &str, dialect: Dialect) -> Option<String> {
    let (label, word) = label_of(text);
    if dialect != Dialect::Linuxcnc {
        let row = below("gcode-fanuc.md", "Other words").find(|row| row.names().any(|name| name == "O"))?;
        return titled(&format!("O{label}"), row);
    }
    let row = if word.is_empty() {
        below("gcode.md", "M codes").find(|row| row.names().any(|name| name == "M98"))
    } else {
        below("gcode-parameters.md", "O words").find(|row| row.names().any(|name| name == word))
    }?;
    let words = row.cells[0].replace('`', "");
    Some(format!("**o{label} {word}**: {words}  \n{}", row.told()))
}

/// The row of a comment that means something.
fn comment(text: &str) -> Option<&'static Row> {
    let inside = text.strip_prefix('(')?.trim_start();
    let word: String = inside.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    let comma = inside[word.len()..].trim_start().starts_with([',', ')']);
    let tables = below("gcode-parameters.md", "Messages").chain(below("gcode.md", "Comments"));
    let says = |cell: &str| {
        cell.split('(').skip(1).any(|one| {
            let name: String = one.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            name.eq_ignore_ascii_case(&word)
        })
    };
    tables.into_iter().find(|row| comma && !word.is_empty() && says(row.cells[0]))
}

/// The row of a function, an operator, or a word of the flow.
fn named(text: &str, dialect: Dialect) -> Option<&'static Row> {
    let name = text.to_uppercase();
    let own = |row: &&Row| match dialect {
        Dialect::Linuxcnc => row.page == "gcode-parameters.md" && row.section == "Expressions",
        Dialect::Fanuc | Dialect::FanucMill => row.page == "gcode-fanuc.md" && row.section == "Macros",
    };
    let says = |row: &&Row| {
        let words = row.cells.iter().flat_map(|cell| cell.split(|c: char| !c.is_ascii_alphabetic()));
        words.into_iter().any(|word| word == name)
    };
    rows().iter().filter(own).find(says)
}
