//! Changes of the user's own files: all of them or none, and nothing but what is changed. In: paths, and what
//! to change. Out: files that are whole at any time.

use std::fs::{File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use super::{FileError, ParameterFile, ToolTable};

/// The byte order mark of UTF-8.
const MARK: &str = "\u{feff}";

/// Files that are changed together. Nothing of them is in its place before [`Changes::put`].
#[derive(Debug, Default)]
pub struct Changes {
    /// Folders in which nobody else changes a file until this is over; without a lock on a file system that
    /// has none.
    folders: Vec<(PathBuf, Option<File>)>,
    prepared: Vec<(PathBuf, intake::Prepared)>,
}

impl Changes {
    /// Some parameters of a file; all else of it stays: order, comments, blanks. One that the file does not
    /// have is inserted at its place, unless it is 0. A file that does not exist begins as `fresh`.
    ///
    /// # Errors
    /// The file cannot be read or written, or has a line that is no parameter, or a number out of range or
    /// out of order; or something else changes a file of its folder just now ([`FileError::is_busy`]).
    pub fn parameters(
        &mut self,
        path: &Path,
        values: &[(u32, f64)],
        fresh: &ParameterFile,
    ) -> Result<(), FileError> {
        self.rewrite(path, &fresh.to_text(), |text| ParameterFile::changed(path, text, values))
    }

    /// Some words of tools of a table: number of the tool, letter, value; all else of it stays. A tool that
    /// the table does not have comes at its end. A table that does not exist is made.
    ///
    /// # Errors
    /// The table cannot be read or written, or a line of it is not a tool; or something else changes a file
    /// of its folder just now ([`FileError::is_busy`]).
    pub fn tools(&mut self, path: &Path, words: &[(i32, char, f64)]) -> Result<(), FileError> {
        self.rewrite(path, "", |text| ToolTable::changed(path, text, words))
    }

    /// Puts all of them in their places.
    ///
    /// # Errors
    /// The operating system refuses; those behind the one that is named are as they were.
    pub fn put(self) -> Result<(), FileError> {
        self.prepared
            .into_iter()
            .try_for_each(|(path, file)| file.put().map_err(|error| FileError::Write { path, error }))
    }

    /// Changes a file and nothing of it but what `change` changes: line ends, encoding and a byte order mark
    /// stay. One that does not exist begins with `empty`.
    fn rewrite(
        &mut self,
        path: &Path,
        empty: &str,
        change: impl FnOnce(&str) -> Result<String, FileError>,
    ) -> Result<(), FileError> {
        let wrong = |error| FileError::Read { path: path.into(), error };
        self.claim(path)?;
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
        if old.as_ref() != Some(&changed) {
            let prepared = intake::prepare(path, &changed);
            let prepared = prepared.map_err(|error| FileError::Write { path: path.into(), error })?;
            self.prepared.push((path.into(), prepared));
        }
        Ok(())
    }

    /// Keeps other changes of the files of a folder away, so that none is lost: what is read from here on
    /// nobody else changes before it is written.
    ///
    /// # Errors
    /// Something else changes a file of the folder just now ([`FileError::is_busy`]).
    pub fn claim(&mut self, path: &Path) -> Result<(), FileError> {
        let place = path.canonicalize().unwrap_or_else(|_| path.into());
        let folder = intake::folder_of(&place);
        let folder = folder.canonicalize().unwrap_or_else(|_| folder.into());
        if self.folders.iter().any(|(other, _)| *other == folder) {
            return Ok(());
        }
        let lock = File::open(&folder).ok();
        if let Some(Err(TryLockError::WouldBlock)) = lock.as_ref().map(File::try_lock) {
            let text = "something else changes a file of this folder just now: try again";
            let error = io::Error::new(io::ErrorKind::WouldBlock, text);
            return Err(FileError::Write { path: path.into(), error });
        }
        self.folders.push((folder, lock));
        Ok(())
    }
}

impl FileError {
    /// Whether the same may succeed in a moment.
    pub fn is_busy(&self) -> bool {
        matches!(self, FileError::Write { error, .. } if error.kind() == io::ErrorKind::WouldBlock)
    }
}
