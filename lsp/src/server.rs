//! The thread that answers the editor. It reads no more than the lines that a question is about, and hands on
//! what is about all of them (`whole.rs`).

use std::{collections::BTreeMap, path::Path};

use gen_lsp_types::{
    DidChangeTextDocumentParams, DidCloseTextDocumentParams, DidOpenTextDocumentParams, Hover, HoverParams,
    MarkupContent, MarkupKind, TextDocumentContentChangeEvent,
};
use interpreter::Dialect;
use lsp_server::{Connection, ErrorCode, Message, Notification, Request, Response};
use serde_json::{Value, json};

use crate::{
    check::{Asked, Checked, Checker, Job, crossbeam},
    hover, places,
    scan::{Kind, scan},
    settings::Settings,
    text::{Text, byte_of, range},
    whole,
};

/// How far up the code is looked for that is in force at a line.
const LINES_BACK: u32 = 200;

/// A document that the editor has open.
#[derive(Clone)]
pub(crate) struct Document {
    pub(crate) text: Text,
    pub(crate) dialect: Dialect,
    /// It is a lathe program of FANUC's G-code system B.
    pub(crate) system_b: bool,
}

/// A question that is answered by another thread.
type Question = Box<dyn FnOnce() -> Response + Send>;

struct Server {
    settings: Settings,
    documents: BTreeMap<String, Document>,
    checker: crossbeam::Sender<Asked>,
    beside: crossbeam::Sender<Question>,
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
    let (checker, asked) = crossbeam::unbounded();
    let (beside, questions) = crossbeam::unbounded::<Question>();
    let (done, checked) = crossbeam::unbounded();
    let editor = connection.sender.clone();
    let check = Checker { settings: settings.clone(), asked, editor: editor.clone(), done };
    let answers = editor.clone();
    let mut server = Server { settings, documents: BTreeMap::new(), checker, beside, editor };
    std::thread::scope(|scope| {
        scope.spawn(|| check.run());
        scope.spawn(move || questions.iter().all(|question| answers.send(question().into()).is_ok()));
        let ended = server.run(connection, &checked);
        let _ = server.checker.send(Asked::End);
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
            for Checked { uri, dialect, system_b } in checked.try_iter() {
                if let Some(document) = self.documents.get_mut(&uri) {
                    (document.dialect, document.system_b) = (dialect, system_b);
                }
            }
            match message {
                Message::Request(request) => {
                    if connection.handle_shutdown(&request).map_err(|error| error.to_string())? {
                        return Ok(());
                    }
                    if let Some(response) = self.response(request) {
                        self.editor.send(response.into()).map_err(|error| error.to_string())?;
                    }
                }
                Message::Notification(notification) => self.notified(notification),
                Message::Response(_) => {}
            }
        }
        Err("the editor has gone away without a word".into())
    }

    /// The answer to a request; `None` if it is answered beside.
    fn response(&self, request: Request) -> Option<Response> {
        let Request { id, method, params } = request;
        if method == "textDocument/hover" {
            return Some(match serde_json::from_value(params) {
                Ok(params) => Response::new_ok(id, self.hover(&params)),
                Err(error) => Response::new_err(id, ErrorCode::InvalidParams as i32, error.to_string()),
            });
        }
        let Some(answer) = whole::answer(&method) else {
            let text = format!("pitchlock does not know {method}");
            return Some(Response::new_err(id, ErrorCode::MethodNotFound as i32, text));
        };
        let uri = params["textDocument"]["uri"].as_str().unwrap_or_default();
        let Some(document) = self.documents.get(uri).cloned() else {
            return Some(Response::new_ok(id, Value::Null));
        };
        let folders = self.settings.language.subroutines.clone();
        let question = move || match answer(&document, params, &folders) {
            Ok(answer) => Response::new_ok(id, answer),
            Err(error) => Response::new_err(id, ErrorCode::InvalidParams as i32, error.to_string()),
        };
        // Its thread ends after this one.
        let _ = self.beside.send(Box::new(question));
        None
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
                let document = Document::new(Text::new(&opened.text), dialect);
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
                let uri = closed.uri.to_string();
                self.documents.remove(&uri);
                let _ = self.checker.send(Asked::Closed(uri));
            }
            _ => {}
        }
    }

    /// Keeps a document, and has it checked.
    fn check(&mut self, uri: String, version: i32, document: Document) {
        let job = Job { uri: uri.clone(), version, text: document.text.clone() };
        let _ = self.checker.send(Asked::Check(job));
        self.documents.insert(uri, document);
    }

    fn hover(&self, params: &HoverParams) -> Option<Hover> {
        let at = &params.text_document_position_params;
        let document = self.documents.get(&at.text_document.uri.to_string())?;
        let line = document.text.line(at.position.line);
        let byte = byte_of(line, at.position.character);
        let modal = document.modal(at.position.line);
        let Document { dialect, system_b, .. } = *document;
        let around = hover::Around { dialect, system_b, modal: modal.as_deref() };
        let (bytes, told) = hover::meaning(line, byte, &around)?;
        let content = MarkupContent::new(MarkupKind::Markdown, told);
        Some(Hover::new(content.into(), Some(range(at.position.line, line, bytes))))
    }
}

impl Document {
    fn new(text: Text, dialect: Dialect) -> Document {
        let system_b = is_system_b(&text, dialect);
        Document { text, dialect, system_b }
    }

    /// The code of motion or of a cycle that a line takes over from those above it.
    fn modal(&self, line: u32) -> Option<String> {
        let above = (line.saturating_sub(LINES_BACK)..line).rev();
        let mut codes = above.flat_map(|number| {
            let line = self.text.line(number);
            let tokens = scan(line, self.dialect);
            let points = tokens.iter().any(|token| matches!(token.kind, Kind::Word('X' | 'Z' | 'U' | 'W')));
            // G90, G92 and G94 of FANUC without a point are no cycles.
            let moves = move |code: &String| points || !matches!(code.as_str(), "G90" | "G92" | "G94");
            hover::codes(line, &tokens).into_iter().filter(move |code| moves(code))
        });
        codes.find(|code| hover::is_motion(code, self.dialect, self.system_b))
    }
}

/// Whether a program is one of G-code system B.
pub(crate) fn is_system_b(text: &Text, dialect: Dialect) -> bool {
    dialect == Dialect::Fanuc && gcode::is_system_b(text.lines().iter().map(|line| &**line))
}
