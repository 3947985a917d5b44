//! Frequency response of an axis in motion. In: a multisine on the torque while the axis runs at a constant speed. Out:
//! for each of its lines, what speed and measured torque answer to commanded torque.
//!
//! The axis runs so that friction keeps its sign; mass, mode and viscous friction are linear about that speed. The
//! velocity loop stays closed, so commanded torque is not the multisine but the whole output of the loop.
//!
//! ```text
//! U, V, τ: Fourier sums over a period of commanded torque, speed (one difference of positions), measured torque
//! G = mean V/mean U,   D = mean τ/mean U,   over the periods after the first
//! ```
//! Below the lowest line the axis is taken as what it is there, a mass with viscous friction behind the delay and the lag
//! that were identified.
//!
//! What the encoder rounds is not in step with the periods, and averages away; the scatter of the periods says how much
//! is left.

use core::f64::consts::TAU;

use nalgebra::Complex;
use protocol::machine::AxisConfig;

use crate::{
    drive_loop::metres_per_radian,
    excitation::Multisine,
    refusal::Refusal,
    rigid::{limits, run},
    stand::{Bench, Row, Stand},
    torque_path::{TorquePath, delayed},
};

/// Periods that are evaluated.
const PERIODS: usize = 6;
/// Time for the run to become even before the first period, s.
const SETTLE_S: f64 = 0.2;
/// Speed of the run, of the highest of the axis, and of what the travel gives.
const RUN_SHARE: f64 = 0.1;
const TRAVEL_SHARE: f64 = 0.8;
/// Peak of the multisine, of the torque limit, at first. More would let the slide reverse where it swings, and friction
/// would bend the response.
const PEAK_SHARE: f64 = 0.1;
/// The speed must not fall below this share of that of the run: else the multisine is halved.
const SLOWEST: f64 = 0.2;
/// Distance of lines below the lowest one that is measured, Hz.
const STEP_HZ: f64 = 0.5;
/// How often it may be halved.
const HALVINGS: usize = 6;

/// The answers of an axis at one frequency.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// Frequency, Hz.
    pub hz: f64,
    /// Speed of the motor (one difference of its encoder) by commanded torque, mm/s per N·m.
    pub speed_per_torque: Complex<f64>,
    /// The same for the speed of the linear scale; without a scale the same.
    pub scale_speed_per_torque: Complex<f64>,
    /// Measured by commanded torque.
    pub torque_per_torque: Complex<f64>,
    /// Relative standard deviation of the first.
    pub deviation: f64,
}

/// Runs with the multisine within `reach_mm` (signed) and back.
pub(crate) fn measure<B: Bench>(
    stand: &mut Stand<B>,
    config: &AxisConfig,
    reach_mm: f64,
) -> Result<Vec<Line>, Refusal> {
    let cycle_s = stand.cycle_s();
    let sine = Multisine::new(config, cycle_s);
    let limits = limits(config);
    let first = (SETTLE_S / cycle_s).round() as usize;
    let length_s = 2.0 * SETTLE_S + (PERIODS + 1) as f64 * sine.period() as f64 * cycle_s;
    let speed = (RUN_SHARE * limits.v).min(TRAVEL_SHARE * reach_mm.abs() / (length_s + SETTLE_S));
    let end = (speed * length_s + 2.0 * motion::junction_distance(0.0, speed, &limits)).copysign(reach_mm);
    let ramp = (motion::Ramp::fastest(speed, &limits).duration() / cycle_s).ceil() as usize;
    let start = first + ramp;
    let mut peak = PEAK_SHARE * config.torque_limit_nm;
    let mut rows = Vec::new();
    for _ in 0..HALVINGS {
        let last = start + (PERIODS + 1) * sine.period();
        let offset =
            |cycle: usize| if (start..last).contains(&cycle) { peak * sine.at(cycle - start) } else { 0.0 };
        rows = run(stand, [0.0, end], speed, &limits, offset)?;
        run(stand, [end, 0.0], (3.0 * speed).min(limits.v), &limits, |_| 0.0)?;
        let evaluated = rows.get(start..last).unwrap_or(&[]);
        let slowest = slowest(evaluated, cycle_s, reach_mm.signum());
        rows.drain(..start.min(rows.len()));
        if slowest > SLOWEST * speed {
            break;
        }
        peak *= 0.5;
    }
    Ok(sine.lines().iter().filter_map(|line| answer(&rows, &sine, *line, cycle_s)).collect())
}

/// Lines every half hertz below the lowest one that was measured, for a mass in kg with viscous friction in N s/mm.
pub(crate) fn below(
    lines: &[Line],
    config: &AxisConfig,
    path: &TorquePath,
    [mass_kg, viscous_n_s_mm]: [f64; 2],
    cycle_s: f64,
) -> Vec<Line> {
    let lowest = lines.first().map_or(0.0, |line| line.hz);
    let late_s = path.delay_s.value + path.lag_s.value + cycle_s;
    let line = |number: usize| {
        let hz = STEP_HZ * number as f64;
        let resistance = Complex::new(viscous_n_s_mm, TAU * hz * mass_kg * 1e-3) * metres_per_radian(config);
        let speed = delayed(hz, late_s) / resistance;
        Line {
            hz,
            speed_per_torque: speed,
            scale_speed_per_torque: speed,
            torque_per_torque: delayed(hz, path.delay_s.value + path.lag_s.value + 0.5 * cycle_s),
            deviation: 0.0,
        }
    };
    (1..).map(line).take_while(|line| line.hz < lowest).collect()
}

/// Slowest speed of a run, mm/s, in its direction.
fn slowest(rows: &[Row], cycle_s: f64, sign: f64) -> f64 {
    let speeds = rows.windows(2).map(|two| sign * (two[1].motor_mm - two[0].motor_mm) / cycle_s);
    speeds.fold(f64::INFINITY, f64::min)
}

/// The answer at one line; rows begin with the period that is left out.
fn answer(rows: &[Row], sine: &Multisine, line: usize, cycle_s: f64) -> Option<Line> {
    let period = sine.period();
    let one = |of: &dyn Fn(usize) -> f64, from: usize| -> Complex<f64> {
        let term = |n: usize| {
            let angle = -TAU * ((n * line) % period) as f64 / period as f64;
            Complex::new(libm::cos(angle), libm::sin(angle)) * of(from + n)
        };
        (0..period).map(term).sum()
    };
    if rows.len() < (PERIODS + 1) * period {
        return None;
    }
    let command = |n: usize| rows[n].command_nm;
    let torque = |n: usize| rows[n].torque_nm;
    let speed = |n: usize| (rows[n].motor_mm - rows[n - 1].motor_mm) / cycle_s;
    let scale = |n: usize| (rows[n].scale_mm - rows[n - 1].scale_mm) / cycle_s;
    let starts: Vec<usize> = (1..=PERIODS).map(|number| number * period).collect();
    let mean = |of: &dyn Fn(usize) -> f64| -> Complex<f64> {
        starts.iter().map(|from| one(of, *from)).sum::<Complex<f64>>() / PERIODS as f64
    };
    let input = mean(&command);
    let response = mean(&speed) / input;
    let scatter = |from: &usize| (one(&speed, *from) - response * one(&command, *from)).norm_sqr();
    let variance = starts.iter().map(scatter).sum::<f64>() / (PERIODS * (PERIODS - 1)) as f64;
    let deviation = variance.sqrt() / (response * input).norm();
    deviation.is_finite().then_some(Line {
        hz: sine.hz(line),
        speed_per_torque: response,
        scale_speed_per_torque: mean(&scale) / input,
        torque_per_torque: mean(&torque) / input,
        deviation,
    })
}
