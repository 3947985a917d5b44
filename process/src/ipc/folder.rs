//! The folder and the shared memory of a name space: made once, wiped when nobody of it lives.
//!
//! `<temporary files>/pitchlock-<user>/<id>/` holds what iceoryx2 keeps in files and sockets,
//! `/dev/shm/pl<id>_*` what it keeps in shared memory, and `/dev/shm/pitchlock-<id>` says who owns it and
//! where that folder is. Every living process of the name space, owner or not, holds a shared lock on that
//! last file; the operating system drops the lock however the process ends. Who gets it exclusively knows
//! that nobody is left, and wipes: the file itself last, so that a wipe that is interrupted will be repeated.
//!
//! Both places belong to everybody. Whatever has such a name and was not made by this user for himself alone
//! (a pipe, a link, a folder, a file of another user) is neither opened in earnest nor removed, and hinders
//! nobody.

use std::{
    fs::{self, File},
    io::{ErrorKind, Read, Write},
    os::unix::fs::{DirBuilderExt, MetadataExt, OpenOptionsExt, PermissionsExt},
    path::{Path, PathBuf},
};

use iceoryx2::prelude::{Config, SemanticString};
use rustix::{
    fs::{FlockOperation, OFlags, flock},
    process::{getpid, getuid},
};

use super::{
    IpcError,
    computer::{SHARED_MEMORY, open_own, take_shared_memory},
};

/// Most bytes of a marker.
const MARKER: u64 = 4096;
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
        let id = random();
        let path = base.join(&id);
        if path.as_os_str().len() + SOCKET_NAME_BYTES > 108 {
            return Err(IpcError::PathTooLong { path });
        }
        let (marker, owner) = (marker(&id), getpid().as_raw_pid());
        let made = fs::OpenOptions::new().write(true).create_new(true).mode(0o600).open(&marker);
        let mut alive = made.map_err(|error| IpcError::file(&marker, error))?;
        hold(&alive, &marker)?;
        write!(alive, "{owner} {}", path.display()).map_err(|error| IpcError::file(&marker, error))?;
        fs::DirBuilder::new().mode(0o700).create(&path).map_err(|error| IpcError::file(&path, error))?;
        Ok(Folder { path, id, owner, alive })
    }

    /// Enters the name space of an owner, by its address.
    pub(crate) fn enter(address: &str) -> Result<Folder, IpcError> {
        let wrong = || IpcError::NoSuchAddress(address.into());
        let id = address.rsplit('/').next().filter(|id| is_id(id)).ok_or_else(wrong)?.to_owned();
        let marker = marker(&id);
        let mut alive = open_marker(&marker).ok_or_else(wrong)?;
        hold(&alive, &marker)?;
        let (owner, path) = read_marker(&mut alive, &id).ok_or_else(wrong)?;
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

    /// How every name of its shared memory begins.
    pub(crate) fn prefix(&self) -> String {
        prefix(&self.id)
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
            Err(_) => Ok(()), // somebody else lives in it
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

/// Opens a marker, if it is a file that this user has made for himself alone. Nothing is waited for.
fn open_marker(marker: &Path) -> Option<File> {
    open_own(marker, OFlags::RDONLY)
        .filter(|file| file.metadata().is_ok_and(|found| found.mode() & 0o077 == 0))
}

/// Process id of the owner and path of the folder, if this marker was written to its end.
fn read_marker(marker: &mut File, id: &str) -> Option<(i32, PathBuf)> {
    let mut text = String::new();
    marker.take(MARKER).read_to_string(&mut text).ok()?;
    let (owner, path) = text.split_once(' ')?;
    let path = PathBuf::from(path);
    let base = path.parent()?.file_name()?.to_str()?;
    let named = base
        .strip_prefix(&base_name())
        .is_some_and(|rest| rest.is_empty() || rest.strip_prefix('.').is_some_and(is_id));
    (path.is_absolute() && path.ends_with(id) && named).then_some((owner.parse().ok()?, path))
}

fn base_name() -> String {
    format!("pitchlock-{}", getuid().as_raw())
}

/// The folder of all name spaces of this user. Where somebody else has taken its name, one that nobody can
/// have foreseen.
fn base() -> Result<PathBuf, IpcError> {
    let folder = temporary()?;
    let base = folder.join(base_name());
    match own_folder(&base) {
        Err(error) if error.kind() == ErrorKind::PermissionDenied && folder.is_dir() => {
            let base = folder.join(format!("{}.{}", base_name(), random()));
            own_folder(&base).map_err(|error| IpcError::file(&base, error))?;
            Ok(base)
        }
        made => made.map(|()| base.clone()).map_err(|error| IpcError::file(&base, error)),
    }
}

/// The folder for temporary files by its whole name: processes of a machine know their name space by it.
fn temporary() -> Result<PathBuf, IpcError> {
    let folder = std::env::temp_dir();
    let whole = if folder.as_os_str().is_empty() { PathBuf::from("/tmp") } else { folder };
    let whole = std::path::absolute(&whole).map_err(|error| IpcError::file(&whole, error))?;
    // The names of its channels take no other letters.
    let is_plain = whole.to_str().is_some_and(|text| text.is_ascii());
    if is_plain { Ok(whole) } else { Err(IpcError::PathNotAscii { path: whole }) }
}

/// Makes a folder that nobody else can look into, unless it is there.
fn own_folder(base: &Path) -> std::io::Result<()> {
    match fs::DirBuilder::new().mode(0o700).create(base) {
        Err(error) if error.kind() != ErrorKind::AlreadyExists => return Err(error),
        _ => {}
    }
    let found = fs::symlink_metadata(base)?;
    if !found.is_dir() || found.uid() != getuid().as_raw() {
        return Err(ErrorKind::PermissionDenied.into());
    }
    if found.mode() & 0o077 != 0 {
        fs::set_permissions(base, fs::Permissions::from_mode(0o700))?;
    }
    Ok(())
}

/// Eight digits that nobody can foresee.
fn random() -> String {
    format!("{:08x}", intake::unforeseen() as u32)
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

/// Wipes every name space of this user that nobody lives in. What cannot be wiped is left, and said: it
/// hinders nobody.
fn wipe_abandoned() -> Result<(), IpcError> {
    let shared = Path::new(SHARED_MEMORY);
    for entry in fs::read_dir(shared).map_err(|error| IpcError::file(shared, error))?.flatten() {
        let name = entry.file_name();
        let id = name.to_str().and_then(|name| name.strip_prefix("pitchlock-")).filter(|id| is_id(id));
        let (Some(id), Some(marker)) = (id, open_marker(&entry.path())) else { continue };
        if flock(&marker, FlockOperation::NonBlockingLockExclusive).is_ok()
            && let Err(error) = wipe(id)
        {
            tracing::warn!(%error, "what a run has left is still there");
        }
    }
    Ok(())
}

/// What another user has put beside it under the same prefix stays.
fn wipe(id: &str) -> Result<(), IpcError> {
    let (prefix, marker) = (prefix(id), marker(id));
    let own = |path: &Path| fs::symlink_metadata(path).is_ok_and(|found| found.uid() == getuid().as_raw());
    for entry in fs::read_dir(SHARED_MEMORY).into_iter().flatten().flatten() {
        if entry.file_name().to_str().is_some_and(|name| name.starts_with(&prefix)) && own(&entry.path()) {
            gone(&entry.path(), fs::remove_file(entry.path()))?;
        }
    }
    let Some(mut file) = open_marker(&marker) else { return Ok(()) };
    if let Some((_, path)) = read_marker(&mut file, id)
        && let Some(base) = path.parent()
        && fs::symlink_metadata(base).is_ok_and(|found| found.is_dir())
        && own(base)
    {
        gone(&path, fs::remove_dir_all(&path))?;
        if base.file_name() != Some(base_name().as_ref()) {
            // A name of its own for one run; not empty if there is another one.
            let _ = fs::remove_dir(base);
        }
    }
    gone(&marker, fs::remove_file(&marker))
}

fn gone(path: &Path, removed: std::io::Result<()>) -> Result<(), IpcError> {
    match removed {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(IpcError::file(path, error)),
        _ => Ok(()),
    }
}
