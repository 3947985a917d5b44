//! What the user sees besides pages: results on standard output, log messages on standard error, colour where
//! it is seen.

use std::{
    io::{ErrorKind, IsTerminal, Write},
    sync::atomic::{AtomicBool, Ordering},
};

use tracing::level_filters::LevelFilter;

use crate::{
    args::{LogArgs, LogFormat},
    words,
};

/// Sends log messages to standard error.
pub(crate) fn start_log(log: &LogArgs) {
    let level = match (log.quiet, log.verbose) {
        (true, _) => LevelFilter::ERROR,
        (false, 0) => LevelFilter::WARN,
        (false, 1) => LevelFilter::INFO,
        (false, _) => LevelFilter::DEBUG,
    };
    let builder = tracing_subscriber::fmt()
        .with_max_level(level)
        .with_ansi(colour(&std::io::stderr()))
        .with_writer(|| words::Log);
    match log.log_format {
        LogFormat::Text => builder.without_time().init(),
        LogFormat::Json => builder.json().init(),
    }
}

/// Whether a stream shall be coloured: a terminal that can, and `NO_COLOR` not set.
pub(crate) fn colour(stream: &impl IsTerminal) -> bool {
    let is_dumb = std::env::var_os("TERM").is_some_and(|value| value == "dumb");
    let no_colour = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    stream.is_terminal() && !is_dumb && !no_colour
}

/// Whether results were lost that should have been printed.
static LOST: AtomicBool = AtomicBool::new(false);

/// Prints results to standard output; a reader that has gone away is not an error, a full disk is.
pub(crate) fn print(text: &str) {
    let mut out = std::io::stdout();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            words::say(&format!("error: standard output: {error}\n"));
            LOST.store(true, Ordering::Relaxed);
        }
        _ => {}
    }
}

/// Whether everything could be printed.
pub(crate) fn is_printed() -> bool {
    !LOST.load(Ordering::Relaxed)
}
