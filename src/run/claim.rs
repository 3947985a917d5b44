//! The claim of a run to its folder: nobody else writes into it, it has room for the summary, and a run that
//! came to nothing leaves none behind.

use std::fs::{self, DirBuilder, File, Metadata, TryLockError};
use std::io;
use std::os::unix::fs::DirBuilderExt as _;
use std::path::{Path, PathBuf};

use process::ipc::computer;
use rig::trace;

use super::args::RunArgs;
use super::folder::BEFORE;
use super::journal::JOURNAL;
use crate::{error::CliError, written};

/// What a run leaves, and a machine that never started does not.
pub(crate) const SUMMARY: &str = "summary.json";

/// A folder that this run alone writes into.
pub(super) struct Claim {
    /// The folder.
    pub(super) path: PathBuf,
    /// It was made for this run.
    made: bool,
    /// Held as long as the run writes into it.
    _lock: File,
}

impl Claim {
    /// Makes a folder, or takes an empty one, with room for a summary of so many passes, circles and works.
    ///
    /// # Errors
    /// Other files or another run are in it, or it cannot be made.
    pub(super) fn new(args: &RunArgs, watched: usize) -> Result<Claim, CliError> {
        let claim = match &args.out {
            None => {
                let path = numbered(&args.program)?;
                let lock = lock(&path)?;
                Claim { path, made: true, _lock: lock }
            }
            Some(path) => {
                // Another run is named as such, and not as files.
                let there = path.is_dir().then(|| lock(path)).transpose()?;
                there.as_ref().map_or(Ok(()), |folder| is_own(path, folder))?;
                written::empty(path)?;
                private(true).create(path).map_err(|error| CliError::file(path, error))?;
                let made = there.is_none();
                let lock = there.map_or_else(|| lock(path), Ok)?;
                Claim { path: path.clone(), made, _lock: lock }
            }
        };
        claim.reserve(watched)?;
        Ok(claim)
    }

    /// Takes room for the summary: what a disk that fills up costs is the trace.
    fn reserve(&self, watched: usize) -> Result<(), CliError> {
        let (summary, room) = (self.path.join(SUMMARY), ROOM + ROOM_OF_ONE * watched);
        intake::reserve(&summary, room).map_err(|error| {
            CliError::Machine(format!("{}: no room for {} kB: {error}", summary.display(), room >> 10))
        })
    }
}

/// A folder without summary, journal and trace is that of a run that never began: whoever tries again finds
/// what was there before.
impl Drop for Claim {
    fn drop(&mut self) {
        intake::release(&self.path.join(SUMMARY));
        let traces = [trace::Format::Mcap, trace::Format::Csv].map(trace::Format::file_name);
        if traces.into_iter().chain([SUMMARY, JOURNAL]).any(|name| self.path.join(name).exists()) {
            return;
        }
        // Nothing but copies is in it; what cannot be removed is left.
        let _ = fs::remove_dir_all(self.path.join(BEFORE));
        for file in fs::read_dir(&self.path).into_iter().flatten().flatten() {
            let _ = fs::remove_file(file.path());
        }
        if self.made {
            let _ = fs::remove_dir(&self.path);
        }
    }
}

/// Bytes of a summary, and of what it has about a pass, a circle or a work; some more than they are.
const ROOM: usize = 64 << 10;
const ROOM_OF_ONE: usize = 4 << 10;

/// A folder that nobody else can look into.
fn private(recursive: bool) -> DirBuilder {
    let mut builder = DirBuilder::new();
    builder.recursive(recursive).mode(0o700);
    builder
}

/// Refuses a folder in which somebody else may put another program in the place of the one that was checked.
fn is_own(path: &Path, folder: &File) -> Result<(), CliError> {
    let own = |found: io::Result<Metadata>| found.map(|found| computer::is_own(&found));
    let both = own(fs::symlink_metadata(path)).and_then(|named| Ok(named && own(folder.metadata())?));
    match both.map_err(|error| CliError::file(path, error))? {
        true => Ok(()),
        false => {
            let text = "is another user's, or others may write into it, and they could change the run: name a folder of your own";
            Err(CliError::file(path, text))
        }
    }
}

/// Whether a run has taken room for its summary in a folder and has not written it: it goes on, or was
/// broken off.
pub(crate) fn is_claimed(path: &Path) -> bool {
    path.join("summary.json.new").exists()
}

/// Whether a run still writes into a folder.
pub(crate) fn is_held(path: &Path) -> bool {
    File::open(path).is_ok_and(|folder| matches!(folder.try_lock(), Err(TryLockError::WouldBlock)))
}

/// Two runs do not write into one folder.
fn lock(path: &Path) -> Result<File, CliError> {
    let folder = File::open(path).map_err(|error| CliError::file(path, error))?;
    match folder.try_lock() {
        Err(TryLockError::WouldBlock) => {
            Err(CliError::file(path, "another run writes into this folder: name another one with --out"))
        }
        // A file system without locks.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(folder),
    }
}

/// `runs/<program>-<n>` with the first number that is free.
fn numbered(program: &Path) -> Result<PathBuf, CliError> {
    let stem = program.file_stem().unwrap_or_else(|| "program".as_ref()).to_string_lossy();
    let runs = Path::new("runs");
    std::fs::create_dir_all(runs).map_err(|error| CliError::file(runs, error))?;
    for n in 1..1_000_000 {
        let path = runs.join(format!("{stem}-{n}"));
        match private(false).create(&path) {
            Ok(()) => return Ok(path),
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(CliError::file(&path, error)),
        }
    }
    Err(CliError::Input("runs/ is full: remove old run folders, or name one with --out".into()))
}
