//! The machine in this process.

use process::ipc::time::Moment;
use protocol::operator::Request;
use rig::{Rig, observe::Summary};

use super::{Setup, interrupts::Interrupts, processes::complete, recorder::Recorder};
use crate::error::CliError;

/// Control cycles between two looks at the keyboard.
const LOOK_EVERY: u64 = 256;

/// Runs the machine to its end. The first Ctrl-C presses stop, the second breaks off.
pub(crate) fn run(setup: &Setup) -> Result<Summary, CliError> {
    let mut interrupts = Interrupts::catch()?;
    let begun = Moment::now();
    let items = setup.program.items(&setup.folder.program, &setup.folder.language, &setup.machine)?;
    let mut rig = Rig::new(&setup.machine, items, setup.scenario.clone(), setup.seed)
        .map_err(|error| CliError::Input(format!("machine file: {error}")))?;
    let mut recorder = Recorder::new(setup)?;
    let mut cycle = 0;
    let mut request = None;
    while rig.cycle(request.take(), |record| recorder.cycle(record)) {
        cycle += 1;
        if cycle % LOOK_EVERY == 0 && interrupts.came() {
            if interrupts.count() > 1 {
                break;
            }
            request = Some(Request::Stop);
        }
    }
    for event in rig.pending_events() {
        tracing::warn!("event {event} of the scenario did not happen: its moment never came");
    }
    let summary = recorder.finish(&setup.folder.named, setup.clock)?;
    Ok(complete(summary, setup, begun))
}
