//! A surface Z = ψ(X, Y), the tool on it, and the pattern of its paths.

use serde::{Deserialize, Serialize};

/// A tool that turns about Z. `corner_mm` = 0 is flat, = `radius_mm` a ball, in between a bull nose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tool {
    /// Radius, mm, > 0.
    pub radius_mm: f64,
    /// Radius of its corner, mm, 0 to `radius_mm`.
    pub corner_mm: f64,
}

/// Where the tool touches the surface, seen from above.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Pattern {
    /// Parallel lines along X, or along Y.
    Lines {
        /// Along Y instead of X.
        along_y: bool,
        /// Distance of neighbours, mm; so many lines fill the domain from border to border.
        count: u32,
        /// Every other line backwards, joined along the border; else all in one sense, with retracts.
        zigzag: bool,
    },
    /// Along the border of the domain, ring in ring, from outside inwards.
    Rings {
        /// Distance of neighbours, mm.
        step_mm: f64,
    },
    /// One curve x(t), y(t): formulas 1 and 2.
    Curve {
        /// t at the start and at the end.
        t: [f64; 2],
    },
}

/// A surface. Formula 0 is ψ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Surface {
    /// Domain: lowest and highest X, mm.
    pub x: [f64; 2],
    /// Lowest and highest Y, mm.
    pub y: [f64; 2],
    /// The tool.
    pub tool: Tool,
    /// Its paths.
    pub pattern: Pattern,
    /// Height of the tool above the part where it does not cut, mm.
    pub clear_mm: f64,
}
