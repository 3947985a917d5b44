//! Files that are there as a whole or not at all.

use std::fs::Permissions;
use std::io::Write as _;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;

use crate::CampaignError;

/// What a file is called until it is whole.
pub(crate) const NEW: &str = ".new-";

/// What will be a file as a whole: whoever reads that finds all of it or nothing. What it is until then has a
/// name that no other process has, on whatever computer: process numbers alone are the same in many
/// containers.
pub(crate) fn whole(place: &Path, content: &[u8]) -> std::io::Result<tempfile::NamedTempFile> {
    let parent = place.parent().unwrap_or(Path::new("."));
    let mut new = tempfile::Builder::new()
        .prefix(NEW)
        .permissions(Permissions::from_mode(0o666))
        .tempfile_in(parent)?;
    new.write_all(content)?;
    new.as_file().sync_all()?;
    Ok(new)
}

/// Puts it into its place.
pub(crate) fn put(place: &Path, content: &[u8]) -> Result<(), CampaignError> {
    let put = || whole(place, content)?.persist(place).map(drop).map_err(std::io::Error::from);
    put().map_err(CampaignError::file(place))
}

/// Whether a file is one with just this text.
pub(crate) fn holds(place: &Path, content: &str) -> bool {
    intake::text(place, intake::SETTINGS).is_ok_and(|text| text == content)
}
