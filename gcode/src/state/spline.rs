//! What splines keep from block to block.

/// G5 and G5.2 between their blocks.
#[derive(Clone, Debug, Default)]
pub(crate) struct Spline {
    /// Where the next G5 begins to go to without I and J: from its start, program units.
    pub(crate) onwards: Option<[f64; 2]>,
    /// The curve that G5.2 began.
    pub(crate) open: Option<Box<OpenCurve>>,
    /// The curve that G6.2 began.
    pub(crate) knotted: Option<Box<KnottedCurve>>,
}

/// A curve of G6.2 whose blocks have not ended.
#[derive(Clone, Debug, Default)]
pub(crate) struct KnottedCurve {
    /// P.
    pub(crate) order: usize,
    /// Points and weights in the plane, program units.
    pub(crate) points: Vec<[f64; 3]>,
    /// K of all blocks.
    pub(crate) knots: Vec<f64>,
    /// One of its blocks was wrong: it is not made.
    pub(crate) broken: bool,
}

/// A curve between G5.2 and G5.3.
#[derive(Clone, Debug)]
pub(crate) struct OpenCurve {
    /// L.
    pub(crate) order: usize,
    /// Points and weights in the plane, program units.
    pub(crate) points: Vec<[f64; 3]>,
    /// One of its blocks was wrong: it is not made.
    pub(crate) broken: bool,
}
