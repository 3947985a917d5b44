//! Mass and friction of an axis from runs back and forth at several speeds. In: runs with measured torque and
//! position. Out: mass in kg, Coulomb friction in N, viscous friction in N s/mm, a constant force in N
//! (weight, balance).
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | F | N | measured torque times 2π/lead |
//! | v, x, D | mm/s, mm, s | measured speed and position; duration of a window |
//! | M, Fc, b, F0 | kg, N, N s/mm, N | what is sought |
//!
//! ```text
//! over every window in which the axis does not turn back:
//! ∫F dt = M Δv/1000 + Fc sgn(v) D + b Δx + F0 D                                                        (M78)
//! ```
//! Impulses need no acceleration: positions are differenced once, at the borders of a window, and a count of
//! the encoder weighs little against the change of speed between them. Windows below a tenth of the highest
//! speed are left out: friction has not come to its sliding value there. Friction is no better known than its
//! model is true. What the model misses of it counts against the mass, the more the less the axis
//! accelerates.

use machine::AxisConfig;
use motion::{FeedBlock, Limits, Sample, junction_distance};

use crate::{
    drive_loop::metres_per_radian,
    estimate::Estimate,
    least_squares::fit,
    refusal::Refusal,
    stand::{Bench, Row, Stand},
};

/// Share of the limits of the axis that a test run uses.
const SHARE: f64 = 0.6;
/// Time at the speed of a run, and of rest after it, s.
const CRUISE_S: f64 = 0.15;
/// Speeds of the runs, of the highest.
const SPEEDS: [f64; 5] = [0.25, 0.4, 0.6, 0.8, 1.0];
/// Slowest speed of a window, of the highest.
const SLOWEST: f64 = 0.1;
/// Share of Coulomb friction that may hide in the mass.
const FRICTION_ERROR: f64 = 0.02;
/// Length of a window, s.
const WINDOW_S: f64 = 0.01;

/// Mass and friction.
#[derive(Clone, Debug)]
pub(crate) struct Rigid {
    pub(crate) mass_kg: Estimate,
    pub(crate) coulomb_n: Estimate,
    pub(crate) viscous_n_s_mm: Estimate,
    pub(crate) constant_n: Estimate,
    /// Friction against speed, N and mm/s, one point a run.
    pub(crate) curve: Vec<[f64; 2]>,
}

/// Limits of test runs.
pub(crate) fn limits(config: &AxisConfig) -> Limits {
    let Limits { v, a, j, dj } = config.limits();
    Limits { v: SHARE * v, a: SHARE * a, j: SHARE * j, dj: SHARE * dj }
}

/// Way of a run that is even at a speed for a time, mm.
pub(crate) fn way(v: f64, even_s: f64, limits: &Limits) -> f64 {
    2.0 * junction_distance(0.0, v, limits) + v * even_s
}

/// Highest speed of runs within a way of `length_mm` that are even for a time, mm/s.
pub(crate) fn top_speed(length_mm: f64, even_s: f64, limits: &Limits) -> f64 {
    if way(limits.v, even_s, limits) <= length_mm {
        return limits.v;
    }
    let (mut low, mut high) = (0.0, limits.v);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if way(middle, even_s, limits) <= length_mm { low = middle } else { high = middle }
    }
    low
}

/// A run from one place to another, mm from the start of the test, and a rest.
pub(crate) fn run<B: Bench>(
    stand: &mut Stand<B>,
    [from, to]: [f64; 2],
    v: f64,
    limits: &Limits,
    offset_nm: impl Fn(usize) -> f64,
) -> Result<Vec<Row>, Refusal> {
    let block = FeedBlock::plan((to - from).abs(), 0.0, v, 0.0, limits);
    let block = block.map_err(|_| Refusal::Unplanned(stand.axis(), to - from, v))?;
    let sign = (to - from).signum();
    let law = |t: f64| {
        let Sample { s, v, a, j, dj } = block.at(t);
        Sample { s: from + sign * s, v: sign * v, a: sign * a, j: sign * j, dj: sign * dj }
    };
    stand.follow(block.duration() + CRUISE_S, law, offset_nm)
}

/// Runs from 0 towards `reach_mm` (signed) and back, and what they tell.
///
/// `None` if the runs do not determine the values.
pub(crate) fn measure<B: Bench>(
    stand: &mut Stand<B>,
    config: &AxisConfig,
    reach_mm: f64,
) -> Result<Option<Rigid>, Refusal> {
    let limits = limits(config);
    let top = top_speed(reach_mm.abs(), CRUISE_S, &limits);
    let mut runs = Vec::new();
    for v in SPEEDS.map(|share| share * top) {
        let end = way(v, CRUISE_S, &limits).copysign(reach_mm);
        runs.push(run(stand, [0.0, end], v, &limits, |_| 0.0)?);
        runs.push(run(stand, [end, 0.0], v, &limits, |_| 0.0)?);
    }
    let cycle_s = stand.cycle_s();
    let windows: Vec<Window> = runs
        .iter()
        .flat_map(|run| windows(run, cycle_s, metres_per_radian(config)))
        .filter(|window| window.v_before.min(window.v_after) > SLOWEST * top)
        .collect();
    let rows: Vec<_> = windows.iter().map(Window::row).collect();
    Ok(fit(&rows).map(|fit| {
        let [mut mass, coulomb_n, viscous_n_s_mm, constant_n] = fit.x;
        let fastest = windows.iter().map(Window::acceleration).fold(0.0, f64::max);
        let hidden_kg = FRICTION_ERROR * coulomb_n.value.abs() / (1e-3 * fastest);
        mass.deviation = libm::hypot(mass.deviation, hidden_kg);
        let curve = runs.iter().filter_map(|run| {
            cruise(&windows_of(run, cycle_s, config), mass.value, constant_n.value, SLOWEST * top)
        });
        Rigid { mass_kg: mass, coulomb_n, viscous_n_s_mm, constant_n, curve: curve.collect() }
    }))
}

fn windows_of(run: &[Row], cycle_s: f64, config: &AxisConfig) -> Vec<Window> {
    windows(run, cycle_s, metres_per_radian(config))
}

/// One window of a run. Speeds are along the direction of its motion.
#[derive(Clone, Copy, Debug)]
struct Window {
    sign: f64,
    duration_s: f64,
    impulse_n_s: f64,
    v_before: f64,
    v_after: f64,
    way_mm: f64,
}

impl Window {
    /// Mean magnitude of its acceleration, mm/s².
    fn acceleration(&self) -> f64 {
        (self.v_after - self.v_before).abs() / self.duration_s
    }

    /// The equation of this window (M78).
    fn row(&self) -> ([f64; 4], f64) {
        let change = self.sign * (self.v_after - self.v_before) * 1e-3;
        ([change, self.sign * self.duration_s, self.way_mm, self.duration_s], self.impulse_n_s)
    }
}

fn windows(run: &[Row], cycle_s: f64, metres_per_radian: f64) -> Vec<Window> {
    let length = (WINDOW_S / cycle_s).round().max(2.0) as usize;
    let speed = |at: usize| (run[at + 1].motor_mm - run[at - 1].motor_mm) / (2.0 * cycle_s);
    let mut windows = Vec::new();
    let mut first = 1;
    while first + length + 1 < run.len() {
        let last = first + length;
        let inner: f64 = run[first + 1..last].iter().map(|row| row.torque_nm).sum();
        let torque = inner + 0.5 * (run[first].torque_nm + run[last].torque_nm);
        let way_mm = run[last].motor_mm - run[first].motor_mm;
        let sign = if way_mm < 0.0 { -1.0 } else { 1.0 };
        windows.push(Window {
            sign,
            duration_s: length as f64 * cycle_s,
            impulse_n_s: torque * cycle_s / metres_per_radian,
            v_before: sign * speed(first),
            v_after: sign * speed(last),
            way_mm,
        });
        first = last;
    }
    windows
}

/// Mean friction of a run where it is fast, with its mean speed there.
fn cruise(windows: &[Window], mass_kg: f64, constant_n: f64, slowest: f64) -> Option<[f64; 2]> {
    let fastest = windows.iter().map(|window| window.v_after).fold(0.0, f64::max);
    let even = windows
        .iter()
        .filter(|w| w.v_before.min(w.v_after) > (0.98 * fastest).max(slowest))
        .collect::<Vec<_>>();
    let time: f64 = even.iter().map(|w| w.duration_s).sum();
    let way: f64 = even.iter().map(|w| w.way_mm).sum();
    let impulse: f64 = even
        .iter()
        .map(|w| {
            w.impulse_n_s - constant_n * w.duration_s - mass_kg * w.sign * (w.v_after - w.v_before) * 1e-3
        })
        .sum();
    (time > 0.0).then(|| [way / time, impulse / time])
}
