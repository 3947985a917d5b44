//! What is done of a campaign: a file for each job, written whole or not at all, so that jobs may be killed,
//! started twice, and made by any number of computers that see one folder. In: rows of a job. Out: those of
//! all, in the order of the jobs.
//!
//! Every file says what it was made of: the campaign file, the machine and other files that it names, and the
//! program that made it. What was made of something else is refused and never mixed.

use std::collections::BTreeSet;
use std::fs;
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::plan::Plan;
use crate::rows::Row;
use crate::{CampaignError, vary};

/// The table.
pub const TABLE: &str = "campaign.parquet";
/// The longest file of a job that is read, bytes.
const LONGEST: u64 = 1 << 30;

/// A campaign and its folder.
#[derive(Debug)]
pub struct Folder {
    /// What is asked for.
    pub plan: Plan,
    root: PathBuf,
    made_of: String,
}

/// A job that is done.
#[derive(Debug, Serialize, Deserialize)]
struct Done {
    made_of: String,
    job: u64,
    rows: Vec<Row>,
}

impl Folder {
    /// Opens the folder of a campaign, and writes the machine files that it needs there.
    ///
    /// # Errors
    /// The machine file cannot be read, values make no machine of it, or the folder cannot be written.
    pub fn open(plan: Plan, root: &Path, program: &Path) -> Result<Folder, CampaignError> {
        let machine = plan.machine.as_deref().map(text).transpose()?;
        let made_of = made_of(&plan, machine.as_deref(), program)?;
        let folder = Folder { plan, root: root.into(), made_of };
        for place in [folder.root.join("jobs"), folder.root.join("machines")] {
            fs::create_dir_all(&place).map_err(CampaignError::file(place))?;
        }
        let original = machine.as_deref().unwrap_or(machine::SMALL_LATHE);
        let beside = folder.plan.machine.as_deref().and_then(Path::parent).unwrap_or(Path::new(""));
        let beside = beside.canonicalize().unwrap_or_else(|_| beside.into());
        for (number, keys) in folder.plan.machines() {
            let text = vary::machine(original, &beside, &keys).map_err(CampaignError::Input)?;
            let place = folder.machine(number);
            if fs::read_to_string(&place).ok().as_ref() != Some(&text) {
                put(&place, text.as_bytes())?;
            }
        }
        Ok(folder)
    }

    /// The machine file of a combination of values.
    pub fn machine(&self, number: u64) -> PathBuf {
        self.root.join("machines").join(format!("{number:05}.toml"))
    }

    /// The table, when it is made.
    pub fn table(&self) -> PathBuf {
        self.root.join(TABLE)
    }

    /// Where a run may leave what nobody needs.
    pub fn scratch(&self) -> PathBuf {
        self.root.join("scratch")
    }

    fn job(&self, job: u64) -> PathBuf {
        self.root.join("jobs").join(format!("{job:05}.json"))
    }

    /// The jobs that are not done.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn missing(&self) -> Result<Vec<u64>, CampaignError> {
        let place = self.root.join("jobs");
        let failed = || CampaignError::file(&place);
        let mut there = BTreeSet::new();
        for entry in fs::read_dir(&place).map_err(failed())? {
            let name = entry.map_err(failed())?.file_name();
            let number = name.to_str().and_then(|name| name.strip_suffix(".json"));
            there.extend(number.and_then(|number| number.parse::<u64>().ok()));
        }
        Ok((0..self.plan.jobs()).filter(|job| !there.contains(job)).collect())
    }

    /// The rows of a job that is done.
    ///
    /// # Errors
    /// Its file is not there, not whole, or of something else.
    pub fn rows(&self, job: u64) -> Result<Vec<Row>, CampaignError> {
        let place = self.job(job);
        let text = intake::text(&place, LONGEST)
            .map_err(|error| CampaignError::Input(format!("{}: {error}", place.display())))?;
        let stale = |why: String| {
            let text = format!(
                "{}: {why}: remove it and make the job again, or name a new folder with --out",
                place.display()
            );
            CampaignError::Stale(text)
        };
        let done: Done = serde_json::from_str(&text)
            .map_err(|error| stale(format!("is not what a job leaves ({error})")))?;
        if done.made_of != self.made_of {
            let why = "was made of another campaign file, machine or program file, or by another build of pitchlock";
            return Err(stale(why.into()));
        }
        if done.job != job {
            return Err(stale(format!("is of job {}", done.job)));
        }
        Ok(done.rows)
    }

    /// Keeps the rows of a job.
    ///
    /// # Errors
    /// They cannot be written; nothing is left of them then.
    pub fn keep(&self, job: u64, rows: Vec<Row>) -> Result<(), CampaignError> {
        let done = Done { made_of: self.made_of.clone(), job, rows };
        let text = serde_json::to_vec(&done).map_err(|error| CampaignError::Input(error.to_string()))?;
        put(&self.job(job), &text)
    }
}

/// A file as a whole: whoever reads it finds all of it or nothing.
fn put(place: &Path, content: &[u8]) -> Result<(), CampaignError> {
    let put = || {
        let mut begun = intake::begin(place)?;
        begun.file().write_all(content)?;
        begun.put()
    };
    put().map_err(CampaignError::file(place))
}

fn text(path: &Path) -> Result<String, CampaignError> {
    let named = |error| CampaignError::Input(format!("{}: {error}", path.display()));
    intake::text(path, intake::SETTINGS).map_err(named)
}

/// What a campaign is made of, as a hash: its file, its machine file, every file that a word of its command
/// names, and the program.
fn made_of(plan: &Plan, machine: Option<&str>, program: &Path) -> Result<String, CampaignError> {
    let mut hash = blake3::Hasher::new();
    let mut take = |bytes: &[u8]| {
        hash.update(&(bytes.len() as u64).to_le_bytes());
        hash.update(bytes);
    };
    take(plan.text.as_bytes());
    take(machine.unwrap_or_default().as_bytes());
    let files = plan.command().iter().skip(1).map(Path::new).chain([program]);
    for file in files {
        match fs::read(file) {
            Ok(content) => take(&content),
            // A word that is no file.
            Err(error)
                if [ErrorKind::NotFound, ErrorKind::IsADirectory, ErrorKind::NotADirectory]
                    .contains(&error.kind()) => {}
            Err(error) => return Err(CampaignError::file(file)(error)),
        }
    }
    Ok(hash.finalize().to_hex().to_string())
}
