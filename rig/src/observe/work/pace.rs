//! Whether a trace is cut at its feed. In: every control cycle the way of the commanded and of the true
//! point, mm, and the feed that is asked for, mm/s; every tick the shares of limits in use. Out: the time at
//! the feed, and the deviation from it.
//!
//! ```text
//! feed = |p(t) − p(t − T)| / T                          T: control cycle
//! chord error of an interpolator cycle h = |p(t) − 2 p(t − h) + p(t − 2h)| / 8,
//!     its part normal to p(t) − p(t − 2h)
//! ```
//! The feed is *held* where the commanded one lies within [`HELD`] of what is asked for. Where it is lower, a
//! limit must be the reason: of the axes, or the chord error. Lower feed is looked at in windows of
//! [`WINDOW_S`]; one is explained if a limit is used to [`BINDS`] in it or in the window before. Planned
//! bounds hold for several derivatives at once and over a stretch of the path, so a limit that binds is not
//! always used to the full where it binds; and jerk fades out before the feed is reached, which is what the
//! window before is for. A tool that stands is held or waits, which is counted elsewhere; how it came to
//! stand is looked at.

use super::report::FeedReport;

/// Part of the feed within which it is held.
const HELD: f64 = 0.01;
/// Use of a limit that explains a lower feed.
const BINDS: f64 = 0.25;

/// Way of a cycle in which the tool stands still, mm.
const STANDS_MM: f64 = 1e-9;
/// Length of the windows in which a reason is looked for.
const WINDOW_S: f64 = 0.05;

/// A window of lower feed.
#[derive(Clone, Copy, Debug)]
struct Slow {
    cycles: u64,
    /// Largest use of a limit in it, and in the one before.
    used: f64,
    before: f64,
}

/// What is known of the feed of one trace so far.
#[derive(Clone, Debug)]
pub(super) struct Pace {
    cycle_s: f64,
    chord_mm: f64,
    /// Points at the last two ticks, the later first.
    ticks: [Option<[f64; 3]>; 2],
    /// Largest share of a limit at the last tick.
    used: f64,
    slow: Option<Slow>,
    cycles: u64,
    held: u64,
    true_held: u64,
    unexplained: u64,
    most: f64,
    held_true: [f64; 2],
    held_squares: f64,
    chord_max_mm: f64,
    way_mm: f64,
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    core::array::from_fn(|i| a[i] - b[i])
}

fn length(a: [f64; 3]) -> f64 {
    libm::sqrt(a.iter().map(|part| part * part).sum())
}

/// Length of the part of `a` that is normal to `b`.
fn normal(a: [f64; 3], b: [f64; 3]) -> f64 {
    let (dot, square): (f64, f64) =
        (0..3).fold((0.0, 0.0), |(dot, square), i| (dot + a[i] * b[i], square + b[i] * b[i]));
    if square > 0.0 { length(core::array::from_fn(|i| a[i] - dot / square * b[i])) } else { 0.0 }
}

/// Distance of two points.
pub(super) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    length(minus(a, b))
}

impl Pace {
    pub(super) fn new(cycle_s: f64, chord_mm: f64) -> Pace {
        Pace {
            cycle_s,
            chord_mm,
            ticks: [None; 2],
            used: 0.0,
            slow: None,
            cycles: 0,
            held: 0,
            true_held: 0,
            unexplained: 0,
            most: 0.0,
            held_true: [0.0; 2],
            held_squares: 0.0,
            chord_max_mm: 0.0,
            way_mm: 0.0,
        }
    }

    /// At a tick: where the commanded point is, and the largest share of a limit of an axis.
    pub(super) fn tick(&mut self, at: [f64; 3], used: f64) {
        let chord = match self.ticks {
            [Some(one), Some(two)] => normal(minus(minus(at, one), minus(one, two)), minus(at, two)) / 8.0,
            _ => 0.0,
        };
        self.ticks = [Some(at), self.ticks[0]];
        self.chord_max_mm = self.chord_max_mm.max(chord);
        self.used = used.max(chord / self.chord_mm);
        if let Some(slow) = &mut self.slow {
            slow.used = slow.used.max(self.used);
        }
    }

    /// In every cycle: the way since the one before of the commanded and of the true point, and the feed
    /// asked for.
    pub(super) fn cycle(&mut self, commanded_mm: f64, true_mm: f64, feed_mm_s: f64) {
        self.way_mm += commanded_mm;
        let asked = feed_mm_s * self.cycle_s;
        if asked <= 0.0 {
            return;
        }
        self.cycles += 1;
        let (commanded, real) = (commanded_mm / asked - 1.0, true_mm / asked - 1.0);
        self.most = self.most.max(commanded);
        if commanded_mm <= STANDS_MM {
            self.close();
            return;
        }
        if commanded < -HELD {
            let slow = self.slow.get_or_insert(Slow { cycles: 0, used: self.used, before: 0.0 });
            slow.cycles += 1;
            let Slow { cycles, used: before, .. } = *slow;
            if cycles as f64 * self.cycle_s >= WINDOW_S {
                self.close();
                self.slow = Some(Slow { cycles: 0, used: self.used, before });
            }
            return;
        }
        self.close();
        if commanded <= HELD {
            self.held += 1;
            self.true_held += u64::from(real.abs() <= HELD);
            self.held_true = [self.held_true[0].min(real), self.held_true[1].max(real)];
            self.held_squares += real * real;
        }
    }

    /// The tool leaves the part.
    pub(super) fn lift(&mut self) {
        self.close();
        self.ticks = [None; 2];
    }

    fn close(&mut self) {
        if let Some(slow) = self.slow.take()
            && slow.used.max(slow.before) < BINDS
        {
            self.unexplained += slow.cycles;
        }
    }

    pub(super) fn report(mut self, programmed_mm_min: f64) -> (FeedReport, f64) {
        self.close();
        let share = |cycles: u64, of: u64| 100.0 * cycles as f64 / of.max(1) as f64;
        let report = FeedReport {
            programmed_mm_min,
            held_pct: share(self.held, self.cycles),
            true_held_pct: share(self.true_held, self.held),
            most_pct: 100.0 * self.most,
            true_low_pct: 100.0 * self.held_true[0],
            true_high_pct: 100.0 * self.held_true[1],
            true_rms_pct: 100.0 * (self.held_squares / self.held.max(1) as f64).sqrt(),
            unexplained_s: self.unexplained as f64 * self.cycle_s,
            chord_max_um: 1e3 * self.chord_max_mm,
        };
        (report, self.way_mm)
    }
}
