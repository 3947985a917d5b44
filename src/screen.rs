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
        LogFormat::Json => {
            IN_JSON.store(true, Ordering::Relaxed);
            builder.json().init();
        }
    }
}

/// Whether a stream shall be coloured: a terminal that can, and `NO_COLOR` not set.
pub(crate) fn colour(stream: &impl IsTerminal) -> bool {
    let is_dumb = std::env::var_os("TERM").is_some_and(|value| value == "dumb");
    let no_colour = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    stream.is_terminal() && !is_dumb && !no_colour
}

/// Whether results were lost that should have been printed, and whether there were any.
static LOST: AtomicBool = AtomicBool::new(false);
static PRINTED: AtomicBool = AtomicBool::new(false);
/// Whether what is said is said as JSON.
static IN_JSON: AtomicBool = AtomicBool::new(false);

/// Prints why there is no document, as one; nothing if there is one.
pub(crate) fn print_error(text: &str) {
    if !PRINTED.load(Ordering::Relaxed) {
        print(&format!("{}\n", serde_json::json!({ "error": plain(text) })));
    }
}

/// A text without the colours of a terminal.
pub(crate) fn plain(text: &str) -> String {
    let mut parts = text.split("\u{1b}[");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |plain, part| plain + part.split_once('m').map_or("", |(_, rest)| rest))
}

/// What is said, in the form that was asked for: as it is, or one JSON object in a line, like those of the
/// log.
pub(crate) fn said(text: &str) -> String {
    if !IN_JSON.load(Ordering::Relaxed) || text.is_empty() {
        return text.to_owned();
    }
    let level = match text {
        _ if text.contains("error: ") || text.contains("error[") => "ERROR",
        _ if text.contains("warning[") || text.contains("not good: ") => "WARN",
        _ => "INFO",
    };
    let fields = serde_json::json!({ "message": plain(text).trim_end() });
    format!("{}\n", serde_json::json!({ "level": level, "fields": fields, "target": "pitchlock" }))
}

/// Prints results to standard output; a reader that has gone away is not an error, a full disk is.
pub(crate) fn print(text: &str) {
    PRINTED.store(true, Ordering::Relaxed);
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
