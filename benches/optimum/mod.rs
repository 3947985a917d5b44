//! The least time on a given path within the limits of the axes, found by numbers. In: the path on a grid,
//! limits in mm/sⁿ. Out: seconds, of a feed that keeps all limits at every place of the grid.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | h | mm | step of the grid |
//! | b = ṡ² | mm²/s² | the unknown at every place of it; b′, b″, b‴ are its differences |
//! | p₁ … p₄ | 1/mmⁿ⁻¹ | derivatives of an axis by the way |
//! | μ | s | weight of the barrier |
//!
//! ```text
//! q = ½ p₁b″ + 3/2 p₂b′ + p₃b,  q′ = ½ p₁b‴ + 2 p₂b″ + 5/2 p₃b′ + p₄b
//! b ≤ F², V²/p₁², 8 ε/|p₂|T²,  |½ p₁b′ + p₂b| ≤ A,  √b |q| ≤ J,  |b q′ + ½ b′q| ≤ D
//! least Σ 2h/(√bₖ + √bₖ₊₁) − μ Σ log(1 − what is used of each limit),  μ → 0                   (M178)
//! ```
//! Each step is one of Newton's with the squares of the slopes for the curvature of the barrier, as long as
//! it stays within all limits and gains. Two places at each end of the path, where the machine rests, are
//! left out of jerk, three out of jerk rate: that makes the result some hundredths of a second short. It is a
//! local least; a lower one is not ruled out.

use motion::Limits;
use motion::chain::{Ask, Block, Chain, Ratios, Settings};

/// Derivatives p₁ … p₄ of every axis at a place.
pub(crate) type Place = [[f64; 3]; 4];

/// What is kept beside the limits of the axes.
#[derive(Clone, Copy)]
pub(crate) struct Caps {
    /// Feed, mm/s.
    pub(crate) feed: f64,
    /// 8 ε/T², mm/s².
    pub(crate) chord_v2: f64,
}

/// Places of the matrix beside its diagonal.
const BAND: usize = 4;
/// The barrier costs this share of the time at the end.
const GAP: f64 = 0.002;
/// What the weight of the barrier is divided by.
const FASTER: f64 = 4.0;
/// Most steps for one weight.
const STEPS: usize = 60;
/// A turn of the direction within a step of the grid that is a stop.
const STOP: f64 = 0.7;

/// The path of a chain with its blends on a grid of `h` mm: it is driven at 1 mm/s by axes without limits, so
/// that no stop is faster than a rounded corner.
pub(crate) fn places(blocks: &[Block<3, ()>], h: f64) -> Vec<Place> {
    let free = Limits { v: 1e6, a: 1e8, j: 1e12, dj: 1e16 };
    let mut chain = Chain::new(Settings { axes: [free; 3], cycle_s: h });
    let mut left = blocks.iter().map(|block| Block {
        feed: motion::chain::Feed::PerSecond(1.0),
        chord_mm: 1e9,
        ..*block
    });
    let mut next = left.next();
    let mut places = Vec::new();
    loop {
        while let Some(block) = next.filter(|_| chain.has_room()) {
            chain.push(block);
            next = left.next();
        }
        if next.is_none() && chain.has_room() {
            chain.close();
        }
        let ask = Ask { ratios: Ratios::full(0.0), hold: false, single: false, more: next.is_some() };
        let Some(step) = chain.tick(&ask) else { break };
        assert!(!step.rejected);
        let along = step.along;
        if (along.v - 1.0).abs() < 1e-9 && along.a == 0.0 {
            places.push([1, 2, 3, 4].map(|n| step.axes.map(|axis| [axis.v, axis.a, axis.j, axis.dj][n - 1])));
        }
    }
    for (k, pair) in places.windows(2).enumerate() {
        let turn: f64 = (0..3).map(|i| (pair[1][0][i] - pair[0][0][i]).powi(2)).sum();
        assert!(turn.sqrt() < STOP, "{} mm: too coarse a grid, or a stop", k as f64 * h);
    }
    places
}

struct Problem<'a> {
    places: &'a [Place],
    axes: &'a [Limits; 3],
    caps: Vec<f64>,
    h: f64,
}

/// Value, slopes, and the lower half of the band of the second derivatives.
struct Model {
    slope: Vec<f64>,
    bands: Vec<[f64; BAND + 1]>,
}

impl Model {
    /// Adds − μ log of a slack with its slopes by the five unknowns about `k`.
    fn bar(&mut self, mu: f64, slack: f64, by: &[f64; 5], k: usize) {
        for i in 0..5 {
            if by[i] == 0.0 {
                continue;
            }
            let row = k + i - 2;
            self.slope[row] -= mu * by[i] / slack;
            for j in 0..=i {
                self.bands[row][i - j] += mu * by[i] * by[j] / (slack * slack);
            }
        }
    }
}

impl Problem<'_> {
    fn free(&self) -> std::ops::Range<usize> {
        2..self.places.len() + 2
    }

    /// The time alone, s.
    fn time(&self, b: &[f64]) -> f64 {
        b[1..b.len() - 1].windows(2).map(|b| 2.0 * self.h / (b[0].sqrt() + b[1].sqrt())).sum()
    }

    /// What all limits leave, each a share of itself, with slopes by five unknowns; false if one leaves
    /// nothing.
    fn slacks(&self, b: &[f64], mut each: impl FnMut(f64, [f64; 5], usize)) -> bool {
        let h = self.h;
        let count = self.places.len();
        for (n, place) in self.places.iter().enumerate() {
            let k = n + 2;
            let at = b[k];
            let cap = 1.0 - at / self.caps[n];
            if !(at > 0.0 && cap > 0.0) {
                return false;
            }
            each(at, [0.0, 0.0, 1.0, 0.0, 0.0], k);
            each(cap, [0.0, 0.0, -1.0 / self.caps[n], 0.0, 0.0], k);
            let d1 = [0.0, -0.5 / h, 0.0, 0.5 / h, 0.0];
            let d2 = [0.0, 1.0 / (h * h), -2.0 / (h * h), 1.0 / (h * h), 0.0];
            let d3 = [-0.5, 1.0, 0.0, -1.0, 0.5].map(|c| c / (h * h * h));
            let own = [0.0, 0.0, 1.0, 0.0, 0.0];
            let near = &b[k - 2..k + 3];
            let of = |by: &[f64; 5]| -> f64 { by.iter().zip(near).map(|(c, b)| c * b).sum() };
            let root = at.sqrt();
            let b1 = of(&d1);
            for (i, axis) in self.axes.iter().enumerate() {
                let [p1, p2, p3, p4] = [0, 1, 2, 3].map(|n| place[n][i]);
                if p1 == 0.0 && p2 == 0.0 && p3 == 0.0 && p4 == 0.0 {
                    continue;
                }
                let mix = |f: &dyn Fn(usize) -> f64| -> [f64; 5] { std::array::from_fn(f) };
                let a = mix(&|m| 0.5 * p1 * d1[m] + p2 * own[m]);
                let qs = mix(&|m| 0.5 * p1 * d2[m] + 1.5 * p2 * d1[m] + p3 * own[m]);
                let q1s = mix(&|m| 0.5 * p1 * d3[m] + 2.0 * p2 * d2[m] + 2.5 * p3 * d1[m] + p4 * own[m]);
                let (q, q1) = (of(&qs), of(&q1s));
                let js = mix(&|m| root * qs[m] + 0.5 * q / root * own[m]);
                let ds = mix(&|m| at * q1s[m] + q1 * own[m] + 0.5 * (b1 * qs[m] + q * d1[m]));
                let inner = |margin: usize| n >= margin && n + margin < count;
                let all = [
                    (true, of(&a), a, axis.a),
                    (inner(2), root * q, js, axis.j),
                    (inner(3), at * q1 + 0.5 * b1 * q, ds, axis.dj),
                ];
                for (_, value, by, limit) in all.into_iter().filter(|one| one.0) {
                    for side in [1.0, -1.0] {
                        let slack = 1.0 - side * value / limit;
                        if slack <= 0.0 {
                            return false;
                        }
                        each(slack, by.map(|by| -side * by / limit), k);
                    }
                }
            }
        }
        true
    }

    /// Time and barrier; infinite outside of the limits.
    fn merit(&self, b: &[f64], mu: f64) -> f64 {
        let mut logs = 0.0;
        let within = self.slacks(b, |slack, _, _| logs += libm::log(slack));
        if within { self.time(b) - mu * logs } else { f64::INFINITY }
    }

    fn model(&self, b: &[f64], mu: f64) -> Model {
        let mut model = Model { slope: vec![0.0; b.len()], bands: vec![[0.0; BAND + 1]; b.len()] };
        self.slacks(b, |slack, by, k| model.bar(mu, slack, &by, k));
        for k in 1..b.len() - 2 {
            let (x, y) = (b[k].sqrt(), b[k + 1].sqrt());
            let sum = x + y;
            for (row, own) in [(k, x), (k + 1, y)] {
                if own > 0.0 {
                    model.slope[row] -= self.h / (own * sum * sum);
                    model.bands[row][0] += self.h * (0.5 / own + 1.0 / sum) / (own * own * sum * sum);
                }
            }
            if x > 0.0 && y > 0.0 {
                model.bands[k + 1][1] += self.h / (x * y * sum * sum * sum);
            }
        }
        model
    }

    /// Newton's step of the free unknowns, by Cholesky of the band.
    fn step(&self, mut model: Model) -> Vec<f64> {
        let free = self.free();
        let (mut step, bands) = (vec![0.0; model.slope.len()], &mut model.bands);
        for k in free.clone() {
            bands[k][0] *= 1.0 + 1e-12;
            for m in (0..=BAND.min(k - free.start)).rev() {
                let j = k - m;
                let mut sum = bands[k][m];
                for l in m + 1..=BAND.min(k - free.start) {
                    if l - m <= BAND {
                        sum -= bands[k][l] * bands[j][l - m];
                    }
                }
                bands[k][m] = if m == 0 { sum.max(f64::MIN_POSITIVE).sqrt() } else { sum / bands[j][0] };
            }
            let known: f64 = (1..=BAND.min(k - free.start)).map(|m| bands[k][m] * step[k - m]).sum();
            step[k] = (-model.slope[k] - known) / bands[k][0];
        }
        for k in free.clone().rev() {
            let known: f64 =
                (1..=BAND).filter(|m| k + m < free.end).map(|m| bands[k + m][m] * step[k + m]).sum();
            step[k] = (step[k] - known) / bands[k][0];
        }
        step
    }
}

/// The least time along places that are `h` mm apart, from rest to rest, s.
pub(crate) fn least_time(places: &[Place], h: f64, axes: &[Limits; 3], caps: Caps) -> f64 {
    let cap = |place: &Place| {
        let bend = place[1].iter().map(|x| x * x).sum::<f64>().sqrt();
        let chord = if bend > 0.0 { caps.chord_v2 / bend } else { f64::INFINITY };
        let axis = |i: usize| (axes[i].v / place[0][i].abs()).powi(2);
        (0..3).map(axis).fold(chord.min(caps.feed * caps.feed), f64::min)
    };
    let problem = Problem { places, axes, caps: places.iter().map(cap).collect(), h };
    let count = places.len();
    let mut b = vec![0.0; count + 4];
    for k in 0..count {
        let end = ((k + 1).min(count - k) as f64 * h).min(1.0);
        b[k + 2] = caps.feed * caps.feed * end * end.sqrt();
    }
    while problem.merit(&b, 0.0).is_infinite() {
        b.iter_mut().for_each(|b| *b *= 0.7);
    }
    let limits = (20 * count) as f64;
    let mut mu = problem.time(&b) / limits;
    loop {
        let mut merit = problem.merit(&b, mu);
        for _ in 0..STEPS {
            let step = problem.step(problem.model(&b, mu));
            let mut share = 1.0;
            let (better, at) = loop {
                let there: Vec<f64> = b.iter().zip(&step).map(|(b, step)| b + share * step).collect();
                let better = problem.merit(&there, mu);
                if better < merit || share < 1e-6 {
                    break (better, there);
                }
                share *= 0.5;
            };
            let gain = merit - better;
            if gain > 0.0 {
                (b, merit) = (at, better);
            }
            if gain <= 1e-5 * problem.time(&b) {
                break;
            }
        }
        let time = problem.time(&b);
        if mu * limits < GAP * time {
            return time;
        }
        mu = (mu / FASTER).min(time / limits);
    }
}
