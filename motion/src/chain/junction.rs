//! Where two blocks meet: stop, or go on along a path that is smooth there.
//! In: two blocks. Out: the blend of the junction, or none if the machine has to stop.
//!
//! A blend reaches equally far along both blocks. Between two lines it may reach to their other ends: the
//! deviations of two neighbouring corners are convex along the line between them, so their sum is nowhere
//! larger than at its ends, where only one is left. Beside an arc it reaches to the middle at most and has
//! half the tolerance, because blends of a curvature that jumps lie on both sides of the path. The same holds
//! beside a piece of a curve; pieces of one curve have no jumps at all, so nothing is rounded between them.

use super::Block;
use crate::blend::Blend;

/// Corners that turn by more are stopped at: rounding would leave the tip uncut. Cosine of 120°.
const SHARPEST: f64 = -0.5;
/// A jump of direction below this is none: rounding of end points, 1e-9 mm over a micrometre.
const TANGENT: f64 = 1e-3;
/// Lines whose lengths differ by less, relative, are equally long: their blends fill them, and a curve that
/// was finely divided keeps its own curvature.
pub(super) const ALIKE: f64 = 1e-3;
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
}

/// The blend of the junction of two blocks; `None` for a stop.
pub(super) fn blend<const N: usize, T>(last: &Block<N, T>, next: &Block<N, T>) -> Option<Blend<N>> {
    let jumps = last.path.jumps(&next.path);
    let size = |jump: &[f64; N]| jump.iter().map(|d| d * d).sum::<f64>().sqrt();
    let turn = size(&jumps[0]);
    let tolerance = match last.corner {
        Corner::Stop => return None,
        Corner::Exact(tolerance) if turn <= TANGENT => tolerance,
        Corner::Exact(_) => return None,
        Corner::Blend(tolerance) => tolerance,
    };
    // |Δ1|² = 2 − 2 cos of the turn.
    if 1.0 - 0.5 * turn * turn < SHARPEST || !last.feed.same_kind(next.feed) {
        return None;
    }
    let (lengths, lines) =
        ([last.path.length(), next.path.length()], last.path.is_line() && next.path.is_line());
    let (shorter, longer) = (lengths[0].min(lengths[1]), lengths[0].max(lengths[1]));
    let (tolerance, cap) = if lines {
        // What of the longer reach is cut off at the end of the shorter line is π ALIKE of the blend's p₃ at
        // most: as a step of jerk, less in a cycle than the rate of a smooth change.
        (tolerance, if longer - shorter <= ALIKE * shorter { longer } else { shorter })
    } else {
        ((0.5 * tolerance).min(last.room).min(next.room), 0.5 * shorter)
    };
    let mut rounding = ROUNDED * size(&next.path.at(0.0)[1]);
    let smooth = jumps.iter().all(|jump| {
        let joins = size(jump) <= rounding;
        rounding /= shorter;
        joins
    });
    if smooth {
        return Some(Blend::NONE);
    }
    let half = Blend::half_within(&jumps, tolerance, cap);
    (half >= LEAST_HALF.min(cap)).then(|| Blend::new(jumps, half))
}
