//! A machine whose processes have run, made again in one process: its modules take what they took then.
//! In: machine code, scenario, seed, arrivals. Out, each control cycle: what every module says, bit for
//! bit.
//!
//! In lock step every message comes when it is due. What came otherwise is named by the arrivals, as the
//! cycle that a message belongs to; the message itself is what its sender says here in that cycle. So a
//! module that was late then is not late here: it does its work in its own cycle, and others take it as
//! late as they did.

use std::collections::{BTreeMap, VecDeque};

use interpolator::Interpolator;
use machine::Machine;
use protocol::{
    Axis, AxisFrame, AxisStatus, CodePacket, DriveCommand, Input, Item, MachineStatus, Measurement,
    OperatorRequest, PerAxis, SpindleCommand, Taken, Truth, operator::Request, units::AXES,
};
use regulator::Regulator;
use sim_plant::{Plant, PlantError, Scenario};

use super::arrivals::{Arrivals, Change};
use crate::observe::Record;
use crate::rig::Exchange;

/// Messages of a sender that are kept for whoever takes them late: more than wait in the longest queue.
const KEPT: usize = 2048;
/// The same of frames, which are long.
const KEPT_FRAMES: usize = 64;

/// What a module has sent, by its cycle.
struct Sent<T> {
    messages: VecDeque<(u64, T)>,
    most: usize,
    looked_at: Option<(u64, T)>,
}

impl<T: Copy> Sent<T> {
    fn new(most: usize) -> Sent<T> {
        Sent { messages: VecDeque::new(), most, looked_at: None }
    }

    fn put(&mut self, cycle: u64, message: T) {
        if self.messages.len() == self.most {
            self.messages.pop_front();
        }
        self.messages.push_back((cycle, message));
    }

    /// The message of a cycle.
    fn of(&mut self, which: Option<u64>, what: &str) -> Result<Option<T>, String> {
        let Some(cycle) = which else { return Ok(None) };
        if self.looked_at.is_none_or(|(seen, _)| seen != cycle) {
            let found = self.messages.iter().rev().find(|(sent, _)| *sent == cycle).copied();
            let nobody =
                || format!("the arrivals name a message of {what} of cycle {cycle} that nobody has sent");
            self.looked_at = Some(found.ok_or_else(nobody)?);
        }
        Ok(self.looked_at.map(|(_, message)| message))
    }
}

/// The regulator of an axis, and what it has sent.
struct Governor {
    axis: Axis,
    regulator: Regulator,
    statuses: Sent<AxisStatus>,
    drives: Sent<DriveCommand>,
    frames: Sent<AxisFrame>,
    /// The latest of its statuses that the interpolator knows.
    known: AxisStatus,
}

/// The machine.
pub struct Replica<I> {
    plant: Plant,
    interpolator: Interpolator,
    governors: Vec<Governor>,
    code: I,
    packets: u64,
    ticks: u64,
    spindles: Sent<SpindleCommand>,
    machines: Sent<MachineStatus>,
    arrivals: VecDeque<Change>,
    modes: BTreeMap<Input, Taken>,
    /// The interpolator has made its last tick.
    finished: bool,
    frames: PerAxis<Option<AxisFrame>>,
    drives: PerAxis<DriveCommand>,
    spindle: SpindleCommand,
    seen: Vec<(Axis, AxisStatus)>,
    machine: MachineStatus,
}

impl<I: Iterator<Item = Item>> Replica<I> {
    /// The machine before cycle 0.
    ///
    /// # Errors
    /// [`PlantError`] if the truth about the plant cannot be.
    pub fn new(
        machine: &Machine,
        code: I,
        scenario: Scenario,
        seed: u64,
        arrivals: &Arrivals,
    ) -> Result<Replica<I>, PlantError> {
        let mut changes = arrivals.changes.clone();
        changes.sort_by_key(|(cycle, ..)| *cycle);
        let governor = |axis| Governor {
            axis,
            regulator: Regulator::new(machine, axis),
            statuses: Sent::new(KEPT),
            drives: Sent::new(KEPT),
            frames: Sent::new(KEPT_FRAMES),
            known: AxisStatus::default(),
        };
        Ok(Replica {
            plant: Plant::new(machine, scenario, seed)?,
            interpolator: Interpolator::new(machine),
            governors: machine.axes().map(|(axis, _)| governor(axis)).collect(),
            code,
            packets: 0,
            ticks: machine.cycles_per_tick(),
            spindles: Sent::new(KEPT_FRAMES),
            machines: Sent::new(KEPT),
            arrivals: changes.into(),
            modes: BTreeMap::new(),
            finished: false,
            frames: [None; AXES],
            drives: [DriveCommand::default(); AXES],
            spindle: SpindleCommand::default(),
            seen: machine.axes().map(|(axis, _)| (axis, AxisStatus::default())).collect(),
            machine: MachineStatus::default(),
        })
    }

    /// One control cycle. `observe` sees what went between the modules, and what the recorder saw of it;
    /// whether it saw anything. False after the last cycle.
    ///
    /// # Errors
    /// The arrivals name a message that nobody has sent: they are those of another run.
    pub fn exchange(&mut self, observe: impl FnOnce(&Exchange, bool)) -> Result<bool, String> {
        let truth = *self.plant.truth();
        let now = truth.cycle.0;
        let (mut request, mut lost) = (OperatorRequest::default(), false);
        while let Some((_, input, taken)) = self.arrivals.pop_front_if(|(cycle, ..)| *cycle <= now) {
            match (input, taken) {
                (Input::Lost, _) => lost = true,
                (Input::OperatorValue, Taken::This(bits)) => request.value = f64::from_bits(bits),
                (Input::Operator, Taken::This(kind)) => request.kind = kind as u32,
                _ => {
                    self.modes.insert(input, taken);
                }
            }
        }
        let measurement = truth.measurement.sealed();
        let last = measurement.last != 0;
        if now.is_multiple_of(self.ticks) || last {
            self.interpolate(now, &measurement, lost)?;
        }
        self.regulate(now, &measurement)?;
        let late = self.drive(now)?;
        self.command(now)?;
        self.see(now)?;
        let record = Record { truth: &truth, axes: &self.seen, machine: &self.machine };
        let Replica { frames, drives, spindle, .. } = &*self;
        observe(&Exchange { record, frames, drives, spindle }, self.takes(Input::Truth, Some(now)).is_some());
        (0..late).for_each(|_| self.plant.note_late());
        let request: Option<Request> = request.unpack().ok();
        self.plant.tick(&self.drives, &self.spindle, request);
        Ok(!last)
    }

    /// Mains and controls fail behind the cycle that was last: the plant at rest.
    /// `see` is shown every cycle on its way there.
    pub fn lose_power(self, see: impl FnMut(&Truth)) -> Plant {
        let Replica { mut plant, drives, spindle, .. } = self;
        plant.lose_power(&drives, &spindle, see);
        plant
    }

    /// What is taken for an input where something is due.
    fn takes(&self, input: Input, due: Option<u64>) -> Option<u64> {
        self.modes.get(&input).copied().unwrap_or_default().or(due)
    }

    /// One tick of the interpolator, if it got its measurement.
    fn interpolate(&mut self, now: u64, measurement: &Measurement, lost: bool) -> Result<(), String> {
        if self.finished || self.takes(Input::TickMeasurement, Some(now)).is_none() {
            return Ok(());
        }
        let before = now.checked_sub(1);
        let mut statuses = [AxisStatus::default(); AXES];
        for index in 0..self.governors.len() {
            let axis = self.governors[index].axis;
            let which = self.takes(Input::Status(axis), before);
            let governor = &mut self.governors[index];
            governor.known = governor.statuses.of(which, "the axis status")?.unwrap_or_default();
            statuses[axis.index()] = governor.known;
        }
        self.feed();
        if lost {
            self.interpolator.lost_source();
        }
        self.finished = self.interpolator.finished() || measurement.last != 0;
        let Some(out) = self.interpolator.tick(&interpolator::In { measurement, axes: &statuses }) else {
            return Ok(());
        };
        for Governor { axis, frames, .. } in &mut self.governors {
            frames.put(now, out.frames[axis.index()]);
        }
        self.spindles.put(now, out.spindle);
        self.machines.put(now, out.status);
        Ok(())
    }

    /// Machine code: as much as is wanted, or as much as had come.
    fn feed(&mut self) {
        let mut left = self.takes(Input::Code, None).unwrap_or(u64::MAX);
        while left > 0 && self.interpolator.wants() {
            let Some(item) = self.code.next() else { return };
            // What is refused is a fault, which the tick tells.
            let _ = self.interpolator.push(&CodePacket::pack(self.packets, &item));
            self.packets += 1;
            left -= 1;
        }
    }

    /// One cycle of every regulator that got its measurement.
    fn regulate(&mut self, now: u64, measurement: &Measurement) -> Result<(), String> {
        self.frames = [None; AXES];
        let due = now.checked_sub(self.ticks).filter(|_| now.is_multiple_of(self.ticks));
        for index in 0..self.governors.len() {
            let axis = self.governors[index].axis;
            if self.takes(Input::Measurement(axis), Some(now)).is_none() {
                continue;
            }
            let which = self.takes(Input::Frame(axis), due);
            let Governor { regulator, statuses, drives, frames, .. } = &mut self.governors[index];
            let frame = frames.of(which, "the axis command")?;
            let out = regulator.tick(&regulator::In { measurement, frame: frame.as_ref() });
            statuses.put(now, out.status);
            drives.put(now, out.drive);
            self.frames[axis.index()] = frame;
        }
        Ok(())
    }

    /// What the drives follow; how many of the commands were late.
    fn drive(&mut self, now: u64) -> Result<usize, String> {
        let mut late = 0;
        for index in 0..self.governors.len() {
            let axis = self.governors[index].axis;
            let which = self.takes(Input::Drive(axis), Some(now));
            let command = self.governors[index].drives.of(which, "the drive command")?.unwrap_or_default();
            late += usize::from(command.cycle.0 < now);
            self.drives[axis.index()] = command;
        }
        Ok(late)
    }

    /// What the recorder sees.
    fn see(&mut self, now: u64) -> Result<(), String> {
        for index in 0..self.governors.len() {
            let which = self.takes(Input::SeenAxis(self.governors[index].axis), Some(now));
            let seen = self.governors[index].statuses.of(which, "the axis status")?;
            self.seen[index].1 = seen.unwrap_or_default();
        }
        let which = self.takes(Input::SeenMachine, Some(now - now % self.ticks));
        self.machine = self.machines.of(which, "the machine status")?.unwrap_or_default();
        Ok(())
    }

    /// The spindle command that comes into force. What is refused has not arrived.
    fn command(&mut self, now: u64) -> Result<(), String> {
        let due = now.checked_sub(self.ticks).filter(|_| now.is_multiple_of(self.ticks));
        let Some(due) = due else { return Ok(()) };
        let which = self.takes(Input::Spindle, Some(due));
        if let Some(command) = self.spindles.of(which, "the spindle command")?
            && command.check().is_ok()
        {
            self.spindle = command;
        }
        Ok(())
    }
}
