//! What stays in force from block to block. Lengths in mm, X a radius, speeds in 1/min.

use protocol::{Axis, Feed, Machine, SpindleMode};

use crate::block::Motion;
use crate::thread::{Point, Starts};
use crate::words::Parameters;

/// How F is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FeedMode {
    PerMinute,
    PerRevolution,
}

/// The modal state of a program.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub(crate) parameters: Parameters,
    pub(crate) motion: Motion,
    /// mm in one unit of length: 1 or 25.4.
    pub(crate) unit_mm: f64,
    /// G7: X words are diameters.
    pub(crate) diameter: bool,
    /// G91.
    pub(crate) incremental: bool,
    pub(crate) feed_mode: FeedMode,
    /// F in mm/min or mm/rev; none since the start or the last change of mode.
    pub(crate) feed: Option<f64>,
    pub(crate) spindle: SpindleMode,
    /// S.
    pub(crate) rpm: Option<f64>,
    /// The programmed point.
    pub(crate) point: Point,
    /// Where the axes rest; differs from the programmed point after a pass that ran beyond it.
    pub(crate) rest: Point,
    /// The last motion was a G33.
    pub(crate) after_thread: bool,
    /// Passes so far.
    pub(crate) passes: u32,
    pub(crate) starts: Starts,
}

impl State {
    /// The state at the start: G18 G21 G90 G94 G97 G8 G91.1, no motion in force, the axes at home.
    pub(crate) fn new(machine: &Machine) -> State {
        let home = |axis| machine.axis.get(&axis).map_or(0.0, |config| config.home_mm);
        let point = Point { x: home(Axis::X), z: home(Axis::Z) };
        State {
            parameters: Parameters::default(),
            motion: Motion::None,
            unit_mm: 1.0,
            diameter: false,
            incremental: false,
            feed_mode: FeedMode::PerMinute,
            feed: None,
            spindle: SpindleMode::Stop,
            rpm: None,
            point,
            rest: point,
            after_thread: false,
            passes: 0,
            starts: Starts::default(),
        }
    }

    /// mm of radius in one unit of an X word.
    pub(crate) fn radius_mm(&self) -> f64 {
        if self.diameter { 0.5 * self.unit_mm } else { self.unit_mm }
    }

    /// The point that X and Z words mean.
    pub(crate) fn target(&self, x: Option<f64>, z: Option<f64>) -> Point {
        let Point { x: from_x, z: from_z } = if self.incremental { self.point } else { Point::default() };
        Point {
            x: x.map_or(self.point.x, |x| from_x + x * self.radius_mm()),
            z: z.map_or(self.point.z, |z| from_z + z * self.unit_mm),
        }
    }

    /// F as the feed of a move.
    pub(crate) fn feed_of_move(&self) -> Option<Feed> {
        self.feed.map(|feed| match self.feed_mode {
            FeedMode::PerMinute => Feed::PerMinute(feed),
            FeedMode::PerRevolution => Feed::PerRevolution(feed),
        })
    }

    /// Whether the spindle turns at a programmed speed.
    pub(crate) fn turning(&self) -> Option<f64> {
        self.rpm.filter(|rpm| *rpm > 0.0 && self.spindle != SpindleMode::Stop)
    }
}
