//! The journal of a run, written by a thread of its own: in its folder there is at any time what the control
//! knows.
//!
//! Nothing waits for the disk: what the thread cannot take yet is kept back, and the newest takes its place.

use std::{
    io,
    path::Path,
    sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel},
    thread::JoinHandle,
};

use rig::{
    journal::{Book, File, Keeper, State},
    observe::Record,
};

use crate::error::CliError;

/// Its name in the run folder.
pub(crate) const JOURNAL: &str = "journal.bin";
/// Records that wait for the disk at most.
const WAITING: usize = 64;

/// A journal that is being written.
pub(crate) struct Journal {
    keeper: Keeper,
    to_disk: SyncSender<State>,
    thread: JoinHandle<io::Result<()>>,
    kept_back: Option<State>,
}

impl Journal {
    /// A new journal in a run folder.
    pub(crate) fn create(folder: &Path, keeper: Keeper) -> Result<Journal, CliError> {
        let path = folder.join(JOURNAL);
        let book = File::create(&path).map(Book::new).map_err(|error| CliError::file(&path, error))?;
        let (to_disk, news) = sync_channel(WAITING);
        let thread = std::thread::Builder::new().name("journal".into()).spawn(move || write(&news, book));
        let thread = thread.map_err(|error| CliError::Machine(error.to_string()))?;
        Ok(Journal { keeper, to_disk, thread, kept_back: None })
    }

    /// Takes one control cycle.
    pub(crate) fn cycle(&mut self, record: &Record) {
        let news = self.keeper.cycle(record).or(self.kept_back.take());
        self.kept_back = news.and_then(|news| match self.to_disk.try_send(news) {
            Ok(()) => None,
            Err(TrySendError::Full(news)) => Some(news),
            // The thread has met an error, which is told at the end.
            Err(TrySendError::Disconnected(_)) => None,
        });
    }

    /// Writes what is known last, waits until the disk has it; why not all of it could be written.
    pub(crate) fn finish(self) -> io::Result<()> {
        if let Some(state) = self.keeper.last() {
            // Nobody listens any more once writing has failed.
            let _ = self.to_disk.send(state);
        }
        drop(self.to_disk);
        self.thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

/// Writes what comes, and confirms all of it that has come meanwhile at once.
fn write(news: &Receiver<State>, mut book: Book<File>) -> io::Result<()> {
    while let Ok(first) = news.recv() {
        for state in std::iter::once(first).chain(news.try_iter()) {
            book.write(&state)?;
        }
        book.sync()?;
    }
    Ok(())
}
