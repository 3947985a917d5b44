//! The trace of a run, written by a thread of its own. In: a row of every control cycle. Out: the file, or
//! why there is none; how many rows are not in it because the disk did not take them in time.

use std::{
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::TrySendError,
    },
    time::Duration,
};

use process::ipc::time::Moment;
use rig::{
    observe::FaultReport,
    trace::{Row, TraceWriter, hash_of},
};

use super::disk::{DISK, Disk, News, Unwritten, look_again};

/// Rows that are handed over at once, and how often that may wait for the disk: 8 s on the machine.
const BATCH: usize = 256;
const WAITING: usize = 64;
/// Nobody is waiting but a computer; after Ctrl-C somebody is, and a disk that takes nothing for so long
/// costs rows.
const HURRY: Duration = Duration::from_millis(500);
/// What the system calls a disk, and a share of it, that is full: ENOSPC, EDQUOT.
const FULL: [i32; 2] = [28, 122];

/// A trace that is being written.
pub(super) struct Traced {
    disk: Disk<Vec<Row>>,
    path: PathBuf,
    batch: Vec<Row>,
    patience: Patience,
    lost: Lost,
}

/// Rows that are not in the trace.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Lost {
    /// How many.
    pub(super) rows: u64,
    /// Control cycle of the first.
    pub(super) first: u64,
}

impl Lost {
    /// What the operator has to know.
    pub(super) fn told(self) -> Option<FaultReport> {
        let Lost { rows, first } = self;
        let text = format!(
            "{rows} cycles, the first of them {first}, are not in the trace: the disk did not take them in time, and the machine \
             does not wait for it"
        );
        let (source, code) = ("launcher".into(), "trace-has-gaps".into());
        (rows > 0).then_some(FaultReport { cycle: first, source, code, text })
    }
}

/// Whether a machine that has no time but its own waits for the disk.
pub(super) struct Patience {
    /// It does, until somebody asks for something: in lock step that changes no cycle.
    pub(super) waits: bool,
    /// Somebody has.
    pub(super) asked: Arc<AtomicBool>,
}

impl Traced {
    /// A thread that writes this trace.
    ///
    /// # Errors
    /// The computer has no thread to spare.
    pub(super) fn start(path: &Path, trace: TraceWriter, patience: Patience) -> std::io::Result<Traced> {
        let kept = path.to_owned();
        let disk = Disk::start("trace", WAITING, move |rows| write(rows, trace, &kept))?;
        let batch = Vec::with_capacity(BATCH);
        Ok(Traced { disk, path: path.into(), batch, patience, lost: Lost::default() })
    }

    /// Takes the row of a control cycle; false if there will be no trace.
    pub(super) fn row(&mut self, row: Row) -> bool {
        self.batch.push(row);
        if self.batch.len() < BATCH {
            return true;
        }
        let mut batch = std::mem::replace(&mut self.batch, Vec::with_capacity(BATCH));
        let since = Moment::now();
        loop {
            match self.disk.offer(batch) {
                Ok(()) => return true,
                Err(TrySendError::Disconnected(_)) => return false,
                Err(TrySendError::Full(back)) if self.waits_on(since) => batch = back,
                Err(TrySendError::Full(back)) => {
                    self.lose(&back);
                    return true;
                }
            }
            look_again();
        }
    }

    fn waits_on(&self, since: Moment) -> bool {
        let Patience { waits, asked } = &self.patience;
        // Once rows were lost nobody waits again before the disk has answered.
        *waits && (!asked.load(Ordering::Relaxed) || self.lost.rows == 0 && since.elapsed() < HURRY)
    }

    fn lose(&mut self, rows: &[Row]) {
        if self.lost.rows == 0 {
            self.lost.first = rows.first().map_or(0, |row| row.cycle);
        }
        self.lost.rows += rows.len() as u64;
    }

    /// Completes the file: its hash, or why there is none; and the rows that are not in it.
    pub(super) fn finish(self) -> (Result<String, Unwritten>, Lost) {
        let Traced { disk, path, batch, lost, .. } = self;
        let hashed = |()| hash_of(&path).map_err(|error| Unwritten::Failed(error.to_string()));
        (disk.finish(Some(batch), DISK).and_then(hashed), lost)
    }
}

/// Writes what comes, to its end. A trace that has no room any more goes: its room is that of the journal and
/// the rest.
fn write(rows: &News<Vec<Row>>, mut trace: TraceWriter, path: &Path) -> Result<(), String> {
    let written = loop {
        match rows.next() {
            Ok(batch) => {
                if let Err(error) = batch.iter().try_for_each(|row| trace.row(row)) {
                    drop(trace);
                    break Err(error);
                }
            }
            Err(_) => break trace.finish(),
        }
    };
    written.map_err(|error| {
        let text = error.to_string();
        let full = FULL.map(|code| std::io::Error::from_raw_os_error(code).to_string());
        if full.iter().any(|full| text.contains(full.as_str())) {
            let _ = std::fs::remove_file(path);
        }
        text
    })
}

#[cfg(test)]
#[allow(clippy::disallowed_methods)] // threads, as in the launcher
mod tests {
    use std::{
        collections::BTreeSet,
        fs::{File, OpenOptions},
        io::Read as _,
        process::Command,
        sync::atomic::AtomicU64,
    };

    use rig::{
        observe::{Led, Traced as Work},
        trace::{CutRow, Format},
    };

    use super::*;

    /// Cycles of a run: more than the queue, all buffers and a pipe hold.
    const CYCLES: u64 = 80_000;

    fn row(cycle: u64) -> Row {
        Row {
            cycle,
            t_s: 0.0,
            spindle_true_deg: 0.0,
            spindle_counts: 0,
            spindle_rpm: 0.0,
            override_pct: 100.0,
            axes: Vec::new(),
            pass: 0,
            line: 0,
            cut: CutRow::default(),
            traced: Work::default(),
            led: Led::default(),
        }
    }

    /// A trace on a disk that takes nothing (a pipe that nobody reads), and what it takes once it answers
    /// again.
    fn standing(place: &Path, patience: Patience) -> (Traced, File) {
        let path = place.join("trace.csv");
        assert!(Command::new("mkfifo").arg(&path).status().expect("mkfifo").success());
        let both = OpenOptions::new().read(true).write(true).open(&path).expect("a pipe");
        let trace = TraceWriter::create(&path, Format::Csv, &[]).expect("it is there");
        let reads = File::open(&path).expect("a pipe");
        drop(both);
        (Traced::start(&path, trace, patience).expect("a thread"), reads)
    }

    /// The disk answers again at the end of the run: every cycle is in the trace, or counted as lost.
    fn is_counted(traced: Traced, mut reads: File) {
        let read = std::thread::spawn(move || {
            let mut text = String::new();
            reads.read_to_string(&mut text).expect("text");
            text
        });
        let (_, lost) = traced.finish();
        let text = read.join().expect("it reads");
        let cycle = |line: &str| line.split(',').next().and_then(|cell| cell.parse::<u64>().ok());
        let there: BTreeSet<u64> = text.lines().skip(1).filter_map(cycle).collect();
        let missing: Vec<u64> = (0..CYCLES).filter(|cycle| !there.contains(cycle)).collect();
        assert_eq!((missing.len() as u64, missing.first().copied()), (lost.rows, Some(lost.first)));
        assert!(lost.rows > CYCLES / 4, "{lost:?}: the disk took nearly all");
        assert!(lost.told().expect("a warning").text.starts_with(&format!("{} cycles", lost.rows)));
    }

    /// Where time is the wall's: each cycle goes on at once.
    #[test]
    fn a_disk_that_stands_costs_rows_that_are_counted() {
        let place = tempfile::tempdir().expect("a folder");
        let patience = Patience { waits: false, asked: Arc::default() };
        let (mut traced, reads) = standing(place.path(), patience);
        assert!((0..CYCLES).all(|cycle| traced.row(row(cycle))));
        is_counted(traced, reads);
    }

    /// In lock step the machine waits for the disk, until somebody wants it to stop.
    #[test]
    fn nobody_who_asks_for_a_stop_waits_for_the_disk() {
        let place = tempfile::tempdir().expect("a folder");
        let asked = Arc::<AtomicBool>::default();
        let patience = Patience { waits: true, asked: Arc::clone(&asked) };
        let (mut traced, reads) = standing(place.path(), patience);
        let at = Arc::<AtomicU64>::default();
        let cycles = Arc::clone(&at);
        let machine = std::thread::spawn(move || {
            for cycle in 0..CYCLES {
                assert!(traced.row(row(cycle)));
                cycles.store(cycle, Ordering::Relaxed);
            }
            traced
        });
        // It comes to where the queue is full, and no farther.
        while at.load(Ordering::Relaxed) < (BATCH * WAITING) as u64 - 1 {
            look_again();
        }
        assert!(!machine.is_finished());
        asked.store(true, Ordering::Relaxed);
        is_counted(machine.join().expect("it goes on"), reads);
    }
}
