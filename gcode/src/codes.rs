//! G and M codes, and the modal groups that they exclude each other in.
//!
//! A code is ten times its number, so that G33.1 is `G(331)`. Groups are those of RS274/NGC (NIST IR 6556,
//! table 4) with the additions of LinuxCNC.

use std::fmt;

/// A G code, in tenths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct G(pub u16);

/// An M code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct M(pub u16);

impl fmt::Display for G {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 % 10 {
            0 => write!(f, "G{}", self.0 / 10),
            tenth => write!(f, "G{}.{tenth}", self.0 / 10),
        }
    }
}

impl fmt::Display for M {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "M{}", self.0)
    }
}

/// Number of modal groups of G codes.
pub(crate) const G_GROUPS: usize = 16;
/// Number of modal groups of M codes.
pub(crate) const M_GROUPS: usize = 10;

/// Groups of G codes, as indexes.
pub(crate) mod group {
    /// Not modal: G4 G10 G28 G28.1 G30 G30.1 G52 G53 G92.
    pub(crate) const ONCE: usize = 0;
    /// G0 to G3, G5, G6.2, G33, G38, G70 to G76, G80 to G89.
    pub(crate) const MOTION: usize = 1;
    /// G17 G18 G19.
    pub(crate) const PLANE: usize = 2;
    /// G90 G91.
    pub(crate) const DISTANCE: usize = 3;
    /// G90.1 G91.1.
    pub(crate) const ARC_DISTANCE: usize = 4;
    /// G93 G94 G95.
    pub(crate) const FEED_MODE: usize = 5;
    /// G20 G21.
    pub(crate) const UNITS: usize = 6;
    /// G40 G41 G42.
    pub(crate) const COMPENSATION: usize = 7;
    /// G43 G49.
    pub(crate) const TOOL_LENGTH: usize = 8;
    /// G92.1 G92.2 G92.3.
    pub(crate) const SUSPENSION: usize = 9;
    /// G98 G99.
    pub(crate) const RETRACT: usize = 10;
    /// G54 to G59.3.
    pub(crate) const COORDINATES: usize = 12;
    /// G61 G64.
    pub(crate) const PATH: usize = 13;
    /// G96 G97.
    pub(crate) const SPINDLE_MODE: usize = 14;
    /// G7 G8.
    pub(crate) const DIAMETER: usize = 15;
}

/// Groups of M codes, as indexes.
pub(crate) mod m_group {
    /// M0 M1 M2 M30 M60 (M99 at the end of a program).
    pub(crate) const STOP: usize = 0;
    /// M62 to M68.
    pub(crate) const IO: usize = 1;
    /// M6 M61.
    pub(crate) const TOOL: usize = 2;
    /// M3 M4 M5 M19.
    pub(crate) const SPINDLE: usize = 3;
    /// M7.
    pub(crate) const MIST: usize = 4;
    /// M8, M9.
    pub(crate) const FLOOD: usize = 5;
    /// M48 to M53.
    pub(crate) const OVERRIDE: usize = 6;
    /// M70 to M73.
    pub(crate) const STATE: usize = 7;
    /// M98 M99.
    pub(crate) const CALL: usize = 8;
    /// Codes of the machine that switch an output.
    pub(crate) const MACHINE: usize = 9;
}

/// The group of a G code of the dialect `linuxcnc`, or `None` if there is no such code.
pub fn g_group(code: G) -> Option<usize> {
    Some(match code.0 {
        40 | 100 | 280 | 281 | 300 | 301 | 520 | 530 | 920 => group::ONCE,
        921..=923 => group::SUSPENSION,
        0
        | 10
        | 20
        | 30
        | 50..=53
        | 62
        | 63
        | 330
        | 331
        | 382..=385
        | 700
        | 710..=712
        | 720..=722
        | 730
        | 740
        | 760
        | 800
        | 810
        | 820
        | 830
        | 840
        | 850
        | 860
        | 870
        | 880
        | 890 => group::MOTION,
        170 | 180 | 190 | 171 | 181 | 191 => group::PLANE,
        900 | 910 => group::DISTANCE,
        901 | 911 => group::ARC_DISTANCE,
        930 | 940 | 950 => group::FEED_MODE,
        200 | 210 => group::UNITS,
        400 | 410 | 411 | 420 | 421 => group::COMPENSATION,
        430..=432 | 490 => group::TOOL_LENGTH,
        980 | 990 => group::RETRACT,
        540 | 550 | 560 | 570 | 580 | 590..=593 => group::COORDINATES,
        610 | 611 | 640 => group::PATH,
        960 | 970 => group::SPINDLE_MODE,
        70 | 80 => group::DIAMETER,
        _ => return None,
    })
}

/// The group of an M code of the dialect `linuxcnc`, or `None` if there is no such code.
pub fn m_group(code: M) -> Option<usize> {
    Some(match code.0 {
        0 | 1 | 2 | 30 | 60 => m_group::STOP,
        62..=68 => m_group::IO,
        6 | 61 => m_group::TOOL,
        3 | 4 | 5 | 19 => m_group::SPINDLE,
        7 => m_group::MIST,
        8 | 9 => m_group::FLOOD,
        48..=53 => m_group::OVERRIDE,
        70..=73 => m_group::STATE,
        98 | 99 => m_group::CALL,
        _ => return None,
    })
}

/// The code of a coordinate system: 1 is G54, 9 is G59.3.
pub(crate) fn system_code(system: u8) -> G {
    match u16::from(system) {
        system @ 1..=6 => G(530 + 10 * system),
        system => G(584 + system),
    }
}
