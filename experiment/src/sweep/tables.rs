//! The tables of the sweep. In: rows. Out: figures over all of them, the worst of them by name, figures by
//! belief, by override and by pass, and every row.

use super::{FRICTION_ERRORS, MASS_ERRORS, OVERRIDES, PASSES, Row};
use report::table::{Column, Place, Table};

/// How many of the worst cases are named.
const NAMED: usize = 5;

/// Figures over some of the rows, µm.
pub(super) struct Over {
    name: String,
    cases: usize,
    pub(super) median: f64,
    pub(super) worst: f64,
    end: f64,
    at_depth: f64,
    thread: f64,
}

impl Over {
    /// Figures over the rows that `belongs` picks; zeros if there are none.
    pub(super) fn of(name: String, rows: &[Row], belongs: impl Fn(&Row) -> bool) -> Over {
        let chosen: Vec<&Row> = rows.iter().filter(|row| belongs(row)).collect();
        let worst = |of: fn(&Row) -> f64| chosen.iter().map(|row| of(row)).fold(0.0, f64::max);
        Over {
            name,
            cases: chosen.len(),
            median: median(chosen.iter().map(|row| row.approach_max_abs_um).collect()),
            worst: worst(|row| row.approach_max_abs_um),
            end: worst(|row| row.end_um.abs()),
            at_depth: worst(|row| row.at_depth_max_abs_um),
            thread: worst(|row| row.thread_max_abs_um),
        }
    }

    /// Over all rows.
    pub(super) fn all(rows: &[Row]) -> Over {
        Over::of("all".into(), rows, |_| true)
    }
}

/// The middle one in order; the mean of both middle ones of an even number; 0 of none.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match (values.get(middle), values.get(middle.wrapping_sub(1))) {
        (Some(upper), Some(lower)) if values.len().is_multiple_of(2) => 0.5 * (upper + lower),
        (Some(upper), _) => *upper,
        (None, _) => 0.0,
    }
}

/// The rows from the worst on.
pub(super) fn from_worst(rows: &[Row]) -> Vec<&Row> {
    let mut sorted: Vec<&Row> = rows.iter().collect();
    sorted.sort_by(|a, b| b.approach_max_abs_um.total_cmp(&a.approach_max_abs_um));
    sorted
}

fn two(um: f64) -> String {
    // Adding zero makes a zero of a negative zero.
    format!("{:.2}", (um * 100.0).round() / 100.0 + 0.0)
}

fn groups(rows: &[Row], finer: &[Row]) -> Vec<Over> {
    let beliefs = MASS_ERRORS.into_iter().flat_map(|mass| FRICTION_ERRORS.map(|friction| (mass, friction)));
    let by_belief = beliefs.map(|(mass, friction)| {
        let name = format!("mass {mass:+.0} %, friction {friction:+.0} %");
        Over::of(name, rows, |row| (row.mass_error_pct, row.friction_error_pct) == (mass, friction))
    });
    let by_override = OVERRIDES
        .into_iter()
        .map(|pct| Over::of(format!("override {pct:.0} %"), rows, |row| row.override_pct == pct));
    let by_pass = PASSES.into_iter().map(|[s, dx, dc]| {
        let name = format!("{s:.0} 1/min, {dx:.0} mm in {dc:.0}°");
        Over::of(name, rows, |row| [row.s_rpm, row.delta_x_mm, row.delta_c_deg] == [s, dx, dc])
    });
    let finer = Over::of("all, spindle encoder twice as fine".into(), finer, |_| true);
    [Over::all(rows), finer].into_iter().chain(by_belief).chain(by_override).chain(by_pass).collect()
}

const GROUPS: [Column<Over>; 7] = [
    Column { name: "cases", unit: "", cell: |over| over.name.clone() },
    Column { name: "number", unit: "", cell: |over| over.cases.to_string() },
    Column { name: "approach, median", unit: "± µm", cell: |over| two(over.median) },
    Column { name: "approach, worst", unit: "± µm", cell: |over| two(over.worst) },
    Column { name: "end, worst", unit: "± µm", cell: |over| two(over.end) },
    Column { name: "at depth, worst", unit: "± µm", cell: |over| two(over.at_depth) },
    Column { name: "thread, worst", unit: "± µm", cell: |over| two(over.thread) },
];

const CASES: [Column<Row>; 11] = [
    Column { name: "S", unit: "1/min", cell: |row| format!("{:.0}", row.s_rpm) },
    Column { name: "ΔX", unit: "mm", cell: |row| format!("{:.0}", row.delta_x_mm) },
    Column { name: "ΔC", unit: "deg", cell: |row| format!("{:.0}", row.delta_c_deg) },
    Column { name: "override", unit: "%", cell: |row| format!("{:.0}", row.override_pct) },
    Column { name: "mass", unit: "% off", cell: |row| format!("{:+.0}", row.mass_error_pct) },
    Column { name: "friction", unit: "% off", cell: |row| format!("{:+.0}", row.friction_error_pct) },
    Column { name: "seed", unit: "", cell: |row| row.seed.to_string() },
    Column { name: "peak a", unit: "m/s²", cell: |row| two(1e-3 * row.peak_acceleration()) },
    Column { name: "approach", unit: "± µm", cell: |row| two(row.approach_max_abs_um) },
    Column { name: "end", unit: "µm", cell: |row| two(row.end_um) },
    Column { name: "thread", unit: "± µm", cell: |row| two(row.thread_max_abs_um) },
];

/// Every table of the sweep; `finer` is the same with a spindle encoder of twice the lines.
pub(super) fn all(rows: &[Row], finer: &[Row]) -> Vec<Table> {
    let worst: Vec<Row> = from_worst(rows).into_iter().cloned().collect();
    let named = worst.get(..NAMED).unwrap_or(&worst);
    vec![
        Table::of("Servo error of X over all cases, and over parts of them", &GROUPS, &groups(rows, finer)).with_caption(
            "Approach: largest magnitude of the servo error while X is under its stroke. End: in the first cycle after \
             it. At depth: from the end on. Thread: from one turn later.",
        ),
        Table::of("The worst cases", &CASES, named)
            .with_caption("Peak a: peak acceleration of the stroke at the speed it was made with."),
        Table::of("Every case, the worst first", &CASES, &worst).at(Place::Details),
    ]
}
