//! What the link to another computer and the launcher that started it say to each other: a line of JSON each,
//! by a socket that is the standard input of the link.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Why somebody is refused whose machine file was compared with one that was changed then.
pub const CHANGED: &str = "the machine file at the machine was changed while it waited for programs\nhelp: ask again; both need \
     the same one";

/// What the link says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Said {
    /// The lower level can be called.
    Listening,
    /// The upper level was let in.
    Welcome {
        /// Name of the session, which is that of the run.
        run: String,
    },
    /// A run is asked for: its files lie in the folder.
    Run {
        /// Its name.
        run: String,
        /// Its arguments, the program first.
        words: Vec<String>,
        /// Hash of the machine file that was compared for it.
        compared: String,
    },
    /// A panel is asked for: the files of its program lie in the folder.
    Panel {
        /// Its arguments, the program first, which is empty without one.
        words: Vec<String>,
        /// Hash of the machine file that was compared for it.
        compared: String,
    },
    /// The machine has started.
    Started,
    /// It is refused, and why.
    Refused(String),
    /// Somebody at the upper level presses: 1 stop, 2 emergency stop.
    Press(u8),
    /// Something to be told.
    Note(String),
    /// Why it ends.
    Why(String),
    /// What became of the run.
    Outcome(Value),
    /// Whoever asked for the last run has been told what became of it.
    Fetched,
    /// Somebody in a hall looks at the machine: what is it doing?
    Look,
    /// What machines of a hall do, in the order in which they were named.
    Machines(Vec<Watched>),
    /// The interpreter on the other computer computes.
    Computes,
    /// The process of the link lives.
    Beat,
}

impl Said {
    /// The same, and no text in it that is shown steers a terminal.
    #[must_use]
    pub fn harmless(self) -> Said {
        let watched = |watched: Watched| Watched {
            seen: watched.seen.map(harmless),
            why: watched.why.as_deref().map(shown),
            ..watched
        };
        match self {
            Said::Refused(text) => Said::Refused(shown(&text)),
            Said::Note(text) => Said::Note(shown(&text)),
            Said::Why(text) => Said::Why(shown(&text)),
            Said::Outcome(value) => Said::Outcome(harmless(value)),
            Said::Machines(all) => Said::Machines(all.into_iter().map(watched).collect()),
            other => other,
        }
    }
}

/// A machine of a hall, where it can be called, and the key that it has.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Watch {
    /// Its address.
    pub at: String,
    /// The file with its key.
    pub key: PathBuf,
}

/// What is known of one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Watched {
    /// What it did when it was heard of last.
    pub seen: Option<Value>,
    /// How old that was then, s.
    pub age_s: f64,
    /// So long nothing has been heard of it, s.
    pub silent_s: f64,
    /// Why it cannot be looked at.
    pub why: Option<String>,
}

/// What it is told.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Told {
    /// What is known from before, the first line of all: the key, if its file was read, and what became of
    /// the last run.
    Before {
        /// As it is in its file.
        key: Option<String>,
        /// With the name of that run.
        outcome: Option<Value>,
    },
    /// The machine file has this hash now: whoever comes from here on is compared with that. One that cannot
    /// be read has none, and is compared when something is asked for.
    Compared(Option<String>),
    /// Take your place in the name space with this address.
    Join {
        /// Its address.
        address: String,
        /// Whether the machine runs in real time.
        real: bool,
    },
    /// The files of the run are the regular ones in this folder; its arguments, the program first.
    Send {
        /// The folder.
        folder: PathBuf,
        /// The files in it.
        files: Vec<String>,
        /// The arguments.
        words: Vec<String>,
    },
    /// The panel of the other computer is carried by this socket.
    Panel {
        /// Where it is.
        socket: PathBuf,
        /// What it hears first, on this host alone.
        first: String,
    },
    /// The run is refused, and why.
    Refuse(String),
    /// The panel has ended.
    Over,
    /// It was lost, and why.
    Lost(String),
    /// The interpreter computes.
    Computes,
    /// Somebody presses.
    Press(u8),
    /// What the machine does.
    Seen(Value),
}

/// A text of another computer as it is shown: what would steer a terminal, or turn the order of letters
/// round, is written out. Ends of lines stay.
pub fn shown(text: &str) -> String {
    let turns = |letter: char| matches!(letter, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let letter = |letter: char| match letter {
        '\n' => "\n".to_owned(),
        _ if letter.is_control() || turns(letter) => letter.escape_unicode().to_string(),
        _ => letter.to_string(),
    };
    text.chars().map(letter).collect()
}

/// The same of all texts in a document.
fn harmless(value: Value) -> Value {
    match value {
        Value::String(text) => Value::String(shown(&text)),
        Value::Array(all) => all.into_iter().map(harmless).collect(),
        Value::Object(all) => all.into_iter().map(|(name, value)| (shown(&name), harmless(value))).collect(),
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steers_a_terminal_is_written_out_and_all_else_is_as_it_was() {
        let plain = "Drehbank „Süd“, Größe 3 — 旋盤\n\\ \" line 2";
        assert_eq!(shown(plain), plain);
        assert_eq!(shown("\u{1b}[2J\r\t\u{9b}a\u{202e}b"), "\\u{1b}[2J\\u{d}\\u{9}\\u{9b}a\\u{202e}b");
        let value = serde_json::json!({ "a": ["\u{7}", 1], "b\u{1b}": { "c": null } });
        assert_eq!(harmless(value), serde_json::json!({ "a": ["\\u{7}", 1], "b\\u{1b}": { "c": null } }));
    }
}
