//! What the link and whoever started it say to each other, by a socket that is the standard input of the
//! link. In and out: lines.

use std::{
    io::{self, BufReader, Write as _},
    os::{fd::AsFd as _, unix::net::UnixStream},
    sync::{Mutex, OnceLock, PoisonError},
    time::Duration,
};

pub use process::link::{CHANGED, Said, Told};

use process::ipc::time::{Moment, sleep_until};

use crate::LinkError;

/// How often whoever started this hears that it lives.
const ALIVE: Duration = Duration::from_millis(500);

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
    static WHOLE: Mutex<()> = Mutex::new(());
    // One line after the other.
    let _whole = WHOLE.lock().unwrap_or_else(PoisonError::into_inner);
    if let (Some(mut parent), Ok(line)) = (parent(), serde_json::to_string(what)) {
        let _ = parent.write_all(format!("{line}\n").as_bytes());
    }
}

/// Says again and again that this process lives: one that is stopped does not.
///
/// # Errors
/// There is no thread for it.
pub fn beats() -> Result<(), LinkError> {
    let beat = || {
        loop {
            say(&Said::Beat);
            sleep_until(Moment::now().after(ALIVE));
        }
    };
    let thread = std::thread::Builder::new().name("alive".into()).spawn(beat);
    thread.map(drop).map_err(|error| LinkError::broken("a thread", error))
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
