//! A place for what cannot be read twice.

use std::fs::File;
use std::io;

/// A file that is gone when it is closed.
///
/// # Errors
/// The folder of temporary files takes none.
pub(super) fn unnamed_file() -> io::Result<File> {
    let folder = std::env::temp_dir();
    for attempt in 0..1000 {
        let path = folder.join(format!("pitchlock-{}-{attempt}.ngc", std::process::id()));
        match File::options().read(true).write(true).create_new(true).open(&path) {
            Ok(file) => {
                std::fs::remove_file(&path)?;
                return Ok(file);
            }
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
    Err(io::Error::new(io::ErrorKind::AlreadyExists, format!("no free name in {}", folder.display())))
}
