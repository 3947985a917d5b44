//! The whole machine in one process: the same modules, in the same order, with the same one feedback delay as the
//! processes over iceoryx2, so that both give the same numbers bit for bit.
//!
//! Enters: machine code, a scenario, a seed. Leaves, each control cycle: a [`Record`](crate::observe::Record) of it.

use interpolator::{Interpolator, Out};
use protocol::{
    Axis, AxisFrame, AxisStatus, CodePacket, DriveCommand, Item, Machine, MachineStatus, PerAxis,
    SpindleCommand, operator::Request, units::AXES,
};
use regulator::Regulator;
use sim_plant::{Plant, PlantError, Scenario};

use crate::observe::Record;

/// The machine. `I` is where its machine code comes from: an interpreter, a file, a list.
pub struct Rig<I> {
    plant: Plant,
    interpolator: Interpolator,
    regulators: Vec<(Axis, Regulator)>,
    code: I,
    sent: u64,
    ticks: u64,
    /// Made by the last tick, in force from the next one on.
    frames: Option<PerAxis<AxisFrame>>,
    spindle_made: SpindleCommand,
    spindle: SpindleCommand,
    drives: PerAxis<DriveCommand>,
    statuses: PerAxis<AxisStatus>,
    seen: Vec<(Axis, AxisStatus)>,
    machine_status: MachineStatus,
}

impl<I: Iterator<Item = Item>> Rig<I> {
    /// A machine at rest before cycle 0.
    ///
    /// # Errors
    /// [`PlantError`] if the truth about the plant cannot be.
    pub fn new(machine: &Machine, code: I, scenario: Scenario, seed: u64) -> Result<Rig<I>, PlantError> {
        let regulators: Vec<_> =
            machine.axes().map(|(axis, _)| (axis, Regulator::new(machine, axis))).collect();
        Ok(Rig {
            plant: Plant::new(machine, scenario, seed)?,
            interpolator: Interpolator::new(machine),
            seen: regulators.iter().map(|(axis, _)| (*axis, AxisStatus::default())).collect(),
            regulators,
            code,
            sent: 0,
            ticks: machine.cycles_per_tick(),
            frames: None,
            spindle_made: SpindleCommand::default(),
            spindle: SpindleCommand::default(),
            drives: [DriveCommand::default(); AXES],
            statuses: [AxisStatus::default(); AXES],
            machine_status: MachineStatus::default(),
        })
    }

    /// One control cycle; `observe` sees it before the plant goes on. False after the last one.
    pub fn cycle(&mut self, request: Option<Request>, observe: impl FnOnce(&Record)) -> bool {
        let truth = *self.plant.truth();
        let measurement = &truth.measurement;
        let tick = measurement.cycle.0.is_multiple_of(self.ticks);

        let in_force = if tick { self.frames } else { None };
        if tick {
            self.spindle = self.spindle_made;
            self.feed();
            let Out { frames, spindle, status } =
                self.interpolator.tick(&interpolator::In { measurement, axes: &self.statuses });
            self.frames = Some(frames);
            self.spindle_made = spindle;
            self.machine_status = status;
        }
        for ((axis, regulator), seen) in self.regulators.iter_mut().zip(&mut self.seen) {
            let frame = in_force.as_ref().map(|frames| &frames[axis.index()]);
            let out = regulator.tick(&regulator::In { measurement, frame });
            self.drives[axis.index()] = out.drive;
            self.statuses[axis.index()] = out.status;
            seen.1 = out.status;
        }
        observe(&Record { truth: &truth, axes: &self.seen, machine: &self.machine_status });

        self.plant.tick(&self.drives, &self.spindle, request);
        measurement.last == 0
    }

    /// Fills the interpolator's queue, as far as there is program and credit.
    fn feed(&mut self) {
        while self.interpolator.wants() {
            let Some(item) = self.code.next() else { return };
            let packet = CodePacket::pack(self.sent, &item);
            self.sent += 1;
            if self.interpolator.push(&packet).is_err() {
                return;
            }
        }
    }

    /// Numbers of the scenario's events that did not happen.
    pub fn pending_events(&self) -> impl Iterator<Item = usize> {
        self.plant.pending_events()
    }
}
