//! The thread that answers the editor. It reads no more than the lines that a question is about, or, for
//! folding, formatting and definitions, looks at each once; a definition may be in a file beside.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use gcode::codes::{G, g_group};
use gen_lsp_types::{
    Definition, DefinitionParams, DidChangeTextDocumentParams, DidCloseTextDocumentParams,
    DidOpenTextDocumentParams, DocumentFormattingParams, FoldingRange, FoldingRangeParams, Hover,
    HoverParams, Location, MarkupContent, MarkupKind, Position, PublishDiagnosticsParams, Range,
    TextDocumentContentChangeEvent, TextDocumentPositionParams, TextEdit,
};
use interpreter::Dialect;
use lsp_server::{Connection, ErrorCode, Message, Notification, Request, Response};
use serde_json::{Value, json};

use crate::{
    check::{Checked, Checker, Job, crossbeam},
    fold, format, hover, places,
    scan::scan,
    settings::Settings,
    text::{Text, byte_of, range},
};

/// How far up the code is looked for that is in force at a line.
const LINES_BACK: u32 = 200;

/// A document that the editor has open.
struct Document {
    text: Text,
    dialect: Dialect,
}

struct Server {
    settings: Settings,
    documents: BTreeMap<String, Document>,
    jobs: crossbeam::Sender<Job>,
    editor: crossbeam::Sender<Message>,
}

/// Answers an editor until it says that it ends.
///
/// # Errors
/// The editor does not keep to the protocol, or is gone.
pub fn serve(connection: &Connection, settings: Settings) -> Result<(), String> {
    let lost = |error: lsp_server::ProtocolError| error.to_string();
    let (id, params) = connection.initialize_start().map_err(lost)?;
    connection.initialize_finish(id, answer()).map_err(lost)?;
    let folder = params["rootUri"].as_str().and_then(places::path_of);
    let settings = match settings.clone().with(&params["initializationOptions"], folder.as_deref()) {
        Ok(settings) => settings,
        Err(error) => {
            let shown = json!({ "type": 1, "message": format!("pitchlock: {error}") });
            let _ = connection.sender.send(Notification::new("window/showMessage".into(), shown).into());
            settings
        }
    };
    let (jobs, received) = crossbeam::unbounded();
    let (done, checked) = crossbeam::unbounded();
    let editor = connection.sender.clone();
    let checker = Checker { settings: settings.clone(), jobs: received, editor: editor.clone(), done };
    let mut server = Server { settings, documents: BTreeMap::new(), jobs, editor };
    std::thread::scope(|scope| {
        scope.spawn(|| checker.run());
        let ended = server.run(connection, &checked);
        drop(server);
        ended
    })
}

/// What the server can do.
fn answer() -> Value {
    json!({
        "capabilities": {
            "positionEncoding": "utf-16",
            "textDocumentSync": { "openClose": true, "change": 2 },
            "hoverProvider": true,
            "definitionProvider": true,
            "documentFormattingProvider": true,
            "foldingRangeProvider": true,
        },
        "serverInfo": { "name": "pitchlock", "version": env!("CARGO_PKG_VERSION") },
    })
}

impl Server {
    fn run(&mut self, connection: &Connection, checked: &crossbeam::Receiver<Checked>) -> Result<(), String> {
        for message in &connection.receiver {
            for Checked { uri, dialect } in checked.try_iter() {
                if let Some(document) = self.documents.get_mut(&uri) {
                    document.dialect = dialect;
                }
            }
            match message {
                Message::Request(request) => {
                    if connection.handle_shutdown(&request).map_err(|error| error.to_string())? {
                        return Ok(());
                    }
                    let response = self.response(request);
                    self.editor.send(response.into()).map_err(|error| error.to_string())?;
                }
                Message::Notification(notification) => self.notified(notification),
                Message::Response(_) => {}
            }
        }
        Err("the editor has gone away without a word".into())
    }

    fn response(&self, request: Request) -> Response {
        let Request { id, method, params } = request;
        let answer = match method.as_str() {
            "textDocument/hover" => serde_json::from_value(params).map(|params| json!(self.hover(&params))),
            "textDocument/definition" => {
                serde_json::from_value(params).map(|params| json!(self.definition(&params)))
            }
            "textDocument/formatting" => {
                serde_json::from_value(params).map(|params| json!(self.formatting(&params)))
            }
            "textDocument/foldingRange" => {
                serde_json::from_value(params).map(|params| json!(self.folding(&params)))
            }
            _ => {
                let text = format!("pitchlock does not know {method}");
                return Response::new_err(id, ErrorCode::MethodNotFound as i32, text);
            }
        };
        match answer {
            Ok(answer) => Response::new_ok(id, answer),
            Err(error) => Response::new_err(id, ErrorCode::InvalidParams as i32, error.to_string()),
        }
    }

    fn notified(&mut self, notification: Notification) {
        let Notification { method, params } = notification;
        match method.as_str() {
            "textDocument/didOpen" => {
                let Ok(DidOpenTextDocumentParams { text_document: opened }) = serde_json::from_value(params)
                else {
                    return;
                };
                // Jobs and machine code are other languages.
                let is_other = interpreter::is_job(Path::new(opened.uri.as_ref()));
                if is_other || opened.uri.to_string().ends_with(".mc") {
                    return;
                }
                let (language, machine) = (&self.settings.language, &self.settings.machine);
                let (dialect, _) = interpreter::dialect_of_text(opened.text.as_bytes(), language, machine);
                let document = Document { text: Text::new(&opened.text), dialect };
                self.check(opened.uri.to_string(), opened.version, document);
            }
            "textDocument/didChange" => {
                let Ok(changed) = serde_json::from_value::<DidChangeTextDocumentParams>(params) else {
                    return;
                };
                let uri = changed.text_document.text_document_identifier.uri.to_string();
                let Some(mut document) = self.documents.remove(&uri) else { return };
                for change in changed.content_changes {
                    match change {
                        TextDocumentContentChangeEvent::TextDocumentContentChangePartial(part) => {
                            document.text.edit(part.range, &part.text);
                        }
                        TextDocumentContentChangeEvent::TextDocumentContentChangeWholeDocument(whole) => {
                            document.text = Text::new(&whole.text);
                        }
                    }
                }
                self.check(uri, changed.text_document.version, document);
            }
            "textDocument/didClose" => {
                let Ok(DidCloseTextDocumentParams { text_document: closed }) = serde_json::from_value(params)
                else {
                    return;
                };
                self.documents.remove(&closed.uri.to_string());
                // Nothing is left of it on the screen.
                let nothing = PublishDiagnosticsParams::new(closed.uri, None, Vec::new());
                let told = Notification::new("textDocument/publishDiagnostics".into(), nothing);
                let _ = self.editor.send(told.into());
            }
            _ => {}
        }
    }

    /// Keeps a document, and has it checked.
    fn check(&mut self, uri: String, version: i32, document: Document) {
        let _ = self.jobs.send(Job { uri: uri.clone(), version, text: document.text.clone() });
        self.documents.insert(uri, document);
    }

    /// The document of a question, the line of it, and the byte in that.
    fn asked(&self, at: &TextDocumentPositionParams) -> Option<(&Document, &str, usize)> {
        let document = self.documents.get(&at.text_document.uri.to_string())?;
        let line = document.text.line(at.position.line);
        Some((document, line, byte_of(line, at.position.character)))
    }

    fn hover(&self, params: &HoverParams) -> Option<Hover> {
        let at = &params.text_document_position_params;
        let (document, line, byte) = self.asked(at)?;
        let modal = document.modal(at.position.line);
        let (bytes, told) = hover::meaning(line, byte, document.dialect, modal.as_deref())?;
        let content = MarkupContent::new(MarkupKind::Markdown, told);
        Some(Hover::new(content.into(), Some(range(at.position.line, line, bytes))))
    }

    fn definition(&self, params: &DefinitionParams) -> Option<Definition> {
        let at = &params.text_document_position_params;
        let (document, line, byte) = self.asked(at)?;
        let dialect = document.dialect;
        let target = places::target(line, byte, dialect)?;
        let place = |line: u32| Range::new(Position::new(line, 0), Position::new(line, 0));
        if let Some(line) = places::find(document.text.lines(), &target, at.position.line, dialect) {
            return Some(Location::new(at.text_document.uri.clone(), place(line)).into());
        }
        let places::Target::Label(label) = &target else { return None };
        let path = places::path_of(at.text_document.uri.as_ref());
        let beside = path.as_deref().and_then(|path| path.parent()).map(PathBuf::from);
        let folders: Vec<PathBuf> =
            beside.into_iter().chain(self.settings.language.subroutines.clone()).collect();
        let file = places::file(label, &folders, dialect)?;
        let text = Text::new(&gcode::readable(&intake::bytes(&file, intake::SHOWN).ok()?));
        let line = places::find(text.lines(), &target, 0, dialect).unwrap_or(0);
        Some(Location::new(places::uri_of(&file).into(), place(line)).into())
    }

    fn formatting(&self, params: &DocumentFormattingParams) -> Vec<TextEdit> {
        let Some(document) = self.documents.get(&params.text_document.uri.to_string()) else {
            return Vec::new();
        };
        let lines = document.text.lines();
        let new = format::formatted(lines.iter().map(|line| &**line), document.dialect);
        let edit = |((number, line), new): ((u32, &std::sync::Arc<str>), Option<String>)| {
            Some(TextEdit::new(range(number, line, 0..line.len()), new?))
        };
        (0..).zip(lines).zip(new).filter_map(edit).collect()
    }

    fn folding(&self, params: &FoldingRangeParams) -> Vec<FoldingRange> {
        let Some(document) = self.documents.get(&params.text_document.uri.to_string()) else {
            return Vec::new();
        };
        let folds = fold::folds(document.text.lines(), document.dialect);
        let range = |(from, to)| FoldingRange { start_line: from, end_line: to, ..FoldingRange::default() };
        folds.into_iter().map(range).collect()
    }
}

impl Document {
    /// The code of motion or of a cycle that a line takes over from those above it.
    fn modal(&self, line: u32) -> Option<String> {
        let above = (line.saturating_sub(LINES_BACK)..line).rev();
        let mut codes = above.flat_map(|number| {
            let line = self.text.line(number);
            hover::codes(line, &scan(line, self.dialect))
        });
        codes.find(|code| {
            let number = code.strip_prefix('G').and_then(|number| number.parse::<f64>().ok());
            let Some(tenths) = number.map(|number| (10.0 * number).round() as u16) else { return false };
            match self.dialect {
                Dialect::Linuxcnc => g_group(G(tenths)) == g_group(G(10)),
                Dialect::Fanuc => matches!(tenths, 0..40 | 320 | 340 | 700..900 | 900 | 920 | 940),
                Dialect::FanucMill => matches!(tenths, 0..40 | 730..900),
            }
        })
    }
}
