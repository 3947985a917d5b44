//! Stiffness of friction before it slides, from reversals of some micrometres. In: torque and position over
//! slow strokes. Out: N/mm.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | F | N | friction: measured force without mass, viscous and constant part, and without known cogging |
//! | z, L | mm | deflection, and the one at which friction slides |
//! | s0 | N/mm | stiffness; s0 L is the friction at which it breaks away |
//!
//! ```text
//! F = s0 z,   dz = dx − |dx| z/L,  so over a stretch of one direction  z → ±L + (z ∓ L) exp(−|dx|/L)   (M79)
//! ```
//! For a given L the path z follows from the measured positions alone, and s0 is linear: it is eliminated,
//! and L found by search. Torque and position are means over 10 ms: of a count that toggles, a mean keeps a
//! small part. The axis slides slowly before the first reversal, so z is known there. Several frictions one
//! behind the other are not one spring: the deviation is half the difference between what the wider and what
//! the narrower strokes say, and a share of the value, which is what one spring misses of two.

use core::ops::Range;

use machine::AxisConfig;
use motion::{Limits, Sample, Stroke};

use crate::{
    drive_loop::metres_per_radian,
    estimate::Estimate,
    refusal::Refusal,
    rigid::{Rigid, run},
    stand::{Bench, Row, Stand},
};

/// Slow slide before the reversals: way in mm, speed in mm/s.
const SLIDE: (f64, f64) = (0.3, 0.5);
/// Strokes of the reversals, mm, each forth and back.
const STROKES: [f64; 4] = [0.05, 0.025, 0.012, 0.006];
/// Duration of a stroke, s.
const STROKE_S: f64 = 0.25;
/// Length of a mean, s.
const MEAN_S: f64 = 0.01;
/// Lengths among which L is sought, mm.
const LENGTHS: (f64, f64) = (2e-4, 1.0);
/// Relative error of one spring in the place of several.
const SPRING_ERROR: f64 = 0.15;
/// Friction below this many of its deviations is none.
const SEEN: f64 = 3.0;

/// What the reversals told.
#[derive(Clone, Debug)]
pub(crate) struct Presliding {
    /// None without friction that could be told from noise.
    pub(crate) stiffness_n_mm: Option<Estimate>,
    /// Friction at which it breaks away, N.
    pub(crate) breakaway_n: f64,
    /// Friction against position, mm and N.
    pub(crate) loops: Vec<[f64; 2]>,
}

/// Makes the strokes from 0 and evaluates them; `None` if they do not determine a stiffness.
pub(crate) fn measure<B: Bench>(
    stand: &mut Stand<B>,
    config: &AxisConfig,
    rigid: &Rigid,
    limits: &Limits,
) -> Result<Option<Presliding>, Refusal> {
    let (way, speed) = SLIDE;
    let mut rows = run(stand, [0.0, way], speed, limits, |_| 0.0)?;
    // What came before the slide has no part in the reversals.
    rows.drain(..rows.len() / 2);
    let mut at = way;
    for stroke in STROKES {
        for signed in [-stroke, stroke] {
            let law = Stroke::new(signed, STROKE_S);
            rows.extend(stand.follow(STROKE_S, |t| Sample { s: at + law.at(t).s, ..law.at(t) }, |_| 0.0)?);
            at += signed;
        }
    }
    run(stand, [at, 0.0], speed, limits, |_| 0.0)?;
    Ok(evaluate(&means(&rows, stand.cycle_s(), metres_per_radian(config), rigid)))
}

/// Means over [`MEAN_S`]: position in mm, friction in N.
fn means(rows: &[Row], cycle_s: f64, metres_per_radian: f64, rigid: &Rigid) -> Vec<[f64; 2]> {
    let length = (MEAN_S / cycle_s).round().max(1.0) as usize;
    let mean = |rows: &[Row], of: fn(&Row) -> f64| rows.iter().map(of).sum::<f64>() / rows.len() as f64;
    let parts = rows.chunks_exact(length);
    let means: Vec<_> = parts
        .map(|part| [mean(part, |row| row.motor_mm), mean(part, |row| row.torque_nm - row.cogging_nm)])
        .collect();
    let step_s = length as f64 * cycle_s;
    let friction = means.windows(3).map(|three| {
        let v = (three[2][0] - three[0][0]) / (2.0 * step_s);
        let a = (three[2][0] - 2.0 * three[1][0] + three[0][0]) / (step_s * step_s);
        let moving = rigid.mass_kg.value * a * 1e-3 + rigid.viscous_n_s_mm.value * v;
        [three[1][0], three[1][1] / metres_per_radian - rigid.constant_n.value - moving]
    });
    friction.collect()
}

/// Deflections along measured positions for a length L, as shares of L. It slides forwards at the start.
fn deflections(points: &[[f64; 2]], length: f64) -> Vec<f64> {
    let mut z = 1.0;
    let mut before = points.first().map_or(0.0, |point| point[0]);
    let step = |point: &[f64; 2]| {
        let dx = point[0] - before;
        before = point[0];
        let sign = if dx < 0.0 { -1.0 } else { 1.0 };
        z = sign + (z - sign) * libm::exp(-dx.abs() / length);
        z
    };
    points.iter().map(step).collect()
}

/// Breakaway force for a length, and the sum of squares that it leaves over a part of the points.
fn breakaway(points: &[[f64; 2]], part: &Range<usize>, length: f64) -> (f64, f64) {
    let (mut fz, mut zz, mut ff) = (0.0, 0.0, 0.0);
    let both = deflections(points, length).into_iter().zip(points);
    for (z, [_, f]) in both.skip(part.start).take(part.len()) {
        fz += f * z;
        zz += z * z;
        ff += f * f;
    }
    let force = if zz > 0.0 { fz / zz } else { 0.0 };
    (force, ff - force * fz)
}

/// Breakaway force and length that leave least over a part of the points.
fn best(points: &[[f64; 2]], part: Range<usize>) -> Option<(f64, f64)> {
    let left = |log_length: f64| breakaway(points, &part, libm::exp(log_length)).1;
    let (low, high) = (libm::log(LENGTHS.0), libm::log(LENGTHS.1));
    let step = (high - low) / 100.0;
    let grid = (0..=100).map(|i| low + step * f64::from(i));
    let near = grid.min_by(|a, b| left(*a).total_cmp(&left(*b)))?;
    let length = libm::exp(smallest(left, near - step, near + step));
    let (force, _) = breakaway(points, &part, length);
    Some((force, length))
}

fn evaluate(points: &[[f64; 2]]) -> Option<Presliding> {
    let (force, length) = best(points, 0..points.len())?;
    let half = points.len() / 2;
    let (wide, narrow) = (best(points, 0..half)?, best(points, half..points.len())?);
    let spread = 0.5 * (wide.0 / wide.1 - narrow.0 / narrow.1).abs();
    let value = force / length;
    let deviation = libm::hypot(spread, SPRING_ERROR * value);
    let (_, left) = breakaway(points, &(0..points.len()), length);
    let noise = (left / points.len().max(1) as f64).sqrt();
    let sound = value.is_finite() && spread.is_finite();
    sound.then(|| Presliding {
        stiffness_n_mm: (force > SEEN * noise).then_some(Estimate { value, deviation }),
        breakaway_n: force,
        loops: points.to_vec(),
    })
}

/// The place of the smallest value between two bounds, by golden section.
fn smallest(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let share = 0.5 * (5f64.sqrt() - 1.0);
    for _ in 0..60 {
        let (left, right) = (high - share * (high - low), low + share * (high - low));
        if f(left) < f(right) { high = right } else { low = left }
    }
    0.5 * (low + high)
}
