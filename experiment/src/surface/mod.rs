//! Experiment `surface`: how far feed ratios miss a curve or a surface, without a correction, with the
//! published one as it is printed, with its signs and with its mixed term put right, and with exact ratios.
//! In: nothing but the constants of `work`. Out: a row for each work, correction and step. µm, mm, %.
//!
//! Source: "An alternative approach to control the shaping of parts with spatially complex surfaces"; its
//! formulas are M36–M45, in `shape`. Every ratio here is computed by the code that moves the machine.

mod figures;
mod machine;
mod machine_figures;
mod maps;
mod misprints;
mod reference;
mod steps;
#[cfg(test)]
mod tests;
mod text;
mod work;

use serde::Serialize;
use shape::Correction;

use report::table::{Column, Place, Table};

use super::{Findings, stand::Stand};
use crate::ExperimentError;
use misprints::Misprint;
use work::Work;

/// Steps of a row, in those that are shown first.
const SCALES: [f64; 5] = [2.0, 1.0, 0.5, 0.25, 0.125];

/// Below this an error is the rounding of positions in double precision, µm.
const ROUNDING_UM: f64 = 1e-6;

/// Inputs and figures of one case.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    surface: &'static str,
    correction: Correction,
    /// Step of the parameter of the path.
    h_mm: f64,
    /// Whether X leads; else the axis with the largest way.
    x_leads: bool,
    max_next_point_um: f64,
    /// The same along the normal of the surface.
    max_next_normal_um: f64,
    max_accumulated_um: f64,
    max_over_step_um: f64,
    max_plan_um: f64,
    /// Feed along the work with steps of `h_mm` along it: least and largest, less what is asked for.
    feed_min_pct: f64,
    feed_max_pct: f64,
}

impl Row {
    fn of(work: &Work, correction: Correction, h_mm: f64, x_leads: bool) -> Row {
        let (most, _) = steps::misses(work, correction, h_mm, x_leads);
        let feed = steps::feed(work, correction, h_mm, x_leads);
        let of_feed = |pick: fn(f64, f64) -> f64| feed.iter().map(|(_, error)| 100.0 * error).reduce(pick);
        Row {
            surface: work.text.name,
            correction,
            h_mm,
            x_leads,
            max_next_point_um: 1e3 * most.next,
            max_next_normal_um: 1e3 * most.next_normal,
            max_accumulated_um: 1e3 * most.accumulated,
            max_over_step_um: 1e3 * most.over_step,
            max_plan_um: 1e3 * most.plan,
            feed_min_pct: of_feed(f64::min).unwrap_or_default(),
            feed_max_pct: of_feed(f64::max).unwrap_or_default(),
        }
    }

    /// Largest magnitude of the error of the feed, %.
    fn feed_pct(&self) -> f64 {
        self.feed_max_pct.max(-self.feed_min_pct)
    }
}

/// The name of a correction in JSON and in job files.
fn name(correction: Correction) -> &'static str {
    match correction {
        Correction::None => "none",
        Correction::Published => "published",
        Correction::PublishedSigns => "published-signs",
        Correction::Mixed => "mixed",
        Correction::Exact => "exact",
    }
}

/// Three significant digits; what is rounding is said to be nothing but that.
fn three(value: f64) -> String {
    if value != 0.0 && value.abs() < 1e-3 {
        return format!("{value:.1e}");
    }
    format!("{value:.2e}").parse::<f64>().unwrap_or(value).to_string()
}

/// An error in µm, or that it is rounding.
fn um(value: f64) -> String {
    if value < ROUNDING_UM { "rounding".into() } else { three(value) }
}

/// Everything that was computed.
struct Computed {
    works: Vec<Work>,
    rows: Vec<Row>,
    /// X leading on works where otherwise the largest way leads.
    x_leads: Vec<Row>,
    misprints: Vec<Misprint>,
}

impl Computed {
    fn new() -> Result<Computed, ExperimentError> {
        let works = work::all()?;
        let cases = works.iter().flat_map(|work| Correction::ALL.map(|correction| (work, correction)));
        let rows = cases.flat_map(|(work, correction)| {
            let of = move |scale| Row::of(work, correction, scale * work.text.h_mm, work.text.x_leads);
            SCALES.map(of)
        });
        let swapped = works.iter().filter(|work| work.text.name == STEEP);
        let led = swapped.flat_map(|work| {
            Correction::ALL.map(|correction| Row::of(work, correction, work.text.h_mm, true))
        });
        let misprints = works.iter().find(|work| work.text.name == MISPRINTED).map(misprints::all);
        let (rows, x_leads) = (rows.collect(), led.collect());
        Ok(Computed { rows, x_leads, misprints: misprints.unwrap_or_default(), works })
    }

    fn work(&self, name: &str) -> Option<&Work> {
        self.works.iter().find(|work| work.text.name == name)
    }

    /// The row of a work with its first step, times a factor.
    fn row(&self, name: &str, correction: Correction, scale: f64) -> Option<&Row> {
        let h = self.work(name)?.text.h_mm * scale;
        self.rows.iter().find(|row| row.surface == name && row.correction == correction && row.h_mm == h)
    }

    /// Power of the step with which an error falls from the step that is shown first to a quarter of it;
    /// `None` where it is rounding.
    fn order(&self, row: &Row, of: fn(&Row) -> f64) -> Option<f64> {
        let finer = self.row(row.surface, row.correction, 0.25).map(of)?;
        (finer > ROUNDING_UM).then(|| 0.5 * libm::log2(of(row) / finer))
    }
}

/// The work on which the misprints are shown: its second derivatives are constant, and none is zero.
const MISPRINTED: &str = "quad_twist";

/// The work on which leaders are compared: it goes from level to steep.
const STEEP: &str = "circle";

/// Computes the rows with what is to be said and drawn of them.
///
/// # Errors
/// The small mill does not make the wave.
pub(super) fn findings(stand: &Stand) -> Result<Findings<Row>, ExperimentError> {
    let computed = Computed::new()?;
    let runs = machine::runs(stand)?;
    let mut tables = vec![summary(&computed)];
    tables.extend(computed.work(MISPRINTED).map(|work| misprints::table(work, &computed.misprints)));
    tables.push(leaders(&computed));
    tables.push(machine::table(&runs));
    tables.push(reference::table(&computed).at(Place::Page));
    tables.push(works(&computed).at(Place::Page));
    tables.push(every(&computed).at(Place::Details));
    Ok(Findings {
        title: "Curves and surfaces by feed ratios",
        short: text::short(&computed, &runs),
        done: text::done(),
        tables,
        notes: Vec::new(),
        figures: figures::all(&computed).into_iter().chain(machine_figures::all(&runs)).collect(),
        text: text::meaning(&computed, &runs),
        rows: computed.rows,
    })
}

/// Names and units of columns.
fn columns<const M: usize>(head: [[&str; 2]; M]) -> Vec<[String; 2]> {
    head.map(|column| column.map(str::to_owned)).to_vec()
}

/// A line a work and correction, at the step that is shown first.
fn summary(computed: &Computed) -> Table {
    let shown = computed
        .rows
        .iter()
        .filter(|row| computed.work(row.surface).is_some_and(|work| work.text.h_mm == row.h_mm));
    let order = |row: &Row, of| computed.order(row, of).map_or("–".into(), |order| format!("{order:.1}"));
    let line = |row: &Row| {
        vec![
            row.surface.into(),
            name(row.correction).into(),
            row.h_mm.to_string(),
            um(row.max_next_point_um),
            order(row, |row| row.max_next_point_um),
            um(row.max_accumulated_um),
            order(row, |row| row.max_accumulated_um),
            um(row.max_over_step_um),
            um(row.max_plan_um),
            three(row.feed_pct()),
        ]
    };
    Table {
        title: "Largest deviation from the curve or surface".into(),
        caption: text::summary(),
        head: columns([
            ["work", ""],
            ["correction", ""],
            ["step", "mm"],
            ["next point", "µm"],
            ["order", ""],
            ["accumulated", "µm"],
            ["order", ""],
            ["over the step", "µm"],
            ["plan", "µm"],
            ["feed off by", "%"],
        ]),
        rows: shown.map(line).collect(),
        place: Place::Everywhere,
    }
}

/// What it does if X leads where a slope is steep.
fn leaders(computed: &Computed) -> Table {
    let line = |row: &Row| {
        let other = computed.row(row.surface, row.correction, 1.0);
        let both = |of: fn(&Row) -> String| [of(row), other.map_or("–".into(), of)];
        let figures = [
            both(|row| um(row.max_next_normal_um)),
            both(|row| um(row.max_next_point_um)),
            both(|row| three(row.feed_pct())),
        ];
        [row.surface.into(), name(row.correction).into()]
            .into_iter()
            .chain(figures.into_iter().flatten())
            .collect()
    };
    Table {
        title: "Which axis leads".into(),
        caption: text::leaders(),
        head: columns([
            ["work", ""],
            ["correction", ""],
            ["distance, X leads", "µm"],
            ["largest leads", "µm"],
            ["along Z, X leads", "µm"],
            ["largest leads", "µm"],
            ["feed, X leads", "%"],
            ["largest leads", "%"],
        ]),
        rows: computed.x_leads.iter().map(line).collect(),
        place: Place::Everywhere,
    }
}

/// The works themselves.
fn works(computed: &Computed) -> Table {
    let columns: [Column<&Work>; 6] = [
        Column { name: "work", unit: "", cell: |work| work.text.name.into() },
        Column {
            name: "formula",
            unit: "mm",
            cell: |work| format!("{} = {}", if work.text.is_surface { "z" } else { "y" }, work.text.psi),
        },
        Column {
            name: "path",
            unit: "mm",
            cell: |work| match work.text {
                text if text.is_surface => format!("x = {}, y = {}", text.path[0], text.path[1]),
                text => format!("x = {}", text.path[0]),
            },
        },
        Column { name: "t", unit: "mm", cell: |work| format!("{} … {}", work.text.t[0], work.text.t[1]) },
        Column {
            name: "tool",
            unit: "",
            cell: |work| match work.text.ball_mm {
                0.0 => "a point".into(),
                ball => format!("ball of {ball} mm"),
            },
        },
        Column {
            name: "leads",
            unit: "",
            cell: |work| if work.text.x_leads { "X".into() } else { "largest way".into() },
        },
    ];
    Table::of("The works", &columns, &computed.works.iter().collect::<Vec<_>>()).with_caption(text::works())
}

fn every(computed: &Computed) -> Table {
    let columns: [Column<Row>; 9] = [
        Column { name: "work", unit: "", cell: |row| row.surface.into() },
        Column { name: "correction", unit: "", cell: |row| name(row.correction).into() },
        Column { name: "step", unit: "mm", cell: |row| row.h_mm.to_string() },
        Column { name: "next point", unit: "µm", cell: |row| um(row.max_next_point_um) },
        Column { name: "accumulated", unit: "µm", cell: |row| um(row.max_accumulated_um) },
        Column { name: "over the step", unit: "µm", cell: |row| um(row.max_over_step_um) },
        Column { name: "plan", unit: "µm", cell: |row| um(row.max_plan_um) },
        Column { name: "feed, least", unit: "%", cell: |row| three(row.feed_min_pct) },
        Column { name: "feed, largest", unit: "%", cell: |row| three(row.feed_max_pct) },
    ];
    Table::of("Every step", &columns, &computed.rows).with_caption(text::every())
}
