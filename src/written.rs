//! Files that commands write where they are told to. Whoever is told the wrong name loses nothing: a file
//! is replaced only if an earlier run of the same command made it, as its first bytes say, and as a
//! whole: it is written under another name and renamed. A pipe, which may have no reader, is refused;
//! what the system has in `/dev` (`/dev/null`, `/dev/stdout`) is written to, once all of it is there.

use std::{
    fs::File,
    io::{self, ErrorKind, Read, Seek as _, Write as _},
    os::unix::fs::{FileTypeExt as _, MetadataExt as _},
    path::Path,
};

use crate::error::CliError;

/// How many bytes are looked at.
const HEAD: u64 = 4096;

/// What a command writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Made {
    /// A page of `report`, `experiment`, `tune` or `resolution`.
    Page,
    /// The rows of an experiment.
    Rows,
    /// Machine code.
    Code,
    /// Straight lines of `compile --g1`.
    Lines,
    /// The calls of `canon`.
    Calls,
}

impl Made {
    /// Whether a file that begins so is one of these. An empty one is nobody's loss.
    fn is(self, head: &[u8]) -> bool {
        let text = String::from_utf8_lossy(head);
        let text = text.trim_start();
        match self {
            _ if head.is_empty() => true,
            Made::Page => text.contains("<title>pitchlock: "),
            Made::Rows => text.starts_with("{\n  \"experiment\": "),
            Made::Code => head.starts_with(&protocol::code_file::MAGIC),
            Made::Lines => text.starts_with("; straight lines of ") && text.contains("made by pitchlock"),
            Made::Calls => text.lines().take(3).all(is_call),
        }
    }

    /// What it is called.
    fn name(self) -> &'static str {
        match self {
            Made::Page => "a page",
            Made::Rows => "rows of an experiment",
            Made::Code => "machine code",
            Made::Lines => "lines of compile --g1",
            Made::Calls => "calls of canon",
        }
    }
}

/// Whether a line is a canonical function, as in `SET_FEED_RATE(100.0000)` or
/// `    5 N.....  SET_FEED_RATE(100.0000)`.
fn is_call(line: &str) -> bool {
    let Some((before, _)) = line.split_once('(') else { return false };
    let name = before.rsplit(' ').next().unwrap_or_default();
    let is_name = name.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_');
    // `O100(SHAFT)` is a program.
    name.len() > 3 && is_name && (name.contains('_') || !name.contains(|c: char| c.is_ascii_digit()))
}

/// Whether a path may be written to.
///
/// # Errors
/// There is a file that the command has not made.
pub(crate) fn free(path: &Path, made: Made) -> Result<(), CliError> {
    no_pipe(path)?;
    let Ok(mut file) = intake::open(path) else { return Ok(()) };
    let mut head = Vec::new();
    let read = Read::by_ref(&mut file).take(HEAD).read_to_end(&mut head);
    if read.is_ok() && made.is(&head) {
        return Ok(());
    }
    let text = format!("is there already and is not {}: name another file, or remove this one", made.name());
    Err(CliError::file(path, text))
}

/// Whether a path may be written to that is new or, like the last, named by the user as what is changed.
///
/// # Errors
/// There is another file.
pub(crate) fn new_or(path: &Path, changed: Option<&Path>) -> Result<(), CliError> {
    no_pipe(path)?;
    let is_file = path.metadata().is_ok_and(|found| found.is_file());
    let same = changed.is_some_and(
        |changed| matches!((path.canonicalize(), changed.canonicalize()), (Ok(a), Ok(b)) if a == b),
    );
    if is_file && !same {
        return Err(CliError::file(path, "is there already: name another file, or remove this one"));
    }
    Ok(())
}

/// Whether a folder is empty, or can be made.
///
/// # Errors
/// There is something in it, or it is a file.
pub(crate) fn empty(path: &Path) -> Result<(), CliError> {
    let entries = match path.read_dir() {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        entries => entries.map_err(|error| CliError::file(path, error))?,
    };
    let mut entries = entries.flatten();
    if entries.next().is_none() {
        return Ok(());
    }
    let what = if path.join("summary.json").is_file() { "a run is" } else { "other files are" };
    let text = format!("{what} in this folder already: name a new one with --out, or remove it");
    Err(CliError::file(path, text))
}

/// Writes a file, if it may be.
///
/// # Errors
/// It may not be, or cannot.
pub(crate) fn write(path: &Path, made: Made, content: impl AsRef<[u8]>) -> Result<(), CliError> {
    free(path, made)?;
    put(path, content)
}

/// Writes what may be written: a file as a whole.
///
/// # Errors
/// It cannot be written; what was there is as it was.
pub(crate) fn put(path: &Path, content: impl AsRef<[u8]>) -> Result<(), CliError> {
    let all = |file: &mut File| file.write_all(content.as_ref());
    by_parts(path, |file| all(file).map_err(|error| CliError::file(path, error)))
}

/// The same, part by part.
///
/// # Errors
/// As [`put`], and those of `write`.
pub(crate) fn by_parts<T>(
    path: &Path,
    write: impl FnOnce(&mut File) -> Result<T, CliError>,
) -> Result<T, CliError> {
    let failed = |error| CliError::file(path, error);
    let of_system = path.starts_with("/dev") || path.metadata().is_ok_and(|found| !found.is_file());
    if of_system {
        // Nothing of what is broken off can be taken for all of it.
        let mut whole = intake::unnamed().map_err(failed)?;
        let written = write(&mut whole)?;
        whole.rewind().and_then(|()| hand_over(&mut whole, path)).map_err(failed)?;
        return Ok(written);
    }
    let mut prepared = intake::begin(path).map_err(failed)?;
    let written = write(prepared.file())?;
    prepared.put().map_err(failed)?;
    Ok(written)
}

/// Copies what is whole to what the system has. Standard output goes on where it is: opened anew, a file that
/// it was led into would be written from its beginning.
fn hand_over(whole: &mut File, path: &Path) -> io::Result<()> {
    if is_standard_output(path) {
        let mut out = io::stdout().lock();
        io::copy(whole, &mut out)?;
        return out.flush();
    }
    io::copy(whole, &mut File::create(path)?).map(|_| ())
}

/// Whether a path is another name of where this process prints.
pub(crate) fn is_standard_output(path: &Path) -> bool {
    let place = |path: &Path| path.metadata().ok().map(|found| (found.dev(), found.ino()));
    place(path).is_some_and(|there| place(Path::new("/dev/stdout")) == Some(there))
}

/// Refuses what would be waited for until somebody reads it.
fn no_pipe(path: &Path) -> Result<(), CliError> {
    let waits = |kind: std::fs::FileType| kind.is_fifo() || kind.is_socket();
    match path.metadata() {
        Ok(found) if waits(found.file_type()) && !path.starts_with("/dev") => {
            Err(CliError::file(path, "is a pipe, which may have no reader: name a file, or /dev/stdout"))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::{Made, is_call};

    #[test]
    fn what_a_command_made_is_known_by_its_head() {
        let made = [
            (Made::Page, "<!DOCTYPE html><html><head><title>pitchlock: feed</title>"),
            (Made::Rows, "{\n  \"experiment\": \"feed\","),
            (Made::Code, "PLMC\u{7}\u{0}"),
            (Made::Lines, "; straight lines of wave.toml, made by pitchlock compile --g1\n"),
            (Made::Calls, "USE_LENGTH_UNITS(CANON_UNITS_MM)\nCOMMENT(\"a\")\n"),
        ];
        for (kind, head) in made {
            let is = |other: &&(Made, &str)| kind.is(other.1.as_bytes());
            assert_eq!(made.iter().filter(is).count(), 1, "{kind:?}");
            assert!(kind.is(head.as_bytes()) && kind.is(b""), "{kind:?}");
            assert!(!kind.is(b"G21 (COMMENT)\nG0 X1\nM2\n"), "{kind:?}");
        }
        assert!(is_call("    5 N..... SET_G92_OFFSET(0.0000)") && !is_call("O100 (SHAFT)"));
    }
}
