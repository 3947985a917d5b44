//! Faults have stable codes, and `docs/faults.md` explains each of them in their order.

use protocol::Fault;

const PAGE: &str = include_str!("../../../docs/faults.md");

#[test]
fn the_page_explains_every_fault_in_order() {
    let cell = |line: &'static str| line.strip_prefix("| `")?.split_once('`').map(|(code, _)| code);
    let explained: Vec<&str> = PAGE.lines().filter_map(cell).collect();
    assert_eq!(explained, Fault::ALL.map(Fault::code));
}

#[test]
fn numbers_lead_back_to_their_faults() {
    for (fault, number) in Fault::ALL.into_iter().zip(1..) {
        assert_eq!((fault as u32, Fault::from_code(number)), (number, Some(fault)));
        assert!(fault.text().len() > 10 && !fault.text().ends_with('.'));
    }
    assert_eq!((Fault::from_code(0), Fault::from_code(Fault::ALL.len() as u32 + 1)), (None, None));
}
