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

#[test]
fn a_code_may_switch_an_output_that_is_declared() {
    let file = |codes: &str| {
        format!("{PLAIN_LATHE}\n[m_codes]\n{codes}\n[outputs.3]\nname = \"chuck\"\nsafe = true\n")
    };
    let deed = |value: &str| format!("31 = {{ does = \"output\", number = 3, value = {value} }}");
    for (written, value) in [("true", true), ("false", false), ("\"on\"", true), ("\"off\"", false)] {
        let machine = Machine::from_toml(&file(&deed(written))).unwrap();
        let codes: Vec<_> = machine.machine_codes().collect();
        assert_eq!(codes, [(31, MachineCode::Output { number: 3, value })]);
        assert_eq!(machine.outputs_on(), [0, 8]);
        let again = Machine::from_toml(&toml::to_string(&machine).unwrap()).unwrap();
        assert_eq!(again, machine, "it is written as it is read");
    }
    for wrong in [deed("1"), deed("\"high\""), deed("true").replace("output", "input")] {
        let said = refused(&file(&wrong));
        assert!(said.contains("[m_codes]") && said.contains("does = \"output\""), "{wrong}: {said}");
    }
    let said = refused(&file(&deed("true").replace("= 3", "= 4")));
    assert!(said.starts_with("m_codes.31.number = 4: ") && said.contains("add [outputs.4]"), "{said}");
    for wrong in ["64", "-1", "03", "chuck"] {
        let said = refused(&format!("{PLAIN_LATHE}\n[outputs.{wrong}]\nname = \"a\"\n"));
        assert!(
            said.starts_with(&format!("outputs = {wrong}: an output is declared by its number")),
            "{said}"
        );
    }
}
