//! Random moves, and the planner they are compared with: rsruckig, a port of Ruckig, which plans the fastest
//! motion with rectangular jerk. In: a seed. Out: blocks in m and s, and the time rsruckig gives them.
#![allow(dead_code, clippy::unwrap_used, missing_docs, unreachable_pub)] // the bench and the test each use their part

use motion::{FeedBlock, Limits};
use rsruckig::prelude::{InputParameter, Ruckig, ThrowErrorHandler, Trajectory};
use testing::Seed;

/// What a block is asked to do.
#[derive(Clone, Copy, Debug)]
pub struct Asked {
    pub length: f64,
    pub f0: f64,
    pub f: f64,
    pub f_end: f64,
    pub limits: Limits,
}

impl Asked {
    /// A move from rest to rest, or with feeds at its start and end, of any length and with the limits of
    /// machines of any size. `dj` is the limit of the jerk rate, which the peer does not know.
    pub fn draw(draw: &mut Seed, at_rest: bool, dj: f64) -> Asked {
        let f = draw.scale(0.02, 2.0);
        let mut feed = || if at_rest { 0.0 } else { f * draw.unit() };
        let (f0, f_end) = (feed(), feed());
        let limits = Limits { v: f, a: draw.scale(0.2, 20.0), j: draw.scale(2.0, 500.0), dj };
        Asked { length: draw.scale(1e-4, 1.0), f0, f, f_end, limits }
    }

    /// Our plan; `None` if the block is too short to join its feeds.
    pub fn plan(&self) -> Option<FeedBlock> {
        FeedBlock::plan(self.length, self.f0, self.f, self.f_end, &self.limits).ok()
    }

    /// The same for the peer, with a share of the jerk limit.
    pub fn input(&self, share_of_jerk: f64) -> InputParameter<1> {
        let mut input = InputParameter::new(None);
        input.target_position[0] = self.length;
        (input.current_velocity[0], input.target_velocity[0]) = (self.f0, self.f_end);
        input.max_velocity[0] = self.f;
        input.max_acceleration[0] = self.limits.a;
        input.max_jerk[0] = share_of_jerk * self.limits.j;
        input
    }
}

/// So many blocks that can be planned.
pub fn blocks(seed: u64, count: usize, at_rest: bool, dj: f64) -> Vec<Asked> {
    let mut draw = Seed::new(seed);
    let drawn = std::iter::repeat_with(|| Asked::draw(&mut draw, at_rest, dj));
    drawn.filter(|asked| asked.plan().is_some()).take(count).collect()
}

/// rsruckig for one axis, with the trajectory it fills.
pub struct Peer(Ruckig<1, ThrowErrorHandler>, Trajectory<1>);

impl Peer {
    pub fn new() -> Peer {
        Peer(Ruckig::new(None, 0.001), Trajectory::new(None))
    }

    /// Time of the motion, s; `None` if rsruckig finds no solution.
    pub fn time(&mut self, input: &InputParameter<1>) -> Option<f64> {
        self.0.calculate(input, &mut self.1).ok().map(|_| self.1.get_duration())
    }
}
