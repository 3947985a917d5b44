//! What the link says to whoever started it.

use std::io::Write as _;

pub use process::link::{Said, Told};

use crate::LinkError;

/// Says something. Nobody may listen any more, and that is no error.
pub fn say(what: &Said) {
    if let Ok(line) = serde_json::to_string(what) {
        let _ = writeln!(std::io::stdout(), "{line}");
    }
}

/// Says why, and ends this process. Zenoh would wait ten seconds for what a cable that was pulled does not
/// take.
pub fn leave(why: &LinkError) -> ! {
    say(&match why {
        LinkError::Input(text) | LinkError::OtherKey(text) => Said::Refused(text.clone()),
        other => Said::Why(other.to_string()),
    });
    std::process::exit(why.status().into())
}

/// Prints a text as it is.
pub fn print(text: &str) {
    let _ = write!(std::io::stdout(), "{text}");
}
