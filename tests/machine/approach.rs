//! The published experiment on the whole machine: how well X keeps to its law in step with the spindle, for
//! each structure of feedforward, at every override. Bounds in µm.

use crate::shop::Place;
use machine::{Feedforward, Machine, PLAIN_LATHE};
use protocol::Axis;
use rig::{
    observe::{Outcome, ServoError},
    trial::{Trial, program, run},
};
use serde_json::Value;
use sim_plant::Scenario;

const OVERRIDES: [f64; 5] = [120.0, 100.0, 80.0, 60.0, 40.0];

/// Servo error of X in the pass of the experiment, on the built-in machine with another structure.
fn approach(structure: Feedforward, override_pct: f64, seed: u64) -> ServoError {
    let mut machine = Machine::plain();
    let x = machine.axis.get_mut(&Axis::X).expect("it has an X");
    (x.feedforward, x.following_error_mm, x.thread_error_mm) = (structure, 10.0, 10.0);
    on(&machine, override_pct, seed)
}

/// The same on a machine as it is.
fn on(machine: &Machine, override_pct: f64, seed: u64) -> ServoError {
    let items = program(machine, &[Trial::default()]).expect("the machine can follow it");
    let scenario = Scenario::spindle_override(override_pct);
    let seen = run(machine, &items, &scenario, seed, &mut |_| ()).expect("the plant can be");
    assert_eq!(seen.outcome, Outcome::Completed, "{:?}", seen.faults);
    seen.passes[0].x
}

/// Largest magnitude in the approach.
fn largest(error: &ServoError) -> f64 {
    error.approach_max_um.max(-error.approach_min_um)
}

/// Bounds over every override and ten seeds: approach, end, thread from its beginning, thread from one turn
/// on.
#[track_caller]
fn within(machine: &Machine, [approach, end, at_depth, thread]: [f64; 4]) {
    for override_pct in OVERRIDES {
        for seed in 1..=10 {
            let error = on(machine, override_pct, seed);
            let what = format!("{override_pct} %, seed {seed}: {error:?}");
            assert!(largest(&error) <= approach && error.end_um.abs() <= end, "{what}");
            assert!(error.thread_max_abs_um <= at_depth && error.settled_max_abs_um <= thread, "{what}");
        }
    }
}

/// The goal of 0.2 µm in the thread holds from one turn on: before, the error of a mass believed too low dies
/// away.
#[test]
fn the_full_structure_over_ten_seeds() {
    within(&Machine::plain(), [2.0, 0.5, 0.5, 0.2]);
}

/// The built-in lathe, which is as hard as one in a shop.
#[test]
fn the_full_structure_in_a_shop_over_ten_seeds() {
    within(&Machine::default(), [2.0, 0.5, 0.2, 0.2]);
}

#[test]
fn the_tuned_machine_over_ten_seeds() {
    let place = Place::new();
    place.write("plain.toml", PLAIN_LATHE);
    let answer = place.ask(&["tune", "--machine", "plain.toml", "-o", "tuned.toml"]);
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    let text = std::fs::read_to_string(place.at("tuned.toml")).expect("it is written");
    within(&Machine::from_toml(&text).expect("it can be read"), [1.5, 0.3, 0.1, 0.1]);
}

/// The published band is 5 to 12 µm. Speed alone lies in it with every seed, speed and acceleration lie at
/// its lower end.
#[test]
fn differences_of_positions_lie_about_the_published_band() {
    for structure in [Feedforward::DifferenceV, Feedforward::DifferenceVa] {
        for seed in 1..=4 {
            let error = approach(structure, 100.0, seed);
            let least = if structure == Feedforward::DifferenceV { 5.0 } else { 4.5 };
            assert!((least..=12.0).contains(&largest(&error)), "{structure:?}, seed {seed}: {error:?}");
        }
    }
    // Always behind at the end, as in print.
    assert!((-2.0..0.0).contains(&approach(Feedforward::DifferenceVa, 100.0, 1).end_um));
}

/// What is missing costs more, the more is missing.
#[test]
fn each_part_of_the_feedforward_pays() {
    let errors = [
        Feedforward::None,
        Feedforward::DifferenceV,
        Feedforward::AnalyticV,
        Feedforward::AnalyticVaNoLead,
        Feedforward::Full,
    ]
    .map(|structure| largest(&approach(structure, 100.0, 1)));
    assert!(errors[0] > 300.0, "the position loop alone: {errors:?}");
    assert!(errors.windows(2).all(|pair| pair[0] > 1.5 * pair[1]), "{errors:?}");
}

/// The rows of the command, at its one seed, on the built-in lathe.
#[test]
fn the_command_says_the_same() {
    let answer = Place::new().ask(&["experiment", "approach", "--json"]);
    assert_eq!(answer.status, Some(0), "{}", answer.stderr);
    let document: Value = serde_json::from_str(&answer.stdout).expect("one document");
    let rows = document["rows"].as_array().expect("rows");
    let number = |row: &Value, key: &str| row[key].as_f64().unwrap_or_else(|| panic!("{key} in {row}"));
    assert_eq!(rows.len(), 7 * OVERRIDES.len());
    for row in rows.iter().filter(|row| row["structure"] == "full" && row["tuned"] == false) {
        let error = on(&Machine::default(), number(row, "override_pct"), 1);
        // The last digit is lost on the way through JSON.
        assert!((number(row, "approach_min_um") - error.approach_min_um).abs() < 1e-9, "{row}");
        assert!((number(row, "end_um") - error.end_um).abs() < 1e-9, "{row}");
        assert!((0.3..10.0).contains(&number(row, "torque_peak_nm")), "{row}");
    }
    let tuned: Vec<_> = rows.iter().filter(|row| row["tuned"] == true).collect();
    assert_eq!(tuned.len(), OVERRIDES.len());
    for row in tuned {
        assert_eq!(row["structure"], "full");
        assert!(number(row, "end_um").abs() <= 0.3, "{row}");
        assert!(number(row, "at_depth_max_abs_um") <= 0.2, "{row}");
    }
}
