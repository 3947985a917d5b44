//! Digital inputs. In: the table `[inputs]` of the machine file. Out: which there are, and what each of them
//! shows before anything happens.

use serde::{Deserialize, Serialize};

use crate::{Machine, MachineError, outputs};

/// How many digital inputs a machine has at most: they are numbered from 0.
pub const INPUTS: u32 = protocol::INPUTS as u32;

/// A digital input.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// What it tells, for people.
    pub name: String,
    /// Whether it is on at the simulated machine before anything happens.
    #[serde(default)]
    pub initial: bool,
}

/// Refuses a table that names no inputs.
pub(crate) fn check(machine: &Machine) -> Result<(), MachineError> {
    outputs::check_names("inputs", INPUTS, machine.inputs.iter().map(|(key, one)| (key, &one.name)))
}

impl Machine {
    /// The input of a number.
    pub fn input(&self, wanted: u32) -> Option<&Input> {
        self.inputs.get(&wanted.to_string())
    }

    /// The inputs for which something holds: bit n is input n.
    pub fn inputs_with(&self, holds: fn(&Input) -> bool) -> u64 {
        let those = self.inputs.iter().filter(|(_, input)| holds(input));
        those.filter_map(|(key, _)| outputs::number(key, INPUTS)).fold(0, |sum, number| sum | 1 << number)
    }
}
