//! The journal of a run, written by a thread of its own: in its folder there is at any time what the control
//! knows.
//!
//! The first record is written before anything moves. From there on nothing waits for the disk: what the
//! thread cannot take yet is kept back, and the newest takes its place. What comes soon after the disk was
//! asked is written at once, and confirmed with what follows.

use std::{
    io,
    path::{Path, PathBuf},
    sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel},
    thread::JoinHandle,
    time::Duration,
};

use process::ipc::time::Moment;
use rig::{
    journal::{Book, File, Keeper, Medium, State},
    observe::Record,
};

use crate::error::CliError;

/// Its name in the run folder.
pub(crate) const JOURNAL: &str = "journal.bin";
/// Records that wait for the disk at most.
const WAITING: usize = 64;
/// The disk is asked to have it at most so often: of a machine that runs much faster than in truth, asking
/// for each record by itself would take three in a hundred of the run.
const GATHER: Duration = Duration::from_millis(20);
/// The same of a machine that runs as fast as it can be computed: what is written is safe from a kill at
/// once, and asking took half of what a journal costs.
const GATHER_FAST: Duration = Duration::from_millis(60);

/// Room beside a journal for the one that takes its place, bytes.
const SPARE: usize = 4096;

/// The file of a journal. A disk that fills up leaves it room for the newest record.
struct Spared {
    file: File,
    path: PathBuf,
}

impl Spared {
    fn create(path: &Path) -> io::Result<Spared> {
        let file = File::create(path)?;
        intake::reserve(path, SPARE)?;
        Ok(Spared { file, path: path.into() })
    }
}

impl Medium for Spared {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.append(bytes)
    }

    fn sync(&mut self) -> io::Result<()> {
        self.file.sync()
    }

    fn replace(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.replace(bytes)?;
        // Its room has just become free: where somebody else was faster the next one is without.
        let _ = intake::reserve(&self.path, SPARE);
        Ok(())
    }
}

impl Drop for Spared {
    fn drop(&mut self) {
        intake::release(&self.path);
    }
}

/// A journal that is being written.
pub(crate) struct Journal {
    keeper: Keeper,
    to_disk: SyncSender<State>,
    thread: JoinHandle<io::Result<()>>,
    kept_back: Option<State>,
    /// Ends when the first record is written.
    first: Receiver<()>,
    begun: bool,
}

impl Journal {
    /// A new journal in a run folder, of a machine that keeps to the wall or runs as `fast` as it can.
    pub(crate) fn create(folder: &Path, keeper: Keeper, fast: bool) -> Result<Journal, CliError> {
        let path = folder.join(JOURNAL);
        let book = Spared::create(&path).map(Book::new).map_err(|error| CliError::file(&path, error))?;
        let (to_disk, news) = sync_channel(WAITING);
        let (begins, first) = sync_channel(0);
        let gather = if fast { GATHER_FAST } else { GATHER };
        let thread = std::thread::Builder::new().name("journal".into());
        let thread = thread.spawn(move || write(&news, book, gather, begins));
        let thread = thread.map_err(|error| CliError::Machine(error.to_string()))?;
        Ok(Journal { keeper, to_disk, thread, kept_back: None, first, begun: false })
    }

    /// Takes one control cycle.
    pub(crate) fn cycle(&mut self, record: &Record) {
        if let Some(news) = self.keeper.cycle(record) {
            self.kept_back = Some(news);
        }
        // In most cycles there is nothing, and what there would be is long.
        let Some(news) = &self.kept_back else { return };
        if !matches!(self.to_disk.try_send(*news), Err(TrySendError::Full(_))) {
            self.kept_back = None;
            // Before anything moves: a journal is never without a whole record.
            if !std::mem::replace(&mut self.begun, true) {
                let _ = self.first.recv();
            }
        }
    }

    /// Writes what is known last, waits until the disk has it; why not all of it could be written.
    pub(crate) fn finish(self) -> io::Result<()> {
        if let Some(state) = self.keeper.last() {
            let _ = self.to_disk.send(state);
        }
        drop(self.to_disk);
        self.thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

/// Writes what comes, and confirms it: at once where the disk was not asked for a while, else with what
/// follows. Whoever waits for the first one waits for the end of `begins`.
fn write(
    news: &Receiver<State>,
    mut book: Book<Spared>,
    gather: Duration,
    begins: SyncSender<()>,
) -> io::Result<()> {
    let mut begins = Some(begins);
    // When the disk was asked last, and whether something waits for it.
    let (mut asked, mut waits) = (None::<Moment>, false);
    // Why the last one could not be written. The next one is tried again: it is a whole state.
    let mut failed = None;
    loop {
        let rest = asked.map_or(Duration::ZERO, |asked| gather.saturating_sub(asked.elapsed()));
        let came = match waits {
            false => news.recv().map_err(|_| RecvTimeoutError::Disconnected),
            true => news.recv_timeout(rest),
        };
        match came {
            Ok(first) => {
                for state in std::iter::once(first).chain(news.try_iter()) {
                    failed = book.write(&state).err();
                    drop(begins.take());
                }
                waits = true;
            }
            Err(RecvTimeoutError::Timeout) => {
                failed = book.sync().err().or(failed);
                (asked, waits) = (Some(Moment::now()), false);
            }
            Err(RecvTimeoutError::Disconnected) => {
                let written = failed.map_or(Ok(()), Err);
                return written.and_then(|()| book.sync().map(|_| ()));
            }
        }
    }
}
