//! Rigid taps. In: calls of them, what is in force. Out: passes that return, and notes of them.

use gcode::canon::{X, Z};
use gcode::problem::{Blame, short};
use gcode::{Place, Pose, Problem};
use machine::Kinematics;
use protocol::{Axis, WayOut};

use super::Translator;
use crate::reach::Done;
use crate::spindle::Turning;
use crate::tapping::{self, Tap};
use crate::threading::{SAME, check_lead};

/// Longest dwell at the depth, s.
const LONGEST_S: f64 = 1000.0;
/// A tap farther from the axis of a lathe is no longer on it, mm.
const AXIS_MM: f64 = 0.1;

impl Translator {
    /// In along Z to the target, so many s there, and back to where the tool stands, so many times as fast.
    /// The spindle turns as before then.
    pub(super) fn rigid_tap(&mut self, place: Place, to: &Pose, [faster, dwell_s]: [f64; 2]) -> Done {
        let Some(synchronised) = self.modal.synchronised else {
            let help = "G33.1 gives it with K";
            return Err(Problem::error("bad-value", Blame::Block, "the tap has no lead", help));
        };
        if self.threads.table().is_in_force() {
            return Err(self.threads.table().refuses("a tap"));
        }
        let (from, to) = (*self.points.programmed(), self.modal.frame.machine(to));
        let moved = |coordinate: &usize| (to[*coordinate] - from[*coordinate]).abs() > SAME;
        if let Some(letter) = (0..to.len()).filter(|coordinate| *coordinate != Z).find(moved) {
            let word = ['X', 'Y', 'Z', 'A', 'B', 'C'].get(letter).copied().unwrap_or('X');
            let message = format!("{word} of a tap: it goes in along Z, where the tool stands");
            let help = format!("move {word} in a block before");
            return Err(Problem::error("unused-word", Blame::Word(word), message, help));
        }
        if (to[Z] - from[Z]).abs() < SAME {
            let help = "give Z of its depth";
            return Err(Problem::error("bad-value", Blame::Block, "the tap has no depth", help));
        }
        self.warn_beside_the_axis(place);
        self.points.target(to, &self.machine)?;
        self.points.at_programmed_point()?;
        let turning = Turning { spindle: &self.spindle, frame: &self.modal.frame };
        let (s_rpm, direction) = turning.taps(&self.machine)?;
        let ratio = tapping::return_ratio(faster, 'I')?;
        if !(0.0..=LONGEST_S).contains(&dwell_s) {
            let message = format!("a tap cannot dwell {} s", short(dwell_s));
            let help = format!("give 0 to {LONGEST_S} s");
            return Err(Problem::error("bad-value", Blame::Word('P'), message, help));
        }
        let tap = Tap {
            s_rpm,
            direction,
            units: self.modal.frame.units,
            from_mm: from[Z],
            to_mm: to[Z],
            lead_mm: synchronised.lead_mm,
            return_ratio: ratio,
            dwell_s,
            leaves: 0,
        };
        self.tap(place, tap)
    }

    /// A lathe has its hole where the spindle turns: beside its axis a tap breaks.
    fn warn_beside_the_axis(&mut self, place: Place) {
        let x_mm = self.points.programmed()[X] - self.origin().x;
        if self.machine.general.kinematics != Kinematics::Lathe || x_mm.abs() <= AXIS_MM {
            return;
        }
        let units = self.modal.frame.units;
        let message = format!("the tap stands {} beside the axis of the spindle", units.length(x_mm.abs()));
        let help = "go to X0 before it";
        self.output.report(place, *Problem::warning("tap-off-axis", Blame::Block, message, help));
    }

    /// One tap from where the tool rests, which it comes back to.
    fn tap(&mut self, place: Place, tap: Tap) -> Done {
        check_lead(tap.lead_mm, 'K', tap.units)?;
        self.warn_of_encoder(place, tap.lead_mm);
        let rest = self.points.axes_at_rest();
        let leaves = self.threads.leaves(self.machine.threading.leaves()) & !WayOut::RETURNS;
        let planned = tapping::plan(&Tap { leaves, ..tap }, &rest, &self.machine)?;
        let pass = self.threads.tap(place, planned, rest[Axis::X.index()].mm());
        self.pass(place, pass, self.origin());
        let back = *self.points.rest();
        self.points.program_goes_to(back);
        Ok(())
    }
}
