//! Modes: what codes switch, and what F and S are.

use crate::block::Block;
use crate::canon::{FeedMode, PathMode, Plane, Turn, X};
use crate::codes::G;

/// Modes of motion.
#[derive(Clone, Debug)]
pub(crate) struct Modes {
    /// G17, G18, G19.
    pub(crate) plane: Plane,
    /// G7: X words are diameters.
    pub(crate) diameter: bool,
    /// G91.
    pub(crate) incremental: bool,
    /// G90.1: centres of arcs are absolute.
    pub(crate) absolute_centers: bool,
    /// G93, G94, G95.
    pub(crate) feed_mode: FeedMode,
    /// F.
    pub(crate) feed: f64,
    /// The motion code in force; `None` after G80.
    pub(crate) motion: Option<G>,
    /// G98: canned cycles retract to where they began, else (G99) to R.
    pub(crate) retract_to_start: bool,
    pub(crate) path: Path,
}

/// G61, G64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Path {
    pub(crate) mode: PathMode,
    /// G64 Q, or P where Q was left out.
    pub(crate) naivecam: f64,
    /// Q was not left out.
    pub(crate) naivecam_programmed: bool,
}

/// S, M3, M4, M5, G96, G97.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Spindle {
    /// Direction while it turns.
    pub(crate) turning: Option<Turn>,
    /// S: 1/min, or m/min (ft/min) at constant surface speed.
    pub(crate) speed: f64,
    /// G96: highest speed (D), 1/min.
    pub(crate) constant_surface: Option<f64>,
    /// It was warned of a feed per revolution while it stands.
    pub(crate) standing_feed: bool,
}

/// M7, M8, M9.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Coolant {
    pub(crate) mist: bool,
    pub(crate) flood: bool,
}

/// M48 to M53.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Overrides {
    /// Feed override allowed.
    pub(crate) feed: bool,
    /// Spindle override allowed.
    pub(crate) speed: bool,
    /// Adaptive feed.
    pub(crate) adaptive: bool,
    /// Feed hold by an input.
    pub(crate) hold: bool,
}

impl Default for Overrides {
    fn default() -> Overrides {
        Overrides { feed: true, speed: true, adaptive: false, hold: true }
    }
}

impl Modes {
    /// The modes in which a program begins.
    pub(super) fn new(plane: Plane, diameter: bool) -> Modes {
        Modes {
            plane,
            diameter,
            incremental: false,
            absolute_centers: false,
            feed_mode: FeedMode::PerMinute,
            feed: 0.0,
            motion: None,
            retract_to_start: false,
            path: Path { mode: PathMode::Continuous(0.0), naivecam: 0.0, naivecam_programmed: false },
        }
    }

    /// The axis words of a block; X words are diameters under G7.
    pub(crate) fn axes(&self, block: &Block) -> [Option<f64>; 6] {
        let mut words = block.axes();
        if self.diameter {
            words[X] = words[X].map(|diameter| diameter / 2.0);
        }
        words
    }

    /// G20, G21: F and the tolerances of the path times a factor.
    pub(crate) fn scale(&mut self, factor: f64) {
        if self.feed_mode != FeedMode::InverseTime {
            self.feed *= factor;
        }
        self.path.naivecam *= factor;
        if let PathMode::Continuous(tolerance) = &mut self.path.mode {
            *tolerance *= factor;
        }
    }
}
