//! The upper level: one tick each interpolator cycle.

use protocol::{
    Axis, AxisCommand, AxisFrame, AxisState, AxisStatus, Code, CodePacket, Cycle, DriveState, Fault, Item,
    Machine, MachineState, MachineStatus, Measurement, Panel, PerAxis, Position, Refused, Setpoint,
    SpindleCommand, SpindleMode, SpindleSpeed, StatusWord, ThreadPass, frame::SETPOINT_LEAD, units::AXES,
};

use crate::{queue::Queue, spindle::Spindle, task::Task, travel::Travel};

/// Longest wait for drives, spindle, rest or index before it is a fault, s; three turns of the spindle are added.
const PATIENCE_S: f64 = 30.0;

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
    pub(crate) axes: [Option<Axis>; AXES],
    pub(crate) queue: Queue,
    pub(crate) spindle: Spindle,
    pub(crate) task: Task,
    pub(crate) next: Option<Item>,
    pub(crate) here: PerAxis<Position>,
    pub(crate) line: u32,
    pub(crate) pass: u32,
    pub(crate) depth_mm: f64,
    /// Bits of [`MachineStatus::coolant`].
    pub(crate) coolant: u16,
    pub(crate) index_not_before: Cycle,
    pub(crate) travel: Travel,
    pub(crate) waited: u64,
    /// Ticks for which the spindle has hardly turned although it shall.
    stalled: u64,
    pub(crate) stopped: bool,
    refused: bool,
    source_lost: bool,
    /// Commanded has been taken over from measured.
    taken_over: bool,
}

impl Interpolator {
    /// An interpolator for a machine.
    pub fn new(machine: &Machine) -> Interpolator {
        let mut axes = [None; AXES];
        machine.axes().for_each(|(axis, _)| axes[axis.index()] = Some(axis));
        Interpolator {
            machine: machine.clone(),
            axes,
            queue: Queue::default(),
            spindle: Spindle::new(machine),
            task: Task::Starting,
            next: None,
            here: [Position(0); AXES],
            line: 0,
            pass: 0,
            depth_mm: 0.0,
            coolant: 0,
            index_not_before: Cycle(0),
            travel: Travel::new(machine),
            waited: 0,
            stalled: 0,
            stopped: false,
            refused: false,
            source_lost: false,
            taken_over: false,
        }
    }

    /// Takes an item of machine code.
    ///
    /// # Errors
    /// The item is damaged or out of order; once everything before it is done, a fault is latched.
    pub fn push(&mut self, packet: &CodePacket) -> Result<(), Refused> {
        self.queue.push(packet).inspect_err(|_| self.refused = true)
    }

    /// Whether items can still be taken: a tick in virtual time waits until this is false.
    pub fn wants(&self) -> bool {
        let over = matches!(self.task, Task::Ending | Task::Ended | Task::Fault { .. });
        !over && !self.refused && !self.source_lost && self.queue.wants()
    }

    /// Items taken off the wire so far.
    pub fn received(&self) -> u64 {
        self.queue.received()
    }

    /// No more machine code will come although the program has not ended. What is in the queue is still executed,
    /// then it is a fault.
    pub fn lost_source(&mut self) {
        self.source_lost = true;
    }

    /// Whether everything is at rest and the machine may be switched off.
    pub fn finished(&self) -> bool {
        match self.task {
            Task::Ended => true,
            Task::Fault { .. } => self.spindle.stands() && self.waited > 1,
            _ => false,
        }
    }

    /// One interpolator cycle.
    pub fn tick(&mut self, input: &In) -> Out {
        let cycle = input.measurement.cycle;
        self.spindle.update(input.measurement);
        // Nobody waits in vain while the operator holds the spindle at 0, or while a pass is cut, however slowly.
        let cutting = matches!(self.task, Task::Threading { .. }) && self.begun(input);
        self.waited = if self.spindle.held() || cutting { 0 } else { self.waited + 1 };
        self.stalled = if self.spindle.stalls() { self.stalled + 1 } else { 0 };
        self.travel.tracing.cutting = 0;
        let before = self.task.public();
        match self.fault(input) {
            // What does not stop the axes by itself stops them on their path.
            Some(fault) if matches!(self.task, Task::Moving) && fault != Fault::AxisFault => {
                self.travel.fault.get_or_insert(fault);
            }
            Some(fault) => self.enter_fault(fault),
            None => {}
        }
        let (setpoints, command) = self.work(input, cycle);
        self.spindle.at_x(self.here[Axis::X.index()]);
        if self.task.public() != before {
            self.waited = 0;
        }
        self.answer(cycle, &setpoints, command, &input.measurement.panel)
    }

    /// What ends every task.
    fn fault(&self, input: &In) -> Option<Fault> {
        if matches!(self.task, Task::Fault { .. } | Task::Ended) {
            return None;
        }
        // What is wrong with the program waits until everything before it is done and the axes rest.
        let ran_dry = matches!(self.task, Task::Ready) && self.next.is_none() && self.queue.is_empty();
        if ran_dry && (self.refused || self.source_lost) {
            return Some(Fault::BadMachineCode);
        }
        if self.statuses(input).any(|status| status.state == AxisState::Fault as u32) {
            return Some(Fault::AxisFault);
        }
        let turning = self.spindle.commanded() != 0.0;
        let turn_s = if turning { 60.0 / self.spindle.commanded().abs() } else { 0.0 };
        let patience = ((PATIENCE_S + 3.0 * turn_s) / self.machine.machine.interpolator_cycle_s) as u64;
        match self.task {
            Task::Starting if self.waited > patience => Some(Fault::DriveFault),
            Task::Ready if self.next.is_some() && self.waited > patience && turning => {
                Some(if self.spindle.at_speed() {
                    Fault::AxisNotInPosition
                } else {
                    Fault::SpindleNotAtSpeed
                })
            }
            Task::Threading { .. } if self.waited > patience && turning && !self.begun(input) => {
                Some(Fault::IndexNotSeen)
            }
            _ if self.stalled > patience => Some(Fault::SpindleNotAtSpeed),
            _ => None,
        }
    }

    /// Once every drive holds its axis, commanded is where it was measured; false until then.
    fn take_over(&mut self, measurement: &Measurement) -> bool {
        for axis in self.axes.into_iter().flatten() {
            let measured = &measurement.axes[axis.index()];
            if StatusWord(measured.status_word as u16).state() != Some(DriveState::OperationEnabled) {
                return false;
            }
            let config = self.machine.axis.get(&axis);
            self.here[axis.index()] = config.map_or(measured.position, |config| config.position(measured));
        }
        true
    }

    pub(crate) fn enter_fault(&mut self, fault: Fault) {
        let threading = matches!(self.task, Task::Threading { .. });
        self.switch_off();
        self.task = Task::Fault { fault, threading };
    }

    /// Goes on with the task in hand: the setpoints of this tick, and the command that goes with them.
    fn work(&mut self, input: &In, cycle: Cycle) -> (PerAxis<Setpoint>, AxisCommand) {
        let due = cycle.after(SETPOINT_LEAD * self.machine.cycles_per_tick());
        let panel = &input.measurement.panel;
        match self.task {
            Task::Starting => {
                if !self.taken_over {
                    self.taken_over = self.take_over(input.measurement);
                    return (self.rest(due), AxisCommand::Hold);
                }
                if self.statuses(input).all(|status| status.state == AxisState::Streaming as u32) {
                    self.task = Task::Ready;
                }
                (self.rest(due), AxisCommand::Stream)
            }
            Task::Ready => self.begin(input, cycle, due),
            Task::Moving => (self.go_on(panel, due), AxisCommand::Stream),
            Task::Dwelling { left } => {
                let over = left <= 1 || ends(panel);
                self.task = if over { Task::Ready } else { Task::Dwelling { left: left - 1 } };
                (self.rest(due), AxisCommand::Stream)
            }
            Task::Paused { cycle_starts } => {
                if panel.cycle_starts != cycle_starts || ends(panel) {
                    self.task = Task::Ready;
                }
                (self.rest(due), AxisCommand::Stream)
            }
            Task::Arming { pass, sent } => (self.rest(due), self.watch_arming(input, cycle, pass, sent)),
            Task::Threading { pass } => (self.rest(due), self.watch_pass(input, &pass)),
            Task::Ending => {
                if self.spindle.stands() {
                    self.task = Task::Ended;
                }
                (self.rest(due), AxisCommand::Stream)
            }
            Task::Ended => (self.rest(due), AxisCommand::Stream),
            Task::Fault { fault, threading } => {
                let command = match (threading, fault) {
                    (true, Fault::IndexNotSeen) => AxisCommand::CallOff,
                    (true, _) => AxisCommand::Hold,
                    (false, Fault::AxisFault) => AxisCommand::Stop,
                    (false, Fault::PassCalledOff) => AxisCommand::CallOff,
                    (false, _) => AxisCommand::Hold,
                };
                (self.rest(due), command)
            }
        }
    }

    /// Two ticks after arming every axis must have said so; else the pass is called off everywhere, in time.
    fn watch_arming(&mut self, input: &In, cycle: Cycle, pass: ThreadPass, sent: Cycle) -> AxisCommand {
        if cycle < sent.after(2 * self.machine.cycles_per_tick()) {
            return AxisCommand::Hold;
        }
        let armed = |status: &AxisStatus| status.pass == pass.pass && status.state == AxisState::Armed as u32;
        if self.statuses(input).all(armed) {
            self.task = Task::Threading { pass };
            AxisCommand::Hold
        } else {
            self.enter_fault(Fault::PassCalledOff);
            AxisCommand::CallOff
        }
    }

    /// Waits for the end of a pass. Until the index is seen, feed hold and stop still take it back: at the earliest an
    /// axis moves ten control cycles after that index, and the frame that calls the pass off acts before.
    fn watch_pass(&mut self, input: &In, pass: &ThreadPass) -> AxisCommand {
        let panel = &input.measurement.panel;
        if !self.begun(input) && (panel.pressed(Panel::FEED_HOLD) || ends(panel)) {
            self.next = Some(Item { line: self.line, code: Code::Pass(*pass) });
            self.task = Task::Ready;
            return AxisCommand::CallOff;
        }
        if self.statuses(input).all(|status| status.state == AxisState::Streaming as u32) {
            for axis in self.axes.into_iter().flatten() {
                self.here[axis.index()] = pass.axis(axis).end;
            }
            self.spindle.set_ceiling(f64::INFINITY);
            self.task = Task::Ready;
        }
        AxisCommand::Hold
    }

    /// Whether any axis has seen the index of the pass.
    fn begun(&self, input: &In) -> bool {
        self.statuses(input)
            .any(|status| status.state > AxisState::Armed as u32 && status.state < AxisState::Fault as u32)
    }

    /// The state as others see it.
    fn state(&self) -> MachineState {
        match self.task.public() {
            MachineState::Moving | MachineState::Ready if self.travel.waits.is_some() => MachineState::Paused,
            state => state,
        }
    }

    pub(crate) fn end(&mut self) {
        self.switch_off();
        self.task = Task::Ending;
    }

    /// Spindle and coolant; nothing more begins.
    fn switch_off(&mut self) {
        self.spindle_and_coolant_off();
        self.travel.clear();
        self.next = None;
    }

    pub(crate) fn spindle_and_coolant_off(&mut self) {
        self.spindle.program(SpindleMode::Stop, SpindleSpeed::Rpm(0.0));
        self.coolant = 0;
    }

    pub(crate) fn statuses<'a>(&self, input: &In<'a>) -> impl Iterator<Item = &'a AxisStatus> + use<'a> {
        let (axes, statuses) = (self.axes, input.axes);
        axes.into_iter().flatten().map(move |axis| &statuses[axis.index()])
    }

    pub(crate) fn rest(&self, cycle: Cycle) -> PerAxis<Setpoint> {
        std::array::from_fn(|axis| Setpoint { cycle, position: self.here[axis], ..Setpoint::default() })
    }

    fn answer(
        &self,
        cycle: Cycle,
        setpoints: &PerAxis<Setpoint>,
        command: AxisCommand,
        panel: &Panel,
    ) -> Out {
        let mut frames = [AxisFrame::default(); AXES];
        for axis in self.axes.into_iter().flatten() {
            let mut own = command;
            if let (AxisCommand::Arm { law, .. }, Some(pass)) = (&mut own, self.task.pass()) {
                *law = *pass.axis(axis);
            }
            frames[axis.index()] = AxisFrame::pack(cycle, self.line, setpoints[axis.index()], &own);
        }
        let pass = self.task.pass();
        let fault = if let Task::Fault { fault, .. } = self.task { fault as u32 } else { 0 };
        let spindle = SpindleCommand {
            cycle,
            rpm: self.spindle.commanded(),
            finished: u32::from(self.finished()),
            line: self.line,
            pass: pass.map_or(0, |pass| pass.pass),
            paused: u32::from(self.state() == MachineState::Paused),
            index_not_before: self.index_not_before,
            direction: pass.map_or(0.0, |pass| pass.direction),
            groove: pass.map(ThreadPass::groove).unwrap_or_default(),
        };
        let status = MachineStatus {
            cycle,
            state: self.state() as u32,
            fault,
            line: self.line,
            pass: self.pass,
            moves: self.travel.moves,
            taken: self.queue.taken().saturating_sub(self.travel.pending(self.next.as_ref())),
            overrides_clamped: self.spindle.clamped(),
            stopped: u16::from(self.stopped),
            coolant: self.coolant,
            spindle_rpm: self.spindle.commanded(),
            spindle_override_pct: self.spindle.override_pct(),
            feed_override_pct: panel.feed_override_pct,
            depth_mm: self.depth_mm,
            starved: self.travel.starved,
            tracing: self.travel.tracing.cutting,
        };
        Out { frames, spindle, status }
    }
}

/// Whether the operator ends the program.
pub(crate) fn ends(panel: &Panel) -> bool {
    panel.pressed(Panel::STOP) || panel.pressed(Panel::ABORT)
}
