//! What is done of a campaign: a file for each job, written whole or not at all, so that jobs may be killed,
//! started twice, and made by any number of computers that see one folder. In: rows of a job. Out: those of
//! all, in the order of the jobs.
//!
//! Every file says what it was made of: the campaign file, the machine and other files that it names, and the
//! program that made it. What was made of something else is refused and never mixed.

use std::collections::BTreeSet;
use std::fs::{self, Permissions};
use std::io::{ErrorKind, Write as _};
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::plan::Plan;
use crate::rows::Row;
use crate::{CampaignError, vary};

/// What says which campaign a folder is of.
const MARK: &str = "made-of";
const OTHER: &str =
    "was made of another campaign file, machine or program file, or by another build of pitchlock";
/// What a file is called until it is whole.
const NEW: &str = ".new-";
/// The longest file of a job that is read, bytes.
const LONGEST: u64 = 1 << 30;

/// A campaign and its folder.
#[derive(Debug)]
pub struct Folder {
    /// What is asked for.
    pub plan: Plan,
    root: PathBuf,
    program: PathBuf,
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
        let made_of = made_of(&plan, program)?;
        let folder = Folder { plan, root: root.into(), program: program.into(), made_of };
        let original = machine.as_deref().unwrap_or(machine::SMALL_LATHE);
        let beside = folder.plan.machine.as_deref().and_then(Path::parent).unwrap_or(Path::new(""));
        let beside = beside.canonicalize().unwrap_or_else(|_| beside.into());
        let of = |(number, keys): (u64, Vec<_>)| Ok((number, vary::machine(original, &beside, &keys)?));
        let machines = folder.plan.machines().into_iter().map(of).collect::<Result<Vec<_>, _>>();
        let machines = machines.map_err(CampaignError::Input)?;
        // From here on something is written.
        folder.is_ours()?;
        for place in [folder.root.join("jobs"), folder.root.join("machines")] {
            fs::create_dir_all(&place).map_err(CampaignError::file(place))?;
        }
        for (number, text) in machines {
            let place = folder.machine(number);
            if fs::read_to_string(&place).ok().as_ref() != Some(&text) {
                put(&place, text.as_bytes())?;
            }
        }
        Ok(folder)
    }

    /// Refuses a folder in which there is something else, before anything is written there.
    fn is_ours(&self) -> Result<(), CampaignError> {
        let mark = self.root.join(MARK);
        let refused = |why: &str| {
            let place = self.root.display();
            Err(CampaignError::Stale(format!(
                "{place}: {why}: name a new folder with --out, or remove this one"
            )))
        };
        match fs::read_to_string(&mark) {
            Ok(text) if text.trim() == self.made_of => Ok(()),
            Ok(_) => refused(OTHER),
            Err(error) if error.kind() == ErrorKind::NotFound => {
                // Somebody else may just begin the same campaign.
                let new = |entry: &fs::DirEntry| entry.file_name().to_string_lossy().starts_with(NEW);
                if fs::read_dir(&self.root).is_ok_and(|entries| entries.flatten().any(|entry| !new(&entry))) {
                    return refused("other files are in this folder already");
                }
                fs::create_dir_all(&self.root).map_err(CampaignError::file(&self.root))?;
                put(&mark, format!("{}\n", self.made_of).as_bytes())
            }
            Err(error) => Err(CampaignError::file(mark)(error)),
        }
    }

    /// The machine file of a combination of values.
    pub fn machine(&self, number: u64) -> PathBuf {
        self.root.join("machines").join(format!("{number:05}.toml"))
    }

    /// The table, when it is made.
    pub fn table(&self) -> PathBuf {
        self.root.join("campaign.parquet")
    }

    /// A folder for what a job leaves that nobody needs; dropping it takes it away.
    ///
    /// # Errors
    /// It cannot be made.
    pub fn scratch(&self, job: u64) -> Result<tempfile::TempDir, CampaignError> {
        let place = self.root.join("scratch");
        fs::create_dir_all(&place).map_err(CampaignError::file(&place))?;
        let made = tempfile::Builder::new().prefix(&format!("{job:05}-")).tempdir_in(&place);
        made.map_err(CampaignError::file(place))
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

    /// Takes away what jobs that were killed have left; all are done.
    pub fn clear(&self) {
        // Whatever cannot be removed is in nobody's way.
        let _ = fs::remove_dir_all(self.root.join("scratch"));
        for place in ["jobs", "machines"] {
            for entry in fs::read_dir(self.root.join(place)).into_iter().flatten().flatten() {
                if entry.file_name().to_string_lossy().starts_with(NEW) {
                    let _ = fs::remove_file(entry.path());
                }
            }
        }
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
            return Err(stale(OTHER.into()));
        }
        if done.job != job {
            return Err(stale(format!("is of job {}", done.job)));
        }
        Ok(done.rows)
    }

    /// Keeps the rows of a job.
    ///
    /// # Errors
    /// They cannot be written, or what they were made of has changed meanwhile; nothing is left of them then.
    pub fn keep(&self, job: u64, rows: Vec<Row>) -> Result<(), CampaignError> {
        if made_of(&self.plan, &self.program)? != self.made_of {
            let why = "a file that it is made of has changed meanwhile: nothing of it is kept";
            return Err(CampaignError::Stale(format!("job {job}: {why}")));
        }
        let done = Done { made_of: self.made_of.clone(), job, rows };
        let text = serde_json::to_vec(&done).map_err(|error| CampaignError::Input(error.to_string()))?;
        put(&self.job(job), &text)
    }
}

/// A file as a whole: whoever reads it finds all of it or nothing. What it is until then has a name
/// that no other process has, on whatever computer: process numbers alone are the same in many
/// containers.
fn put(place: &Path, content: &[u8]) -> Result<(), CampaignError> {
    let put = || {
        let parent = place.parent().unwrap_or(Path::new("."));
        let mut new = tempfile::Builder::new()
            .prefix(NEW)
            .permissions(Permissions::from_mode(0o666))
            .tempfile_in(parent)?;
        new.write_all(content)?;
        new.as_file().sync_all()?;
        new.persist(place)?;
        std::io::Result::Ok(())
    };
    put().map_err(CampaignError::file(place))
}

fn text(path: &Path) -> Result<String, CampaignError> {
    let named = |error| CampaignError::Input(format!("{}: {error}", path.display()));
    intake::text(path, intake::SETTINGS).map_err(named)
}

/// What a campaign is made of, as a hash: its file, its machine file, every file that a word of one of
/// its commands names, also behind `=`, and the program.
fn made_of(plan: &Plan, program: &Path) -> Result<String, CampaignError> {
    let mut whole = blake3::Hasher::new();
    whole.update(blake3::hash(plan.text.as_bytes()).as_bytes());
    let words = plan.words();
    let values = words.iter().map(|word| word.split_once('=').map_or(word.as_str(), |(_, value)| value));
    let named = words.iter().map(String::as_str).chain(values).map(Path::new);
    for file in plan.machine.as_deref().into_iter().chain(named).chain([program]) {
        // A word that is no file; devices and pipes have nothing that stays.
        if !fs::metadata(file).is_ok_and(|found| found.is_file()) {
            continue;
        }
        let mut hash = blake3::Hasher::new();
        let read = fs::File::open(file).and_then(|mut file| std::io::copy(&mut file, &mut hash));
        read.map_err(CampaignError::file(file))?;
        whole.update(hash.finalize().as_bytes());
    }
    Ok(whole.finalize().to_hex().to_string())
}
