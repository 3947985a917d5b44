//! Files that others made, and files that are whole at any time. In: a path, and how many bytes such a file
//! may have. Out: the file, its bytes or its text; or an error that says what it is instead.
//!
//! A name may stand for a pipe that nobody writes to, a device that never ends, a folder. None of them is
//! opened in earnest: whoever opens a named pipe waits for its other end, for ever if nobody comes.
#![forbid(unsafe_code)]

use std::{
    fs::{self, File, OpenOptions},
    hash::{BuildHasher as _, RandomState},
    io::{Error, ErrorKind, Read, Result, Write},
    os::unix::fs::{FileTypeExt, OpenOptionsExt},
    path::{Path, PathBuf},
};

/// Do not wait for the other end of a pipe: `O_NONBLOCK` of Linux, as in its `asm-generic/fcntl.h`. For
/// regular files it means nothing.
const NO_WAITING: i32 = 0o4000;

const MEBI: u64 = 1 << 20;
/// Most bytes of a machine file, a scenario, a description of a part, and what is kept beside a program.
pub const SETTINGS: u64 = MEBI;
/// Most bytes of a tool table and of a file of parameters.
pub const TABLE: u64 = 4 * MEBI;
/// Most bytes of a `summary.json`: some ten thousand passes.
pub const SUMMARY: u64 = 64 * MEBI;
/// Most bytes of a program that is shown in a page.
pub const SHOWN: u64 = 64 * MEBI;

/// What a reader of TOML or JSON found, with kinds of values as their authors call them and not as Rust does.
pub fn in_words(message: &str) -> String {
    let kinds = [("f64", "a number")].into_iter().chain(
        ["u8", "u16", "u32", "u64", "usize", "i8", "i16", "i32", "i64", "isize"]
            .map(|kind| (kind, "a whole number")),
    );
    let mut text = message.to_owned();
    for (kind, words) in kinds {
        // Whole words alone: what is quoted from the file ends otherwise.
        for end in ["\n", " at ", " for key "] {
            text = text.replace(&format!("expected {kind}{end}"), &format!("expected {words}{end}"));
        }
        if let Some(rest) = text.strip_suffix(&format!("expected {kind}")) {
            text = format!("{rest}expected {words}");
        }
    }
    text
}

/// Opens a regular file.
///
/// # Errors
/// It is a folder, a pipe, a socket or a device; or the operating system refuses.
pub fn open(path: &Path) -> Result<File> {
    let file = OpenOptions::new().read(true).custom_flags(NO_WAITING).open(path)?;
    let kind = file.metadata()?.file_type();
    let what = match kind {
        _ if kind.is_file() => return Ok(file),
        _ if kind.is_dir() => return Err(Error::from(ErrorKind::IsADirectory)),
        _ if kind.is_fifo() => "a pipe",
        _ if kind.is_socket() => "a socket",
        _ => "a device",
    };
    Err(Error::new(
        ErrorKind::InvalidInput,
        format!("is {what}, and a file is needed: write it to one first"),
    ))
}

/// The bytes of a regular file.
///
/// # Errors
/// As [`open`]; and if it has more than `most` bytes.
pub fn bytes(path: &Path, most: u64) -> Result<Vec<u8>> {
    all(open(path)?, most)
}

/// All bytes that come.
///
/// # Errors
/// They cannot be read, or are more than `most`.
pub fn all(reader: impl Read, most: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    reader.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let most = if most < MEBI { format!("{} kB", most >> 10) } else { format!("{} MB", most / MEBI) };
        let text = format!("has more than {most}, the most that such a file may have: is it the right one?");
        return Err(Error::new(ErrorKind::FileTooLarge, text));
    }
    Ok(bytes)
}

/// The text of a regular file, in UTF-8.
///
/// # Errors
/// As [`bytes`]; and if it is not text.
pub fn text(path: &Path, most: u64) -> Result<String> {
    String::from_utf8(bytes(path, most)?).map_err(|_| {
        Error::new(ErrorKind::InvalidData, "is not text in UTF-8: save it as such, or is it the right file?")
    })
}

/// A number that nobody can foresee: for a name that nobody else has taken before.
#[must_use]
pub fn unforeseen() -> u64 {
    RandomState::new().hash_one(std::process::id())
}

/// A file for this user alone that has no name and is gone when it is closed: for what cannot be read twice.
///
/// # Errors
/// The folder for temporary files takes none.
pub fn unnamed() -> Result<File> {
    let path = std::env::temp_dir().join(format!("pitchlock-{:016x}", unforeseen()));
    let file = OpenOptions::new().read(true).write(true).create_new(true).mode(0o600).open(&path)?;
    fs::remove_file(&path)?;
    Ok(file)
}

/// The name under which a file is written until it is whole.
fn fresh(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".new");
    name.into()
}

/// Takes room for a file that [`replace`] will write, bytes, so that a disk that fills up meanwhile does not
/// keep it from being written.
///
/// # Errors
/// There is no such room, or the operating system refuses.
pub fn reserve(path: &Path, bytes: usize) -> Result<()> {
    let mut file = create(&fresh(path))?;
    let taken = file.write_all(&vec![0; bytes]).and_then(|()| file.sync_all());
    taken.inspect_err(|_| {
        let _ = fs::remove_file(fresh(path)); // what is reported is why it could not be written
    })
}

/// Gives back the room that [`reserve`] took, if no file came of it.
pub fn release(path: &Path) {
    let _ = fs::remove_file(fresh(path)); // if it is not there it needs no room
}

/// Writes a file under another name, down to the disk, and puts it in its place: at any time there is the
/// whole file or the one before. What stood there is replaced, also where it is a link: where that leads is
/// left alone.
///
/// # Errors
/// It cannot be written.
pub fn replace(path: &Path, bytes: &[u8]) -> Result<()> {
    let fresh = fresh(path);
    let own = || fs::symlink_metadata(&fresh).is_ok_and(|found| found.is_file());
    let write = || {
        let mut file = if own() { OpenOptions::new().write(true).open(&fresh)? } else { create(&fresh)? };
        file.write_all(bytes)?;
        file.set_len(bytes.len() as u64)?;
        file.sync_all()?;
        fs::rename(&fresh, path)
    };
    write().inspect_err(|_| {
        let _ = fs::remove_file(&fresh); // what is reported is why it could not be written
    })?;
    File::open(folder_of(path))?.sync_all()
}

/// The folder that a file stands in. A name is on the disk when its folder is.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// What will be a file under a name of its own, until it is put in its place; dropped, it is gone.
#[derive(Debug)]
pub struct Prepared {
    file: File,
    fresh: PathBuf,
    path: PathBuf,
}

/// Writes what will be the new content of a file of the user's own, down to the disk.
///
/// # Errors
/// As [`begin`]; or it cannot be written.
pub fn prepare(path: &Path, bytes: &[u8]) -> Result<Prepared> {
    let mut prepared = begin(path)?;
    prepared.file.write_all(bytes)?;
    prepared.file.sync_all()?;
    Ok(prepared)
}

/// Begins what will be the new content of a file of the user's own. It keeps its permissions, and its place
/// if `path` is a link. What is written to is new: no link is followed, no pipe waited for, and nobody else's
/// file is touched.
///
/// # Errors
/// It cannot be written.
pub fn begin(path: &Path) -> Result<Prepared> {
    let old = path.canonicalize().ok();
    let path = old.clone().unwrap_or_else(|| path.into());
    let mut name = path.as_os_str().to_owned();
    name.push(format!(".{}.new", std::process::id()));
    let fresh = PathBuf::from(name);
    let file = OpenOptions::new().write(true).create_new(true).open(&fresh)?;
    let prepared = Prepared { file, fresh, path };
    if let Some(old) = &old {
        prepared.file.set_permissions(fs::metadata(old)?.permissions())?;
    }
    Ok(prepared)
}

impl Prepared {
    /// What its content is written to.
    pub fn file(&mut self) -> &mut File {
        &mut self.file
    }

    /// Puts it in its place, down to the disk.
    ///
    /// # Errors
    /// The operating system refuses; the file is as it was.
    pub fn put(self) -> Result<()> {
        self.file.sync_all()?;
        fs::rename(&self.fresh, &self.path)?;
        if let Ok(folder) = File::open(folder_of(&self.path)) {
            let _ = folder.sync_all(); // not every file system can; the file itself is whole
        }
        Ok(())
    }
}

impl Drop for Prepared {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.fresh); // once it is put, nothing of that name is there
    }
}

/// A new file; a link of that name is not followed.
fn create(path: &Path) -> Result<File> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    OpenOptions::new().write(true).create_new(true).open(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_of_values_have_their_names_and_what_is_quoted_stays() {
        let said = "1 | a = \"expected u64\"\ninvalid type: string \"expected u64\", expected u64\n";
        let told =
            "1 | a = \"expected u64\"\ninvalid type: string \"expected u64\", expected a whole number\n";
        assert_eq!(in_words(said), told);
        assert_eq!(in_words("expected f64"), "expected a number");
        assert_eq!(in_words("expected f64 or f32 of u8"), "expected f64 or f32 of u8");
    }

    #[test]
    fn a_file_is_replaced_as_a_whole_and_no_link_is_followed() {
        let folder = std::env::temp_dir().join(format!("intake-{}", std::process::id()));
        fs::create_dir(&folder).expect("a folder");
        let (path, other) = (folder.join("file"), folder.join("other"));
        fs::write(&other, "other").expect("room");
        for name in ["file", "file.new"] {
            std::os::unix::fs::symlink(&other, folder.join(name)).expect("a link");
        }
        reserve(&path, 100_000).expect("room");
        assert_eq!(fs::metadata(folder.join("file.new")).expect("it is taken").len(), 100_000);
        for text in ["long, long", "short"] {
            replace(&path, text.as_bytes()).expect("room");
            assert_eq!(fs::read_to_string(&path).expect("it is there"), text);
        }
        assert_eq!(fs::read_to_string(&other).expect("it is there"), "other");
        assert!(
            fs::symlink_metadata(&path).expect("it is there").is_file() && !folder.join("file.new").exists()
        );
        // Where it cannot be put in its place, nothing is left of it.
        fs::create_dir(folder.join("taken")).expect("a folder");
        assert!(replace(&folder.join("taken"), b"text").is_err() && !folder.join("taken.new").exists());
        fs::remove_dir_all(&folder).expect("it is ours");
    }

    #[test]
    fn what_is_no_file_is_refused_at_once() {
        let refused = |path: &str| open(Path::new(path)).expect_err(path).to_string();
        assert!(refused("/dev/zero").contains("is a device"), "{}", refused("/dev/zero"));
        assert!(refused("/tmp").contains("directory"), "{}", refused("/tmp"));
        assert!(bytes(Path::new("/dev/zero"), SETTINGS).is_err());
    }

    #[test]
    fn a_file_of_the_longest_length_is_read_and_a_longer_one_is_not() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
        let length = std::fs::metadata(&path).expect("it is here").len();
        assert_eq!(text(&path, length).expect("it fits").len() as u64, length);
        let refused = bytes(&path, length - 1).expect_err("it is longer").to_string();
        assert!(refused.contains("the most that such a file may have"), "{refused}");
    }
}
