//! What a word means: the rows of the language pages that tell of it. In: a line, a place in it, what the
//! program around it says. Out: text in Markdown, or nothing.

use std::ops::Range;

use gcode::{
    Dialect,
    codes::{G, M, g_group},
};

use crate::pages::{Row, below, rows};
use crate::scan::{self, Kind, Token, label_of, scan};

/// What the program around a line says of its words.
#[derive(Clone, Copy, Debug)]
pub struct Around<'a> {
    /// The dialect that it is read in.
    pub dialect: Dialect,
    /// It is a lathe program of FANUC's G-code system B.
    pub system_b: bool,
    /// The code of motion or of a cycle that is in force, where the block has none of its own.
    pub modal: Option<&'a str>,
}

/// What stands at a byte of a line, and what it means.
pub fn meaning(line: &str, byte: usize, around: &Around) -> Option<(Range<usize>, String)> {
    let dialect = around.dialect;
    let tokens = scan(line, dialect);
    let token = &tokens[scan::at(&tokens, byte)?];
    let text = &line[token.at.clone()];
    let told = match token.kind {
        Kind::Word(letter @ ('G' | 'M')) => {
            let row = code(letter, text, around)?;
            titled(&name(letter, text)?, &group(row), row)
        }
        Kind::Word(letter) => Some(word(letter, &codes(line, &tokens), around)),
        Kind::Parameter => parameter(text, dialect).and_then(|row| titled(text, "", row)),
        Kind::Label => label(text, dialect),
        Kind::Comment => comment(text).and_then(|row| titled(row.cells[0].trim_matches('`'), "", row)),
        Kind::Name => named(text, dialect).and_then(|row| titled(&text.to_uppercase(), "", row)),
        Kind::Number | Kind::Sign => None,
    }?;
    Some((token.at.clone(), told))
}

/// The codes of a row that tells of several, in the order in which it does.
fn group(row: &Row) -> String {
    if row.names().nth(1).is_none() {
        return String::new();
    }
    row.names().collect::<Vec<_>>().join(" ") + ": "
}

fn titled(title: &str, group: &str, row: &Row) -> Option<String> {
    Some(format!("**{title}**  \n{group}{}", row.told()))
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
fn code(letter: char, text: &str, around: &Around) -> Option<&'static Row> {
    let (name, dialect) = (name(letter, text)?, around.dialect);
    if around.system_b {
        let mut rows = below(page(dialect), "G-code system B");
        if let Some(row) = rows.find(|row| row.names().any(|one| one == name)) {
            return Some(row);
        }
    }
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

/// What a letter means: to the codes of its block, to the one in force, and in itself.
fn word(letter: char, codes: &[String], around: &Around) -> String {
    let told = match around.dialect {
        Dialect::Linuxcnc => of_linuxcnc(letter, codes, around),
        Dialect::Fanuc | Dialect::FanucMill => of_fanuc(letter, codes, around),
    };
    [vec![format!("**{letter}**")], told].concat().join("  \n")
}

/// The codes of a block with that in force behind them, which none of theirs takes the place of.
fn acting<'a>(codes: &'a [String], around: &Around<'a>) -> impl Iterator<Item = &'a str> {
    let once = |code: &str| around.dialect == Dialect::Fanuc && code.starts_with("G7");
    let moves = codes.iter().any(|code| once(code) || is_motion(code, around.dialect, around.system_b));
    codes.iter().map(String::as_str).chain(around.modal.filter(|_| !moves))
}

/// Whether a code says how its words move the tool, until another one does.
pub(crate) fn is_motion(code: &str, dialect: Dialect, system_b: bool) -> bool {
    let number = code.strip_prefix('G').and_then(|number| number.parse::<f64>().ok());
    let Some(code) = number.map(|number| G((10.0 * number).round() as u16)) else { return false };
    let code = if system_b { gcode::in_system_a(code) } else { Some(code) };
    code.is_some_and(|code| match dialect {
        Dialect::Linuxcnc => g_group(code) == g_group(G(10)),
        Dialect::Fanuc => matches!(code.0, 0..40 | 320 | 340..=360 | 800..900 | 900 | 920 | 940),
        Dialect::FanucMill => matches!(code.0, 0..40 | 730..900),
    })
}

fn of_linuxcnc(letter: char, codes: &[String], around: &Around) -> Vec<String> {
    let belongs = |row: &&Row| row.has(0, letter);
    let own = |name: &str| {
        let words = below("gcode.md", "Words of the codes");
        let mut words = words.filter(|row| row.names().any(|one| one == name) && row.has(1, letter));
        if let Some(row) = words.next() {
            return Some(format!("of {name}: {}", row.meaning()));
        }
        let row = code(name.chars().next()?, name, around)?;
        let mut below = row.leads().into_iter().flat_map(|(page, section)| below(page, section));
        below.find(belongs).map(|row| format!("of {name}: {}", row.told()))
    };
    match acting(codes, around).find_map(own) {
        Some(own) => vec![own],
        None => below("gcode.md", "Other words").filter(belongs).map(Row::told).collect(),
    }
}

/// The first of the codes that has a meaning of its own for the letter tells it; else it is what it is
/// everywhere.
fn of_fanuc(letter: char, codes: &[String], around: &Around) -> Vec<String> {
    let dialect = around.dialect;
    let tables = [(page(dialect), "Words of the codes"), ("gcode-fanuc.md", "Words of calls")];
    let own = |name: &str| {
        let there = if around.system_b { in_system_a(name) } else { Some(name.to_owned()) }?;
        let rows = tables.iter().flat_map(|(page, section)| below(page, section));
        let mut rows = rows.filter(|row| row.names().any(|one| one == there) && row.has(1, letter));
        rows.next().map(|row| format!("of {name}: {}", row.meaning()))
    };
    if let Some(own) = acting(codes, around).find_map(own) {
        return vec![own];
    }
    let numbers = below("gcode-fanuc.md", "Numbers").filter(|row| !row.cells[0].contains(" of "));
    let numbers = numbers.filter(|_| dialect == Dialect::Fanuc);
    let rows = below(page(dialect), "Other words").chain(numbers);
    rows.filter(|row| row.has(0, letter)).map(Row::told).collect()
}

/// The name that a code of system B has in system A.
fn in_system_a(name: &str) -> Option<String> {
    let Some(number) = name.strip_prefix('G').and_then(|number| number.parse::<f64>().ok()) else {
        return Some(name.to_owned());
    };
    gcode::in_system_a(G((10.0 * number).round() as u16)).map(|code| code.to_string())
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
        return titled(&format!("O{label}"), "", row);
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
