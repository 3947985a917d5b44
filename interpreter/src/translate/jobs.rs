//! Jobs on their way to items. In: the text of a job, what is in force. Out: moves, formulas, traces, and
//! what its file sets.

use gcode::files::ToolTable;
use gcode::{Job, Place};
use protocol::Code;

use super::Translator;
use crate::job::{Coolant, InForce, Move, Planned, Setup};

impl Translator {
    /// A job: what its file sets, moves to the work, the work, moves away.
    pub(super) fn take_job(&mut self, place: Place, source: &Job, tools: &ToolTable) {
        let in_force = InForce {
            machine: &self.machine,
            frame: &self.modal.frame,
            feed_mm_min: self.modal.feed_mm_min(),
            rest: self.points.axes_at_rest(),
            spindle_turns: self.spindle.turns(),
        };
        let ready = match self.jobs.plan(place, source, tools, &in_force) {
            Ok(ready) => ready,
            Err((place, problem)) => return self.output.report(place, problem),
        };
        for (place, warning) in ready.warnings {
            self.output.report(place, warning);
        }
        if let Some(setup) = ready.setup {
            self.set_up(place.line, &setup);
        }
        let Planned { approach, formulas, traces, end, retract, .. } = ready.planned;
        self.go(place.line, &approach);
        for (slot, formula) in (0..).zip(formulas) {
            self.push(place.line, Code::Formula { slot, formula });
        }
        for trace in traces {
            self.push(place.line, Code::Work(trace));
        }
        if let Some(block) = &mut self.block {
            block.forget();
        }
        self.points.axes_rest_at(&end);
        self.go(place.line, &retract);
        self.points.program_follows_axes();
    }

    /// Tool, spindle and coolant of a job file.
    fn set_up(&mut self, line: u32, setup: &Setup) {
        let tool = setup.tool.and_then(|number| self.auxiliary.select_tool(number));
        self.zero_is_of_job();
        self.push_some(line, tool);
        if let Some(rpm) = setup.spindle_rpm {
            self.spindle.turn(rpm);
        }
        let coolant = self.auxiliary.coolant(setup.coolant == Coolant::Mist, setup.coolant == Coolant::Flood);
        self.push_some(line, coolant);
    }

    /// Moves around the work of a job.
    fn go(&mut self, line: u32, moves: &[Move]) {
        for step in moves {
            self.push(line, Code::Line { target: step.to, feed: step.feed });
            self.points.axes_rest_at(&step.to);
        }
    }
}
