//! How far the simulated machine is and what has reached its modules, kept while it runs: who makes the run
//! again after all processes were killed needs that to know the machine. It is the truth, and no control
//! reads it.
//!
//! | file | what |
//! |---|---|
//! | `moment.bin` | control cycles that are recorded, in steps of at most 64, or 512 of a machine that runs as fast as it can be computed: a number of eight bytes, little-endian, and its complement |
//! | `arrivals.live` | the lines of `arrivals.txt` as it grows, each twice, with its number and a hash |

use std::{
    fs::{self, File},
    io::Write as _,
    os::unix::fs::FileExt as _,
    path::{Path, PathBuf},
};

use rig::replay::Arrivals;

use crate::error::CliError;

/// Their names in the run folder.
pub(crate) const MOMENT: &str = "moment.bin";
pub(crate) const LIVE: &str = "arrivals.live";
/// Bytes of a number and its complement.
const BYTES: usize = 16;
/// Written every so many control cycles: in every one it would take a sixth of virtual speed.
pub(super) const EVERY: u64 = 64;
/// The same of a machine that runs as fast as it can be computed: to wake the thread that writes took half of
/// what a record costs.
pub(super) const EVERY_FAST: u64 = 512;

/// The record of a machine that runs.
pub(super) struct Live {
    moment: File,
    arrivals: File,
}

impl Live {
    /// A new record in a run folder.
    pub(super) fn create(folder: &Path, head: &str) -> Result<Live, CliError> {
        let create = |path: &Path| File::create_new(path).map_err(|error| CliError::file(path, error));
        let [moment, path] = paths(folder);
        let (moment, mut arrivals) = (create(&moment)?, create(&path)?);
        arrivals.write_all(head.as_bytes()).map_err(|error| CliError::file(&path, error))?;
        Ok(Live { moment, arrivals })
    }

    /// So many control cycles are recorded, and these are the next lines of what reached the modules. A disk
    /// that is full costs what does not fit.
    pub(super) fn write(&mut self, cycles: u64, lines: &str) {
        if !lines.is_empty() {
            let _ = self.arrivals.write_all(lines.as_bytes());
        }
        let mut bytes = [0; BYTES];
        bytes[..BYTES / 2].copy_from_slice(&cycles.to_le_bytes());
        bytes[BYTES / 2..].copy_from_slice(&(!cycles).to_le_bytes());
        let _ = self.moment.write_all_at(&bytes, 0);
    }
}

fn paths(folder: &Path) -> [PathBuf; 2] {
    [MOMENT, LIVE].map(|name| folder.join(name))
}

/// The run has ended, and all of it is kept elsewhere.
pub(super) fn remove(folder: &Path) {
    paths(folder).iter().for_each(|path| {
        let _ = fs::remove_file(path);
    });
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
