//! Digital outputs, and when each of them changed. In: the machine status of every control cycle. Out: an
//! [`OutputReport`] of each change.

use std::collections::BTreeMap;

use machine::{Machine, OUTPUTS};
use protocol::MachineStatus;
use serde::{Deserialize, Serialize};

/// A change of a digital output.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct OutputReport {
    /// Its number.
    pub number: u32,
    /// What it switches, as the machine file says; empty if it does not.
    pub name: String,
    /// Whether it is on from this cycle on.
    pub on: bool,
    /// Line of the part program that is executed in this cycle: that of a move, if it begins with it. 0
    /// before the program begins.
    pub line: u32,
    /// Control cycle: the tick of the interpolator that switched it.
    pub cycle: u64,
}

/// Watches the outputs of a run. Those that are on at the start are its first changes.
#[derive(Clone, Default)]
pub(super) struct Outputs {
    names: BTreeMap<u32, String>,
    before: u64,
    seen: Vec<OutputReport>,
}

impl Outputs {
    pub(super) fn of(machine: &Machine) -> Outputs {
        let name = |number| Some((number, machine.output(number)?.name.clone()));
        Outputs { names: (0..OUTPUTS).filter_map(name).collect(), ..Outputs::default() }
    }

    /// Takes one control cycle.
    pub(super) fn cycle(&mut self, status: &MachineStatus) {
        let (on, line, cycle) = (status.outputs, status.line, status.cycle.0);
        let mut changed = std::mem::replace(&mut self.before, on) ^ on;
        while changed != 0 {
            let number = changed.trailing_zeros();
            changed &= changed - 1;
            let name = self.names.get(&number).cloned().unwrap_or_default();
            self.seen.push(OutputReport { number, name, on: on >> number & 1 == 1, line, cycle });
        }
    }

    /// The changes in the order of their coming; of one cycle in the order of their numbers.
    pub(super) fn finish(self) -> Vec<OutputReport> {
        self.seen
    }
}
