//! Every channel of a machine: what it carries, from whom, to whom, how deep, and what happens when it is
//! full. This file is the one place to change any of that.

use std::{any::Any, marker::PhantomData};

use protocol::{
    Arrival, Axis, AxisFrame, AxisStatus, CodePacket, Credit, DriveCommand, Measurement, Payload,
    SpindleCommand, Truth, operator::OperatorRequest, status::MachineStatus,
};

use super::{IpcError, Process, count::CountPacket, port};

/// Machine code that may be on its way: the interpreter sends item `n` once `n - CODE_DEPTH` have been taken.
pub const CODE_DEPTH: u64 = 64;

// Two interpolator cycles of a machine with the longest (200 control cycles) fit, and a recorder that is
// woken for every RECORD_WAKE cycles need not hurry.
const RECORD_DEPTH: usize = 1024;

/// Arrivals that wait for a recorder that stands, of each sender.
const ARRIVAL_DEPTH: usize = 512;

/// How often those who send to the recorder should wake it, control cycles.
pub const RECORD_WAKE: u64 = 256;

/// Interpreter → interpolator.
pub const MACHINE_CODE: Channel<CodePacket> =
    Channel::new("machine-code", End::Interpreter, &[End::Interpolator], CODE_DEPTH as usize, Keep::Every);
/// Interpolator → interpreter: how much was taken.
pub const CREDIT: Channel<Credit> =
    Channel::new("credit", End::Interpolator, &[End::Interpreter], 1, Keep::Latest);
/// Interpolator → regulator.
pub const AXIS_COMMAND: Channel<AxisFrame> =
    Channel::new("axis-command", End::Interpolator, &[End::ThisRegulator], 16, Keep::Every);
/// Interpolator → plant.
pub const SPINDLE_COMMAND: Channel<SpindleCommand> =
    Channel::new("spindle-command", End::Interpolator, &[End::Plant], 16, Keep::Every);
/// Plant → regulators, every control cycle.
pub const MEASUREMENT: Channel<Measurement> =
    Channel::new("measurement", End::Plant, &[End::EveryRegulator], 64, Keep::Every);
/// Plant → interpolator, every interpolator cycle.
pub const TICK_MEASUREMENT: Channel<Measurement> =
    Channel::new("measurement/interpolator", End::Plant, &[End::Interpolator], 16, Keep::Every);
/// Regulator → plant.
pub const DRIVE_COMMAND: Channel<DriveCommand> =
    Channel::new("drive-command", End::ThisRegulator, &[End::Plant], 64, Keep::Every);
/// Regulator → interpolator and recorder.
pub const AXIS_STATUS: Channel<AxisStatus> = Channel::new(
    "axis-status",
    End::ThisRegulator,
    &[End::Interpolator, End::Launcher],
    RECORD_DEPTH,
    Keep::Every,
);
/// Interpolator → recorder.
pub const MACHINE_STATUS: Channel<MachineStatus> =
    Channel::new("machine-status", End::Interpolator, &[End::Launcher], RECORD_DEPTH, Keep::Every);
/// Plant → recorder. No controller reads it.
pub const TRUTH: Channel<Truth> =
    Channel::new("truth", End::Plant, &[End::Launcher], RECORD_DEPTH, Keep::Every);
/// Launcher → plant: what the operator does.
pub const OPERATOR: Channel<OperatorRequest> =
    Channel::new("operator", End::Launcher, &[End::Plant], 64, Keep::Every);
/// Whoever works in cycles → recorder: what it takes otherwise than in lock step, so seldom anything.
pub const ARRIVAL: Channel<Arrival> =
    Channel::new("arrival", End::Cyclic, &[End::Launcher], ARRIVAL_DEPTH, Keep::Every);
/// Everybody → launcher, once, at the end.
pub(crate) const COUNT: Channel<CountPacket> =
    Channel::new("count", End::Everybody, &[End::Launcher], 64, Keep::Every);

/// Every channel of a machine with these axes.
pub fn all(axes: &[Axis]) -> Vec<Row> {
    let mut all = vec![
        MACHINE_CODE.row(axes),
        CREDIT.row(axes),
        SPINDLE_COMMAND.row(axes),
        MEASUREMENT.row(axes),
        TICK_MEASUREMENT.row(axes),
        MACHINE_STATUS.row(axes),
        TRUTH.row(axes),
        OPERATOR.row(axes),
        ARRIVAL.row(axes),
        COUNT.row(axes),
    ];
    for axis in axes {
        all.push(AXIS_COMMAND.of(*axis).row(axes));
        all.push(DRIVE_COMMAND.of(*axis).row(axes));
        all.push(AXIS_STATUS.of(*axis).row(axes));
    }
    all
}

/// What a full channel does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keep {
    /// Nothing is lost: the sender waits, and says so if it cannot.
    Every,
    /// The newest replaces the oldest.
    Latest,
}

/// Who stands at an end of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum End {
    Launcher,
    Interpreter,
    Interpolator,
    Plant,
    /// The regulator of the channel's own axis.
    ThisRegulator,
    /// Each regulator.
    EveryRegulator,
    /// Everybody who works in cycles: interpolator, plant, regulators.
    Cyclic,
    /// Everybody but the launcher.
    Everybody,
}

impl End {
    fn processes(self, axes: &[Axis], this: Option<Axis>) -> Vec<Process> {
        match self {
            End::Launcher => vec![Process::Launcher],
            End::Interpreter => vec![Process::Interpreter],
            End::Interpolator => vec![Process::Interpolator],
            End::Plant => vec![Process::Plant],
            End::ThisRegulator => this.into_iter().map(Process::Regulator).collect(),
            End::EveryRegulator => axes.iter().copied().map(Process::Regulator).collect(),
            End::Cyclic => {
                let mut members = Process::members(axes);
                members.retain(|process| *process != Process::Interpreter);
                members
            }
            End::Everybody => Process::members(axes),
        }
    }
}

/// A channel for messages of one type.
#[derive(Clone, Copy, Debug)]
pub struct Channel<T> {
    stem: &'static str,
    axis: Option<Axis>,
    from: End,
    to: &'static [End],
    pub(crate) depth: usize,
    pub(crate) keep: Keep,
    message: PhantomData<fn() -> T>,
}

impl<T> Channel<T> {
    const fn new(stem: &'static str, from: End, to: &'static [End], depth: usize, keep: Keep) -> Channel<T> {
        Channel { stem, axis: None, from, to, depth, keep, message: PhantomData }
    }

    /// The channel of one axis, of those that exist once per axis.
    pub fn of(self, axis: Axis) -> Channel<T> {
        Channel { axis: Some(axis), ..self }
    }

    fn one_per_axis(&self) -> bool {
        self.from == End::ThisRegulator || self.to.contains(&End::ThisRegulator)
    }
}

impl<T: Payload> Channel<T> {
    /// `machine-code`, `axis-command/x` …
    ///
    /// # Panics
    /// If the channel exists once per axis and no axis was named, or the other way round.
    pub fn name(&self) -> String {
        assert_eq!(self.one_per_axis(), self.axis.is_some(), "{}: say whose with `of(axis)`", self.stem);
        match self.axis {
            Some(axis) => format!("{}/{}", self.stem, axis.name()),
            None => self.stem.into(),
        }
    }

    fn row(self, axes: &[Axis]) -> Row {
        let senders = self.from.processes(axes, self.axis);
        let receivers: Vec<_> = self.to.iter().flat_map(|end| end.processes(axes, self.axis)).collect();
        let (from, to) = (senders.len(), receivers.len());
        Row {
            name: self.name(),
            senders,
            receivers,
            depth: self.depth,
            keep: self.keep,
            message_bytes: T::MOST_BYTES,
            create: Box::new(move |node| Ok(Box::new(port::create_service(node, &self, from, to)?))),
        }
    }
}

/// A channel as the table of all channels shows it.
pub struct Row {
    /// Name of the channel.
    pub name: String,
    /// Who sends.
    pub senders: Vec<Process>,
    /// Who receives; each gets every message.
    pub receivers: Vec<Process>,
    /// Messages that wait for a receiver at most.
    pub depth: usize,
    /// What happens when that many wait.
    pub keep: Keep,
    /// Most bytes of a message.
    pub message_bytes: usize,
    pub(crate) create: Create,
}

impl Row {
    /// Shared memory that its messages need at most, bytes: every sender has room for all that can wait and
    /// be in hand.
    fn shared_bytes(&self) -> u64 {
        let messages = self.receivers.len() * (self.depth + 1) + 2;
        (self.senders.len() * messages * (self.message_bytes + HEADER_BYTES)) as u64
    }
}

/// What iceoryx2 adds to a message, and its queues, at most.
const HEADER_BYTES: usize = 192;
/// What it needs for a channel and for a process, at most.
const ENDS_BYTES: u64 = 48 * 1024;

/// Shared memory that a machine with these axes needs at most, bytes.
pub fn shared_bytes(axes: &[Axis]) -> u64 {
    let all = all(axes);
    let ends = all.iter().map(|row| row.senders.len() + row.receivers.len()).sum::<usize>() as u64;
    all.iter().map(Row::shared_bytes).sum::<u64>() + ENDS_BYTES * ends
}

type Create = Box<dyn Fn(&port::Node) -> Result<Box<dyn Any>, IpcError>>;
