//! One move along a line or an arc, from rest to rest on the sin²-jerk feed profile (M16–M23), within V, A, J and
//! dJ/dt of every axis (M55–M58).
//!
//! Lengths in mm, times in s, feeds in mm/s along the path. The plan is stretched by a fraction of an interpolator
//! cycle so that it ends on a setpoint.

use motion::{FeedBlock, Limits, Path, Sample};
use protocol::{Arc, Axis, Cycle, Machine, PerAxis, Position, Refused, Setpoint, units::AXES};

use crate::pace::{PLAN_SHARE, Pace, Step};

/// Slowest feed, mm/s: a millimetre in a quarter of an hour.
const LEAST_FEED: f64 = 1e-3;

/// A planned move.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    from: PerAxis<Position>,
    to: PerAxis<Position>,
    path: Path<AXES>,
    limits: Limits,
    profile: FeedBlock,
    stretch: f64,
    tau: f64,
    pace: Pace,
    top_ratio: f64,
    done: bool,
}

impl Block {
    /// Plans a move along a line; `None` if it has no length. `feed` in mm/s (infinite for a rapid), `ratio` is the
    /// pace it starts with, 0 to 1.
    pub fn line(
        machine: &Machine,
        from: &PerAxis<Position>,
        to: &PerAxis<Position>,
        feed: f64,
        ratio: f64,
    ) -> Option<Block> {
        let mut displacement = [0.0; AXES];
        for (axis, _) in machine.axes() {
            displacement[axis.index()] = to[axis.index()].mm_from(from[axis.index()]);
        }
        Path::line(displacement, &Axis::METRIC).map(|path| Block::plan(machine, from, to, path, feed, ratio))
    }

    /// Plans a move along an arc; the rest as [`Block::line`].
    ///
    /// # Errors
    /// As [`Arc::path`].
    pub fn arc(
        machine: &Machine,
        from: &PerAxis<Position>,
        arc: &Arc,
        feed: f64,
        ratio: f64,
    ) -> Result<Block, Refused> {
        Ok(Block::plan(machine, from, &arc.target, arc.path(from)?, feed, ratio))
    }

    fn plan(
        machine: &Machine,
        from: &PerAxis<Position>,
        to: &PerAxis<Position>,
        path: Path<AXES>,
        feed: f64,
        ratio: f64,
    ) -> Block {
        let limits = path.limits(&machine.limits());
        let share = Limits {
            v: limits.v,
            a: limits.a * PLAN_SHARE,
            j: limits.j * PLAN_SHARE,
            dj: limits.dj * PLAN_SHARE,
        };
        let profile = FeedBlock::plan(path.length(), 0.0, feed.max(LEAST_FEED).min(limits.v), 0.0, &share)
            .expect("from rest to rest there is a plan for every length (M23)");
        let tick = machine.machine.interpolator_cycle_s;
        let ticks = (profile.duration() / tick).ceil().max(1.0);
        Block {
            from: *from,
            to: *to,
            path,
            limits,
            profile,
            stretch: profile.duration() / (ticks * tick),
            tau: 0.0,
            pace: Pace::constant(ratio),
            top_ratio: share.top_ratio(&profile.peak()),
            done: false,
        }
    }

    /// The next setpoint of every axis, true at `cycle`. The first is the start.
    pub fn setpoints(&self, cycle: Cycle, step: &Step) -> PerAxis<Setpoint> {
        let along = if self.done { Sample::default() } else { self.profile.at(self.tau) };
        let along = along.driven(step.ratio * self.stretch, step.ratio_rate * self.stretch);
        let axes = self.path.follow(&along);
        std::array::from_fn(|axis| Setpoint {
            cycle,
            position: if self.done { self.to[axis] } else { self.from[axis].moved(axes[axis].s) },
            velocity_mm_s: axes[axis].v,
            acceleration_mm_s2: axes[axis].a,
        })
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
        let axes = self.path.follow(&Sample::uniform(self.profile.at(self.tau).s, 0.0));
        std::array::from_fn(|axis| self.from[axis].moved(axes[axis].s))
    }
}
