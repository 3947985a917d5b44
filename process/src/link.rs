//! What the link to another computer and the launcher that started it say to each other: a line of JSON each,
//! on standard output and input of the link.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// What the link says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Said {
    /// The lower level can be called at this address.
    Listening(String),
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
    },
    /// A panel is asked for: the files of its program lie in the folder.
    Panel {
        /// Its arguments, the program first, which is empty without one.
        words: Vec<String>,
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
    Outcome(serde_json::Value),
    /// Somebody in a hall looks at the machine: what is it doing?
    Look,
    /// What machines of a hall do, in the order in which they were named.
    Machines(Vec<Watched>),
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
    pub seen: Option<serde_json::Value>,
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
    /// Somebody presses.
    Press(u8),
    /// What the machine does.
    Seen(serde_json::Value),
}
