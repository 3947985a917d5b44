//! `summary.json`: read, and written whole.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::summary::{Summary, VERSION};

/// A warning of the check of a program.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProgramWarning {
    /// The program, or the file of a subroutine.
    pub file: String,
    /// Line in it.
    pub line: u32,
    /// Its stable name.
    pub code: String,
    /// What it says.
    pub text: String,
    /// What to do about it.
    pub help: String,
}

/// Why a summary could not be read or written.
#[derive(Debug, thiserror::Error)]
#[error("{path}: {reason}")]
pub struct SummaryError {
    path: String,
    reason: String,
}

impl SummaryError {
    fn new(path: &Path, reason: impl std::fmt::Display) -> SummaryError {
        SummaryError { path: path.display().to_string(), reason: reason.to_string() }
    }
}

impl Summary {
    /// Reads `summary.json`.
    ///
    /// # Errors
    /// Names the file and what is wrong with it.
    pub fn read(path: &Path) -> Result<Summary, SummaryError> {
        let text = intake::text(path, intake::SUMMARY).map_err(|error| SummaryError::new(path, error))?;
        let summary: Summary = serde_json::from_str(&text).map_err(|error| SummaryError::new(path, error))?;
        if summary.version != VERSION {
            let reason =
                format!("the summary is of version {}, and this program reads {VERSION}", summary.version);
            return Err(SummaryError::new(path, reason));
        }
        Ok(summary)
    }

    /// Writes `summary.json`, indented, with a newline at the end. The file is whole at any time.
    ///
    /// # Errors
    /// Names the file and why it could not be written.
    pub fn write(&self, path: &Path) -> Result<(), SummaryError> {
        let mut text = serde_json::to_string_pretty(self).map_err(|error| SummaryError::new(path, error))?;
        text.push('\n');
        intake::replace(path, text.as_bytes()).map_err(|error| SummaryError::new(path, error))
    }
}
