//! What stays in force from block to block.
//!
//! Lengths in the units in force (G20 and G21 convert them), X a radius, angles in degrees; values that belong to
//! the machine (tool table, offsets of the coordinate systems, home positions) in units of the machine.

use crate::canon::{FeedMode, PathMode, Plane, Position, Turn, Units};
use crate::codes::G;
use crate::execute::{compensation::Compensation, cycles::Sticky};
use crate::files::ToolTable;
use crate::words::memory::Memory;

/// S, M3, M4, M5, G96, G97.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spindle {
    /// Direction while it turns.
    pub turning: Option<Turn>,
    /// S: 1/min, or m/min (ft/min) at constant surface speed.
    pub speed: f64,
    /// G96: highest speed (D), 1/min.
    pub constant_surface: Option<f64>,
}

/// M48 to M53.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overrides {
    /// Feed override allowed.
    pub feed: bool,
    /// Spindle override allowed.
    pub speed: bool,
    /// Adaptive feed.
    pub adaptive: bool,
    /// Feed hold by an input.
    pub hold: bool,
}

/// The modal state of a program.
#[derive(Clone, Debug)]
pub struct State {
    /// Units of the machine.
    pub machine_units: Units,
    /// G20, G21.
    pub units: Units,
    /// G17, G18, G19.
    pub plane: Plane,
    /// G7: X words are diameters.
    pub diameter: bool,
    /// G91.
    pub incremental: bool,
    /// G90.1: centres of arcs are absolute.
    pub absolute_centers: bool,
    /// G93, G94, G95.
    pub feed_mode: FeedMode,
    /// F.
    pub feed: f64,
    /// Spindle.
    pub spindle: Spindle,
    /// The motion code in force; `None` after G80.
    pub motion: Option<G>,
    /// G98: canned cycles retract to where they began, else (G99) to R.
    pub retract_to_start: bool,
    /// G61, G64.
    pub path: PathMode,
    /// G64 Q.
    pub naivecam: f64,
    /// M7.
    pub mist: bool,
    /// M8.
    pub flood: bool,
    /// M48 to M53.
    pub overrides: Overrides,
    /// The programmed point.
    pub position: Position,
    /// Coordinate system in force, 1 (G54) to 9 (G59.3).
    pub system: u8,
    /// Its offset.
    pub g5x: Position,
    /// G52 and G92: the offset in force (zero while G92.2 suspends it).
    pub g92: Position,
    /// Rotation of the coordinate system about Z, degrees.
    pub rotation: f64,
    /// G43: offset of the tool.
    pub tool_offset: Position,
    /// T: the tool that comes next.
    pub selected: Option<i32>,
    /// The tool in the spindle, 0 for none.
    pub tool: i32,
    /// Tools; entry 0 is what is in the spindle.
    pub tools: ToolTable,
    /// G40, G41, G42.
    pub compensation: Compensation,
    /// What canned cycles keep from block to block.
    pub cycle: Sticky,
    /// Parameters.
    pub memory: Memory,
    /// Value that the last M66 or probe left (#5399, #5061 to #5070) is in `memory`; depth of subroutine calls.
    pub call_level: u32,
    /// G73 and G83 go back by this much between pecks, machine units.
    pub peck_clearance: f64,
}

impl State {
    /// Multiply machine units by this to get program units.
    pub fn per_machine_unit(&self) -> f64 {
        self.machine_units.mm() / self.units.mm()
    }
}
