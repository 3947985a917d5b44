//! The modules beside the plant, and what each of them got and said last. In, each control cycle: a
//! measurement. Out: drive commands, the spindle command in force, statuses. Each module has its moment in
//! the cycle, and lives, is frozen or dead.

use interpolator::{Interpolator, Out};
use machine::Machine;
use protocol::{
    Axis, AxisFrame, AxisStatus, CodePacket, Cycle, DriveCommand, Item, MachineStatus, Measurement, Module,
    PerAxis, SpindleCommand, units::AXES,
};
use regulator::Regulator;
use sim_plant::Packet;

use crate::lives::{Desk, Life};
use crate::wires::{Disturbed, Tamperer, Wires};

/// Measurements and frames that wait for a module at most, as in the channels between processes.
const MEASUREMENTS: usize = 64;
const TICKS: usize = 16;
/// Who starts the processes takes an interpreter that says nothing for so long for dead, s.
const PATIENCE_S: f64 = 1.0;

/// The regulator of an axis, and what waits for it.
#[derive(Clone)]
struct Governor {
    axis: Axis,
    regulator: Regulator,
    desk: Desk<(Measurement, Option<AxisFrame>)>,
}

impl Governor {
    /// The regulator answers what arrives, or, if that has to wait, what has waited: its last answer.
    fn cycle(&mut self, arrives: Option<regulator::In>) -> Option<&regulator::Out> {
        if let Some(input) = arrives {
            if self.desk.is_up_to_date() {
                return Some(self.regulator.tick(&input));
            }
            self.desk.arrives((*input.measurement, input.frame.copied()));
        }
        let ready = self.desk.ready();
        (1..ready).for_each(|_| {
            self.catch_up();
        });
        if ready > 0 { self.catch_up() } else { None }
    }

    /// Its answer to the oldest that waits.
    fn catch_up(&mut self) -> Option<&regulator::Out> {
        let (measurement, frame) = self.desk.take()?;
        Some(self.regulator.tick(&regulator::In { measurement: &measurement, frame: frame.as_ref() }))
    }
}

/// The modules, and the wires between them.
#[derive(Clone)]
pub(crate) struct Modules<I, W> {
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
    /// What each regulator got in this cycle.
    pub(crate) frames: PerAxis<Option<AxisFrame>>,
    /// In force.
    pub(crate) spindle: SpindleCommand,
    /// What the drives go on with.
    pub(crate) drives: PerAxis<DriveCommand>,
    statuses: PerAxis<AxisStatus>,
    /// What the regulators said last.
    pub(crate) seen: Vec<(Axis, AxisStatus)>,
    /// What the interpolator said last.
    pub(crate) machine_status: MachineStatus,
}

impl<I: Iterator<Item = Item>, W: Wires> Modules<I, W> {
    /// Before cycle 0.
    pub(crate) fn new(machine: &Machine, code: I, wires: W) -> Modules<I, W> {
        let governor =
            |axis| Governor { axis, regulator: Regulator::new(machine, axis), desk: Desk::new(MEASUREMENTS) };
        Modules {
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
        }
    }

    /// One control cycle; how many drives go on with the command of an earlier one.
    pub(crate) fn cycle(&mut self, now: Cycle, measurement: &Measurement) -> usize {
        let measurement = &measurement.sealed();
        self.frames = [None; AXES];
        if now.0.is_multiple_of(self.ticks) {
            self.deliver(now);
            self.interpolate(now, measurement);
        }
        self.regulate(now, measurement)
    }

    /// What the last tick made comes into force.
    fn deliver(&mut self, now: Cycle) {
        for Governor { axis, .. } in &self.governors {
            let sent = self.made.as_ref().map(|out| &out.frames[axis.index()]);
            self.frames[axis.index()] = self.wires.frame(now, *axis, sent).copied();
        }
        let sent = self.made.as_ref().map(|out| &out.spindle);
        // What is refused has not arrived.
        if let Some(spindle) = self.wires.spindle(now, sent).filter(|spindle| spindle.check().is_ok()) {
            self.spindle = *spindle;
        }
        self.made = None;
    }

    /// One tick of the interpolator.
    fn interpolate(&mut self, now: Cycle, sent: &Measurement) {
        let arrived =
            self.wires.tick_measurement(now, Some(sent)).filter(|arrived| is_whole(arrived, sent)).copied();
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
            self.turn(Module::Interpreter, Life::Dead);
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

    /// One cycle of every regulator. A drive that gets no command goes on with the one before. How many
    /// answers are late: those that did not come, and those that come of an earlier cycle.
    fn regulate(&mut self, now: Cycle, sent: &Measurement) -> usize {
        let mut late = 0;
        for (governor, seen) in self.governors.iter_mut().zip(&mut self.seen) {
            let (axis, index) = (governor.axis, governor.axis.index());
            let measurement =
                self.wires.measurement(now, axis, Some(sent)).filter(|arrived| is_whole(arrived, sent));
            let frame = self.frames[index].as_ref();
            let out = governor.cycle(measurement.map(|measurement| regulator::In { measurement, frame }));
            let arrived = self.wires.drive(now, axis, out.map(|out| &out.drive));
            if let Some(drive) = arrived.filter(|drive| drive.is_whole()) {
                self.drives[index] = *drive;
            }
            late += usize::from(self.drives[index].cycle < now);
            if let Some(status) = self.wires.status(now, axis, out.map(|out| &out.status)) {
                self.statuses[index] = *status;
            }
            if let Some(out) = out {
                seen.1 = out.status;
            }
        }
        late
    }

    /// Messages are to be tampered with.
    pub(crate) fn tamper(&mut self, packet: &Packet) {
        self.wires.disturbance.take(packet, self.governors.iter().map(|own| own.axis));
    }

    /// A module dies, freezes or thaws.
    pub(crate) fn turn(&mut self, module: Module, life: Life) {
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
        if (module, life) == (Module::Interpreter, Life::Dead) {
            self.interpolator.lost_source();
        }
    }

    /// How a module is, if there is such a module.
    pub(crate) fn life(&self, module: Module) -> Option<Life> {
        match module {
            Module::Interpreter => Some(self.interpreter),
            Module::Interpolator => Some(self.ticks_waiting.life),
            Module::Regulator(axis) => {
                self.governors.iter().find(|own| own.axis == axis).map(|own| own.desk.life)
            }
        }
    }

    /// The wires below those that the scenario tampers with.
    pub(crate) fn wires_mut(&mut self) -> &mut W {
        &mut self.wires.wires
    }
}

/// Whether a measurement has come to no harm; what is still where it was sent from has not been touched.
fn is_whole(arrived: &Measurement, sent: &Measurement) -> bool {
    std::ptr::eq(arrived, sent) || arrived.is_whole()
}
