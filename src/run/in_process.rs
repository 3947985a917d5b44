//! The machine in this process.

use process::ipc::{Process, time::Moment};
use protocol::{Doom, operator::Request};
use rig::{
    Rig,
    observe::{Record, Summary},
    supervisor::Supervisor,
};

use super::{
    Setup,
    endings::{Death, Endings},
    interrupts::{Interrupts, Wish},
    processes::complete,
    recorder::Recorder,
};
use crate::error::CliError;

/// Control cycles between two looks at the keyboard.
const LOOK_EVERY: u64 = 256;

/// Runs the machine to its end. Ctrl-C does what it does to processes.
pub(crate) fn run(setup: &Setup) -> Result<Summary, CliError> {
    let mut interrupts = Interrupts::catch()?;
    let begun = Moment::now();
    let items = setup.program.items(&setup.folder.program, &setup.folder.language, &setup.machine)?;
    let mut rig = Rig::new(&setup.machine, items, setup.scenario.clone(), setup.seed)
        .map_err(|error| CliError::Input(format!("machine file: {error}")))?;
    let mut recorder = Recorder::new(setup)?;
    let mut supervisor = Supervisor::new(&setup.machine, &setup.program.watched);
    let mut endings = Endings::default();
    let (mut cycle, mut wish) = (0, Wish::None);
    let mut request = None;
    loop {
        let asked = request.take();
        let mut wanted = None;
        let goes_on = rig.cycle(asked, |record| {
            recorder.cycle(record);
            wanted = doomed(record, &mut supervisor, &mut endings).or(supervisor.cycle(record));
        });
        request = wanted;
        cycle += 1;
        if cycle % LOOK_EVERY == 0 && interrupts.wish() != wish {
            let before = std::mem::replace(&mut wish, interrupts.wish());
            request = match wish {
                Wish::EmergencyStop => supervisor.emergency_stop(),
                _ if before == Wish::None => Some(Request::Stop),
                _ => request,
            };
        }
        if wish == Wish::End {
            endings.broken_off();
        }
        if !goes_on || wish == Wish::End || supervisor.end().is_some() {
            break;
        }
    }
    endings.ends(supervisor.end());
    for event in rig.pending_events() {
        tracing::warn!("event {event} of the scenario did not happen: its moment never came");
    }
    let mut summary = recorder.finish(&setup.folder.named, setup.clock)?;
    endings.tell(&mut summary);
    Ok(complete(summary, setup, begun))
}

/// What the scenario does to a module. One that is frozen counts as dead: so it does for all others.
fn doomed(record: &Record, supervisor: &mut Supervisor, endings: &mut Endings) -> Option<Request> {
    let (doom, module) = record.truth.doom()?;
    let process = Process::of(module);
    if doom == Doom::Thaw || endings.has_died(process) {
        return None;
    }
    if doom == Doom::Freeze {
        endings.frozen(process);
    }
    let cycle = record.truth.cycle.0;
    endings.died(Death { process, ending: "was killed by the scenario".into(), cycle, over: false });
    supervisor.died(module)
}
