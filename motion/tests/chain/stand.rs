//! A test stand: feeds a chain and watches every cycle.
//!
//! Between two cycles h apart every derivative has to be the integral of the next one. What the trapezium
//! with its correction by the end slopes leaves of an integral is bounded by the jerk rate D (Peano):
//!
//! ```text
//! Δs − h/2 Σv + h²/12 Δa ≤ D h⁴/192,   Δv − h/2 Σa + h²/12 Δj ≤ √3/54 D h³,  Δa − h/2 Σj ≤ D h²/4,  Δj ≤ D h
//! ```

use crate::programs::{Line, N, Place, end_of};
use motion::chain::{Ask, Chain, Ratios, Settings, Step};
use motion::{Limits, Sample};

pub(crate) const CYCLE_S: f64 = 0.002;
pub(crate) const AXES: [Limits; N] = [
    Limits { v: 150.0, a: 2000.0, j: 80_000.0, dj: 8.0e6 },
    Limits { v: 200.0, a: 1500.0, j: 60_000.0, dj: 4.0e6 },
    Limits { v: 80.0, a: 1000.0, j: 50_000.0, dj: 9.0e6 },
];
/// Of ways in mm and speeds in mm/s.
const ROUNDING: f64 = 1e-12;
/// Cycles after which a program that has not ended never will.
const MOST_TICKS: u64 = 3_000_000;

pub(crate) fn ask() -> Ask {
    Ask { ratios: Ratios::full(10.0), hold: false, single: false, more: true }
}

/// What the chain did in a cycle, and where that is in the program.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    pub(crate) step: Step<N, Place>,
    /// The axes in the coordinates of the program.
    pub(crate) axes: [Sample; N],
}

#[derive(Clone)]
pub(crate) struct Stand<'a> {
    chain: Chain<N, Place>,
    blocks: &'a [Line],
    pushed: usize,
    completed: u32,
    ticks: u64,
    starved: u32,
    axes: [Limits; N],
    cycle_s: f64,
    /// Blocks that arrive at a time,
    pub(crate) pace: usize,
    /// and cycles from one time to the next.
    pub(crate) every: u64,
    pub(crate) last: Option<Seen>,
}

impl<'a> Stand<'a> {
    pub(crate) fn new(blocks: &'a [Line]) -> Stand<'a> {
        Stand::of(blocks, AXES, CYCLE_S)
    }

    /// A machine with other limits and another cycle.
    pub(crate) fn of(blocks: &'a [Line], axes: [Limits; N], cycle_s: f64) -> Stand<'a> {
        let chain = Chain::new(Settings { axes, cycle_s });
        Stand {
            chain,
            blocks,
            pushed: 0,
            completed: 0,
            ticks: 0,
            starved: 0,
            axes,
            cycle_s,
            pace: 2000,
            every: 1,
            last: None,
        }
    }

    pub(crate) fn ticks(&self) -> u64 {
        self.ticks
    }

    /// How often it ran out of blocks.
    pub(crate) fn starved(&self) -> u32 {
        self.starved
    }

    /// Speed along the path, mm/s.
    pub(crate) fn speed(&self) -> f64 {
        self.last.map_or(0.0, |seen| seen.step.along.v)
    }

    /// One cycle; false at the end.
    pub(crate) fn tick(&mut self, ask: &Ask) -> bool {
        let arrive = if self.ticks.is_multiple_of(self.every) { self.pace } else { 0 };
        for _ in 0..arrive {
            if self.pushed < self.blocks.len() && self.chain.has_room() {
                self.chain.push(self.blocks[self.pushed]);
                self.pushed += 1;
                if self.pushed == self.blocks.len() {
                    self.chain.close();
                }
            }
        }
        let step = self.chain.tick(ask);
        if step.is_none() && self.pushed == self.blocks.len() {
            return false;
        }
        self.ticks += 1;
        assert!(self.ticks < MOST_TICKS, "does not end: {:?}", self.last);
        let Some(step) = step else { return true };
        self.completed += step.completed;
        self.starved += u32::from(step.starved);
        assert!(!step.rejected, "no law for {step:?} at {}", self.ticks);
        let start = step.tag.start;
        let axes = std::array::from_fn(|i| Sample { s: start[i] + step.axes[i].s, ..step.axes[i] });
        let seen = Seen { step, axes };
        self.limits(&seen);
        if let Some(last) = self.last {
            self.continues(&last, &seen);
        }
        self.last = Some(seen);
        true
    }

    /// To the end under one request.
    pub(crate) fn run(&mut self, ask: &Ask) {
        while self.tick(ask) {}
    }

    fn limits(&self, seen: &Seen) {
        for (axis, limits) in seen.axes.iter().zip(&self.axes) {
            for (got, most) in
                [(axis.v, limits.v), (axis.a, limits.a), (axis.j, limits.j), (axis.dj, limits.dj)]
            {
                // Not >: a NaN must not pass.
                let kept = got.abs() <= most * (1.0 + 1e-6);
                assert!(kept, "{got} over {most} at {}: {seen:?}", self.ticks);
            }
        }
    }

    fn continues(&self, last: &Seen, seen: &Seen) {
        let h = self.cycle_s;
        for (i, (p, q)) in last.axes.iter().zip(&seen.axes).enumerate() {
            let rate = self.axes[i].dj;
            let [ds, dv, da, dj] = [q.s - p.s, q.v - p.v, q.a - p.a, q.j - p.j];
            let errors = [
                (ds - 0.5 * h * (p.v + q.v) + h * h / 12.0 * da, rate * h * h * h * h / 192.0),
                (dv - 0.5 * h * (p.a + q.a) + h * h / 12.0 * dj, 3_f64.sqrt() / 54.0 * rate * h * h * h),
                (da - 0.5 * h * (p.j + q.j), 0.25 * rate * h * h),
                (dj, rate * h),
            ];
            for (n, (error, most)) in errors.into_iter().enumerate() {
                let kept = error.abs() <= most * (1.0 + 1e-6) + 1e-9;
                assert!(
                    kept,
                    "derivative {n} of axis {i} jumps by {error} at {}: {last:?} {seen:?}",
                    self.ticks
                );
            }
        }
        let way = seen.step.along.s - last.step.along.s;
        let (old, new) = (last.step.tag.number, seen.step.tag.number);
        assert!(new > old || new == old && way >= -ROUNDING, "back by {way} at {}: {seen:?}", self.ticks);
        assert!(seen.step.along.v >= -ROUNDING, "backwards at {}: {seen:?}", self.ticks);
    }

    /// What must hold at the end of a program.
    pub(crate) fn ends(&self) {
        let last = self.blocks.last().expect("a block");
        let end = end_of(&last.path);
        let got = self.last.expect("a tick").axes;
        for i in 0..N {
            let off = got[i].s - last.tag.start[i] - end[i];
            assert!(off.abs() <= 1e-9, "axis {i} ends {off} mm from its target");
            assert_eq!((got[i].v, got[i].a, got[i].j), (0.0, 0.0, 0.0), "axis {i}");
        }
        assert_eq!(self.completed as usize, self.blocks.len());
    }
}
