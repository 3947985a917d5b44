//! Changes of the user's files that wait for somebody else who changes one of the same folder just now.

use std::path::Path;

use gcode::files::{Changes, FileError};
use process::ipc::time::{Moment, sleep_until};

use crate::error::CliError;

/// How long is waited, s.
const BUSY_S: f64 = 5.0;
/// How long between two tries, s.
const AGAIN_S: f64 = 0.02;

/// Keeps others from changing a file, as soon as they have done with theirs.
pub(crate) fn claim(changes: &mut Changes, path: &Path) -> Result<(), CliError> {
    let end = Moment::in_s(BUSY_S);
    loop {
        match changes.claim(path) {
            Err(error) if error.is_busy() && !end.passed() => sleep_until(Moment::in_s(AGAIN_S)),
            done => return done.map_err(wrong),
        }
    }
}

/// What is wrong with a file, for people.
pub(crate) fn wrong(error: FileError) -> CliError {
    CliError::Input(error.to_string())
}
