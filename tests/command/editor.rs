//! An editor and its server, by the protocol.

use std::{
    fmt::Write as _,
    io::BufReader,
    process::{Child, ChildStdin, ChildStdout, Stdio},
};

use lsp_server::{Message, Notification, Request, RequestId, Response};
use serde_json::{Value, json};

use crate::shop::Place;

/// An editor with one server.
struct Editor {
    server: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
    asked: i32,
    /// What was heard while an answer was waited for.
    heard: Vec<Notification>,
    uri: String,
}

impl Editor {
    /// Starts a server for a file of a place.
    fn start(place: &Place, file: &str, options: &Value) -> Editor {
        let mut command = place.pitchlock();
        command.arg("lsp").stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut server = command.spawn().expect("it starts");
        let (to, from) = (server.stdin.take().expect("piped"), server.stdout.take().expect("piped"));
        let uri = format!("file://{}", place.at(file).display());
        let from = BufReader::new(from);
        let mut editor = Editor { server, to, from, asked: 0, heard: Vec::new(), uri };
        let root = format!("file://{}", place.path().display());
        let params = json!({ "processId": null, "rootUri": root, "capabilities": {}, "initializationOptions": options });
        let answer = editor.ask("initialize", params);
        assert_eq!(answer["capabilities"]["textDocumentSync"]["change"], 2, "{answer}");
        editor.tell("initialized", json!({}));
        editor
    }

    fn tell(&mut self, method: &str, params: Value) {
        let message = Message::from(Notification::new(method.into(), params));
        message.write(&mut self.to).expect("it listens");
    }

    fn ask(&mut self, method: &str, params: Value) -> Value {
        self.asked += 1;
        let id = RequestId::from(self.asked);
        let message = Message::from(Request::new(id.clone(), method.into(), params));
        message.write(&mut self.to).expect("it listens");
        loop {
            match Message::read(&mut self.from).expect("it speaks the protocol").expect("it is there") {
                Message::Response(Response { id: answered, response_result }) => {
                    assert_eq!(answered, id);
                    return response_result.expect("an answer");
                }
                Message::Notification(notification) => self.heard.push(notification),
                Message::Request(request) => panic!("{request:?}"),
            }
        }
    }

    /// Opens the file with a text, which is not on the disk.
    fn open(&mut self, text: &str) {
        let document = json!({ "uri": self.uri, "languageId": "gcode", "version": 1, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": document }));
    }

    fn close(&mut self) {
        let document = json!({ "uri": self.uri });
        self.tell("textDocument/didClose", json!({ "textDocument": document }));
    }

    /// Types a text into a line, in the place of some columns.
    fn types(&mut self, version: i32, line: u32, columns: [u32; 2], text: &str) {
        let [start, end] = columns.map(|character| json!({ "line": line, "character": character }));
        let change = json!({ "range": { "start": start, "end": end }, "text": text });
        let document = json!({ "uri": self.uri, "version": version });
        self.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": [change] }));
    }

    fn at(&mut self, question: &str, line: u32, character: u32) -> Value {
        let position = json!({ "line": line, "character": character });
        let document = json!({ "uri": self.uri });
        self.ask(question, json!({ "textDocument": document, "position": position }))
    }

    fn of_document(&mut self, question: &str) -> Value {
        let document = json!({ "uri": self.uri });
        let options = json!({ "tabSize": 2, "insertSpaces": true });
        self.ask(question, json!({ "textDocument": document, "options": options }))
    }

    /// Waits for what a method tells next.
    fn hears(&mut self, method: &str) -> Value {
        loop {
            if let Some(at) = self.heard.iter().position(|notification| notification.method == method) {
                return self.heard.remove(at).params;
            }
            match Message::read(&mut self.from).expect("it speaks the protocol").expect("it is there") {
                Message::Notification(notification) => self.heard.push(notification),
                other => panic!("{other:?}"),
            }
        }
    }

    /// Waits for the diagnostics of a version, the ones before it left out.
    fn diagnostics(&mut self, version: i32) -> Vec<Value> {
        loop {
            let told = self.hears("textDocument/publishDiagnostics");
            assert_eq!(told["uri"], self.uri);
            if told["version"] == version {
                return told["diagnostics"].as_array().expect("a list").clone();
            }
        }
    }

    fn end(mut self) {
        self.ask("shutdown", Value::Null);
        self.tell("exit", Value::Null);
        assert!(self.server.wait().expect("it was started here").success());
    }
}

/// A program of so many lines; the last but one is wrong.
fn long(lines: usize) -> String {
    let mut text = String::from("G18 G21 G90 G94 G8\nM3 S600\nG0 X50 Z90\n");
    for n in 0..lines - 5 {
        let _ = writeln!(text, "G1 X{} F3000", if n % 2 == 0 { 50.01 } else { 50.0 });
    }
    text + "G1 X1 X2\nM2\n"
}

#[test]
fn a_long_program_is_edited_while_it_is_checked() {
    const LINES: u32 = 100_000;
    let place = Place::new();
    let mut editor = Editor::start(&place, "long.ngc", &Value::Null);
    editor.open(&long(LINES as usize));
    let hover = editor.at("textDocument/hover", 50_000, 11);
    assert!(hover["contents"]["value"].as_str().is_some_and(|told| told.contains("feed")), "{hover}");
    let [found] = &editor.diagnostics(1)[..] else { panic!("one mistake") };
    assert_eq!(found["code"], "repeated-word", "{found}");
    let place = json!({ "start": { "line": LINES - 2, "character": 6 }, "end": { "line": LINES - 2, "character": 8 } });
    assert_eq!((&found["range"], &found["severity"]), (&place, &json!(1)), "{found}");
    assert!(found["message"].as_str().is_some_and(|told| told.contains("\nhelp: ")), "{found}");

    // Every keystroke is answered; what was found of a text that is gone is not told.
    for version in 2..42 {
        editor.types(version, 50_000, [0, 0], " ");
        let hover = editor.at("textDocument/hover", 50_000, version as u32 - 1);
        let wanted = json!({ "line": 50_000, "character": version - 1 });
        assert_eq!(hover["range"]["start"], wanted, "{hover}");
    }
    let told = editor.heard.iter().filter(|told| told.method == "textDocument/publishDiagnostics").count();
    assert!(told <= 1, "{told} times");
    editor.types(42, LINES - 2, [5, 8], "");
    assert_eq!(editor.diagnostics(42), Vec::<Value>::new());
    editor.end();
}

#[test]
fn both_dialects_are_spoken() {
    let place = Place::new();
    place.write("bolts.ngc", "(a file beside)\no<bolts> sub\nG0 X#1\no<bolts> endsub\nM2\n");
    let mut editor = Editor::start(&place, "part.ngc", &json!({ "docs": "https://example.org/docs" }));
    editor.open("g0x50z90\no1 sub\nG0 X60\no1 endsub\no1 call\no<bolts> call [70]\n(thread, M20x2-9z)\nM2\n");
    let found = editor.diagnostics(1);
    let [wrong] = &found[..] else { panic!("{found:?}") };
    assert_eq!(wrong["range"]["start"]["line"], 6, "{wrong}");
    assert_eq!(wrong["codeDescription"]["href"], "https://example.org/docs/diagnostics.md");
    let subroutine = editor.at("textDocument/definition", 4, 1);
    assert_eq!((&subroutine["uri"], &subroutine["range"]["start"]["line"]), (&json!(editor.uri), &json!(1)));
    let beside = editor.at("textDocument/definition", 5, 4);
    assert!(beside["uri"].as_str().is_some_and(|uri| uri.ends_with("/bolts.ngc")), "{beside}");
    assert_eq!(beside["range"]["start"]["line"], 1);
    assert_eq!(editor.at("textDocument/definition", 0, 1), Value::Null);
    let folds = editor.of_document("textDocument/foldingRange");
    assert_eq!(folds, json!([{ "startLine": 1, "endLine": 3 }]));
    let edits = editor.of_document("textDocument/formatting");
    let texts: Vec<_> = edits.as_array().expect("edits").iter().map(|edit| edit["newText"].clone()).collect();
    assert_eq!(texts, ["G0 X50 Z90", "  G0 X60"]);

    // What is typed makes it a program of the other dialect.
    let document = json!({ "uri": editor.uri, "version": 2 });
    let text = "O1001 (SHAFT)\nG97 S500 M03\nT0100\nG00 X60. Z80.\nG50 S2000\nU2.\nG01 Z70. F0.2\nM98 P2000\nM30\nO2000\nM99\n";
    editor.tell(
        "textDocument/didChange",
        json!({ "textDocument": document, "contentChanges": [{ "text": text }] }),
    );
    assert_eq!(editor.diagnostics(2), Vec::<Value>::new());
    let hover = editor.at("textDocument/hover", 4, 1);
    assert!(
        hover["contents"]["value"].as_str().is_some_and(|told| told.contains("highest speed")),
        "{hover}"
    );
    assert_eq!(editor.at("textDocument/definition", 7, 6)["range"]["start"]["line"], 9);
    editor.close();
    assert_eq!(editor.hears("textDocument/publishDiagnostics")["diagnostics"], json!([]));
    editor.end();
}

/// Neither a document that is closed nor an editor that ends waits for a check that would take hours.
#[test]
fn a_check_in_hand_is_given_up() {
    let hours =
        "G18 G21 G90 G94 G8\nG0 X50 Z90\no1 repeat [1000000000]\nG1 X50.01 F3000\nG1 X50\no1 endrepeat\nM2\n";
    let place = Place::new();
    let mut editor = Editor::start(&place, "part.ngc", &Value::Null);
    // Questions until the check has surely begun.
    let ask = |editor: &mut Editor| (0..3000).for_each(|_| drop(editor.at("textDocument/hover", 4, 0)));
    editor.open(hours);
    ask(&mut editor);
    editor.close();
    assert_eq!(editor.hears("textDocument/publishDiagnostics")["diagnostics"], json!([]));
    assert_eq!(editor.of_document("textDocument/formatting"), Value::Null);
    editor.open(hours);
    ask(&mut editor);
    assert!(editor.heard.is_empty(), "{:?}", editor.heard);
    editor.end();
}

#[test]
fn what_the_editor_says_of_the_machine_counts() {
    let place = Place::new();
    let mill = place.ask(&["machine", "--kinematics", "mill"]).stdout;
    place.write("mill.toml", mill);
    let program = "G17 G21 G90 F600 S4000 M3\nG0 X10 Y10 Z5\nG1 Z-1\nM2\n";
    let mut editor = Editor::start(&place, "part.ngc", &json!({ "machine": "mill.toml" }));
    editor.open(program);
    assert_eq!(editor.diagnostics(1), Vec::<Value>::new());
    editor.end();
    let mut editor = Editor::start(&place, "part.ngc", &json!({ "machine": "none.toml" }));
    let shown = editor.hears("window/showMessage");
    assert!(shown["message"].as_str().is_some_and(|told| told.contains("none.toml: ")), "{shown}");
    editor.open(program);
    assert!(!editor.diagnostics(1).is_empty(), "the built-in lathe has no Y");
    editor.end();
}
