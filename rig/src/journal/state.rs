//! What is kept of a control.

use protocol::{ANALOG_OUTPUTS, MachineState, PerAxis, Position};
use zerocopy::{FromBytes, FromZeros as _, Immutable, IntoBytes};

use super::sheet::Kept;

/// Actions of the operator that every record holds: the last ones.
pub const ACTIONS: usize = 6;

/// What an operator did at the panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Act {
    /// Turned the spindle override to `value` per cent.
    SpindleOverride = 1,
    /// Turned the feed override.
    FeedOverride = 2,
    /// Turned the rapid override.
    RapidOverride = 3,
    /// Pressed or released buttons: `value` is their sum afterwards ([`protocol::Panel`]).
    Buttons = 4,
    /// Pressed cycle start; `value` is how often that was done so far.
    CycleStart = 5,
}

/// One action at the panel.
#[derive(Clone, Copy, Debug, Default, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct Action {
    /// The control cycle that showed it first.
    pub cycle: u64,
    /// To what.
    pub value: f64,
    /// Code of the [`Act`]; 0 for none.
    pub act: u32,
    /// Zero.
    pub reserved: u32,
}

/// All that a control knows of a run at one control cycle, of its own measurements and statuses. Nothing in
/// it is the truth of the plant.
#[derive(Clone, Copy, Debug, PartialEq, IntoBytes, FromBytes, Immutable)]
#[repr(C)]
pub struct State {
    /// When.
    pub cycle: u64,
    /// Hash of all that decides what the program does: its files, the machine file, tools, parameters.
    pub input: [u8; 16],
    /// Seed of the simulated plant.
    pub seed: u64,
    /// Items of machine code, in steps of progress from the beginning of the *program*, that were taken and
    /// are done; a pass or a dwell in hand counts, a move under way does not.
    pub step: u64,
    /// Timed moves completed in this run.
    pub moves: u64,
    /// Spindle encoder: its count, unwrapped, the count at the last index, and how many indexes came. The
    /// phase of the spindle frame: angle C counts from an index.
    pub spindle_count: i64,
    /// See there.
    pub index_count: i64,
    /// See there; 0 means that no index has been seen yet.
    pub index_number: u64,
    /// Spindle speed commanded, 1/min, signed.
    pub spindle_rpm: f64,
    /// Angle since the index of the pass in hand as the axis that threads observes it, degrees.
    pub angle_deg: f64,
    /// X and Z of the machine at which zero of the program lies in the pass in hand or the last one, all
    /// offsets included, mm.
    pub origin_mm: [f64; 2],
    /// Measured positions.
    pub measured: PerAxis<Position>,
    /// Overrides at the panel, of spindle, feed and rapid, per cent.
    pub overrides_pct: [f64; 3],
    /// The same where they rested last, while one is being turned.
    pub rested_pct: [f64; 3],
    /// The last actions at the panel, oldest first.
    pub actions: [Action; ACTIONS],
    /// How many there were in all.
    pub acted: u64,
    /// The digital outputs that are on, bit by bit, as they were commanded last; the analog ones.
    pub outputs: u64,
    /// See there.
    pub analog: [f64; ANALOG_OUTPUTS as usize],
    /// The digital inputs that were on, bit by bit.
    pub inputs: u64,
    /// State of every axis, by its code.
    pub axes: PerAxis<u8>,
    /// Line of the program.
    pub line: u32,
    /// Pass being cut or cut last.
    pub pass: u32,
    /// Pass that was begun and is not cut to its end; 0 if there is none.
    pub open: u32,
    /// Whether the operator ended the program, 1 if so.
    pub stopped: u32,
    /// Passes of the program cut to their end, in this run and in those that it goes on with.
    pub passes: u32,
    /// State of the interpolator, and its fault, by their codes.
    pub machine: u32,
    /// See there.
    pub fault: u32,
    /// Number of the tool.
    pub tool: u32,
    /// What cools ([`protocol::MachineStatus::coolant`]).
    pub coolant: u32,
    /// Buttons pressed, and how often cycle start was.
    pub buttons: u32,
    /// See there.
    pub cycle_starts: u32,
    /// The axes whose reference run is still to be made, bit by bit in the order of the wire.
    pub unreferenced: u32,
}

impl State {
    /// Of a machine before its first cycle.
    pub fn nothing() -> State {
        State { overrides_pct: [100.0; 3], rested_pct: [100.0; 3], ..State::new_zeroed() }
    }

    /// Whether the program came to its end.
    pub fn is_complete(&self) -> bool {
        self.machine == MachineState::Ended as u32 && self.stopped == 0 && self.fault == 0
    }
}

impl Kept for State {
    const MAGIC: [u8; 8] = *b"PITCHJ\0\x03";
}
