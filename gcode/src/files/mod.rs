//! Files beside the program: tool table, parameters, machine description.

mod machine;
mod parameters;
mod tools;
mod words;

use std::fs::{self, File};
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
    let bytes = fs::read(path).map_err(|error| FileError::Read { path: path.into(), error })?;
    Ok(readable(&bytes))
}

/// Writes a file beside `path` (`NAME.new`) and puts it in its place, so that there is a whole file at any
/// time.
fn replace(path: &Path, text: &str) -> Result<(), FileError> {
    let fresh = with_suffix(path, ".new");
    let written = File::create(&fresh)
        .and_then(|mut file| {
            file.write_all(text.as_bytes())?;
            file.sync_data()
        })
        .and_then(|()| fs::rename(&fresh, path));
    written.map_err(|error| {
        let _ = fs::remove_file(&fresh); // what is reported is why it could not be written
        FileError::Write { path: path.into(), error }
    })
}

fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(suffix);
    name.into()
}
