//! Faults have stable codes, and `docs/faults.md` is their table.

use protocol::{FAULTS, Fault, FaultRow};

const PAGE: &str = include_str!("../../../docs/faults.md");

#[test]
fn the_page_is_the_table() {
    let rows: Vec<&str> = PAGE.lines().filter(|line| line.starts_with("| `")).collect();
    let table = FAULTS.iter().map(|row| {
        let FaultRow { code, source, found, within, reaction, remedy, .. } = row;
        let within = within.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ");
        format!("| `{code}` | {source} | {found} | {within} | {reaction} | {remedy} |")
    });
    let table: Vec<String> = table.collect();
    assert_eq!(rows, table, "docs/faults.md; it should read\n{}", table.join("\n"));
}

#[test]
fn numbers_lead_back_to_their_faults() {
    for (fault, number) in Fault::ALL.into_iter().zip(1..) {
        assert_eq!((fault as u32, Fault::from_code(number)), (number, Some(fault)));
        assert_eq!(fault.row().fault, fault);
        assert!(fault.text().len() > 10 && !fault.text().ends_with('.'));
    }
    assert_eq!((Fault::from_code(0), Fault::from_code(Fault::ALL.len() as u32 + 1)), (None, None));
}
