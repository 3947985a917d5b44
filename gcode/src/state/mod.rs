//! What stays in force from block to block.
//!
//! Lengths in the units in force (G20 and G21 convert them), X a radius, angles in degrees; values that
//! belong to the machine (tool table, offsets of the coordinate systems, home positions) in units of the
//! machine.
//!
//! | file | what it keeps |
//! |---|---|
//! | `scale.rs` | units of the machine and of the program |
//! | `modes.rs` | planes, distances, feed, path, motion code; spindle, coolant, overrides |
//! | `axes.rs` | the programmed point, and the offsets between it and the machine |
//! | `length.rs` | whose length of tool is in force, and what was said of it |
//! | `compensation.rs` | G41, G42: tool and side, where the centre of the tool is |
//! | `sticky.rs`, `recorder.rs` | words of canned cycles; the contour of G70, G71, G72 |
//! | `tap.rs` | how G84 of FANUC taps |
//! | `saved.rs` | what M70 and M73 saved |
//! | `memory.rs` | parameters |

mod axes;
mod compensation;
mod length;
pub(crate) mod memory;
mod modes;
mod recorder;
mod saved;
mod scale;
mod spline;
mod sticky;
mod tap;

pub(crate) use axes::{Axes, turn};
pub(crate) use compensation::{Compensation, Cutter};
pub(crate) use length::Length;
pub(crate) use memory::Memory;
pub(crate) use modes::{Coolant, Modes, Overrides, Spindle};
pub(crate) use recorder::{Cycle, Piece, Recorder};
pub(crate) use saved::{Context, Contexts, Saved};
pub(crate) use scale::Scale;
pub(crate) use spline::{KnottedCurve, OpenCurve, Spline};
pub(crate) use sticky::Sticky;
pub(crate) use tap::{Rigid, depths};

use std::cell::Cell;
use std::collections::BTreeMap;
use std::sync::Arc;

use crate::canon::{Call, FeedMode, Pose, Turn};
use crate::codes::G;
use crate::files::ToolTable;
use crate::options::{Dialect, MachineCode, Options};
use crate::problem::{Problem, Span};

/// See [`State::assume`].
pub(crate) const SPINDLE_MAY_TURN: &str = "M3";

/// #5161 to #5166: home of G28, machine units; #5181: home of G30.
pub(crate) const HOME: [u32; 2] = [5161, 5181];
/// 1 while the offset of G52 and G92 is applied.
pub(crate) const G92_APPLIED: u32 = 5210;
/// #5211 to #5216: that offset, machine units.
pub(crate) const G92_OFFSET: u32 = 5211;
/// The coordinate system in force.
pub(crate) const SYSTEM: u32 = 5220;
/// What the last M66 read.
pub(crate) const INPUT: u32 = 5399;

/// #5221 for G54, #5241 for G55...: the first of six offsets, machine units; the rotation is nine after it.
pub(crate) fn offset_of_system(system: u8) -> u32 {
    SYSTEM + 1 + 20 * u32::from(system.saturating_sub(1))
}

/// The parameter that holds the rotation of a coordinate system, degrees.
pub(crate) fn rotation_of_system(system: u8) -> u32 {
    offset_of_system(system) + 9
}

/// The tools: what is in the spindle, and what comes next.
#[derive(Clone, Debug)]
pub(crate) struct Tools {
    /// T: the tool that comes next.
    pub(crate) selected: Option<i32>,
    /// The number of the tool in the spindle, 0 for none.
    pub(crate) number: i32,
    /// Tools; entry 0 is what is in the spindle.
    pub(crate) table: ToolTable,
    /// Whose length is in force.
    pub(crate) length: Length,
}

/// What does not change while the program runs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Settings {
    /// [`Options::stand_alone`].
    pub(crate) stand_alone: bool,
    /// [`Options::rigid_taps`].
    pub(crate) rigid_taps: bool,
    /// [`Options::is_mill`], or a dialect of mills.
    pub(crate) is_mill: bool,
    /// G73 and G83 go back by this much between pecks, machine units.
    pub(crate) peck_clearances: [f64; 2],
    /// [`Options::forgets_g92`].
    pub(crate) forgets_g92: bool,
    /// [`Options::no_fanuc_subs`].
    pub(crate) no_fanuc_subs: bool,
    /// M19 turns to this angle if R is 0, degrees.
    pub(crate) orient_offset: f64,
    /// Moves that a block may make, see [`crate::Limits::moves_of_block`].
    pub(crate) moves_of_block: u64,
    /// Codes of the feed per minute and per revolution, as the dialect has them.
    pub(crate) feed_codes: [G; 2],
}

/// How far the program has come.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Progress {
    /// The line that is being read.
    pub(crate) line: u32,
    /// Depth of subroutine calls.
    pub(crate) call_level: u32,
    /// M2 or M30 was executed.
    pub(crate) ended: bool,
}

/// The modal state of a program.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub(crate) settings: Settings,
    /// [`Options::machine_codes`].
    pub(crate) machine_codes: Arc<BTreeMap<u16, MachineCode>>,
    pub(crate) units: Scale,
    pub(crate) modes: Modes,
    pub(crate) spindle: Spindle,
    pub(crate) coolant: Coolant,
    /// M48 to M53.
    pub(crate) overrides: Overrides,
    pub(crate) axes: Axes,
    pub(crate) tools: Tools,
    /// G40, G41, G42.
    pub(crate) compensation: Compensation,
    /// What splines keep from block to block.
    pub(crate) spline: Spline,
    /// What canned cycles keep from block to block.
    pub(crate) cycle: Sticky,
    /// FANUC: how G84 and G74 of the block tap; none: in a floating holder.
    pub(crate) rigid: Option<Rigid>,
    /// G70, G71, G72: the contour that is being read.
    pub(crate) recorder: Recorder,
    /// What M70 and M73 saved.
    pub(crate) contexts: Contexts,
    pub(crate) memory: Memory,
    pub(crate) progress: Progress,
    /// A parameter was read that tells where the axes are.
    pub(crate) told_place: Cell<bool>,
}

impl State {
    /// What the machine does with an M code that no dialect has.
    ///
    /// # Errors
    /// It is not declared.
    pub(crate) fn machine_code(&self, value: f64, span: Span) -> Result<MachineCode, Box<Problem>> {
        let number =
            if value.fract() == 0.0 && (0.0..1000.0).contains(&value) { Some(value as u16) } else { None };
        let declared = number.and_then(|number| self.machine_codes.get(&number));
        declared.copied().ok_or_else(|| crate::problem::undeclared(number, value, span))
    }

    /// The state in which a program begins: G17 G90 G91.1 G94 G8 G40 G49 G64 G97 G99 and no motion code, with
    /// the offsets that the parameters hold.
    pub(crate) fn new(options: &Options) -> State {
        let memory = Memory::new(&options.parameters, &options.named);
        let system = memory.numbered(SYSTEM) as u8;
        let system = if (1..=9).contains(&system) { system } else { 1 };
        let mut state = State {
            settings: Settings {
                stand_alone: options.stand_alone,
                rigid_taps: options.rigid_taps,
                is_mill: options.is_mill || options.dialect == Dialect::FanucMill,
                peck_clearances: options.peck_clearances,
                forgets_g92: options.forgets_g92,
                no_fanuc_subs: options.no_fanuc_subs,
                orient_offset: options.orient_offset,
                moves_of_block: options.limits.moves_of_block,
                feed_codes: match options.dialect {
                    Dialect::Fanuc => [G(980), G(990)],
                    Dialect::Linuxcnc | Dialect::FanucMill => [G(940), G(950)],
                },
            },
            machine_codes: Arc::clone(&options.machine_codes),
            units: Scale::new(options.machine_units, options.units, options.stand_alone),
            modes: Modes::new(options.plane, options.diameter),
            spindle: Spindle::default(),
            coolant: Coolant::default(),
            overrides: Overrides::default(),
            axes: Axes::new(options.position),
            tools: Tools {
                selected: None,
                number: 0,
                table: options.tools.clone(),
                length: Length::default(),
            },
            compensation: Compensation::default(),
            spline: Spline::default(),
            cycle: Sticky::default(),
            rigid: None,
            recorder: Recorder::default(),
            contexts: Contexts::default(),
            memory,
            progress: Progress::default(),
            told_place: Cell::default(),
        };
        state.set_parameter(SYSTEM, f64::from(system));
        let (offset, rotation) = state.origin_of(system);
        state.axes.begin(system, offset, rotation, state.shift());
        state
    }

    /// A feed or a speed was missed, which is said once, or a refused word may have started the spindle: from
    /// here on there is one. What the receiver of the calls is to know of it.
    pub(crate) fn assume(&mut self, problem: &str) -> Vec<Call<'static>> {
        match problem {
            "no-feed" if self.modes.feed == 0.0 => {
                // One that nobody is warned of.
                let turning = self.modes.feed_mode == FeedMode::PerRevolution;
                self.modes.feed = if turning { 0.1 } else { 100.0 };
                vec![Call::SetFeedRate(self.modes.feed)]
            }
            "no-spindle-speed" | SPINDLE_MAY_TURN => {
                let (spindle, mut calls) = (&mut self.spindle, Vec::new());
                if spindle.speed == 0.0 {
                    spindle.speed = 100.0;
                    calls.push(Call::SetSpindleSpeed(spindle.speed));
                }
                if spindle.turning.is_none() {
                    spindle.turning = Some(Turn::Clockwise);
                    calls.push(Call::StartSpindle(Turn::Clockwise));
                }
                calls
            }
            _ => Vec::new(),
        }
    }

    /// The value of `#index` as it is stored.
    pub(crate) fn parameter(&self, index: u32) -> f64 {
        self.memory.numbered(index)
    }

    /// Stores a value in `#index`.
    pub(crate) fn set_parameter(&mut self, index: u32, value: f64) {
        self.memory.set_numbered(index, value);
    }

    /// Six parameters in machine units, as program units.
    pub(crate) fn lengths_at(&self, first: u32) -> Pose {
        let stored = [0, 1, 2, 3, 4, 5].map(|axis| self.parameter(first + axis));
        self.units.to_program(&stored)
    }

    /// Stores program units in six parameters in machine units.
    pub(crate) fn set_lengths_at(&mut self, first: u32, lengths: &Pose) {
        for (index, value) in (first..).zip(self.units.to_machine(lengths)) {
            self.set_parameter(index, value);
        }
    }

    /// Offset and rotation of a coordinate system as the parameters hold them, program units and degrees.
    pub(crate) fn origin_of(&self, system: u8) -> (Pose, f64) {
        (self.lengths_at(offset_of_system(system)), self.parameter(rotation_of_system(system)))
    }

    /// The offset of G52 and G92 as the parameters hold it, 0 while it is not applied; program units.
    pub(crate) fn shift(&self) -> Pose {
        if self.parameter(G92_APPLIED) != 0.0 { self.lengths_at(G92_OFFSET) } else { [0.0; 6] }
    }

    /// Where the centre of the tool is: the programmed point while compensation is off.
    pub(crate) fn center(&self) -> Pose {
        self.compensation.center(&self.axes.position, self.modes.plane)
    }
}
