//! What is done of a campaign: a file for each job, written whole or not at all, so that jobs may be killed,
//! started twice, and made by any number of computers that see one folder. In: rows of a job. Out: those of
//! all, in the order of the jobs.
//!
//! Every file says what it was made of: the campaign file, the machine and other files that it names, and the
//! program that made it. What was made of something else is refused and never mixed, nor is what somebody has
//! changed since.

use std::collections::BTreeSet;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::made::{add, files, hash, made_of};
use crate::plan::Plan;
use crate::rows::Row;
use crate::whole::{NEW, holds, put, whole};
use crate::{CampaignError, vary};

/// What says which campaign a folder is of.
const MARK: &str = "made-of";
const OTHER: &str =
    "was made of another campaign file, machine or program file, or by another build of pitchlock";
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
    /// The machine file whose keys vary, and the folder that its paths count from.
    original: String,
    beside: PathBuf,
    /// Words of the commands that all jobs have.
    shared: BTreeSet<String>,
}

/// A job that has begun.
#[derive(Debug)]
pub struct Begun {
    job: u64,
    made_of: String,
    /// Its machine files: where they lie, and what they hold.
    machines: Vec<(PathBuf, String)>,
}

/// A job that is done.
#[derive(Debug, Serialize, Deserialize)]
struct Done {
    made_of: String,
    job: u64,
    rows: Vec<Row>,
    /// Of the rows, as they are written.
    hash: String,
}

impl Folder {
    /// Opens the folder of a campaign, for one job or for all.
    ///
    /// # Errors
    /// The machine file cannot be read, values make no machine of it, or the folder cannot be written.
    pub fn open(plan: Plan, root: &Path, program: &Path, job: Option<u64>) -> Result<Folder, CampaignError> {
        let machine = plan.machine.as_deref().map(text).transpose()?;
        let shared = plan.words();
        let made_of = made_of(&plan, &shared, program)?;
        let original = machine.unwrap_or_else(|| machine::SMALL_LATHE.into());
        let beside = plan.machine.as_deref().and_then(Path::parent).unwrap_or(Path::new(""));
        let beside = beside.canonicalize().unwrap_or_else(|_| beside.into());
        let folder =
            Folder { plan, root: root.into(), program: program.into(), made_of, original, beside, shared };
        folder.machines_are_some(job)?;
        // From here on something is written.
        folder.is_ours()?;
        for place in [folder.root.join("jobs"), folder.root.join("machines")] {
            fs::create_dir_all(&place).map_err(CampaignError::file(place))?;
        }
        Ok(folder)
    }

    /// Refuses values that make no machine, and a machine that keeps something from run to run.
    fn machines_are_some(&self, job: Option<u64>) -> Result<(), CampaignError> {
        let table = self.original.parse::<toml::Table>().unwrap_or_default();
        let has = table.get("machine").and_then(|machine| machine.get("parameters")).is_some();
        if has || self.plan.keys(0).iter().any(|(key, _)| *key == "machine.parameters") {
            return Err(CampaignError::Input(
                "machine.parameters: a run writes this file in its end, so figures would hang on the order of the \
                 jobs: take it out of the machine file, and let the program set what it has"
                    .into(),
            ));
        }
        let numbers = job.map_or_else(|| (0..self.plan.machines()).collect(), |job| self.machines_of(job));
        numbers.into_iter().try_for_each(|number| self.machine_text(number).map(drop))
    }

    /// The machine files of a job.
    fn machines_of(&self, job: u64) -> BTreeSet<u64> {
        self.plan.runs(job).iter().filter_map(|run| run.machine).collect()
    }

    fn machine_text(&self, number: u64) -> Result<String, CampaignError> {
        let keys = self.plan.keys(number);
        vary::machine(&self.original, &self.beside, &keys).map_err(CampaignError::Input)
    }

    /// Whether the folder is marked as ours; refuses that of another campaign.
    fn is_marked(&self) -> Result<bool, CampaignError> {
        let mark = self.root.join(MARK);
        match intake::text(&mark, intake::SETTINGS) {
            Ok(text) if text.trim() == self.made_of => Ok(true),
            Ok(_) => Err(self.refused(OTHER)),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
            Err(error) => Err(self.refused(&format!("{MARK} {error}"))),
        }
    }

    fn refused(&self, why: &str) -> CampaignError {
        let place = self.root.display();
        CampaignError::Stale(format!("{place}: {why}: name a new folder with --out, or remove this one"))
    }

    /// Refuses a folder in which there is something else, before anything is written there. Of those who
    /// begin in one folder at the same time one marks it, and the others look again.
    fn is_ours(&self) -> Result<(), CampaignError> {
        if self.is_marked()? {
            return Ok(());
        }
        let new = |entry: &fs::DirEntry| entry.file_name().to_string_lossy().starts_with(NEW);
        let others =
            fs::read_dir(&self.root).is_ok_and(|entries| entries.flatten().any(|entry| !new(&entry)));
        if !others {
            fs::create_dir_all(&self.root).map_err(CampaignError::file(&self.root))?;
            let mark = self.root.join(MARK);
            let made = whole(&mark, format!("{}\n", self.made_of).as_bytes())
                .and_then(|new| new.persist_noclobber(&mark).map(drop).map_err(|error| error.error));
            if let Err(error) = made
                && error.kind() != ErrorKind::AlreadyExists
            {
                return Err(CampaignError::file(mark)(error));
            }
        }
        if self.is_marked()? { Ok(()) } else { Err(self.refused("other files are in this folder already")) }
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
            let number = number.and_then(|number| number.parse::<u64>().ok());
            there.extend(number.filter(|number| self.job(*number).file_name() == Some(&name)));
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
        if done.made_of != self.of_job(job)? {
            return Err(stale(OTHER.into()));
        }
        if done.job != job {
            return Err(stale(format!("is of job {}", done.job)));
        }
        if done.hash != hash(&done.rows)? {
            return Err(stale("its rows are not those that the job has left".into()));
        }
        Ok(done.rows)
    }

    /// A job begins: its machine files are there.
    ///
    /// # Errors
    /// A file cannot be read or written.
    pub fn begin(&self, job: u64) -> Result<Begun, CampaignError> {
        let file = |number| Ok((self.machine(number), self.machine_text(number)?));
        let machines =
            self.machines_of(job).into_iter().map(file).collect::<Result<Vec<_>, CampaignError>>()?;
        for (place, content) in machines.iter().filter(|(place, content)| !holds(place, content)) {
            put(place, content.as_bytes())?;
        }
        Ok(Begun { job, made_of: self.of_job(job)?, machines })
    }

    /// Keeps the rows of a job.
    ///
    /// # Errors
    /// They cannot be written, or what they were made of has changed meanwhile; nothing is left of them then.
    pub fn keep(&self, begun: Begun, rows: Vec<Row>) -> Result<(), CampaignError> {
        let Begun { job, made_of: of_job, machines } = begun;
        let changed = |what: &str| {
            Err(CampaignError::Stale(format!(
                "job {job}: {what} has changed meanwhile: nothing of it is kept, the same command makes it again"
            )))
        };
        if made_of(&self.plan, &self.shared, &self.program)? != self.made_of || self.of_job(job)? != of_job {
            return changed("a file that it is made of");
        }
        if let Some((place, _)) = machines.iter().find(|(place, content)| !holds(place, content)) {
            return changed(&place.display().to_string());
        }
        let done = Done { made_of: of_job, job, hash: hash(&rows)?, rows };
        let text = serde_json::to_vec(&done).map_err(|error| CampaignError::Input(error.to_string()))?;
        if text.len() as u64 > LONGEST {
            let why = "its rows are longer than a file of a job may be (1 GiB): a smaller per_job makes shorter ones";
            return Err(CampaignError::Input(format!("job {job}: {why}")));
        }
        put(&self.job(job), &text)
    }

    /// What a job is made of: all that the campaign is, and files whose names have its seeds in them.
    fn of_job(&self, job: u64) -> Result<String, CampaignError> {
        let words = self.plan.runs(job).into_iter().flat_map(|run| run.words);
        let own: BTreeSet<String> = words.filter(|word| !self.shared.contains(word)).collect();
        let files = files(&own);
        if files.is_empty() {
            return Ok(self.made_of.clone());
        }
        let mut whole = blake3::Hasher::new();
        whole.update(self.made_of.as_bytes());
        files.iter().try_for_each(|file| add(&mut whole, file))?;
        Ok(whole.finalize().to_hex().to_string())
    }
}

fn text(path: &Path) -> Result<String, CampaignError> {
    let named = |error| CampaignError::Input(format!("{}: {error}", path.display()));
    intake::text(path, intake::SETTINGS).map_err(named)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(mass_kg: u32) -> Plan {
        let text =
            format!("command = [\"run\", \"a.ngc\"]\n[vary]\n\"axis.x.mass_kg\" = [{mass_kg}, 1800]\n");
        Plan::read("one.toml", &text).expect("a campaign")
    }

    /// A folder, and a program in it.
    fn place() -> (tempfile::TempDir, PathBuf) {
        let place = tempfile::tempdir().expect("a folder");
        let program = place.path().join("program");
        fs::write(&program, "p").expect("a file");
        (place, program)
    }

    /// Two begin two campaigns in one new folder at the same time: one of them has it.
    #[test]
    fn one_folder_is_of_one_campaign_whoever_else_begins_there() {
        let (place, program) = place();
        for round in 0..200 {
            let root = place.path().join(round.to_string());
            let open = |mass_kg: u32| Folder::open(plan(mass_kg), &root, &program, None);
            let both = std::thread::scope(|scope| {
                let other = scope.spawn(|| open(1700));
                [open(1900), other.join().expect("it ends")]
            });
            let ours: Vec<&Folder> = both.iter().flatten().collect();
            assert_eq!(ours.len(), 1, "round {round}: {both:?}");
            let mark = fs::read_to_string(root.join(MARK)).expect("a mark");
            assert_eq!(mark.trim(), ours[0].made_of);
        }
    }

    /// The same campaign, begun by many at the same time.
    #[test]
    fn whoever_begins_the_same_campaign_at_the_same_time_takes_part() {
        let (place, program) = place();
        for round in 0..100 {
            let root = place.path().join(round.to_string());
            let open = || Folder::open(plan(1900), &root, &program, None).map(drop);
            std::thread::scope(|scope| {
                let all: Vec<_> = (0..4).map(|_| scope.spawn(open)).collect();
                all.into_iter().for_each(|one| one.join().expect("it ends").expect("it is ours, too"));
            });
        }
    }

    #[test]
    fn what_somebody_changed_is_not_kept_or_not_believed() {
        let (place, program) = place();
        let folder = Folder::open(plan(1900), &place.path().join("out"), &program, None).expect("a folder");
        let rows = || vec![Row::from_iter([("seed".into(), 2.into())])];
        let begun = folder.begin(0).expect("a job");
        let machine = folder.machine(0);
        let text = fs::read_to_string(&machine).expect("a machine file");
        fs::write(&machine, text.replace("1900", "1234")).expect("it is ours");
        let why = folder.keep(begun, rows()).expect_err("another machine").to_string();
        assert!(why.contains("00000.toml has changed meanwhile"), "{why}");
        // The next one to begin makes it right.
        let begun = folder.begin(0).expect("a job");
        assert_eq!(fs::read_to_string(&machine).expect("a machine file"), text);
        folder.keep(begun, rows()).expect("kept");
        assert_eq!(folder.rows(0).expect("rows"), rows());
        let job = fs::read_to_string(folder.job(0)).expect("a file");
        fs::write(folder.job(0), job.replace("\"seed\":2", "\"seed\":7")).expect("it is ours");
        let why = folder.rows(0).expect_err("other rows").to_string();
        assert!(why.contains("not those that the job has left"), "{why}");
    }

    #[test]
    fn a_file_whose_name_has_a_seed_is_what_its_job_is_made_of() {
        let place = tempfile::tempdir().expect("a folder");
        let at = |name: &str| place.path().join(name);
        for name in ["program", "p0.ngc", "p1.ngc"] {
            fs::write(at(name), "M2\n").expect("a file");
        }
        let command =
            format!("command = [\"run\", \"{}/p{{seed}}.ngc\"]\nseeds = \"0..2\"\n", place.path().display());
        let open = || {
            let plan = Plan::read("one.toml", &command).expect("a campaign");
            Folder::open(plan, &at("out"), &at("program"), None).expect("a folder")
        };
        let folder = open();
        for job in 0..2 {
            let begun = folder.begin(job).expect("a job");
            folder.keep(begun, Vec::new()).expect("kept");
        }
        let begun = folder.begin(1).expect("a job");
        fs::write(at("p1.ngc"), "M30\n").expect("a file");
        assert!(folder.keep(begun, Vec::new()).is_err(), "it changed meanwhile");
        let folder = open();
        assert!(folder.rows(0).is_ok() && folder.rows(1).is_err_and(|why| why.to_string().contains(OTHER)));
    }

    #[test]
    fn a_pipe_is_no_mark() {
        let (place, program) = place();
        let made = std::process::Command::new("mkfifo").arg(place.path().join(MARK)).status();
        assert!(made.is_ok_and(|status| status.success()));
        let why = Folder::open(plan(1900), place.path(), &program, None).expect_err("a pipe").to_string();
        assert!(why.contains("is a pipe") && why.contains("--out"), "{why}");
    }
}
