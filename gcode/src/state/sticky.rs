//! Words of canned cycles that stay in force.

use crate::canon::Plane;
use crate::codes::G;

/// What canned cycles keep from block to block.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sticky {
    /// The cycle in force, and its plane.
    pub(crate) code: Option<(G, Plane)>,
    /// The axis across the plane where the first cycle in a row began.
    pub(crate) level: Option<f64>,
    /// R.
    pub(crate) r: f64,
    /// The word of the axis across the plane.
    pub(crate) depth: f64,
    /// P, s.
    pub(crate) dwell: f64,
    /// Q.
    pub(crate) peck: f64,
    /// I, J, K of G87.
    pub(crate) offset: [f64; 3],
    /// The block that began the cycle was refused: nothing is asked of those that repeat it.
    pub(crate) refused: bool,
}

impl Sticky {
    /// Another motion code is executed.
    pub(crate) fn end(&mut self) {
        if self.code.is_some() || self.refused {
            *self = Sticky::default();
        }
    }

    /// Converts its lengths: program units have changed.
    pub(crate) fn scale(&mut self, factor: f64) {
        if let Some(level) = &mut self.level {
            *level *= factor;
        }
        for length in [&mut self.r, &mut self.depth, &mut self.peck].into_iter().chain(&mut self.offset) {
            *length *= factor;
        }
    }
}
