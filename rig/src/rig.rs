//! The whole machine in one process: the same modules, in the same order, with the same one feedback delay as
//! the processes over iceoryx2, so that both give the same numbers bit for bit.
//!
//! Enters: machine code, a scenario, a seed, wires; each control cycle, perhaps what the operator does at the
//! panel. Leaves, each control cycle: a [`Record`] of it, or the whole [`Exchange`] between the modules.

use interpolator::{Interpolator, Out};
use machine::Machine;
use protocol::{
    Axis, AxisFrame, AxisStatus, CodePacket, Cycle, DriveCommand, Item, MachineStatus, Measurement, PerAxis,
    SpindleCommand, operator::Request, units::AXES,
};
use regulator::Regulator;
use sim_plant::{Plant, PlantError, Scenario};

use crate::observe::Record;
use crate::wires::{Straight, Wires};

/// The machine. `I` is where its machine code comes from: an interpreter, a file, a list. `W` is what lies
/// between its modules.
pub struct Rig<I, W = Straight> {
    plant: Plant,
    interpolator: Interpolator,
    regulators: Vec<(Axis, Regulator)>,
    wires: W,
    code: I,
    sent: u64,
    ticks: u64,
    /// Made by the last tick, in force from the next one on.
    made: Option<Out>,
    frames: PerAxis<Option<AxisFrame>>,
    spindle: SpindleCommand,
    drives: PerAxis<DriveCommand>,
    statuses: PerAxis<AxisStatus>,
    seen: Vec<(Axis, AxisStatus)>,
    machine_status: MachineStatus,
}

/// All that went between the modules in one control cycle.
#[derive(Clone, Copy, Debug)]
pub struct Exchange<'a> {
    /// The truth with its measurement, what the regulators said of this cycle, what the interpolator said
    /// last.
    pub record: Record<'a>,
    /// The frame that each regulator got in this cycle: one at a tick, else none.
    pub frames: &'a PerAxis<Option<AxisFrame>>,
    /// The drive commands that the plant goes on with.
    pub drives: &'a PerAxis<DriveCommand>,
    /// The spindle command in force.
    pub spindle: &'a SpindleCommand,
}

impl<I: Iterator<Item = Item>> Rig<I> {
    /// A machine at rest before cycle 0, its wires straight.
    ///
    /// # Errors
    /// [`PlantError`] if the truth about the plant cannot be.
    pub fn new(machine: &Machine, code: I, scenario: Scenario, seed: u64) -> Result<Rig<I>, PlantError> {
        Rig::with_wires(machine, code, scenario, seed, Straight)
    }
}

impl<I: Iterator<Item = Item>, W: Wires> Rig<I, W> {
    /// A machine at rest before cycle 0, with these wires between its modules.
    ///
    /// # Errors
    /// [`PlantError`] if the truth about the plant cannot be.
    pub fn with_wires(
        machine: &Machine,
        code: I,
        scenario: Scenario,
        seed: u64,
        wires: W,
    ) -> Result<Rig<I, W>, PlantError> {
        let regulators: Vec<_> =
            machine.axes().map(|(axis, _)| (axis, Regulator::new(machine, axis))).collect();
        Ok(Rig {
            plant: Plant::new(machine, scenario, seed)?,
            interpolator: Interpolator::new(machine),
            seen: regulators.iter().map(|(axis, _)| (*axis, AxisStatus::default())).collect(),
            regulators,
            wires,
            code,
            sent: 0,
            ticks: machine.cycles_per_tick(),
            made: None,
            frames: [None; AXES],
            spindle: SpindleCommand::default(),
            drives: [DriveCommand::default(); AXES],
            statuses: [AxisStatus::default(); AXES],
            machine_status: MachineStatus::default(),
        })
    }

    /// One control cycle; `observe` sees its record before the plant goes on. What the operator does is on
    /// the panel of the next measurement. False after the last cycle.
    pub fn cycle(&mut self, request: Option<Request>, observe: impl FnOnce(&Record)) -> bool {
        self.exchange(request, |exchange| observe(&exchange.record))
    }

    /// As [`Rig::cycle`], and `observe` sees all that went between the modules.
    pub fn exchange(&mut self, request: Option<Request>, observe: impl FnOnce(&Exchange)) -> bool {
        let truth = *self.plant.truth();
        let now = truth.cycle;
        let tick = now.0.is_multiple_of(self.ticks);

        self.frames = [None; AXES];
        if tick {
            self.deliver(now);
            self.interpolate(now, &truth.measurement);
        }
        self.regulate(now, &truth.measurement);
        observe(&Exchange {
            record: Record { truth: &truth, axes: &self.seen, machine: &self.machine_status },
            frames: &self.frames,
            drives: &self.drives,
            spindle: &self.spindle,
        });
        self.plant.tick(&self.drives, &self.spindle, request);
        truth.measurement.last == 0
    }

    /// What the last tick made comes into force.
    fn deliver(&mut self, now: Cycle) {
        let made = self.made.take();
        for (axis, _) in &self.regulators {
            let sent = made.as_ref().map(|out| &out.frames[axis.index()]);
            self.frames[axis.index()] = self.wires.frame(now, *axis, sent).copied();
        }
        if let Some(spindle) = self.wires.spindle(now, made.as_ref().map(|out| &out.spindle)) {
            self.spindle = *spindle;
        }
    }

    /// One tick of the interpolator.
    fn interpolate(&mut self, now: Cycle, sent: &Measurement) {
        let Some(&measurement) = self.wires.tick_measurement(now, Some(sent)) else { return };
        self.feed(now);
        let out =
            self.interpolator.tick(&interpolator::In { measurement: &measurement, axes: &self.statuses });
        self.machine_status = out.status;
        self.made = Some(out);
    }

    /// Fills the interpolator's queue, as far as there is program and credit.
    fn feed(&mut self, now: Cycle) {
        while self.interpolator.wants() {
            let packet = self.code.next().map(|item| CodePacket::pack(self.sent, &item));
            self.sent += u64::from(packet.is_some());
            let Some(packet) = self.wires.code(now, packet.as_ref()) else { return };
            if self.interpolator.push(packet).is_err() {
                return;
            }
        }
    }

    /// One cycle of every regulator. A drive that gets no command goes on with the one before.
    fn regulate(&mut self, now: Cycle, sent: &Measurement) {
        for ((axis, regulator), seen) in self.regulators.iter_mut().zip(&mut self.seen) {
            let index = axis.index();
            let frame = self.frames[index].as_ref();
            let measurement = self.wires.measurement(now, *axis, Some(sent));
            let out = measurement.map(|measurement| regulator.tick(&regulator::In { measurement, frame }));
            match self.wires.drive(now, *axis, out.as_ref().map(|out| &out.drive)) {
                Some(drive) => self.drives[index] = *drive,
                None => self.plant.note_late(),
            }
            if let Some(status) = self.wires.status(now, *axis, out.as_ref().map(|out| &out.status)) {
                self.statuses[index] = *status;
            }
            if let Some(out) = &out {
                seen.1 = out.status;
            }
        }
    }

    /// The wires, so that they can be disturbed while the machine runs.
    pub fn wires_mut(&mut self) -> &mut W {
        &mut self.wires
    }

    /// Numbers of the scenario's events that did not happen.
    pub fn pending_events(&self) -> impl Iterator<Item = usize> {
        self.plant.pending_events()
    }
}
