//! Every case and every sample of the reference vectors (50-digit arithmetic), see the README beside them.
//! The folder is `PITCHLOCK_REFERENCE_DIR`, otherwise `tests/reference` of the workspace.

mod feed;
mod stroke;
mod z_axis;

use motion::Sample;

/// The values of a sample, path first.
fn values(sample: Sample) -> [f64; 5] {
    [sample.s, sample.v, sample.a, sample.j, sample.dj]
}
