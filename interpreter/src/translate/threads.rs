//! Threads among the calls: what goes on from a G33 that waits, what its retract is, the passes of a cycle.

use gcode::canon::{self, ThreadCycle};
use gcode::{Call, Place, Pose};
use protocol::{Axis, Code, Feed, ThreadPass};

use super::Translator;
use crate::arc;
use crate::modal::Synchronised;
use crate::pass_note::coarse_encoder;
use crate::reach::Done;
use crate::retract;
use crate::spindle::Turning;
use crate::thread::{Blunt, Next, Point, Round};
use crate::threading::{self, in_plane_of, is_apart};

impl Translator {
    /// Whether a call is a thread that goes on from the one that waits.
    pub(super) fn goes_on(&self, call: &Call<'_>) -> bool {
        matches!(call, Call::StraightFeed(_) | Call::ArcFeed(_)) && self.modal.synchronised.is_some()
    }

    /// G33: it is planned when the next move is known. One behind another goes on from it, with no index
    /// between them.
    pub(super) fn thread_move(
        &mut self,
        place: Place,
        (target, round): (&Pose, Option<Round>),
        synchronised: &Synchronised,
    ) -> Done {
        if self.threads.is_blunt() {
            return Err(Blunt::refuses("a thread by G33 (G32)"));
        }
        let turning = Turning { spindle: &self.spindle, frame: &self.modal.frame };
        let of = (place.line, self.threads.waits());
        let told = (synchronised, self.threads.table());
        let single = threading::single(of, (target, round), told, &self.points, turning, &self.machine)?;
        self.spindle.hold(single.s_rpm);
        self.warn_of_encoder(place, synchronised.lead_mm);
        self.gauge_sees_leg(&single, self.threads.waits());
        self.points.thread_goes_to(*target);
        match self.threads.waits() {
            true => self.threads.go_on(single, self.modal.frame.units),
            false => {
                self.threads.hold(place, single, self.origin(), &self.machine);
                Ok(())
            }
        }
    }

    /// G35 and G36 of FANUC: the same along an arc.
    pub(super) fn thread_along_arc(
        &mut self,
        place: Place,
        arc: &canon::Arc,
        synchronised: &Synchronised,
    ) -> Done {
        let [target, centre] = arc::ends(arc, &self.modal);
        self.points.target(target, &self.machine)?;
        let round = Round { centre: threading::in_plane(&centre), counterclockwise: arc.turns > 0 };
        self.thread_move(place, (&target, Some(round)), synchronised)
    }

    /// What a call does behind the G33 that waits with the axis that lifts the tool.
    pub(super) fn behind_thread(&self, call: &Call<'_>) -> Next {
        let (Call::StraightTraverse(to) | Call::StraightFeed(to)) = call else { return Next::Stays };
        let rapid = matches!(call, Call::StraightTraverse(_));
        let to = self.modal.frame.machine(to);
        retract::next(self.points.programmed(), &to, rapid, self.threads.waits_along(), &self.machine)
    }

    /// Plans the G33 that waits.
    pub(super) fn release(&mut self, next: Next) {
        let (rest, along) = (self.points.axes_at_rest(), self.threads.waits_along());
        let Some(released) = self.threads.release(next, &rest, &self.machine) else { return };
        let place = released.place;
        let planned = released.pass.map(|pass| self.pass(place, pass, released.origin));
        self.spindle.release();
        if let Err(problem) = planned {
            return self.refuse(place, *problem);
        }
        if let Some(problem) = retract::no_retract(place.line, next, along) {
            self.output.report(place, *problem);
        }
    }

    /// A threading cycle: every pass of a thread, with the moves between them.
    pub(super) fn thread_cycle(&mut self, place: Place, cycle: &ThreadCycle) -> Done {
        let turning = Turning { spindle: &self.spindle, frame: &self.modal.frame };
        if self.threads.table().is_in_force() {
            return Err(self.threads.table().refuses("a threading cycle"));
        }
        let cycle = threading::cycle_on_machine(cycle, turning, &self.machine)?;
        self.warn_of_encoder(place, cycle.lead_mm);
        let rest = self.points.axes_at_rest();
        let on = (&self.modal.frame, &self.machine);
        let passes = self.threads.cycle(place, &cycle, &rest, on)?;
        self.spindle.hold(cycle.s_rpm);
        for (from, pass) in passes {
            self.line_to(place.line, in_plane_of(self.points.rest(), from), Feed::Rapid);
            self.pass(place, pass, self.origin());
        }
        self.spindle.release();
        let end = in_plane_of(self.points.rest(), Point { x: cycle.from.x, z: cycle.to_z });
        if is_apart(self.points.rest(), &end) {
            self.line_to(place.line, end, Feed::Rapid);
        }
        self.points.program_goes_to(end);
        Ok(())
    }

    pub(super) fn pass(&mut self, place: Place, pass: ThreadPass, origin: Point) {
        for problem in self.threads.take_doubts() {
            self.output.report(place, problem);
        }
        self.part_sees_pass(place, &pass, origin);
        let end = Point { x: pass.axis(Axis::X).end.mm(), z: pass.axis(Axis::Z).end.mm() };
        self.points.axes_go_to(in_plane_of(self.points.rest(), end));
        let tells = self.threads.tells(pass.pass);
        self.push_some(place.line, tells);
        self.push(place.line, Code::Pass(pass));
    }

    pub(super) fn warn_of_encoder(&mut self, place: Place, lead_mm: f64) {
        if let Some(warning) = coarse_encoder(place.line, lead_mm, &self.machine) {
            self.output.report(place, *warning);
        }
    }
}
