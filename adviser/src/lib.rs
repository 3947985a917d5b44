//! How fine a control has to count, as equations: what rounded positions do to speed, acceleration and jerk
//! ([`resolution`], M28–M35), and the standard tolerances of lengths that parts have to keep ([`tolerance`],
//! M94).
//!
//! The command that asks these questions of a machine file is `pitchlock resolution`.
#![forbid(unsafe_code)]

pub mod resolution;
pub mod tolerance;
