//! `pitchlock tune`: axes are commissioned from short test moves. In: a machine file. Out: what was
//! identified, margins and a trial pass before and after, and the machine file with the keys that follow.
//!
//! The moves and what is learned from them are the crate `tune`; here is the bench it moves, and what is
//! shown and written.

mod change;
mod document;
mod figures;
mod file;
mod page;
mod tables;
mod trial;

use std::{path::PathBuf, process::ExitCode};

use clap::Args;
use machine::Machine;
use protocol::Axis;
use tune::{Goals, Tuned};

use crate::{
    args::MachineArgs,
    error::CliError,
    screen,
    words::Phase,
    written::{self, Made},
};

pub(crate) const HELP: &str = "Examples:
  pitchlock tune                                          the built-in lathe: what would be changed
  pitchlock tune --machine my-lathe.toml -o tuned.toml    with the changes in a new file
  pitchlock tune --axis x --page x.html                   X alone, with pictures

The controller learns from its measurements alone: nothing of [plant] is read. See docs/tuning.md.

Exit status: 0 done, 1 an axis could not be tuned, 2 the machine file or an argument is wrong.";

#[derive(Clone, Debug, Args)]
pub(crate) struct TuneArgs {
    #[command(flatten)]
    machine: MachineArgs,
    /// Axis to tune; may be given again for another one [default: every linear axis].
    #[arg(long, value_name = "AXIS")]
    axis: Vec<String>,
    /// The machine file with the proposal: a new file, or the one of --machine; without it nothing is
    /// written.
    #[arg(short, long, value_name = "OUT.toml")]
    out: Option<PathBuf>,
    /// Page with tables and pictures.
    #[arg(long, value_name = "PAGE.html")]
    page: Option<PathBuf>,
    /// Least phase margin of the velocity loop, degrees.
    #[arg(long, value_name = "DEG", default_value_t = Goals::default().velocity_phase_deg)]
    phase_margin: f64,
    /// Residual vibration that an approach of 5 mm may leave, µm.
    #[arg(long, value_name = "UM", default_value_t = Goals::default().residual_um)]
    residual: f64,
    /// Spindle speed for which the angle of that approach is told, 1/min.
    #[arg(long, value_name = "RPM", default_value_t = 300.0)]
    rpm: f64,
    /// Seed of everything random about the plant.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = crate::args::seed)]
    seed: u64,
    /// Print one JSON document, and nothing else.
    #[arg(long)]
    pub(crate) json: bool,
}

/// What a commissioning found, of all its axes.
struct Found {
    machine: Machine,
    proposed: Machine,
    tuned: Vec<Tuned>,
    /// Servo errors of a trial pass, or why none was made.
    trial: Result<trial::Compared, String>,
    goals: Goals,
    rpm: f64,
    seed: u64,
}

/// Tunes the axes, shows what was found, and writes the machine file if asked.
pub(crate) fn tune(args: &TuneArgs, quiet: bool) -> Result<ExitCode, CliError> {
    let (machine, text) = args.machine.read()?;
    let axes = axes(args, &machine)?;
    let goals = goals(args)?;
    paths(args)?;
    let tuning = Phase::begin("tuning");
    let tuned = rig::bench::all(&machine, &axes, args.seed, &goals)?;
    let proposed = rig::bench::with(&machine, &tuned);
    let trial = trial::compared(&machine, &proposed, &axes, args.seed);
    drop(tuning);
    let failed = trial.as_ref().ok().and_then(trial::Compared::failed_after);
    if let Some(worse) = trial.as_ref().ok().and_then(trial::Compared::worse) {
        tracing::warn!("{worse}; look at the margins that were asked for");
    }
    // A proposal that the machine fails with is shown, but not written.
    let out = args.out.as_ref().filter(|_| failed.is_none());
    if let Some(path) = out {
        let edited = tuned.iter().try_fold(text, |text, one| file::edited(&text, one.axis, &one.proposal))?;
        // What is written is what was tried.
        if Machine::from_toml(&edited).ok().as_ref() != Some(&proposed) {
            return Err(CliError::Machine(format!("{}: the proposal cannot be written", path.display())));
        }
        written::put(path, edited)?;
    }
    let found = Found { machine, proposed, tuned, trial, goals, rpm: args.rpm, seed: args.seed };
    if let Some(path) = &args.page {
        let html = page::html(&again(args), &found);
        written::write(path, Made::Page, html)?;
    }
    if args.json {
        screen::print(&document::json(&found)?);
    } else if !quiet {
        screen::print(&tables::text(&found));
        let written = |name: &str, path: &Option<PathBuf>| {
            path.as_ref().map_or(String::new(), |path| format!("{name:8}{}\n", path.display()))
        };
        let nothing = "nothing is written; -o OUT.toml writes the machine file with these values\n";
        let machine_file =
            if args.out.is_none() { nothing.into() } else { written("written", &out.cloned()) };
        screen::print(&format!("\n{machine_file}{}", written("page", &args.page)));
    }
    match (&args.out, failed) {
        (Some(path), Some(reason)) => Err(CliError::Machine(format!(
            "{} is not written: with the proposal the machine does not make the trial pass {reason}",
            path.display()
        ))),
        _ => Ok(ExitCode::SUCCESS),
    }
}

/// A page must not take the place of a machine file, and nothing that of a file of somebody else.
fn paths(args: &TuneArgs) -> Result<(), CliError> {
    if let Some(out) = &args.out {
        written::new_or(out, args.machine.machine.as_deref())?;
    }
    let absolute = |path: &PathBuf| std::path::absolute(path).unwrap_or_else(|_| path.clone());
    let Some(page) = &args.page else { return Ok(()) };
    let taken = [("-o", &args.out), ("--machine", &args.machine.machine)];
    for (name, path) in taken {
        if path.as_ref().map(absolute) == Some(absolute(page)) {
            let page = page.display();
            return Err(CliError::Input(format!("--page {page} and {name} are one file: name two")));
        }
    }
    written::free(page, Made::Page)
}

/// The axes that are meant.
fn axes(args: &TuneArgs, machine: &Machine) -> Result<Vec<Axis>, CliError> {
    let named = |name: &String| {
        let axis = Axis::from_name(name).filter(|axis| machine.axis.contains_key(axis));
        axis.ok_or_else(|| {
            let all: Vec<_> = machine.axes().map(|(axis, _)| axis.name()).collect();
            CliError::Input(format!("--axis {name}: {} has {}", args.machine.name(), all.join(", ")))
        })
    };
    let mut axes = args.axis.iter().map(named).collect::<Result<Vec<_>, _>>()?;
    if axes.is_empty() {
        return Ok(rig::bench::linear(machine));
    }
    axes.sort_by_key(|axis| axis.index());
    axes.dedup();
    Ok(axes)
}

fn goals(args: &TuneArgs) -> Result<Goals, CliError> {
    for (name, value, low, high) in [
        ("--phase-margin", args.phase_margin, 10.0, 80.0),
        ("--residual", args.residual, 1e-3, 1e3),
        ("--rpm", args.rpm, 0.1, 1e5),
    ] {
        if !(low..=high).contains(&value) {
            return Err(CliError::Input(format!("{name} {value}: must lie between {low} and {high}")));
        }
    }
    Ok(Goals { velocity_phase_deg: args.phase_margin, residual_um: args.residual, ..Goals::default() })
}

/// The command that finds the same again.
fn again(args: &TuneArgs) -> String {
    let machine = args.machine.machine.as_ref();
    let machine = machine.map_or(String::new(), |path| format!(" --machine {}", path.display()));
    let axes: String = args.axis.iter().map(|axis| format!(" --axis {axis}")).collect();
    let TuneArgs { phase_margin, residual, rpm, seed, .. } = args;
    format!(
        "pitchlock tune{machine}{axes} --phase-margin {phase_margin} --residual {residual} --rpm {rpm} --seed {seed}"
    )
}
