//! The tool table, in the form that LinuxCNC keeps it in.
//!
//! One tool a line, words in any order, a comment after a semicolon:
//! ```text
//! T11 P11 X-12.4 Z-35.6 D1.6 I95 J155 Q2 ;turning tool, tip radius 0.8
//! ```
//! T and P are whole numbers, Q is 0 to 9, all others decimal numbers in units of the machine or degrees.

use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use super::{FileError, decimal, replace, words::Words};
use crate::canon::Pose;
use crate::problem::Diagnostic;

/// A tool: lengths in units of the machine, X a radius, angles in degrees.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tool {
    /// Its line in the table, from 1; 0 for what is in the spindle.
    pub index: u32,
    /// T: number of the tool, -1 for none.
    pub number: i32,
    /// P: its pocket.
    pub pocket: i32,
    /// Offset in every axis.
    pub offset: Pose,
    /// Offsets of U, V, W: kept for machines that have these axes.
    pub uvw: [f64; 3],
    /// D: diameter; of a turning tool twice the radius of its nose.
    pub diameter: f64,
    /// I: angle of the front edge.
    pub front_angle: f64,
    /// J: angle of the back edge.
    pub back_angle: f64,
    /// Q: orientation of a turning tool, 0 to 9.
    pub orientation: u8,
    /// What stands after the semicolon.
    pub comment: String,
}

impl Tool {
    /// What a table says of it besides T and P, by letter; 0 for what it leaves out.
    pub fn words(&self) -> [(char, f64); 13] {
        let ([x, y, z, a, b, c], [u, v, w]) = (self.offset, self.uvw);
        let offsets =
            [('X', x), ('Y', y), ('Z', z), ('A', a), ('B', b), ('C', c), ('U', u), ('V', v), ('W', w)];
        let edges = [('D', self.diameter), ('I', self.front_angle), ('J', self.back_angle)];
        let mut words = [('Q', f64::from(self.orientation)); 13];
        for (word, known) in words.iter_mut().zip(offsets.into_iter().chain(edges)) {
            *word = known;
        }
        words
    }
}

/// Tools by number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ToolTable {
    /// What is in the spindle: a copy of a tool (LinuxCNC's entry 0).
    pub in_spindle: Tool,
    tools: Vec<Tool>,
}

impl ToolTable {
    /// The tool of a number.
    pub fn find(&self, number: i32) -> Option<&Tool> {
        self.tools.iter().find(|tool| tool.number == number)
    }

    /// Puts a tool into the table: in place of that with its number, else at the end. Its `index` is set.
    pub fn set(&mut self, tool: Tool) {
        match self.find_mut(tool.number) {
            Some(old) => *old = Tool { index: old.index, ..tool },
            None => self.tools.push(Tool { index: self.tools.len() as u32 + 1, ..tool }),
        }
    }

    /// The tool of a number, to be changed; its number must stay.
    pub fn find_mut(&mut self, number: i32) -> Option<&mut Tool> {
        self.tools.iter_mut().find(|tool| tool.number == number)
    }

    /// Whether there is no tool at all: no table was given.
    pub fn is_empty(&self) -> bool {
        self.tools.is_empty()
    }

    /// The tools, in the order of the table.
    pub fn iter(&self) -> impl Iterator<Item = &Tool> {
        self.tools.iter()
    }

    /// Reads a table.
    ///
    /// # Errors
    /// The file cannot be read, or a line of it is not a tool.
    pub fn read(path: &Path) -> Result<ToolTable, FileError> {
        let text = super::read(path)?;
        Ok(ToolTable::parse(&path.display().to_string(), &text)?)
    }

    /// Reads a table from a text; `name` is what messages call it.
    ///
    /// # Errors
    /// The first line that is not a tool.
    pub fn parse(name: &str, text: &str) -> Result<ToolTable, Box<Diagnostic>> {
        let name: Arc<str> = name.into();
        let mut table = ToolTable::default();
        for (n, line) in text.lines().enumerate() {
            let mut words = Words::new(&name, n as u32 + 1, line);
            if let Some(tool) = tool(&mut words)? {
                if table.find(tool.number).is_some() {
                    let message = format!("T{} stands in this table already", tool.number);
                    return Err(words.wrong(message, "give every tool a number of its own"));
                }
                table.set(tool);
            }
        }
        Ok(table)
    }

    /// The text of a table with some words of tools changed.
    pub(super) fn changed(path: &Path, old: &str, words: &[(i32, char, f64)]) -> Result<String, FileError> {
        let name = path.display().to_string();
        ToolTable::parse(&name, old)?;
        let change = |text: String, (number, letter, value): &_| changed(&text, *number, *letter, *value);
        let text = words.iter().fold(old.to_owned(), change);
        ToolTable::parse(&name, &text)?;
        Ok(text)
    }

    /// What is other in this table than in `old`, as words of [`Changes::tools`](super::Changes::tools).
    pub fn changes_since(&self, old: &ToolTable) -> Vec<(i32, char, f64)> {
        let nothing = Tool::default();
        let words = |tool: &Tool| {
            let before = old.find(tool.number).unwrap_or(&nothing).words();
            let changed =
                tool.words().into_iter().zip(before).filter(|((_, now), (_, before))| now != before);
            let number = tool.number;
            changed.map(|((letter, value), _)| (number, letter, value)).collect::<Vec<_>>()
        };
        self.tools.iter().flat_map(words).collect()
    }

    /// The table as the text of a file.
    pub fn to_text(&self) -> String {
        self.tools.iter().map(line_of).collect()
    }

    /// Writes the table: first beside the old one, then in its place, so that there is a whole table at any
    /// time.
    ///
    /// # Errors
    /// The file cannot be written; the old one is as it was.
    pub fn write(&self, path: &Path) -> Result<(), FileError> {
        replace(path, self.to_text().as_bytes())
    }
}

/// The tool of a line; `None` for one that is blank or all comment.
fn tool(words: &mut Words<'_>) -> Result<Option<Tool>, Box<Diagnostic>> {
    let mut tool = Tool { number: -1, ..Tool::default() };
    while let Some(letter) = words.next_letter()? {
        match letter {
            'T' => tool.number = words.whole(1, i32::MAX)?,
            'P' => tool.pocket = words.whole(0, i32::MAX)?,
            'Q' => tool.orientation = words.whole(0, 9)? as u8,
            'X' => tool.offset[0] = words.number()?,
            'Y' => tool.offset[1] = words.number()?,
            'Z' => tool.offset[2] = words.number()?,
            'A' => tool.offset[3] = words.number()?,
            'B' => tool.offset[4] = words.number()?,
            'C' => tool.offset[5] = words.number()?,
            'U' => tool.uvw[0] = words.number()?,
            'V' => tool.uvw[1] = words.number()?,
            'W' => tool.uvw[2] = words.number()?,
            'D' => tool.diameter = words.number()?,
            'I' => tool.front_angle = words.number()?,
            'J' => tool.back_angle = words.number()?,
            _ => {
                let help = "words of a tool are T P X Y Z A B C U V W D I J Q; a comment begins with `;`";
                return Err(words.wrong(format!("{letter} says nothing about a tool"), help));
            }
        }
    }
    if words.is_blank() {
        return Ok(None);
    }
    if tool.number < 0 {
        return Err(words.wrong("this tool has no number", "begin the line with T and its number"));
    }
    tool.comment = words.comment().to_owned();
    Ok(Some(tool))
}

fn line_of(tool: &Tool) -> String {
    let mut line = format!("T{} P{}", tool.number, tool.pocket);
    for (letter, value) in tool.words().into_iter().filter(|(_, value)| *value != 0.0) {
        let _ = write!(line, " {letter}{value}"); // a string takes everything
    }
    if !tool.comment.is_empty() {
        let _ = write!(line, " ;{}", tool.comment);
    }
    line + "\n"
}

/// The text of a table with one word of a tool changed.
fn changed(text: &str, number: i32, letter: char, value: f64) -> String {
    let is_of = |line: &str| place(line, 'T').is_some_and(|place| line[place].trim().parse() == Ok(number));
    let mut found = false;
    let mut out: String = text
        .split_inclusive('\n')
        .map(|line| {
            found |= is_of(line);
            if is_of(line) { with_word(line, letter, value) } else { line.to_owned() }
        })
        .collect();
    if !found {
        if !out.is_empty() && !out.ends_with('\n') {
            out.push('\n');
        }
        out += &with_word(&format!("T{number} P{number}\n"), letter, value);
    }
    out
}

/// A line of a tool with a word changed, or added behind its other words.
fn with_word(line: &str, letter: char, value: f64) -> String {
    let value = decimal(value);
    match place(line, letter) {
        Some(place) => format!("{}{value}{}", &line[..place.start], &line[place.end..]),
        None if value == "0" => line.to_owned(),
        None => {
            let words = line.split_once(';').map_or(line, |(words, _)| words).trim_end();
            format!("{words} {letter}{value}{}", &line[words.len()..])
        }
    }
}

/// Where the number of a word stands in a line.
fn place(line: &str, letter: char) -> Option<Range<usize>> {
    let words = line.split_once(';').map_or(line, |(words, _)| words);
    let start = words.find(|c: char| c.eq_ignore_ascii_case(&letter))? + 1;
    let start = words.len() - words[start..].trim_start().len();
    let length = words[start..].find(|c: char| c.is_whitespace() || c.is_ascii_alphabetic());
    Some(start..length.map_or(words.len(), |length| start + length))
}
