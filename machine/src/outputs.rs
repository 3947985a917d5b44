//! Digital outputs. In: the table `[outputs]` of the machine file. Out: what each of them is at the start and
//! when the program is over.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::{Machine, MachineError, refuse};

/// How many digital outputs a machine has at most: they are numbered from 0.
pub const OUTPUTS: u32 = 64;

/// A digital output.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Output {
    /// What it switches, for people.
    pub name: String,
    /// Whether it is on before the program begins.
    #[serde(default)]
    pub initial: bool,
    /// Whether it is on once the program is over, however it ended.
    #[serde(default)]
    pub safe: bool,
}

/// The number of an output, if it can be declared.
pub(crate) fn number(key: &str) -> Option<u32> {
    key.parse().ok().filter(|number: &u32| *number < OUTPUTS && number.to_string() == key)
}

/// The remedy where an output is not declared.
pub fn declare(number: u32) -> String {
    if number < OUTPUTS {
        format!("add [outputs.{number}] and below it name = \"what it switches\"")
    } else {
        format!("outputs are numbered from 0 to {}", OUTPUTS - 1)
    }
}

/// Refuses keys that are no numbers of outputs.
pub(crate) fn check(outputs: &BTreeMap<String, Output>) -> Result<(), MachineError> {
    match outputs.keys().find(|key| number(key).is_none()) {
        Some(key) => {
            Err(refuse("outputs", key, "an output is declared by its number, 0 to 63, as in [outputs.3]"))
        }
        None => Ok(()),
    }
}

impl Machine {
    /// The output of a number.
    pub fn output(&self, wanted: u32) -> Option<&Output> {
        self.outputs.iter().find(|(key, _)| number(key) == Some(wanted)).map(|(_, output)| output)
    }

    /// The outputs that are on before the program begins, and those that are on once it is over: bit n is
    /// output n.
    pub fn outputs_on(&self) -> [u64; 2] {
        let sum = |on: fn(&Output) -> bool| {
            let on = self.outputs.iter().filter(|(_, output)| on(output));
            on.filter_map(|(key, _)| number(key)).fold(0, |sum, number| sum | 1 << number)
        };
        [sum(|output| output.initial), sum(|output| output.safe)]
    }
}
