//! The mode of the slide. In: the response from commanded torque to speed, delay and lag of the torque. Out:
//! frequency and damping of the slide against the standing motor, its mass; none where none is seen.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | P(s) | (m/s)/N | speed of the motor by the force on it, true response of the mechanics |
//! | M, m, k, c | kg, N/m, N s/m | motor side, slide, elastic mode between them |
//! | w = √(k/m), ζ | rad/s, – | the slide against the standing motor: zeros of P |
//!
//! ```text
//! P = jω X/F,   X = G U T/(1 − z⁻¹)   from the speed that is measured as one difference
//! F = 2π/lead U (1 − z⁻¹)/(jωT) exp(−jωδ)/(1 + jωτ)   a held command, delayed, lagging                 (M81)
//! P = (c2 s² + c1 s + c0)/(s³ + d2 s² + d1 s + d0):   M = 1/c2,  M + m = d1/c0,  w² = c0/c2,  2ζw = c1/c2
//! without a mode  P = c/(s + d)
//! ```
//! The six coefficients are linear after multiplying with the denominator; dividing by the denominator found
//! before weighs every line by its true error (Sanathanan and Koerner 1963).

use core::f64::consts::TAU;

use machine::AxisConfig;
use nalgebra::Complex;

use crate::{
    drive_loop::metres_per_radian,
    estimate::Estimate,
    least_squares::{Fit, fit},
    response::Line,
    torque_path::{TorquePath, delayed},
};

/// Lines that are used, of the sampling frequency: above, images of the held torque count.
const HIGHEST: f64 = 0.15;
/// Scale of s in the fit, rad/s.
const UNIT: f64 = TAU * 50.0;
const ROUNDS: usize = 20;
/// Relative error of a line that the encoder has no part in: friction is not quite linear.
const EXACTNESS: f64 = 0.002;
/// A mode must make the residual this many times smaller.
const CLEARER: f64 = 1.5;
/// A slide lighter than this share of the axis does not count.
const LIGHTEST: f64 = 0.003;

/// The slide on its elastic mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// Frequency of the slide against the standing motor, Hz.
    pub hz: Estimate,
    /// Damping ratio of that mode, guide included.
    pub damping: Estimate,
    /// Mass that swings, kg.
    pub slide_kg: Estimate,
}

/// Speed by force, m/s per N, at a line (M81).
pub(crate) fn mechanics(line: &Line, config: &AxisConfig, path: &TorquePath, cycle_s: f64) -> Complex<f64> {
    let s = Complex::new(0.0, TAU * line.hz);
    let difference = Complex::from(1.0) - delayed(line.hz, cycle_s);
    let lag = (Complex::from(1.0) + s * path.lag_s.value).inv();
    let force = difference / (s * cycle_s) * delayed(line.hz, path.delay_s.value) * lag;
    let position = line.speed_per_torque * 1e-3 * cycle_s / difference;
    s * position / force * metres_per_radian(config)
}

/// The response at one line, and what its relative error weighs.
struct Point {
    hz: f64,
    response: Complex<f64>,
    weight: f64,
}

/// The mode, if one is seen.
pub(crate) fn identify(lines: &[Line], config: &AxisConfig, path: &TorquePath, cycle_s: f64) -> Option<Mode> {
    let used = lines.iter().filter(|line| line.hz * cycle_s <= HIGHEST);
    let point = |line: &Line| Point {
        hz: line.hz,
        response: mechanics(line, config, path, cycle_s),
        weight: 1.0 / (line.deviation + EXACTNESS),
    };
    let points: Vec<_> = used.map(point).collect();
    let stiff = rational::<2>(&points, 1)?;
    let elastic = rational::<6>(&points, 3)?;
    let mode = meaning(&elastic)?;
    let total = |fit: &Fit<6>| fit.x[4].value / fit.x[0].value / UNIT;
    let visible = mode.slide_kg.value > LIGHTEST * total(&elastic) && mode.hz.value * cycle_s <= HIGHEST;
    (visible && stiff.residual > CLEARER * elastic.residual).then_some(mode)
}

/// Fits c_k s^k … over s^n + d_k s^k …, both of degree n − 1 below the leading term, s in [`UNIT`]. `N` = 2
/// n.
fn rational<const N: usize>(points: &[Point], degree: usize) -> Option<Fit<N>> {
    let mut found: Option<Fit<N>> = None;
    for _ in 0..ROUNDS {
        let rows: Vec<_> = points.iter().flat_map(|point| equations(point, degree, found.as_ref())).collect();
        found = Some(fit(&rows)?);
    }
    found
}

fn equations<const N: usize>(
    Point { hz, response, weight }: &Point,
    degree: usize,
    before: Option<&Fit<N>>,
) -> [([f64; N], f64); 2] {
    let s = Complex::new(0.0, TAU * hz / UNIT);
    let denominator = before.map_or(Complex::from(1.0), |fit| {
        let lower = (0..degree).map(|k| s.powu(k as u32) * fit.x[degree + k].value);
        s.powu(degree as u32) + lower.sum::<Complex<f64>>()
    });
    // Errors count relative to the response, by how well the line is known.
    let weight = (denominator * *response).inv() * *weight;
    let terms: [Complex<f64>; N] = core::array::from_fn(|i| {
        let power = s.powu((i % degree) as u32) * weight;
        if i < degree { power } else { -*response * power }
    });
    let right = *response * s.powu(degree as u32) * weight;
    [(terms.map(|term| term.re), right.re), (terms.map(|term| term.im), right.im)]
}

fn meaning(fit: &Fit<6>) -> Option<Mode> {
    let [hz, damping, slide_kg] = values(fit.values())?;
    let deviation = |which: usize| {
        let parts = (0..6).map(|i| {
            let mut moved = fit.values();
            moved[i] += fit.x[i].deviation;
            values(moved).map_or(0.0, |moved| {
                let change = moved[which] - [hz, damping, slide_kg][which];
                change * change
            })
        });
        parts.sum::<f64>().sqrt()
    };
    Some(Mode {
        hz: Estimate { value: hz, deviation: deviation(0) },
        damping: Estimate { value: damping, deviation: deviation(1) },
        slide_kg: Estimate { value: slide_kg, deviation: deviation(2) },
    })
}

/// Frequency in Hz, damping, mass in kg of c0, c1, c2, d0, d1, d2.
fn values([c0, c1, c2, _, d1, _]: [f64; 6]) -> Option<[f64; 3]> {
    let w2 = c0 / c2;
    let w = w2.sqrt();
    let (motor, total) = (1.0 / c2 / UNIT, d1 / c0 / UNIT);
    let all = [w * UNIT / TAU, 0.5 * c1 / c2 / w, total - motor];
    (w2 > 0.0 && all[1] > 0.0 && all.iter().all(|value| value.is_finite())).then_some(all)
}
