//! How far the simulated machine is and what has reached its modules, kept while it runs: who makes the run
//! again after all processes were killed needs that to know the machine. It is the truth, and no control
//! reads it.
//!
//! | file | what |
//! |---|---|
//! | `moment.bin` | control cycles that are recorded, in steps of 64: a number of eight bytes, little-endian, and its complement |
//! | `arrivals.live` | the lines of `arrivals.txt` as it grows, each twice, with its number and a hash |

use std::{
    fs::{self, File},
    io::Write as _,
    os::unix::fs::FileExt as _,
    path::{Path, PathBuf},
};

use rig::replay::{Arrivals, Collector};

use crate::error::CliError;

/// Their names in the run folder.
pub(crate) const MOMENT: &str = "moment.bin";
pub(crate) const LIVE: &str = "arrivals.live";
/// Bytes of a number and its complement.
const BYTES: usize = 16;
/// Written every so many control cycles: in every one it would take a sixth of virtual speed.
const EVERY: u64 = 64;

/// The record of a machine that runs.
pub(super) struct Live {
    paths: [PathBuf; 2],
    moment: File,
    arrivals: File,
    /// Changes that are written.
    written: usize,
}

impl Live {
    /// A new record in a run folder.
    pub(super) fn create(folder: &Path, head: &str) -> Result<Live, CliError> {
        let paths = [MOMENT, LIVE].map(|name| folder.join(name));
        let create = |path: &Path| File::create_new(path).map_err(|error| CliError::file(path, error));
        let (moment, mut arrivals) = (create(&paths[0])?, create(&paths[1])?);
        arrivals.write_all(head.as_bytes()).map_err(|error| CliError::file(&paths[1], error))?;
        Ok(Live { paths, moment, arrivals, written: 0 })
    }

    /// So many control cycles are recorded. A disk that is full costs what does not fit.
    pub(super) fn cycle(&mut self, cycles: u64, collected: &Collector) {
        let so_far = collected.so_far();
        if so_far.changes.len() > self.written {
            let _ = self.arrivals.write_all(so_far.lines_from(self.written).as_bytes());
            self.written = so_far.changes.len();
        }
        if !cycles.is_multiple_of(EVERY) {
            return;
        }
        let mut bytes = [0; BYTES];
        bytes[..BYTES / 2].copy_from_slice(&cycles.to_le_bytes());
        bytes[BYTES / 2..].copy_from_slice(&(!cycles).to_le_bytes());
        let _ = self.moment.write_all_at(&bytes, 0);
    }

    /// The run has ended, and all of it is kept elsewhere.
    pub(super) fn remove(self) {
        self.paths.iter().for_each(|path| {
            let _ = fs::remove_file(path);
        });
    }
}

/// Control cycles that were recorded of a run whose processes were killed, if that is known.
pub(crate) fn cycles(folder: &Path) -> Option<u64> {
    let bytes = intake::bytes(&folder.join(MOMENT), BYTES as u64).ok()?;
    let [cycles, complement] = [0, BYTES / 2].map(|at| {
        let half: Option<[u8; 8]> = bytes.get(at..at + BYTES / 2).and_then(|half| half.try_into().ok());
        half.map(u64::from_le_bytes)
    });
    cycles.filter(|cycles| complement == Some(!cycles))
}

/// What had reached the modules of such a run.
pub(crate) fn arrivals(folder: &Path) -> Arrivals {
    let bytes = intake::bytes(&folder.join(LIVE), rig::replay::MOST_BYTES).unwrap_or_default();
    Arrivals::left(&bytes)
}
