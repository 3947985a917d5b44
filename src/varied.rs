//! How the speed of the spindle is varied in the passes of a program, for people and for editors. In: what
//! the interpreter notes of passes. Out: a line for passes that follow each other alike; a part of JSON.

use interpreter::PassNote;
use machine::Varied;
use protocol::Variation;
use serde::Serialize;

/// Of one pass, for JSON.
#[derive(Debug, Serialize)]
pub(crate) struct SpeedVariation {
    shape: &'static str,
    /// How far to either side, per cent of the speed.
    percent: f64,
    revolutions: f64,
    /// Lowest and highest speed at 100 % override, 1/min.
    rpm: [f64; 2],
    /// Highest change of the speed, 1/min per s.
    ramp_rpm_s: f64,
    /// Bound on what the thread is off by it at the highest override, µm (M232).
    error_um: f64,
}

impl SpeedVariation {
    /// Of a pass; nothing if its speed is even.
    pub(crate) fn of(note: &PassNote) -> Option<SpeedVariation> {
        note.varied.map(|(variation, varied)| SpeedVariation {
            shape: variation.shape.name(),
            percent: 100.0 * variation.share,
            revolutions: variation.revolutions,
            rpm: varied.rpm,
            ramp_rpm_s: varied.ramp_rpm_s,
            error_um: varied.error_um,
        })
    }
}

/// A line for passes that follow each other and are varied alike.
pub(crate) fn lines(passes: &[PassNote]) -> Vec<String> {
    let alike = passes.chunk_by(|one, other| one.varied == other.varied);
    alike.filter_map(|run| Some(line(run.first()?, run.last()?, run.first()?.varied?))).collect()
}

fn line(first: &PassNote, last: &PassNote, (variation, varied): (Variation, Varied)) -> String {
    let passes = match (first.pass, last.pass) {
        (one, other) if one == other => format!("pass {one}"),
        (one, other) => format!("passes {one} to {other}"),
    };
    let Varied { rpm: [low, high], ramp_rpm_s, error_um, .. } = varied;
    format!(
        "speed varied in {passes}: {} of ±{:.1} % over {} revolutions, S{low:.0} to S{high:.0}, {ramp_rpm_s:.0} 1/min \
         per s at most; at most {error_um:.2} µm of the thread",
        variation.shape.name(),
        100.0 * variation.share,
        variation.revolutions
    )
}
