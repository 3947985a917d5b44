//! The walk along a contour that roughing makes.
//!
//! In: a start point and a contour in the frame of the cuts ([`super::frame`]). Out: steps, in order. Where
//! the contour falls, it is descended level by level, and on each level a pass goes across to the next place
//! where the contour rises to that level. Where it rises (or is level), the tool follows it. So a *pocket*,
//! where the contour falls again, is cut when the tool gets there.
//!
//! ```text
//! levels    x_k = x_top − k i,  k = k_first, k_first + 1, ...                      (6)
//! ```
//!
//! x_top is the height of the start point; if only pockets are cut, that of their highest rim so far.

use super::contour::{NEAR, Point, Segment};
use super::passes::{Pockets, Roughing};

/// A piece of a contour that only rises (or is level), or only falls.
#[derive(Clone, Copy, Debug)]
struct Flank {
    segment: Segment,
    rises: bool,
    /// The second half of an arc that rises and falls, or falls and rises.
    second: bool,
}

/// What the walk does next.
pub(super) enum Step {
    /// Down a flank; `lead` on the way to the contour, in the air.
    Down { part: Segment, lead: bool },
    /// Across a level.
    Across { from: Point, to: Point, lead: bool },
    /// Straight on to a flank that begins or passes at the height of the tool.
    Bridge(Point),
    /// Up a flank.
    Up { part: Segment, valley: bool },
}

/// The way to the contour, and its flanks.
fn flanks(start: Point, contour: &[Segment]) -> Vec<Flank> {
    let Some(first) = contour.first() else { return Vec::new() };
    let flank =
        |segment: Segment, second| Flank { segment, rises: segment.end.x >= segment.start.x - NEAR, second };
    let mut flanks = vec![flank(Segment::line(start, first.start), false)];
    for segment in contour {
        let (one, two) = segment.halves();
        flanks.push(flank(one, false));
        flanks.extend(two.map(|two| flank(two, true)));
    }
    flanks
}

/// How far a walk goes down, all pockets added up: it makes a pass for each infeed of that, and one for each
/// place where it begins to go down.
pub(crate) fn descent(start: Point, contour: &[Segment]) -> f64 {
    flanks(start, contour).iter().map(|flank| (flank.segment.start.x - flank.segment.end.x).max(0.0)).sum()
}

/// Walks along a contour. Levels are counted from `first` (6).
pub(super) fn walk<E>(
    start: Point,
    contour: &[Segment],
    first: u32,
    how: &Roughing,
    visit: &mut dyn FnMut(Step) -> Result<(), E>,
) -> Result<(), E> {
    let flanks = flanks(start, contour);
    let infeed = how.infeed.max(2.0 * NEAR);
    let (mut at, mut top, mut next) = (start, start.x, 0);
    let mut level = start.x - f64::from(first) * infeed;
    let mut pocket = false;
    while let Some(flank) = flanks.get(next) {
        let lead = next == 0;
        if flank.rises {
            if how.pockets == Pockets::Bridge {
                return bridge(flanks.iter().skip(next), at, visit);
            }
            // a pass at the bottom of a valley divides it
            let valley = flank.second && (level - at.x).abs() > NEAR;
            visit(Step::Up { part: Segment { start: at, ..flank.segment }, valley })?;
            at = flank.segment.end;
            next += 1;
            if flanks.get(next).is_some_and(|flank| !flank.rises) {
                if how.pockets == Pockets::Only && (!pocket || at.x > top) {
                    top = at.x;
                }
                pocket = true;
                level = top - ((top - at.x - NEAR) / infeed).ceil().max(0.0) * infeed;
            }
            continue;
        }
        let part = Segment { start: at, ..flank.segment };
        let skip = how.pockets == Pockets::Only && !pocket;
        let z = part.z_at(level).filter(|_| !skip && level > part.end.x + NEAR);
        let Some(z) = z else {
            visit(Step::Down { part, lead })?;
            at = part.end;
            next += 1;
            continue;
        };
        at = Point::new(z, level);
        visit(Step::Down { part: Segment { end: at, ..part }, lead })?;
        let mut rising = flanks.iter().skip(next + 1).filter(|flank| flank.rises);
        let wall = rising.find_map(|flank| flank.segment.z_at(level)).filter(|wall| at.z - wall > NEAR);
        if let Some(wall) = wall {
            visit(Step::Across { from: at, to: Point::new(wall, level), lead })?;
        }
        // an infeed too small to change the level ends the descent
        level = if level - infeed < level { level - infeed } else { f64::NEG_INFINITY };
    }
    Ok(())
}

/// Follows what rises of the flanks, and goes straight over what lies lower than the tool.
fn bridge<'a, E>(
    flanks: impl Iterator<Item = &'a Flank>,
    mut at: Point,
    visit: &mut dyn FnMut(Step) -> Result<(), E>,
) -> Result<(), E> {
    for Flank { segment, rises, second } in flanks {
        if !rises {
            let summit =
                segment.bend.is_some_and(|bend| bend.ccw && (bend.center.z - segment.start.z).abs() < NEAR);
            if summit && !second && (segment.start.x - at.x).abs() < NEAR {
                at = segment.start;
                visit(Step::Bridge(at))?;
            }
            continue;
        }
        let Some(z) = segment.z_at(at.x) else { continue };
        let from = Point::new(z, at.x);
        let valley = *second && from.distance(at) < NEAR;
        if !valley {
            visit(Step::Bridge(from))?;
        }
        visit(Step::Up { part: Segment { start: from, ..*segment }, valley })?;
        at = segment.end;
    }
    Ok(())
}
