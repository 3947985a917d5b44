//! Experiment `chatter`: what a varied spindle speed does against regenerative chatter. In: a lathe. Out: a
//! row for each speed: the widest chip that is stable by the lobes, on the plant's own model at an even
//! speed, and at a varied one; and threads cut on the whole machine on either side. mm, 1/min.
//!
//! ```text
//! at each speed  ±30 % over the shortest period that the machine proves (M233), 1.5 … 10 turns;
//!                where that is longer, the largest share over 10 turns                             (M238)
//! ```
//! Ten turns are what a thread has: a variation that is slower is over before it has begun. One turn is too
//! short: each turn would be like the one before, and the delay at each angle always the same. What other
//! periods do is tabled at one speed.

mod figures;
mod lathe;
mod limit;
mod lobes;
mod tables;
#[cfg(test)]
mod tests;
mod text;

use machine::Machine;
use protocol::{Axis, ThreadPass, Variation, VariationShape};
use serde::Serialize;
use sim_plant::ChatterMode;

use super::{Findings, stand::Stand};
use crate::ExperimentError;
use limit::Case;

/// The mode of the tool across the groove: a slender bar.
const MODE: ChatterMode = ChatterMode { stiffness_n_mm: 20_000.0, hz: 120.0, damping: 0.04 };
/// Steel: 2000 N/mm², 1.5 times that for the chip of a V, half of it across the groove; N/mm².
const STIFFNESS_N_MM2: f64 = 2000.0 * 1.5 * 0.5;
/// Lead of the thread, mm.
const LEAD_MM: f64 = 2.0;

/// Share and shortest and longest period of the variations.
const SHARE: f64 = 0.3;
const PERIODS: [f64; 2] = [1.5, 10.0];
/// A share below that is none.
const LEAST_SHARE: f64 = 0.005;

/// The speeds of the chart, 1/min: so many from the first on, each by the same factor faster.
const SPEEDS: (f64, f64, i32) = (90.0, 3000.0, 90);
/// The speed at which threads are cut, and that is named.
const NAMED_RPM: f64 = 240.0;
/// A slow speed, at which the drive can do every one of these periods.
const SLOW_RPM: f64 = 120.0;
const TRIED: [f64; 9] = [0.5, 1.0, 1.25, 1.5, 2.0, 3.0, 4.0, 6.0, 10.0];
/// What is asked of the variation there.
const ASKED: f64 = 1.3;

/// Limits at one speed.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    rpm: f64,
    /// Waves of the mode in a turn.
    waves: f64,
    /// By the lobes (M236).
    lobes_mm: f64,
    /// On the model, at an even speed.
    even_mm: f64,
    /// What the drive can vary by.
    percent: f64,
    revolutions: f64,
    sine_mm: f64,
    triangle_mm: f64,
    random_mm: f64,
    /// The sine against the even speed.
    gain: f64,
}

/// What one period does at the slow speed.
pub(super) struct Period {
    revolutions: f64,
    sine_mm: f64,
    gain: f64,
}

/// The limit at the slow speed under a sine of ±30 % over a period.
fn period(revolutions: f64, seed: u64) -> Result<Period, ExperimentError> {
    let variation = Some(Variation { shape: VariationShape::Sine, share: SHARE, revolutions });
    let case = Case { mode: MODE, stiffness_n_mm2: STIFFNESS_N_MM2, rpm: SLOW_RPM, variation, seed };
    let limit = |case: Case| {
        let none = || ExperimentError::Machine(format!("no limit was found at {SLOW_RPM} 1/min"));
        case.limit_mm(lobes::least_mm(&MODE, STIFFNESS_N_MM2)).ok_or_else(none)
    };
    let (sine_mm, even_mm) = (limit(case)?, limit(Case { variation: None, ..case })?);
    Ok(Period { revolutions, sine_mm, gain: sine_mm / even_mm })
}

/// What the machine can vary by at a speed (M238); nothing if that is hardly anything.
fn strongest(machine: &Machine, rpm: f64) -> Option<Variation> {
    let mut pass =
        ThreadPass { pass: 1, s_rpm: rpm, max_ratio: 2.0, lead_mm: LEAD_MM, ..ThreadPass::default() };
    pass.axes[Axis::Z.index()].lead_mm = LEAD_MM;
    let [shortest, longest] = PERIODS;
    let asked = Variation { shape: VariationShape::Sine, share: SHARE, revolutions: shortest };
    let period = machine.shortest_period(&pass, &asked).filter(|period| *period <= longest);
    let varied = match period {
        Some(revolutions) => Variation { revolutions, ..asked },
        None => {
            let longest = Variation { revolutions: longest, ..asked };
            Variation { share: machine.largest_share(&pass, &longest)?, ..longest }
        }
    };
    (varied.share >= LEAST_SHARE).then_some(varied)
}

/// The limits at a speed.
fn row(machine: &Machine, rpm: f64, seed: u64) -> Result<Row, ExperimentError> {
    let least = lobes::least_mm(&MODE, STIFFNESS_N_MM2);
    let variation = strongest(machine, rpm);
    let case = Case { mode: MODE, stiffness_n_mm2: STIFFNESS_N_MM2, rpm, variation: None, seed };
    let limit = |case: Case| {
        let none = || ExperimentError::Machine(format!("no limit was found at {rpm} 1/min"));
        case.limit_mm(least).ok_or_else(none)
    };
    let even_mm = limit(case)?;
    let of = |shape| match variation {
        Some(variation) => limit(Case { variation: Some(Variation { shape, ..variation }), ..case }),
        None => Ok(even_mm),
    };
    let [sine_mm, triangle_mm, random_mm] =
        [of(VariationShape::Sine)?, of(VariationShape::Triangle)?, of(VariationShape::Random)?];
    Ok(Row {
        rpm,
        waves: MODE.hz * 60.0 / rpm,
        lobes_mm: lobes::limit_mm(&MODE, STIFFNESS_N_MM2, rpm),
        even_mm,
        percent: 100.0 * variation.map_or(0.0, |variation| variation.share),
        revolutions: variation.map_or(0.0, |variation| variation.revolutions),
        sine_mm,
        triangle_mm,
        random_mm,
        gain: sine_mm / even_mm,
    })
}

/// Every speed of the chart, and the one that is named.
fn speeds() -> Vec<f64> {
    let (first, last, count) = SPEEDS;
    let factor = libm::pow(last / first, 1.0 / f64::from(count - 1));
    let mut speeds: Vec<f64> = (0..count).map(|n| first * libm::pow(factor, f64::from(n))).collect();
    speeds.push(NAMED_RPM);
    speeds.sort_by(f64::total_cmp);
    speeds
}

/// Finds the limits, and cuts the threads.
///
/// # Errors
/// The machine does not vary its spindle, or does not cut the threads.
pub(super) fn findings(stand: &Stand) -> Result<Findings<Row>, ExperimentError> {
    let rows = stand.each(&speeds(), |rpm| row(&stand.machine, *rpm, stand.seed))?;
    let periods = stand.each(&TRIED, |revolutions| period(*revolutions, stand.seed))?;
    let threads = lathe::threads(stand)?;
    Ok(Findings {
        title: "A varied spindle speed against chatter",
        short: text::short(&rows, &threads),
        done: text::done(rows.len()),
        tables: tables::all(&rows, &periods, &threads),
        notes: Vec::new(),
        figures: figures::all(&rows, &threads),
        text: text::meaning(&rows, &periods),
        rows,
    })
}
