//! The upper level: one tick each interpolator cycle. What it is doing is a [`Task`]; a tick finds an event,
//! and the task goes one step.

use machine::Machine;
use protocol::{
    Axis, AxisFrame, AxisStatus, CodePacket, Cycle, DriveState, Fault, Feed, Groove, MachineState,
    MachineStatus, Measurement, Panel, PerAxis, Refused, Setpoint, SpindleCommand, ThreadPass,
    frame::SETPOINT_LEAD, units::AXES,
};

use crate::{
    axes::Axes,
    pass::{self, Ready, Stand},
    patience::Patience,
    program::{Next, Program},
    spindle::Spindle,
    task::{Event, Moved, Order, Task, Wait},
    travel::{Hands, Travel},
};

/// What one tick brings.
#[derive(Clone, Copy, Debug)]
pub struct In<'a> {
    /// The measurement of the tick's cycle.
    pub measurement: &'a Measurement,
    /// Status of every axis, of the cycle before.
    pub axes: &'a PerAxis<AxisStatus>,
}

/// What the interpolator answers.
#[derive(Clone, Copy, Debug)]
pub struct Out {
    /// One frame per axis; those of axes that do not exist mean nothing.
    pub frames: PerAxis<AxisFrame>,
    /// To the spindle.
    pub spindle: SpindleCommand,
    /// To the observer.
    pub status: MachineStatus,
}

/// The interpolator. It holds no clock and allocates nothing after `new`.
#[derive(Clone, Debug)]
pub struct Interpolator {
    machine: Machine,
    task: Task,
    program: Program,
    travel: Travel,
    spindle: Spindle,
    patience: Patience,
    /// Number and depth of the pass in hand, or of the one before.
    pass: (u32, f64),
}

impl Interpolator {
    /// An interpolator for a machine.
    pub fn new(machine: &Machine) -> Interpolator {
        Interpolator {
            machine: machine.clone(),
            task: Task::Enabling,
            program: Program::default(),
            travel: Travel::new(machine),
            spindle: Spindle::new(machine),
            patience: Patience::new(machine.general.interpolator_cycle_s),
            pass: (0, 0.0),
        }
    }

    /// Takes an item of machine code.
    ///
    /// # Errors
    /// The item is damaged or out of order; once everything before it is done, a fault is latched.
    pub fn push(&mut self, packet: &CodePacket) -> Result<(), Refused> {
        self.program.push(packet)
    }

    /// Whether items can still be taken: a tick in virtual time waits until this is false.
    pub fn wants(&self) -> bool {
        !self.task.is_over() && self.program.queue.wants()
    }

    /// Items taken off the wire so far.
    pub fn received(&self) -> u64 {
        self.program.queue.received()
    }

    /// No more machine code will come although the program has not ended. What is in the queue is still
    /// executed, then it is a fault.
    pub fn lost_source(&mut self) {
        self.program.queue.lost();
    }

    /// Whether everything is at rest and the machine may be switched off.
    pub fn finished(&self) -> bool {
        match self.task {
            Task::Ended { .. } => true,
            Task::Fault { .. } => self.spindle.stands() && self.patience.waited() > 1,
            _ => false,
        }
    }

    /// One interpolator cycle.
    pub fn tick(&mut self, input: &In) -> Out {
        self.spindle.update(input.measurement);
        self.patience.tick(&self.spindle, matches!(self.task, Task::Cutting(_)));
        self.travel.idle();
        let before = self.task.public();
        if let Some(fault) = self.fault(input) {
            self.step(&Event::Fault(fault));
        }
        let (setpoints, event) = self.work(input);
        let order = self.step(&event);
        self.spindle.at_x(self.travel.here()[Axis::X.index()]);
        if self.task.public() != before {
            self.patience.begin();
        }
        self.answer(input.measurement, &setpoints, &order)
    }

    /// What ends every task.
    fn fault(&self, input: &In) -> Option<Fault> {
        let (axes, spindle) = (Axes::new(&self.machine, input.axes), &self.spindle);
        let turning = spindle.commanded() != 0.0;
        let in_vain = self.patience.is_over(spindle);
        match self.task {
            Task::Fault { .. } | Task::Ended { .. } => None,
            // What is wrong with the program waits until everything before it is done and the axes rest.
            Task::Ready { .. } if self.program.is_broken_off() => Some(Fault::BadMachineCode),
            _ if axes.in_fault() => Some(Fault::AxisFault),
            Task::Enabling | Task::Starting if in_vain => Some(Fault::DriveFault),
            Task::Ready { .. } if in_vain && turning && self.program.in_hand().is_some() => {
                Some(if spindle.at_speed() { Fault::AxisNotInPosition } else { Fault::SpindleNotAtSpeed })
            }
            Task::Armed(_) if in_vain && turning && !axes.begun() => Some(Fault::IndexNotSeen),
            _ if self.patience.stalled(spindle) => Some(Fault::SpindleNotAtSpeed),
            _ => None,
        }
    }

    /// Goes one step, and does what belongs to it.
    fn step(&mut self, event: &Event) -> Order {
        let (over, begun) = (self.task.is_over(), matches!(self.task, Task::Cutting(_)));
        if let (Some(arm), Event::Cut) = (self.task.pass(), event) {
            self.travel.rest_at(std::array::from_fn(|axis| arm.pass.axes[axis].end));
        }
        let order = self.task.step(event);
        match (&order, event) {
            (Order::Arm(arm), _) => self.pass = (arm.pass.pass, arm.pass.depth_mm),
            (_, Event::Begun) => self.program.queue.done(),
            (_, Event::Cut) => {
                self.spindle.set_ceiling(f64::INFINITY);
                if !begun {
                    self.program.queue.done();
                }
            }
            (_, Event::CalledOff) => self.spindle.set_ceiling(f64::INFINITY),
            _ => {}
        }
        if self.task.is_over() && !over {
            self.program.switch_off(&mut self.spindle);
            self.program.queue.done();
            self.travel.clear();
        }
        order
    }

    /// Goes on with the task in hand: the setpoints of this tick, and what came of it.
    fn work(&mut self, input: &In) -> (PerAxis<Setpoint>, Event) {
        let cycle = input.measurement.cycle;
        let due = cycle.after(SETPOINT_LEAD * self.machine.cycles_per_tick());
        let panel = &input.measurement.panel;
        let axes = Axes::new(&self.machine, input.axes);
        let event = match &self.task {
            Task::Enabling => self.take_over(input.measurement),
            Task::Starting if axes.stream() => Event::Streaming,
            Task::Ready { wait } => return self.begin(input, due, wait.after(panel.cycle_starts)),
            Task::Moving { wait, fault } => {
                return self.move_on(panel, due, wait.after(panel.cycle_starts), fault.is_some());
            }
            Task::Dwelling { left } if *left <= 1 || ends(panel) => Event::Over,
            Task::Paused { cycle_starts } if panel.cycle_starts != *cycle_starts || ends(panel) => {
                Event::Over
            }
            task @ (Task::Arming { .. } | Task::Armed(_) | Task::CallingOff { .. } | Task::Cutting(_)) => {
                let taken_back = panel.pressed(Panel::FEED_HOLD) || ends(panel);
                pass::watch(task, &axes, cycle, self.machine.cycles_per_tick(), taken_back)
            }
            Task::Ending { stopped } if self.spindle.stands() && (!stopped || self.led_to_rest()) => {
                Event::Stands
            }
            _ => Event::Nothing,
        };
        (self.travel.rest(due), event)
    }

    /// Once every drive holds its axis, commanded is where it was measured.
    fn take_over(&mut self, measurement: &Measurement) -> Event {
        let mut here = *self.travel.here();
        for (axis, config) in self.machine.axes() {
            let measured = &measurement.axes[axis.index()];
            if measured.drive().state() != Some(DriveState::OperationEnabled) {
                return Event::Nothing;
            }
            here[axis.index()] = config.position(measured);
        }
        self.travel.rest_at(here);
        Event::Enabled
    }

    /// Whether the axes have reached their last setpoint, which lay ahead when they were told to rest.
    fn led_to_rest(&self) -> bool {
        self.patience.waited() > SETPOINT_LEAD
    }

    /// At rest: begins what is next.
    fn begin(&mut self, input: &In, due: Cycle, wait: Wait) -> (PerAxis<Setpoint>, Event) {
        let panel = &input.measurement.panel;
        let event = if ends(panel) {
            Event::Ends(true)
        } else if wait != Wait::No {
            self.patience.begin();
            Event::Waits(wait)
        } else {
            let held = panel.pressed(Panel::FEED_HOLD);
            match self.program.next(held, &mut self.spindle, self.travel.route()) {
                Next::Nothing => Event::Waits(Wait::No),
                Next::Held => {
                    self.patience.begin();
                    Event::Waits(Wait::No)
                }
                Next::Move(feed) if !self.spindle.lets(feed) => Event::Waits(Wait::No),
                Next::Move(_) => return self.move_on(panel, due, Wait::No, false),
                Next::Work(work) if !self.spindle.lets(Feed::PerMinute(work.feed_mm_min)) => {
                    Event::Waits(Wait::No)
                }
                Next::Work(work) => match self.travel.begin_work(self.program.line, &work) {
                    Ok(()) => return self.move_on(panel, due, Wait::No, false),
                    Err(fault) => Event::Fault(fault),
                },
                Next::Pass(pass) => self.begin_pass(input, &pass),
                Next::Dwell(seconds) => {
                    Event::Dwells((seconds / self.machine.general.interpolator_cycle_s).ceil() as u64)
                }
                Next::Pause => Event::Pauses(panel.cycle_starts),
                Next::End => Event::Ends(false),
            }
        };
        (self.travel.rest(due), event)
    }

    /// A pass is next: leads the axes to its start, waits for speed and rest, then arms every axis.
    fn begin_pass(&mut self, input: &In, pass: &ThreadPass) -> Event {
        let stand = Stand {
            machine: &self.machine,
            here: self.travel.here(),
            axes: &Axes::new(&self.machine, input.axes),
            cycle: input.measurement.cycle,
            rested: self.patience.waited(),
        };
        match pass::prepare(pass, &stand, &mut self.spindle) {
            Ok(Ready::Arm(arm)) => Event::Pass(arm, input.measurement.cycle),
            Ok(Ready::Wait) => Event::Waits(Wait::No),
            Ok(Ready::Lead(start)) => match self.travel.lead_to(self.program.line, &start) {
                Ok(()) => Event::Moved(Moved::default()),
                Err(fault) => Event::Fault(fault),
            },
            Err(fault) => Event::Fault(fault),
        }
    }

    /// One tick of timed motion.
    fn move_on(&mut self, panel: &Panel, due: Cycle, wait: Wait, stops: bool) -> (PerAxis<Setpoint>, Event) {
        if panel.pressed(Panel::ABORT) {
            self.program.switch_off(&mut self.spindle);
        }
        let hands = Hands { panel, spindle: &self.spindle, wait, stops };
        let (setpoints, moved, line) = self.travel.tick(&mut self.program.queue, &hands, due);
        self.program.line = line.unwrap_or(self.program.line);
        (setpoints, Event::Moved(moved))
    }

    fn answer(&self, measurement: &Measurement, setpoints: &PerAxis<Setpoint>, order: &Order) -> Out {
        let (cycle, line) = (measurement.cycle, self.program.line);
        let mut frames = [AxisFrame::default(); AXES];
        let stop_s = self.machine.stop_s(setpoints);
        for (axis, _) in self.machine.axes() {
            let i = axis.index();
            let frame = AxisFrame::pack(cycle, line, setpoints[i], &order.of(axis));
            frames[i] = AxisFrame { stop_s, ..frame };
        }
        let (state, arm) = (self.task.public(), self.task.pass());
        let pass = arm.map(|arm| &arm.pass);
        let spindle = SpindleCommand {
            cycle,
            rpm: self.spindle.commanded(),
            finished: u32::from(self.finished()),
            line,
            pass: pass.map_or(0, |pass| pass.pass),
            paused: u32::from(state == MachineState::Paused),
            index_not_before: arm.map_or(Cycle(0), |arm| arm.not_before),
            direction: pass.map_or(0.0, |pass| pass.direction),
            groove: pass.map(Groove::of).unwrap_or_default(),
        };
        let queue = &self.program.queue;
        let status = MachineStatus {
            cycle,
            state: state as u32,
            fault: self.task.fault().map_or(0, |fault| fault as u32),
            line,
            pass: self.pass.0,
            moves: self.travel.moves(),
            taken: queue.taken().saturating_sub(self.travel.pending(queue.in_hand())),
            overrides_clamped: self.spindle.clamped(),
            stopped: u16::from(self.task.stopped()),
            coolant: self.program.coolant,
            spindle_rpm: self.spindle.commanded(),
            spindle_override_pct: self.spindle.override_pct(),
            feed_override_pct: measurement.panel.feed_override_pct,
            depth_mm: self.pass.1,
            starved: self.travel.starved(),
            work: self.travel.cutting(),
        };
        Out { frames, spindle, status }
    }
}

/// Whether the operator ends the program.
fn ends(panel: &Panel) -> bool {
    panel.pressed(Panel::STOP) || panel.pressed(Panel::ABORT)
}
