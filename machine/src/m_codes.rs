//! M codes of one machine: what a chip conveyor, a door or a chamfer switch is told by part programs. In: the
//! table `[m_codes]` of the machine file. Out: by number, what the control does with the code.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::{MachineError, refuse};

/// Codes that the control has for itself.
const OWN: [u16; 14] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 19, 30, 98, 99];
/// Highest number of an M code.
const HIGHEST: u16 = 999;

/// What the control does with an M code of this machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum MachineCode {
    /// Nothing: what it switches is of no concern to the part.
    Ignore,
    /// Waits for cycle start, as M0 does: somebody does by hand what it asks.
    Wait,
}

/// The number of a code, if it can be declared.
pub(crate) fn number(key: &str) -> Option<u16> {
    key.parse().ok().filter(|number| *number <= HIGHEST && !OWN.contains(number))
}

/// Refuses keys that are no numbers, or those of codes that the control has for itself.
pub(crate) fn check(codes: &BTreeMap<String, MachineCode>) -> Result<(), MachineError> {
    match codes.keys().find(|key| number(key).is_none()) {
        Some(key) => Err(refuse(
            "m_codes",
            key,
            "a code is declared by its number, 10 to 999, as in 31 = \"ignore\"; what the control has for itself, \
             such as M3, M8, M19, M30, cannot be declared",
        )),
        None => Ok(()),
    }
}
