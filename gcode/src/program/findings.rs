//! What was found wrong. In: problems, which name a word. Out: diagnostics, which name file, line and column;
//! each line is reported once, and so is a word that stays in force over the lines behind it.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::reader::Reader;
use crate::block::Block;
use crate::canon::Place;
use crate::codes::group;
use crate::problem::{Blame, Diagnostic, Problem, Span};

/// What was reported so far.
#[derive(Default)]
pub(super) struct Findings {
    warnings: Vec<Diagnostic>,
    /// File and line of every error so far.
    reported: BTreeSet<(u16, u32)>,
    /// The same of warnings, each code by itself.
    warned: BTreeSet<(u16, u32, &'static str)>,
    /// What the first errors said, no more than [`REMEMBERED`].
    told: Vec<String>,
}

/// Errors that are looked through for one that comes again.
const REMEMBERED: usize = 100;

/// Whether a block blames what another one left in force: a word or a code that it does not have itself.
fn is_held(blame: Blame, block: &Block) -> bool {
    let elsewhere = match blame {
        Blame::Word(letter) => !block.has(letter),
        Blame::G(code) => block.g_codes().all(|own| own != code),
        _ => false,
    };
    elsewhere && block.g(group::MOTION).is_none()
}

impl Findings {
    /// Makes a diagnostic of an error, if there is none for its line yet. `refused`: see [`diagnostic`].
    pub(super) fn error(
        &mut self,
        problem: Problem,
        refused: Option<Place>,
        reader: &mut Reader,
    ) -> Option<Diagnostic> {
        let again = refused.is_none() && is_held(problem.blame, reader.block());
        if again && self.told.contains(&problem.message) {
            return None;
        }
        if self.told.len() < REMEMBERED {
            self.told.push(problem.message.clone());
        }
        let (file, diagnostic) = diagnostic(problem, refused, reader);
        // What it was warned of before, and is refused now, is said once.
        let same = |warned: &Diagnostic| {
            (&warned.file, warned.line, warned.code) == (&diagnostic.file, diagnostic.line, diagnostic.code)
        };
        self.warnings.retain(|warned| !same(warned));
        self.reported.insert((file, diagnostic.line)).then_some(diagnostic)
    }

    /// Keeps the warnings of a line.
    pub(super) fn keep_warnings(&mut self, problems: &mut Vec<Problem>, reader: &mut Reader) {
        for problem in problems.drain(..) {
            let (file, diagnostic) = diagnostic(problem, None, reader);
            if self.warned.insert((file, diagnostic.line, diagnostic.code)) {
                self.warnings.push(diagnostic);
            }
        }
    }

    /// The warnings since the last call.
    pub(super) fn take_warnings(&mut self) -> Vec<Diagnostic> {
        std::mem::take(&mut self.warnings)
    }
}

/// Puts a problem at its place, and tells the number of the file. `refused`: the call that the sink refused,
/// which may be of an earlier line.
pub(super) fn diagnostic(
    mut problem: Problem,
    refused: Option<Place>,
    reader: &mut Reader,
) -> (u16, Diagnostic) {
    let block = reader.block().place();
    let earlier = refused.filter(|place| (place.file, place.line) != (block.file, block.line));
    let (file, line) = match (problem.blame, earlier) {
        (Blame::Part(place, _), _) => (place.file, place.line),
        (Blame::Line(line), place) => (place.map_or(block.file, |place| place.file), line),
        (_, Some(place)) | (Blame::At(place), _) => (place.file, place.line),
        _ => (block.file, block.line),
    };
    let (name, text) = match reader.files_mut().get_mut(usize::from(file)) {
        Some(source) => (Arc::clone(source.name()), source.text(line)),
        None => ("".into(), String::new()),
    };
    problem.message = reader.in_its_words(problem.message);
    problem.help = reader.in_its_words(problem.help);
    let whole = Span { start: 0, end: text.len() as u32 };
    let span = match problem.blame {
        Blame::Part(_, span) => Some(span),
        _ if earlier.is_some() => None,
        blame => reader.block().span(blame),
    };
    (file, Diagnostic::new(problem, &name, line, &text, span.unwrap_or(whole)))
}
