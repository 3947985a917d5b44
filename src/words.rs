//! What is said on standard error. A thread of its own writes it: a pipe that nobody reads and a terminal
//! that was stopped hold up that thread, never a machine. What does not fit into its queue meanwhile is not
//! said. In: lines, log messages, progress. Out: standard error.

use std::{
    io::{IsTerminal as _, Write},
    sync::{
        OnceLock,
        atomic::{AtomicU32, Ordering},
        mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel},
    },
    time::Duration,
};

use crate::screen;
use indicatif::{ProgressBar, ProgressStyle};
use process::ipc::time::{Moment, sleep_until};
use tracing::level_filters::LevelFilter;

/// Words that wait to be written.
const DEPTH: usize = 256;
/// What a writer needs of a stack, bytes. A plant locks all its memory.
const STACK: usize = 256 * 1024;
/// So long whoever runs a machine waits in the end for words to be read.
const LAST_WORDS: Duration = Duration::from_secs(1);

/// Work that takes longer is shown, and so often.
const PATIENCE: Duration = Duration::from_secs(1);
const PHASE_STEP: Duration = Duration::from_millis(200);
/// Nothing is due.
const FOREVER: Duration = Duration::from_secs(3600);

/// The line that such work has come to, from 1; 0 without one.
static LINE: AtomicU32 = AtomicU32::new(0);

/// Something for the writer.
enum Word {
    /// Bytes of whole lines.
    Lines(Vec<u8>),
    /// A bar of so many steps from here on.
    Bar(u64),
    /// Where the bar stands.
    Step(u64, String),
    /// No bar from here on.
    NoBar,
    /// Work without a known end, from this moment on.
    Phase(Moment, &'static str),
    /// That work has ended.
    NoPhase,
    /// Everything before this has been written when it is answered.
    Written(SyncSender<()>),
}

/// The way to the writer, once there was anything to say; nothing if the computer has no thread to spare.
static WRITER: OnceLock<Option<SyncSender<Word>>> = OnceLock::new();

fn send(word: Word) {
    let start = || {
        let (sender, words) = sync_channel(DEPTH);
        let thread = std::thread::Builder::new().name("words".into()).stack_size(STACK);
        thread.spawn(move || write(&words)).ok().map(|_| sender)
    };
    if let Some(writer) = WRITER.get_or_init(start) {
        // What does not fit is lost: nobody reads it anyway.
        let _ = writer.try_send(word);
    }
}

/// The thread.
fn write(words: &Receiver<Word>) {
    let mut bar: Option<ProgressBar> = None;
    let mut phase: Option<(Moment, &'static str)> = None;
    loop {
        let word = match (phase, words.recv_timeout(if phase.is_some() { PHASE_STEP } else { FOREVER })) {
            (_, Ok(word)) => word,
            (_, Err(RecvTimeoutError::Disconnected)) => return,
            (Some((since, what)), Err(RecvTimeoutError::Timeout)) => {
                go_on(&mut bar, since, what);
                continue;
            }
            (None, Err(RecvTimeoutError::Timeout)) => continue,
        };
        match word {
            Word::Lines(bytes) => {
                // A reader that has gone away is no error.
                let say = || {
                    let _ = std::io::stderr().write_all(&bytes);
                };
                bar.as_ref().map_or_else(say, |bar| bar.suspend(say));
            }
            Word::Phase(since, what) => phase = Some((since, what)),
            Word::NoPhase => {
                phase = None;
                bar.take().iter().for_each(ProgressBar::finish_and_clear);
            }
            Word::Bar(steps) => bar = Some(new_bar(steps)),
            Word::Step(position, message) => {
                if let Some(bar) = &bar {
                    bar.set_position(position);
                    bar.set_message(message);
                }
            }
            Word::NoBar => bar.take().iter().for_each(ProgressBar::finish_and_clear),
            Word::Written(answer) => {
                let _ = answer.send(());
            }
        }
    }
}

/// Work without a known end goes on: after a second it is shown, with what is counted of it.
fn go_on(bar: &mut Option<ProgressBar>, since: Moment, what: &str) {
    let elapsed = since.elapsed();
    if elapsed < PATIENCE {
        return;
    }
    let bar = bar.get_or_insert_with(|| {
        let style = ProgressStyle::with_template("{spinner} {msg}");
        ProgressBar::new_spinner().with_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()))
    });
    let at = match LINE.load(Ordering::Relaxed) {
        0 => String::new(),
        line => format!(", line {line}"),
    };
    bar.set_message(format!("{what}{at}, {} s", elapsed.as_secs()));
    bar.tick();
}

fn new_bar(steps: u64) -> ProgressBar {
    let bar = ProgressBar::new(steps);
    let style =
        ProgressStyle::with_template("{bar:24} {msg}").unwrap_or_else(|_| ProgressStyle::default_bar());
    bar.with_style(style)
}

/// Says something, which ends its lines itself. It is written soon, besides the bar.
pub(crate) fn say(text: &str) {
    send(Word::Lines(screen::said(text).into_bytes()));
}

/// Shows a bar of so many steps from here on, if there is a terminal. True if so.
pub(crate) fn show_bar(steps: u64) -> bool {
    let shows = std::io::stderr().is_terminal();
    if shows {
        send(Word::Bar(steps));
    }
    shows
}

/// A number of things: "1 pass", "2 passes".
pub(crate) fn counted(number: u64, one: &str, many: &str) -> String {
    format!("{number} {}", if number == 1 { one } else { many })
}

/// Sets the bar to a step.
pub(crate) fn step(position: u64, message: String) {
    send(Word::Step(position, message));
}

/// Takes the bar away.
pub(crate) fn hide_bar() {
    send(Word::NoBar);
}

/// Work without a known end, shown on a terminal if it takes longer than a second, until this is dropped.
pub(crate) struct Phase {
    shows: bool,
}

impl Phase {
    /// Work that begins. With `--quiet` nothing is shown.
    pub(crate) fn begin(what: &'static str) -> Phase {
        let is_quiet = LevelFilter::current() <= LevelFilter::ERROR;
        let shows = !is_quiet && std::io::stderr().is_terminal();
        if shows {
            LINE.store(0, Ordering::Relaxed);
            send(Word::Phase(Moment::now(), what));
        }
        Phase { shows }
    }

    /// The line of the program that it has come to.
    pub(crate) fn at(line: u32) {
        LINE.store(line, Ordering::Relaxed);
    }
}

impl Drop for Phase {
    fn drop(&mut self) {
        if self.shows {
            send(Word::NoPhase);
            flush(true);
        }
    }
}

/// Waits until everything is written; `bounded`: for a second at most, because a machine may depend on it.
pub(crate) fn flush(bounded: bool) {
    let Some(Some(writer)) = WRITER.get() else { return };
    let deadline = Moment::now().after(LAST_WORDS);
    let (answer, written) = sync_channel(1);
    while writer.try_send(Word::Written(answer.clone())).is_err() {
        if bounded && deadline.passed() {
            return;
        }
        sleep_until(Moment::in_s(0.001));
    }
    drop(answer);
    let is_slow = || written.recv_timeout(LAST_WORDS) == Err(RecvTimeoutError::Timeout);
    while is_slow() && !bounded {}
}

/// Where the log writes.
pub(crate) struct Log;

impl Write for Log {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        send(Word::Lines(bytes.to_vec()));
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}
