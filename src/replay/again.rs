//! `pitchlock replay`: a recorded run is made again, and compared with what was recorded of it.

use std::{path::PathBuf, process::ExitCode};

use clap::Args;
use protocol::Axis;
use rig::trace::{self, Row};

use super::folder::Recorded;
use crate::{error::CliError, screen, words::Phase};

pub(crate) const HELP: &str = "Example:
  pitchlock replay runs/m20x2-1

The modules get again what they got then: the same program, machine file, scenario and seed, and every message in the
control cycle in which it came, in a run in real time too. arrivals.txt of the folder says what came otherwise than in
lock step. A run whose record of that has a gap is refused, with the reason.

Exit status: 0 all of it is the same, bit for bit; 1 it is not, and the first control cycle, module and column that
differ from the trace are named; 2 the run cannot be made again.";

#[derive(Clone, Debug, Args)]
pub(crate) struct ReplayArgs {
    /// A run folder.
    pub(crate) run_dir: PathBuf,
}

/// Makes a run again.
pub(crate) fn replay(args: &ReplayArgs, quiet: bool) -> Result<ExitCode, CliError> {
    let recorded = Recorded::open(&args.run_dir)?;
    let made = Phase::begin("making the run again");
    let (mut machine, mut observer, mut cycles) = (recorded.machine_again()?, recorded.observer(), 0_u64);
    while machine.step(|exchange, seen| {
        if seen {
            observer.cycle(&exchange.record);
            cycles += 1;
        }
    })? {}
    drop(made);
    let again = observer.finish().trace_hash;
    if again == recorded.summary.trace_hash && cycles == recorded.summary.cycles {
        if !quiet {
            let late = recorded.changes();
            screen::print(&format!(
                "the same, bit for bit: {cycles} cycles, {late} changes of what came\ntrace     {again}\n"
            ));
        }
        return Ok(ExitCode::SUCCESS);
    }
    screen::print(&format!(
        "NOT the same: recorded {} cycles, trace {}\n              again    {cycles} cycles, trace {again}\n",
        recorded.summary.cycles, recorded.summary.trace_hash,
    ));
    screen::print(&first_place(&recorded, &args.run_dir)?);
    Ok(ExitCode::FAILURE)
}

/// Where the trace of the folder, as far as it goes, and the run that is made again differ first.
fn first_place(recorded: &Recorded, dir: &std::path::Path) -> Result<String, CliError> {
    let Some(path) = trace::find(dir) else {
        return Ok("there is no trace: where they differ is not known\n".into());
    };
    let (mut machine, mut observer) = (recorded.machine_again()?, recorded.observer());
    let (mut found, mut broken) = (None, None);
    trace::read(&path, |row| {
        let mut again = None;
        while found.is_none()
            && broken.is_none()
            && again.as_ref().is_none_or(|again: &Row| again.cycle < row.cycle)
        {
            let step = machine.step(|exchange, seen| {
                if seen {
                    observer.cycle(&exchange.record);
                    again = Some(Row::of(&exchange.record, &observer, recorded.machine.general.cycle_s));
                }
            });
            match step {
                Ok(true) => {}
                Ok(false) => found = Some((row.cycle, "is not there any more".into())),
                Err(error) => broken = Some(error),
            }
        }
        if let Some((column, [one, other])) = again.and_then(|again| row.first_difference(&again)) {
            let text = format!("{}, {column}: recorded {one:?}, again {other:?}", module_of(&column));
            found = found.take().or(Some((row.cycle, text)));
        }
    })?;
    match (broken, found) {
        (Some(error), _) => Err(error),
        (None, Some((cycle, text))) => Ok(format!("first in cycle {cycle}, {text}\n")),
        (None, None) => Ok("what the trace has of it is the same\n".into()),
    }
}

/// The module that a column of a trace comes from.
fn module_of(column: &str) -> String {
    const COMMANDED: [&str; 7] =
        ["programmed", "commanded", "velocity", "acceleration", "jerk", "servo_error", "state"];
    let split = column.split_once('_').and_then(|(axis, rest)| Some((Axis::from_name(axis)?, rest)));
    match split {
        Some((axis, rest)) if COMMANDED.contains(&rest) => format!("regulator-{}", axis.name()),
        _ if ["pass", "line", "tool", "motion", "trace"].contains(&column) => "interpolator".into(),
        _ => "sim-plant".into(),
    }
}
