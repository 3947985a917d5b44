//! M codes of one machine: what a chip conveyor, a door or a chamfer switch is told by part programs. In: the
//! table `[m_codes]` of the machine file. Out: by number, what the control does with the code.

use protocol::Set;
use serde::{Deserialize, Serialize};

use crate::{Machine, MachineError, OutputRefused, ProgramDialect, refuse};

/// Codes that the control has for itself.
const OWN: [u16; 14] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 19, 30, 98, 99];
/// Highest number of an M code.
const HIGHEST: u16 = 999;

/// What the control does with an M code of this machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "Written", into = "Written")]
pub enum MachineCode {
    /// Nothing: what it switches is of no concern to the part.
    Ignore,
    /// Waits for cycle start, as M0 does: somebody does by hand what it asks.
    Wait,
    /// Switches a digital output, as M64 and M65 do.
    Output {
        /// Its number in `[outputs]`.
        number: u32,
        /// Whether it is on from then on.
        value: bool,
    },
}

/// A code as it stands in the file.
#[derive(Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected \"ignore\", \"wait\", or { does = \"output\", number = 3, value = true }"
)]
enum Written {
    Word(Word),
    Deed { does: Deed, number: u32, value: Value },
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Word {
    Ignore,
    Wait,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Deed {
    Output,
}

/// `true`, `false`, `"on"`, `"off"`.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Value {
    Truth(bool),
    Word(Switch),
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Switch {
    On,
    Off,
}

impl From<Written> for MachineCode {
    fn from(written: Written) -> MachineCode {
        match written {
            Written::Word(Word::Ignore) => MachineCode::Ignore,
            Written::Word(Word::Wait) => MachineCode::Wait,
            Written::Deed { does: Deed::Output, number, value } => {
                let value = matches!(value, Value::Truth(true) | Value::Word(Switch::On));
                MachineCode::Output { number, value }
            }
        }
    }
}

impl From<MachineCode> for Written {
    fn from(code: MachineCode) -> Written {
        match code {
            MachineCode::Ignore => Written::Word(Word::Ignore),
            MachineCode::Wait => Written::Word(Word::Wait),
            MachineCode::Output { number, value } => {
                Written::Deed { does: Deed::Output, number, value: Value::Truth(value) }
            }
        }
    }
}

/// The number of a code, if it can be declared.
pub(crate) fn number(key: &str) -> Option<u16> {
    key.parse().ok().filter(|number| *number <= HIGHEST && !OWN.contains(number))
}

/// The dialect that has a code for itself, if the machine reads no other.
fn taken(code: u16, machine: &Machine) -> Option<&'static str> {
    match (machine.general.dialect, code) {
        (ProgramDialect::Linuxcnc, 48..=53 | 60..=68 | 70..=73) => Some("LinuxCNC"),
        (ProgramDialect::Fanuc, 97) => Some("FANUC"),
        _ => None,
    }
}

/// Refuses keys that are no numbers, or those of codes that the control has for itself, and outputs that the
/// machine lacks.
pub(crate) fn check(machine: &Machine) -> Result<(), MachineError> {
    let codes = &machine.m_codes;
    if let Some(key) = codes.keys().find(|key| number(key).is_none()) {
        return Err(refuse(
            "m_codes",
            key,
            "a code is declared by its number, 10 to 999, as in 31 = \"ignore\"; what the control has for itself, \
             such as M3, M8, M19, M30, cannot be declared",
        ));
    }
    if let Some((key, dialect)) = codes.keys().find_map(|key| Some((key, taken(number(key)?, machine)?))) {
        return Err(refuse(
            "m_codes",
            key,
            &format!(
                "it would never act: {dialect} has M{key} for itself, and goes first. Leave it out, or set \
                 machine.dialect to what the programs are written in"
            ),
        ));
    }
    let lacking = codes.iter().find_map(|(key, code)| match code {
        MachineCode::Output { number, value } => {
            Some((key, number, machine.refuses_output(*number, Set::Digital(*value), false)?))
        }
        _ => None,
    });
    match lacking {
        Some((key, number, OutputRefused { message, help, .. })) => {
            Err(refuse(&format!("m_codes.{key}.number"), number, &format!("{message}: {help}")))
        }
        None => Ok(()),
    }
}
