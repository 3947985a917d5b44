//! What a campaign is made of, and what a job has left, as hashes. In: a campaign, the program; rows. Out: a
//! hash of all files that its rows hang on; one of the rows.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::CampaignError;
use crate::plan::Plan;
use crate::rows::Row;

/// Of all jobs: the campaign file, its machine file, every file that one of these words of its commands
/// names, also behind `=`, and the program.
pub(crate) fn made_of(
    plan: &Plan,
    words: &BTreeSet<String>,
    program: &Path,
) -> Result<String, CampaignError> {
    let mut whole = blake3::Hasher::new();
    whole.update(blake3::hash(plan.text.as_bytes()).as_bytes());
    for file in plan.machine.as_deref().into_iter().chain(files(words)).chain([program]) {
        add(&mut whole, file)?;
    }
    Ok(whole.finalize().to_hex().to_string())
}

/// The files that words name. Devices and pipes are none: they have nothing that stays.
pub(crate) fn files(words: &BTreeSet<String>) -> Vec<&Path> {
    let values = words.iter().map(|word| word.split_once('=').map_or(word.as_str(), |(_, value)| value));
    let named = words.iter().map(String::as_str).chain(values).map(Path::new);
    named.filter(|file| fs::metadata(file).is_ok_and(|found| found.is_file())).collect()
}

/// Adds the hash of a file.
pub(crate) fn add(whole: &mut blake3::Hasher, file: &Path) -> Result<(), CampaignError> {
    let mut hash = blake3::Hasher::new();
    let read = fs::File::open(file).and_then(|mut file| std::io::copy(&mut file, &mut hash));
    read.map_err(CampaignError::file(file))?;
    whole.update(hash.finalize().as_bytes());
    Ok(())
}

/// Of rows, as they are written.
pub(crate) fn hash(rows: &[Row]) -> Result<String, CampaignError> {
    let text = serde_json::to_vec(rows).map_err(|error| CampaignError::Input(error.to_string()))?;
    Ok(blake3::hash(&text).to_hex().to_string())
}
