//! `pitchlock experiment`: one document, one page that needs nothing else, the table that its documentation
//! shows, and refusals with a remedy.

use std::fs;
use std::sync::OnceLock;

use crate::shop::{Place, project};
use serde_json::Value;

const NAMES: [&str; 10] = [
    "approach",
    "chatter",
    "feed",
    "observer",
    "positioner",
    "profiles",
    "reference",
    "resolution",
    "surface",
    "sweep",
];
/// Those that take less than a second.
const SHORT: [&str; 3] = ["feed", "positioner", "profiles"];

/// What `pitchlock experiment NAME` left.
struct Ran {
    printed: String,
    page: String,
    rows: String,
}

/// An experiment as its documentation runs it; once for all tests, since some take minutes.
fn ran(name: &str) -> &'static Ran {
    static RAN: [OnceLock<Ran>; NAMES.len()] = [const { OnceLock::new() }; NAMES.len()];
    let index = NAMES.iter().position(|other| *other == name).expect("a name");
    RAN[index].get_or_init(|| {
        let place = Place::new();
        let answer = place.ask(&["experiment", name]);
        assert_eq!(answer.status, Some(0), "{name}: {}", answer.stderr);
        let made = |file: &str| {
            fs::read_to_string(place.at("experiments").join(name).join(file)).expect("it is written")
        };
        Ran { printed: answer.stdout, page: made("report.html"), rows: made("rows.json") }
    })
}

/// Its document.
fn document(name: &str) -> Value {
    serde_json::from_str(&ran(name).rows).expect("one document")
}

#[test]
fn json_is_one_document_with_the_rows() {
    let place = Place::new();
    for name in SHORT {
        let answer = place.ask(&["experiment", name, "--json", "--seed", "7", "--out", "made"]);
        assert_eq!(answer.status, Some(0), "{}", answer.stderr);
        let document: Value = serde_json::from_str(&answer.stdout).expect("one document and nothing else");
        assert_eq!((&document["version"], &document["seed"]), (&1.into(), &7.into()));
        assert_eq!(fs::read_to_string(place.at("made/rows.json")).expect("it is written"), answer.stdout);
        assert!(!place.at("experiments").exists(), "--out says where");
    }
    for name in NAMES {
        let document = document(name);
        assert_eq!(document["experiment"], name);
        assert_eq!((&document["version"], &document["seed"]), (&1.into(), &1.into()));
        assert!(document["rows"].as_array().is_some_and(|rows| !rows.is_empty()));
    }
}

#[test]
fn a_row_of_feed_has_its_inputs_and_figures() {
    let document = document("feed");
    let rows = document["rows"].as_array().expect("rows");
    let keys = "f0 f f_end length_m a_max j_max dj_max j_p t1 t2 t_p peak_feed total_time_s";
    for row in rows {
        assert!(keys.split(' ').all(|key| row[key].is_f64()), "{row}");
    }
    let examples: Vec<_> = rows.iter().filter_map(|row| row["example"].as_u64()).collect();
    assert_eq!(examples, [1, 2, 3]);
}

#[test]
fn a_row_of_profiles_has_its_inputs_and_figures() {
    let document = document("profiles");
    let rows = document["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 6 * 4 * 61);
    for row in rows {
        let keys = ["approach_s", "mode_hz", "stroke_mm", "residual_um"];
        assert!(keys.iter().all(|key| row[key].is_f64()) && row["profile"].is_string(), "{row}");
        let (residual, bound) = (row["residual_um"].as_f64().expect("a number"), &row["bound_um"]);
        if row["profile"] == "sin2-acceleration" {
            assert!(residual <= bound.as_f64().expect("a number"), "{row}");
        } else {
            assert!(bound.is_null(), "{row}");
        }
    }
}

#[test]
fn a_row_of_surface_has_its_inputs_and_figures() {
    let document = document("surface");
    let rows = document["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 7 * 5 * 5);
    let keys = "h_mm max_next_point_um max_next_normal_um max_accumulated_um max_over_step_um max_plan_um feed_min_pct \
                feed_max_pct";
    for row in rows {
        assert!(keys.split(' ').all(|key| row[key].is_f64()) && row["surface"].is_string(), "{row}");
        if row["correction"] == "exact" {
            assert!(row["max_next_point_um"].as_f64().is_some_and(|um| um < 1e-6), "{row}");
        }
    }
}

#[test]
fn a_row_of_reference_has_its_inputs_and_figures() {
    let document = document("reference");
    let rows = document["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 9 * 3);
    let figures = ["approach_min_um", "approach_max_um", "end_um", "thread_max_abs_um"];
    for row in rows {
        assert!(row["structure"].is_string() && row["override_pct"].is_f64(), "{row}");
        for key in figures {
            assert!(row[key].is_f64() && row[format!("reference_{key}")].is_f64(), "{row}");
        }
    }
    // All but a row or two at the edge of what the seeds spread over.
    let agree = rows.iter().filter(|row| row["agrees"] == true).count();
    assert!(agree >= 24, "{agree} of 27 rows agree: {rows:?}");
    let refused = Place::new().ask(&["experiment", "reference", "--machine", "lathe.toml"]);
    assert_eq!(refused.status, Some(2), "it has a machine of its own: {}", refused.stderr);
}

#[test]
fn a_row_of_chatter_has_its_inputs_and_figures() {
    let document = document("chatter");
    let rows = document["rows"].as_array().expect("rows");
    let keys = "rpm waves lobes_mm even_mm percent revolutions sine_mm triangle_mm random_mm gain";
    assert!(rows.iter().all(|row| keys.split(' ').all(|key| row[key].is_f64())));
    let number = |row: &Value, key: &str| row[key].as_f64().expect("a number");
    for row in rows {
        let (even, lobes) = (number(row, "even_mm"), number(row, "lobes_mm"));
        assert!((even / lobes - 1.0).abs() < 0.03, "{row}");
    }
    let named = rows.iter().find(|row| number(row, "rpm") == 240.0).expect("the speed that is named");
    assert!(number(named, "gain") >= 1.3, "{named}");
    assert!(rows.iter().any(|row| number(row, "gain") < 1.02), "it does not help everywhere");
    let page = &ran("chatter").page;
    assert!(page.contains("It does not help everywhere") && page.contains("Stability chart"));
}

#[test]
fn a_row_of_sweep_has_its_inputs_and_figures() {
    let document = document("sweep");
    let rows = document["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 10 * 4 * 2 * 3 * 3);
    let keys = "s_rpm delta_x_mm delta_c_deg override_pct mass_error_pct friction_error_pct approach_max_abs_um \
                end_um thread_max_abs_um";
    for row in rows {
        assert!(keys.split(' ').all(|key| row[key].is_f64()) && row["seed"].is_u64(), "{row}");
    }
}

#[test]
fn every_page_stands_alone() {
    for name in NAMES {
        let Ran { printed, page, .. } = ran(name);
        assert!(printed.ends_with(&format!("report  experiments/{name}/report.html\n")), "{printed}");
        let before_the_library = page.split("</main>").next().unwrap_or_default();
        for needed in
            ["What was done", "What it means", "How to repeat it", "--seed 1", "<figure>", "aria-label"]
        {
            assert!(before_the_library.contains(needed), "{name}: {needed} is missing");
        }
        for foreign in ["http://", "https://", "<link", " src="] {
            assert!(!before_the_library.contains(foreign), "{name}: {foreign} in the page");
        }
    }
}

#[test]
fn a_row_of_resolution_has_its_inputs_and_figures() {
    let document = document("resolution");
    let rows = document["rows"].as_array().expect("rows");
    let quanta: Vec<_> = rows.iter().filter_map(|row| row["quantum_mm"].as_f64()).collect();
    assert_eq!(quanta, [1e-2, 1e-3, 3e-4, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9]);
    let keys = ["approach_min_um", "approach_max_um", "end_um", "torque_noise_nm"];
    for row in rows {
        assert!(keys.iter().all(|key| row[key].is_f64()), "{row}");
    }
}

#[test]
fn a_row_of_observer_has_its_inputs_and_figures() {
    let document = document("observer");
    let rows = document["rows"].as_array().expect("rows");
    let keys = ["bandwidth_hz", "lead_mm", "observer_max_abs_um", "observer_worst_um", "m53_max_abs_um"];
    for row in rows {
        assert!(keys.iter().all(|key| row[key].is_f64()) && row["lines"].is_u64(), "{row}");
        // A turn of the slow case takes minutes; with 25 lines the machine may stop in the pass.
        let may_miss = row["case"] == "slow" || row["lines"] == 25;
        assert!(row["helix_max_abs_um"].is_f64() || (may_miss && row["helix_max_abs_um"].is_null()), "{row}");
    }
    // With the machine's own encoder and observer every case was cut.
    let own_hz = machine::Machine::default().spindle.observer_hz;
    let own: Vec<_> =
        rows.iter().filter(|row| row["lines"] == 2500 && row["bandwidth_hz"] == own_hz).collect();
    assert_eq!(own.len(), 5);
    assert!(own.iter().all(|row| row["helix_max_abs_um"].is_f64()), "{own:?}");
}

#[test]
fn a_row_of_positioner_has_its_inputs_and_figures() {
    let document = document("positioner");
    let rows = document["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 6 * 3);
    let three = |value: &Value| -> Vec<f64> {
        let numbers = value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect::<Vec<_>>();
        assert_eq!(numbers.len(), 3, "{value}");
        numbers
    };
    for row in rows {
        let inputs = ["part_mm", "linear_error_mm", "angular_error_deg"];
        assert!(inputs.iter().all(|key| row[key].is_f64()), "{row}");
        let [published, tight, attained, sampled] =
            ["published_um", "tight_um", "attained_um", "sampled_max_um"].map(|key| three(&row[key]));
        for axis in 0..3 {
            assert!(tight[axis] <= published[axis] * (1.0 + 1e-12), "{row}");
            assert!((attained[axis] / tight[axis] - 1.0).abs() < 1e-4, "{row}");
            assert!(sampled[axis] > 0.6 * tight[axis] && sampled[axis] < 1.0001 * tight[axis], "{row}");
        }
    }
}

#[test]
fn the_page_has_everything_in_it() {
    let place = Place::new();
    let answer = place.ask(&["experiment", "feed", "--seed", "3", "--out", "feed"]);
    assert!(answer.stdout.ends_with("report  feed/report.html\n"), "{}", answer.stdout);
    let page = fs::read_to_string(place.at("feed/report.html")).expect("it is written");
    assert_eq!(page.matches("<figure>").count(), 4);
    for needed in [
        "What was done",
        "What it means",
        "How to repeat it",
        "--seed 3",
        "Plotly.react",
        "dj/dt (m/s⁴)",
        "aria-label",
    ] {
        assert!(page.contains(needed), "{needed} is missing");
    }
    let before_the_library = page.split("</main>").next().unwrap_or_default();
    for foreign in ["http://", "https://", "<link", " src="] {
        assert!(!before_the_library.contains(foreign), "{foreign} in the page");
    }
}

/// The block below the command in `docs/experiments.md` is what the command prints.
#[test]
fn the_documentation_shows_what_is_printed() {
    let page = fs::read_to_string(project().join("docs/experiments.md")).expect("it is there");
    for name in NAMES {
        let shown = format!("```text\n$ pitchlock experiment {name}\n{}```\n", ran(name).printed);
        assert!(page.contains(&shown), "docs/experiments.md should have:\n{shown}");
    }
}

#[test]
fn what_cannot_be_done_is_refused() {
    let place = Place::new();
    place.write("file", "in the way");
    let mill = include_str!("../../examples/machines/small-mill.toml");
    fs::write(place.at("mill.toml"), mill).expect("it can be written");
    let cases: [(&[&str], &[&str]); 11] = [
        (&["experiment", "positioner", "--machine", "mill.toml"], &["mill.toml", "is not a positioner"]),
        (&["experiment", "approach", "--machine", "mill.toml"], &["mill.toml", "lathe"]),
        (&["experiment", "observer", "--machine", "mill.toml"], &["mill.toml", "lathe"]),
        (&["experiment", "resolution", "--machine", "mill.toml"], &["mill.toml", "lathe"]),
        (&["experiment", "sweep", "--machine", "mill.toml"], &["mill.toml", "lathe"]),
        (&["experiment"], &["<NAME>", "--help"]),
        (&["experiment", "frobnicate"], &["frobnicate", "feed"]),
        (&["experiment", "feed", "--seed", "-1"], &["-1"]),
        (&["experiment", "feed", "--seed", "many"], &["many", "--seed"]),
        (&["experiment", "feed", "--out", "file/below"], &["file/below"]),
        (&["experiment", "feed", "--machine", "lathe.toml"], &["feed", "--machine"]),
    ];
    for (arguments, words) in cases {
        let answer = place.ask(arguments);
        assert_eq!(answer.status, Some(2), "{arguments:?}: {}", answer.stderr);
        assert!(words.iter().all(|word| answer.stderr.contains(word)), "{arguments:?}: {}", answer.stderr);
        assert!(answer.stdout.is_empty() && !answer.stderr.contains("panicked"), "{arguments:?}");
    }
}

/// A row of 120 % was cut at 120 %, or there is no row.
#[test]
fn an_override_that_the_machine_does_not_allow_is_named() {
    let place = Place::new();
    let lathe = include_str!("../../examples/machines/small-lathe.toml");
    for key in ["override_max_pct", "design_override_pct"] {
        let less = lathe.replace(&format!("{key} = 120.0"), &format!("{key} = 100.0"));
        assert_ne!(less, lathe);
        fs::write(place.at("less.toml"), less).expect("it can be written");
        let answer = place.ask(&["experiment", "approach", "--machine", "less.toml"]);
        assert_eq!(answer.status, Some(1), "{}", answer.stderr);
        assert!(answer.stderr.contains("120 %") && answer.stderr.contains(key), "{}", answer.stderr);
    }
}
