//! Where two blocks meet: stop, or go on along a path that is smooth there.
//! In: two blocks. Out: what becomes of the junction.
//!
//! | blocks | the junction | its blend |
//! |---|---|---|
//! | two lines | a corner | as wide as `width.rs` finds it may be, over other corners too |
//! | one is an arc or a piece of a curve | fixed | to half of the shorter at most, with half the tolerance |
//! | a stop is faster (`halt.rs`) | a stop | none |
//!
//! Blends of a curvature that jumps lie on both sides of the path, so those beside an arc share the
//! tolerance. Pieces of one curve have no jumps at all, so nothing is rounded between them.

use super::Block;
use super::halt::stop_is_faster;
use super::pieces::REACH_MM;
use crate::blend::{Blend, aside};
use crate::limits::Limits;
use crate::path::Path;

/// Corners that turn by more are stopped at: rounding would leave the tip uncut. Cosine of 120°.
const SHARPEST: f64 = -0.5;
/// A jump of direction below this is none: rounding of end points, 1e-9 mm over a micrometre.
const TANGENT: f64 = 1e-3;
/// Jumps of pₙ by less than this share of |p₁| by Lⁿ⁻¹ are rounding, L being the shorter block: pieces of a
/// curve have them. A block takes a sixteenth of a cycle T at least, so s′ ≤ 16 L/T there, and the n-th
/// derivative by time jumps by 1e-10 s′ (16/T)ⁿ⁻¹ at most: at 100 mm/s and 2 ms by less than 1 mm/s³ in jerk.
const ROUNDED: f64 = 1e-10;
/// A blend that reaches less far than this, mm, is slower than a stop.
const LEAST_HALF: f64 = 1e-6;

/// What may become of the corner at the end of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Corner {
    /// The machine stops (G61.1).
    Stop,
    /// The machine goes on where the direction does not change, and stops at corners (G61). Jumps of
    /// curvature are made smooth within so many mm.
    Exact(f64),
    /// The corner is rounded within so many mm (G64).
    Blend(f64),
    /// The same; a corner of two lines whose tip lies within `tip` mm of the line past it is rounded within
    /// `flat` mm, which is more (G64 Q).
    Curve {
        /// Of any other corner, mm.
        corner: f64,
        /// Of a flat one, mm.
        flat: f64,
        /// What is flat, mm.
        tip: f64,
    },
}

impl Corner {
    /// The same with nothing rounded by more than so many mm.
    #[must_use]
    pub fn at_most(self, mm: f64) -> Corner {
        match self {
            Corner::Blend(tolerance) => Corner::Blend(tolerance.min(mm)),
            Corner::Curve { corner, flat, tip } => {
                Corner::Curve { corner: corner.min(mm), flat: flat.min(mm), tip }
            }
            corner => corner,
        }
    }
}

/// What becomes of the junction of two blocks.
#[derive(Clone, Copy, Debug)]
pub(super) enum Junction<const N: usize> {
    /// The machine stops; the next law may lead it so many mm off the contour before (M194).
    Stop(f64),
    /// A blend that reaches over no other junction; [`Blend::NONE`] where nothing jumps.
    Fixed(Blend<N>),
    /// Two lines.
    Corner(Turn<N>),
}

/// A corner of two lines.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn<const N: usize> {
    /// Jump of p₁, and its size; 0 for one that is rounding.
    pub(super) jump: [f64; N],
    pub(super) size: f64,
    /// How far the path may be led away, mm.
    pub(super) tolerance: f64,
    /// The widest half width that this alone allows, mm.
    pub(super) widest: f64,
    /// There is less travel beside the lines than the path may be led away: no other blend reaches here, so
    /// that the path stays between the lines.
    pub(super) alone: bool,
}

/// What becomes of the junction of two blocks.
pub(super) fn junction<const N: usize, T>(
    last: &Block<N, T>,
    next: &Block<N, T>,
    axes: &[Limits; N],
) -> Junction<N> {
    let jumps = last.path.jumps(&next.path);
    let size = |jump: &[f64; N]| jump.iter().map(|d| d * d).sum::<f64>().sqrt();
    let turn = size(&jumps[0]);
    let tolerance = match last.corner {
        Corner::Stop => return Junction::Stop(0.0),
        Corner::Exact(tolerance) if turn <= TANGENT => tolerance,
        Corner::Exact(_) => return Junction::Stop(0.0),
        Corner::Blend(tolerance) => tolerance,
        Corner::Curve { flat, tip, .. } if is_flat(last, next, tip) => flat,
        Corner::Curve { corner, .. } => corner,
    };
    // |Δ1|² = 2 − 2 cos of the turn.
    if 1.0 - 0.5 * turn * turn < SHARPEST || !last.feed.same_kind(next.feed) {
        return Junction::Stop(0.0);
    }
    let shorter = last.path.length().min(next.path.length());
    let lines = last.path.is_line() && next.path.is_line();
    let room = last.room.min(next.room);
    let spare = tolerance.min(room);
    let mut rounding = ROUNDED * size(&next.path.at(0.0)[1]);
    let smooth = jumps.iter().all(|jump| {
        let joins = size(jump) <= rounding;
        rounding /= shorter;
        joins
    });
    if lines {
        let (jump, size) = if smooth { ([0.0; N], 0.0) } else { (jumps[0], turn) };
        let widest = tolerance / (aside(0.0, 1.0) * size);
        let blend = Blend::new([jump, [0.0; N], [0.0; N]], widest.min(shorter).min(REACH_MM));
        if widest < LEAST_HALF.min(shorter) || stop_is_faster([last, next], &blend, size, spare, axes) {
            return Junction::Stop(spare);
        }
        let alone = room < tolerance;
        return Junction::Corner(Turn { jump, size, tolerance, widest, alone });
    }
    if smooth {
        return Junction::Fixed(Blend::NONE);
    }
    let tolerance = (0.5 * tolerance).min(room);
    let half = Blend::half_within(&jumps, tolerance, 0.5 * shorter);
    let blend = Blend::new(jumps, half);
    if half < LEAST_HALF.min(0.5 * shorter) || stop_is_faster([last, next], &blend, turn, spare, axes) {
        return Junction::Stop(spare);
    }
    Junction::Fixed(blend)
}

/// Whether the corner of two lines lies within `tip` mm of the line past it, and both lead along that.
fn is_flat<const N: usize, T>(last: &Block<N, T>, next: &Block<N, T>, tip: f64) -> bool {
    let end = |path: &Path<N>| path.at(path.length())[0];
    let dot = |a: &[f64; N], b: &[f64; N]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (to, on) = (end(&last.path), end(&next.path));
    let past: [f64; N] = core::array::from_fn(|i| to[i] + on[i]);
    let (along, all) = (dot(&to, &past), dot(&past, &past));
    // The square of the distance, times that of the length.
    let aside = (dot(&to, &to) * all - along * along).max(0.0);
    let lines = last.path.is_line() && next.path.is_line();
    lines && along > 0.0 && dot(&on, &past) > 0.0 && aside <= tip * tip * all
}
