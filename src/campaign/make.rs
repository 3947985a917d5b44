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

use super::script::quote;
use crate::{error::CliError, run::interrupts::Wish};

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
/// It was asked to end, a command was ended from outside or by the computer, what it is made of has
/// changed, or something cannot be written: nothing is kept.
pub(super) fn job(folder: &Folder, job: u64, stop: &AtomicBool) -> Result<(), CliError> {
    let begun = folder.begin(job)?;
    let scratch = folder.scratch(job)?;
    let mut all = Vec::new();
    for run in folder.plan.runs(job) {
        let command = command(folder, &run);
        let said = |why: String| CliError::Machine(format!("job {job}: `{command}` {why}"));
        let made = ended(folder, &run, scratch.path(), stop)?;
        let Some(status) = made.status.code() else {
            let signal = made.status.signal().map(signal_words).unwrap_or_default();
            return Err(said(format!("was ended by {signal}")));
        };
        for row in of_run(&run, status, &made, scratch.path()).map_err(said)? {
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
    Ok(folder.keep(begun, all)?)
}

/// The rows of one command; where it was refused one that says why.
///
/// # Errors
/// What came of it says something of this computer, and nothing of the machine: in words.
fn of_run(run: &Run, status: i32, made: &Ended, scratch: &Path) -> Result<Vec<Row>, String> {
    let name = run.words.first().map_or("", String::as_str);
    let document: Option<Value> = serde_json::from_str(&made.printed).ok();
    let of = |key: &str| document.as_ref().and_then(|document| document.get(key));
    if let Some(asked) = &run.seeds
        && of("seeds").and_then(Value::as_u64).is_some_and(|seeds| seeds != asked.end - asked.start)
    {
        return Err("was broken off".into());
    }
    let outcome = of("outcome").and_then(Value::as_str);
    // Only a scenario stops a run that nobody attends; a signal is told.
    let by_scenario = run.words.iter().any(|word| word.starts_with("--scenario"));
    let by_signal = Wish::End.words(Wish::None).any(|words| made.said.contains(words));
    if outcome == Some("stopped") && (!by_scenario || by_signal) {
        return Err("was stopped from outside".into());
    }
    if status == 1 && outcome == Some("completed") {
        return Err(format!("did not end well: {}", made.said));
    }
    let why = match (&document, of("error").and_then(Value::as_str)) {
        (_, Some(why)) => why.to_owned(),
        (None, None) => made.said.clone(),
        (Some(document), None) => match rows(name, document) {
            Ok(rows) => return Ok(rows),
            Err(why) => why,
        },
    };
    // Whose arguments are refused says so. Who has nothing to print had nowhere to: a full disk or the like,
    // as is what is wrong with a folder of ours.
    if status == 0 || (document.is_none() && status != 2) || why.contains(&scratch.display().to_string()) {
        return Err(format!("gives no rows: {why}"));
    }
    let mut short = why;
    short.truncate((0..=LONGEST_ERROR.min(short.len())).rfind(|at| short.is_char_boundary(*at)).unwrap_or(0));
    Ok(vec![Row::from_iter([("error".into(), short.into())])])
}

/// The machine file of a run, if it does not take the built-in one.
fn machine(folder: &Folder, run: &Run) -> Option<PathBuf> {
    run.machine.map(|number| folder.machine(number)).or_else(|| folder.plan.machine.clone())
}

/// The command as a shell takes it where the campaign was started.
fn command(folder: &Folder, run: &Run) -> String {
    let machine = machine(folder, run).map(|path| ["--machine".into(), path.display().to_string()]);
    let words = ["pitchlock".into()]
        .into_iter()
        .chain(run.words.iter().cloned())
        .chain(machine.into_iter().flatten());
    words.map(|word| quote(&word)).collect::<Vec<_>>().join(" ")
}

/// Runs one command to its end. What nobody needs of it lies in `place`.
fn ended(folder: &Folder, run: &Run, place: &Path, stop: &AtomicBool) -> Result<Ended, CliError> {
    let failed = |error: std::io::Error| CliError::Machine(format!("{}: {error}", place.display()));
    let (printed, said) = (place.join("printed"), place.join("said"));
    let this = std::env::current_exe().map_err(failed)?;
    let mut command = Command::new(this);
    command.args(&run.words).args(added(run, place));
    if let Some(machine) = machine(folder, run) {
        command.arg("--machine").arg(machine);
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
    let read = |path: &Path| {
        intake::text(path, LONGEST).map_err(|error| CliError::Machine(format!("{}: {error}", path.display())))
    };
    let ended = Ended { status, printed: read(&printed)?, said: read(&said)? };
    // The next command of this job begins in an empty folder.
    let _ = std::fs::remove_dir_all(place.join("out"));
    Ok(ended)
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
