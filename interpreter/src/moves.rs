//! Straight moves, arcs, and what the path may do between them. In: calls. Out: lines and arcs to absolute points within
//! the travel; path modes.

use gcode::canon::{self, FeedMode, Plane};
use gcode::problem::{Blame, short};
use gcode::{Place, Problem};
use protocol::machine::Kinematics;
use protocol::{Axis, Code, Feed, Machine, PathMode, PerAxis, Position};

use crate::translate::{Done, Translator, missing};

/// Positions closer than this are one, mm or degrees: the quantum of the wire.
pub(crate) const SAME: f64 = 1e-9;

/// Slowest feed, mm/min: what a chain of moves takes for one.
const LEAST_FEED: f64 = 60.0 * motion::chain::LEAST_FEED;

impl Translator {
    /// G0, G1, and the moves of canned cycles.
    pub(crate) fn straight(&mut self, place: Place, to: &gcode::Position, rapid: bool) -> Done {
        let target = self.target(to)?;
        if let (false, Some((lead_mm, start_deg))) = (rapid, self.lead) {
            return self.thread_move(place, &target, lead_mm, start_deg);
        }
        if self.positions(&target) == self.positions(&self.rest) {
            (self.point, self.after_thread) = (target, false);
            return Ok(());
        }
        if !rapid {
            self.at_programmed_point()?;
        }
        let feed = if rapid { Feed::Rapid } else { self.feed_of_line(&target)? };
        (self.point, self.after_thread) = (target, false);
        self.line_to(place.line, &target, feed);
        Ok(())
    }

    /// Refuses to cut from where a thread ran beyond its end.
    fn at_programmed_point(&self) -> Done {
        if self.positions(&self.point) == self.positions(&self.rest) {
            return Ok(());
        }
        let message =
            "the thread before ran out beyond its end (run_out = \"beyond\"), and this cut would begin there";
        let help = "let a G0 follow the thread";
        Err(Problem::error("cut-after-thread", Blame::Block, message, help))
    }

    /// A line, unless the axes rest there already.
    pub(crate) fn line_to(&mut self, line: u32, target: &gcode::Position, feed: Feed) {
        let to = self.positions(target);
        if to != self.positions(&self.rest) {
            self.push(line, Code::Line { target: to, feed });
            self.rest = *target;
        }
    }

    /// G2, G3, helices.
    pub(crate) fn arc(&mut self, place: Place, arc: &canon::Arc) -> Done {
        self.plane_of_arc()?;
        if self.lead.is_some() {
            return Err(missing("a thread along an arc", "cut it along lines"));
        }
        let (first, second, across) = self.plane.axes();
        let [a, b, c] = arc.rotary;
        let point = |[one, other]: [f64; 2]| {
            let mut point = [0.0, 0.0, 0.0, a, b, c];
            (point[first], point[second], point[across]) = (one, other, arc.along);
            point
        };
        // A move before that could not be made was reported: this arc would begin where it did not end.
        let astray = self.positions(&self.asked) != self.positions(&self.rest);
        let target = self.target(&point(arc.end))?;
        let center = self.frame.machine(&point(arc.center));
        self.at_programmed_point()?;
        let feed = self.feed_of_move(self.feed)?;
        let from = self.positions(&self.rest);
        let arc = protocol::Arc {
            plane: match self.plane {
                Plane::Xy => protocol::Plane::Xy,
                Plane::Xz => protocol::Plane::Zx,
                Plane::Yz => protocol::Plane::Yz,
            },
            target: self.positions(&target),
            center: [center[first], center[second]].map(Position::from_mm),
            turns: arc.turns,
        };
        let [lowest, highest] = match arc.bounds(&from) {
            Ok(corners) => corners,
            Err(_) if astray => return Ok(()),
            Err(refused) => {
                let help = "check the end point and the centre (I, J, K) or the radius (R)";
                let message = format!("the arc cannot be made: {refused}");
                return Err(Problem::error("bad-arc", Blame::Block, message, help));
            }
        };
        for corner in [lowest, highest] {
            for (axis, _) in self.machine.axes() {
                within_travel(&self.machine, axis, corner[axis.index()].mm(), Blame::Block)?;
            }
        }
        (self.point, self.rest, self.after_thread) = (target, target, false);
        self.push(place.line, Code::Arc { arc, feed });
        Ok(())
    }

    /// Refuses arcs in a plane that the machine does not have, or that is turned out of its axes.
    fn plane_of_arc(&self) -> Done {
        let (first, second, _) = self.plane.axes();
        let lacks = |coordinate: usize| {
            let axis = protocol::kinematics::COORDINATES.get(coordinate);
            axis.is_some_and(|axis| !self.machine.axis.contains_key(axis))
        };
        if lacks(first) || lacks(second) {
            let help = "choose the plane of the lathe with G18";
            return Err(missing("an arc outside the plane of X and Z", help));
        }
        if self.frame.rotation_deg != 0.0 && self.plane != Plane::Xy {
            let what = "an arc across the plane of X and Y in a coordinate system turned about Z";
            return Err(missing(what, "turn it back with G10 L2 R0, or cut the arc in G17"));
        }
        Ok(())
    }

    /// The point of the machine that a programmed position means, refused if it lies outside the travel. What has
    /// been refused before is not refused again before it changes.
    fn target(&mut self, to: &gcode::Position) -> Result<gcode::Position, Box<Problem>> {
        let asked = self.frame.machine(to);
        let before = std::mem::replace(&mut self.asked, asked);
        let kinematics = self.machine.machine.kinematics;
        let (before, axes) = (kinematics.axes(&before), kinematics.axes(&asked));
        // First the axes that there are not: travel matters less.
        let exists = |axis: &Axis| self.machine.axis.contains_key(axis);
        let [missing, present] =
            [false, true].map(|there| Axis::ALL.into_iter().filter(move |axis| exists(axis) == there));
        for axis in missing.chain(present).filter(|axis| axes[axis.index()] != before[axis.index()]) {
            within_travel(&self.machine, axis, axes[axis.index()], Blame::Word(letter(axis)))?;
        }
        Ok(asked)
    }

    /// F of a line to a point. Where only rotary axes move it counts degrees, whatever the unit of length.
    fn feed_of_line(&mut self, to: &gcode::Position) -> Result<Feed, Box<Problem>> {
        let (from, to) = (self.positions(&self.rest), self.positions(to));
        let is_linear = |axis: &Axis| Axis::METRIC[axis.index()] && from[axis.index()] != to[axis.index()];
        let feed = if Axis::ALL.iter().any(is_linear) { self.feed } else { self.feed / self.frame.unit };
        self.feed_of_move(feed)
    }

    /// A feed in mm or degrees.
    fn feed_of_move(&mut self, feed: f64) -> Result<Feed, Box<Problem>> {
        self.settle_spindle(self.place());
        if feed <= 0.0 {
            let help = "add an F word to this block or one before; G94 and G95 each need their own";
            return Err(Problem::error("no-feed", Blame::Block, "the move has no feed", help));
        }
        match self.feed_mode {
            FeedMode::PerRevolution if !self.spindle.turns() => {
                let message = "feed per revolution (G95) with a spindle that does not turn";
                let help = "start it before, as in S600 M3, or use G94";
                Err(Problem::error("spindle-not-turning", Blame::Block, message, help))
            }
            _ if feed * self.spindle.turns_in_feed(self.feed_mode) < LEAST_FEED => {
                let message = format!("a feed of {} is too slow to be one", short(feed));
                let help = format!("give at least {LEAST_FEED} mm/min");
                Err(Problem::error("no-feed", Blame::Block, message, help))
            }
            FeedMode::PerRevolution => Ok(Feed::PerRevolution(feed)),
            FeedMode::PerMinute | FeedMode::InverseTime => Ok(Feed::PerMinute(feed)),
        }
    }

    /// G61, G61.1, G64 P. Without P, or with P0, the tolerance is that of the machine.
    pub(crate) fn mode_of_path(&self, mode: canon::PathMode) -> Result<PathMode, Box<Problem>> {
        Ok(match mode {
            canon::PathMode::ExactPath => PathMode::ExactPath,
            canon::PathMode::ExactStop => PathMode::ExactStop,
            canon::PathMode::Continuous(0.0) => PathMode::within(self.machine.path.tolerance_mm),
            canon::PathMode::Continuous(tolerance) => PathMode::within(self.tolerance('P', tolerance)?),
        })
    }

    /// G64 Q: P is for blends alone.
    pub(crate) fn merge_within(&mut self, tolerance: f64) -> Done {
        let merge = self.tolerance('Q', tolerance)?;
        if let PathMode::Blend { tolerance_mm, merge_mm } = &mut self.path_mode {
            if !self.merges_all {
                *tolerance_mm += *merge_mm;
            }
            (*merge_mm, self.merges_all) = (merge, true);
        }
        Ok(())
    }

    fn tolerance(&self, letter: char, tolerance: f64) -> Result<f64, Box<Problem>> {
        let mm = tolerance * self.frame.unit;
        if (0.0..=PathMode::MOST_MM).contains(&mm) {
            return Ok(mm);
        }
        let message = format!("{} mm is no tolerance of a path", short(mm));
        let help = format!("give at most {} mm", short(PathMode::MOST_MM));
        Err(Problem::error("bad-value", Blame::Word(letter), message, help))
    }

    /// Where the axes stand for a point of the machine, as the wire carries it.
    pub(crate) fn positions(&self, point: &gcode::Position) -> PerAxis<Position> {
        self.machine.machine.kinematics.axes(point).map(Position::from_mm)
    }
}

/// The letter of the words that move an axis.
pub(crate) fn letter(axis: Axis) -> char {
    axis.name().chars().next().unwrap_or(' ').to_ascii_uppercase()
}

/// Refuses a position outside the travel of its axis, and one of an axis that there is not; `at` in mm or degrees.
pub(crate) fn within_travel(machine: &Machine, axis: Axis, at: f64, blame: Blame) -> Done {
    let Some(config) = machine.axis.get(&axis) else {
        let is_origin = Position::from_mm(at) == Position(0);
        return if is_origin { Ok(()) } else { Err(no_axis(machine, axis, at)) };
    };
    let [low, high] = config.travel_mm;
    if (low..=high).contains(&at) {
        return Ok(());
    }
    let is_radius = axis == Axis::X && machine.machine.kinematics == Kinematics::Lathe;
    let message = format!(
        "{axis} at {} {unit}{note} is outside axis.{name}.travel_{unit} = [{}, {}]",
        short(at),
        short(low),
        short(high),
        note = if is_radius { " (radius)" } else { "" },
        name = axis.name(),
        unit = axis.unit(),
    );
    let help = "keep the target within the travel; check units (G20, G21), G7, G91 and offsets";
    Err(Problem::error("travel-limit", blame, message, help))
}

/// The machine is asked for an axis that it does not have; `at` in mm or degrees.
pub(crate) fn no_axis(machine: &Machine, axis: Axis, at: f64) -> Box<Problem> {
    let kind = match machine.machine.kinematics {
        Kinematics::Lathe => "lathe",
        Kinematics::Mill => "mill",
        Kinematics::Positioner => "positioner",
    };
    let axes: Vec<String> = machine.axes().map(|(axis, _)| axis.to_string()).collect();
    let message = format!("this {kind} has no axis {axis} (it would be at {})", short(at));
    let help = format!("its axes are {}: leave the word out", axes.join(", "));
    Problem::error("no-such-axis", Blame::Word(letter(axis)), message, help)
}
