//! Outputs and inputs, and when each of them changed. In: the machine status and the measurement of every
//! control cycle. Out: a [`SignalReport`] or an [`AnalogReport`] of each change.

use std::collections::BTreeMap;

use machine::{ANALOG_OUTPUTS, INPUTS, Machine, OUTPUTS};
use protocol::{MachineStatus, Measurement};
use serde::{Deserialize, Serialize};

/// A change of a digital output or input.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SignalReport {
    /// Its number.
    pub number: u32,
    /// What it is, as the machine file says; empty if it does not.
    pub name: String,
    /// Whether it is on from this cycle on.
    pub on: bool,
    /// Line of the part program that is executed in this cycle: that of a move, if it begins with it. 0
    /// before the program begins.
    pub line: u32,
    /// Control cycle: the tick of the interpolator that switched an output; the first that shows an input so.
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
    /// Line of the part program, as of an [`SignalReport`].
    pub line: u32,
    /// Control cycle: the tick of the interpolator that set it.
    pub cycle: u64,
}

/// Watches digital outputs, or digital inputs. Those that are on at the start are the first changes.
#[derive(Clone, Default)]
struct Signals {
    names: BTreeMap<u32, String>,
    before: u64,
    seen: Vec<SignalReport>,
}

impl Signals {
    fn cycle(&mut self, on: u64, line: u32, cycle: u64) {
        let mut changed = std::mem::replace(&mut self.before, on) ^ on;
        while changed != 0 {
            let number = changed.trailing_zeros();
            changed &= changed - 1;
            let name = self.names.get(&number).cloned().unwrap_or_default();
            self.seen.push(SignalReport { number, name, on: on >> number & 1 == 1, line, cycle });
        }
    }
}

/// Watches the outputs and inputs of a run.
#[derive(Clone, Default)]
pub(super) struct Outputs {
    outputs: Signals,
    inputs: Signals,
    analog_names: [String; ANALOG_OUTPUTS],
    analog_before: [f64; ANALOG_OUTPUTS],
    analog: Vec<AnalogReport>,
}

impl Outputs {
    pub(super) fn of(machine: &Machine) -> Outputs {
        let output = |number| Some((number, machine.output(number)?.name.clone()));
        let input = |number| Some((number, machine.input(number)?.name.clone()));
        let analog = |number: usize| Some(machine.analog_output(number as u32)?.name.clone());
        let [outputs, inputs] =
            [(0..OUTPUTS).filter_map(output).collect(), (0..INPUTS).filter_map(input).collect()]
                .map(|names| Signals { names, ..Signals::default() });
        let analog_names = std::array::from_fn(|number| analog(number).unwrap_or_default());
        Outputs { outputs, inputs, analog_names, ..Outputs::default() }
    }

    /// Takes one control cycle.
    pub(super) fn cycle(&mut self, status: &MachineStatus, measurement: &Measurement) {
        self.outputs.cycle(status.outputs, status.line, status.cycle.0);
        self.inputs.cycle(measurement.inputs, status.line, measurement.cycle.0);
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
    }

    /// The changes in the order of their coming, of one cycle in the order of their numbers: outputs, analog
    /// ones, inputs.
    pub(super) fn finish(self) -> (Vec<SignalReport>, Vec<AnalogReport>, Vec<SignalReport>) {
        (self.outputs.seen, self.analog, self.inputs.seen)
    }
}
