//! One straight move, from rest to rest on the sin²-jerk feed profile (M16–M23), within V, A, J and dJ/dt of every
//! axis.
//!
//! Lengths in mm, times in s, feeds in mm/s along the path. The plan is stretched by a fraction of an interpolator
//! cycle so that it ends on a setpoint.

use motion::{FeedBlock, Limits, Sample};
use protocol::{Cycle, Machine, PerAxis, Position, Setpoint, units::AXES};

use crate::pace::{PLAN_SHARE, Pace, Step};

/// Slowest feed, mm/s: a millimetre in a quarter of an hour.
const LEAST_FEED: f64 = 1e-3;

/// A planned move.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    from: PerAxis<Position>,
    to: PerAxis<Position>,
    direction: PerAxis<f64>,
    limits: Limits,
    profile: FeedBlock,
    stretch: f64,
    tau: f64,
    pace: Pace,
    top_ratio: f64,
    done: bool,
}

/// The limits of the axes as the path direction sees them: the tightest component rules.
pub fn path_limits(machine: &Machine, direction: &PerAxis<f64>) -> Limits {
    let none = f64::INFINITY;
    let mut path = Limits { v: none, a: none, j: none, dj: none };
    for (axis, config) in machine.axes() {
        let share = direction[axis.index()].abs();
        if share > 0.0 {
            path.v = path.v.min(config.velocity_mm_s / share);
            path.a = path.a.min(config.acceleration_mm_s2 / share);
            path.j = path.j.min(config.jerk_mm_s3 / share);
            path.dj = path.dj.min(config.jerk_rate_mm_s4 / share);
        }
    }
    path
}

impl Block {
    /// Plans a move; `None` if it has no length. `feed` in mm/s (infinite for a rapid), `ratio` is the pace it starts
    /// with, 0 to 1.
    pub fn plan(
        machine: &Machine,
        from: &PerAxis<Position>,
        to: &PerAxis<Position>,
        feed: f64,
        ratio: f64,
    ) -> Option<Block> {
        let mut direction = [0.0; AXES];
        for (axis, _) in machine.axes() {
            direction[axis.index()] = to[axis.index()].mm_from(from[axis.index()]);
        }
        let length = direction.iter().map(|d| d * d).sum::<f64>().sqrt();
        if length == 0.0 {
            return None;
        }
        direction.iter_mut().for_each(|d| *d /= length);
        let limits = path_limits(machine, &direction);
        let share = Limits {
            v: limits.v,
            a: limits.a * PLAN_SHARE,
            j: limits.j * PLAN_SHARE,
            dj: limits.dj * PLAN_SHARE,
        };
        let profile = FeedBlock::plan(length, 0.0, feed.clamp(LEAST_FEED, limits.v), 0.0, &share)
            .expect("from rest to rest there is a plan for every length (M23)");
        let tick = machine.machine.interpolator_cycle_s;
        let ticks = (profile.duration() / tick).ceil().max(1.0);
        Some(Block {
            from: *from,
            to: *to,
            direction,
            limits,
            profile,
            stretch: profile.duration() / (ticks * tick),
            tau: 0.0,
            pace: Pace::constant(ratio),
            top_ratio: share.top_ratio(&profile.peak()),
            done: false,
        })
    }

    /// The next setpoint of every axis, true at `cycle`. The first is the start.
    pub fn setpoints(&self, cycle: Cycle, step: &Step) -> PerAxis<Setpoint> {
        let along = if self.done { Sample::default() } else { self.profile.at(self.tau) };
        let along = along.driven(step.ratio * self.stretch, step.ratio_rate * self.stretch);
        std::array::from_fn(|axis| Setpoint {
            cycle,
            position: if self.done { self.to[axis] } else { self.position(axis, along.s) },
            velocity_mm_s: along.v * self.direction[axis],
            acceleration_mm_s2: along.a * self.direction[axis],
        })
    }

    fn position(&self, axis: usize, s: f64) -> Position {
        Position(self.from[axis].0 + Position::from_mm(self.direction[axis] * s).0)
    }

    /// Goes on by one interpolator cycle towards the pace asked for (a multiple of the planned feed). Returns the step
    /// and whether the ratio had to be clamped to what the limits allow.
    pub fn advance(&mut self, tick_s: f64, ratio: f64) -> (Step, bool) {
        let clamped = ratio > self.top_ratio;
        self.pace.turn_to(ratio.min(self.top_ratio), &self.profile.peak(), &self.limits);
        let step = self.pace.advance(tick_s);
        self.tau += step.tau * self.stretch;
        self.done = self.tau >= self.profile.duration() * (1.0 - 1e-12);
        (step, clamped)
    }

    /// Whether the end is reached.
    pub fn done(&self) -> bool {
        self.done
    }

    /// Whether the move stands on its path because the pace is zero.
    pub fn holds(&self) -> bool {
        self.pace.holds()
    }

    /// Where the axes are.
    pub fn here(&self) -> PerAxis<Position> {
        if self.done {
            return self.to;
        }
        let s = self.profile.at(self.tau).s;
        std::array::from_fn(|axis| self.position(axis, s))
    }
}
