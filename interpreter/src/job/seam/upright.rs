//! A seam whose direction passes that of the turn axis closely, where C would have to turn fast. In: seams,
//! their formulas, how far their direction may be off. Out: the way of the axes, with a direction that is
//! moved so that it goes through that of the turn axis (M239) where this is within the tolerance and faster.

use machine::PositionerConfig;
use shape::{Formula, Seam};

use super::super::{Fault, Job};
use super::travel::{self, Asked, Travelled, on, place};

/// Places of all seams together at which is looked first, and of each at the least.
const PLACES: usize = 4096;
const FEWEST: usize = 16;
/// Steps that narrow down the nearest place: each leaves 0.618 of the way.
const NARROWED: usize = 40;
/// The golden section.
const GOLDEN: f64 = 0.618_033_988_749_894_8;

/// The solution that is nearest. Where a rotary axis does not keep the feed, and the direction may be off by
/// as much as it passes that of the turn axis, it is moved so that it goes through it.
///
/// # Errors
/// As [`travel::nearest`].
pub(super) fn best(
    job: &Job,
    seams: &[Seam],
    formulas: &[Formula],
    asked: &Asked,
) -> Result<Travelled, Fault> {
    let found = travel::nearest(job, seams, formulas, asked);
    let (Some(positioner), true) = (&job.machine.positioner, asked.tolerance_deg > 0.0) else { return found };
    if found.as_ref().is_ok_and(|way| way.warning.is_none()) {
        return found;
    }
    let pass = passing(seams, formulas, positioner);
    let Some(pass) = pass.filter(|pass| pass.off_deg() <= asked.tolerance_deg) else { return found };
    let moved: Vec<Seam> = seams.iter().map(|seam| Seam { moved: Some(pass.moved), ..*seam }).collect();
    match (travel::nearest(job, &moved, formulas, asked), found) {
        (Ok(way), Ok(found)) if way.slowest.0 <= found.slowest.0 => Ok(found),
        (Ok(mut way), _) => {
            let told =
                format!("up to {:.4} deg off, that of the turn axis at {}", pass.off_deg(), pass.place);
            way.moved = Some(told);
            Ok(way)
        }
        (Err(_), found) => found,
    }
}

/// Where a direction is nearest to that of the turn axis.
struct Nearest {
    /// c of M239.
    moved: [f64; 2],
    /// The place in words.
    place: String,
}

impl Nearest {
    /// By how much a direction that is moved is off at the most, degrees (M239).
    fn off_deg(&self) -> f64 {
        (2.0 * libm::atan(length(self.moved) / 2.0)).to_degrees()
    }
}

/// The nearest place of all seams; none where a direction goes through that of the turn axis already.
fn passing(seams: &[Seam], formulas: &[Formula], positioner: &PositionerConfig) -> Option<Nearest> {
    let places = (PLACES / seams.len().max(1)).max(FEWEST);
    let looked = seams.iter().enumerate().flat_map(|(index, seam)| {
        let [from, to] = seam.t;
        let at = move |n: usize| from + (to - from) * n as f64 / places as f64;
        (0..=places).map(move |n| (length(leaning(seam, formulas, positioner, at(n))), index, at(n)))
    });
    let (_, index, t) = looked.filter(|(c, ..)| c.is_finite()).min_by(|(a, ..), (b, ..)| a.total_cmp(b))?;
    let seam = seams.get(index)?;
    let t = narrowed(seam, formulas, positioner, t, (seam.t[1] - seam.t[0]).abs() / places as f64);
    let moved = leaning(seam, formulas, positioner, t);
    let is_beside = length(moved) > 0.0 && length(moved).is_finite();
    is_beside.then(|| Nearest { moved, place: place(seam, index, t) })
}

/// The place where a direction leans least, not farther than `step` from t: by golden sections.
fn narrowed(seam: &Seam, formulas: &[Formula], positioner: &PositionerConfig, t: f64, step: f64) -> f64 {
    let off = |t: f64| length(leaning(seam, formulas, positioner, t));
    let (low, high) = (seam.t[0].min(seam.t[1]), seam.t[0].max(seam.t[1]));
    let [mut from, mut to] = [(t - step).max(low), (t + step).min(high)];
    for _ in 0..NARROWED {
        let [left, right] = [to - GOLDEN * (to - from), from + GOLDEN * (to - from)];
        if off(left) <= off(right) {
            to = right;
        } else {
            from = left;
        }
    }
    // The first look is kept where the direction leans less there: an end of the seam, a corner.
    [t, from, to].into_iter().min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap_or(t)
}

/// (lx, ly)/lz at t; no number where there is no direction.
fn leaning(seam: &Seam, formulas: &[Formula], positioner: &PositionerConfig, t: f64) -> [f64; 2] {
    let [_, [x, y, z]] = on(seam, formulas, positioner).place(t);
    [x.value() / z.value(), y.value() / z.value()]
}

fn length([x, y]: [f64; 2]) -> f64 {
    libm::hypot(x, y)
}
