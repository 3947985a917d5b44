//! Folders for temporary files that belong to a process of this program: each goes with its process, and
//! what a process has left that was killed goes with the next one. A lock on a file in it says that its owner
//! lives.

use std::{
    fs::{self, DirBuilder, File},
    os::unix::fs::{DirBuilderExt as _, MetadataExt as _},
    path::{Path, PathBuf},
};

use crate::error::CliError;

/// What they are called before what they are for.
const NAME: &str = "pitchlock-";
/// The file in them that is held.
const LIVES: &str = ".lives";

/// A folder that only this user can look into.
pub(crate) struct Temporary {
    path: PathBuf,
    _lives: File,
}

impl Temporary {
    /// A new one; what was left of others that were for the same is removed.
    pub(crate) fn new(what: &str) -> Result<Temporary, CliError> {
        Temporary::within(&std::env::temp_dir(), what)
    }

    fn within(temporary: &Path, what: &str) -> Result<Temporary, CliError> {
        let prefix = format!("{NAME}{what}-");
        // A name that nobody can foresee, and take.
        let path = temporary.join(format!("{prefix}{:016x}", intake::unforeseen()));
        let failed = |error: std::io::Error| {
            CliError::Machine(format!("{}: {error}\nhelp: TMPDIR names another folder", path.display()))
        };
        DirBuilder::new().mode(0o700).create(&path).map_err(failed)?;
        // It is held before it has its name: one that has it and is not held was left.
        let unnamed = path.join("new");
        let lives = File::create_new(&unnamed).map_err(failed)?;
        lives.lock().map_err(failed)?;
        fs::rename(&unnamed, path.join(LIVES)).map_err(failed)?;
        sweep(temporary, &prefix, fs::symlink_metadata(&path).map_err(failed)?.uid());
        Ok(Temporary { path, _lives: lives })
    }

    /// Where it is.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.path);
    }
}

/// Removes what nobody holds any more. What is another user's, a link, or held stays.
fn sweep(temporary: &Path, prefix: &str, own: u32) {
    for entry in fs::read_dir(temporary).into_iter().flatten().flatten() {
        let folder = entry.path();
        let named = entry.file_name().to_str().is_some_and(|name| name.starts_with(prefix));
        let Ok(found) = fs::symlink_metadata(&folder) else { continue };
        let ours = named && found.is_dir() && found.uid() == own;
        if ours && File::open(folder.join(LIVES)).is_ok_and(|file| file.try_lock().is_ok()) {
            // What cannot be removed is left.
            let _ = fs::remove_dir_all(&folder);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a process has left that was killed goes with the next one; what is held, for something else, or
    /// not of this kind stays.
    #[test]
    fn what_was_left_goes_and_what_is_held_stays() {
        let place = tempfile::tempdir().expect("a folder");
        let make = |what: &str| Temporary::within(place.path(), what).expect("made");
        let held = make("one");
        let left = |what: &str| {
            let path = place.path().join(format!("pitchlock-{what}-0123456789abcdef"));
            fs::create_dir(&path).expect("made");
            fs::write(path.join("file"), "left").expect("written");
            path
        };
        let (without, other, killed) = (left("one"), left("two"), left("one-more"));
        fs::write(other.join(LIVES), "").expect("written");
        fs::write(killed.join(LIVES), "").expect("written");
        let link = place.path().join("pitchlock-one-link");
        std::os::unix::fs::symlink(&other, &link).expect("a link");
        let new = make("one");
        assert!(held.path().exists() && new.path().exists() && other.exists() && link.exists());
        assert!(without.exists(), "nobody knows whose it is");
        assert!(!killed.exists(), "it was left");
        let gone = [held.path().to_owned(), new.path().to_owned()];
        drop((held, new));
        assert!(gone.iter().all(|path| !path.exists()), "each goes with its owner");
    }
}
