//! Random programs: lines short and long, corners sharp and flat, arcs, feeds of every kind, every path mode.

use motion::Path;
use motion::chain::{Block, Corner, Feed};

pub(crate) const N: usize = 3;

/// A small generator of numbers that are the same everywhere (splitmix64).
pub(crate) struct Seed(u64);

impl Seed {
    pub(crate) fn new(seed: u64) -> Seed {
        Seed(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5851_f42d_4c95_7f2d)
    }

    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// 0 ≤ … < 1.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// From low to high, evenly in the logarithm.
    pub(crate) fn scale(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.unit())
    }

    pub(crate) fn chance(&mut self, p: f64) -> bool {
        self.unit() < p
    }
}

/// A program of one kind of feed, with the start point of every block in its tag.
pub(crate) fn program(random: &mut Seed) -> Vec<Block<N, [f64; N]>> {
    let count = 1 + (random.next() % 60) as usize;
    let corner = match random.next() % 4 {
        0 => Corner::Stop,
        1 => Corner::Exact(5e-4),
        _ => Corner::Blend(random.scale(1e-3, 0.5)),
    };
    let kind = random.next() % 3;
    let (short, long) = (random.scale(1e-3, 1.0), random.scale(0.1, 50.0));
    let bent = random.scale(0.01, 3.0);
    let mut at = [0.0; N];
    let mut heading = random.between(0.0, 6.28);
    let mut blocks = Vec::new();
    while blocks.len() < count {
        let feed = random.scale(1.0, 500.0);
        let feed = match kind {
            0 => Feed::Rapid,
            1 => Feed::PerSecond(feed),
            _ => Feed::PerRevolution(feed / 60.0, 2.0 * feed),
        };
        let feed = blocks
            .last()
            .map_or(feed, |last: &Block<N, _>| if random.chance(0.8) { last.feed } else { feed });
        heading += random.between(-bent, bent);
        let length = random.scale(short.min(long), long.max(short));
        let line = [length * heading.cos(), length * heading.sin(), random.between(-0.1, 0.1) * length];
        let path = if random.chance(0.7) {
            Path::line(line, &[true; N])
        } else {
            // An arc that leaves along the heading.
            let (radius, sweep) = (random.scale(0.05, 50.0), random.between(0.05, 6.0));
            let side: f64 = if random.chance(0.5) { 1.0 } else { -1.0 };
            let start = [radius * side * heading.sin(), -radius * side * heading.cos()];
            let angle = side * sweep;
            let end = [
                start[0] * angle.cos() - start[1] * angle.sin(),
                start[0] * angle.sin() + start[1] * angle.cos(),
            ];
            heading += angle;
            let drift = if random.chance(0.3) { random.between(-5.0, 5.0) } else { 0.0 };
            Path::arc([0, 1], start, end, side as i32, [0.0, 0.0, drift], &[true; N])
        };
        let Some(path) = path else { continue };
        let end = path.at(path.length())[0];
        blocks.push(Block { path, feed, corner, room: 1.0, tag: at });
        at = std::array::from_fn(|i| at[i] + end[i]);
    }
    blocks
}
