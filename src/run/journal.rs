//! The journal of a run and the record of what reached its modules, each written by a thread: in the run
//! folder there is at any time what the control knows, and what its machine needs to be made again up to
//! there.
//!
//! The first record is written before anything moves. From there on nothing waits for the disk: what the
//! threads cannot take yet is kept back, and the newest takes its place. A state goes through the thread of
//! the record to that of the journal, so it is never there without what had reached the modules before. What
//! comes soon after the disk was asked is written at once, and confirmed with what follows.

use std::{
    io,
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, RecvTimeoutError, SyncSender, TryRecvError, TrySendError, sync_channel},
    },
    time::Duration,
};

use process::ipc::time::Moment;
use rig::{
    journal::{Book, File, Keeper, Medium, State},
    observe::Record,
    replay::Collector,
};

use super::{
    disk::{DISK, Disk, News, Unwritten, look_again},
    moment::{EVERY, EVERY_FAST, Live},
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

/// What is to be written: nothing, or what became of it since the threads took the last.
#[derive(Default)]
struct Kept {
    /// The newest state.
    state: Option<State>,
    /// How many control cycles are recorded.
    cycles: Option<u64>,
    /// What reached the modules, as lines of its file.
    lines: String,
}

/// A journal that is being written.
pub(super) struct Journal {
    keeper: Keeper,
    disk: Disk<Kept>,
    kept_back: Kept,
    /// The record of the machine is written every so many control cycles at least.
    every: u64,
    /// Changes of arrivals that are in it.
    arrivals: usize,
    /// Ends when the first record is written.
    first: Receiver<()>,
    begun: bool,
    asked: Arc<AtomicBool>,
}

impl Journal {
    /// A new journal in a run folder, of a machine that keeps to the wall or runs as `fast` as it can;
    /// `asked` tells that the operator wants something. The record of arrivals begins with `head`.
    pub(super) fn create(
        folder: &Path,
        keeper: Keeper,
        head: &str,
        fast: bool,
        asked: Arc<AtomicBool>,
    ) -> Result<Journal, CliError> {
        let path = folder.join(JOURNAL);
        let book = Spared::create(&path).map(Book::new).map_err(|error| CliError::file(&path, error))?;
        let mut live = Live::create(folder, head)?;
        let often = if fast { (GATHER_FAST, EVERY_FAST) } else { (GATHER, EVERY) };
        let journal = Journal::on(book, keeper, asked, move |cycles, lines| live.write(cycles, lines), often);
        journal.map_err(|error| CliError::Machine(error.to_string()))
    }

    fn on<M: Medium + Send + 'static>(
        book: Book<M>,
        keeper: Keeper,
        asked: Arc<AtomicBool>,
        live: impl FnMut(u64, &str) + Send + 'static,
        (gather, every): (Duration, u64),
    ) -> io::Result<Journal> {
        let (begins, first) = sync_channel(0);
        let journal = Disk::start("journal", WAITING, move |news| write(news, book, gather, begins))?;
        let disk = Disk::start("record", WAITING, move |news| hand_on(news, live, journal))?;
        Ok(Journal {
            keeper,
            disk,
            kept_back: Kept::default(),
            every,
            arrivals: 0,
            first,
            begun: false,
            asked,
        })
    }

    /// Takes one control cycle, and what has reached the modules.
    pub(super) fn cycle(&mut self, record: &Record, collected: &Collector) {
        let state = self.keeper.cycle(record);
        let (cycles, so_far) = (record.truth.cycle.0 + 1, collected.so_far());
        let kept = &mut self.kept_back;
        let more = so_far.changes.len() > self.arrivals;
        if more {
            kept.lines += &so_far.lines_from(self.arrivals);
            self.arrivals = so_far.changes.len();
        }
        if more || state.is_some() || cycles.is_multiple_of(self.every) {
            kept.cycles = Some(cycles);
        }
        let begins = state.is_some() && !self.begun;
        kept.state = state.or(kept.state);
        // In most cycles there is nothing, and what there would be is long.
        if kept.state.is_none() && kept.cycles.is_none() {
            return;
        }
        if let Err(TrySendError::Full(back)) = self.disk.offer(std::mem::take(kept)) {
            self.kept_back = back;
        } else if begins {
            self.begun = true;
            self.wait_for_the_first();
        }
    }

    /// Before anything moves: a journal is never without a whole record. Somebody who wants the machine to
    /// stop does not wait for that.
    fn wait_for_the_first(&self) {
        while self.first.try_recv() == Err(TryRecvError::Empty) && !self.asked.load(Ordering::Relaxed) {
            look_again();
        }
    }

    /// Writes what is known last, waits until the disk has it, or has done nothing for so long; why not all
    /// of it could be written.
    pub(super) fn finish(self, patience: Duration) -> Result<(), Unwritten> {
        let state = self.keeper.last().or(self.kept_back.state);
        self.disk.finish(Some(Kept { state, ..self.kept_back }), patience)
    }
}

/// Writes what reached the modules, and hands on the state that was known then: the newest, if the journal
/// takes none now.
fn hand_on(news: &News<Kept>, mut live: impl FnMut(u64, &str), journal: Disk<State>) -> Result<(), String> {
    let mut newest = None;
    while let Ok(Kept { state, cycles, lines }) = news.next() {
        cycles.into_iter().for_each(|cycles| live(cycles, &lines));
        newest = state.or(newest);
        if let Some(state) = newest.take()
            && let Err(TrySendError::Full(back)) = journal.offer(state)
        {
            newest = Some(back);
        }
    }
    journal.finish(newest, DISK).map_err(|error| error.to_string())
}

/// Writes what comes, and confirms it: at once where the disk was not asked for a while, else with what
/// follows. Whoever waits for the first one waits for the end of `begins`.
fn write<M: Medium>(
    news: &News<State>,
    mut book: Book<M>,
    gather: Duration,
    begins: SyncSender<()>,
) -> Result<(), String> {
    let mut begins = Some(begins);
    // When the disk was asked last, and whether something waits for it.
    let (mut asked, mut waits) = (None::<Moment>, false);
    // Why the last one could not be written. The next one is tried again: it is a whole state.
    let mut failed = None;
    loop {
        let rest = asked.map_or(Duration::ZERO, |asked| gather.saturating_sub(asked.elapsed()));
        let came = match waits {
            false => news.next().map_err(|_| RecvTimeoutError::Disconnected),
            true => news.next_within(rest),
        };
        match came {
            Ok(state) => {
                failed = book.write(&state).err();
                drop(begins.take());
                waits = true;
            }
            Err(RecvTimeoutError::Timeout) => {
                failed = book.sync().err().or(failed);
                (asked, waits) = (Some(Moment::now()), false);
            }
            Err(RecvTimeoutError::Disconnected) => {
                let written = failed.map_or(Ok(()), Err);
                return written.and_then(|()| book.sync().map(drop)).map_err(|error| error.to_string());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use machine::Machine;
    use protocol::{Cycle, MachineStatus, Truth};
    use rig::journal::{Origin, latest};

    use super::*;

    /// A disk that takes one record, and the next ones when it is told to.
    struct Standing {
        bytes: Arc<Mutex<Vec<u8>>>,
        answers: Receiver<()>,
        first: bool,
    }

    impl Medium for Standing {
        fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
            if !std::mem::take(&mut self.first) {
                // Until nobody holds it any more.
                let _ = self.answers.recv();
            }
            self.bytes.lock().expect("nobody panics").extend(bytes);
            Ok(())
        }

        fn sync(&mut self) -> io::Result<()> {
            Ok(())
        }

        fn replace(&mut self, bytes: &[u8]) -> io::Result<()> {
            *self.bytes.lock().expect("nobody panics") = bytes.into();
            Ok(())
        }
    }

    /// Every cycle is an event, thousands more than wait for the disk: each goes on at once, the newest is
    /// kept, and what reached the modules meanwhile is not lost.
    #[test]
    fn no_cycle_waits_for_a_journal_whose_disk_stands() {
        const CYCLES: u64 = 20_000;
        let (holds, answers) = sync_channel::<()>(0);
        let (bytes, live) = (Arc::<Mutex<Vec<u8>>>::default(), Arc::<Mutex<(u64, usize)>>::default());
        let medium = Standing { bytes: Arc::clone(&bytes), answers, first: true };
        let keeper = Keeper::new(&Machine::plain(), Origin::default(), &[]);
        let seen = Arc::clone(&live);
        let seen = move |cycles, lines: &str| {
            let mut seen = seen.lock().expect("nobody panics");
            *seen = (cycles, seen.1 + lines.lines().count());
        };
        let journal = Journal::on(Book::new(medium), keeper, Arc::default(), seen, (Duration::ZERO, EVERY));
        let (mut journal, mut collected) = (journal.expect("a thread"), Collector::new(true, 4));
        for cycle in 0..CYCLES {
            let truth = Truth { cycle: Cycle(cycle), ..Truth::default() };
            let machine =
                MachineStatus { cycle: truth.cycle, tool: cycle as u32, ..MachineStatus::default() };
            collected.asked(cycle, Some(protocol::operator::Request::Stop));
            journal.cycle(&Record { truth: &truth, axes: &[], machine: &machine }, &collected);
        }
        let known = || latest::<State>(&bytes.lock().expect("nobody panics")).expect("a whole record").1;
        assert_eq!(known().tool, 0, "the disk stands");
        drop(holds);
        journal.finish(DISK).expect("it is written");
        assert_eq!(u64::from(known().tool), CYCLES - 1);
        let lines = collected.so_far().lines_from(0).lines().count();
        assert_eq!(live.lock().expect("nobody panics").1, lines);
        assert!(lines > 0);
    }
}
