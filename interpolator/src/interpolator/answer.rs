//! What a tick answers: frames to the axes, the spindle command, the status. In: the setpoints and the order
//! of the tick.

use protocol::{
    AxisFrame, Cycle, Groove, MachineStatus, Measurement, PerAxis, Setpoint, SpindleCommand, units::AXES,
};

use crate::{
    interpolator::{Interpolator, Out},
    task::Order,
};

impl Interpolator {
    /// What the plant is told of the end: that all is over, or that the spindle does not obey.
    fn ends(&self) -> u32 {
        if self.finished() {
            SpindleCommand::FINISHED
        } else if self.opened {
            SpindleCommand::EMERGENCY_STOP
        } else {
            0
        }
    }

    pub(crate) fn answer(
        &self,
        measurement: &Measurement,
        setpoints: &PerAxis<Setpoint>,
        order: &Order,
    ) -> Out {
        let (cycle, line) = (measurement.cycle, self.program.line);
        let mut frames = [AxisFrame::default(); AXES];
        let stop_s = self.machine.stop_s(setpoints);
        for (axis, _) in self.machine.axes() {
            let i = axis.index();
            frames[i] = AxisFrame::pack(cycle, line, setpoints[i], stop_s, &order.of(axis));
        }
        let (state, arm) = (self.task.public(), self.task.pass());
        let pass = arm.map(|arm| &arm.pass);
        let spindle = SpindleCommand {
            cycle,
            rpm: self.spindle.commanded(),
            finished: self.ends(),
            line,
            pass: pass.map_or(0, |pass| pass.pass),
            paused: u32::from(state.waits_for_start()),
            index_not_before: arm.map_or(Cycle(0), |arm| arm.not_before),
            direction: pass.map_or(0.0, |pass| pass.direction),
            groove: pass.map(Groove::of).unwrap_or_default(),
        };
        let queue = &self.program.queue;
        let fault = self.second.or(self.task.fault());
        let status = MachineStatus {
            cycle,
            state: state as u32,
            fault: fault.map_or(0, |fault| fault as u32),
            line,
            pass: self.pass.0,
            moves: self.travel.moves(),
            taken: queue.taken().saturating_sub(self.travel.pending(queue.in_hand())),
            overrides_clamped: self.spindle.clamped(),
            stopped: u8::from(self.task.stopped()),
            fault_axis: fault
                .and_then(|fault| self.heard.accused(fault))
                .map_or(0, |axis| axis.index() as u8 + 1),
            coolant: self.program.coolant,
            unreferenced: self.references.open(),
            spindle_rpm: self.spindle.commanded(),
            spindle_override_pct: self.spindle.override_pct(),
            feed_override_pct: measurement.panel.feed_override_pct,
            depth_mm: self.pass.1,
            starved: self.travel.starved(),
            work: self.travel.cutting(),
            tool: self.program.tool,
            motion: self.travel.motion() as u32,
            outputs: self.program.outputs.now().digital,
            analog: self.program.outputs.now().analog,
        };
        Out { frames, spindle, status }
    }
}
