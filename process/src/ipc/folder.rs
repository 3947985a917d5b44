//! The folder and the shared memory of a name space: made once, wiped when nobody of it lives.
//!
//! `<temporary files>/pitchlock-<user>/<id>/` holds what iceoryx2 keeps in files and sockets,
//! `/dev/shm/pl<id>_*` what it keeps in shared memory, and `/dev/shm/pitchlock-<id>` says who owns it and
//! where that folder is. Every living process of the name space, owner or not, holds a shared lock on that
//! last file; the operating system drops the lock however the process ends. Who gets it exclusively knows
//! that nobody is left, and wipes: the file itself last, so that a wipe that is interrupted will be repeated.

use std::{
    fs::{self, File},
    hash::{BuildHasher, Hasher},
    io::{ErrorKind, Write},
    os::unix::fs::{DirBuilderExt, MetadataExt, OpenOptionsExt},
    path::{Path, PathBuf},
};

use iceoryx2::prelude::{Config, SemanticString};
use rustix::{
    fs::{FlockOperation, flock},
    process::{getpid, getuid},
};

use super::{
    IpcError,
    computer::{SHARED_MEMORY, take_shared_memory},
};

/// Room that iceoryx2 needs behind the folder's path in the 108 bytes of a socket's address.
const SOCKET_NAME_BYTES: usize = 60;

/// A name space, and the proof that this process lives in it.
#[derive(Debug)]
pub(crate) struct Folder {
    path: PathBuf,
    id: String,
    owner: i32,
    alive: File,
}

impl Folder {
    /// Makes a name space, and wipes those of this user that nobody lives in any more.
    pub(crate) fn create() -> Result<Folder, IpcError> {
        wipe_abandoned()?;
        let base = base()?;
        let mut attempts = 0..10;
        loop {
            match Folder::make(&base) {
                // Somebody who was just wiping took the marker, new and not yet locked, for an abandoned one.
                Err(IpcError::File { path, .. })
                    if path.starts_with(SHARED_MEMORY) && attempts.next().is_some() => {}
                made => return made,
            }
        }
    }

    fn make(base: &Path) -> Result<Folder, IpcError> {
        let mut random = std::hash::RandomState::new().build_hasher();
        random.write_i32(getpid().as_raw_pid());
        let id = format!("{:08x}", random.finish() as u32);
        let path = base.join(&id);
        if path.as_os_str().len() + SOCKET_NAME_BYTES > 108 {
            return Err(IpcError::PathTooLong { path });
        }
        let (marker, owner) = (marker(&id), getpid().as_raw_pid());
        let made = fs::OpenOptions::new().write(true).create_new(true).mode(0o600).open(&marker);
        let mut alive = made.map_err(|error| IpcError::file(&marker, error))?;
        hold(&alive, &marker)?;
        write!(alive, "{owner} {}", path.display()).map_err(|error| IpcError::file(&marker, error))?;
        fs::create_dir(&path).map_err(|error| IpcError::file(&path, error))?;
        Ok(Folder { path, id, owner, alive })
    }

    /// Enters the name space of an owner, by its address.
    pub(crate) fn enter(address: &str) -> Result<Folder, IpcError> {
        let wrong = || IpcError::NoSuchAddress(address.into());
        let id = address.rsplit('/').next().filter(|id| is_id(id)).ok_or_else(wrong)?.to_owned();
        let marker = marker(&id);
        let alive = File::open(&marker).map_err(|_| wrong())?;
        hold(&alive, &marker)?;
        let (owner, path) = read_marker(&marker, &id).ok_or_else(wrong)?;
        if path != Path::new(address) {
            return Err(wrong());
        }
        Ok(Folder { path, id, owner, alive })
    }

    /// What a member needs to enter.
    pub(crate) fn address(&self) -> String {
        self.path.display().to_string()
    }

    /// Process id of the owner.
    pub(crate) fn owner(&self) -> i32 {
        self.owner
    }

    /// Everything in code: a configuration file lying about would be another machine's.
    pub(crate) fn config(&self) -> Result<Config, IpcError> {
        let wrong = |error| IpcError::bus("configuration", format!("{error:?}"));
        let mut config = Config::default();
        let root = SemanticString::new(self.address().as_bytes()).map_err(wrong)?;
        config.global.set_root_path(&root);
        config.global.prefix = SemanticString::new(prefix(&self.id).as_bytes()).map_err(wrong)?;
        config.global.node.cleanup_dead_nodes_on_creation = false;
        config.global.node.cleanup_dead_nodes_on_destruction = false;
        config.global.service.cleanup_dead_nodes_on_open = false;
        Ok(config)
    }

    /// Takes all the shared memory that its channels will ever use.
    pub(crate) fn take_memory(&self) -> Result<(), IpcError> {
        take_shared_memory(&prefix(&self.id))
    }

    /// Wipes this name space if nobody else lives in it. Whoever goes lets go of the shared lock before it
    /// asks for the other one: so of several that go at once one gets it.
    pub(crate) fn wipe_if_last(&self) -> Result<(), IpcError> {
        let path = marker(&self.id);
        flock(&self.alive, FlockOperation::Unlock).map_err(|error| IpcError::file(&path, error))?;
        match flock(&self.alive, FlockOperation::NonBlockingLockExclusive) {
            Ok(()) => self.wipe(),
            Err(_) => Ok(()),
        }
    }

    /// Wipes this name space. The owner does so when its processes have ended.
    pub(crate) fn wipe(&self) -> Result<(), IpcError> {
        wipe(&self.id)
    }
}

fn prefix(id: &str) -> String {
    format!("pl{id}_")
}

fn marker(id: &str) -> PathBuf {
    Path::new(SHARED_MEMORY).join(format!("pitchlock-{id}"))
}

fn is_id(name: &str) -> bool {
    name.len() == 8 && name.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
}

/// Process id of the owner and path of the folder, if this marker was written to its end.
fn read_marker(marker: &Path, id: &str) -> Option<(i32, PathBuf)> {
    let text = fs::read_to_string(marker).ok()?;
    let (owner, path) = text.split_once(' ')?;
    let path = PathBuf::from(path);
    (path.is_absolute() && path.ends_with(base_name().join(id))).then_some((owner.parse().ok()?, path))
}

fn base_name() -> PathBuf {
    format!("pitchlock-{}", getuid().as_raw()).into()
}

/// The folder of all name spaces of this user; nobody else may have made it.
fn base() -> Result<PathBuf, IpcError> {
    let base = std::env::temp_dir().join(base_name());
    match fs::DirBuilder::new().mode(0o700).create(&base) {
        Err(error) if error.kind() != ErrorKind::AlreadyExists => return Err(IpcError::file(&base, error)),
        _ => {}
    }
    let found = fs::symlink_metadata(&base).map_err(|error| IpcError::file(&base, error))?;
    if !found.is_dir() || found.uid() != getuid().as_raw() {
        return Err(IpcError::file(&base, ErrorKind::PermissionDenied));
    }
    Ok(base)
}

/// Takes the shared lock. Somebody who wipes may have been faster; then the marker is locked, or has no name
/// any more.
fn hold(alive: &File, marker: &Path) -> Result<(), IpcError> {
    flock(alive, FlockOperation::NonBlockingLockShared).map_err(|error| IpcError::file(marker, error))?;
    match alive.metadata() {
        Ok(found) if found.nlink() > 0 => Ok(()),
        Ok(_) => Err(IpcError::file(marker, ErrorKind::NotFound)),
        Err(error) => Err(IpcError::file(marker, error)),
    }
}

/// Wipes every name space of this user that nobody lives in.
fn wipe_abandoned() -> Result<(), IpcError> {
    let shared = Path::new(SHARED_MEMORY);
    for entry in fs::read_dir(shared).map_err(|error| IpcError::file(shared, error))?.flatten() {
        let name = entry.file_name();
        let id = name.to_str().and_then(|name| name.strip_prefix("pitchlock-")).filter(|id| is_id(id));
        let (Some(id), Ok(marker)) = (id, File::open(entry.path())) else { continue };
        let mine = marker.metadata().is_ok_and(|found| found.uid() == getuid().as_raw());
        if mine && flock(&marker, FlockOperation::NonBlockingLockExclusive).is_ok() {
            wipe(id)?;
        }
    }
    Ok(())
}

fn wipe(id: &str) -> Result<(), IpcError> {
    let (prefix, marker) = (prefix(id), marker(id));
    for entry in fs::read_dir(SHARED_MEMORY).into_iter().flatten().flatten() {
        if entry.file_name().to_str().is_some_and(|name| name.starts_with(&prefix)) {
            gone(&entry.path(), fs::remove_file(entry.path()))?;
        }
    }
    if let Some((_, path)) = read_marker(&marker, id) {
        gone(&path, fs::remove_dir_all(&path))?;
    }
    gone(&marker, fs::remove_file(&marker))
}

fn gone(path: &Path, removed: std::io::Result<()>) -> Result<(), IpcError> {
    match removed {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(IpcError::file(path, error)),
        _ => Ok(()),
    }
}
