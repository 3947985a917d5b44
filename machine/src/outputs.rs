//! Outputs. In: the tables `[outputs]` and `[analog_outputs]` of the machine file. Out: what each of them is
//! at the start and when the program is over.

use std::collections::BTreeMap;

use protocol::{Code, Set};
use serde::{Deserialize, Serialize};

use crate::{INPUTS, Machine, MachineError, refuse};

/// How many digital outputs a machine has at most: they are numbered from 0.
pub const OUTPUTS: u32 = protocol::OUTPUTS as u32;
/// How many analog ones.
pub const ANALOG_OUTPUTS: usize = protocol::ANALOG_OUTPUTS as usize;

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
    /// Whether it changes only while the axes and the spindle stand: a chuck, a door.
    #[serde(default)]
    pub standstill: bool,
}

/// An analog output.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AnalogOutput {
    /// What it sets, for people.
    pub name: String,
    /// Its unit, for people.
    #[serde(default)]
    pub unit: String,
    /// Its least and largest value.
    pub range: [f64; 2],
    /// Its value before the program begins.
    pub initial: f64,
    /// Its value once the program is over, however it ended.
    pub safe: f64,
}

impl AnalogOutput {
    /// Whether it can be set to a value.
    pub fn takes(&self, value: f64) -> bool {
        (self.range[0]..=self.range[1]).contains(&value)
    }
}

/// The number of what is numbered from 0 to one less than `most`, if the key is one.
pub(crate) fn number(key: &str, most: u32) -> Option<u32> {
    key.parse().ok().filter(|number: &u32| *number < most && number.to_string() == key)
}

/// What is wrong with setting an output, or with waiting for an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SignalFault {
    /// The machine file does not have it.
    Unknown,
    /// It changes at standstill only, and is asked to in step with motion.
    NeedsStandstill,
    /// The value is outside its range.
    OutOfRange,
}

/// Why an output cannot be set, or an input not be waited for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SignalRefused {
    /// What kind of refusal it is.
    pub fault: SignalFault,
    /// What is wrong.
    pub message: String,
    /// The remedy.
    pub help: String,
}

fn unknown(what: &str, table: &str, number: u8, most: u32, keys: &str) -> SignalRefused {
    let number = u32::from(number);
    let help = match number < most {
        true => format!("add [{table}.{number}] and below it {keys}"),
        false => format!("they are numbered from 0 to {}", most - 1),
    };
    SignalRefused {
        fault: SignalFault::Unknown,
        message: format!("{what} {number} is not in the machine file"),
        help,
    }
}

/// Refuses keys of a table that are no numbers below `most`, and names by which people could not tell one
/// from another.
pub(crate) fn check_names<'a>(
    table: &str,
    most: u32,
    names: impl Iterator<Item = (&'a String, &'a String)>,
) -> Result<(), MachineError> {
    let mut known: BTreeMap<&str, &str> = BTreeMap::new();
    for (key, name) in names {
        if number(key, most).is_none() {
            let say =
                format!("each is declared by its number, 0 to {}: write [{table}.0] for the first", most - 1);
            return Err(refuse(table, key, &say));
        }
        let place = format!("{table}.{key}.name");
        if name.trim().is_empty() {
            return Err(refuse(&place, name, "say what it is: messages and reports call it so"));
        }
        if let Some(other) = known.insert(name.trim(), key) {
            let say = format!("[{table}.{other}] has this name already: give each its own");
            return Err(refuse(&place, name, &say));
        }
    }
    Ok(())
}

/// Refuses tables that name no outputs.
pub(crate) fn check(machine: &Machine) -> Result<(), MachineError> {
    check_names("outputs", OUTPUTS, machine.outputs.iter().map(|(key, one)| (key, &one.name)))?;
    let analog = &machine.analog_outputs;
    check_names("analog_outputs", ANALOG_OUTPUTS as u32, analog.iter().map(|(key, one)| (key, &one.name)))?;
    for (key, one) in analog {
        let [low, high] = one.range;
        if !(low.is_finite() && high.is_finite() && low < high) {
            let say = "give its least and its largest value, the least first";
            return Err(refuse(&format!("analog_outputs.{key}.range"), format!("{:?}", one.range), say));
        }
        for (name, value) in [("initial", one.initial), ("safe", one.safe)] {
            if !one.takes(value) {
                let say = format!("it must be within the range, {low} to {high}");
                return Err(refuse(&format!("analog_outputs.{key}.{name}"), value, &say));
            }
        }
    }
    Ok(())
}

impl Machine {
    /// The output of a number.
    pub fn output(&self, wanted: u32) -> Option<&Output> {
        self.outputs.get(&wanted.to_string())
    }

    /// The analog output of a number.
    pub fn analog_output(&self, wanted: u32) -> Option<&AnalogOutput> {
        self.analog_outputs.get(&wanted.to_string())
    }

    /// Why an output cannot be set or an input be waited for, if so it is.
    pub fn refuses(&self, code: &Code) -> Option<SignalRefused> {
        let (number, set, in_step) = match *code {
            Code::Output { number, set, in_step } => (number, set, in_step),
            Code::Await { input, .. } if self.input(input.into()).is_none() => {
                return Some(unknown("input", "inputs", input, INPUTS, "name = \"what it tells\""));
            }
            _ => return None,
        };
        let (fault, message, help) = match (
            set,
            self.output(number.into()),
            self.analog_output(number.into()),
        ) {
            (Set::Digital(_), None, _) => {
                return Some(unknown("output", "outputs", number, OUTPUTS, "name = \"what it switches\""));
            }
            (Set::Analog(_), _, None) => {
                let (most, keys) = (ANALOG_OUTPUTS as u32, "name, range, initial and safe");
                return Some(unknown("analog output", "analog_outputs", number, most, keys));
            }
            (Set::Digital(_), Some(output), _) if output.standstill && in_step => (
                SignalFault::NeedsStandstill,
                format!("output {number}, {}, changes at standstill only, and the axes move", output.name),
                "switch it with M64 or M65: standstill = true in the machine file asks for that".into(),
            ),
            (Set::Analog(value), _, Some(output)) if !output.takes(value) => {
                let [low, high] = output.range;
                (
                    SignalFault::OutOfRange,
                    format!("analog output {number}, {}, cannot be {value}", output.name),
                    format!(
                        "give {low} to {high}, or change analog_outputs.{number}.range of the machine file"
                    ),
                )
            }
            _ => return None,
        };
        Some(SignalRefused { fault, message, help })
    }

    /// The outputs for which something holds: bit n is output n.
    pub fn outputs_with(&self, holds: fn(&Output) -> bool) -> u64 {
        let those = self.outputs.iter().filter(|(_, output)| holds(output));
        those.filter_map(|(key, _)| number(key, OUTPUTS)).fold(0, |sum, number| sum | 1 << number)
    }

    /// A value of every analog output, 0 for one that does not exist.
    pub fn analog_outputs_at(&self, value: fn(&AnalogOutput) -> f64) -> [f64; ANALOG_OUTPUTS] {
        std::array::from_fn(|number| self.analog_output(number as u32).map_or(0.0, value))
    }
}
