//! One record as bytes. In: a running number and what is kept. Out: two equal sectors; and from any bytes the
//! newest record that is whole.
//!
//! | bytes of a sector | what |
//! |---|---|
//! | 0 … 8 | what is kept, with its version ([`Kept::MAGIC`]) |
//! | 8 … 16 | running number, little-endian |
//! | 16 … | the bytes of what is kept, then zeros |
//! | 504 … 512 | the first eight bytes of BLAKE3 over all before |

use std::path::PathBuf;

use zerocopy::{FromBytes, Immutable, IntoBytes};

/// Bytes of a sector.
pub const SECTOR: usize = 512;
/// Where its parts begin.
const NUMBER: usize = 8;
const BODY: usize = 16;
const HASH: usize = SECTOR - 8;

/// Something that a journal keeps. It has no padding, and fits in a sector.
pub trait Kept: IntoBytes + FromBytes + Immutable + Copy {
    /// Name and version of its form.
    const MAGIC: [u8; 8];
}

fn hash(sector: &[u8]) -> [u8; 8] {
    let mut short = [0; 8];
    short.copy_from_slice(&blake3::hash(sector.get(..HASH).unwrap_or_default()).as_bytes()[..8]);
    short
}

/// A record: the same sector twice.
pub(crate) fn sheet<T: Kept>(number: u64, kept: &T) -> [u8; 2 * SECTOR] {
    const { assert!(size_of::<T>() <= HASH - BODY, "a sector holds a whole record") };
    let mut sector = [0; SECTOR];
    sector[..NUMBER].copy_from_slice(&T::MAGIC);
    sector[NUMBER..BODY].copy_from_slice(&number.to_le_bytes());
    sector[BODY..BODY + size_of::<T>()].copy_from_slice(kept.as_bytes());
    let hash = hash(&sector);
    sector[HASH..].copy_from_slice(&hash);
    let mut sheet = [0; 2 * SECTOR];
    sheet[..SECTOR].copy_from_slice(&sector);
    sheet[SECTOR..].copy_from_slice(&sector);
    sheet
}

/// What a sector holds, if it is whole and of this form.
fn read<T: Kept>(sector: &[u8]) -> Option<(u64, T)> {
    if sector.get(..NUMBER)? != T::MAGIC || sector.get(HASH..)? != hash(sector) {
        return None;
    }
    let number = u64::from_le_bytes(sector.get(NUMBER..BODY)?.try_into().ok()?);
    Some((number, T::read_from_prefix(sector.get(BODY..HASH)?).ok()?.0))
}

/// The newest whole record among some bytes, with its running number; none if there is none.
pub fn latest<T: Kept>(bytes: &[u8]) -> Option<(u64, T)> {
    bytes.chunks_exact(SECTOR).filter_map(read).max_by_key(|(number, _)| *number)
}

/// Whether whole records of another version of this form are among some bytes.
pub fn has_other_version<T: Kept>(bytes: &[u8]) -> bool {
    const NAME: usize = NUMBER - 1;
    let is_other = |sector: &[u8]| {
        let (magic, whole) = (sector.get(..NUMBER), sector.get(HASH..) == Some(&hash(sector)[..]));
        whole && magic.is_some_and(|magic| magic[..NAME] == T::MAGIC[..NAME] && magic != T::MAGIC)
    };
    bytes.chunks_exact(SECTOR).any(is_other)
}

/// A short hash of what some files are named and hold, in their order.
pub fn fingerprint(files: &[(PathBuf, blake3::Hash)]) -> [u8; 16] {
    let mut all = blake3::Hasher::new();
    for (path, hash) in files {
        all.update(path.file_name().unwrap_or_default().as_encoded_bytes());
        all.update(hash.as_bytes());
    }
    let mut short = [0; 16];
    short.copy_from_slice(&all.finalize().as_bytes()[..16]);
    short
}
