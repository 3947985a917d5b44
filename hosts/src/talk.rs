//! What the link and whoever started it say to each other, by a socket that is the standard input of the
//! link. In and out: lines.

use std::{
    io::{self, BufReader, Write as _},
    os::{fd::AsFd as _, unix::net::UnixStream},
    sync::OnceLock,
};

pub use process::link::{Said, Told};

use crate::LinkError;

/// The socket, if it is there.
fn parent() -> Option<&'static UnixStream> {
    static PARENT: OnceLock<Option<UnixStream>> = OnceLock::new();
    PARENT.get_or_init(|| io::stdin().as_fd().try_clone_to_owned().map(UnixStream::from).ok()).as_ref()
}

/// What whoever started this says.
///
/// # Errors
/// Nobody did.
pub fn hear() -> Result<BufReader<&'static UnixStream>, LinkError> {
    parent().map(BufReader::new).ok_or_else(|| LinkError::Broken("nobody has started this".into()))
}

/// Says something. Nobody may listen any more, and that is no error.
pub fn say(what: &Said) {
    if let (Some(mut parent), Ok(line)) = (parent(), serde_json::to_string(what)) {
        let _ = parent.write_all(format!("{line}\n").as_bytes());
    }
}

/// Says why, and ends this process. Zenoh would wait ten seconds for what a cable that was pulled does not
/// take.
pub fn leave(why: &LinkError) -> ! {
    say(&match why {
        LinkError::Input(text) | LinkError::Refused(text) | LinkError::Nobody(text) => {
            Said::Refused(text.clone())
        }
        other => Said::Why(other.to_string()),
    });
    std::process::exit(why.status().into())
}

/// Prints a text as it is.
pub fn print(text: &str) {
    let _ = write!(std::io::stdout(), "{text}");
}
