//! The rows against the reference values (`tests/reference/feed_profile.json`), and what is said of
//! misprints.

use motion::Limits;
use serde_json::Value;

use super::{LIMITS, RampFigures, Row, block, ramp, rows};

/// A list of `feed_profile.json`.
fn reference(list: &str) -> Vec<Value> {
    let file: Value = testing::reference::read("feed_profile.json");
    let cases = file[list].as_array().expect("a list").clone();
    assert!(!cases.is_empty(), "no {list}");
    cases
}

fn number(case: &Value, key: &str) -> f64 {
    case[key].as_f64().unwrap_or_else(|| panic!("{key} in {case}"))
}

fn limits(case: &Value) -> Limits {
    Limits {
        v: f64::INFINITY,
        a: number(case, "a_max_m_s2"),
        j: number(case, "j_max_m_s3"),
        dj: number(case, "dj_max_m_s4"),
    }
}

/// Equal to a millionth: the times of a short block come from a root.
fn same(what: &str, case: &Value, got: f64, want: f64) {
    assert!((got - want).abs() <= 1e-6 * want.abs() + 1e-12, "{}: {what}: {got} for {want}", case["id"]);
}

fn same_ramp(case: &Value, got: &RampFigures, want: &Value) {
    same("j_p", case, got.j_p, number(want, "j_p_m_s3"));
    same("t1", case, got.t1, number(want, "t1_s"));
    same("t2", case, got.t2, number(want, "t2_s"));
    same("t_p", case, got.t_p, number(want, "t_p_s"));
}

#[test]
fn reference_ramps_are_rows() {
    for case in reference("ramps") {
        let row =
            ramp(number(&case, "f0_m_s"), number(&case, "f_m_s"), &limits(&case)).expect("it is feasible");
        same_ramp(&case, &row.start, &case);
        same("a_peak", &case, row.start.a_peak, number(&case, "a_peak_m_s2"));
        same("dj_peak", &case, row.start.dj_peak, number(&case, "dj_peak_m_s4"));
        same("length_m", &case, row.length_m, number(&case, "s_tp_m"));
        same("total_time_s", &case, row.total_time_s, number(&case, "t_p_s"));
        same("peak_feed", &case, row.peak_feed, number(&case, "f_m_s"));
        same("v(t1)", &case, row.block.at(row.start.t1).v, number(&case, "v_t1_m_s"));
        same("v(t2)", &case, row.block.at(row.start.t2).v, number(&case, "v_t2_m_s"));
    }
}

#[test]
fn reference_blocks_are_rows() {
    for case in reference("blocks") {
        let feeds = ["f0_m_s", "f_m_s", "f_end_m_s"].map(|key| number(&case, key));
        let row = block(number(&case, "length_m"), feeds, &limits(&case));
        let feasible = case["status"].as_str().is_some_and(|status| status.ends_with("_feed"));
        assert_eq!(row.is_ok(), feasible, "{}", case["id"]);
        let Ok(row) = row else { continue };
        same("peak_feed", &case, row.peak_feed, number(&case, "peak_feed_m_s"));
        same("total_time_s", &case, row.total_time_s, number(&case, "total_time_s"));
        same("cruise_time_s", &case, row.cruise_time_s, number(&case, "cruise_time_s"));
        same_ramp(&case, &row.start, &case["accel"]);
        same_ramp(&case, row.end.as_ref().expect("every one ends with a ramp"), &case["decel"]);
    }
}

/// The examples that are printed are those of the reference.
#[test]
fn reference_examples_are_printed() {
    let rows = rows().expect("they are feasible");
    let inputs = |row: &Row| [row.f0, row.f, row.a_max, row.j_max, row.dj_max];
    let mut found = 0;
    for case in reference("ramps") {
        let number_of = |case: &Value| case["id"].as_str()?.strip_prefix("example ")?.parse::<usize>().ok();
        let Some(example) = number_of(&case) else { continue };
        let row = rows.iter().find(|row| row.example == Some(example)).expect("it is printed");
        let keys = ["f0_m_s", "f_m_s", "a_max_m_s2", "j_max_m_s3", "dj_max_m_s4"];
        assert_eq!(inputs(row), keys.map(|key| number(&case, key)), "example {example}");
        found += 1;
    }
    assert_eq!(found, 3, "examples in the reference");
}

#[test]
fn the_right_figures_stand_beside_the_misprints() {
    let rows = rows().expect("they are feasible");
    let of = |row: &Row| row.corrections.iter().map(|c| c.sentence()).collect::<Vec<_>>();
    for row in rows.iter().filter(|row| row.example.is_some()) {
        assert!(of(row)[0].contains("printed 5.64, right 11.2838."), "{:?}", of(row));
        // What would follow from the misprint is not what is computed: another bound is active.
        assert!(row.start.j_p < 5.64);
    }
    assert!(of(&rows[0])[1].contains("right 0.05, 0.15, 0.2."), "{:?}", of(&rows[0]));
    assert!(rows[3..].iter().all(|row| row.example.is_none() && row.corrections.is_empty()));
}

/// The blocks show every kind: programmed feed reached and not, equal and different ends, each bound of a
/// short one.
#[test]
fn the_blocks_keep_their_limits_and_show_both_kinds() {
    let rows = rows().expect("they are feasible");
    let blocks = &rows[3..];
    assert!(
        blocks.iter().any(|row| row.peak_feed == row.f) && blocks.iter().any(|row| row.peak_feed < row.f)
    );
    for row in blocks {
        let peak = row.block.peak();
        assert!(peak.a <= LIMITS.a && peak.j <= LIMITS.j && peak.dj <= LIMITS.dj, "{peak:?}");
    }
}
