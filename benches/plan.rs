//! Planning of a chain of blocks: blocks per second on one core, and how much faster a contour is than with a
//! stop after every block. `cargo bench --bench plan` prints them.
//!
//! The contours are 4 m in 20,000 lines of 0.2 mm: a smooth one, whose corners are flat, the same in lines of
//! different lengths, and one with a sharp corner at every twentieth line. Blocks arrive as the interpolator
//! takes them, some in every tick. The time is that of the whole: blends, limits, look-ahead, laws with their
//! check, and the setpoints of every tick.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout, clippy::disallowed_methods)] // measures time

use std::{f64::consts::PI, hint::black_box, time::Instant};

use motion::chain::{Ask, Block, Chain, Corner, Feed, Ratios, Settings};
use motion::{FeedBlock, Limits, Path};

const SEGMENTS: usize = 20_000;
const SEGMENT_MM: f64 = 0.2;
const CYCLE_S: f64 = 0.002;
const AXIS: Limits = Limits { v: 200.0, a: 2000.0, j: 80_000.0, dj: 8e6 };
/// Blocks that can arrive in a tick.
const ARRIVALS: usize = 32;
const FEED_MM_S: f64 = 100.0;
const TOLERANCE_MM: f64 = 0.01;
const ROUNDS: usize = 5;

type Contour = Vec<Block<3, ()>>;
/// From the number of a line: its length in mm, and the angle in radians by which it is turned against the
/// one before.
type Line = fn(usize) -> (f64, f64);

/// Lines one after the other.
fn contour(corner: Corner, line: Line) -> Contour {
    let mut heading: f64 = 0.0;
    let block = |number| {
        let (length, turn) = line(number);
        heading += turn;
        let (s, c) = libm::sincos(heading);
        let path = Path::line([length * c, length * s, 0.0], &[true; 3]).unwrap();
        Block { path, feed: Feed::PerSecond(FEED_MM_S), corner, room: 1.0, chord_mm: 1e-3, tag: () }
    };
    (0..SEGMENTS).map(block).collect()
}

/// Radii from 9 to 60 mm, to the left and to the right.
fn smooth(number: usize) -> (f64, f64) {
    (SEGMENT_MM, SEGMENT_MM * (0.045 + 0.065 * libm::sin(number as f64 / 80.0)))
}

/// The same curve in lines that are not equally long, as a chord tolerance makes them.
fn uneven(number: usize) -> (f64, f64) {
    let length = |number: usize| SEGMENT_MM * (0.8 + 0.4 * (number * 7 % 11) as f64 / 10.0);
    let between = 0.5 * (length(number) + length(number + 10)) / SEGMENT_MM;
    (length(number), between * smooth(number).1)
}

/// The same with a corner of 20 to 120 degrees at every twentieth line.
fn cornered(number: usize) -> (f64, f64) {
    let sharp = if number % 20 == 19 { PI / 9.0 * (1 + number % 6) as f64 } else { 0.0 };
    let (length, turn) = smooth(number);
    (length, turn + if number % 40 == 19 { sharp } else { -sharp })
}

/// A chain, and the contour that it gets over and over again.
struct Job<'a> {
    chain: Chain<3, ()>,
    blocks: std::iter::Cycle<std::slice::Iter<'a, Block<3, ()>>>,
    /// Blocks that have not arrived yet.
    left: usize,
    completed: u64,
}

impl<'a> Job<'a> {
    fn new(contour: &'a Contour, blocks: usize) -> Job<'a> {
        let settings = Settings { axes: [AXIS; 3], cycle_s: CYCLE_S };
        Job { chain: Chain::new(settings), blocks: contour.iter().cycle(), left: blocks, completed: 0 }
    }

    /// Takes the blocks that arrive, and goes on by a cycle; false at the end.
    fn tick(&mut self, ask: &Ask) -> bool {
        for _ in 0..ARRIVALS {
            if self.left > 0 && self.chain.has_room() {
                self.chain.push(*self.blocks.next().unwrap());
                self.left -= 1;
                if self.left == 0 {
                    self.chain.close();
                }
            }
        }
        let step = black_box(self.chain.tick(ask));
        self.completed += step.map_or(0, |step| u64::from(step.completed));
        step.is_some()
    }
}

fn ask() -> Ask {
    Ask { ratios: Ratios::full(0.0), hold: false, single: false, more: true }
}

/// Ticks that the contour takes.
fn ticks(contour: &Contour) -> u64 {
    let mut job = Job::new(contour, contour.len());
    let ticks = (0..).take_while(|_| job.tick(&ask())).count() as u64;
    assert_eq!(job.completed, contour.len() as u64, "every block is made");
    ticks
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn rate(name: &str, contour: &Contour) {
    let mut ticks_made = 0;
    let mut run_s = |_| {
        let begun = Instant::now();
        ticks_made = ticks(contour);
        begun.elapsed().as_secs_f64()
    };
    let run_s = median((0..ROUNDS).map(&mut run_s).collect());
    println!(
        "{name:<10} {:>9.0} blocks per second of computing, {:.0} ns a block with the {:.1} ticks it lasts \
         (median of {ROUNDS} runs)",
        contour.len() as f64 / run_s,
        1e9 * run_s / contour.len() as f64,
        ticks_made as f64 / contour.len() as f64
    );
}

/// Time of motion of the contour, rounded, and with a stop after each block.
fn factor(name: &str, line: Line) {
    let stop = FeedBlock::plan(SEGMENT_MM, 0.0, FEED_MM_S, 0.0, &AXIS).unwrap().duration();
    let [stopped, rounded] = [Corner::Stop, Corner::Blend(TOLERANCE_MM)]
        .map(|corner| ticks(&contour(corner, line)) as f64 * CYCLE_S);
    println!(
        "{name:<10} {rounded:>7.2} s rounded within {TOLERANCE_MM} mm, {stopped:>7.2} s with stops: factor {:.1} \
         (one block from rest to rest along an axis takes {:.2} ms, all at their feed {:.2} s)",
        stopped / rounded,
        stop * 1e3,
        SEGMENTS as f64 * SEGMENT_MM / FEED_MM_S
    );
}

fn main() {
    let contours: [(&str, Line); 3] = [("smooth", smooth), ("uneven", uneven), ("cornered", cornered)];
    println!("{SEGMENTS} lines of {SEGMENT_MM} mm at {FEED_MM_S} mm/s, a tick every {CYCLE_S} s");
    contours.iter().for_each(|&(name, line)| factor(name, line));
    let rounded = contours.map(|(name, line)| (name, contour(Corner::Blend(TOLERANCE_MM), line)));
    rounded.iter().for_each(|(name, contour)| rate(name, contour));
}
