//! Experiment `feed`: ramps of feed with a sin² jerk, and blocks made of them. In: the three examples of the
//! published method, and four blocks. Out: a row for each. Units m and s, as in print. Source: "Формирование
//! гладкого закона изменения рывка на участках разгона-торможения при высокоскоростной обработке на
//! оборудовании с ЧПУ", examples 1–3; its equations are M16–M23.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | f0, f, f_end | m/s | feed at the start, programmed, at the end |
//! | a_max, j_max, dj_max | m/s², m/s³, m/s⁴ | limits of acceleration, jerk, jerk rate |
//! | j_p | m/s³ | peak jerk of the ramp at the start |
//! | t1, t2, t_p | s | of that ramp: end of the first jerk pulse, start of the second, its duration |
//!
//! A published example is a single ramp: the block that ends as soon as it is at its feed.

mod corrections;
mod figures;
#[cfg(test)]
mod tests;

use motion::{Binding, FeedBlock, Limits, Ramp, Unreachable, junction_distance};
use serde::Serialize;

use report::table::{Column, Table, six};

use super::Findings;
use crate::ExperimentError;
use corrections::Correction;

/// Limits of the published examples; they give no limit of speed.
const LIMITS: Limits = Limits { v: f64::INFINITY, a: 0.5, j: 5.0, dj: 400.0 };

/// Feeds of the published examples 1, 2, 3.
const EXAMPLES: [(f64, f64); 3] = [(0.0, 0.2), (0.019, 0.1), (0.018, 0.02)];

/// Length and the feeds at the start, programmed, at the end of the blocks.
const BLOCKS: [(f64, [f64; 3]); 4] =
    [(0.2, [0.0, 0.2, 0.0]), (0.05, [0.0, 0.2, 0.0]), (0.1, [0.05, 0.15, 0.02]), (0.01, [0.1, 0.2, 0.1])];

/// Inputs and figures of one case.
#[derive(Debug, Serialize)]
pub(super) struct Row {
    #[serde(skip_serializing_if = "Option::is_none")]
    example: Option<usize>,
    f0: f64,
    f: f64,
    f_end: f64,
    length_m: f64,
    a_max: f64,
    j_max: f64,
    dj_max: f64,
    #[serde(flatten)]
    start: RampFigures,
    peak_feed: f64,
    total_time_s: f64,
    cruise_time_s: f64,
    /// The ramp at the end, if the feed falls there.
    #[serde(skip_serializing_if = "Option::is_none")]
    end: Option<RampFigures>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    corrections: Vec<Correction>,
    #[serde(skip)]
    block: FeedBlock,
}

/// Figures of one ramp, all 0 if the feed does not change; peaks are magnitudes.
#[derive(Debug, Serialize)]
struct RampFigures {
    j_p: f64,
    t1: f64,
    t2: f64,
    t_p: f64,
    a_peak: f64,
    dj_peak: f64,
    /// What fixes the peak jerk.
    #[serde(skip_serializing_if = "Option::is_none")]
    bound: Option<&'static str>,
}

impl RampFigures {
    fn of(ramp: &Ramp, limits: &Limits) -> RampFigures {
        let peak = ramp.peak();
        let bound = match Ramp::peak_jerk(ramp.dv(), limits).1 {
            Binding::Jerk => "jerk",
            Binding::AccelerationAndJerkRate => "acceleration and jerk rate",
            Binding::JerkRate => "jerk rate",
        };
        RampFigures {
            j_p: peak.j,
            t1: ramp.jerk_interval(),
            t2: ramp.duration() - ramp.jerk_interval(),
            t_p: ramp.duration(),
            a_peak: peak.a,
            dj_peak: peak.dj,
            bound: (ramp.dv() != 0.0).then_some(bound),
        }
    }
}

/// The row of a block of `length` with the feeds at its start, programmed, and at its end (M23).
fn block(length: f64, [f0, f, f_end]: [f64; 3], limits: &Limits) -> Result<Row, Unreachable> {
    let block = FeedBlock::plan(length, f0, f, f_end, limits)?;
    Ok(Row {
        example: None,
        f0,
        f,
        f_end,
        length_m: length,
        a_max: limits.a,
        j_max: limits.j,
        dj_max: limits.dj,
        start: RampFigures::of(block.accel(), limits),
        peak_feed: block.peak_feed(),
        total_time_s: block.duration(),
        cruise_time_s: block.cruise_time(),
        end: (block.decel().dv() != 0.0).then(|| RampFigures::of(block.decel(), limits)),
        corrections: Vec::new(),
        block,
    })
}

/// The row of a single ramp between two feeds (M16–M20).
fn ramp(f0: f64, f: f64, limits: &Limits) -> Result<Row, Unreachable> {
    block(junction_distance(f0, f, limits), [f0, f, f], limits)
}

/// The rows: the published examples with what was misprinted, then the blocks.
fn rows() -> Result<Vec<Row>, Unreachable> {
    let examples = EXAMPLES.iter().zip(1..).map(|(&(f0, f), example)| {
        let row = ramp(f0, f, &LIMITS)?;
        Ok(Row { example: Some(example), corrections: corrections::of(example, &row), ..row })
    });
    examples.chain(BLOCKS.iter().map(|&(length, feeds)| block(length, feeds, &LIMITS))).collect()
}

const COLUMNS: [Column<Row>; 15] = [
    Column { name: "case", unit: "", cell: name },
    Column { name: "f0", unit: "m/s", cell: |row| six(row.f0) },
    Column { name: "f", unit: "m/s", cell: |row| six(row.f) },
    Column { name: "f_end", unit: "m/s", cell: |row| six(row.f_end) },
    Column { name: "length_m", unit: "m", cell: |row| six(row.length_m) },
    Column { name: "a_max", unit: "m/s²", cell: |row| six(row.a_max) },
    Column { name: "j_max", unit: "m/s³", cell: |row| six(row.j_max) },
    Column { name: "dj_max", unit: "m/s⁴", cell: |row| six(row.dj_max) },
    Column { name: "j_p", unit: "m/s³", cell: |row| six(row.start.j_p) },
    Column { name: "t1", unit: "s", cell: |row| six(row.start.t1) },
    Column { name: "t2", unit: "s", cell: |row| six(row.start.t2) },
    Column { name: "t_p", unit: "s", cell: |row| six(row.start.t_p) },
    Column { name: "peak_feed", unit: "m/s", cell: |row| six(row.peak_feed) },
    Column {
        name: "end.t_p",
        unit: "s",
        cell: |row| row.end.as_ref().map_or("–".into(), |end| six(end.t_p)),
    },
    Column { name: "total_time_s", unit: "s", cell: |row| six(row.total_time_s) },
];

fn name(row: &Row) -> String {
    row.example.map_or("block".into(), |example| format!("example {example}"))
}

/// Computes the rows with what is to be said and drawn of them.
///
/// # Errors
/// None for the cases above; what the planner says if it refuses one.
pub(super) fn findings() -> Result<Findings<Row>, ExperimentError> {
    let rows = rows().map_err(|error| ExperimentError::Machine(error.to_string()))?;
    let notes = rows.iter().flat_map(|row| {
        row.corrections.iter().map(move |correction| format!("{}: {}", name(row), correction.sentence()))
    });
    Ok(Findings {
        title: "Feed with a smooth jerk",
        short: vec![
            "Every ramp keeps each of its limits and reaches one of them. The figures of the published examples are \
             reproduced; what is misprinted there is put right in the notes, and changes no result."
                .into(),
        ],
        done: done(),
        notes: notes.collect(),
        tables: vec![Table::of("Ramps and blocks", &COLUMNS, &rows)],
        text: meaning(),
        figures: figures::all(&rows),
        rows,
    })
}

fn done() -> Vec<String> {
    vec![
        "The feed goes from one value to another while the jerk follows sin²: one pulse up, a time of constant \
         acceleration if the limit of acceleration is reached, one pulse down. Examples 1 to 3 are single ramps of the \
         published method, with its limits. A block has a length, a feed at its start, a programmed feed and a feed at \
         its end; it is a ramp, a stretch at constant feed and a ramp. One too short for its programmed feed gets the \
         highest feed it can reach."
            .into(),
        "All figures come from the planner that moves the machine, not from a table. j_p, t1, t2 and t_p are those of \
         the ramp at the start."
            .into(),
    ]
}

fn meaning() -> Vec<(&'static str, Vec<String>)> {
    vec![(
        "What it means",
        vec![
            "Speed, acceleration, jerk and the rate of the jerk are continuous, and each stays within its limit. One \
             limit is reached in every ramp: the jerk itself, the acceleration together with the jerk rate, or, for a \
             small change of feed, the jerk rate alone. So a ramp is the fastest of its family."
                .into(),
            "A sin² pulse has half the mean of a rectangular one. Where the jerk rate does not bind, a ramp takes \
             exactly the time of the fastest one with rectangular jerk at half the limit."
                .into(),
        ],
    )]
}
