//! `pitchlock soak`: seeds of random machines, programs and faults, and what they broke. In: a range of
//! seeds. Out: a table or one JSON document; for each seed that fails the command that repeats it and the
//! smallest case that still breaks the same invariant, as files.

use std::{
    fmt::Write as _,
    io::IsTerminal,
    ops::Range,
    path::{Path, PathBuf},
    process::ExitCode,
    sync::{
        Mutex,
        atomic::{AtomicU64, Ordering},
    },
};

use ::soak::{
    driver::{self, Failed, Report, Seen},
    shrink,
};
use clap::Args;
use process::ipc::time::Moment;
use serde_json::json;

use crate::{
    error::CliError,
    run::interrupts::{Interrupts, Wish},
    screen, written,
};

pub(crate) const HELP: &str = "Examples:
  pitchlock soak --seeds 0..2000
  pitchlock soak --seeds 1234..1235 --out broken     one seed, and its smallest case as files
  pitchlock soak --seeds 0..100000 --json > soak.json
On several computers, and what came of every seed as a table: pitchlock campaign --help";

/// Cases that are made smaller, at most: each takes some dozen runs.
const MOST_SHRUNK: usize = 20;
/// Seeds between two words about progress where there is no terminal.
const EVERY: u64 = 500;

#[derive(Clone, Debug, Args)]
pub(crate) struct SoakArgs {
    /// The seeds: the first, and the one behind the last.
    #[arg(long, value_name = "A..B", value_parser = campaign::plan::seeds)]
    pub(crate) seeds: Range<u64>,
    /// Print one JSON document and nothing else.
    #[arg(long)]
    pub(crate) json: bool,
    /// In that document also what came of each seed: `rows`.
    #[arg(long, requires = "json")]
    pub(crate) each: bool,
    /// Threads; without it one for each processor.
    #[arg(long, value_name = "N", value_parser = jobs)]
    pub(crate) jobs: Option<usize>,
    /// Folder for what fails: program.ngc, machine.toml and scenario.toml of each smallest case.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

pub(crate) fn jobs(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|jobs| *jobs > 0).ok_or_else(|| "threads, 1 or more".into())
}

/// A seed that failed, with its smallest case.
struct Found<'a> {
    failed: &'a Failed,
    command: String,
    smallest: Option<(::soak::case::Case, ::soak::judge::Broken)>,
    folder: Option<PathBuf>,
}

/// Runs the seeds; 1 if any of them breaks an invariant.
pub(crate) fn soak(args: &SoakArgs, quiet: bool) -> Result<ExitCode, CliError> {
    let jobs = args.jobs.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
    let begun = Moment::now();
    let all = args.seeds.end - args.seeds.start;
    if let Some(out) = &args.out {
        written::empty(out)?;
    }
    let told = AtomicU64::new(0);
    let terminal = std::io::stderr().is_terminal();
    let interrupts = Mutex::new(Interrupts::catch()?);
    let rows = Mutex::new(args.each.then(Vec::new));
    let progress = |seen: Seen, done: u64, failed: u64| {
        if let Ok(Some(rows)) = rows.lock().as_deref_mut() {
            rows.push(seen);
        }
        let every = if terminal { all.div_ceil(500) } else { EVERY };
        if !quiet
            && (done.is_multiple_of(every.max(1)) || done == all)
            && told.fetch_max(done, Ordering::Relaxed) < done
        {
            let rate = done as f64 / begun.elapsed().as_secs_f64().max(1e-3);
            let end = if terminal && done < all { "\r" } else { "\n" };
            eprint!("{done} of {all} seeds, {rate:.0} a second, {failed} failed{end}");
        }
        // Ctrl-C ends the search, not the report of it.
        interrupts.lock().map_or(true, |mut interrupts| interrupts.wish() == Wish::None)
    };
    let report = driver::soak(args.seeds.clone(), jobs, &progress);
    let wall_s = begun.elapsed().as_secs_f64();
    let found = report
        .failed
        .iter()
        .enumerate()
        .map(|(n, failed)| Found::of(failed, n < MOST_SHRUNK, args.out.as_deref()));
    let found = found.collect::<Result<Vec<_>, CliError>>()?;
    let per_core = report.cycles as f64 / wall_s / jobs as f64;
    if args.json {
        let rows = rows.into_inner().unwrap_or_default();
        let text = serde_json::to_string_pretty(&document(&report, &found, rows, per_core));
        screen::print(&format!("{}\n", text.map_err(|error| CliError::Machine(error.to_string()))?));
    } else {
        screen::print(&page(&report, &found, wall_s, per_core));
    }
    Ok(if found.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

impl<'a> Found<'a> {
    fn of(failed: &'a Failed, shrinks: bool, out: Option<&Path>) -> Result<Found<'a>, CliError> {
        let command = format!("pitchlock soak --seeds {}..{}", failed.seed, failed.seed + 1);
        let shrinks = shrinks && failed.broken.invariant != "panic";
        let smallest = shrinks.then(|| shrink::shrink(&failed.case, &failed.broken));
        let folder = match out {
            Some(out) => {
                let case = smallest.as_ref().map_or(&failed.case, |(case, _)| case);
                Some(write(case, &out.join(format!("seed-{}", failed.seed)))?)
            }
            None => None,
        };
        Ok(Found { failed, command, smallest, folder })
    }
}

/// The three files of a case, and the folder they lie in.
fn write(case: &::soak::case::Case, folder: &Path) -> Result<PathBuf, CliError> {
    let failed = |what: &dyn std::fmt::Display| CliError::Machine(format!("{}: {what}", folder.display()));
    std::fs::create_dir_all(folder).map_err(|error| failed(&error))?;
    let machine = case.machine_file().map_err(|error| failed(&error))?;
    for (name, text) in
        [("program.ngc", case.program()), ("machine.toml", machine), ("scenario.toml", case.scenario())]
    {
        std::fs::write(folder.join(name), text).map_err(|error| failed(&error))?;
    }
    Ok(folder.to_path_buf())
}

/// `rows` are of the seeds in whatever order they were done.
fn document(report: &Report, found: &[Found], rows: Option<Vec<Seen>>, per_core: f64) -> serde_json::Value {
    let failed = found.iter().map(|found| {
        let broken = &found.failed.broken;
        let smallest = found.smallest.as_ref().map(|(case, broken)| {
            json!({ "program": case.program(), "scenario": case.scenario(), "cycle": broken.cycle, "text": broken.text })
        });
        json!({
            "seed": found.failed.seed,
            "invariant": broken.invariant,
            "command": found.command,
            "cycle": broken.cycle,
            "text": broken.text,
            "case": found.failed.case.told(),
            "smallest": smallest,
            "folder": found.folder,
        })
    });
    let mut document = json!({
        "seeds": report.seeds,
        "failed": failed.collect::<Vec<_>>(),
        "drawn": report.drawn,
        "ended": report.ended,
        "slowest_cycles": report.slowest,
        "cycles": report.cycles,
        "cycles_per_s_per_core": per_core.round(),
    });
    if let Some(mut rows) = rows {
        rows.sort_by_key(|seen| seen.seed);
        document["rows"] = json!(rows);
    }
    document
}

fn page(report: &Report, found: &[Found], wall_s: f64, per_core: f64) -> String {
    let mut text = String::new();
    for found in found {
        let broken = &found.failed.broken;
        let _ = writeln!(
            text,
            "seed {} breaks {} in cycle {}: {}",
            found.failed.seed, broken.invariant, broken.cycle, broken.text
        );
        let _ = writeln!(text, "  {}\n  again: {}", found.failed.case.told(), found.command);
        if let Some((case, broken)) = &found.smallest {
            let _ = writeln!(text, "  smallest: {} ({}, cycle {})", case.told(), broken.text, broken.cycle);
        }
        if let Some(folder) = &found.folder {
            let at = folder.display();
            let _ = writeln!(
                text,
                "  to look at it: pitchlock run {at}/program.ngc --machine {at}/machine.toml --scenario {at}/scenario.toml --seed {} --in-process",
                found.failed.case.plant_seed
            );
        }
    }
    let _ = writeln!(text, "drawn");
    for (kind, count) in &report.drawn {
        let _ = writeln!(text, "  {kind:<24} {count:>9}");
    }
    let _ = writeln!(text, "outcomes, and the first fault of each run");
    for (kind, count) in &report.ended {
        let _ = writeln!(text, "  {kind:<24} {count:>9}");
    }
    let _ = writeln!(text, "slowest first word about a single event, control cycles");
    for (kind, cycles) in &report.slowest {
        let _ = writeln!(text, "  {kind:<24} {cycles:>9}");
    }
    let _ = writeln!(
        text,
        "{} seeds, {} failed, {wall_s:.1} s, {} control cycles, {per_core:.0} a second and core",
        report.seeds,
        found.len(),
        report.cycles
    );
    text
}
