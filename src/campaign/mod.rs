//! `pitchlock campaign FILE`: one command over many seeds and values, on all processors or by a scheduler.
//! In: a campaign file. Out: a folder with a file for each job, and one table of all rows.

mod make;
mod script;

use std::{
    collections::BTreeMap,
    io::Write,
    path::{Path, PathBuf},
    process::ExitCode,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicU64, AtomicUsize, Ordering},
    },
};

use ::campaign::{CampaignError, folder::Folder, plan::Plan, rows::Row, table};
use clap::Args;
use serde_json::{Value, json};

use crate::{error::CliError, run::interrupts::Interrupts, screen, words, written};

pub(crate) const HELP: &str = "A campaign file:
  command = [\"run\", \"examples/m20x2.ngc\", \"--seed\", \"{seed}\"]     or soak, experiment, tune
  seeds = \"1..11\"                          the first, and the one behind the last
  machine = \"lathe.toml\"                   without it the built-in small lathe
  [vary]
  \"axis.x.mass_kg\" = [1800, 1905, 2000]    a key of the machine file, or {name} in the command

Examples:
  pitchlock campaign mass.toml                      every job on all processors, then the table
  pitchlock campaign mass.toml --slurm | sbatch     the same on a cluster
  pitchlock campaign mass.toml --merge              the table of what a scheduler has made

What is broken off is gone on with by the same command. docs/campaigns.md has more.";

/// So many jobs may go wrong before no more are made.
const MOST_FAILED: usize = 20;

#[derive(Clone, Debug, Args)]
pub(crate) struct CampaignArgs {
    /// Campaign file (TOML).
    file: PathBuf,
    /// Its folder, which all computers see [default: `campaigns/NAME`].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Jobs at the same time; without it one for each processor.
    #[arg(long, value_name = "N", value_parser = crate::soak::jobs)]
    jobs: Option<usize>,
    /// Make this job and no other, as a scheduler asks.
    #[arg(long, value_name = "N", group = "part")]
    job: Option<u64>,
    /// Make no job: the table of those that are done, if all are.
    #[arg(long, group = "part")]
    merge: bool,
    /// Make no job: print an array of Slurm for the jobs that are not done.
    #[arg(long, group = "part")]
    slurm: bool,
    /// Print one JSON document and nothing else.
    #[arg(long, conflicts_with = "slurm")]
    pub(crate) json: bool,
}

impl From<CampaignError> for CliError {
    fn from(error: CampaignError) -> Self {
        match error {
            CampaignError::Input(_) | CampaignError::Stale(_) => CliError::Input(error.to_string()),
            CampaignError::File { .. } | CampaignError::Table(_) => CliError::Machine(error.to_string()),
        }
    }
}

/// Makes what is asked for of a campaign; 1 if it is not complete.
pub(crate) fn campaign(args: &CampaignArgs, quiet: bool) -> Result<ExitCode, CliError> {
    let text =
        intake::text(&args.file, intake::SETTINGS).map_err(|error| CliError::file(&args.file, error))?;
    let plan = Plan::read(&args.file.display().to_string(), &text)?;
    let name = args.file.file_stem().unwrap_or(args.file.as_os_str());
    let root = args.out.clone().unwrap_or_else(|| Path::new("campaigns").join(name));
    let this = std::env::current_exe().map_err(|error| CliError::Machine(error.to_string()))?;
    let named = |error| match error {
        CampaignError::Input(why) => CampaignError::Input(format!("{}: {why}", args.file.display())),
        other => other,
    };
    let folder = Folder::open(plan, &root, &this, args.job).map_err(named)?;
    let missing = folder.missing()?;
    if let Some(job) = args.job {
        return one(&folder, job, &missing, args.json);
    }
    if args.slurm {
        screen::print(&script::script(args, &root, &missing)?);
        return Ok(ExitCode::SUCCESS);
    }
    if !args.merge {
        let jobs = args.jobs.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
        all(&folder, &missing, jobs, quiet)?;
    }
    merge(&folder, args, quiet)
}

/// Makes one job, unless it is done; 1 if no command of it took its arguments.
fn one(folder: &Folder, job: u64, missing: &[u64], json: bool) -> Result<ExitCode, CliError> {
    let jobs = folder.plan.jobs();
    if job >= jobs {
        let text = format!("--job {job}: this campaign has the jobs 0 to {}", jobs.saturating_sub(1));
        return Err(CliError::Input(text));
    }
    if missing.contains(&job) {
        all(folder, &[job], 1, true)?;
    }
    if json {
        screen::print(&format!("{}\n", json!({ "job": job })));
    }
    let rows = folder.rows(job)?;
    let refused = rows.iter().all(|row| row.get("status").and_then(Value::as_i64) == Some(2));
    Ok(if refused && !rows.is_empty() { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

/// Makes jobs, so many at the same time.
fn all(folder: &Folder, jobs: &[u64], at_once: usize, quiet: bool) -> Result<(), CliError> {
    let interrupts = Interrupts::catch()?;
    let stop = interrupts.asked();
    let (next, done) = (AtomicUsize::new(0), AtomicU64::new(0));
    let failed = Mutex::new(Vec::new());
    let shows = !quiet && words::show_bar(jobs.len() as u64);
    let work = || {
        while let Some(job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
            // Who makes the same job beside us may have been faster.
            if let Err(error) = make::job(folder, *job, stop)
                && folder.rows(*job).is_err()
            {
                let mut failed = failed.lock().unwrap_or_else(PoisonError::into_inner);
                failed.push(error);
                // One that is ended for its memory holds up no other; what befalls all is told soon.
                if stop.load(Ordering::Relaxed) || failed.len() >= MOST_FAILED {
                    return;
                }
                continue;
            }
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            let told = format!("{done} of {} jobs", jobs.len());
            if shows {
                words::step(done, told);
            } else if !quiet {
                words::say(&format!("{told}\n"));
            }
        }
    };
    std::thread::scope(|scope| (0..at_once.min(jobs.len())).for_each(|_| drop(scope.spawn(work))));
    if shows {
        words::hide_bar();
    }
    interrupts.let_go();
    let failed = failed.into_inner().unwrap_or_else(PoisonError::into_inner);
    let many = failed.len();
    match failed.into_iter().next() {
        Some(error) if many > 1 && !stop.load(Ordering::Relaxed) => {
            Err(CliError::Machine(format!("{many} jobs were not made, the first: {error}")))
        }
        Some(error) => Err(error),
        None => Ok(()),
    }
}

/// The table, and what is said of it.
fn merge(folder: &Folder, args: &CampaignArgs, quiet: bool) -> Result<ExitCode, CliError> {
    let missing = folder.missing()?;
    let jobs = folder.plan.jobs();
    if let Some(first) = missing.first() {
        let file = args.file.display();
        return Err(CliError::Machine(format!(
            "{} of {jobs} jobs are not done, job {first} first: `pitchlock campaign {file}` makes them here, \
             `--slurm` prints an array for a cluster",
            missing.len()
        )));
    }
    // Every row is read twice, and no more of them are held than a group of the table: first what is in them.
    let mut seen = table::Columns::default();
    let mut statuses: BTreeMap<i64, (u64, Row)> = BTreeMap::new();
    let mut count = 0;
    let shows = !quiet && words::show_bar(2 * jobs);
    let step = |done: u64| {
        if shows {
            words::step(done, format!("the table: {} % of {jobs} jobs read", 50 * done / jobs.max(1)));
        }
    };
    for job in 0..jobs {
        step(job);
        for row in folder.rows(job)? {
            seen.see(&row);
            count += 1;
            let status = row.get("status").and_then(Value::as_i64).unwrap_or_default();
            statuses.entry(status).or_insert((0, row)).0 += 1;
        }
    }
    let place = folder.table();
    let written = written::by_parts(&place, |file| fill(folder, seen, file, &|job| step(jobs + job)));
    if shows {
        words::hide_bar();
    }
    written?;
    folder.clear();
    let refused = |(same, _): &(u64, Row)| *same == count;
    let nothing = statuses.get(&2).is_some_and(refused);
    if args.json {
        let counts: BTreeMap<String, u64> =
            statuses.iter().map(|(status, (count, _))| (status.to_string(), *count)).collect();
        let document = json!({ "jobs": jobs, "rows": count, "status": counts, "table": place });
        screen::print(&format!("{document}\n"));
    } else if !quiet {
        screen::print(&format!("{count} rows of {jobs} jobs  {}\n", place.display()));
        statuses.iter().filter(|(status, _)| **status != 0).for_each(|(status, (count, row))| {
            let of = |key: &str| row.get(key).and_then(Value::as_str).unwrap_or_default();
            screen::print(&format!("{count} with status {status}, such as: {}\n", of("command")));
            let why: String = of("error").lines().map(|line| format!("  {line}\n")).collect();
            screen::print(&why);
        });
    }
    Ok(if nothing { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

/// The rows of all jobs into the table.
fn fill(
    folder: &Folder,
    seen: table::Columns,
    file: &mut (impl Write + Send),
    step: &dyn Fn(u64),
) -> Result<(), CliError> {
    let failed = |error| CliError::from(CampaignError::from(error));
    let mut table = table::Table::begin(file, seen, &folder.plan.columns()).map_err(failed)?;
    for job in 0..folder.plan.jobs() {
        step(job);
        for row in folder.rows(job)? {
            table.push(row).map_err(failed)?;
        }
    }
    table.end().map_err(failed)
}
