//! Every case of the reference vectors (50-digit arithmetic), see the README beside them. The folder is
//! `PITCHLOCK_REFERENCE_DIR`, otherwise `tests/reference` of the workspace.

mod positioner;
mod shaping;
