//! How long an editor waits after a keystroke in a program of 100,000 lines, while the program is checked and
//! both processors are busy with something else. `cargo bench --bench keystroke`.
//!
//! A keystroke is an edit in the middle, and the question what the word there means. Some editors ask for
//! what can be folded after each edit, too. The whole is formatted when somebody asks for it: that is the
//! last row, and the one before it is a hover that is asked for meanwhile. Keystrokes come so far apart that
//! a check has begun when the next one comes. 100 ms are what nobody notices.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]
#![allow(clippy::disallowed_methods)] // threads that keep processors busy, a clock

use std::{
    fmt::Write as _,
    hint::black_box,
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::{Duration, Instant},
};

use interpreter::Language;
use lsp_server::{Connection, Message, Notification, Request, RequestId};
use machine::{Machine, SMALL_LATHE};
use serde_json::{Value, json};

const LINES: usize = 100_000;
/// Keystrokes of each kind, and the time between two of them: more than the tenth of a second after which a
/// check begins.
const KEYSTROKES: usize = 300;
const APART: Duration = Duration::from_millis(130);
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

    /// Asks, and says under which number.
    fn question(&mut self, method: &str, params: Value) -> RequestId {
        self.asked += 1;
        let id = RequestId::from(self.asked);
        self.connection.sender.send(Request::new(id.clone(), method.into(), params).into()).unwrap();
        id
    }

    /// Waits for an answer.
    fn answer(&self, to: &RequestId) {
        let is = |message: &Message| matches!(message, Message::Response(answer) if answer.id == *to);
        while !is(&self.connection.receiver.recv().unwrap()) {}
    }

    fn ask(&mut self, method: &str, params: Value) {
        let id = self.question(method, params);
        self.answer(&id);
    }

    fn about(&mut self, question: &str) -> RequestId {
        let options = json!({ "tabSize": 2, "insertSpaces": true });
        let at = json!({ "line": LINES / 2, "character": self.asked });
        let params = json!({ "textDocument": { "uri": URI }, "position": at, "options": options });
        self.question(&format!("textDocument/{question}"), params)
    }

    /// Types a blank, asks the questions and waits for the answer to the last of them.
    fn keystroke(&mut self, questions: &[&str]) -> Duration {
        let begun = Instant::now();
        let at = json!({ "line": LINES / 2, "character": 0 });
        let change = json!({ "range": { "start": at, "end": at }, "text": " " });
        let document = json!({ "uri": URI, "version": self.asked });
        self.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": [change] }));
        let ids: Vec<RequestId> = questions.iter().map(|question| self.about(question)).collect();
        self.answer(ids.last().unwrap());
        begun.elapsed()
    }
}

fn main() {
    // `cargo test --benches` asks whether a bench runs at all.
    let shortened = std::env::args().any(|argument| argument == "--test");
    let keystrokes = if shortened { 3 } else { KEYSTROKES };
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
        let kinds: [&[&str]; 4] = [&["hover"], &["foldingRange"], &["formatting", "hover"], &["formatting"]];
        for questions in kinds {
            let document = json!({ "uri": URI, "languageId": "gcode", "version": 0, "text": program() });
            editor.tell("textDocument/didOpen", json!({ "textDocument": document }));
            let mut waited: Vec<Duration> = Vec::new();
            for _ in 0..keystrokes {
                thread::sleep(APART);
                waited.push(editor.keystroke(questions));
            }
            waited.sort_unstable();
            let ms = |share: f64| {
                let at = (share * waited.len() as f64) as usize;
                1e3 * waited[at.min(waited.len() - 1)].as_secs_f64()
            };
            let name = questions.join(", then ");
            println!(
                "{name:<23} median {:>5.1} ms   99 of 100 {:>5.1} ms   worst {:>5.1} ms",
                ms(0.5),
                ms(0.99),
                ms(1.0)
            );
        }
        busy.store(false, Ordering::Relaxed);
        editor.ask("shutdown", Value::Null);
        editor.tell("exit", Value::Null);
    });
}
