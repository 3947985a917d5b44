//! Every case of the reference vectors (50-digit arithmetic), see the README beside them. The folder is
//! `PITCHLOCK_REFERENCE_DIR`, otherwise `tests/reference` of the workspace.

#[expect(dead_code, reason = "shared with the reference tests of motion, which use all of it")]
#[path = "../../motion/tests/reference/compare.rs"]
mod compare;
#[path = "reference/positioner.rs"]
mod positioner;
#[path = "reference/shaping.rs"]
mod shaping;
