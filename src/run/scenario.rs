//! The scenario of a run. In: arguments. Out: what happens to the machine meanwhile, and the text that says
//! so; or why the machine cannot play it in the way it is run.

use std::path::PathBuf;

use machine::Machine;
use process::shell::{Clock, Pace};

use super::args::RunArgs;
use crate::error::CliError;

/// Refuses what the machine cannot play in the way it is run.
pub(super) fn can_be_played(scenario: &sim_plant::Scenario, args: &RunArgs) -> Result<(), CliError> {
    let input = |text: String| Err(CliError::Input(text));
    if args.in_process && args.clock.clock() == Clock::Real {
        return input("--in-process runs in virtual time only; leave out --clock real".into());
    }
    if args.processes && args.clock.clock() == Clock::Virtual {
        return input(
            "in lock step each module has a process of its own: leave out --processes, or add --clock real"
                .into(),
        );
    }
    if args.in_process && args.with_panel {
        return input("the panel is of a machine of processes: leave out --in-process".into());
    }
    if args.clock.clock() == Clock::Real && args.pace.is_some_and(Pace::waits) {
        return input(
            "--pace is of virtual time; in real time the pace is 1: leave out --pace, or --clock real".into(),
        );
    }
    match (scenario.needs_one_process(), scenario.needs_time_to_go_on()) {
        (Some(event), _) if !args.in_process => input(format!(
            "event {event} of the scenario: messages between processes cannot be disturbed; add --in-process"
        )),
        (_, Some(event)) if !args.in_process && args.clock.clock() == Clock::Virtual => input(format!(
            "event {event} of the scenario: in lock step all processes wait for one that is frozen, so for_s \
             never passes; add --in-process or --clock real, or leave out for_s"
        )),
        _ => Ok(()),
    }
}

/// What `--single-block` adds to the scenario.
const SINGLE_BLOCK: &str = "[[event]]\nat = { cycle = 0 }\nsingle_block = true\n";

/// What the scenario says of the panel, if anything.
const AT_THE_PANEL: &str = "panel = ";

/// Reads it, and adds what arguments say besides.
///
/// # Errors
/// Names the file, the event, the key.
pub(crate) fn read_scenario(
    args: &RunArgs,
    machine: &Machine,
) -> Result<(sim_plant::Scenario, Option<String>), CliError> {
    let given = args.scenario.as_ref();
    let read =
        |path: &PathBuf| intake::text(path, intake::SETTINGS).map_err(|error| CliError::file(path, error));
    let mut text = given.map(read).transpose()?;
    if args.single_block {
        text = Some(text.map_or_else(String::new, |text| text + "\n") + SINGLE_BLOCK);
    }
    let presses = args.presses.as_ref().map(read).transpose()?;
    let at_the_panel = match (args.with_panel, &presses) {
        (true, _) => Some("live"),
        (false, Some(_)) => Some("recorded"),
        (false, None) => None,
    };
    if let Some(who) = at_the_panel {
        let text_before = text.unwrap_or_default();
        let events = text_before.lines().filter(|line| !line.starts_with(AT_THE_PANEL));
        let events = events.map(|line| format!("{line}\n")).collect::<String>();
        text = Some(format!("{AT_THE_PANEL}\"{who}\"\n{events}{}", presses.unwrap_or_default()));
    }
    let wrong = |error: &dyn std::fmt::Display| {
        let name = given.map_or("scenario".into(), |path| path.display().to_string());
        CliError::Input(format!("{name}: {error}"))
    };
    let scenario = sim_plant::Scenario::from_toml(text.as_deref().unwrap_or_default());
    let scenario = scenario.map_err(|error| wrong(&error))?;
    // Alone the machine can be built: its file has been read.
    sim_plant::Plant::new(machine, scenario.clone(), 1).map_err(|error| wrong(&error))?;
    Ok((scenario, text))
}
