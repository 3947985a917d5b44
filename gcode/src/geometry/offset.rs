//! A contour with an allowance on it: what the centre of a circle of that radius describes that rolls along.
//!
//! In: a monotone contour in the frame of the cuts ([`super::contour`]), a distance d, positive towards the
//! tool. Out: the contour that is d away from it. Every segment moves by d (2); at a corner that sticks out,
//! an arc about it joins the two (a corner blunter than the rounding of programs is left sharp). These pieces
//! are functions x(z). What is d away from all of the contour is their upper envelope (the lower one for d <
//! 0), so notches narrower than the circle close by themselves:
//!
//! ```text
//! x(z) = max x_i(z) over all pieces i that have a z      (5)
//! ```
//!
//! Walls have no x(z): they are where the envelope jumps, and where it begins or ends.

use super::contour::{NEAR, Point, Segment, crossings};

/// Corners that open by less than this along Z get no arc.
const SHARP: f64 = 1e-2;

/// The contour at a distance, or `None` if nothing is left of it.
pub(crate) fn raised(contour: &[Segment], distance: f64) -> Option<Vec<Segment>> {
    if distance == 0.0 {
        return Some(contour.to_vec());
    }
    let pieces = pieces(contour, distance);
    let to = pieces.last()?.end.z;
    joined(&pieces, to, distance)
}

/// The contour that roughing leaves at a distance, 0 or greater: as [`raised`], but it reaches the Z in which
/// the contour ends, unless that is a wall. What is beyond the end is not of the contour: it gets no
/// allowance.
pub(crate) fn left_on(contour: &[Segment], distance: f64) -> Option<Vec<Segment>> {
    let Some(last) = contour.iter().rfind(|segment| segment.chord() > NEAR).filter(|last| !last.is_wall())
    else {
        return raised(contour, distance);
    };
    if distance == 0.0 {
        return raised(contour, distance);
    }
    let mut pieces = pieces(contour, distance);
    let over = last.end + last.direction(last.end).right() * distance;
    pieces.push(Segment::arc(over, last.end - Point::new(distance, 0.0), last.end, true));
    joined(&pieces, last.end.z, distance)
}

/// The envelope (5) of moved segments up to a Z, with walls where it jumps.
fn joined(pieces: &[Segment], to: f64, distance: f64) -> Option<Vec<Segment>> {
    let first = pieces.first()?;
    let from = first.start.z;
    if to > from + NEAR {
        return None;
    }
    let runs = envelope(pieces, from, to, distance.signum());
    let sunk = |run: &&Segment| {
        // a wall at the beginning that leads to the material, and is all below the rest
        let (wall, over) = (first.end.x - first.start.x, run.start.x - first.start.x);
        !first.is_wall() || (wall * distance < 0.0 && over * distance > 0.0)
    };
    let begin = runs.first().filter(sunk).map_or(first.start, |run| run.start);
    let mut path = Path { at: begin, segments: Vec::with_capacity(runs.len() + 2) };
    for run in runs {
        path.join(run.start);
        path.add(run);
    }
    let walls = pieces.iter().rev().take_while(|piece| piece.is_wall()).count();
    for wall in pieces.iter().skip(pieces.len() - walls) {
        for to in [wall.start, wall.end] {
            if (to.x - path.at.x) * (wall.end.x - wall.start.x) > 0.0 {
                path.join(to);
            }
        }
    }
    Some(path.segments).filter(|segments| !segments.is_empty())
}

/// The moved segments with arcs about the corners, in order.
fn pieces(contour: &[Segment], distance: f64) -> Vec<Segment> {
    let mut pieces: Vec<Segment> = Vec::with_capacity(2 * contour.len());
    let mut before: Option<(&Segment, Segment, bool)> = None;
    for segment in contour.iter().filter(|segment| segment.chord() > NEAR) {
        let (mut moved, left) = segment.offset(distance);
        let opening = before.filter(|(previous, ..)| {
            opens(previous.direction(previous.end), segment.direction(segment.start), distance)
        });
        if let Some((previous, last, last_left)) = opening {
            match tip(&last, &moved) {
                None => pieces.push(Segment::arc(last.end, moved.start, previous.end, distance > 0.0)),
                Some(tip) => {
                    moved.start = tip;
                    if let Some(last) = pieces.last_mut().filter(|_| last_left) {
                        last.end = tip;
                    }
                }
            }
        }
        if left {
            pieces.push(moved);
        }
        before = Some((segment, moved, left));
    }
    if distance > 0.0 {
        cap_the_ends(contour, distance, &mut pieces);
    }
    pieces
}

/// Where the first or the last segment has vanished, the half circle about that end of the contour takes its
/// place.
fn cap_the_ends(contour: &[Segment], distance: f64, pieces: &mut Vec<Segment>) {
    let way = Point::new(distance, 0.0);
    let cap = |end: Point| Segment::arc(end + way, end - way, end, true);
    let vanished = |segment: &&Segment| !segment.offset(distance).1;
    if let Some(first) = contour.first().filter(vanished) {
        pieces.insert(0, cap(first.start));
    }
    if let Some(last) = contour.last().filter(vanished) {
        pieces.push(cap(last.end));
    }
}

/// Whether a corner from one direction to another sticks out towards the side of `distance`: a turn to the
/// left for the right side. Straight back is a turn to the left on top of a spike.
fn opens(before: Point, after: Point, distance: f64) -> bool {
    let turn = before.cross(after);
    let turn = if turn.abs() < 1e-9 && before.dot(after) < 0.0 { before.x } else { turn };
    turn * distance > 0.0
}

/// The point that two segments meet in if they are made longer, if the corner is a blunt one.
fn tip(before: &Segment, after: &Segment) -> Option<Point> {
    let gap = before.end.distance(after.start);
    if before.end.z - after.start.z > SHARP {
        return None;
    }
    let tips = crossings(before, after).into_iter().flatten();
    let tip = tips.min_by(|a, b| a.distance(before.end).total_cmp(&b.distance(before.end)));
    match tip.filter(|tip| tip.distance(before.end) <= 2.0 * gap) {
        None if gap < NEAR => Some(before.end),
        tip => tip,
    }
}

/// The parts of pieces that are highest (lowest for `side` −1) between two Z, from the greater to the smaller
/// (5).
fn envelope(pieces: &[Segment], from: f64, to: f64, side: f64) -> Vec<Segment> {
    let mut pieces: Vec<&Segment> = pieces.iter().filter(|piece| !piece.is_wall()).collect();
    pieces.sort_by(|a, b| b.start.z.total_cmp(&a.start.z));
    let mut breaks = vec![from, to];
    for (i, piece) in pieces.iter().enumerate() {
        breaks.extend([piece.start.z, piece.end.z]);
        for other in pieces.iter().skip(i + 1).take_while(|other| other.start.z > piece.end.z) {
            breaks.extend(crossings(piece, other).into_iter().flatten().map(|at| at.z));
        }
    }
    breaks.retain(|z| (to..=from).contains(z));
    breaks.sort_by(|a, b| b.total_cmp(a));
    breaks.dedup_by(|a, b| *b - *a < 1e-9);

    let mut runs: Vec<(&Segment, f64, f64)> = Vec::new();
    let (mut next, mut active): (usize, Vec<&Segment>) = (0, Vec::new());
    for (z, end) in breaks.iter().zip(breaks.iter().skip(1)) {
        let middle = (z + end) / 2.0;
        while let Some(piece) = pieces.get(next).filter(|piece| piece.start.z > middle) {
            active.push(piece);
            next += 1;
        }
        active.retain(|piece| piece.end.z < middle);
        let height = |piece: &Segment| side * piece.x_at(middle);
        let Some(top) = active.iter().copied().max_by(|a, b| height(a).total_cmp(&height(b))) else {
            continue;
        };
        match runs.last_mut() {
            Some((same, _, last)) if std::ptr::eq(*same, top) => *last = *end,
            _ => runs.push((top, *z, *end)),
        }
    }
    runs.into_iter().map(|(piece, from, to)| piece.between(from, to)).collect()
}

/// A contour that grows.
struct Path {
    at: Point,
    segments: Vec<Segment>,
}

impl Path {
    /// Adds a line to a point, unless it is there.
    fn join(&mut self, to: Point) {
        if self.at.distance(to) > NEAR {
            self.segments.push(Segment::line(self.at, to));
            self.at = to;
        }
    }

    /// Adds a segment that begins where the path ends.
    fn add(&mut self, segment: Segment) {
        if segment.chord() > NEAR {
            self.segments.push(Segment { start: self.at, ..segment });
            self.at = segment.end;
        }
    }
}
