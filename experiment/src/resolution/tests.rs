//! The published cases against the reference values, and the rows against the reference simulation.

use adviser::resolution::{Required, order};
use machine::Machine;
use protocol::Axis;
use serde_json::Value;

use super::{
    QUANTA_MM, Row,
    measure::foretold,
    published::{FEEDS, G_M_S2, MACHINES, MOTIONS, TOLERANCES_UM, demand},
    reference::{Beside, LONGER_S, PRINTED, as_there, beside},
    series,
};
use crate::stand::Stand;

fn reference() -> Value {
    testing::reference::read("resolution.json")
}

/// The numbers of these keys in every case of a list.
fn inputs(file: &Value, list: &str, keys: &[&str]) -> Vec<Vec<f64>> {
    let cases = file[list].as_array().expect("a list");
    let number = |case: &Value, key: &str| case[key].as_f64().unwrap_or_else(|| panic!("{key} in {case}"));
    cases.iter().map(|case| keys.iter().map(|key| number(case, key)).collect()).collect()
}

/// Every case that is printed is one of the reference, whose figures `motion` is held to. A file with more
/// cases than are printed is as good.
#[test]
fn reference_cases_are_printed() {
    let file = reference();
    assert_eq!(file["g_m_s2"], G_M_S2);
    let feeds = FEEDS.map(|(feed, f, k)| vec![feed, f, k]).to_vec();
    let motions = MOTIONS.map(|(feed, g, jerk, f)| vec![feed, g, jerk, f]).to_vec();
    let machines =
        MACHINES.map(|m| vec![m.feed_mm_min, m.cycle_hz, m.k_f, m.overload_g, m.jerk_m_s3, m.k_j]).to_vec();
    let tolerances = TOLERANCES_UM.map(|um| vec![um]).to_vec();
    let keys = ["f_max_mm_min", "f_cycle_hz", "k_f", "overload_g", "j_max_m_s3", "k_j"];
    for (list, printed, keys) in [
        ("feed_error", feeds, &["feed_mm_min", "f_cycle_hz", "k_per_mm"][..]),
        ("conversion", motions, &["feed_mm_min", "overload_g", "jerk_m_s3", "f_cycle_hz"]),
        ("required_resolution", machines, &keys),
        ("position_order", tolerances, &["p_accur_um"]),
    ] {
        let cases = inputs(&file, list, keys);
        assert!(!cases.is_empty() && printed.iter().all(|case| cases.contains(case)), "{list}: {cases:?}");
    }
}

#[test]
fn reference_steps_are_those_of_the_table() {
    let file = reference();
    let keys =
        ["f_max_mm_min", "f_cycle_hz", "k_f", "df_min_mm_cycle", "da_min_mm_cycle2", "dj_min_mm_cycle3"];
    for case in &MACHINES {
        let (demand, steps) = demand(case);
        let got = Required::of(&demand, &steps);
        let orders = ["df_order_floor", "da_order_floor", "dj_order_floor"];
        let all = inputs(&file, "required_resolution", &keys);
        let found = all
            .iter()
            .position(|row| row[..3] == [case.feed_mm_min, case.cycle_hz, case.k_f])
            .expect("it is there");
        let want = &all[found];
        for (n, (step, want)) in got.steps()[1..].iter().zip(&want[3..]).enumerate() {
            assert!((step / want - 1.0).abs() < 1e-9, "{}: {step} for {want}", case.feed_mm_min);
            assert_eq!(file["required_resolution"][found][orders[n]], order(*step), "{}", case.feed_mm_min);
        }
    }
}

fn stand(seed: u64) -> Stand {
    let machine = Machine::from_toml(include_str!("../../../examples/machines/plain-lathe.toml"));
    Stand { machine: machine.expect("it is the built-in one"), seed, progress: false }
}

fn with(rows: &[Row], quantum_mm: Option<f64>) -> &Row {
    rows.iter().find(|row| row.quantum_mm == quantum_mm).expect("it was run")
}

/// The figures of mathematics: errors in the approach within a fifth from 1e-4 mm on, or as far as one pass
/// of any seed goes; the torque noise within a quarter, which is its last digit.
#[test]
fn under_its_conditions_the_reference_comes_out() {
    let beside = beside(&stand(1)).expect("it runs");
    let rows = as_there(&beside);
    for printed in &PRINTED[..6] {
        let row = with(rows, printed.quantum_mm);
        let [low, high] = printed.approach_um;
        let fine = printed.quantum_mm.is_some_and(|q| q < 2e-4);
        let near = |got: f64, want: f64| (got / want - 1.0).abs() < 0.2;
        let within = row.approach_lowest_um < 0.8 * low && row.approach_highest_um > 0.8 * high;
        assert!(
            if fine { near(row.approach_min_um, low) && near(row.approach_max_um, high) } else { within },
            "{row:?}"
        );
        assert!(
            (row.torque_noise_nm / printed.noise_nm - 1.0).abs() < 0.25,
            "{row:?} for {}",
            printed.noise_nm
        );
        assert!(!fine || (row.end_um - printed.end_um).abs() < 0.25, "{row:?} for {}", printed.end_um);
    }
}

/// What remains with fine positions is the delay of the hold: leads that make up for it take most of it away.
#[test]
fn leads_as_long_as_the_hold_delays_leave_the_least() {
    let beside = beside(&stand(3)).expect("it runs");
    let of = |longer_s: f64| {
        let Beside { rows, .. } = beside.iter().find(|b| b.longer_s == longer_s).expect("it was tried");
        with(rows, Some(1e-6)).approach_abs_um()
    };
    let [short, right, long] = LONGER_S.map(of);
    assert!(right < 1.2 && short > 1.8 * right && long > 1.8 * right, "{short}, {right}, {long}");
}

#[test]
fn finer_quanta_are_quieter_down_to_the_noise_of_the_encoder() {
    let stand = stand(1);
    let rows = series(&stand, &stand.machine, &QUANTA_MM, 0.0).expect("it runs").rows;
    assert_eq!(rows.len(), QUANTA_MM.len() + 1);
    let noise = |q| with(&rows, q).torque_noise_nm;
    assert!(rows[..5].is_sorted_by(|a, b| a.torque_noise_nm > b.torque_noise_nm), "{rows:?}");
    assert!(noise(Some(1e-9)) < 1.3 * noise(None), "{rows:?}");
    let x = &stand.machine.axis[&Axis::X];
    for q in [1e-3, 3e-4] {
        let said = foretold(x, stand.machine.general.cycle_s, q);
        assert!((noise(Some(q)) / said - 1.0).abs() < 0.25, "{q}: {} for {said}", noise(Some(q)));
    }
    for row in &rows[4..9] {
        let finest = with(&rows, Some(1e-9));
        assert!((row.approach_abs_um() - finest.approach_abs_um()).abs() < 0.15, "{row:?}");
    }
}
