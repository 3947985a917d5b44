//! A job: its commands one behind the other, each a process of this program, and their rows into its file.

use std::{
    fs::File,
    os::unix::process::{CommandExt as _, ExitStatusExt as _},
    path::{Path, PathBuf},
    process::{Command, ExitStatus, Stdio},
    sync::atomic::{AtomicBool, Ordering},
    time::Duration,
};

use ::campaign::{
    folder::Folder,
    plan::Run,
    rows::{Row, rows},
};
use process::ipc::{
    child::signal_words,
    time::{Moment, sleep_until},
};
use serde_json::Value;

use crate::error::CliError;

/// How often it is looked whether a command has ended.
const LOOK: Duration = Duration::from_millis(10);
/// The longest document that is read, bytes.
const LONGEST: u64 = 1 << 30;
/// The longest text of an error that a row has, bytes.
const LONGEST_ERROR: usize = 2000;

/// What one process left.
struct Ended {
    status: ExitStatus,
    printed: String,
    said: String,
}

/// Makes a job and keeps its rows.
///
/// # Errors
/// It was asked to end, a command was ended from outside, or something cannot be written: nothing is kept.
pub(super) fn job(folder: &Folder, job: u64, stop: &AtomicBool) -> Result<(), CliError> {
    let scratch = Scratch::new(folder, job)?;
    let mut all = Vec::new();
    for run in folder.plan.runs(job) {
        let command = command(folder, &run);
        let made = scratch.ended(folder, &run, stop)?;
        let Some(status) = made.status.code() else {
            let signal = made.status.signal().map(signal_words).unwrap_or_default();
            return Err(CliError::Machine(format!("job {job}: `{command}` was ended: {signal}")));
        };
        for row in of_run(&run, status, &made)? {
            let mut whole = Row::new();
            whole.insert("job".into(), job.into());
            whole.insert("command".into(), command.clone().into());
            whole.insert("status".into(), status.into());
            whole.extend(run.varied.iter().cloned());
            // Figures whose name a column of the campaign has already keep both.
            for (name, value) in row {
                let name = if whole.contains_key(&name) { format!("row.{name}") } else { name };
                whole.insert(name, value);
            }
            all.push(whole);
        }
    }
    Ok(folder.keep(job, all)?)
}

/// The rows of one command; where it printed no document one that says why.
fn of_run(run: &Run, status: i32, made: &Ended) -> Result<Vec<Row>, CliError> {
    let name = run.words.first().map_or("", String::as_str);
    let document: Option<Value> = serde_json::from_str(&made.printed).ok();
    let refused = document.as_ref().and_then(|document| document.get("error")?.as_str());
    let why = match (&document, refused) {
        (_, Some(why)) => why.to_owned(),
        (None, None) => made.said.clone(),
        (Some(document), None) => {
            if let Some(asked) = &run.seeds
                && document
                    .get("seeds")
                    .and_then(Value::as_u64)
                    .is_some_and(|seeds| seeds != asked.end - asked.start)
            {
                return Err(CliError::Machine(format!("`{}` was broken off", run.words.join(" "))));
            }
            match rows(name, document) {
                Ok(rows) => return Ok(rows),
                Err(why) => why,
            }
        }
    };
    if status == 0 {
        return Err(CliError::Machine(format!("`{}` gives no rows: {why}", run.words.join(" "))));
    }
    let mut short = why;
    short.truncate((0..=LONGEST_ERROR.min(short.len())).rfind(|at| short.is_char_boundary(*at)).unwrap_or(0));
    Ok(vec![Row::from_iter([("error".into(), short.into())])])
}

/// The command as a person repeats it, in the folder of the campaign where it has a machine file there.
fn command(folder: &Folder, run: &Run) -> String {
    let word =
        |word: &String| if word.contains([' ', '"', '\'']) { format!("{word:?}") } else { word.clone() };
    let words: Vec<String> = run.words.iter().map(word).collect();
    let machine = match (run.machine, &folder.plan.machine) {
        (Some(number), _) => format!(" --machine machines/{number:05}.toml"),
        (None, Some(path)) => format!(" --machine {}", path.display()),
        (None, None) => String::new(),
    };
    format!("pitchlock {}{machine}", words.join(" "))
}

/// Where the commands of a job leave what nobody needs. Dropping it takes that away.
struct Scratch(PathBuf);

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

impl Scratch {
    fn new(folder: &Folder, job: u64) -> Result<Scratch, CliError> {
        let place = folder.scratch().join(format!("{job:05}-{}", std::process::id()));
        std::fs::create_dir_all(&place).map_err(|error| CliError::file(&place, error))?;
        Ok(Scratch(place))
    }

    /// Runs one command to its end.
    fn ended(&self, folder: &Folder, run: &Run, stop: &AtomicBool) -> Result<Ended, CliError> {
        let Scratch(place) = self;
        let failed = |error: std::io::Error| CliError::file(place, error);
        let (printed, said) = (place.join("printed"), place.join("said"));
        let this = std::env::current_exe().map_err(failed)?;
        let mut command = Command::new(this);
        command.args(&run.words).args(added(run, place));
        match (run.machine, &folder.plan.machine) {
            (Some(number), _) => drop(command.arg("--machine").arg(folder.machine(number))),
            (None, Some(path)) => drop(command.arg("--machine").arg(path)),
            (None, None) => {}
        }
        // Ctrl-C is for this process, which ends the command; without this process the command ends, too.
        command.process_group(0).env(process::ipc::ENDS_WITH, std::process::id().to_string());
        command.stdin(Stdio::null());
        command.stdout(File::create(&printed).map_err(failed)?).stderr(File::create(&said).map_err(failed)?);
        let mut child = command.spawn().map_err(failed)?;
        let status = loop {
            if stop.load(Ordering::Relaxed) {
                let _ = child.kill();
                let _ = child.wait();
                return Err(CliError::Machine(
                    "broken off; the same command goes on with what is not done".into(),
                ));
            }
            if let Some(status) = child.try_wait().map_err(failed)? {
                break status;
            }
            sleep_until(Moment::now().after(LOOK));
        };
        let read = |path: &Path| intake::text(path, LONGEST).map_err(|error| CliError::file(path, error));
        let ended = Ended { status, printed: read(&printed)?, said: read(&said)? };
        // The next command of this job begins in an empty folder.
        let _ = std::fs::remove_dir_all(place.join("out"));
        Ok(ended)
    }
}

/// What a campaign adds to a command: a document, no trace, and everything else out of the way.
fn added(run: &Run, place: &Path) -> Vec<PathBuf> {
    let has = |option: &str| run.words.iter().any(|word| word.split('=').next() == Some(option));
    let out = place.join("out");
    let words: &[&str] = match run.words.first().map_or("", String::as_str) {
        "soak" if has("--jobs") => &["--each"],
        "soak" => &["--each", "--jobs", "1"],
        "run" if has("--trace") => &["--in-process"],
        "run" => &["--in-process", "--trace", "none"],
        _ => &[],
    };
    let writes = matches!(run.words.first().map(String::as_str), Some("run" | "experiment"));
    let mut all: Vec<PathBuf> = ["--json"].iter().chain(words).map(PathBuf::from).collect();
    all.extend(writes.then(|| [PathBuf::from("--out"), out]).into_iter().flatten());
    all
}
