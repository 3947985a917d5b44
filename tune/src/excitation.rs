//! A multisine on the torque: many sines at once, each a whole number of times in a period. In: the axis as
//! configured, the control cycle. Out: torque by cycle, with a peak of 1.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | f, T | Hz, s | frequency of a line, control cycle |
//! | L = (w/jω)(1 + 1/(jω Ti)) | – | velocity loop as configured, on a rigid axis; w = 2π f_v |
//!
//! ```text
//! amplitude of a line  ∝  min(|1 + L|, 10) + (10 f T)²
//! phase of a line      so that the energy is spread evenly over the period (Schroeder 1970)
//! ```
//! Below its bandwidth the velocity loop takes from the torque what it is given: low lines are raised. What
//! the encoder rounds weighs with f², being differenced and divided by a speed that falls: high lines are
//! raised as well.

use core::f64::consts::TAU;

use machine::AxisConfig;
use nalgebra::Complex;

/// Length of a period, s: lines are 2 Hz apart.
const PERIOD_S: f64 = 0.5;
/// Lowest frequency, Hz.
const LOWEST_HZ: f64 = 6.0;
/// Up to here every line is excited, Hz; above it every fifth.
const DENSE_HZ: f64 = 250.0;
/// Highest frequency, of the sampling frequency.
const HIGHEST: f64 = 0.25;
/// Most by which a low line is raised.
const RAISED: f64 = 10.0;

/// One period of a multisine with a peak of 1.
#[derive(Clone, Debug)]
pub(crate) struct Multisine {
    cycle_s: f64,
    values: Vec<f64>,
    lines: Vec<usize>,
}

impl Multisine {
    pub(crate) fn new(config: &AxisConfig, cycle_s: f64) -> Multisine {
        let period = (PERIOD_S / cycle_s).round().max(1.0) as usize;
        let hz = |line: usize| line as f64 / (period as f64 * cycle_s);
        let wanted = |line: &usize| {
            hz(*line) >= LOWEST_HZ
                && hz(*line) * cycle_s <= HIGHEST
                && (hz(*line) <= DENSE_HZ || line.is_multiple_of(5))
        };
        let lines: Vec<usize> = (1..period / 2).filter(wanted).collect();
        let amplitudes: Vec<f64> = lines.iter().map(|line| amplitude(config, hz(*line), cycle_s)).collect();
        let phases = phases(&amplitudes);
        let value = |n: usize| -> f64 {
            let sines = lines.iter().zip(&amplitudes).zip(&phases).map(|((line, amplitude), phase)| {
                amplitude * libm::cos(TAU * ((n * line) % period) as f64 / period as f64 + phase)
            });
            sines.sum()
        };
        let mut values: Vec<f64> = (0..period).map(value).collect();
        let peak = values.iter().fold(0.0, |peak: f64, value| peak.max(value.abs()));
        values.iter_mut().for_each(|value| *value /= peak.max(f64::MIN_POSITIVE));
        Multisine { cycle_s, values, lines }
    }

    /// Control cycles of a period.
    pub(crate) fn period(&self) -> usize {
        self.values.len()
    }

    /// The excited lines: periods of each in a period of the multisine.
    pub(crate) fn lines(&self) -> &[usize] {
        &self.lines
    }

    /// Frequency of a line, Hz.
    pub(crate) fn hz(&self, line: usize) -> f64 {
        line as f64 / (self.period() as f64 * self.cycle_s)
    }

    /// The value in a cycle; the multisine goes on for ever.
    pub(crate) fn at(&self, cycle: usize) -> f64 {
        self.values[cycle % self.values.len()]
    }
}

fn amplitude(config: &AxisConfig, hz: f64, cycle_s: f64) -> f64 {
    let s = Complex::new(0.0, TAU * hz);
    let open = TAU * config.velocity_bandwidth_hz / s * (1.0 + (s * config.velocity_integral_s).inv());
    let high = 10.0 * hz * cycle_s;
    (1.0 + open).norm().min(RAISED) + high * high
}

/// Phase i is −2π Σ_{k<i} (i − k) p_k, p the shares of power.
fn phases(amplitudes: &[f64]) -> Vec<f64> {
    let power: f64 = amplitudes.iter().map(|amplitude| amplitude * amplitude).sum();
    let (mut before, mut phase) = (0.0, 0.0);
    let next = |amplitude: &f64| {
        let this = phase;
        before += amplitude * amplitude / power;
        phase -= TAU * before;
        this
    };
    amplitudes.iter().map(next).collect()
}
