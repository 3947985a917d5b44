//! What a file holds, as a hash: a run says by it of which files it was made, and which trace is its own.

use std::path::Path;

/// BLAKE3 of a file, read without being held in memory.
///
/// # Errors
/// It cannot be read.
pub fn of_file(path: &Path) -> std::io::Result<blake3::Hash> {
    let mut hash = blake3::Hasher::new();
    hash.update_reader(intake::open(path)?)?;
    Ok(hash.finalize())
}

/// The same in hex, as summaries have it.
///
/// # Errors
/// It cannot be read.
pub fn hex_of_file(path: &Path) -> std::io::Result<String> {
    of_file(path).map(|hash| hash.to_hex().to_string())
}

/// BLAKE3 of a text, in hex.
pub fn hex_of_text(text: &str) -> String {
    blake3::hash(text.as_bytes()).to_hex().to_string()
}
