//! M codes of one machine: what a chip conveyor, a door or a chamfer switch is told by part programs. In: the
//! table `[m_codes]` of the machine file. Out: by number, what the control does with the code.

use protocol::{Code, Set, Until};
use serde::{Deserialize, Serialize};

use crate::{Kinematics, Machine, MachineError, ProgramDialect, SignalRefused, refuse};

/// Codes that the control has for itself.
const OWN: [u16; 13] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 30, 98, 99];
/// Longest wait for an input, s.
pub(crate) const LONGEST_WAIT_S: f64 = 86_400.0;
/// Highest number of an M code.
const HIGHEST: u16 = 999;

/// What the control does with an M code of this machine.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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
    /// Waits for a digital input, as M66 does.
    Input {
        /// Its number in `[inputs]`.
        number: u32,
        /// For what.
        until: Until,
        /// For so long at most, s.
        within_s: f64,
    },
}

/// A code as it stands in the file.
#[derive(Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected \"ignore\", \"wait\", { does = \"output\", number = 3, value = true }, or { does = \"wait-input\", \
                 number = 2, until = \"high\", within_s = 5 }"
)]
enum Written {
    Word(Word),
    Output { does: Switches, number: u32, value: Value },
    Input { does: Waits, number: u32, until: Wanted, within_s: f64 },
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Word {
    Ignore,
    Wait,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Switches {
    Output,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Waits {
    WaitInput,
}

/// [`Until`] as it is written.
#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Wanted {
    Rise,
    Fall,
    High,
    Low,
}

/// Each of them as the machine has it.
const WANTED: [(Wanted, Until); 4] = [
    (Wanted::Rise, Until::Rise),
    (Wanted::Fall, Until::Fall),
    (Wanted::High, Until::High),
    (Wanted::Low, Until::Low),
];

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
            Written::Output { number, value, .. } => {
                let value = matches!(value, Value::Truth(true) | Value::Word(Switch::On));
                MachineCode::Output { number, value }
            }
            Written::Input { number, until, within_s, .. } => {
                MachineCode::Input { number, until: WANTED[until as usize].1, within_s }
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
                Written::Output { does: Switches::Output, number, value: Value::Truth(value) }
            }
            MachineCode::Input { number, until, within_s } => {
                let until = WANTED[until as usize].0;
                Written::Input { does: Waits::WaitInput, number, until, within_s }
            }
        }
    }
}

impl MachineCode {
    /// What the machine makes of it, if it is for an output or an input.
    fn code(self) -> Option<Code> {
        let number = |number: u32| u8::try_from(number).unwrap_or(u8::MAX);
        match self {
            MachineCode::Ignore | MachineCode::Wait => None,
            MachineCode::Output { number: output, value } => {
                Some(Code::Output { number: number(output), set: Set::Digital(value), in_step: false })
            }
            MachineCode::Input { number: input, until, within_s } => {
                Some(Code::Await { input: number(input), until, within_s })
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
        (ProgramDialect::Linuxcnc, 19 | 48..=53 | 60..=68 | 70..=73) => Some("LinuxCNC"),
        (ProgramDialect::Fanuc, 97) => Some("FANUC"),
        (ProgramDialect::Fanuc, 19) if machine.general.kinematics == Kinematics::Mill => Some("FANUC"),
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
             such as M3, M8, M30, cannot be declared",
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
    for (key, code) in codes {
        if let MachineCode::Input { within_s, .. } = code
            && !(*within_s > 0.0 && *within_s <= LONGEST_WAIT_S)
        {
            let say = format!("give the longest wait in s, above 0 and up to {LONGEST_WAIT_S}");
            return Err(refuse(&format!("m_codes.{key}.within_s"), within_s, &say));
        }
        if let Some(SignalRefused { message, help, .. }) = code.code().and_then(|code| machine.refuses(&code))
        {
            let number = match code {
                MachineCode::Output { number, .. } | MachineCode::Input { number, .. } => *number,
                MachineCode::Ignore | MachineCode::Wait => 0,
            };
            return Err(refuse(&format!("m_codes.{key}.number"), number, &format!("{message}: {help}")));
        }
    }
    Ok(())
}
