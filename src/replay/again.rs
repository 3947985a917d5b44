//! `pitchlock replay`: a recorded run is made again, and compared with what was recorded of it.

use std::{path::PathBuf, process::ExitCode};

use clap::Args;
use protocol::Axis;
use rig::trace::{self, Row};
use serde_json::json;

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
    /// Print one JSON document, and nothing else.
    #[arg(long)]
    pub(crate) json: bool,
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
    let observed = observer.finish();
    let again = observed.trace_hash.clone();
    let equal = again == recorded.summary.trace_hash && cycles == recorded.summary.cycles;
    if args.json {
        let first = if equal { None } else { find_first(&recorded, &args.run_dir)? };
        let document = json!({
            "version": 1,
            "equal": equal,
            "first": first.map(|First { cycle, module, text }| json!({ "cycle": cycle, "module": module, "field": text })),
            "recorded": { "cycles": recorded.summary.cycles, "trace_hash": recorded.summary.trace_hash },
            "again": { "cycles": cycles, "trace_hash": again, "changes": recorded.changes(), "outputs": observed.outputs,
                       "analog_outputs": observed.analog_outputs, "inputs": observed.inputs },
        });
        screen::print(&format!("{document:#}\n"));
        return Ok(if equal { ExitCode::SUCCESS } else { ExitCode::FAILURE });
    }
    if equal {
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

/// Where the trace of a folder and the run that is made again differ first.
struct First {
    cycle: u64,
    /// The module, where it is known.
    module: Option<String>,
    /// The column, and what stands in it.
    text: String,
}

/// The same as a line.
fn first_place(recorded: &Recorded, dir: &std::path::Path) -> Result<String, CliError> {
    if trace::find(dir).is_none() {
        return Ok("there is no trace: where they differ is not known\n".into());
    }
    Ok(match find_first(recorded, dir)? {
        Some(First { cycle, module: Some(module), text }) => {
            format!("first in cycle {cycle}, {module}, {text}\n")
        }
        Some(First { cycle, module: None, text }) => format!("first in cycle {cycle}, {text}\n"),
        None => "what the trace has of it is the same\n".into(),
    })
}

/// Looks for it, as far as the trace goes; none where there is no trace.
fn find_first(recorded: &Recorded, dir: &std::path::Path) -> Result<Option<First>, CliError> {
    let Some(path) = trace::find(dir) else { return Ok(None) };
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
                Ok(false) => {
                    let text = "is not there any more".into();
                    found = Some(First { cycle: row.cycle, module: None, text });
                }
                Err(error) => broken = Some(error),
            }
        }
        if let Some((column, [one, other])) = again.and_then(|again| row.first_difference(&again)) {
            let (module, text) = (module_of(&column), format!("{column}: recorded {one:?}, again {other:?}"));
            found = found.take().or(Some(First { cycle: row.cycle, module: Some(module), text }));
        }
    })?;
    match broken {
        Some(error) => Err(error),
        None => Ok(found),
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
