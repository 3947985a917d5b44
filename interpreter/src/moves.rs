//! Straight moves and arcs. In: calls. Out: lines and arcs to absolute points within the travel.

use gcode::canon::{self, A, B, C, FeedMode, Plane, X, Y, Z};
use gcode::problem::{Blame, short};
use gcode::{Place, Problem};
use protocol::{Axis, Code, Feed, Machine, PerAxis, Position};

use crate::thread::Point;
use crate::translate::{Done, Translator, missing, no_axis};

/// Positions closer than this are one, mm or degrees: the quantum of the wire.
pub(crate) const SAME: f64 = 1e-9;

impl Translator {
    /// G0, G1, and the moves of canned cycles.
    pub(crate) fn straight(&mut self, place: Place, to: &gcode::Position, rapid: bool) -> Done {
        let target = self.target(to)?;
        if let (false, Some((lead_mm, start_deg))) = (rapid, self.lead) {
            return self.thread_move(place, target, lead_mm, start_deg);
        }
        if positions(target) == positions(self.rest) {
            (self.point, self.after_thread) = (target, false);
            return Ok(());
        }
        if !rapid {
            self.at_programmed_point()?;
        }
        let feed = if rapid { Feed::Rapid } else { self.feed_of_move()? };
        (self.point, self.after_thread) = (target, false);
        self.line_to(place.line, target, feed);
        Ok(())
    }

    /// Refuses to cut from where a thread ran beyond its end.
    fn at_programmed_point(&self) -> Done {
        if positions(self.point) == positions(self.rest) {
            return Ok(());
        }
        let message =
            "the thread before ran out beyond its end (run_out = \"beyond\"), and this cut would begin there";
        let help = "let a G0 follow the thread";
        Err(Problem::error("cut-after-thread", Blame::Block, message, help))
    }

    /// A line, unless the axes rest there already.
    pub(crate) fn line_to(&mut self, line: u32, target: Point, feed: Feed) {
        if positions(target) != positions(self.rest) {
            self.push(line, Code::Line { target: positions(target), feed });
            self.rest = target;
        }
    }

    /// G2, G3 in the plane of the lathe.
    pub(crate) fn arc(&mut self, place: Place, arc: &canon::Arc) -> Done {
        if self.plane != Plane::Xz {
            return Err(missing(
                "an arc outside the plane of X and Z",
                "choose the plane of the lathe with G18",
            ));
        }
        if self.lead.is_some() {
            return Err(missing("a thread along an arc", "cut it along lines"));
        }
        let [z, x] = arc.end;
        let [a, b, c] = arc.rotary;
        let target = self.target(&[x, arc.along, z, a, b, c])?;
        let center = self.frame.point(arc.center[1], arc.center[0]);
        self.at_programmed_point()?;
        let feed = self.feed_of_move()?;
        let from = positions(self.rest);
        let center = [Position::from_mm(center.z), Position::from_mm(center.x)];
        let plane = protocol::Plane::Zx;
        let arc = protocol::Arc { plane, target: positions(target), center, turns: arc.turns };
        let [lowest, highest] = arc.bounds(&from).map_err(|refused| {
            let help = "check the end point and the centre (I, K) or the radius (R)";
            Problem::error("bad-arc", Blame::Block, format!("the arc cannot be made: {refused}"), help)
        })?;
        for corner in [lowest, highest] {
            for axis in [Axis::X, Axis::Z] {
                within_travel(&self.machine, axis, corner[axis.index()].mm(), Blame::Block)?;
            }
        }
        (self.point, self.rest, self.after_thread) = (target, target, false);
        self.push(place.line, Code::Arc { arc, feed });
        Ok(())
    }

    /// The point of the machine that a programmed position means, refused if it lies outside the travel. What has
    /// been refused before is not refused again before it changes.
    fn target(&mut self, to: &gcode::Position) -> Result<Point, Box<Problem>> {
        let asked = self.frame.machine(to);
        let before = std::mem::replace(&mut self.asked, asked);
        let new = |axis: usize| asked[axis] != before[axis];
        if let Some((axis, name)) = [(Y, 'Y'), (A, 'A'), (B, 'B'), (C, 'C')]
            .into_iter()
            .find(|(axis, _)| new(*axis) && asked[*axis].abs() > SAME)
        {
            return Err(no_axis(name, asked[axis]));
        }
        let target = Point { x: asked[X], z: asked[Z] };
        for (index, axis, at) in [(X, Axis::X, target.x), (Z, Axis::Z, target.z)] {
            if new(index) {
                within_travel(&self.machine, axis, at, Blame::Word(if index == X { 'X' } else { 'Z' }))?;
            }
        }
        Ok(target)
    }

    fn feed_of_move(&self) -> Result<Feed, Box<Problem>> {
        if self.feed <= 0.0 {
            let help = "add an F word to this block or one before; G94 and G95 each need their own";
            return Err(Problem::error("no-feed", Blame::Block, "the move has no feed", help));
        }
        match self.feed_mode {
            FeedMode::PerRevolution if self.turning().is_none() => {
                let message = "feed per revolution (G95) with a spindle that does not turn";
                let help = "start it before, as in S600 M3, or use G94";
                Err(Problem::error("spindle-not-turning", Blame::Block, message, help))
            }
            FeedMode::PerRevolution => Ok(Feed::PerRevolution(self.feed)),
            FeedMode::PerMinute | FeedMode::InverseTime => Ok(Feed::PerMinute(self.feed)),
        }
    }
}

/// Refuses a position outside the travel of its axis.
pub(crate) fn within_travel(machine: &Machine, axis: Axis, mm: f64, blame: Blame) -> Done {
    let [low, high] = machine.axis.get(&axis).map_or([0.0, 0.0], |config| config.travel_mm);
    if (low..=high).contains(&mm) {
        return Ok(());
    }
    let note = if axis == Axis::X { " (radius)" } else { "" };
    let message = format!(
        "{axis} at {} mm{note} is outside axis.{}.travel_mm = [{}, {}]",
        short(mm),
        axis.name(),
        short(low),
        short(high)
    );
    let help = "keep the target within the travel; check units (G20, G21), G7, G91 and offsets";
    Err(Problem::error("travel-limit", blame, message, help))
}

/// A point as the wire carries it.
pub(crate) fn positions(point: Point) -> PerAxis<Position> {
    let mut positions = PerAxis::<Position>::default();
    positions[Axis::X.index()] = Position::from_mm(point.x);
    positions[Axis::Z.index()] = Position::from_mm(point.z);
    positions
}
