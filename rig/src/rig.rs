//! The whole machine in one process: the same modules, in the same order, with the same one feedback delay as
//! the processes over iceoryx2, so that both give the same numbers bit for bit.
//!
//! Enters: machine code, a scenario, a seed, wires; each control cycle, perhaps what the operator does at the
//! panel. Leaves, each control cycle: a [`Record`] of it, or the whole [`Exchange`] between the modules.
//!
//! A module can die and hang ([`Rig::kill`], [`Rig::freeze`]), from outside or by the scenario: what it would
//! have sent is missing then, and the others go on.

use interpolator::{Interpolator, Out};
use machine::Machine;
use protocol::{
    Axis, AxisFrame, AxisStatus, CodePacket, Cycle, Doom, DriveCommand, Item, MachineStatus, Measurement,
    Module, PerAxis, SpindleCommand, operator::Request, units::AXES,
};
use regulator::Regulator;
use sim_plant::{Plant, PlantError, Scenario};

use crate::lives::{Desk, Life};
use crate::observe::Record;
use crate::wires::{Disturbed, Straight, Tamperer, Wires};

/// Measurements and frames that wait for a module at most, as in the channels between processes.
const MEASUREMENTS: usize = 64;
const TICKS: usize = 16;
/// Who starts the processes takes an interpreter that says nothing for so long for dead, s.
const PATIENCE_S: f64 = 1.0;

/// The regulator of an axis, and what waits for it.
struct Governor {
    axis: Axis,
    regulator: Regulator,
    desk: Desk<(Measurement, Option<AxisFrame>)>,
}

impl Governor {
    /// The regulator answers a measurement, or lets it wait.
    fn arrives(&mut self, input: regulator::In) -> Option<regulator::Out> {
        if self.desk.is_up_to_date() {
            return Some(self.regulator.tick(&input));
        }
        self.desk.arrives((*input.measurement, input.frame.copied()));
        None
    }

    /// Its last answer to what has waited.
    fn catch_up(&mut self) -> Option<regulator::Out> {
        let mut last = None;
        for _ in 0..self.desk.ready() {
            let (measurement, frame) = self.desk.take()?;
            last = Some(
                self.regulator.tick(&regulator::In { measurement: &measurement, frame: frame.as_ref() }),
            );
        }
        last
    }
}

/// The machine. `I` is where its machine code comes from: an interpreter, a file, a list. `W` is what lies
/// between its modules.
pub struct Rig<I, W = Straight> {
    plant: Plant,
    interpolator: Interpolator,
    ticks_waiting: Desk<Measurement>,
    governors: Vec<Governor>,
    /// The scenario tampers with what the wires carry.
    wires: Disturbed<Tamperer, W>,
    code: I,
    interpreter: Life,
    /// Ticks for which the interpreter has been frozen, and how many make it a dead one.
    silent: (u64, u64),
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
        let governor =
            |axis| Governor { axis, regulator: Regulator::new(machine, axis), desk: Desk::new(MEASUREMENTS) };
        Ok(Rig {
            plant: Plant::new(machine, scenario, seed)?,
            interpolator: Interpolator::new(machine),
            ticks_waiting: Desk::new(TICKS),
            governors: machine.axes().map(|(axis, _)| governor(axis)).collect(),
            seen: machine.axes().map(|(axis, _)| (axis, AxisStatus::default())).collect(),
            wires: Disturbed::new(Tamperer::default(), wires),
            code,
            interpreter: Life::Works,
            silent: (0, (PATIENCE_S / machine.general.interpolator_cycle_s).ceil() as u64),
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
        match truth.doom() {
            Some((Doom::Kill, module)) => self.kill(module),
            Some((Doom::Freeze, module)) => self.freeze(module),
            Some((Doom::Thaw, module)) => self.thaw(module),
            None => {}
        }
        if let Some(packet) = self.plant.packet() {
            self.wires.disturbance.take(&packet, self.governors.iter().map(|own| own.axis));
        }

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
        for Governor { axis, .. } in &self.governors {
            let sent = made.as_ref().map(|out| &out.frames[axis.index()]);
            self.frames[axis.index()] = self.wires.frame(now, *axis, sent).copied();
        }
        let sent = made.as_ref().map(|out| &out.spindle);
        // What is refused has not arrived.
        if let Some(spindle) = self.wires.spindle(now, sent).filter(|spindle| spindle.check().is_ok()) {
            self.spindle = *spindle;
        }
    }

    /// One tick of the interpolator.
    fn interpolate(&mut self, now: Cycle, sent: &Measurement) {
        let arrived = self.wires.tick_measurement(now, Some(sent)).copied();
        if self.ticks_waiting.is_up_to_date() {
            arrived.iter().for_each(|measurement| self.tick(now, measurement));
            return;
        }
        arrived.into_iter().for_each(|measurement| self.ticks_waiting.arrives(measurement));
        for _ in 0..self.ticks_waiting.ready() {
            let measurement = self.ticks_waiting.take();
            measurement.iter().for_each(|measurement| self.tick(now, measurement));
        }
    }

    /// The interpolator works on a measurement. What it made of the one before, if that has not come into
    /// force, is lost.
    fn tick(&mut self, now: Cycle, measurement: &Measurement) {
        self.feed(now);
        let input = interpolator::In { measurement, axes: &self.statuses };
        let Some(out) = self.interpolator.tick(&input) else { return };
        self.machine_status = out.status;
        self.made = Some(out);
    }

    /// Fills the interpolator's queue, as far as there is program and credit.
    fn feed(&mut self, now: Cycle) {
        self.silent.0 = if self.interpreter == Life::Frozen { self.silent.0 + 1 } else { 0 };
        if self.silent.0 > self.silent.1 {
            self.kill(Module::Interpreter);
        }
        while self.interpreter == Life::Works && self.interpolator.wants() {
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
        for (governor, seen) in self.governors.iter_mut().zip(&mut self.seen) {
            let (axis, index) = (governor.axis, governor.axis.index());
            let measurement = self.wires.measurement(now, axis, Some(sent));
            let out = measurement.and_then(|measurement| {
                governor.arrives(regulator::In { measurement, frame: self.frames[index].as_ref() })
            });
            let out = out.or_else(|| governor.catch_up());
            match self.wires.drive(now, axis, out.as_ref().map(|out| &out.drive)) {
                Some(drive) => self.drives[index] = *drive,
                None => self.plant.note_late(),
            }
            if let Some(status) = self.wires.status(now, axis, out.as_ref().map(|out| &out.status)) {
                self.statuses[index] = *status;
            }
            if let Some(out) = &out {
                seen.1 = out.status;
            }
        }
    }

    /// A module ends, between two cycles: what it has sent still arrives, nothing more comes.
    pub fn kill(&mut self, module: Module) {
        self.turn(module, Life::Dead);
        if module == Module::Interpreter {
            self.interpolator.lost_source();
        }
    }

    /// A module stands still: it answers nothing, and its messages wait, as many as its channel holds. An
    /// interpreter that says nothing for a second counts as dead.
    pub fn freeze(&mut self, module: Module) {
        self.turn(module, Life::Frozen);
    }

    /// A frozen module goes on: a few of the messages that wait in each of its cycles, oldest first, until it
    /// has caught up. So its answers are old for a while.
    pub fn thaw(&mut self, module: Module) {
        self.turn(module, Life::Works);
    }

    /// Whether a module has been killed.
    pub fn is_dead(&self, module: Module) -> bool {
        let life = match module {
            Module::Interpreter => Some(self.interpreter),
            Module::Interpolator => Some(self.ticks_waiting.life),
            Module::Regulator(axis) => {
                self.governors.iter().find(|own| own.axis == axis).map(|own| own.desk.life)
            }
        };
        life == Some(Life::Dead)
    }

    fn turn(&mut self, module: Module, life: Life) {
        match module {
            Module::Interpreter => self.interpreter.turn(life),
            Module::Interpolator => self.ticks_waiting.life.turn(life),
            Module::Regulator(axis) => {
                self.governors
                    .iter_mut()
                    .filter(|own| own.axis == axis)
                    .for_each(|own| own.desk.life.turn(life));
            }
        }
    }

    /// The wires, so that they can be disturbed while the machine runs.
    pub fn wires_mut(&mut self) -> &mut W {
        &mut self.wires.wires
    }

    /// Numbers of the scenario's events that did not happen.
    pub fn pending_events(&self) -> impl Iterator<Item = usize> {
        self.plant.pending_events()
    }
}
