//! The file of a journal. In: what is to be kept. Out: records on a medium, numbered, confirmed when the
//! medium says that it has them.

use std::{
    fs::OpenOptions,
    io::{Result, Write as _},
    path::{Path, PathBuf},
};

use super::sheet::{Kept, sheet};

/// Most bytes of a journal: then a new file with the last record takes its place.
pub const MOST: u64 = 1 << 20;

/// What a journal is written on.
pub trait Medium {
    /// Appends bytes. They may be lost, all or any of them, until [`Medium::sync`] has returned.
    ///
    /// # Errors
    /// They cannot be written.
    fn append(&mut self, bytes: &[u8]) -> Result<()>;

    /// Waits until all that was appended is there for good.
    ///
    /// # Errors
    /// It is not.
    fn sync(&mut self) -> Result<()>;

    /// Puts these bytes in the place of all there are. Once it returns they are there for good; before, there
    /// is the old or the new whole.
    ///
    /// # Errors
    /// The old is still there.
    fn replace(&mut self, bytes: &[u8]) -> Result<()>;
}

/// A journal that is being written.
#[derive(Debug)]
pub struct Book<M> {
    medium: M,
    /// Number of the last record, from 1; of the last that is confirmed.
    number: u64,
    confirmed: u64,
    length: u64,
}

impl<M: Medium> Book<M> {
    /// An empty journal on an empty medium.
    pub fn new(medium: M) -> Book<M> {
        Book { medium, number: 0, confirmed: 0, length: 0 }
    }

    /// Writes a record; its number. It is not confirmed yet, unless the journal was begun anew for it:
    /// because it is long, or because the medium has no more room and gets that of the records before.
    ///
    /// # Errors
    /// The medium does not take it; what was written before is as it was.
    pub fn write<T: Kept>(&mut self, kept: &T) -> Result<u64> {
        let (number, bytes) = (self.number + 1, sheet(self.number + 1, kept));
        let more = bytes.len() as u64;
        if self.length + more <= MOST && self.medium.append(&bytes).is_ok() {
            self.length += more;
        } else {
            self.medium.replace(&bytes)?;
            (self.length, self.confirmed) = (more, number);
        }
        self.number = number;
        Ok(number)
    }

    /// Confirms all that was written; the number of the last record.
    ///
    /// # Errors
    /// The medium does not have it.
    pub fn sync(&mut self) -> Result<u64> {
        if self.confirmed < self.number {
            self.medium.sync()?;
            self.confirmed = self.number;
        }
        Ok(self.confirmed)
    }

    /// Number of the last record that is confirmed, 0 for none.
    pub fn confirmed(&self) -> u64 {
        self.confirmed
    }

    /// What it is written on.
    pub fn medium(&self) -> &M {
        &self.medium
    }
}

/// A file as a medium.
#[derive(Debug)]
pub struct File {
    path: PathBuf,
    file: std::fs::File,
    length: u64,
    /// Whether its name is on the disk: it is when its folder is.
    named: bool,
}

impl File {
    /// A new file; nothing of that name may be there.
    ///
    /// # Errors
    /// There is, or it cannot be made.
    pub fn create(path: &Path) -> Result<File> {
        let file = OpenOptions::new().append(true).create_new(true).open(path)?;
        Ok(File { path: path.into(), file, length: 0, named: false })
    }
}

impl Medium for File {
    fn append(&mut self, bytes: &[u8]) -> Result<()> {
        self.file.write_all(bytes).inspect_err(|_| {
            // A part of a record would push those behind it out of their places.
            let _ = self.file.set_len(self.length);
        })?;
        self.length += bytes.len() as u64;
        Ok(())
    }

    fn sync(&mut self) -> Result<()> {
        self.file.sync_data()?;
        if !self.named {
            std::fs::File::open(intake::folder_of(&self.path))?.sync_all()?;
            self.named = true;
        }
        Ok(())
    }

    fn replace(&mut self, bytes: &[u8]) -> Result<()> {
        intake::replace(&self.path, bytes)?;
        self.file = OpenOptions::new().append(true).open(&self.path)?;
        (self.length, self.named) = (bytes.len() as u64, true);
        Ok(())
    }
}
