//! The upper level: one tick each interpolator cycle. What it is doing is a [`Task`]; a tick finds an event,
//! and the task goes one step.

use std::mem::discriminant;

mod answer;
mod begin;
mod by_hand;
mod passes;
mod referencing;
mod standing;
mod supervise;
mod taps;

use machine::Machine;
use protocol::{
    Axis, AxisFrame, AxisStatus, CodePacket, Cycle, DriveState, Fault, MachineStatus, Measurement, Panel,
    PerAxis, Refused, Setpoint, SpindleCommand, frame::SETPOINT_LEAD,
};

use crate::{
    axes::{Axes, Heard},
    guard::Guard,
    hand::Hand,
    interpolator::standing::Standing,
    pass::{self, Look},
    patience::Patience,
    program::Program,
    reference::References,
    spindle::Spindle,
    tap::Tap,
    task::{Back, Event, Order, Task, Wait},
    travel::{Hands, Travel},
};

/// A measurement that is more ticks ahead than this is damaged, unless the next one is as far ahead.
const MOST_MISSED: u64 = 8;
/// More ticks of motion than this are never made up for.
const MOST_MADE_UP: u64 = 8;

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
    pub(crate) machine: Machine,
    pub(crate) task: Task,
    pub(crate) program: Program,
    pub(crate) travel: Travel,
    pub(crate) spindle: Spindle,
    pub(crate) patience: Patience,
    pub(crate) guard: Guard,
    /// The spindle of a pass that returns.
    pub(crate) tap: Tap,
    /// What the regulators said last.
    pub(crate) heard: Heard,
    /// The panel of this tick; stop and abort stay pressed, however short the press.
    panel: Panel,
    /// The inputs of this tick, bit by bit.
    inputs: u64,
    /// Cycle of the measurement of the last tick.
    last: Option<Cycle>,
    /// A cycle that lay far ahead.
    ahead: Option<Cycle>,
    /// Ticks from the measurement before to this one.
    ticks: u64,
    standing: Standing,
    /// The emergency stop chain is open, since the spindle does not obey; what is wrong besides the fault.
    pub(crate) opened: bool,
    pub(crate) second: Option<Fault>,
    /// Number and depth of the pass in hand, or of the one before.
    pub(crate) pass: (u32, f64),
    /// Blocks by hand.
    hand: Hand,
    /// Reference runs.
    references: References,
}

impl Interpolator {
    /// An interpolator for a machine.
    pub fn new(machine: &Machine) -> Interpolator {
        Interpolator {
            machine: machine.clone(),
            task: Task::Enabling,
            program: Program::new(machine),
            travel: Travel::new(machine),
            references: References::new(machine),
            spindle: Spindle::new(machine),
            patience: Patience::new(machine.general.interpolator_cycle_s),
            guard: Guard::new(),
            tap: Tap::new(machine),
            heard: Heard::new(),
            panel: Panel::default(),
            inputs: 0,
            last: None,
            ahead: None,
            ticks: 1,
            standing: Standing::new(machine),
            opened: false,
            second: None,
            pass: (0, 0.0),
            hand: Hand::default(),
        }
    }

    /// Takes an item of machine code.
    ///
    /// # Errors
    /// The item is damaged or out of order; once everything before it is done, a fault is latched.
    pub fn push(&mut self, packet: &CodePacket) -> Result<(), Refused> {
        self.program.queue.push(packet)
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

    /// One interpolator cycle. A measurement that is not newer than the one of the tick before makes nothing.
    pub fn tick(&mut self, input: &In) -> Option<Out> {
        let measurement = input.measurement;
        let farthest = MOST_MISSED * self.machine.cycles_per_tick();
        if self.last.is_some_and(|last| !measurement.cycle.follows(last, farthest, &mut self.ahead)) {
            return None;
        }
        let since = measurement.cycle.0 - self.last.map_or(0, |last| last.0);
        self.ticks = (since / self.machine.cycles_per_tick()).clamp(1, MOST_MADE_UP);
        self.last = Some(measurement.cycle);
        let cycle_starts = self.look(input);
        self.program.outputs.tick(measurement.cycle);
        self.travel.idle();
        let (task, public) = (discriminant(&self.task), self.task.public());
        if let Some(trouble) = self.trouble(measurement) {
            self.step(&Event::Fault(trouble));
        }
        let (setpoints, event) = self.work(measurement, cycle_starts);
        let order = self.step(&event);
        let order = self.out_of_pass(order, measurement.cycle);
        self.look_after_spindle();
        self.turn_tap(measurement);
        self.end_outputs();
        self.spindle.at_x(self.travel.here()[Axis::X.index()]);
        if (discriminant(&self.task), self.task.public()) != (task, public) {
            self.patience.begin();
        }
        Some(self.answer(measurement, &setpoints, &order))
    }

    /// In fault no axis stays in a pass, whatever became of the frames and statuses before: to one that is in
    /// none, this is to hold.
    fn out_of_pass(&self, order: Order, cycle: Cycle) -> Order {
        match (&self.task, order) {
            (Task::Fault { .. }, Order::Hold | Order::Leave(_)) => Order::Leave(self.leave_at(cycle)),
            _ => order,
        }
    }

    /// Takes in what a tick brings; how often cycle start had been pressed before.
    fn look(&mut self, input: &In) -> u32 {
        let (measurement, cycle_starts) = (input.measurement, self.panel.cycle_starts);
        let ended = self.panel.buttons & (Panel::STOP | Panel::ABORT);
        self.panel = measurement.panel;
        self.inputs = measurement.inputs;
        self.panel.buttons |= ended;
        self.hand.look(&self.panel);
        self.references.look(&self.machine, measurement);
        self.ends_jog_at_switch(measurement);
        self.heard.take(&self.machine, input.axes, measurement.cycle);
        let leaves = matches!(self.task, Task::Leaving { .. });
        self.vary(leaves);
        self.spindle.update(measurement, self.turns_towards(), leaves);
        let axes = Axes::new(&self.machine, &self.heard, measurement.cycle);
        self.standing.update(measurement, axes.rest());
        match self.task {
            Task::Cutting(_) => {
                let speeds = [self.spindle.observed(), self.spindle.programmed()];
                self.guard.tick(&self.machine, &axes, measurement, speeds);
            }
            _ => self.guard = Guard::new(),
        }
        self.spindle.guard(self.guard.share());
        // Nobody waits in vain for a spindle that the operator holds at 0, or while a pass is cut slowly.
        let for_spindle = matches!(self.task, Task::Ready { .. } | Task::Armed(_));
        let cutting = matches!(self.task, Task::Cutting(_));
        let turning = self.taps() && self.tap.goes_on();
        let counts = !(cutting || turning || for_spindle && self.spindle.held());
        self.patience.tick(&self.spindle, counts);
        cycle_starts
    }

    /// Goes one step, and does what belongs to it.
    fn step(&mut self, event: &Event) -> Order {
        let (over, by_hand) = (self.task.is_over(), self.task == Task::ByHand);
        if let Event::Fault(trouble) = event {
            self.heard.accuse(trouble);
        }
        if let (Some(arm), Event::Cut(_)) = (self.task.pass(), event) {
            self.travel.rest_at(std::array::from_fn(|axis| arm.pass.axes[axis].end));
        }
        let order = self.task.step(event);
        match (&order, event) {
            (Order::Arm(arm), _) => self.pass = (arm.pass.pass, arm.pass.depth_mm),
            (_, Event::Over(_)) if by_hand && self.hand.is_given(&self.panel) => {
                self.hand.begins(&self.panel);
                self.program.queue.ask();
            }
            (_, Event::Begun) => self.program.outputs.begun(u64::MAX, Cycle(0)),
            (_, Event::Cut(_)) => {
                self.program.outputs.begun(u64::MAX, Cycle(0));
                self.spindle.set_ceiling(f64::INFINITY);
                self.program.queue.done();
            }
            (_, Event::CalledOff | Event::Left) => self.spindle.set_ceiling(f64::INFINITY),
            _ => {}
        }
        if self.stops_spindle() {
            self.program.switch_off(&mut self.spindle);
        }
        if self.task.is_over() && !over {
            self.program.switch_off(&mut self.spindle);
            self.program.queue.done();
            self.travel.clear();
        }
        order
    }

    /// Goes on with the task in hand: the setpoints of this tick, and what came of it.
    fn work(&mut self, measurement: &Measurement, cycle_starts: u32) -> (PerAxis<Setpoint>, Event) {
        let cycle = measurement.cycle;
        let due = cycle.after(SETPOINT_LEAD * self.machine.cycles_per_tick());
        let panel = &self.panel;
        let axes = Axes::new(&self.machine, &self.heard, cycle);
        let event = match &self.task {
            Task::Enabling => self.take_over(measurement),
            Task::Starting if axes.stream() => Event::Streaming,
            Task::Ready { wait } => return self.begin(measurement, due, wait.after(panel.cycle_starts)),
            Task::Moving { wait, fault, back } => {
                let back = back.map(|back| back.after(panel));
                return self.move_on(due, self.ticks, wait.after(panel.cycle_starts), fault.is_some(), back);
            }
            Task::Referencing { axis, home_offset } => self.sets_reference(*axis, *home_offset, measurement),
            Task::Dwelling { left } if *left <= 1 && self.program.settles() => Event::Over(Wait::No),
            Task::Dwelling { left } if *left <= 1 => Event::Over(Wait::behind_block(panel)),
            Task::Dwelling { .. } if ends(panel) => Event::Over(Wait::No),
            Task::Awaiting(wait) => self.await_input(*wait, cycle),
            task if task.waits_since().is_some_and(|before| panel.cycle_starts != before || ends(panel)) => {
                Event::Over(Wait::No)
            }
            Task::ByHand if self.hand.is_given(panel) || ends(panel) => Event::Over(Wait::No),
            task if task.pass().is_some() => {
                let look = Look {
                    axes: &axes,
                    cycle,
                    tick: self.machine.cycles_per_tick(),
                    panel,
                    cycle_starts,
                    leave_at: self.leave_at(cycle),
                    in_vain: self.patience.is_over(&self.spindle),
                    returned: self.tap.has_turned(),
                };
                let event = pass::watch(task, &look);
                if event == Event::Left {
                    self.travel.rest_at(axes.commanded(self.travel.here()));
                }
                event
            }
            Task::Returning { back, .. } => self.lead_back(cycle, back.after(panel)),
            Task::Ending { stopped } if self.is_at_rest(*stopped) => Event::Stands,
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

    /// So many ticks of timed motion up to `due`: one, and those of measurements that did not come. Only the
    /// last setpoint is sent; the axes interpolate over the others.
    fn move_on(
        &mut self,
        due: Cycle,
        ticks: u64,
        wait: Wait,
        stops: bool,
        back: Option<Back>,
    ) -> (PerAxis<Setpoint>, Event) {
        let panel = &self.panel;
        if panel.pressed(Panel::ABORT) {
            self.program.switch_off(&mut self.spindle);
        }
        let (jog, alone) = (self.references.jog().unwrap_or(self.hand.jog), self.references.runs());
        let hands = Hands { panel, spindle: &self.spindle, wait, stops, back, jog, alone };
        let mut left = ticks;
        loop {
            left -= 1;
            let due = Cycle(due.0 - left * self.machine.cycles_per_tick());
            let (setpoints, moved, line) = self.travel.tick(&mut self.program, &hands, due);
            self.program.line = line.unwrap_or(self.program.line);
            if left == 0 || moved.stands || moved.fault.is_some() || moved.wait != wait {
                return (setpoints, Event::Moved(moved));
            }
        }
    }
}

/// Whether the operator ends the program.
fn ends(panel: &Panel) -> bool {
    panel.pressed(Panel::STOP) || panel.pressed(Panel::ABORT)
}
