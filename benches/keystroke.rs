//! How long an editor waits after a keystroke in a program of 100,000 lines, while the program is checked and
//! both processors are busy with something else. `cargo bench --bench keystroke`.
//!
//! A keystroke is an edit in the middle, and the question what the word there means. Some editors ask for
//! what can be folded after each edit, too. The whole is formatted when somebody asks for it, and is here to
//! be compared. 100 ms are what nobody notices.
#![allow(missing_docs, clippy::unwrap_used, clippy::disallowed_methods)] // threads that keep processors busy

use std::{
    fmt::Write as _,
    hint::black_box,
    sync::atomic::{AtomicBool, Ordering},
    thread,
};

use criterion::{Criterion, criterion_group, criterion_main};
use interpreter::Language;
use lsp_server::{Connection, Message, Notification, Request, RequestId};
use machine::{Machine, SMALL_LATHE};
use serde_json::{Value, json};

const LINES: usize = 100_000;
const URI: &str = "file:///long.ngc";

fn program() -> String {
    let mut text = String::from("G18 G21 G90 G94 G8\nM3 S600\nG0 X50 Z90\n");
    for n in 0..LINES {
        let _ = writeln!(text, "G1 X{} F3000", if n % 2 == 0 { 50.01 } else { 50.0 });
    }
    text + "M2\n"
}

struct Editor {
    connection: Connection,
    asked: i32,
}

impl Editor {
    fn tell(&self, method: &str, params: Value) {
        self.connection.sender.send(Notification::new(method.into(), params).into()).unwrap();
    }

    fn ask(&mut self, method: &str, params: Value) {
        self.asked += 1;
        let request = Request::new(RequestId::from(self.asked), method.into(), params);
        self.connection.sender.send(request.into()).unwrap();
        while !matches!(self.connection.receiver.recv().unwrap(), Message::Response(_)) {}
    }

    fn keystroke(&mut self, question: &str) {
        let at = json!({ "line": LINES / 2, "character": 0 });
        let change = json!({ "range": { "start": at, "end": at }, "text": " " });
        let document = json!({ "uri": URI, "version": self.asked });
        self.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": [change] }));
        let options = json!({ "tabSize": 2, "insertSpaces": true });
        let at = json!({ "line": LINES / 2, "character": self.asked });
        self.ask(question, json!({ "textDocument": { "uri": URI }, "position": at, "options": options }));
    }
}

fn keystrokes(bench: &mut Criterion) {
    let (server, client) = Connection::memory();
    let machine = Machine::from_toml(SMALL_LATHE).unwrap();
    let settings = lsp::Settings { machine, language: Language::default(), docs: None };
    let busy = AtomicBool::new(true);
    thread::scope(|scope| {
        scope.spawn(move || lsp::serve(&server, settings).unwrap());
        for _ in 0..2 {
            scope.spawn(|| {
                let mut n = 0_u64;
                while busy.load(Ordering::Relaxed) {
                    n = black_box(n.wrapping_mul(31).wrapping_add(7));
                }
            });
        }
        let mut editor = Editor { connection: client, asked: 0 };
        editor.ask("initialize", json!({ "processId": null, "rootUri": null, "capabilities": {} }));
        editor.tell("initialized", json!({}));
        for question in ["hover", "foldingRange", "formatting"] {
            let document = json!({ "uri": URI, "languageId": "gcode", "version": 0, "text": program() });
            editor.tell("textDocument/didOpen", json!({ "textDocument": document }));
            bench.bench_function(&format!("a keystroke and {question}"), |bench| {
                bench.iter(|| editor.keystroke(&format!("textDocument/{question}")));
            });
        }
        busy.store(false, Ordering::Relaxed);
        editor.ask("shutdown", Value::Null);
        editor.tell("exit", Value::Null);
    });
}

criterion_group!(benches, keystrokes);
criterion_main!(benches);
