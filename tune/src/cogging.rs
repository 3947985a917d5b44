//! What comes back with every turn of the motor, above all its cogging. In: slow even runs both ways with
//! measured torque and position. Out: how often a turn, N·m, degrees.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | x, θ | mm, rad | measured position of the motor, and 2π x/lead |
//! | d | N·m | torque that does not accelerate: (M133) without a table, with the mass that was found |
//! | n, T, φ | –, N·m, rad | how often a turn, torque, phase |
//!
//! ```text
//! over every turn and each way   c = 2/lead ∫ (d − mean of d) exp(−i n θ) dx;   T = |c|,  φ = arg c + π/2
//! ```
//! The motor turns so slowly that its loops hold it: hardly anything is left to accelerate. Every turn says
//! it anew: the scatter of c is its deviation. What stands out of that, and is large enough to matter, is
//! proposed.

use core::array;
use core::f64::consts::TAU;

use machine::{AxisConfig, MOST_A_TURN, MOST_COGGING};
use nalgebra::Complex;

use crate::{
    drive_loop::metres_per_radian,
    estimate::Estimate,
    proposal::digits,
    refusal::Refusal,
    rigid::{Rigid, limits, run},
    stand::{Bench, Row, Stand},
};

/// Speed of the runs, turns per s.
const SPEED: f64 = 0.4;
/// Most turns of a run that are evaluated, and what comes before and after them.
const TURNS: usize = 2;
const MARGIN: f64 = 0.25;
/// Half width of a look, s.
const LOOK_S: f64 = 2.5e-3;
/// What is proposed is so many of its deviations, and such a share of the torque limit.
const SEEN: f64 = 5.0;
const LEAST: f64 = 5e-4;

/// How often a turn is looked at.
const HARMONICS: usize = MOST_A_TURN as usize;

/// A torque that comes back so often a turn of the motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// How often.
    pub times: u32,
    /// Its amplitude.
    pub torque_nm: Estimate,
    /// Its phase where the position is 0 (M133).
    pub phase_deg: Estimate,
}

impl Wave {
    /// As `cogging` of `[axis.*]` has it, with the digits that a machine file shall show.
    pub(crate) fn row(&self) -> [f64; 3] {
        let degrees = (10.0 * self.phase_deg.value).round() / 10.0 + 0.0;
        [f64::from(self.times), digits(self.torque_nm.value, 3), degrees]
    }
}

/// Torque of cogging at an angle in turns.
pub(crate) fn torque_nm(rows: &[[f64; 3]], turns: f64) -> f64 {
    let wave = |[times, nm, deg]: &[f64; 3]| nm * libm::sin(TAU * times * turns + deg.to_radians());
    rows.iter().map(wave).sum()
}

/// Runs some turns from 0 towards `reach_mm` (signed) and back; `None` where there is no room for a turn.
pub(crate) fn measure<B: Bench>(
    stand: &mut Stand<B>,
    config: &AxisConfig,
    rigid: &Rigid,
    reach_mm: f64,
) -> Result<Option<Vec<Wave>>, Refusal> {
    let (lead, limits) = (config.screw_lead_mm, limits(config));
    let turns = ((reach_mm.abs() / lead - 2.0 * MARGIN).max(0.0) as usize).min(TURNS);
    if turns == 0 {
        return Ok(None);
    }
    let end = ((turns as f64 + 2.0 * MARGIN) * lead).copysign(reach_mm);
    let mut seen = Vec::new();
    for [from, to] in [[0.0, end], [end, 0.0]] {
        let rows = run(stand, [from, to], (SPEED * lead).min(limits.v), &limits, |_| 0.0)?;
        let looks = looks(&rows, stand.cycle_s(), config, rigid.mass_kg.value);
        let start = from + (MARGIN * lead).copysign(to - from);
        for turn in 0..turns {
            let gone = |look: &Look| (look.motor_mm - start) * (to - from).signum() / lead - turn as f64;
            let turn: Vec<_> = looks.iter().filter(|look| (0.0..1.0).contains(&gone(look))).collect();
            seen.push(waves(&turn, stand.start_mm(), lead));
        }
    }
    Ok(Some(standing_out(&seen, config.torque_limit_nm)))
}

/// A look at the motor.
struct Look {
    motor_mm: f64,
    way_mm: f64,
    /// d.
    torque_nm: f64,
}

/// Looks of a run (M133).
fn looks(rows: &[Row], cycle_s: f64, config: &AxisConfig, mass_kg: f64) -> Vec<Look> {
    let half = (LOOK_S / cycle_s).round().max(1.0) as usize;
    let (n, inertia) = (half as f64, 1e-3 * mass_kg * metres_per_radian(config));
    let look = |rows: &[Row]| {
        let share = |i: usize| (half - i.abs_diff(half)) as f64 / (n * n);
        let torque_nm: f64 = rows.iter().enumerate().map(|(i, row)| share(i) * row.torque_nm).sum();
        let [first, middle, last] = [0, half, 2 * half].map(|i| rows[i].motor_mm);
        let acceleration = (last - 2.0 * middle + first) / (n * cycle_s * n * cycle_s);
        Look {
            motor_mm: middle,
            way_mm: (last - first).abs() / (2.0 * n),
            torque_nm: torque_nm - inertia * acceleration,
        }
    };
    rows.windows(2 * half + 1).map(look).collect()
}

/// c for each n from 1 on, of the looks of a turn.
fn waves(looks: &[&Look], start_mm: f64, lead_mm: f64) -> [Complex<f64>; HARMONICS] {
    let way_mm: f64 = looks.iter().map(|look| look.way_mm).sum();
    let mean_nm = looks.iter().map(|look| look.way_mm * look.torque_nm).sum::<f64>() / way_mm;
    let mut sums = [Complex::from(0.0); HARMONICS];
    for Look { motor_mm, way_mm: here_mm, torque_nm } in looks {
        let (sin, cos) = libm::sincos(TAU * (start_mm + motor_mm) / lead_mm);
        let turned = Complex::new(cos, -sin);
        let mut term = Complex::from(2.0 * here_mm / way_mm * (torque_nm - mean_nm));
        for sum in &mut sums {
            term *= turned;
            *sum += term;
        }
    }
    sums
}

/// Waves that stand out of their scatter, the largest if there are too many.
fn standing_out(seen: &[[Complex<f64>; HARMONICS]], limit_nm: f64) -> Vec<Wave> {
    let count = seen.len() as f64;
    let wave = |i: usize| {
        let mean = seen.iter().map(|waves| waves[i]).sum::<Complex<f64>>() / count;
        let scatter: f64 = seen.iter().map(|waves| (waves[i] - mean).norm_sqr()).sum();
        let (value, deviation) = (mean.norm(), (scatter / (count * (count - 1.0))).sqrt());
        let degrees = libm::atan2(mean.re, -mean.im).to_degrees();
        Wave {
            times: i as u32 + 1,
            torque_nm: Estimate { value, deviation },
            phase_deg: Estimate { value: degrees, deviation: (deviation / value).to_degrees() },
        }
    };
    let all: [Wave; HARMONICS] = array::from_fn(wave);
    let stands_out = |wave: &&Wave| {
        let Estimate { value, deviation } = wave.torque_nm;
        value > SEEN * deviation && value > LEAST * limit_nm
    };
    let mut waves: Vec<Wave> = all.iter().filter(stands_out).copied().collect();
    waves.sort_by(|a, b| b.torque_nm.value.total_cmp(&a.torque_nm.value));
    waves.truncate(MOST_COGGING);
    waves.sort_by_key(|wave| wave.times);
    waves
}
