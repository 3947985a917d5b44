//! How far the slides are from contours in the time that an earlier pitchlock took for them. In: contours,
//! the machine. Out: a row each. `FOLLOWED=10 cargo bench --bench contours` runs each with ten seeds.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | c, v | mm, mm/s | commanded position and speed |
//! | p | mm | true position of the slides |
//!
//! ```text
//! e = p − c,   contour error = |e − (e·v) v/v²|          what a run says of the motors, here of the slides
//! ```
//! Faster motion errs more, so it is slowed down until the time that is foretold is that of before, in either
//! of two ways: by the feed alone, so that straights are slower and bends are not; or all of it alike, as a
//! machine with lower limits would: speed by x, acceleration by x², jerk by x³, its rate by x⁴.

use machine::Machine;
use protocol::Axis;
use rig::{Rig, observe::Record};
use sim_plant::Scenario;

use super::{FEED_MM_MIN, Point, less, norm, program, time};

/// What commit 015c7cf4 did at 6 m/min, before anything was done about contours in lines: seconds foretold,
/// and of ten seeds the largest contour error, its rms, how far the slides were from the lines at most, µm.
const BEFORE: [[f64; 4]; 13] = [
    [9.83, 2.89, 1.22, 8.94],
    [4.00, 4.55, 1.93, 4.44],
    [4.01, 4.55, 1.93, 4.47],
    [4.02, 4.55, 1.93, 4.68],
    [6.95, 3.55, 1.31, 7.63],
    [8.38, 3.27, 1.28, 4.54],
    [8.41, 3.27, 1.28, 4.55],
    [20.03, 2.79, 1.13, 7.71],
    [25.39, 2.82, 1.18, 7.40],
    [36.62, 2.53, 1.10, 3.75],
    [15.23, 2.57, 1.43, 8.41],
    [15.32, 3.58, 1.20, 8.21],
    [42.31, 2.71, 1.15, 8.29],
];

/// Slower than this is standing, mm/s.
const STANDS_MM_S: f64 = 1e-3;
/// How far along the lines the nearest place may be from that of the cycle before, mm.
const WINDOW_MM: f64 = 0.5;
/// Times are the same within this share.
const SAME: f64 = 0.002;

/// What was seen of some runs.
#[derive(Default)]
struct Seen {
    max_mm: f64,
    squares: f64,
    cycles: u64,
    off_mm: f64,
}

/// Where the nearest place of the lines was last.
struct Nearest<'a> {
    points: &'a [Point],
    line: usize,
}

impl Nearest<'_> {
    /// How far a place is from the lines, near the place before, mm.
    fn off(&mut self, at: &Point) -> f64 {
        let distance = |line: usize| {
            let [from, to] = [self.points[line], self.points[line + 1]];
            let (way, seen) = (less(&to, &from), less(at, &from));
            let dot = |a: &Point, b: &Point| (0..3).map(|i| a[i] * b[i]).sum::<f64>();
            let share = (dot(&seen, &way) / dot(&way, &way)).clamp(0.0, 1.0);
            norm(&std::array::from_fn(|i| seen[i] - share * way[i]))
        };
        let mut best = (distance(self.line), self.line);
        for ahead in [true, false] {
            let (mut line, mut way) = (self.line, 0.0);
            while way < WINDOW_MM {
                way += norm(&less(&self.points[line + 1], &self.points[line]));
                let next = if ahead { line + 1 } else { line.wrapping_sub(1) };
                if next >= self.points.len() - 1 {
                    break;
                }
                line = next;
                let off = distance(line);
                if off < best.0 {
                    best = (off, line);
                }
            }
        }
        self.line = best.1;
        best.0
    }
}

/// Lines of the program before the first one of the contour.
const HEAD: u32 = 2;

impl Seen {
    fn cycle(&mut self, record: &Record, nearest: &mut Nearest) {
        let axes = [Axis::X, Axis::Y, Axis::Z].map(|axis| {
            let (_, status) = record.axes.iter().find(|(other, _)| *other == axis).unwrap();
            let slide = record.truth.axes[axis.index()].slide_mm;
            (slide, slide - status.commanded_mm, status.velocity_mm_s)
        });
        let sum = |of: fn(&(f64, f64, f64)) -> f64| axes.iter().map(of).sum::<f64>();
        let (error, along, speed) = (sum(|a| a.1 * a.1), sum(|a| a.1 * a.2), sum(|a| a.2 * a.2));
        if record.axes[0].1.line <= HEAD || speed <= STANDS_MM_S * STANDS_MM_S {
            return;
        }
        let error = (error - along * along / speed).max(0.0);
        self.max_mm = self.max_mm.max(error.sqrt());
        (self.squares, self.cycles) = (self.squares + error, self.cycles + 1);
        self.off_mm = self.off_mm.max(nearest.off(&axes.map(|axis| axis.0)));
    }
}

/// How a contour is slowed down to a share of its speed.
#[derive(Clone, Copy)]
enum Slowed {
    /// By the programmed feed.
    Feed,
    /// By the feed and all limits of the machine.
    All,
}

impl Slowed {
    /// The machine, and the feed, mm/min.
    fn to(self, share: f64, machine: &Machine) -> (Machine, f64) {
        let mut machine = machine.clone();
        if let Slowed::All = self {
            machine.axis.values_mut().for_each(|axis| {
                axis.velocity_mm_s *= share;
                axis.acceleration_mm_s2 *= share.powi(2);
                axis.jerk_mm_s3 *= share.powi(3);
                axis.jerk_rate_mm_s4 *= share.powi(4);
            });
        }
        (machine, share * FEED_MM_MIN)
    }

    /// The share at which points take so long, and how long they take; all of it where they take as long then
    /// or longer.
    fn share_of(self, points: &[Point], seconds: f64, machine: &Machine) -> (f64, f64) {
        let (mut low, mut high, mut share) = (0.02, 1.0, 1.0_f64);
        loop {
            let (slowed, feed) = self.to(share, machine);
            let takes = time(&slowed, points, "P0.01", 5, feed);
            let same = (takes / seconds - 1.0).abs() < SAME;
            if same || high / low < 1.0 + 1e-5 || share == 1.0 && takes > seconds {
                return (share, takes);
            }
            *if takes < seconds { &mut high } else { &mut low } = share;
            share = (low * high).sqrt();
        }
    }
}

/// Runs points at a feed with as many seeds.
fn seen(points: &[Point], feed_mm_min: f64, machine: &Machine, seeds: u64) -> Seen {
    let check = interpreter::check("contour.ngc", &program(points, "P0.01", 5, feed_mm_min), machine);
    let mut seen = Seen::default();
    for seed in 1..=seeds {
        let mut rig = Rig::new(machine, check.items.iter().copied(), Scenario::default(), seed).unwrap();
        let mut nearest = Nearest { points, line: 0 };
        while rig.cycle(None, |record| seen.cycle(record, &mut nearest)) {}
    }
    seen
}

/// A controller that is told the modes of its slides (M131), which this mill takes to be rigid.
fn told(machine: &Machine) -> Machine {
    let mut machine = machine.clone();
    for (axis, config) in &mut machine.axis {
        config.mode_hz = machine.plant["axis"][&format!("{axis:?}").to_lowercase()]["mode_hz"].as_float();
    }
    machine
}

/// Prints for each contour what is now beside what was before.
pub(crate) fn beside(seeds: u64, contours: &[(&str, Vec<Point>)], machine: &Machine) {
    println!(
        "{:<20} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8}",
        "contour", "F", "s", "max, um", "rms, um", "off, um", "moved, s"
    );
    let told = told(machine);
    let ways =
        [("by feed", Slowed::Feed, machine), ("all", Slowed::All, machine), ("told", Slowed::Feed, &told)];
    for ((name, points), [s, max, rms, off]) in contours.iter().zip(BEFORE) {
        println!("{name:<20} {:>8} {s:>8.2} {max:>8.2} {rms:>8.2} {off:>8.2}", "before");
        for (what, slowed, machine) in ways {
            let (share, s) = slowed.share_of(points, s, machine);
            let (slowed, feed) = slowed.to(share, machine);
            let seen = seen(points, feed, &slowed, seeds);
            let moved_s = seen.cycles as f64 * machine.general.cycle_s / seeds as f64;
            let [max, off] = [seen.max_mm, seen.off_mm].map(|mm| 1e3 * mm);
            let rms = 1e3 * (seen.squares / seen.cycles as f64).sqrt();
            println!("  {what:<18} {feed:>8.0} {s:>8.2} {max:>8.2} {rms:>8.2} {off:>8.2} {moved_s:>8.2}");
        }
    }
}
