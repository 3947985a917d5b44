//! What a campaign is made of, as a hash. In: a campaign, the program. Out: a hash of all files that its rows
//! hang on.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::CampaignError;
use crate::plan::Plan;

/// Of all jobs: the campaign file, its machine file, every file that a word of one of
/// its commands names, also behind `=`, and the program.
pub(crate) fn made_of(plan: &Plan, program: &Path) -> Result<String, CampaignError> {
    let mut whole = blake3::Hasher::new();
    whole.update(blake3::hash(plan.text.as_bytes()).as_bytes());
    let words = plan.words();
    for file in plan.machine.as_deref().into_iter().chain(files(&words)).chain([program]) {
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
