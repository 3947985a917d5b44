//! What the computer has to give to the processes of a machine: room in shared memory and on a disk, files
//! that may be open at once. In: the axes of the machine, folders. Out: what is missing, in bytes and files,
//! before a process starts.

use std::{
    fs,
    os::unix::fs::{MetadataExt, PermissionsExt},
    path::Path,
};

use protocol::Axis;
use rustix::{
    fs::{FallocateFlags, Mode, OFlags, fallocate, statvfs},
    process::{Resource, Rlimit, getrlimit, getuid, setrlimit},
};

use super::{IpcError, channel};

/// Where shared memory lies.
pub(crate) const SHARED_MEMORY: &str = "/dev/shm";

/// Files that a process of a machine has open at most: counted with two, three and four axes, and some room.
/// The most has the interpolator.
const FILES: u64 = 120;
/// The same for each axis.
const FILES_OF_AXIS: u64 = 24;

/// Whether a folder, or a link to one, is this user's, and not one in which everybody may change what is
/// there.
pub fn is_own(found: &fs::Metadata) -> bool {
    found.uid() == getuid().as_raw() && (found.is_symlink() || found.mode() & 0o002 == 0)
}

/// Files that a process of a machine with these axes has open at once, at most.
pub fn files(axes: &[Axis]) -> u64 {
    FILES + FILES_OF_AXIS * axes.len() as u64
}

/// Allows this process, and those that it starts, to open so many files at once.
///
/// # Errors
/// [`IpcError::TooFewFiles`] if this user may not.
pub fn allow_files(needed: u64) -> Result<(), IpcError> {
    let limit = getrlimit(Resource::Nofile);
    if limit.current.is_none_or(|allowed| allowed >= needed) {
        return Ok(());
    }
    let refused = || IpcError::TooFewFiles { allowed: limit.maximum.or(limit.current).unwrap_or(0), needed };
    if limit.maximum.is_some_and(|most| most < needed) {
        return Err(refused());
    }
    setrlimit(Resource::Nofile, Rlimit { current: Some(needed), ..limit }).map_err(|_| refused())
}

/// Room that is left for this user where a folder lies, bytes; `None` if nobody knows.
pub fn free_bytes(folder: &Path) -> Option<u64> {
    let found = statvfs(folder).ok()?;
    Some(found.f_bavail.saturating_mul(found.f_frsize))
}

/// Refuses shared memory that is too small for a machine with these axes: memory that is not there is missed
/// when it is written to, and kills whoever writes.
pub(crate) fn check_shared_memory(axes: &[Axis]) -> Result<(), IpcError> {
    enough(free_bytes(Path::new(SHARED_MEMORY)), channel::shared_bytes(axes))
}

/// Whether so much shared memory is enough.
fn enough(free: Option<u64>, needed: u64) -> Result<(), IpcError> {
    match free {
        Some(free) if free < needed => Err(IpcError::NoRoom { free, needed }),
        _ => Ok(()),
    }
}

/// Opens a file that this user has made, under one name alone. Nothing is waited for, no link is followed.
pub(crate) fn open_own(path: &Path, how: OFlags) -> Option<fs::File> {
    let how = how | OFlags::NOFOLLOW | OFlags::NONBLOCK | OFlags::CLOEXEC;
    let file = fs::File::from(rustix::fs::open(path, how, Mode::empty()).ok()?);
    let found = file.metadata().ok()?;
    (found.is_file() && found.uid() == getuid().as_raw() && found.nlink() == 1).then_some(file)
}

/// Takes all the shared memory that files with this beginning will ever use, so that whoever fills the rest
/// later kills nobody; a system that cannot do that is left alone. And closes them to other users: iceoryx2
/// leaves one of them open to everybody.
pub(crate) fn take_shared_memory(prefix: &str) -> Result<(), IpcError> {
    for entry in fs::read_dir(SHARED_MEMORY).into_iter().flatten().flatten() {
        if !entry.file_name().to_str().is_some_and(|name| name.starts_with(prefix)) {
            continue;
        }
        let Some(file) = open_own(&entry.path(), OFlags::RDWR) else { continue };
        // A file that somebody else has put there cannot be closed, and is nobody's.
        let _ = file.set_permissions(fs::Permissions::from_mode(0o600));
        let bytes = file.metadata().map_or(0, |found| found.len());
        if bytes > 0 && fallocate(&file, FallocateFlags::KEEP_SIZE, 0, bytes) == Err(rustix::io::Errno::NOSPC)
        {
            let free = free_bytes(Path::new(SHARED_MEMORY)).unwrap_or(0);
            return Err(IpcError::NoRoom { free, needed: bytes });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_little_shared_memory_is_said_before_it_is_written_to() {
        let needed = channel::shared_bytes(&[Axis::X, Axis::Z]);
        assert!((1_000_000..16_000_000).contains(&needed), "{needed}");
        assert!(enough(Some(needed), needed).is_ok() && enough(None, needed).is_ok());
        let refused = enough(Some(700_000), needed).expect_err("a machine dies there");
        assert!(refused.to_string().contains("683 kB free"), "{refused}");
    }

    #[test]
    fn more_files_than_anybody_may_open_are_refused() {
        assert!(allow_files(16).is_ok(), "a test has them");
        let refused = allow_files(1 << 40).expect_err("no system allows so many").to_string();
        assert!(refused.contains("ulimit -n"), "{refused}");
    }
}
