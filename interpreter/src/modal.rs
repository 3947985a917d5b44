//! What stays in force from block to block: units, offsets, plane, feed, path mode, the lead of synchronised
//! motion. In: calls. Out: what they make of a move; what this machine cannot do, by name.

use gcode::canon::{FeedMode, Plane, Units};
use gcode::problem::Blame;
use gcode::{Call, Problem};
use machine::Machine;
use protocol::{Axis, Feed, PerAxis, Position};

use crate::frame::Frame;
use crate::path_mode::PathAsked;
use crate::reach::{Done, missing, needs_spindle, no_axis, plane_of};
use crate::spindle::Spindle;

/// Highest feed, mm/min or mm/rev.
pub(crate) const HIGHEST_FEED: f64 = 1e6;
/// Slowest feed, mm/min: what a chain of moves takes for one.
const LEAST_FEED: f64 = 60.0 * motion::chain::LEAST_FEED;

/// Lead of synchronised motion, mm/rev along the path, by how much it grows in a turn, and its start angle,
/// degrees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Synchronised {
    pub(crate) lead_mm: f64,
    pub(crate) growth_mm: f64,
    pub(crate) start_deg: f64,
}

/// What is in force.
pub(crate) struct Modal {
    pub(crate) frame: Frame,
    pub(crate) plane: Plane,
    pub(crate) path: PathAsked,
    /// Synchronised motion that has begun.
    pub(crate) synchronised: Option<Synchronised>,
    feed_mode: FeedMode,
    /// F in mm/min or mm/rev, 0 for none.
    feed: f64,
}

impl Modal {
    /// What is in force at the start of a program.
    pub(crate) fn new(machine: &Machine) -> Modal {
        Modal {
            frame: Frame::new(),
            plane: plane_of(machine),
            path: PathAsked::within(machine.path.tolerance_mm),
            synchronised: None,
            feed_mode: FeedMode::PerMinute,
            feed: 0.0,
        }
    }

    /// A call that changes what is in force.
    pub(crate) fn change(&mut self, call: &Call<'_>, machine: &Machine) -> Done {
        match *call {
            Call::UseLengthUnits(units) => self.frame.units = units,
            Call::SelectPlane(plane) => self.plane = plane,
            Call::SetG5xOffset(_, offset) => self.frame.system = self.offset(&offset, machine)?,
            Call::SetG92Offset(offset) => self.frame.shift = self.offset(&offset, machine)?,
            Call::UseToolLengthOffset(offset) => self.frame.tool = self.offset(&offset, machine)?,
            Call::SetXyRotation(degrees) if degrees != 0.0 && !machine.axis.contains_key(&Axis::Y) => {
                let help = "leave R out, or set it to 0";
                return Err(missing("a coordinate system turned about Z", help));
            }
            Call::SetXyRotation(degrees) => self.frame.rotation_deg = degrees,
            Call::SetFeedMode(mode) => {
                if mode == FeedMode::PerRevolution {
                    needs_spindle(machine, "feed per revolution", Blame::Block)?;
                }
                self.feed_mode = mode;
            }
            Call::SetFeedRate(feed) => self.set_feed(feed)?,
            Call::SetMotionControlMode(mode) => {
                self.path = PathAsked::asked(mode, self.frame.units, machine.path.tolerance_mm)?;
            }
            Call::SetNaivecamTolerance { tolerance, programmed: true } => {
                self.path.merge_within(tolerance * self.frame.unit(), self.frame.units)?;
            }
            Call::StartSpeedFeedSynch { lead, velocity, start_deg, growth } => {
                let [lead_mm, growth_mm] = [lead, growth].map(|value| value * self.frame.unit());
                self.synchronised = (!velocity).then_some(Synchronised { lead_mm, growth_mm, start_deg });
            }
            Call::StopSpeedFeedSynch => self.synchronised = None,
            _ => {}
        }
        Ok(())
    }

    /// An offset in mm and degrees; refused if it shifts an axis that the machine does not have.
    fn offset(&self, offset: &gcode::Pose, machine: &Machine) -> Result<gcode::Pose, Box<Problem>> {
        let scaled = self.frame.scaled(offset);
        let shifts = machine.general.kinematics.axes(&scaled).map(Position::from_mm);
        let lacks = |axis: &Axis| !machine.axis.contains_key(axis) && shifts[axis.index()] != Position(0);
        match Axis::ALL.into_iter().find(lacks) {
            Some(axis) => Err(no_axis(machine, axis)),
            None => Ok(scaled),
        }
    }

    fn set_feed(&mut self, feed: f64) -> Done {
        let feed = feed * self.frame.unit();
        if !(0.0..=HIGHEST_FEED).contains(&feed) {
            self.feed = HIGHEST_FEED; // one mistake, one message: the moves behind it do not also lack a feed
            let message = format!("F of {} is not a feed", self.frame.units.length(feed));
            let help = format!("give a feed above 0 and up to {}", self.frame.units.length(HIGHEST_FEED));
            return Err(Problem::error("bad-value", Blame::Word('F'), message, help));
        }
        self.feed = feed;
        Ok(())
    }

    /// F under G94, mm/min, if there is one.
    pub(crate) fn feed_mm_min(&self) -> Option<f64> {
        (self.feed_mode == FeedMode::PerMinute && self.feed > 0.0).then_some(self.feed)
    }

    /// F of a line. Where only rotary axes move it counts degrees, whatever the unit of length.
    pub(crate) fn feed_of_line(
        &self,
        [from, to]: [PerAxis<Position>; 2],
        spindle: &Spindle,
    ) -> Result<Feed, Box<Problem>> {
        let is_linear = |axis: &Axis| Axis::METRIC[axis.index()] && from[axis.index()] != to[axis.index()];
        let in_mm = Axis::ALL.iter().any(is_linear);
        self.checked_feed(if in_mm { self.feed } else { self.feed / self.frame.unit() }, spindle)
    }

    /// F of an arc.
    pub(crate) fn feed_of_arc(&self, spindle: &Spindle) -> Result<Feed, Box<Problem>> {
        self.checked_feed(self.feed, spindle)
    }

    /// A feed in mm or degrees.
    fn checked_feed(&self, feed: f64, spindle: &Spindle) -> Result<Feed, Box<Problem>> {
        if feed <= 0.0 {
            let help = "add an F word to this block or one before; each way to feed needs its own";
            return Err(Problem::error("no-feed", Blame::Block, "the move has no feed", help));
        }
        match self.feed_mode {
            FeedMode::PerRevolution if !spindle.turns() => {
                let message = "feed per revolution (G95) with a spindle that does not turn";
                let help = "start it before, as in S600 M3, or feed per minute";
                Err(Problem::error("spindle-not-turning", Blame::Block, message, help))
            }
            _ if feed * spindle.turns_in_feed(self.feed_mode) < LEAST_FEED => {
                let units = self.frame.units;
                let turn = if self.feed_mode == FeedMode::PerRevolution { "in a turn" } else { "a minute" };
                let message = format!("a feed of {} {turn} is too slow to be one", fine(feed, units));
                // Rounded up.
                let least = (1e4 * LEAST_FEED / units.mm() - 1e-6).ceil() * 1e-4 * units.mm();
                let help = format!("give at least {}/min", units.length(least));
                Err(Problem::error("no-feed", Blame::Block, message, help))
            }
            FeedMode::PerRevolution => Ok(Feed::PerRevolution(feed)),
            FeedMode::PerMinute | FeedMode::InverseTime => Ok(Feed::PerMinute(feed)),
        }
    }
}

/// A small length with its unit, in as many decimals as show it.
fn fine(mm: f64, units: Units) -> String {
    let text = format!("{:.8}", mm / units.mm());
    format!("{} {}", text.trim_end_matches('0').trim_end_matches('.'), units.name())
}
