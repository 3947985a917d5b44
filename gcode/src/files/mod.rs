//! Files beside the program: tool table, parameters, machine description.

mod machine;
mod parameters;
mod tools;
mod words;

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

pub use machine::MachineFile;
pub use parameters::ParameterFile;
pub use tools::{Tool, ToolTable};

use crate::problem::Diagnostic;
use crate::text::readable;

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// It cannot be read.
    #[error("{}: cannot be read: {error}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// It cannot be written.
    #[error("{}: cannot be written: {error}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// What stands in it is wrong.
    #[error("{}", .0.render(false).trim_end())]
    Content(Box<Diagnostic>),
}

impl From<Box<Diagnostic>> for FileError {
    fn from(diagnostic: Box<Diagnostic>) -> FileError {
        FileError::Content(diagnostic)
    }
}

/// The text of a file.
fn read(path: &Path) -> Result<String, FileError> {
    let bytes =
        intake::bytes(path, intake::TABLE).map_err(|error| FileError::Read { path: path.into(), error })?;
    Ok(readable(&bytes))
}

/// Writes a file beside `path` and puts it in its place, so that there is a whole file at any time. It keeps
/// its permissions, and its place if `path` is a link. What is written to is new: no link is followed, no
/// pipe waited for, and nobody else's file is touched.
fn replace(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let old = path.canonicalize().ok();
    let path = old.as_deref().unwrap_or(path);
    let fresh = with_suffix(path, &format!(".{}.new", std::process::id()));
    let write = |error| FileError::Write { path: path.into(), error };
    let file = OpenOptions::new().write(true).create_new(true).open(&fresh).map_err(write)?;
    let fill = |mut file: File| {
        file.write_all(bytes)?;
        if let Some(old) = &old {
            file.set_permissions(fs::metadata(old)?.permissions())?;
        }
        file.sync_all()?;
        fs::rename(&fresh, path)
    };
    let written = fill(file);
    if written.is_ok()
        && let Some(folder) = path.parent().and_then(|folder| File::open(folder).ok())
    {
        let _ = folder.sync_all(); // not every file system can; the file itself is whole
    }
    written.map_err(|error| {
        let _ = fs::remove_file(&fresh); // what is reported is why it could not be written
        write(error)
    })
}

/// Keeps other changes of the files of a folder away, so that none is lost: what one has read another one
/// does not change before it is written. On a file system without locks nothing does.
fn alone(path: &Path) -> Result<Option<File>, FileError> {
    let place = path.canonicalize().unwrap_or_else(|_| path.into());
    let folder = place.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let Ok(folder) = File::open(folder) else { return Ok(None) };
    match folder.try_lock() {
        Err(TryLockError::WouldBlock) => {
            let text = "something else changes a file of this folder just now: try again";
            let error = io::Error::new(io::ErrorKind::WouldBlock, text);
            Err(FileError::Write { path: path.into(), error })
        }
        Ok(()) | Err(TryLockError::Error(_)) => Ok(Some(folder)),
    }
}

/// Changes a file and nothing of it but what `change` changes: line ends, encoding and a byte order mark
/// stay. One that does not exist begins with `empty`.
fn rewrite(
    path: &Path,
    empty: &str,
    change: impl FnOnce(&str) -> Result<String, FileError>,
) -> Result<(), FileError> {
    let wrong = |error| FileError::Read { path: path.into(), error };
    let _alone = alone(path)?;
    let old = if path.exists() { Some(intake::bytes(path, intake::TABLE).map_err(wrong)?) } else { None };
    let bytes = old.as_deref().unwrap_or(empty.as_bytes());
    if bytes.contains(&0) {
        let error = io::Error::new(io::ErrorKind::InvalidData, "it is not a text in UTF-8 or Latin-1");
        return Err(wrong(error));
    }
    let utf8 = std::str::from_utf8(bytes);
    // One character for each byte, and back.
    let text = utf8.map_or_else(|_| bytes.iter().copied().map(char::from).collect(), str::to_owned);
    let (mark, text) = text.strip_prefix(MARK).map_or(("", text.as_str()), |rest| (MARK, rest));
    let changed = format!("{mark}{}", change(text)?);
    let changed = match utf8 {
        Ok(_) => changed.into_bytes(),
        Err(_) => changed.chars().map(|c| c as u8).collect(),
    };
    if old.as_ref() == Some(&changed) { Ok(()) } else { replace(path, &changed) }
}

/// The byte order mark of UTF-8.
const MARK: &str = "\u{feff}";

/// A number as people write it: at most six decimals, none that say nothing.
fn decimal(value: f64) -> String {
    let text = format!("{value:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(suffix);
    name.into()
}
