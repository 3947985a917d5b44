//! The table of docs/metrology.md that says how well published limits agree, against what is computed.

use std::collections::BTreeMap;

use crate::{compare::Cell, reference, tables};

/// What is said of a standard.
#[derive(Default)]
struct Row {
    agree: usize,
    /// Largest difference of those, µm.
    worst_um: f64,
    differ: usize,
    /// Largest difference of those, µm.
    most_um: f64,
}

impl Row {
    fn add(&mut self, cell: &Cell) {
        let apart = if cell.key.ends_with("_deg") { 0.0 } else { cell.apart_um() };
        if cell.agrees() {
            self.agree += 1;
            self.worst_um = self.worst_um.max(apart);
        } else {
            self.differ += 1;
            self.most_um = self.most_um.max(apart);
        }
    }
}

#[test]
fn the_page_has_the_figures_that_are_computed() {
    let mut rows = BTreeMap::<String, Row>::new();
    for (cell, _) in reference::of(include_str!("../../../tests/reference/threads.json")) {
        rows.entry(cell.standard.clone()).or_default().add(&cell);
    }
    for (_, cell, _) in tables::all() {
        rows.entry(cell.standard.clone()).or_default().add(&cell);
    }
    let page = include_str!("../../../docs/metrology.md");
    let um = |value: f64| format!("{value:.2}");
    let lines = rows.iter().map(|(standard, row)| {
        let Row { agree, worst_um, differ, most_um } = row;
        let most = if *differ == 0 { "–".to_owned() } else { um(*most_um) };
        format!("| {standard} | {} | {agree} | {} | {differ} | {most} |", agree + differ, um(*worst_um))
    });
    let missing: Vec<String> = lines.filter(|line| !page.contains(line)).collect();
    assert!(missing.is_empty(), "the page lacks\n{}", missing.join("\n"));
}
