//! A test stand: feeds a chain, watches every cycle.

use motion::chain::{Ask, Block, Chain, Ratios, Settings};
use motion::{Limits, Sample};

use crate::programs::N;

pub(crate) const CYCLE_S: f64 = 0.002;
pub(crate) const AXES: [Limits; N] = [
    Limits { v: 150.0, a: 2000.0, j: 80_000.0, dj: 8.0e6 },
    Limits { v: 200.0, a: 1500.0, j: 60_000.0, dj: 4.0e6 },
    Limits { v: 80.0, a: 1000.0, j: 50_000.0, dj: 9.0e6 },
];

pub(crate) fn ask() -> Ask {
    Ask { ratios: Ratios::full(10.0), hold: false, single: false, more: true }
}

pub(crate) struct Stand<'a> {
    chain: Chain<N, [f64; N]>,
    blocks: &'a [Block<N, [f64; N]>],
    pushed: usize,
    completed: u32,
    ticks: u64,
    /// Blocks that arrive in a cycle.
    pub(crate) pace: u32,
    pub(crate) last: Option<[Sample; N]>,
}

impl<'a> Stand<'a> {
    pub(crate) fn new(blocks: &'a [Block<N, [f64; N]>]) -> Stand<'a> {
        let settings = Settings { axes: AXES, cycle_s: CYCLE_S, chord_mm: 1e-3 };
        Stand { chain: Chain::new(settings), blocks, pushed: 0, completed: 0, ticks: 0, pace: 32, last: None }
    }

    pub(crate) fn ticks(&self) -> u64 {
        self.ticks
    }

    /// One cycle; false at the end.
    pub(crate) fn tick(&mut self, ask: &Ask) -> bool {
        for _ in 0..self.pace {
            if self.pushed < self.blocks.len() && self.chain.has_room() {
                self.chain.push(self.blocks[self.pushed]);
                self.pushed += 1;
                if self.pushed == self.blocks.len() {
                    self.chain.close();
                }
            }
        }
        let Some(step) = self.chain.tick(ask) else { return false };
        self.ticks += 1;
        self.completed += step.completed;
        assert!(!step.rejected && !step.starved, "{} at tick {}", step.rejected, self.ticks);
        let axes: [Sample; N] =
            std::array::from_fn(|i| Sample { s: step.tag[i] + step.axes[i].s, ..step.axes[i] });
        for (i, (axis, limits)) in axes.iter().zip(&AXES).enumerate() {
            for (got, most) in
                [(axis.v, limits.v), (axis.a, limits.a), (axis.j, limits.j), (axis.dj, limits.dj)]
            {
                assert!(
                    got.abs() <= most * (1.0 + 1e-6),
                    "axis {i} {got} over {most} at {}: {axes:?} {step:?}",
                    self.ticks
                );
            }
        }
        if let Some(last) = self.last {
            for (i, (a, b)) in last.iter().zip(&axes).enumerate() {
                // Trapezoid with its correction by the accelerations: what is left is of the order of the jerk rate.
                let h = CYCLE_S;
                let way = 0.5 * h * (a.v + b.v) + h * h / 12.0 * (a.a - b.a);
                assert!(
                    (b.s - a.s - way).abs() < 1e-6,
                    "axis {i} jumps by {} at {} {:?}",
                    b.s - a.s - way,
                    self.ticks,
                    step
                );
            }
        }
        self.last = Some(axes);
        true
    }

    pub(crate) fn ends(&self, seed: u64) {
        let last = self.blocks.last().expect("a block");
        let end = last.path.at(last.path.length())[0];
        let got = self.last.expect("a tick");
        for i in 0..N {
            assert!(
                (got[i].s - last.tag[i] - end[i]).abs() < 1e-9,
                "program {seed}: axis {i} ends at {}",
                got[i].s
            );
            assert_eq!((got[i].v, got[i].a), (0.0, 0.0), "program {seed}");
        }
        assert_eq!(self.completed as usize, self.blocks.len(), "program {seed}");
    }
}
