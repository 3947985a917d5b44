//! Reference runs. In: what a summary has of them. Out: a table of them in the order of their ends.

use rig::observe::{ReferenceReport, Summary};

use crate::table::{Column, Table};

struct Found<'a> {
    run: &'a ReferenceReport,
    time_s: f64,
    at_s: f64,
}

/// The table; nothing if there was none.
pub(super) fn table(summary: &Summary) -> Option<Table> {
    let seconds = |cycles: u64| cycles as f64 * summary.cycle_s;
    let found = |run| Found { run, time_s: seconds(run.cycles), at_s: seconds(run.cycle) };
    let found: Vec<Found<'_>> = summary.references.iter().map(found).collect();
    if found.is_empty() {
        return None;
    }
    let columns = [
        Column { name: "Axis", unit: "", cell: |one: &Found<'_>| one.run.axis.name().to_ascii_uppercase() },
        Column { name: "By", unit: "", cell: |one| one.run.method.in_words().to_owned() },
        Column { name: "Position", unit: "mm", cell: |one| format!("{:.4}", one.run.position_mm) },
        Column { name: "Shift", unit: "mm", cell: |one| format!("{:+.4}", one.run.shift_mm) },
        Column { name: "Run", unit: "s", cell: |one| format!("{:.3}", one.time_s) },
        Column { name: "Known at", unit: "s", cell: |one| format!("{:.3}", one.at_s) },
    ];
    let caption = "Position is where switch or index are by the machine file, of an index alone that of the turn \
                   that was found. Shift is what was added to the position that the axis believed in before. Run is \
                   how long the run took until the position was known, with its holds; Known at is that moment, from \
                   the first control cycle. Of a rotary axis degrees stand for mm.";
    Some(Table::of("Reference runs", &columns, &found).with_caption(caption.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_run_has_its_row() {
        let run = r#"{ "axis": "x", "method": "switch-and-index", "position_mm": 66.0, "shift_mm": -0.737, "cycle": 9000,
                       "cycles": 8000 }"#;
        let run = serde_json::from_str(run).expect("a run");
        let summary = Summary { cycle_s: 0.0005, references: vec![run], ..Summary::default() };
        let rows = table(&summary).expect("there is one").rows;
        assert_eq!(rows, [["X", "switch and index", "66.0000", "-0.7370", "4.000", "4.500"]]);
        assert!(table(&Summary::default()).is_none());
    }
}
