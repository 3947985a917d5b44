//! What stays in force from block to block.
//!
//! Lengths in the units in force (G20 and G21 convert them), X a radius, angles in degrees; values that belong to
//! the machine (tool table, offsets of the coordinate systems, home positions) in units of the machine.

use crate::block::Block;
use crate::canon::{FeedMode, PathMode, Plane, Position, Turn, Units, X, Y, Z};
use crate::codes::G;
use crate::execute::{compensation::Compensation, context::Contexts, cycles::Sticky, roughing::Recorder};
use crate::files::ToolTable;
use crate::options::Options;
use crate::words::memory::Memory;

/// #5161 to #5166: home of G28, machine units; #5181: home of G30.
pub const HOME: [u32; 2] = [5161, 5181];
/// 1 while the offset of G52 and G92 is applied.
pub const G92_APPLIED: u32 = 5210;
/// #5211 to #5216: that offset, machine units.
pub const G92_OFFSET: u32 = 5211;
/// The coordinate system in force.
pub const SYSTEM: u32 = 5220;
/// Inch of LinuxCNC's stand-alone interpreter, mm.
const STAND_ALONE_INCH: f64 = 1.0 / 0.03937007874016;
/// What the last M66 read.
pub const INPUT: u32 = 5399;

/// #5221 for G54, #5241 for G55...: the first of six offsets, machine units; the rotation is nine behind it.
pub fn offset_of_system(system: u8) -> u32 {
    SYSTEM + 1 + 20 * u32::from(system.saturating_sub(1))
}

/// The parameter that holds the rotation of a coordinate system, degrees.
pub fn rotation_of_system(system: u8) -> u32 {
    offset_of_system(system) + 9
}

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
    /// G64 Q, or P where Q was left out.
    pub naivecam: f64,
    /// Q was not left out.
    pub naivecam_programmed: bool,
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
    /// G70, G71, G72: the contour that is being read.
    pub recorder: Recorder,
    /// Parameters.
    pub memory: Memory,
    /// Value that the last M66 or probe left (#5399, #5061 to #5070) is in `memory`; depth of subroutine calls.
    pub call_level: u32,
    /// G73 and G83 go back by this much between pecks, machine units.
    pub peck_clearances: [f64; 2],
    /// M19 turns to this angle if R is 0, degrees.
    pub orient_offset: f64,
    /// Moves that a block may make, see [`crate::Limits::moves_of_block`].
    pub moves_of_block: u64,
    /// The line that is being read.
    pub line: u32,
    /// It was warned of a feed per revolution while the spindle stands.
    pub standing_feed: bool,
    /// What M70 and M73 saved.
    pub contexts: Contexts,
    /// [`Options::stand_alone`].
    pub stand_alone: bool,
    /// By how much offsets of tools have shifted the programmed point since the last move.
    pub unseen: Position,
    /// M2 or M30 was executed.
    pub ended: bool,
}

impl State {
    /// The state in which a program begins: G17 G90 G91.1 G94 G8 G40 G49 G64 G97 G99 and no motion code, with the
    /// offsets that the parameters hold.
    pub fn new(options: &Options) -> State {
        let mut memory = Memory::default();
        for (index, value) in &options.parameters {
            memory.set_numbered(*index, *value);
        }
        for (name, value) in &options.named {
            memory.set_named(name, *value);
        }
        let system = memory.numbered(SYSTEM) as u8;
        let system = if (1..=9).contains(&system) { system } else { 1 };
        memory.set_numbered(SYSTEM, f64::from(system));
        let mut state = State {
            machine_units: options.machine_units,
            units: options.units,
            plane: options.plane,
            diameter: options.diameter,
            incremental: false,
            absolute_centers: false,
            feed_mode: FeedMode::PerMinute,
            feed: 0.0,
            spindle: Spindle { turning: None, speed: 0.0, constant_surface: None },
            motion: None,
            retract_to_start: false,
            path: PathMode::Continuous(0.0),
            naivecam: 0.0,
            naivecam_programmed: false,
            mist: false,
            flood: false,
            overrides: Overrides { feed: true, speed: true, adaptive: false, hold: false },
            position: options.position,
            system,
            g5x: [0.0; 6],
            g92: [0.0; 6],
            rotation: 0.0,
            tool_offset: [0.0; 6],
            selected: None,
            tool: 0,
            tools: options.tools.clone(),
            compensation: Compensation::default(),
            cycle: Sticky::default(),
            recorder: Recorder::default(),
            memory,
            call_level: 0,
            peck_clearances: options.peck_clearances,
            orient_offset: options.orient_offset,
            moves_of_block: options.limits.moves_of_block,
            contexts: Contexts::default(),
            standing_feed: false,
            line: 0,
            stand_alone: options.stand_alone,
            unseen: [0.0; 6],
            ended: false,
        };
        state.g5x = state.lengths_at(offset_of_system(system));
        state.rotation = state.parameter(rotation_of_system(system));
        if state.parameter(G92_APPLIED) != 0.0 {
            state.g92 = state.lengths_at(G92_OFFSET);
        }
        state
    }

    /// Multiply machine units by this to get program units.
    pub fn per_machine_unit(&self) -> f64 {
        let machine = match self.machine_units {
            Units::Inch if self.stand_alone => STAND_ALONE_INCH,
            units => units.mm(),
        };
        machine / self.units.mm()
    }

    /// The axis words of a block; X words are diameters under G7.
    pub fn axes(&self, block: &Block) -> [Option<f64>; 6] {
        let mut words = block.axes();
        if self.diameter {
            words[X] = words[X].map(|diameter| diameter / 2.0);
        }
        words
    }

    /// The value of `#index` as it is stored.
    pub fn parameter(&self, index: u32) -> f64 {
        self.memory.numbered(index)
    }

    /// Stores a value in `#index`.
    pub fn set_parameter(&mut self, index: u32, value: f64) {
        self.memory.set_numbered(index, value);
    }

    /// Six parameters in machine units, as program units.
    pub fn lengths_at(&self, first: u32) -> Position {
        let stored = [0, 1, 2, 3, 4, 5].map(|axis| self.parameter(first + axis));
        self.to_program(&stored)
    }

    /// Stores program units in six parameters in machine units.
    pub fn set_lengths_at(&mut self, first: u32, lengths: &Position) {
        for (index, value) in (first..).zip(self.to_machine(lengths)) {
            self.set_parameter(index, value);
        }
    }

    /// Machine units to program units; angles stay.
    pub fn to_program(&self, lengths: &Position) -> Position {
        scaled(lengths, self.per_machine_unit())
    }

    /// Program units to machine units; angles stay.
    pub fn to_machine(&self, lengths: &Position) -> Position {
        scaled(lengths, 1.0 / self.per_machine_unit())
    }

    /// A point of the coordinate system in force as a point of the machine, program units.
    pub fn absolute(&self, point: &Position) -> Position {
        let mut absolute: Position = std::array::from_fn(|axis| point[axis] + self.g92[axis]);
        turn(&mut absolute, self.rotation);
        std::array::from_fn(|axis| absolute[axis] + self.g5x[axis] + self.tool_offset[axis])
    }

    /// A point of the machine as a point of the coordinate system in force, program units.
    pub fn relative(&self, point: &Position) -> Position {
        let mut relative: Position =
            std::array::from_fn(|axis| point[axis] - self.tool_offset[axis] - self.g5x[axis]);
        turn(&mut relative, -self.rotation);
        std::array::from_fn(|axis| relative[axis] - self.g92[axis])
    }
}

/// Lengths times a factor, angles as they are.
pub(crate) fn scaled(lengths: &Position, factor: f64) -> Position {
    let mut scaled = *lengths;
    for axis in [X, Y, Z] {
        scaled[axis] *= factor;
    }
    scaled
}

/// Turns a point about Z by degrees.
pub(crate) fn turn(point: &mut Position, degrees: f64) {
    if degrees == 0.0 {
        return;
    }
    let (sin, cos) = libm::sincos(degrees.to_radians());
    let [x, y, ..] = *point;
    point[X] = x * cos - y * sin;
    point[Y] = x * sin + y * cos;
}
