//! What a scenario wants of whoever runs the machine: a module killed, frozen or thawed, messages tampered
//! with. In: what has become due. Out: one order a cycle, in the order in which they came.

use std::collections::VecDeque;

use protocol::{Axis, Doom, Module};

/// A channel between the modules whose messages can be tampered with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Machine code to the interpolator.
    MachineCode,
    /// The measurement of a tick to the interpolator.
    TickMeasurement,
    /// Measurements to the regulator of an axis, or to every one.
    Measurement(Option<Axis>),
    /// Frames to the regulator of an axis.
    AxisCommand(Axis),
    /// The status of an axis to the interpolator.
    AxisStatus(Axis),
    /// Spindle commands to the plant.
    SpindleCommand,
    /// Commands to the drive of an axis.
    DriveCommand(Axis),
}

impl Channel {
    /// What they are called, for whoever wrote another name.
    pub(crate) const NAMES: &str = "machine-code, measurement, measurement/interpolator, measurement/x, \
                                    axis-command/x, axis-status/x, spindle-command, drive-command/x (and so for \
                                    other axes)";

    /// The channel of a name, as the table of all channels has it; `measurement/x` is what one regulator gets
    /// of `measurement`.
    pub fn from_name(name: &str) -> Option<Channel> {
        let (stem, axis) = match name.split_once('/') {
            Some((stem, end)) => (stem, Axis::from_name(end)),
            None => (name, None),
        };
        match (name, stem, axis) {
            ("machine-code", ..) => Some(Channel::MachineCode),
            ("measurement/interpolator", ..) => Some(Channel::TickMeasurement),
            ("measurement", ..) => Some(Channel::Measurement(None)),
            ("spindle-command", ..) => Some(Channel::SpindleCommand),
            (_, "measurement", Some(axis)) => Some(Channel::Measurement(Some(axis))),
            (_, "axis-command", Some(axis)) => Some(Channel::AxisCommand(axis)),
            (_, "axis-status", Some(axis)) => Some(Channel::AxisStatus(axis)),
            (_, "drive-command", Some(axis)) => Some(Channel::DriveCommand(axis)),
            _ => None,
        }
    }

    /// The axis at its end, if it is that of one axis.
    pub fn axis(self) -> Option<Axis> {
        match self {
            Channel::Measurement(axis) => axis,
            Channel::AxisCommand(axis) | Channel::AxisStatus(axis) | Channel::DriveCommand(axis) => {
                Some(axis)
            }
            Channel::MachineCode | Channel::TickMeasurement | Channel::SpindleCommand => None,
        }
    }
}

/// What becomes of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tampering {
    /// It does not arrive.
    Drop,
    /// It arrives so many control cycles late.
    Delay {
        /// How many.
        cycles: u32,
    },
    /// It arrives twice.
    Duplicate,
    /// It arrives behind the one that follows it.
    Reorder,
    /// It arrives with one bit turned over; another one in each message.
    Corrupt {
        /// Which in the first of them, counted round.
        bit: u32,
    },
}

/// Messages to be tampered with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Packet {
    /// On which channel.
    pub channel: Channel,
    /// What becomes of them.
    pub tampering: Tampering,
    /// How many, from now on.
    pub count: u32,
}

/// What whoever runs the machine is to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Order {
    Doom(Doom, Module),
    Packet(Packet),
}

/// Orders that wait for their cycle.
#[derive(Clone, Debug)]
pub(crate) struct Orders {
    waiting: VecDeque<Order>,
    thaws: Vec<(u64, Module)>,
    now: Option<Order>,
}

impl Orders {
    /// None yet.
    pub(crate) fn none() -> Orders {
        Orders { waiting: VecDeque::new(), thaws: Vec::new(), now: None }
    }

    /// For a scenario of so many events.
    pub(crate) fn make_room(&mut self, events: usize) {
        self.waiting.reserve(2 * events);
        self.thaws.reserve(events);
    }

    /// One more; what is frozen thaws in the cycle `until`, if there is one.
    pub(crate) fn give(&mut self, order: Order, until: Option<u64>) {
        self.waiting.push_back(order);
        if let (Order::Doom(Doom::Freeze, module), Some(until)) = (order, until) {
            self.thaws.push((until, module));
        }
    }

    /// Goes on to a cycle.
    pub(crate) fn advance(&mut self, cycle: u64) {
        let waiting = &mut self.waiting;
        self.thaws.retain(|(until, module)| {
            let over = cycle >= *until;
            if over {
                waiting.push_back(Order::Doom(Doom::Thaw, *module));
            }
            !over
        });
        self.now = waiting.pop_front();
    }

    /// That of the present cycle.
    pub(crate) fn now(&self) -> Option<Order> {
        self.now
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_are_known_by_their_names() {
        let x = Axis::X;
        for (name, channel) in [
            ("machine-code", Some(Channel::MachineCode)),
            ("measurement", Some(Channel::Measurement(None))),
            ("measurement/interpolator", Some(Channel::TickMeasurement)),
            ("measurement/x", Some(Channel::Measurement(Some(x)))),
            ("axis-command/x", Some(Channel::AxisCommand(x))),
            ("axis-status/x", Some(Channel::AxisStatus(x))),
            ("drive-command/z", Some(Channel::DriveCommand(Axis::Z))),
            ("spindle-command", Some(Channel::SpindleCommand)),
            ("axis-command", None),
            ("truth", None),
            ("machine-code/x", None),
            ("drive-command/q", None),
        ] {
            assert_eq!(Channel::from_name(name), channel, "{name}");
        }
    }

    #[test]
    fn one_order_a_cycle_and_a_thaw_in_its_time() {
        let mut orders = Orders::none();
        orders.give(Order::Doom(Doom::Freeze, Module::Interpolator), Some(3));
        orders.give(Order::Doom(Doom::Kill, Module::Interpreter), None);
        let given: Vec<_> = (0..5)
            .map(|cycle| {
                orders.advance(cycle);
                orders.now()
            })
            .collect();
        let doom = |doom, module| Some(Order::Doom(doom, module));
        let expected = [
            doom(Doom::Freeze, Module::Interpolator),
            doom(Doom::Kill, Module::Interpreter),
            None,
            doom(Doom::Thaw, Module::Interpolator),
            None,
        ];
        assert_eq!(given, expected);
    }
}
