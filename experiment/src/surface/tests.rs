//! Figures of the experiment against the reference file, closed forms and orders of convergence.

use std::sync::LazyLock;

use serde_json::Value;
use shape::Correction;

use super::{
    Computed, ROUNDING_UM, Row,
    reference::{self, Error},
    steps,
};

static COMPUTED: LazyLock<Computed> =
    LazyLock::new(|| Computed::new().expect("the texts of the works are formulas"));

/// The cases of `shaping.json`.
fn cases() -> Vec<Value> {
    let file: Value = testing::reference::read("shaping.json");
    ["curves", "surfaces"].iter().flat_map(|group| file[group].as_array().expect("cases").clone()).collect()
}

/// The figure of a column in a row of a case.
fn cell(case: &Value, row: &Value, column: &str) -> Option<f64> {
    let columns = case["columns"].as_array().expect("columns");
    row[columns.iter().position(|name| name == column)?].as_f64()
}

/// Our errors beside the columns of the file.
const COLUMNS: [(&str, Error, Correction); 5] = [
    ("dev_uncorrected_mm", Error::Next, Correction::None),
    ("dev_corrected_mm", Error::Next, Correction::PublishedSigns),
    ("dev_mixed_mm", Error::Next, Correction::Mixed),
    ("cum_dev_uncorrected_mm", Error::Accumulated, Correction::None),
    ("cum_dev_corrected_mm", Error::Accumulated, Correction::PublishedSigns),
];

#[test]
fn reference_every_row_of_the_file() {
    let computed = &*COMPUTED;
    let mut cases_seen = 0;
    for case in cases() {
        let mut compared = 0;
        let id = case["id"].as_str().expect("a name");
        let work = computed.work(id).expect("a work of this name");
        let h = work.text.h_mm;
        for (column, error, correction) in COLUMNS {
            let ours = match error {
                Error::Next => steps::next_points(work, correction, h, true),
                Error::Accumulated => steps::misses(work, correction, h, true).1,
            };
            for row in case["rows"].as_array().expect("rows") {
                let Some(want) = cell(&case, row, column) else { continue };
                let at = row[0].as_u64().expect("the number of a step") as usize;
                assert!((ours[at].1 - want).abs() < 1e-13 + 1e-9 * want.abs(), "{id}: {column} of step {at}");
                compared += 1;
            }
        }
        // Every case has at least two of the columns.
        let rows = case["rows"].as_array().map_or(0, Vec::len);
        assert!(rows > 0 && compared >= 2 * rows, "{id}: {compared} of {rows} rows");
        cases_seen += 1;
    }
    assert!(cases_seen > 0, "the file is empty");
}

#[test]
fn reference_figures_of_the_table_are_those_of_the_file() {
    let cases = cases();
    for (work, error, correction, um) in reference::PRINTED {
        let case = cases.iter().find(|case| case["id"] == work).expect("the case");
        let columns = COLUMNS.iter().find(|column| (column.1, column.2) == (error, correction));
        let last = case["rows"].as_array().and_then(|rows| rows.last()).expect("rows");
        let mm = cell(case, last, columns.expect("a column").0).expect("a figure");
        assert!((1e3 * mm - um).abs() <= 1e-12 * um.abs(), "{work} {correction:?}: {mm} mm");
    }
    let differences = reference::pairs(&COMPUTED);
    assert_eq!(differences.len(), reference::PRINTED.len());
    assert!(differences.iter().all(|pair| pair.difference().abs() < 1e-10));
}

#[test]
fn orders_are_those_of_the_text() {
    let computed = &*COMPUTED;
    let order = |work: &str, correction, of: fn(&Row) -> f64| {
        computed.order(computed.row(work, correction, 1.0).expect("the row"), of)
    };
    let next: fn(&Row) -> f64 = |row| row.max_next_point_um;
    let sum: fn(&Row) -> f64 = |row| row.max_accumulated_um;
    let near = |order: Option<f64>, want: f64| order.is_some_and(|order| (order - want).abs() < 0.15);
    for work in ["c1", "c2", "quad_twist", "sin_cos", "saddle", "wave"] {
        assert!(near(order(work, Correction::None, next), 2.0), "{work}");
        assert!(near(order(work, Correction::None, sum), 1.0), "{work}");
        assert!(near(order(work, Correction::Mixed, next), 3.0), "{work}");
        assert!(near(order(work, Correction::Mixed, sum), 2.0), "{work}");
        assert_eq!(order(work, Correction::Exact, next), None, "{work}");
    }
    for work in ["quad_twist", "sin_cos", "wave"] {
        for correction in [Correction::Published, Correction::PublishedSigns] {
            assert!(near(order(work, correction, next), 2.0), "{work} {correction:?}");
        }
    }
}

#[test]
fn exact_ratios_meet_every_reference_point() {
    for row in &COMPUTED.rows {
        if row.correction == Correction::Exact {
            let errors = [row.max_next_point_um, row.max_accumulated_um, row.max_plan_um];
            assert!(errors.iter().all(|um| *um < ROUNDING_UM), "{} {} mm: {errors:?}", row.surface, row.h_mm);
        }
    }
}

#[test]
fn each_misprint_costs_what_the_text_says() {
    let computed = &*COMPUTED;
    assert_eq!(computed.misprints.len(), 6);
    for misprint in &computed.misprints {
        let (what, of) = (misprint.what, misprint.printed / misprint.right);
        assert!(of > 100.0, "{} {what}: {of}", misprint.equation);
        // A wrong sign adds what it should take away.
        if what.starts_with('−') {
            let doubled = misprint.printed / misprint.none;
            assert!((1.5..2.01).contains(&doubled), "{} {what}: {doubled}", misprint.equation);
        }
    }
}

#[test]
fn a_chord_and_a_tangent_of_a_circle_are_as_far_off_as_m44_says() {
    // Steps of 0.5 mm on a radius of 30 mm: l²/8R and l²/2R.
    let computed = &*COMPUTED;
    let over = |correction| computed.row("circle", correction, 1.0).expect("the row").max_over_step_um;
    assert!((over(Correction::Exact) - 0.25e3 / 240.0).abs() < 0.01);
    assert!((over(Correction::None) - 0.25e3 / 60.0).abs() < 0.1);
}

#[test]
fn the_tip_of_the_ball_lies_on_its_surface() {
    let wave = COMPUTED.work("wave").expect("the wave");
    for n in 0..100 {
        let at = [f64::from(n), f64::from(n * 7 % 80)];
        let [x, y, z] = wave.towards(at, [1.0, 0.0]).point(0.0);
        assert!((x - at[0]).abs() > 1e-6 || n == 0, "the tip is beside the contact");
        assert!(wave.over([x, y, z]).iter().all(|off| off.abs() < 1e-12), "{at:?}");
    }
}
