//! The positioner of a machine file as `shape` knows it. In: mm, degrees. Out: geometry and drives, mm and
//! radians.
use machine::{POSITIONER_AXES, PositionerConfig};
use protocol::PerAxis;
use shape::{Drives, Positioner};

/// The geometry that a machine file describes.
pub fn geometry(config: &PositionerConfig) -> Positioner {
    let PositionerConfig { x1_mm: x1, y1_mm: y1, z1_mm: z1, x2_mm: x2, y2_mm: y2, z2_mm: z2, .. } = *config;
    Positioner { x1, y1, z1, x2, y2, z2 }
}

/// Drives of a positioner where its axes stand at `axes`, mm and degrees.
pub fn drives(axes: &PerAxis<f64>) -> Drives {
    let [x, y, alpha, beta] = POSITIONER_AXES.map(|axis| axes[axis.index()]);
    Drives { x, y, alpha: alpha.to_radians(), beta: beta.to_radians() }
}
