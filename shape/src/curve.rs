//! A curve that the machine follows: where its axes stand as functions of a parameter.

use crate::series::Series;

/// A curve at one place of its parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point<const N: usize> {
    /// Where the axes stand, mm; rotary ones in degrees.
    pub axes: [Series; N],
    /// The point whose way is the length of the curve and whose speed is the feed, mm: the tool, or the beam
    /// on the part.
    pub tip: [Series; 3],
}

/// A curve of a parameter.
pub trait Curve<const N: usize> {
    /// The curve about `t`; not finite where it does not exist.
    fn at(&self, t: f64) -> Point<N>;

    /// [`Curve::at`], where the axes can be at several places for one point of the curve, at that which is
    /// nearest to `here`. Who walks along the curve asks so, with where the walk has come.
    fn near(&self, t: f64, here: &[f64; N]) -> Point<N> {
        let _ = here;
        self.at(t)
    }
}
