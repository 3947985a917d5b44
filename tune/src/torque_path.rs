//! From commanded to measured torque: delay and lag. In: the response at the lines of a multisine. Out:
//! seconds.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | D(z) | – | measured by commanded torque, both sampled once a cycle T |
//! | δ = (d + φ) T | s | delay until a command acts, d whole, 0 ≤ φ < 1 |
//! | τ | s | lag of the current loop |
//!
//! ```text
//! a command holds for a cycle, δ late, behind a first-order lag:
//! D = a z⁻¹ D + b1 z^−(d+1) + b2 z^−(d+2)                                                              (M80)
//! a = exp(−T/τ),  b1 = g (1 − a exp(φT/τ)),  b2 = g (1 − a) − b1,  g: gain
//! ```
//! Linear in a, b1, b2 for a given d; the d that leaves least is taken.

use nalgebra::Complex;

use crate::{
    estimate::Estimate,
    least_squares::{Fit, fit},
    response::Line,
};

/// Longest delay that is tried, cycles.
const LONGEST: u32 = 8;

/// Delay and lag.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TorquePath {
    pub(crate) delay_s: Estimate,
    pub(crate) lag_s: Estimate,
    /// Measured by commanded torque at rest of all motion.
    pub(crate) gain: Estimate,
}

/// exp(−jωT n).
pub(crate) fn delayed(hz: f64, time_s: f64) -> Complex<f64> {
    let angle = -core::f64::consts::TAU * hz * time_s;
    Complex::new(libm::cos(angle), libm::sin(angle))
}

/// Delay and lag of a response; `None` if it is none of a delay and a lag.
pub(crate) fn identify(lines: &[Line], cycle_s: f64) -> Option<TorquePath> {
    let fits = (0..=LONGEST).filter_map(|d| {
        let rows: Vec<_> = lines.iter().flat_map(|line| equations(line, d, cycle_s)).collect();
        fit::<3>(&rows).map(|fit| (d, fit))
    });
    let (d, best) = fits.min_by(|a, b| a.1.residual.total_cmp(&b.1.residual))?;
    let [delay, lag, gain] = meaning(d, best.values(), cycle_s)?;
    Some(TorquePath {
        delay_s: Estimate { value: delay, deviation: deviation(0, d, &best, cycle_s) },
        lag_s: Estimate { value: lag, deviation: deviation(1, d, &best, cycle_s) },
        gain: Estimate { value: gain, deviation: deviation(2, d, &best, cycle_s) },
    })
}

/// Real and imaginary part of (M80) at one line.
fn equations(line: &Line, d: u32, cycle_s: f64) -> [([f64; 3], f64); 2] {
    let back = |cycles: u32| delayed(line.hz, f64::from(cycles) * cycle_s);
    let answer = line.torque_per_torque;
    let terms = [answer * back(1), back(d + 1), back(d + 2)];
    [(terms.map(|term| term.re), answer.re), (terms.map(|term| term.im), answer.im)]
}

/// Delay in s, lag in s and gain of a, b1, b2.
fn meaning(d: u32, [a, b1, b2]: [f64; 3], cycle_s: f64) -> Option<[f64; 3]> {
    let gain = (b1 + b2) / (1.0 - a);
    // No lag at all leaves a = 0, and then the part of a cycle that a command is late is the share of b2.
    let lag = if a > 1e-6 { -cycle_s / libm::log(a) } else { 0.0 };
    let part = if lag > 0.0 {
        1.0 + lag / cycle_s * libm::log((1.0 - b1 / gain).max(f64::MIN_POSITIVE))
    } else {
        b2 / (b1 + b2)
    };
    let all = [(f64::from(d) + part) * cycle_s, lag, gain];
    (a < 1.0 && all.iter().all(|value| value.is_finite())).then_some(all)
}

/// Standard deviation of one of the three, by its slopes.
fn deviation(which: usize, d: u32, fit: &Fit<3>, cycle_s: f64) -> f64 {
    let at = |values| meaning(d, values, cycle_s).map_or(0.0, |all| all[which]);
    let values = fit.values();
    let parts = (0..3).map(|i| {
        let mut moved = values;
        moved[i] += fit.x[i].deviation;
        (at(moved) - at(values)) * (at(moved) - at(values))
    });
    parts.sum::<f64>().sqrt()
}
