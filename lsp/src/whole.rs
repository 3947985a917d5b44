//! Questions that every line of a document is looked at for, and perhaps a file beside: where a subroutine
//! is, the text as the house writes it, what can be folded.

use std::{path::PathBuf, sync::Arc};

use gen_lsp_types::{Definition, DefinitionParams, FoldingRange, Location, Position, Range, TextEdit};
use serde_json::{Error, Value, json};

use crate::{
    fold, format, places,
    server::Document,
    text::{Text, byte_of, range},
};

/// Answers a question about a document; the folders are those of subroutines.
pub(crate) type Answer = fn(&Document, Value, &[PathBuf]) -> Result<Value, Error>;

/// What answers a method.
pub(crate) fn answer(method: &str) -> Option<Answer> {
    match method {
        "textDocument/definition" => Some(|document, params, folders| {
            Ok(json!(definition(document, &serde_json::from_value(params)?, folders)))
        }),
        "textDocument/formatting" => Some(|document, _, _| Ok(json!(formatting(document)))),
        "textDocument/foldingRange" => Some(|document, _, _| Ok(json!(folding(document)))),
        _ => None,
    }
}

fn definition(document: &Document, params: &DefinitionParams, folders: &[PathBuf]) -> Option<Definition> {
    let at = &params.text_document_position_params;
    let (Document { text, dialect, .. }, number) = (document, at.position.line);
    let line = text.line(number);
    let target = places::target(line, byte_of(line, at.position.character), *dialect)?;
    let place = |line: u32| Range::new(Position::new(line, 0), Position::new(line, 0));
    if let Some(line) = places::find(text.lines(), &target, number, *dialect) {
        return Some(Location::new(at.text_document.uri.clone(), place(line)).into());
    }
    let places::Target::Label(label) = &target else { return None };
    let path = places::path_of(at.text_document.uri.as_ref());
    let beside = path.as_deref().and_then(|path| path.parent()).map(PathBuf::from);
    let folders: Vec<PathBuf> = beside.into_iter().chain(folders.iter().cloned()).collect();
    let file = places::file(label, &folders, *dialect)?;
    let text = Text::new(&gcode::readable(&intake::bytes(&file, intake::SHOWN).ok()?));
    let line = places::find(text.lines(), &target, 0, *dialect).unwrap_or(0);
    Some(Location::new(places::uri_of(&file).into(), place(line)).into())
}

fn formatting(document: &Document) -> Vec<TextEdit> {
    let lines = document.text.lines();
    let new = format::formatted(lines.iter().map(|line| &**line), document.dialect);
    let edit = |((number, line), new): ((u32, &Arc<str>), Option<String>)| {
        Some(TextEdit::new(range(number, line, 0..line.len()), new?))
    };
    (0..).zip(lines).zip(new).filter_map(edit).collect()
}

fn folding(document: &Document) -> Vec<FoldingRange> {
    let folds = fold::folds(document.text.lines(), document.dialect);
    let range = |(from, to)| FoldingRange { start_line: from, end_line: to, ..FoldingRange::default() };
    folds.into_iter().map(range).collect()
}
