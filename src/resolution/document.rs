//! What is needed and what there is, as one JSON document.

use serde::Serialize;

use super::{
    Asked,
    needs::AxisNeeds,
    unseen::{self, Unseen},
    verdict::Verdict,
};
use crate::error::CliError;

/// Version of the document.
const VERSION: u32 = 1;

#[derive(Serialize)]
struct Document {
    version: u32,
    name: String,
    /// Whether every answer is fine.
    fine: bool,
    tolerance: Tolerance,
    axes: Vec<AxisFound>,
    verdicts: Vec<Answer>,
    unseen: Vec<UnseenFound>,
}

#[derive(Serialize)]
struct Tolerance {
    um: f64,
    grade: Option<String>,
    size_mm: Option<f64>,
    radius_mm: Option<f64>,
}

#[derive(Serialize)]
struct AxisFound {
    /// Null: the motion that was given.
    axis: Option<&'static str>,
    unit: &'static str,
    cycle_hz: f64,
    /// One count of the encoder, mm or degrees.
    count: f64,
    quantities: Vec<QuantityFound>,
    differences: Vec<DifferenceFound>,
}

#[derive(Serialize)]
struct QuantityFound {
    quantity: &'static str,
    highest: f64,
    unit: String,
    divided: f64,
    step: f64,
    step_unit: String,
    order: i32,
    /// Null for a position.
    internal: Option<f64>,
    discrepancy: f64,
}

#[derive(Serialize)]
struct DifferenceFound {
    of: &'static str,
    difference: u16,
    unit: String,
    largest: f64,
    rms: f64,
    of_limit_pct: f64,
}

#[derive(Serialize)]
struct Answer {
    what: String,
    has: f64,
    needs: f64,
    unit: String,
    discrepancy: f64,
    fine: bool,
    /// What to change; null where it is fine.
    remedy: Option<String>,
}

/// Lost motion or error of a screw.
#[derive(Serialize)]
struct UnseenFound {
    axis: Option<&'static str>,
    what: &'static str,
    size: f64,
    counts: f64,
    /// How exactly it has to be known.
    within: f64,
    unit: &'static str,
    /// Whether it, and not the count, limits the accuracy.
    limits: bool,
}

/// The document, with its end of line.
pub(super) fn json(asked: &Asked, verdicts: &[Verdict]) -> Result<String, CliError> {
    let parts = &asked.parts;
    let document = Document {
        version: VERSION,
        name: asked.name().into(),
        fine: verdicts.iter().all(Verdict::is_fine),
        tolerance: Tolerance {
            um: parts.um,
            grade: parts.grade.map(|(grade, _)| grade.to_string()),
            size_mm: parts.grade.map(|(_, size_mm)| size_mm),
            radius_mm: parts.radius_mm,
        },
        axes: asked.axes.iter().map(|needs| axis(asked, needs)).collect(),
        verdicts: verdicts.iter().map(answer).collect(),
        unseen: unseen::of(asked).iter().map(behind).collect(),
    };
    let json = serde_json::to_string_pretty(&document);
    json.map(|json| format!("{json}\n")).map_err(|error| CliError::Machine(error.to_string()))
}

fn axis(asked: &Asked, needs: &AxisNeeds) -> AxisFound {
    let quantities = needs.quantities(&asked.steps).map(|quantity| QuantityFound {
        quantity: quantity.name,
        order: quantity.order(),
        highest: quantity.highest,
        unit: quantity.unit,
        divided: quantity.divided,
        step: quantity.step,
        step_unit: quantity.step_unit,
        internal: quantity.internal,
        discrepancy: quantity.discrepancy,
    });
    let differences = needs.differences().map(|difference| DifferenceFound {
        of: difference.of,
        difference: difference.order,
        unit: difference.unit,
        largest: difference.largest,
        rms: difference.rms,
        of_limit_pct: difference.of_limit_pct,
    });
    AxisFound {
        axis: needs.axis.as_ref().map(|(axis, _)| axis.name()),
        unit: needs.unit(),
        cycle_hz: needs.demand.cycle_hz,
        count: needs.encoder.increment_mm(),
        quantities: quantities.into(),
        differences: differences.into(),
    }
}

fn behind(unseen: &Unseen) -> UnseenFound {
    UnseenFound {
        axis: unseen.needs.axis.as_ref().map(|(axis, _)| axis.name()),
        what: unseen.cause.name(),
        size: unseen.size,
        counts: unseen.size / unseen.needs.encoder.increment_mm(),
        within: unseen.within(),
        unit: unseen.needs.unit(),
        limits: unseen.limits(),
    }
}

fn answer(verdict: &Verdict) -> Answer {
    Answer {
        what: verdict.what.clone(),
        has: verdict.has,
        needs: verdict.needs,
        unit: verdict.unit.clone(),
        discrepancy: verdict.has / verdict.needs,
        fine: verdict.is_fine(),
        remedy: Some(verdict.remedy.clone()).filter(|remedy| !remedy.is_empty()),
    }
}
