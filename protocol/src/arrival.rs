//! What reached a module otherwise than in lock step. In: what was taken for each input in each cycle, and
//! what is due there in lock step. Out: an [`Arrival`] wherever that begins or ends to differ, so that a run
//! can be made again from its program: what modules send follows from what they have taken.
//!
//! A message is named by the cycle that it belongs to: it is that of its sender.

use zerocopy::{FromBytes, Immutable, IntoBytes};

use crate::{message::Message, units::Axis};

/// Something that a module takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Input {
    /// Machine code, to the interpolator: how many packets in a tick, if more were wanted.
    Code,
    /// The source of machine code is given up, before the tick of this cycle.
    Lost,
    /// The measurement of a tick, to the interpolator.
    TickMeasurement,
    /// The status of an axis that the interpolator looks at.
    Status(Axis),
    /// The measurement, to the regulator of an axis.
    Measurement(Axis),
    /// The frame that a regulator takes with a measurement.
    Frame(Axis),
    /// The command that a drive follows.
    Drive(Axis),
    /// The spindle command that comes into force.
    Spindle,
    /// The per cent of an override that the operator turns in this cycle: the bits of the number.
    OperatorValue,
    /// What the operator does at the panel: the kind of an [`OperatorRequest`](crate::OperatorRequest).
    Operator,
    /// A module is killed, by whoever runs the machine in one process.
    Killed,
    /// The truth, to the recorder.
    Truth,
    /// The status of an axis that the recorder looks at.
    SeenAxis(Axis),
    /// The status of the interpolator that the recorder looks at.
    SeenMachine,
    /// How many arrivals a module has told: its last word.
    Total,
}

/// Inputs there is one of, by the number of their kind from 0, and their names.
const SINGLE: [(Input, &str); 9] = [
    (Input::Code, "machine-code"),
    (Input::Lost, "machine-code-lost"),
    (Input::TickMeasurement, "measurement/interpolator"),
    (Input::Spindle, "spindle-command"),
    (Input::OperatorValue, "operator-value"),
    (Input::Operator, "operator"),
    (Input::Killed, "killed"),
    (Input::Truth, "truth"),
    (Input::SeenMachine, "machine-status"),
];
/// The input of an axis.
type OfAxis = fn(Axis) -> Input;
/// Inputs of every axis.
const OF_AXIS: [(OfAxis, &str); 5] = [
    (Input::Status, "axis-status/interpolator"),
    (Input::Measurement, "measurement"),
    (Input::Frame, "axis-command"),
    (Input::Drive, "drive-command"),
    (Input::SeenAxis, "axis-status"),
];
/// Codes of inputs there is one of begin here, those of the axes at 0.
const FROM: u32 = 0x100;
const TOTAL: u32 = 0x200;

impl Input {
    /// Its number on the wire.
    pub fn code(self) -> u32 {
        if self == Input::Total {
            return TOTAL;
        }
        if let Some(at) = SINGLE.iter().position(|(input, _)| *input == self) {
            return FROM + at as u32;
        }
        let places = OF_AXIS.iter().zip(0..).flat_map(|((of, _), kind)| {
            Axis::ALL.iter().map(move |axis| (of(*axis), 16 * kind + axis.index() as u32))
        });
        places.into_iter().find(|(input, _)| *input == self).map_or(u32::MAX, |(_, code)| code)
    }

    /// The input of a number.
    pub fn from_code(code: u32) -> Option<Input> {
        if code == TOTAL {
            return Some(Input::Total);
        }
        if let Some(at) = code.checked_sub(FROM) {
            return SINGLE.get(at as usize).map(|(input, _)| *input);
        }
        let (of, _) = OF_AXIS.get(code as usize / 16)?;
        Axis::ALL.get(code as usize % 16).map(|axis| of(*axis))
    }

    /// Its name in a file: that of its channel, where there is one.
    pub fn name(self) -> String {
        if let Some((_, name)) = SINGLE.iter().find(|(input, _)| *input == self) {
            return (*name).into();
        }
        let mut places = OF_AXIS.iter().flat_map(|(of, name)| Axis::ALL.map(|axis| (of(axis), *name, axis)));
        let found = places.find(|(input, ..)| *input == self);
        found.map_or_else(|| "total".into(), |(_, name, axis)| format!("{name}/{}", axis.name()))
    }

    /// The input of a name.
    ///
    /// ```
    /// use protocol::{Axis, arrival::Input};
    /// assert_eq!(Input::from_name("drive-command/x"), Some(Input::Drive(Axis::X)));
    /// assert_eq!(Input::from_name("drive-command"), None);
    /// ```
    pub fn from_name(name: &str) -> Option<Input> {
        if let Some((input, _)) = SINGLE.iter().find(|(_, single)| *single == name) {
            return Some(*input);
        }
        let (stem, axis) = name.rsplit_once('/')?;
        let (of, _) = OF_AXIS.iter().find(|(_, name)| *name == stem)?;
        Axis::from_name(axis).map(of)
    }
}

/// What is taken from a cycle on, until the next arrival of the same input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Taken {
    /// What is due in lock step.
    #[default]
    Due,
    /// Nothing; where a module looks at the latest, nothing has ever come.
    Nothing,
    /// The message of this cycle; of [`Input::Code`] so many; of [`Input::Operator`], [`Input::Killed`] and
    /// [`Input::Total`] what it says there.
    This(u64),
}

impl Taken {
    /// What is taken where something else may be due.
    pub fn or(self, due: Option<u64>) -> Option<u64> {
        match self {
            Taken::Due => due,
            Taken::Nothing => None,
            Taken::This(which) => Some(which),
        }
    }
}

/// Sees what is taken for one input, and tells where it is not what is due.
#[derive(Clone, Copy, Debug, Default)]
pub struct Differs(Taken);

impl Differs {
    /// In this cycle that was taken, and that is due. What is to be told, if anything.
    pub fn note(&mut self, taken: Option<u64>, due: Option<u64>) -> Option<Taken> {
        if self.0.or(due) == taken {
            return None;
        }
        self.0 = match taken {
            _ if taken == due => Taken::Due,
            None => Taken::Nothing,
            Some(which) => Taken::This(which),
        };
        Some(self.0)
    }
}

/// From a cycle on something else is taken for an input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct Arrival {
    /// How many its sender has told before.
    pub number: u64,
    /// The measurement with which it was taken.
    pub cycle: u64,
    /// Code of the [`Input`].
    pub input: u32,
    /// 0 what is due, 1 nothing, 2 the message that `which` names.
    pub taken: u32,
    /// Which message, by its cycle.
    pub which: u64,
}

impl Message for Arrival {
    const NAME: &str = "pitchlock/arrival/1";
}

impl Arrival {
    /// Puts it on the wire.
    pub fn pack(number: u64, cycle: u64, input: Input, taken: Taken) -> Arrival {
        let (taken, which) = match taken {
            Taken::Due => (0, 0),
            Taken::Nothing => (1, 0),
            Taken::This(which) => (2, which),
        };
        Arrival { number, cycle, input: input.code(), taken, which }
    }

    /// Takes it off the wire; `None` for codes that nobody knows.
    pub fn unpack(&self) -> Option<(Input, Taken)> {
        let taken = match self.taken {
            0 => Taken::Due,
            1 => Taken::Nothing,
            2 => Taken::This(self.which),
            _ => return None,
        };
        Some((Input::from_code(self.input)?, taken))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_codes_of_inputs_lead_back() {
        let singles = SINGLE.iter().map(|(input, _)| *input);
        let of_axes = OF_AXIS.iter().flat_map(|(of, _)| Axis::ALL.map(of));
        for input in singles.chain(of_axes) {
            assert_eq!(Input::from_code(input.code()), Some(input));
            assert_eq!(Input::from_name(&input.name()), Some(input));
        }
        assert_eq!(Input::from_code(Input::Total.code()), Some(Input::Total));
        assert_eq!([8, 80, 0x109, u32::MAX].map(Input::from_code), [None; 4]);
    }

    #[test]
    fn only_a_change_is_told_and_all_of_it_can_be_made_again() {
        // Taken, due: one late, two lost, a dead sender.
        let cycles = [
            (Some(0), Some(0)),
            (Some(0), Some(1)),
            (Some(2), Some(2)),
            (None, Some(3)),
            (None, None),
            (None, Some(5)),
            (Some(6), Some(6)),
            (Some(6), Some(7)),
            (Some(6), Some(8)),
        ];
        let (mut differs, mut mode, mut told) = (Differs::default(), Taken::Due, 0);
        for (taken, due) in cycles {
            if let Some(change) = differs.note(taken, due) {
                mode = change;
                told += 1;
            }
            assert_eq!(mode.or(due), taken);
        }
        assert_eq!(told, 5);
    }
}
