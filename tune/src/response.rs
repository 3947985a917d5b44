//! Frequency response of an axis in motion. In: a multisine on the torque while the axis runs at a constant
//! speed. Out: for each of its lines, what speed and measured torque answer to commanded torque.
//!
//! The axis runs so that friction keeps its sign; mass, mode and viscous friction are linear about that
//! speed. Where a run over all periods would be slow, each run takes fewer of them. The velocity loop stays
//! closed, so commanded torque is not the multisine but the whole output of the loop.
//!
//! ```text
//! U, V, τ: Fourier sums over a period of commanded torque, speed (one difference of positions),
//!          measured torque;  U': of what known cogging leaves of the command
//! G = mean V/mean U',  D = mean τ/mean U,   over the periods after the first of each run
//! ```
//! Below the lowest line the axis is taken as what it is there, a mass with viscous friction behind the delay
//! and the lag that were identified.
//!
//! What the encoder rounds is not in step with the periods, and averages away; the scatter of the periods
//! says how much is left.

use core::f64::consts::TAU;

use machine::AxisConfig;
use motion::Limits;
use nalgebra::Complex;

use crate::{
    drive_loop::metres_per_radian,
    excitation::Multisine,
    refusal::Refusal,
    rigid::{limits, run, top_speed, way},
    stand::{Bench, Row, Stand},
    torque_path::{TorquePath, delayed},
};

/// Periods that are evaluated.
const PERIODS: usize = 6;
/// Time for the run to become even before the first period, s.
const SETTLE_S: f64 = 0.2;
/// How many of them one run may take.
const PERIODS_A_RUN: [usize; 4] = [6, 3, 2, 1];
/// Speed of the runs that is wanted, of the highest of a test run.
const RUN_SHARE: f64 = 0.1;
/// Peak of the multisine, of the torque limit, at first. More would let the slide reverse where it swings,
/// and friction would bend the response.
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

/// Runs with the multisine within `reach_mm` (signed) and back: the lines, and the speed they were measured
/// at, mm/s.
pub(crate) fn measure<B: Bench>(
    stand: &mut Stand<B>,
    config: &AxisConfig,
    reach_mm: f64,
) -> Result<(Vec<Line>, f64), Refusal> {
    let cycle_s = stand.cycle_s();
    let sine = Multisine::new(config, cycle_s);
    let limits = limits(config);
    let plan = Plan::new(reach_mm, &sine, cycle_s, &limits);
    let Plan { speed, periods, end, .. } = plan;
    let ramp_s = motion::Ramp::fastest(speed, &limits).duration();
    let start = (SETTLE_S / cycle_s).round() as usize + (ramp_s / cycle_s).ceil() as usize;
    let last = start + (periods + 1) * sine.period();
    let mut peak = PEAK_SHARE * config.torque_limit_nm;
    for _ in 0..HALVINGS {
        let offset =
            |cycle: usize| if (start..last).contains(&cycle) { peak * sine.at(cycle - start) } else { 0.0 };
        let mut runs = Vec::new();
        for _ in 0..PERIODS / periods {
            let rows = run(stand, [0.0, end], speed, &limits, offset)?;
            run(stand, [end, 0.0], (3.0 * speed).min(limits.v), &limits, |_| 0.0)?;
            runs.push(rows.get(start..last).unwrap_or(&[]).to_vec());
        }
        let slowest = runs.iter().map(|rows| slowest(rows, cycle_s, reach_mm.signum()));
        if slowest.fold(f64::INFINITY, f64::min) > SLOWEST * speed {
            let lines = sine.lines().iter().filter_map(|line| answer(&runs, &sine, *line, cycle_s));
            return Ok((lines.collect(), speed));
        }
        peak *= 0.5;
    }
    Err(Refusal::Response(stand.axis(), "the axis came to a stand, however small the multisine", speed))
}

/// How the runs are made.
struct Plan {
    /// Speed, mm/s.
    speed: f64,
    /// Periods of a run that are evaluated.
    periods: usize,
    /// Place of its end, mm.
    end: f64,
}

impl Plan {
    /// As many periods a run as leave it the wanted speed.
    fn new(reach_mm: f64, sine: &Multisine, cycle_s: f64, limits: &Limits) -> Plan {
        let even_s = |periods: usize| 2.0 * SETTLE_S + (periods + 1) as f64 * sine.period() as f64 * cycle_s;
        let speed = |periods| top_speed(reach_mm.abs(), even_s(periods), limits).min(RUN_SHARE * limits.v);
        let fastest = speed(1);
        let periods = PERIODS_A_RUN.into_iter().find(|periods| speed(*periods) >= fastest).unwrap_or(1);
        let end = way(fastest, even_s(periods), limits).copysign(reach_mm);
        Plan { speed: fastest, periods, end }
    }
}

/// Lines every half hertz below the lowest one that was measured, for a mass in kg with viscous friction in N
/// s/mm.
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

/// The answer at one line; each run begins with the period that is left out.
fn answer(runs: &[Vec<Row>], sine: &Multisine, line: usize, cycle_s: f64) -> Option<Line> {
    let period = sine.period();
    // Each with the row before it, for the differences.
    let periods: Vec<&[Row]> = runs
        .iter()
        .flat_map(|rows| rows.get(period - 1..).unwrap_or(&[]).windows(period + 1).step_by(period))
        .collect();
    if periods.len() < PERIODS {
        return None;
    }
    let one = |of: fn(&Row, &Row) -> f64, rows: &[Row]| -> Complex<f64> {
        let term = |(n, two): (usize, &[Row])| {
            let angle = -TAU * ((n * line) % period) as f64 / period as f64;
            Complex::new(libm::cos(angle), libm::sin(angle)) * of(&two[0], &two[1])
        };
        rows.windows(2).enumerate().map(term).sum()
    };
    let mean = |of: fn(&Row, &Row) -> f64| -> Complex<f64> {
        periods.iter().map(|rows| one(of, rows)).sum::<Complex<f64>>() / periods.len() as f64
    };
    let command = |_: &Row, row: &Row| row.command_nm;
    let driving = |_: &Row, row: &Row| row.driving_nm;
    let way = |before: &Row, row: &Row| row.motor_mm - before.motor_mm;
    let input = mean(driving);
    let response = mean(way) / input;
    let scatter = |rows: &&[Row]| (one(way, rows) - response * one(driving, rows)).norm_sqr();
    let variance = periods.iter().map(scatter).sum::<f64>() / (periods.len() * (periods.len() - 1)) as f64;
    let deviation = variance.sqrt() / (response * input).norm();
    deviation.is_finite().then_some(Line {
        hz: sine.hz(line),
        speed_per_torque: response / cycle_s,
        scale_speed_per_torque: mean(|before, row| row.scale_mm - before.scale_mm) / input / cycle_s,
        torque_per_torque: mean(|_, row| row.torque_nm) / mean(command),
        deviation,
    })
}
