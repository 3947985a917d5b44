//! Where the program is, and where the axes are. In: targets of the program, where passes and jobs end. Out:
//! points of the machine, mm and degrees, X of a lathe a radius; refusals of what lies outside the travel.

use gcode::Problem;
use gcode::canon::{X, Z};
use gcode::problem::Blame;
use machine::{Kinematics, Machine};
use protocol::{Axis, PerAxis, Position};

use crate::reach::{Done, home, letter, within_travel};
use crate::thread::Point;

/// The points that a move goes from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Points {
    kinematics: Kinematics,
    /// Where the last move was to go, whether or not it can.
    asked: gcode::Pose,
    programmed: gcode::Pose,
    rest: gcode::Pose,
    after_thread: bool,
    /// Against the directions in which X and Z moved last, ±1: out of the material before a thread.
    outwards: Point,
}

impl Points {
    /// All axes at home.
    pub(crate) fn at_home(machine: &Machine) -> Points {
        let home = home(machine);
        let kinematics = machine.general.kinematics;
        Points {
            kinematics,
            asked: home,
            programmed: home,
            rest: home,
            after_thread: false,
            outwards: Point { x: 1.0, z: 1.0 },
        }
    }

    /// The programmed point.
    pub(crate) fn programmed(&self) -> &gcode::Pose {
        &self.programmed
    }

    /// Where the axes rest; differs from the programmed point after a pass that ran beyond it.
    pub(crate) fn rest(&self) -> &gcode::Pose {
        &self.rest
    }

    /// The same of each axis.
    pub(crate) fn axes_at_rest(&self) -> PerAxis<Position> {
        self.axes(&self.rest)
    }

    /// Where the axes stand for a point of the machine, as the wire carries it.
    pub(crate) fn axes(&self, point: &gcode::Pose) -> PerAxis<Position> {
        self.kinematics.axes(point).map(Position::from_mm)
    }

    /// Whether the last motion was synchronised.
    pub(crate) fn after_thread(&self) -> bool {
        self.after_thread
    }

    /// Whether a move before could not be made: what follows would begin where it did not end.
    pub(crate) fn is_astray(&self) -> bool {
        self.axes(&self.asked) != self.axes_at_rest()
    }

    /// Whether the axes rest at a point.
    pub(crate) fn rests_at(&self, point: &gcode::Pose) -> bool {
        self.axes(point) == self.axes_at_rest()
    }

    /// Notes where a move is to go, and refuses it if that lies outside the travel. What has been refused
    /// before is not refused again before it changes.
    pub(crate) fn target(&mut self, to: gcode::Pose, machine: &Machine) -> Done {
        let before = std::mem::replace(&mut self.asked, to);
        let (before, axes) = (self.kinematics.axes(&before), self.kinematics.axes(&to));
        // First the axes that there are not: travel matters less.
        let exists = |axis: &Axis| machine.axis.contains_key(axis);
        let [missing, present] =
            [false, true].map(|there| Axis::ALL.into_iter().filter(move |axis| exists(axis) == there));
        // What goes on beyond the same end of the travel has the same cause.
        let beyond = |axis: Axis, at: f64| {
            let [low, high] = machine.axis.get(&axis)?.travel_mm;
            (!(low..=high).contains(&at)).then_some(at > high)
        };
        let told = |axis: &Axis| {
            let [at, was] = [axes, before].map(|of| of[axis.index()]);
            at == was || beyond(*axis, was).is_some_and(|side| beyond(*axis, at) == Some(side))
        };
        for axis in missing.chain(present).filter(|axis| !told(axis)) {
            within_travel(machine, axis, axes[axis.index()], Blame::Word(letter(axis)))?;
        }
        Ok(())
    }

    /// Refuses to cut from where a thread ran beyond its end.
    pub(crate) fn at_programmed_point(&self) -> Done {
        if self.rests_at(&self.programmed) {
            return Ok(());
        }
        let message =
            "the thread before ran out beyond its end (run_out = \"beyond\"), and this cut would begin there";
        let help = "let a G0 follow the thread";
        Err(Problem::error("cut-after-thread", Blame::Block, message, help))
    }

    /// Directions of X and Z out of the material, against their last infeeds, ±1; away from the axis and from
    /// the chuck before there was one.
    pub(crate) fn outwards(&self) -> Point {
        self.outwards
    }

    /// The program is at a point now, by timed motion; the axes get there with the items of the move.
    pub(crate) fn program_goes_to(&mut self, point: gcode::Pose) {
        let out = |of: usize, before: f64| match self.programmed[of] - point[of] {
            0.0 => before,
            way => way.signum(),
        };
        self.outwards = Point { x: out(X, self.outwards.x), z: out(Z, self.outwards.z) };
        (self.programmed, self.after_thread) = (point, false);
    }

    /// The program is at a point now, by synchronised motion.
    pub(crate) fn thread_goes_to(&mut self, point: gcode::Pose) {
        (self.programmed, self.after_thread) = (point, true);
    }

    /// The axes rest at a point now.
    pub(crate) fn axes_go_to(&mut self, point: gcode::Pose) {
        self.rest = point;
    }

    /// The axes rest here now, as the wire carries it.
    pub(crate) fn axes_rest_at(&mut self, axes: &PerAxis<Position>) {
        self.rest = self.kinematics.point(&axes.map(Position::mm));
    }

    /// The program goes on from a point that no move leads to.
    pub(crate) fn skip_to(&mut self, point: gcode::Pose) {
        (self.asked, self.programmed, self.rest, self.after_thread) = (point, point, point, false);
    }

    /// The program goes on from where the axes rest.
    pub(crate) fn program_follows_axes(&mut self) {
        (self.programmed, self.asked, self.after_thread) = (self.rest, self.rest, false);
    }
}
