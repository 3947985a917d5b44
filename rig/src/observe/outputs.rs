//! Outputs, and when each of them changed. In: the machine status of every control cycle. Out: an
//! [`OutputReport`] or an [`AnalogReport`] of each change.

use std::collections::BTreeMap;

use machine::{ANALOG_OUTPUTS, Machine, OUTPUTS};
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

/// A change of an analog output.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AnalogReport {
    /// Its number.
    pub number: u32,
    /// What it sets, as the machine file says; empty if it does not.
    pub name: String,
    /// Its value from this cycle on, in the unit of the machine file.
    pub value: f64,
    /// Line of the part program, as of an [`OutputReport`].
    pub line: u32,
    /// Control cycle: the tick of the interpolator that set it.
    pub cycle: u64,
}

/// Watches the outputs of a run. Those that are on at the start are its first changes.
#[derive(Clone, Default)]
pub(super) struct Outputs {
    names: BTreeMap<u32, String>,
    analog_names: [String; ANALOG_OUTPUTS],
    before: u64,
    seen: Vec<OutputReport>,
    analog_before: [f64; ANALOG_OUTPUTS],
    analog: Vec<AnalogReport>,
}

impl Outputs {
    pub(super) fn of(machine: &Machine) -> Outputs {
        let name = |number| Some((number, machine.output(number)?.name.clone()));
        let analog = |number: usize| Some(machine.analog_output(number as u32)?.name.clone());
        Outputs {
            names: (0..OUTPUTS).filter_map(name).collect(),
            analog_names: std::array::from_fn(|number| analog(number).unwrap_or_default()),
            ..Outputs::default()
        }
    }

    /// Takes one control cycle.
    pub(super) fn cycle(&mut self, status: &MachineStatus) {
        for (number, value) in status.analog.into_iter().enumerate() {
            if std::mem::replace(&mut self.analog_before[number], value) != value {
                let name = self.analog_names[number].clone();
                let number = number as u32;
                self.analog.push(AnalogReport {
                    number,
                    name,
                    value,
                    line: status.line,
                    cycle: status.cycle.0,
                });
            }
        }
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
    pub(super) fn finish(self) -> (Vec<OutputReport>, Vec<AnalogReport>) {
        (self.seen, self.analog)
    }
}
