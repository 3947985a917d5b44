//! `tables.txt`: more public tables, whole or in part, as they were printed.

use crate::compare::{Cell, Sizes, cells};

/// Every published size beside ours, and whether it is known to differ; with the name of the table.
pub(crate) fn all() -> Vec<(&'static str, Cell, bool)> {
    let mut all = Vec::new();
    let (mut table, mut columns) = ("", Vec::new());
    for line in include_str!("tables.txt").lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        if let Some(name) = line.strip_prefix("table ") {
            table = name;
        } else if let Some(names) = line.strip_prefix("columns ") {
            columns = names.split(' ').collect();
        } else if !line.starts_with("source ") {
            let (name, sizes) = line.split_once(" | ").unwrap_or_else(|| panic!("no row: {line}"));
            let (sizes, marked) = sizes.split_once(" ! ").unwrap_or((sizes, ""));
            let marked: Vec<&str> = marked.split_whitespace().collect();
            all.extend(row(name, &columns, sizes).into_iter().map(|cell| {
                let known = marked.contains(&cell.key.as_str());
                (table, cell, known)
            }));
        }
    }
    all
}

fn row(name: &str, columns: &[&str], sizes: &str) -> Vec<Cell> {
    let sizes: Vec<f64> = sizes.split(' ').map(|size| size.parse().expect("a number")).collect();
    assert_eq!(sizes.len(), columns.len(), "{name}");
    let of = |external: bool| -> Sizes {
        let all = columns.iter().zip(&sizes).filter(|(key, _)| key.starts_with('D') != external);
        all.map(|(key, size)| ((*key).to_owned(), *size)).collect()
    };
    let [external, internal] = [of(true), of(false)];
    let some = |sizes: &Sizes| (!sizes.is_empty()).then(|| sizes.clone());
    cells(name, some(&external).as_ref(), some(&internal).as_ref())
}

#[test]
fn public_tables_agree_in_the_last_place_or_differ_as_they_are_known_to() {
    let all = all();
    assert!(all.len() > 1000, "{}", all.len());
    let wrong = all.into_iter().filter(|(_, cell, marked)| cell.agrees() == *marked);
    let wrong: Vec<String> = wrong.map(|(table, cell, _)| format!("{table}: {cell}")).collect();
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}
