//! The rows of a document. In: what a command prints with `--json`. Out: rows of plain values; a table in a
//! document becomes names with points, a list of numbers names with numbers.
//!
//! | command | a row for each |
//! |---|---|
//! | `soak` | seed |
//! | `experiment` | row of the experiment |
//! | `tune` | key that it proposes |
//! | `run` | pass; of a program without passes one; the figures of the run are in each |
//!
//! What depends on the computer and not on the machine, such as wall time, is in no row: a campaign gives the
//! same table wherever it is made.

use serde_json::{Map, Value};

/// A row: names and plain values.
pub type Row = Map<String, Value>;

/// Of a run: what describes it and is no figure, or is another one on another computer.
const LEFT_OUT: [&str; 14] = [
    "version",
    "program",
    "clock",
    "seed",
    "cycle_s",
    "wall_s",
    "files",
    "processes",
    "channels",
    "deadline_misses",
    "late",
    "limits",
    "tools",
    "pauses",
];

/// The rows of what a command printed.
///
/// # Errors
/// It is no document of that command: what is missing.
pub fn rows(command: &str, document: &Value) -> Result<Vec<Row>, String> {
    let list = |key: &str| {
        let list = document.get(key).and_then(Value::as_array);
        list.ok_or_else(|| format!("its document has no list \"{key}\""))
    };
    match command {
        "tune" => Ok(list("axes")?.iter().flat_map(changes).collect()),
        "run" => Ok(of_run(document)),
        _ => Ok(list("rows")?.iter().map(flat).collect()),
    }
}

/// What `tune` proposes for an axis.
fn changes(axis: &Value) -> Vec<Row> {
    let changes = axis.get("changes").and_then(Value::as_array).into_iter().flatten();
    let with_axis = |change: &Value| {
        let mut row = flat(change);
        row.insert("axis".into(), axis.get("axis").cloned().unwrap_or(Value::Null));
        row
    };
    changes.map(with_axis).collect()
}

/// A row for each pass.
fn of_run(document: &Value) -> Vec<Row> {
    let mut run = document.as_object().cloned().unwrap_or_default();
    LEFT_OUT.iter().for_each(|key| drop(run.remove(*key)));
    let passes = run.remove("passes");
    // What it judged by, which is in the standard, and which passes it took.
    if let Some(gauge) = run.get_mut("gauge").and_then(Value::as_object_mut) {
        ["limits", "passes"].iter().for_each(|key| drop(gauge.remove(*key)));
    }
    let fault = run.remove("faults").and_then(|faults| faults.get(0)?.get("code").cloned());
    run.insert("fault".into(), fault.unwrap_or(Value::Null));
    let run = flat(&Value::Object(run));
    let passes = passes.as_ref().and_then(Value::as_array).into_iter().flatten();
    let of_pass = |pass: &Value| {
        let figures = flat(pass).into_iter().map(|(name, value)| (format!("pass.{name}"), value));
        run.clone().into_iter().chain(figures).collect()
    };
    let rows: Vec<Row> = passes.map(of_pass).collect();
    if rows.is_empty() { vec![run] } else { rows }
}

/// A value as plain ones.
fn flat(value: &Value) -> Row {
    let mut row = Row::new();
    flatten("", value, &mut row);
    row
}

fn flatten(name: &str, value: &Value, row: &mut Row) {
    match value {
        Value::Object(fields) => {
            for (key, value) in fields {
                let name = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
                flatten(&name, value, row);
            }
        }
        Value::Array(list) if list.iter().all(|one| one.is_number() || one.is_null()) => {
            list.iter().enumerate().for_each(|(n, one)| drop(row.insert(format!("{name}.{n}"), one.clone())));
        }
        // Texts stand in one; a list of tables is no value of a row.
        Value::Array(list) => {
            let texts: Option<Vec<&str>> = list.iter().map(Value::as_str).collect();
            texts.map(|texts| row.insert(name.into(), texts.join("; ").into()));
        }
        plain => drop(row.insert(name.into(), plain.clone())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_run_has_a_row_for_each_pass_and_nothing_of_the_computer() {
        let document = json!({
            "wall_s": 2.5, "outcome": "completed", "thread": { "phase_spread_um": 0.5 },
            "faults": [{ "code": "lost", "cycle": 3 }],
            "passes": [{ "pass": 1, "x": { "end_um": 0.25 }, "origin_mm": [0.0, null] }, { "pass": 2 }],
            "gauge": { "reasons": ["a", "b"] },
        });
        let rows = rows("run", &document).expect("rows");
        let first = json!({
            "outcome": "completed", "thread.phase_spread_um": 0.5, "fault": "lost", "gauge.reasons": "a; b",
            "pass.pass": 1, "pass.x.end_um": 0.25, "pass.origin_mm.0": 0.0, "pass.origin_mm.1": null,
        });
        assert_eq!(Value::Object(rows[0].clone()), first);
        assert_eq!(rows.len(), 2);
        let none =
            super::rows("run", &json!({ "outcome": "completed", "passes": [], "faults": [] })).expect("rows");
        assert_eq!(none.len(), 1);
    }

    #[test]
    fn tune_has_a_row_for_each_key() {
        let document =
            json!({ "axes": [{ "axis": "x", "changes": [{ "key": "a", "after": 2.0 }, { "key": "b" }] }] });
        let rows = rows("tune", &document).expect("rows");
        assert_eq!(Value::Object(rows[0].clone()), json!({ "axis": "x", "key": "a", "after": 2.0 }));
        assert_eq!(rows.len(), 2);
    }

    #[test]
    fn what_is_no_document_is_told() {
        assert!(rows("soak", &json!({ "seeds": 3 })).is_err_and(|why| why.contains("\"rows\"")));
    }
}
