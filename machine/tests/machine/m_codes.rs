//! M codes of a machine are declared by their numbers.
#![allow(clippy::unwrap_used)]

use machine::{Machine, MachineCode, PLAIN_LATHE};

fn refused(text: &str) -> String {
    Machine::from_toml(text).unwrap_err().to_string()
}

#[test]
fn codes_of_the_machine_are_declared_by_their_numbers() {
    let file = |codes: &str| format!("{PLAIN_LATHE}\n[m_codes]\n{codes}\n");
    let machine = Machine::from_toml(&file("31 = \"ignore\"\n120 = \"wait\"")).unwrap();
    let codes: Vec<_> = machine.machine_codes().collect();
    assert_eq!(codes, [(120, MachineCode::Wait), (31, MachineCode::Ignore)]);
    for own in ["3", "0", "99", "30", "1000", "-1", "abc", "3.5"] {
        let said = refused(&file(&format!("\"{own}\" = \"ignore\"")));
        assert!(
            said.starts_with(&format!("m_codes = {own}: a code is declared by its number")),
            "{own}: {said}"
        );
    }
    let said = refused(&file("31 = \"open\""));
    assert!(said.contains("[m_codes]") && said.contains("ignore") && said.contains("wait"), "{said}");
}
