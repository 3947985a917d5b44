//! The thread that checks. In: texts as they change. Out: what `check` says of the newest of each, once
//! nothing has been typed for a moment; a check in hand is given up when something is.

use std::{collections::BTreeMap, path::PathBuf, time::Duration};

use gen_lsp_types::{
    Code, CodeDescription, Diagnostic, DiagnosticSeverity, Message as Told, PublishDiagnosticsParams, Range,
};
use interpreter::{Dialect, Interpreter, Severity};
use lsp_server::{Message, Notification};

use crate::{
    places::path_of,
    server::is_system_b,
    settings::Settings,
    text::{Text, range},
};

/// Nothing is checked before so long nothing was typed.
const QUIET: Duration = Duration::from_millis(100);

/// What the thread is asked.
pub(crate) enum Asked {
    Check(Job),
    /// A document is closed: nothing is left of it on the screen.
    Closed(String),
    /// The editor ends, and does not wait for the check in hand.
    End,
}

/// A text to be checked.
pub(crate) struct Job {
    pub(crate) uri: String,
    pub(crate) version: i32,
    pub(crate) text: Text,
}

/// What became of one.
pub(crate) struct Checked {
    pub(crate) uri: String,
    pub(crate) dialect: Dialect,
    pub(crate) system_b: bool,
}

/// Questions as they come, and where results go.
pub(crate) struct Checker {
    pub(crate) settings: Settings,
    pub(crate) asked: crossbeam::Receiver<Asked>,
    pub(crate) editor: crossbeam::Sender<Message>,
    pub(crate) done: crossbeam::Sender<Checked>,
}

/// The channels of `lsp_server`.
pub(crate) use crossbeam_channel as crossbeam;

impl Checker {
    /// Checks until nobody asks any more.
    pub(crate) fn run(self) {
        let mut waiting: BTreeMap<String, Job> = BTreeMap::new();
        loop {
            let asked = match waiting.is_empty() {
                true => self.asked.recv().map_err(|_| crossbeam::RecvTimeoutError::Disconnected),
                false => self.asked.recv_timeout(QUIET),
            };
            let told = match asked {
                Ok(Asked::Check(job)) => {
                    waiting.insert(job.uri.clone(), job);
                    continue;
                }
                Ok(Asked::Closed(uri)) => {
                    waiting.remove(&uri);
                    self.publish(uri, None, Vec::new())
                }
                Ok(Asked::End) | Err(crossbeam::RecvTimeoutError::Disconnected) => return,
                Err(crossbeam::RecvTimeoutError::Timeout) => {
                    let Some((uri, job)) = waiting.pop_first() else { continue };
                    match self.check(&job) {
                        Some((dialect, found)) => {
                            let system_b = is_system_b(&job.text, dialect);
                            let _ = self.done.send(Checked { uri: uri.clone(), dialect, system_b });
                            self.publish(uri, Some(job.version), found)
                        }
                        None => {
                            waiting.insert(uri, job);
                            continue;
                        }
                    }
                }
            };
            if told.is_err() {
                return;
            }
        }
    }

    /// Tells what was found in a document. All that is told of it comes from this thread, so nothing comes
    /// late.
    ///
    /// # Errors
    /// The editor is gone.
    fn publish(
        &self,
        uri: String,
        version: Option<i32>,
        found: Vec<Diagnostic>,
    ) -> Result<(), crossbeam::SendError<Message>> {
        let published = PublishDiagnosticsParams::new(uri.into(), version, found);
        self.editor.send(Notification::new("textDocument/publishDiagnostics".into(), published).into())
    }

    /// What is found in a text; `None` if something newer has come meanwhile.
    fn check(&self, job: &Job) -> Option<(Dialect, Vec<Diagnostic>)> {
        let machine = &self.settings.machine;
        let source = job.text.source().into_bytes();
        let (dialect, _) = interpreter::dialect_of_text(&source, &self.settings.language, machine);
        let path = path_of(&job.uri).unwrap_or_else(|| PathBuf::from(&job.uri));
        let mut language = self.settings.language.clone();
        // Subroutine files are looked for beside the program first.
        language.subroutines.splice(0..0, path.parent().filter(|folder| folder.is_dir()).map(PathBuf::from));
        let name = path.display().to_string();
        let opened = interpreter::open_text(&name, source, &language, machine).and_then(|program| {
            let part = interpreter::part_beside(&path, machine)?;
            Ok(Interpreter::new(program, machine).with_part(part.map(|(_, part)| part)))
        });
        let interpreter = match opened {
            Ok(interpreter) => interpreter,
            Err(error) => {
                return Some((dialect, vec![diagnostic(Range::default(), None, error.to_string())]));
            }
        };
        let mut is_newest = true;
        let check = interpreter::check_while(interpreter, machine, |_| {
            is_newest = self.asked.is_empty();
            is_newest
        });
        let told = |found: &interpreter::Diagnostic| self.told(job, &name, found);
        is_newest.then(|| (dialect, check.diagnostics.iter().map(told).collect()))
    }

    /// A diagnostic as the protocol has it. One of another file stands in the first line, and says where it
    /// is.
    fn told(&self, job: &Job, name: &str, found: &interpreter::Diagnostic) -> Diagnostic {
        let (mut place, mut text) = (Range::default(), found.message.clone());
        if *found.file == *name {
            let number = found.line.saturating_sub(1);
            let line = job.text.line(number);
            let byte = |column: usize| line.char_indices().nth(column).map_or(line.len(), |(byte, _)| byte);
            let begin = found.column.saturating_sub(1) as usize;
            let length = found.text.get(found.span.clone()).map_or(0, |blamed| blamed.chars().count());
            place = range(number, line, byte(begin)..byte(begin + length));
        } else {
            text = format!("{}:{}: {text}", found.file, found.line);
        }
        if !found.help.is_empty() {
            text = format!("{text}\nhelp: {}", found.help);
        }
        let severity = match found.severity {
            Severity::Error => DiagnosticSeverity::Error,
            Severity::Warning => DiagnosticSeverity::Warning,
        };
        let described = self.settings.docs.as_ref().map(|docs| {
            let href = format!("{}/diagnostics.md", docs.trim_end_matches('/'));
            CodeDescription::new(href.into())
        });
        Diagnostic {
            severity: Some(severity),
            code_description: described,
            ..diagnostic(place, Some(found.code), text)
        }
    }
}

fn diagnostic(range: Range, code: Option<&str>, text: String) -> Diagnostic {
    Diagnostic {
        range,
        severity: Some(DiagnosticSeverity::Error),
        code: code.map(Code::from),
        code_description: None,
        source: Some("pitchlock".into()),
        message: Told::from(text),
        tags: None,
        related_information: None,
        data: None,
    }
}
