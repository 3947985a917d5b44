//! The wave on the whole machine: a few lines of `examples/shape/wave.toml`, with a ball of 6 mm on the small
//! mill, with each correction. In: a seed. Out: how far the tip was from the surface that it has to stay on,
//! and its feed; commanded, and true. µm, mm/min, s.

use machine::{Machine, SMALL_MILL};
use protocol::Axis;
use rig::observe::{AxisUsed, TraceReport, Traced};
use shape::Correction;

use super::{name, three};
use crate::{ExperimentError, stand::Stand};
use report::table::{Place, Table};

const JOB: &str = include_str!("../../../examples/shape/wave.toml");
const NAME: &str = "wave.toml";

/// Distance of the lines, in place of the scallop height of the example.
pub(super) const STEP_MM: f64 = 10.0;

/// Control cycles from one point that is drawn to the next.
const EVERY: u64 = 20;

/// One run.
pub(super) struct Run {
    pub(super) correction: Correction,
    pub(super) report: TraceReport,
    /// Time since the first cut in s, X and Y of the true tip in mm from the zero of the formulas, and what
    /// was measured.
    pub(super) curve: Vec<(f64, [f64; 2], Traced)>,
}

/// The example with lines farther apart, and with a correction.
fn job(correction: Correction) -> String {
    let coarse = JOB.replace("scallop_mm = 0.01", &format!("step_mm = {STEP_MM:?}"));
    format!("{coarse}\ncorrection = \"{}\"\n", name(correction))
}

/// Runs the wave with every correction.
///
/// # Errors
/// The machine does not make it.
pub(super) fn runs(stand: &Stand) -> Result<Vec<Run>, ExperimentError> {
    let machine =
        Machine::from_toml(SMALL_MILL).map_err(|error| ExperimentError::Machine(error.to_string()))?;
    stand.each(&Correction::ALL, |correction| run(&machine, *correction, stand.seed))
}

fn run(machine: &Machine, correction: Correction, seed: u64) -> Result<Run, ExperimentError> {
    let (mut seen, mut cycle) = (Vec::new(), 0_u64);
    let report = Stand::cut(machine, NAME, &job(correction), seed, &mut |record, traced| {
        if traced.trace != 0 && cycle.is_multiple_of(EVERY) {
            let at = [Axis::X, Axis::Y].map(|axis| record.truth.axes[axis.index()].slide_mm);
            seen.push((cycle as f64 * machine.general.cycle_s, at, traced));
        }
        cycle += 1;
    })?;
    let from = seen.first().map_or(0.0, |(t, ..)| *t);
    let [x0, y0, _] = report.origin_mm;
    let curve = seen.into_iter().map(|(t, [x, y], traced)| (t - from, [x - x0, y - y0], traced)).collect();
    Ok(Run { correction, report, curve })
}

/// Largest share of a limit that was used, %.
fn limits_pct(report: &TraceReport) -> f64 {
    let of = |used: &AxisUsed| {
        [used.velocity_pct, used.acceleration_pct, used.jerk_pct, used.jerk_rate_pct]
            .into_iter()
            .fold(0.0, f64::max)
    };
    report.limits_used.values().map(of).fold(0.0, f64::max)
}

/// Two ends of a range, µm.
fn span(low: f64, high: f64) -> String {
    format!("{low:+.2} … {high:+.2}")
}

pub(super) fn table(runs: &[Run]) -> Table {
    let line = |run: &Run| {
        let TraceReport { commanded, slide, feed, .. } = &run.report;
        vec![
            name(run.correction).into(),
            span(commanded.low_um, commanded.high_um),
            span(slide.low_um, slide.high_um),
            format!("{:.2}", slide.rms_um),
            format!("{:.1}", feed.held_pct),
            format!("{:+.2} … {:+.2}", feed.true_low_pct, feed.true_high_pct),
            three(feed.chord_max_um),
            format!("{:.1}", limits_pct(&run.report)),
        ]
    };
    let head = [
        ["correction", ""],
        ["commanded", "µm"],
        ["true", "µm"],
        ["true, rms", "µm"],
        ["feed held", "% of time"],
        ["true feed off by", "%"],
        ["chord", "µm"],
        ["limits used", "%"],
    ];
    Table {
        title: format!("The wave on the small mill, lines {STEP_MM} mm apart"),
        caption: super::text::machine(),
        head: head.map(|column| column.map(str::to_owned)).to_vec(),
        rows: runs.iter().map(line).collect(),
        place: Place::Everywhere,
    }
}
