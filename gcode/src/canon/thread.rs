//! A threading cycle as one call: G76 of LinuxCNC, G76 and G92 of FANUC.
//!
//! ```text
//! depth of pass n    d_n = min(max(J n^(1/R), d_(n-1) + m), K - f), then K, then the spring passes at K
//! start of a pass    Z0 + d tan Q            towards the end
//! end of a pass      Ze - (K - d) tan Q      so that the last one ends at Ze
//! ```
//! with J first depth, R degression, m least cut, f finishing allowance, K full depth, Q infeed angle.

/// How the depth grows from pass to pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Degression {
    /// J: depth of the first pass, > 0.
    pub first: f64,
    /// R, ≥ 1: 1 is constant depth, 2 constant area.
    pub exponent: f64,
    /// Least growth of a pass; 0 for none.
    pub least: f64,
    /// What the last cutting pass leaves for one finishing pass; 0 for none.
    pub finish: f64,
}

/// A threading cycle. Lengths in program units, X a radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadCycle {
    /// Where the tool stands: X is the drive line.
    pub from: super::Position,
    /// Z of the end of the full depth thread.
    pub end_z: f64,
    /// X at the end minus X at the start of the thread: a tapered thread; 0 for a straight one.
    pub taper_x: f64,
    /// Lead along Z, units per revolution, > 0.
    pub lead: f64,
    /// I: drive line to crest; negative for an external thread.
    pub crest: f64,
    /// K: full depth, ≥ first depth.
    pub depth: f64,
    /// Depths of the passes.
    pub degression: Degression,
    /// Q: angle of the infeed, degrees.
    pub infeed_deg: f64,
    /// H: passes at full depth after the last.
    pub springs: u32,
    /// E: length of the tapers at the ends, along Z.
    pub chamfer: f64,
    /// Taper at the start (L1, L3).
    pub chamfer_in: bool,
    /// Taper at the end (L2, L3).
    pub chamfer_out: bool,
    /// Angle of the spindle at which the thread starts, degrees (FANUC Q); 0 is the index.
    pub start_deg: f64,
}
