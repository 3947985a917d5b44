//! A tool that has not left a thread when the run ends. In: passes as they end, and every control cycle what
//! is measured, mm. Out: a warning that says where the tool stands and how to free it.
//!
//! An axis without torque cannot lift the tool off. Only what is measured is asked, not the truth: whoever
//! stands at a machine has no more.

use machine::Machine;
use protocol::{Axis, Cycle, Measurement, PerAxis, Position, ThreadPass, units::AXES};

use super::{FaultReport, Outcome};

/// The warning of a tool that has not left a thread.
pub const TOOL_IN_THREAD: &str = "tool-in-thread";

/// Where the tool is, as far as that is measured.
#[derive(Clone)]
pub(super) struct Inside {
    /// The last pass, as long as the axis that lifts has not got free of it, and whether it was cut to its
    /// end: without a retract the tool is still in it then.
    pass: Option<(ThreadPass, bool)>,
    at: PerAxis<Position>,
    cycle: Cycle,
}

impl Inside {
    pub(super) fn new() -> Inside {
        Inside { pass: None, at: [Position(0); AXES], cycle: Cycle(0) }
    }

    /// A pass is over, and was cut to its end or not.
    pub(super) fn ends(&mut self, pass: ThreadPass, complete: bool) {
        self.pass = Some((pass, complete));
        self.look();
    }

    /// Takes what is measured in a control cycle.
    pub(super) fn cycle(&mut self, machine: &Machine, measurement: &Measurement) {
        self.cycle = measurement.cycle;
        for (axis, config) in machine.axes() {
            self.at[axis.index()] = config.position(&measurement.axes[axis.index()]);
        }
        self.look();
    }

    /// A tool that is out of the groove is forgotten.
    fn look(&mut self) {
        self.pass = self.pass.filter(|(pass, _)| !pass.out.is_free(self.at[pass.out.axis as usize]));
    }

    /// What the operator has to know at the end of the run. A program that is done may leave its tool where
    /// it wants to.
    pub(super) fn warning(&self, machine: &Machine, outcome: Outcome) -> Option<FaultReport> {
        let (pass, complete) = self.pass?;
        if complete && outcome == Outcome::Completed {
            return None;
        }
        let (lifts, _) = machine.axes().find(|(axis, _)| axis.index() == pass.out.axis as usize)?;
        let linear = machine.axes().filter(|(axis, _)| !axis.is_rotary());
        let places: Vec<String> =
            linear.map(|(axis, _)| format!("{axis} {:.3}", self.at[axis.index()].mm())).collect();
        let lathe = machine.general.kinematics == machine::Kinematics::Lathe;
        let measure = if lathe { "mm of the machine, X as a radius" } else { "mm of the machine" };
        if pass.returns() {
            let text = format!(
                "the tap stands in the hole of pass {}, at {} ({measure}); do not start the \
                 spindle, and move no axis: open the tap holder and turn the tap out by hand, or turn the spindle \
                 backwards by hand a turn for every {:.3} mm that {lifts} goes out, then start again",
                pass.pass,
                places.join(" "),
                pass.lead_mm.abs(),
            );
            return Some(self.told(lifts, text));
        }
        let text = format!(
            "the tool stands in the thread of pass {}, at {} ({measure}); do not start the \
             spindle, and move no other axis: move {lifts} by hand to {:.3}, out of the groove, then start again",
            pass.pass,
            places.join(" "),
            pass.out.clear.mm(),
        );
        Some(self.told(lifts, text))
    }

    fn told(&self, lifts: Axis, text: String) -> FaultReport {
        let (source, code) = (format!("axis-{}", lifts.name()), TOOL_IN_THREAD.into());
        FaultReport { cycle: self.cycle.0, source, code, text }
    }
}
