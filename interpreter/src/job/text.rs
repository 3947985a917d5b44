//! The text of a job. In: TOML, with or without the header `[job]`. Out: the keys that every kind has, those
//! of its kind, and where a key stands in the text.

use std::ops::Range;

use serde::de::{Deserialize, DeserializeOwned};
use toml::Spanned;
use toml::de::{DeTable, DeValue, Deserializer, Error};

use super::{Fault, Header, Kind};

/// Keys of [`Header`].
const HEADER: [&str; 9] = [
    "kind",
    "feed_mm_min",
    "chord_mm",
    "correction",
    "name",
    "origin_mm",
    "spindle_rpm",
    "tool_number",
    "coolant",
];

/// Where jobs are described, and seams.
const PAGE: &str = "docs/surfaces.md";
const SEAMS: &str = "docs/positioner.md";

/// A job that was read.
pub(crate) struct Text<'a> {
    /// What every kind has.
    pub(crate) header: Header,
    text: &'a str,
    keys: Spanned<DeTable<'a>>,
}

impl<'a> Text<'a> {
    /// Reads a job.
    ///
    /// # Errors
    /// Not TOML, or a key that every kind has is missing or wrong.
    pub(crate) fn read(text: &'a str) -> Result<Text<'a>, Fault> {
        let refuse = |error| syntax(text, &error, PAGE);
        let table = table(text).map_err(refuse)?;
        let (span, all) = (table.span(), table.into_inner());
        let of_header = |key: &str| HEADER.contains(&key);
        let (header, keys): (DeTable, DeTable) =
            all.into_iter().partition(|(key, _)| of_header(key.get_ref()));
        let header = Header::deserialize(Deserializer::from(Spanned::new(span.clone(), header)));
        Ok(Text { header: header.map_err(refuse)?, text, keys: Spanned::new(span, keys) })
    }

    /// Diameter of the tool, if it is told, mm.
    pub(crate) fn diameter_mm(&self) -> Option<f64> {
        match self.keys.get_ref().get("tool")?.get_ref().as_table()?.get("diameter_mm")?.get_ref() {
            DeValue::Float(mm) => mm.as_str().parse().ok(),
            DeValue::Integer(mm) => mm.as_str().parse().ok(),
            _ => None,
        }
    }

    /// The keys of its kind.
    ///
    /// # Errors
    /// A key that is missing, unknown, or of another type.
    pub(crate) fn keys<T: DeserializeOwned>(self) -> Result<T, Fault> {
        let page = if self.header.kind == Kind::Seam { SEAMS } else { PAGE };
        T::deserialize(Deserializer::from(self.keys)).map_err(|error| syntax(self.text, &error, page))
    }
}

/// Bytes of the text that a fault is about.
pub(crate) fn bytes(text: &str, fault: &Fault) -> Range<usize> {
    if fault.key.is_empty() {
        return fault.part.clone().unwrap_or(0..0);
    }
    let Ok(table) = table(text) else { return 0..0 };
    let (mut span, mut value) = (0..0, DeValue::Table(table.into_inner()));
    for name in fault.key.split('.') {
        let DeValue::Table(table) = value else { break };
        let Some((key, inner)) = table.into_iter().find(|(key, _)| key.get_ref() == name) else { break };
        let of_value = inner.span();
        span = key.span().start..of_value.end;
        value = inner.into_inner();
        if let (Some(part), DeValue::String(string)) = (&fault.part, &value) {
            // A formula as it stands in the text, but for its quotes; else all of it is to blame.
            let first = of_value.start + 1;
            let is_plain = text.get(first..of_value.end.saturating_sub(1)) == Some(&**string);
            return if is_plain { first + part.start..first + part.end } else { of_value };
        }
    }
    span
}

/// The table that holds the keys.
fn table(text: &str) -> Result<Spanned<DeTable<'_>>, Error> {
    let table = DeTable::parse(text)?;
    let span = table.span();
    let all = table.into_inner();
    let has_header = all.iter().all(|(key, value)| key.get_ref() == "job" && value.get_ref().is_table());
    if all.len() != 1 || !has_header {
        return Ok(Spanned::new(span, all));
    }
    let inner = all.into_iter().next().map(|(_, value)| (value.span(), value.into_inner()));
    match inner {
        Some((span, DeValue::Table(table))) => Ok(Spanned::new(span, table)),
        _ => Ok(Spanned::new(span, DeTable::new())),
    }
}

/// What the reader of TOML found; the page that says what is right.
fn syntax(text: &str, error: &Error, page: &str) -> Fault {
    let (message, part) = (error.message(), error.span());
    if let Some(fault) = unknown(text, message, &part, page) {
        return fault;
    }
    if message == "missing field `kind`" && text.lines().any(|line| line.trim() == "[machine]") {
        let message = "this is a machine file, and not a program".to_owned();
        let help =
            "give it behind --machine, and name a program: `pitchlock run PROGRAM --machine FILE`".to_owned();
        return Fault { code: "job", key: "machine".into(), part: None, message, help };
    }
    let help = if part.as_ref().is_some_and(|part| has_parameter(text, part.start)) {
        "# begins a comment here: parameters such as #1 are not read in jobs, write the number".to_owned()
    } else if message.starts_with("missing field") {
        format!(
            "add it; in a program every line of a job begins with ;@, an empty one ends it; {page} shows a whole job; a \
             scenario is given behind --scenario"
        )
    } else {
        format!("{page} lists the keys and their values")
    };
    Fault { code: "job", key: String::new(), part, message: message.to_owned(), help }
}

/// A key that its table does not have. The message names it, and those that the table has.
fn unknown(text: &str, message: &str, part: &Option<Range<usize>>, page: &str) -> Option<Fault> {
    let name = message.strip_prefix("unknown field `")?.split('`').next()?;
    let table = table(text).ok()?;
    let blamed = |span: Range<usize>| part.as_ref().is_none_or(|part| part.contains(&span.start));
    let has = |table: &DeTable| table.keys().any(|key| key.get_ref() == name && blamed(key.span()));
    let inner = table.get_ref().iter().find_map(|(key, value)| match value.get_ref() {
        DeValue::Table(inner) if has(inner) => Some(key.get_ref().as_ref()),
        _ => None,
    });
    let Some(inner) = inner.filter(|_| !has(table.get_ref())) else {
        let help = format!("every job has {}; {page} lists the others", HEADER.join(", "));
        return Some(Fault::new(name, message, help));
    };
    // Serde tells the patterns of a path apart by this key, and does not count it.
    let all = if inner == "path" { "expected one of `pattern`, " } else { "expected one of " };
    let message = message.replacen("expected one of ", all, 1);
    Some(Fault::new(
        &format!("{inner}.{name}"),
        message,
        format!("these are the keys of {inner}; see {page}"),
    ))
}

/// Whether the line at a byte, or the line before it, has a parameter of G-code: `#1`, `#<name>`, `#[1 + 2]`.
fn has_parameter(text: &str, at: usize) -> bool {
    let before = text.get(..at).unwrap_or_default();
    let start = before.rmatch_indices('\n').nth(1).map_or(0, |(at, _)| at + 1);
    let lines = before.matches('\n').count().min(1) + 1;
    let mut lines = text.get(start..).unwrap_or_default().lines().take(lines);
    let begins = |rest: &str| rest.starts_with(|c: char| c.is_ascii_digit() || c == '<' || c == '[');
    lines.any(|line| line.split('#').skip(1).any(begins))
}
