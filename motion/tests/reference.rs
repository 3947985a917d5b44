//! Every case and every sample of the reference vectors (50-digit arithmetic), see the README beside them.
//! The folder is `PITCHLOCK_REFERENCE_DIR`, otherwise `tests/reference` of the workspace.

#[path = "reference/compare.rs"]
mod compare;
#[path = "reference/feed.rs"]
mod feed;
#[path = "reference/resolution.rs"]
mod resolution;
#[path = "reference/stroke.rs"]
mod stroke;
#[path = "reference/z_axis.rs"]
mod z_axis;
