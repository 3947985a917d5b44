//! What begins at rest: the next item of the program.

use protocol::{
    Arc, AxisCommand, Code, Cycle, Fault, Feed, MachineStatus, Panel, PerAxis, Position, Setpoint,
    ThreadPass, frame::SETPOINT_LEAD,
};

use crate::{
    In, Interpolator,
    block::Block,
    pace::Step,
    task::{Move, Task},
};

/// Items without motion that one tick may work off.
const ITEMS_PER_TICK: usize = 8;

/// Interpolator cycles from arming to the first index that counts: one for the way there, one for the status to come
/// back, one for calling off, one to spare.
const ARMING_TICKS: u64 = 4;

/// Farthest the axes may be from the start of a pass and still be led there by a move of its own, mm.
const START_REACH_MM: f64 = 0.01;

/// How a move starts.
struct Start {
    /// Feed of the plan, mm/s.
    mm_s: f64,
    /// Pace it starts with, 0 to 1.
    ratio: f64,
    /// The plan is for this multiple of the programmed feed.
    planned_ratio: f64,
    /// Speed of the spindle, 1/min.
    rpm: f64,
}

impl Interpolator {
    /// At rest: works off items until one takes time.
    pub(crate) fn begin(&mut self, input: &In, cycle: Cycle, due: Cycle) -> (PerAxis<Setpoint>, AxisCommand) {
        let resting = (self.rest(due), AxisCommand::Stream);
        let panel = &input.measurement.panel;
        if panel.pressed(Panel::STOP) {
            self.stopped = true;
            self.end();
            return resting;
        }
        for _ in 0..ITEMS_PER_TICK {
            self.next = self.next.or_else(|| self.queue.pop());
            let Some(item) = self.next else { return resting };
            let moves = matches!(item.code, Code::Line { .. } | Code::Arc { .. } | Code::Pass(_));
            if moves && panel.pressed(Panel::FEED_HOLD) {
                self.waited = 0;
                return resting;
            }
            self.line = item.line;
            match item.code {
                Code::Line { target, feed } if !self.begin_line(&target, feed, panel) => return resting,
                Code::Arc { arc, feed } if !self.begin_arc(&arc, feed, panel) => return resting,
                Code::Line { .. } | Code::Arc { .. } => {
                    if let Task::Moving(motion) = &self.task {
                        let first = Step { tau: 0.0, ratio: 0.0, ratio_rate: 0.0 };
                        return (motion.block.setpoints(due, &first), AxisCommand::Stream);
                    }
                }
                Code::Dwell { seconds } => {
                    let left = (seconds / self.machine.machine.interpolator_cycle_s).ceil() as u64;
                    self.task = Task::Dwelling { left };
                    self.next = None;
                    return resting;
                }
                Code::PathMode(_) => {} // until the look-ahead takes it: every move ends at rest
                Code::Spindle { mode, speed } => self.spindle.program(mode, speed),
                Code::Tool { .. } => {}
                Code::Coolant { mist, flood } => self.coolant = MachineStatus::coolant(mist, flood),
                Code::Pause => {
                    self.task = Task::Paused { cycle_starts: panel.cycle_starts };
                    self.next = None;
                    return resting;
                }
                Code::Pass(pass) => {
                    let command = self.begin_pass(input, cycle, &pass);
                    return (self.rest(due), command);
                }
                Code::End => {
                    self.end();
                    return resting;
                }
            }
            self.next = None;
        }
        resting
    }

    /// Plans a line; false if it has to wait for the spindle, or cannot be.
    fn begin_line(&mut self, target: &PerAxis<Position>, feed: Feed, panel: &Panel) -> bool {
        if !self.machine.can_reach(target) {
            self.enter_fault(Fault::TravelLimit);
            return false;
        }
        let Some(start) = self.start(feed, panel) else { return false };
        match Block::line(&self.machine, &self.here, target, start.mm_s, start.ratio) {
            Some(block) => self.set_off(block, feed, &start),
            None => self.here = *target,
        }
        true
    }

    /// Plans an arc; false if it has to wait for the spindle, or cannot be.
    fn begin_arc(&mut self, arc: &Arc, feed: Feed, panel: &Panel) -> bool {
        let Ok(corners) = arc.bounds(&self.here) else {
            self.enter_fault(Fault::BadMachineCode);
            return false;
        };
        if !corners.iter().all(|corner| self.machine.can_reach(corner)) {
            self.enter_fault(Fault::TravelLimit);
            return false;
        }
        let Some(start) = self.start(feed, panel) else { return false };
        match Block::arc(&self.machine, &self.here, arc, start.mm_s, start.ratio) {
            Ok(block) => self.set_off(block, feed, &start),
            Err(_) => self.enter_fault(Fault::BadMachineCode),
        }
        true
    }

    /// The feed a move can start with; `None` while it has to wait for the spindle.
    fn start(&self, feed: Feed, panel: &Panel) -> Option<Start> {
        let rpm = self.spindle.observed().abs();
        if feed != Feed::Rapid && !self.spindle.at_speed()
            || matches!(feed, Feed::PerRevolution(_)) && rpm < 1.0
        {
            return None;
        }
        let planned_ratio = asked(feed, panel).max(1.0);
        let mm_s = match feed {
            Feed::Rapid => f64::INFINITY,
            Feed::PerMinute(feed) => feed / 60.0 * planned_ratio,
            Feed::PerRevolution(feed) => feed * rpm / 60.0 * planned_ratio,
        };
        Some(Start { mm_s, ratio: asked(feed, panel) / planned_ratio, planned_ratio, rpm })
    }

    fn set_off(&mut self, block: Block, feed: Feed, start: &Start) {
        let Start { planned_ratio, rpm, .. } = *start;
        self.task = Task::Moving(Move { block, feed, planned_ratio, planned_rpm: rpm, clamped: false });
        self.next = None;
    }

    /// A pass is next: leads the axes to its start, waits for speed and rest, then arms every axis.
    fn begin_pass(&mut self, input: &In, cycle: Cycle, pass: &ThreadPass) -> AxisCommand {
        let mut start = self.here;
        let mut reach = 0.0_f64;
        for axis in self.axes.into_iter().flatten() {
            start[axis.index()] = pass.axis(axis).start;
            reach = reach.max(start[axis.index()].mm_from(self.here[axis.index()]).abs());
        }
        if reach > START_REACH_MM {
            self.enter_fault(Fault::BadMachineCode);
            return AxisCommand::Hold;
        }
        if start != self.here {
            let pending = self.next;
            self.begin_line(&start, Feed::Rapid, &input.measurement.panel);
            self.next = pending;
            return AxisCommand::Stream;
        }
        if !self.machine.can_follow(pass) {
            self.enter_fault(Fault::PassNotFeasible);
            return AxisCommand::Hold;
        }
        if (pass.direction * pass.s_rpm - self.spindle.programmed()).abs() > 1e-9 * pass.s_rpm {
            self.enter_fault(Fault::BadMachineCode);
            return AxisCommand::Hold;
        }
        // The ceiling of this pass holds from here on, so that the spindle settles below it before arming.
        self.spindle.set_ceiling(pass.max_ratio * 100.0);
        // A status tells of rest only when the last setpoint, which lies ahead, has been reached.
        let reached = self.waited > SETPOINT_LEAD;
        let at_rest = reached && self.statuses(input).all(|status| status.in_position != 0);
        if !at_rest || !self.spindle.at_speed() {
            return AxisCommand::Stream;
        }
        self.index_not_before = cycle.after(ARMING_TICKS * self.machine.cycles_per_tick());
        self.pass = pass.pass;
        self.depth_mm = pass.depth_mm;
        self.task = Task::Arming { pass: *pass, sent: cycle };
        self.next = None;
        AxisCommand::Arm {
            pass: pass.pass,
            s_rpm: pass.s_rpm,
            direction: pass.direction,
            not_before: self.index_not_before,
            law: protocol::AxisLaw::default(),
        }
    }
}

/// The multiple of the programmed feed that the panel asks for. A value that is no number asks for a stop.
pub(crate) fn asked(feed: Feed, panel: &Panel) -> f64 {
    let (pct, top) = match feed {
        Feed::Rapid => (panel.rapid_override_pct, 100.0),
        Feed::PerMinute(_) | Feed::PerRevolution(_) => (panel.feed_override_pct, 200.0),
    };
    if pct.is_finite() { pct.clamp(0.0, top) / 100.0 } else { 0.0 }
}
