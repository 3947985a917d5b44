//! What a hall sees of a machine. In: a control cycle, what the observer knows of the run. Out: a small
//! document.

use protocol::MachineState;
use rig::observe::{FaultReport, Observer, Record};
use serde_json::{Value, json};

use crate::{panel::Mode, run::Setup};

/// Faults that are told: the newest.
const MOST_FAULTS: usize = 5;

/// A machine on which nothing runs.
pub(super) fn off(machine: &str) -> Value {
    json!({ "machine": machine, "mode": Mode::Off.name() })
}

/// One that runs a program.
pub(crate) fn seen(setup: &Setup, record: &Record, observer: &Observer) -> Value {
    let Record { truth, machine, .. } = record;
    let cycle = truth.cycle.0;
    let faults = observer.faults();
    let fault = |fault: &FaultReport| json!({ "cycle": fault.cycle, "code": fault.code, "text": fault.text });
    json!({
        "machine": setup.machine.general.name,
        "mode": Mode::of(record, None).name(),
        "program": setup.folder.program.file_name().map(|name| name.to_string_lossy()),
        "cycle": cycle,
        "time_s": cycle as f64 * setup.machine.general.cycle_s,
        "line": machine.line,
        "pass": (machine.state() == MachineState::Threading).then_some(machine.pass),
        "passes": [observer.passes().len(), setup.program.passes()],
        "faults": faults[faults.len().saturating_sub(MOST_FAULTS)..].iter().map(fault).collect::<Vec<_>>(),
    })
}
