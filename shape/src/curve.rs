//! A curve that the machine follows: where its axes stand as functions of a parameter.

use crate::series::Series;

/// A curve at one place of its parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point<const N: usize> {
    /// Where the axes stand, mm; rotary ones in degrees.
    pub axes: [Series; N],
    /// The point whose way is the length of the curve and whose speed is the feed, mm: the tool, or the beam on the part.
    pub tip: [Series; 3],
}

/// A curve of a parameter.
pub trait Curve<const N: usize> {
    /// The curve about `t`; not finite where it does not exist.
    fn at(&self, t: f64) -> Point<N>;

    /// Which axes are known up to whole turns of 360° only. Who walks along the curve takes the turn that is nearest to
    /// where the walk has come.
    fn turning(&self) -> [bool; N] {
        [false; N]
    }

    /// [`Curve::at`], with those axes by the turn that is nearest to `here`.
    fn near(&self, t: f64, here: &[f64; N]) -> Point<N> {
        let mut point = self.at(t);
        for ((axis, here), turning) in point.axes.iter_mut().zip(here).zip(self.turning()) {
            if turning {
                axis.0[0] += 360.0 * ((here - axis.0[0]) / 360.0).round();
            }
        }
        point
    }
}
