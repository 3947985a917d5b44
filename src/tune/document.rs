//! What tuning found, as one JSON document.

use serde::Serialize;
use tune::{Estimate, LoopMargins, Margins, Tuned};

use super::{
    Found,
    change::{self, Change},
    tables::approach_deg,
    trial::Row,
};
use crate::error::CliError;

/// Version of the document.
const VERSION: u32 = 1;

#[derive(Serialize)]
struct Document<'a> {
    version: u32,
    seed: u64,
    axes: Vec<AxisFound>,
    /// Trial passes, before and after; none where the machine cannot make them.
    trial: &'a [Row],
}

#[derive(Serialize)]
struct AxisFound {
    axis: &'static str,
    reach_mm: f64,
    changes: Vec<Change>,
    delay_s: Value,
    lag_s: Value,
    breakaway_n: f64,
    constant_n: Value,
    mode: Option<ModeFound>,
    margins: BeforeAfter,
}

#[derive(Serialize)]
struct Value {
    value: f64,
    deviation: f64,
}

#[derive(Serialize)]
struct ModeFound {
    hz: Value,
    damping: Value,
    slide_kg: Value,
    /// Shortest approach that leaves no more than the wanted residual, and its angle.
    approach_s: Option<f64>,
    approach_delta_c_deg: Option<f64>,
}

#[derive(Serialize)]
struct BeforeAfter {
    before: LoopsFound,
    after: LoopsFound,
}

#[derive(Serialize)]
struct LoopsFound {
    velocity: LoopFound,
    position: LoopFound,
}

/// Null: no crossing within the frequencies that were measured.
#[derive(Serialize)]
struct LoopFound {
    phase_margin_deg: f64,
    gain_margin: f64,
    crossover_hz: f64,
}

impl From<Estimate> for Value {
    fn from(Estimate { value, deviation }: Estimate) -> Value {
        Value { value, deviation }
    }
}

impl From<Margins> for LoopsFound {
    fn from(margins: Margins) -> LoopsFound {
        let found = |LoopMargins { phase_deg, crossover_hz, gain }: LoopMargins| LoopFound {
            phase_margin_deg: phase_deg,
            gain_margin: gain,
            crossover_hz,
        };
        LoopsFound { velocity: found(margins.velocity), position: found(margins.position) }
    }
}

/// The document, with its end of line.
pub(super) fn json(found: &Found) -> Result<String, CliError> {
    let document = Document {
        version: VERSION,
        seed: found.seed,
        axes: found.tuned.iter().map(|tuned| axis(found, tuned)).collect(),
        trial: found.trial.as_ref().map_or(&[], |compared| &compared.rows),
    };
    let json = serde_json::to_string_pretty(&document);
    json.map(|json| format!("{json}\n")).map_err(|error| CliError::Machine(error.to_string()))
}

fn axis(found: &Found, tuned: &Tuned) -> AxisFound {
    AxisFound {
        axis: tuned.axis.name(),
        reach_mm: tuned.reach_mm,
        changes: change::changes(&found.machine.axis[&tuned.axis], tuned),
        delay_s: tuned.delay_s.into(),
        lag_s: tuned.lag_s.into(),
        breakaway_n: tuned.breakaway_n,
        constant_n: tuned.constant_n.into(),
        mode: tuned.mode.map(|mode| ModeFound {
            hz: mode.hz.into(),
            damping: mode.damping.into(),
            slide_kg: mode.slide_kg.into(),
            approach_s: tuned.approach_s,
            approach_delta_c_deg: tuned.approach_s.map(|time_s| approach_deg(found, time_s)),
        }),
        margins: BeforeAfter { before: tuned.before.into(), after: tuned.after.into() },
    }
}
