//! What a program is run with: language, start of the machine, tools, parameters, limits.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;

use crate::canon::{Plane, Pose, Units};
use crate::files::ToolTable;

/// Which language a program is written in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dialect {
    /// RS274/NGC as LinuxCNC speaks it.
    #[default]
    Linuxcnc,
    /// FANUC lathe programs, G-code system A.
    Fanuc,
    /// FANUC and Haas mill programs.
    FanucMill,
}

impl Dialect {
    /// All of them.
    pub const ALL: [Dialect; 3] = [Dialect::Linuxcnc, Dialect::Fanuc, Dialect::FanucMill];

    /// Its name, as users write it.
    pub const fn name(self) -> &'static str {
        match self {
            Dialect::Linuxcnc => "linuxcnc",
            Dialect::Fanuc => "fanuc",
            Dialect::FanucMill => "fanuc-mill",
        }
    }

    /// What it is, in a few words.
    pub const fn about(self) -> &'static str {
        match self {
            Dialect::Linuxcnc => "RS274/NGC as LinuxCNC speaks it",
            Dialect::Fanuc => "FANUC lathe programs, G-code system A",
            Dialect::FanucMill => "FANUC and Haas mill programs",
        }
    }
}

impl FromStr for Dialect {
    type Err = UnknownDialect;

    fn from_str(name: &str) -> Result<Dialect, UnknownDialect> {
        let found = Dialect::ALL.into_iter().find(|dialect| dialect.name() == name);
        found.ok_or_else(|| UnknownDialect(name.to_owned()))
    }
}

/// A name that is not the name of a dialect.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a dialect: the dialects are linuxcnc, fanuc and fanuc-mill")]
pub struct UnknownDialect(String);

/// What a coordinate without a decimal point is in a FANUC program, `X40`; with a point there is no question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DecimalPoint {
    /// So many least input increments, 0.001 mm or 0.0001 inch: what controls do unless a parameter says
    /// otherwise.
    Conventional,
    /// So many mm or inch.
    PocketCalculator,
    /// Nothing: it is refused.
    Refuse,
}

/// What is done with an M code that is the machine's own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MachineCode {
    /// Nothing.
    Ignore,
    /// The program waits for cycle start, as at M0.
    Wait,
    /// A digital output is switched at once, as by M64 and M65.
    Output {
        /// Its number.
        number: u32,
        /// Whether it is on from then on.
        on: bool,
    },
    /// The program waits for a digital input, as by M66.
    Input {
        /// Its number.
        number: u32,
        /// How, as L of M66 says it: 1 to 4.
        wait: u8,
        /// At most, s.
        timeout: f64,
    },
}

/// Where a program ends that would not end by itself. Messages name the limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Lines in a row that move nothing, or by less than 0.1 to and fro: a loop of them is taken for endless.
    pub blocks_without_motion: u64,
    /// Moves of one block: holes of a canned cycle with their pecks, passes along a contour.
    pub moves_of_block: u64,
    /// Subroutine calls inside each other.
    pub call_depth: u32,
    /// Brackets, signs and `#` inside each other.
    pub expression_depth: u32,
    /// Bytes of a line.
    pub line_length: usize,
    /// Bytes of all subroutine files.
    pub subroutine_bytes: u64,
}

impl Default for Limits {
    fn default() -> Limits {
        Limits {
            blocks_without_motion: 5_000_000,
            moves_of_block: 1_000_000,
            call_depth: 100,
            expression_depth: 64,
            line_length: 4096,
            subroutine_bytes: 16 << 20,
        }
    }
}

/// What a program is run with.
#[derive(Clone, Debug)]
pub struct Options {
    /// Language.
    pub dialect: Dialect,
    /// Units of the machine: tool table, parameters.
    pub machine_units: Units,
    /// Units in force at the start.
    pub units: Units,
    /// Plane at the start.
    pub plane: Plane,
    /// G7 at the start.
    pub diameter: bool,
    /// Programmed point at the start, in the units in force.
    pub position: Pose,
    /// What a coordinate of a FANUC program without a decimal point is. `None`: as conventional with a
    /// warning, and refused in a program that has others with a point.
    pub decimal_point: Option<DecimalPoint>,
    /// M codes of the machine: those that the dialect itself has go before them.
    pub machine_codes: Arc<BTreeMap<u16, MachineCode>>,
    /// Switches of optional blocks that are on.
    pub skips: Skips,
    /// Tools.
    pub tools: ToolTable,
    /// Numbered parameters that are set at the start.
    pub parameters: Vec<(u32, f64)>,
    /// Named parameters that programs can read only: those of the machine description, such as
    /// `_ini[vars]depth`.
    pub named: Vec<(String, f64)>,
    /// G73 and G83 go back by this much between pecks, machine units.
    pub peck_clearances: [f64; 2],
    /// The shift of G52 and G92 does not outlive the end of the program.
    pub forgets_g92: bool,
    /// LinuxCNC: M98 and M99 are refused, as DISABLE_FANUC_STYLE_SUB of its machine description says.
    pub no_fanuc_subs: bool,
    /// M19 turns to this angle if R is 0, degrees.
    pub orient_offset: f64,
    /// A block that is executed before the first one: what is in force then. RS274/NGC only.
    pub startup: Option<String>,
    /// As LinuxCNC's stand-alone interpreter, where it differs from the controller: G20 and G21 leave F and
    /// the offset of the tool as numbers, a tool change brings the programmed point back to the end of the
    /// last move, an inch machine has inches of 1/0.03937007874016 mm, the first tool of the table counts as
    /// that in an empty spindle, and an error ends all calls.
    pub stand_alone: bool,
    /// G84 and G74 of RS274/NGC, which are for a floating holder, are rigid taps with the lead of F and S,
    /// and that is warned of: for a machine that taps no other way.
    pub rigid_taps: bool,
    /// The machine is a mill: a tool that works with the length of another one, or without one, is warned of.
    pub is_mill: bool,
    /// Where subroutine files are looked for, after the folder of the program.
    pub subroutine_folders: Vec<PathBuf>,
    /// Limits.
    pub limits: Limits,
}

impl Default for Options {
    /// The start of LinuxCNC's `rs274` with a millimetre machine.
    fn default() -> Options {
        Options {
            dialect: Dialect::Linuxcnc,
            machine_units: Units::Millimetre,
            units: Units::Millimetre,
            plane: Plane::Xy,
            diameter: false,
            position: [0.0; 6],
            decimal_point: None,
            machine_codes: Arc::default(),
            skips: Skips::default(),
            tools: ToolTable::default(),
            parameters: Vec::new(),
            named: Vec::new(),
            peck_clearances: [0.254; 2],
            forgets_g92: false,
            no_fanuc_subs: false,
            orient_offset: 0.0,
            startup: None,
            stand_alone: false,
            rigid_taps: false,
            is_mill: false,
            subroutine_folders: Vec::new(),
            limits: Limits::default(),
        }
    }
}

/// Switches of optional blocks that are on: lines that begin with `/`, which is `/1`, to `/9` are left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Skips(u16);

impl Skips {
    /// Switches by their numbers; 1 is that of `/` alone.
    pub fn of(switches: impl IntoIterator<Item = u8>) -> Skips {
        Skips(switches.into_iter().filter(|switch| *switch < 10).fold(0, |on, switch| on | 1 << switch))
    }

    /// Whether a switch is on.
    pub fn is_on(self, switch: u8) -> bool {
        switch < 10 && self.0 & 1 << switch != 0
    }
}
