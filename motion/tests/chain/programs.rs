//! Random programs: lines short and long, corners sharp and flat, arcs and helices, curves in pieces, feeds
//! of every kind, every path mode, little room beside the path.

use crate::curve::Curve;
use motion::Path;
use motion::chain::{Block, Corner, Feed};
use testing::Seed;

pub(crate) const N: usize = 3;
pub(crate) const CHORD_MM: f64 = 1e-3;

/// Where a block is in its program.
#[derive(Default, Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    pub(crate) number: usize,
    /// Its start point, mm.
    pub(crate) start: [f64; N],
}

pub(crate) type Line = Block<N, Place>;

/// What the blocks of a program are drawn from.
struct Kind {
    shortest: f64,
    longest: f64,
    bent: f64,
    arcs: f64,
    curves: f64,
    tolerance: f64,
    /// A curve in steps that are alike but for this share.
    alike: Option<f64>,
    /// A curve in steps so much longer than the shortest, at most: blends reach over many corners.
    fine: Option<f64>,
}

/// A random program.
pub(crate) fn program(random: &mut Seed) -> Vec<Line> {
    let count = 1 + (random.next() % 60) as usize;
    let kind = Kind {
        shortest: random.scale(1e-3, 1.0),
        longest: random.scale(1.0, 50.0),
        bent: random.scale(0.01, 3.0),
        arcs: if random.chance(0.3) { 0.0 } else { random.between(0.0, 0.6) },
        curves: if random.chance(0.5) { 0.0 } else { random.between(0.0, 0.3) },
        tolerance: random.scale(1e-3, 0.5),
        alike: random.chance(0.2).then(|| random.scale(1e-10, 1e-2)),
        fine: random.chance(0.2).then(|| random.scale(1.0, 10.0)),
    };
    let (mut corner, mut feed) = (corner(random, &kind), feed(random, None));
    let mut at = [0.0; N];
    let mut heading = random.between(0.0, std::f64::consts::TAU);
    let mut blocks: Vec<Line> = Vec::new();
    while blocks.len() < count {
        if random.chance(0.03) {
            (corner, feed) = (self::corner(random, &kind), self::feed(random, None));
        } else if random.chance(0.2) {
            feed = self::feed(random, Some(feed));
        }
        // A fine curve has a corner now and then, and bends to one side for the most part.
        heading += match kind.fine {
            Some(_) if random.chance(0.95) => 0.1 * random.between(-kind.bent, 2.0 * kind.bent).min(1.0),
            _ => random.between(-kind.bent, kind.bent),
        };
        let paths = if random.chance(kind.curves) {
            curve(random, &mut heading)
        } else if random.chance(kind.arcs) {
            arc(random, &mut heading).into_iter().collect()
        } else {
            let length = match (kind.alike, kind.fine) {
                (Some(share), _) => kind.shortest * (1.0 + random.between(-share, share)),
                (None, Some(most)) => kind.shortest * random.between(1.0, most),
                (None, None) => random.scale(kind.shortest, kind.longest),
            };
            let (sin, cos) = libm::sincos(heading);
            let way = [length * cos, length * sin, random.between(-0.1, 0.1) * length];
            Path::line(way, &[true; N]).into_iter().collect::<Vec<Path<N>>>()
        };
        for path in paths {
            let room = if random.chance(0.8) { 1.0 } else { random.scale(1e-5, 1e-2) };
            let place = Place { number: blocks.len(), start: at };
            blocks.push(Block { path, feed, corner, room, chord_mm: CHORD_MM, tag: place });
            let end = end_of(&path);
            at = std::array::from_fn(|i| at[i] + end[i]);
        }
    }
    blocks
}

/// End of a path from its start.
pub(crate) fn end_of(path: &Path<N>) -> [f64; N] {
    path.at(path.length())[0]
}

/// A program of lines through points, one feed and path mode.
pub(crate) fn through(points: &[[f64; N]], feed: Feed, corner: Corner) -> Vec<Line> {
    let mut blocks = Vec::new();
    for (number, pair) in points.windows(2).enumerate() {
        let way = std::array::from_fn(|i| pair[1][i] - pair[0][i]);
        let path = Path::line(way, &[true; N]).expect("two points");
        blocks.push(Block {
            path,
            feed,
            corner,
            room: 1.0,
            chord_mm: CHORD_MM,
            tag: Place { number, start: pair[0] },
        });
    }
    blocks
}

fn corner(random: &mut Seed, kind: &Kind) -> Corner {
    match random.next() % 6 {
        0 => Corner::Stop,
        1 => Corner::Exact(random.scale(1e-5, 1e-2)),
        2 => Corner::Curve {
            corner: kind.tolerance,
            flat: kind.tolerance * random.between(1.0, 3.0),
            tip: kind.tolerance * random.scale(0.1, 10.0),
        },
        _ => Corner::Blend(kind.tolerance),
    }
}

/// Another feed, of the kind of `last` if there is one.
fn feed(random: &mut Seed, last: Option<Feed>) -> Feed {
    let feed = random.scale(5.0, 500.0);
    let kinds = [Feed::Rapid, Feed::PerSecond(feed), Feed::PerRevolution(feed / 60.0, 2.0 * feed)];
    match last {
        None => kinds[(random.next() % 3) as usize],
        Some(Feed::Rapid) => kinds[0],
        Some(Feed::PerSecond(_)) => kinds[1],
        Some(Feed::PerRevolution(..)) => kinds[2],
    }
}

/// An arc that leaves along the heading, or a helix.
fn arc(random: &mut Seed, heading: &mut f64) -> Option<Path<N>> {
    let (radius, sweep) = (random.scale(0.05, 50.0), random.between(0.05, 6.0));
    let side: f64 = if random.chance(0.5) { 1.0 } else { -1.0 };
    let (sin, cos) = libm::sincos(*heading);
    let start = [radius * side * sin, -radius * side * cos];
    let (sin, cos) = libm::sincos(side * sweep);
    // Ends that were rounded have not quite one radius.
    let rounded = 1.0 + if random.chance(0.5) { random.between(-1e-4, 1e-4) } else { 0.0 };
    let end = [rounded * (start[0] * cos - start[1] * sin), rounded * (start[0] * sin + start[1] * cos)];
    *heading += side * sweep;
    let drift = if random.chance(0.3) { random.between(-5.0, 5.0) } else { 0.0 };
    Path::arc([0, 1], start, end, side as i32, [0.0, 0.0, drift], &[true; N])
}

/// A curve that leaves along the heading, in pieces that are not equally long.
fn curve(random: &mut Seed, heading: &mut f64) -> Vec<Path<N>> {
    let radius = random.scale(0.05, 50.0);
    let curve = Curve::random(random, *heading, radius);
    let (mut from, mut pieces) = (0.0, Vec::new());
    for _ in 0..1 + random.next() % 12 {
        let to = from + radius * random.between(0.05, 0.4);
        pieces.push(curve.piece(from, to));
        from = to;
    }
    *heading = curve.heading(from);
    pieces
}
