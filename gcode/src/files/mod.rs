//! Files beside the program: tool table, parameters, machine description.

mod changes;
mod machine;
mod parameters;
mod tools;
mod words;

use std::io;
use std::path::{Path, PathBuf};

pub use changes::Changes;
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

/// Writes a file as a whole, as [`intake::prepare`] does.
fn replace(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let written = intake::prepare(path, bytes).and_then(intake::Prepared::put);
    written.map_err(|error| FileError::Write { path: path.into(), error })
}

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
