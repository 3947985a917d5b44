//! M codes of a machine are declared by their numbers.
#![allow(clippy::unwrap_used)]

use machine::{Machine, MachineCode, PLAIN_LATHE};
use protocol::Until;

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
        assert_eq!(machine.outputs_with(|output| output.safe), 8);
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
            said.starts_with(&format!("outputs = {wrong}: each is declared by its number, 0 to 63")),
            "{said}"
        );
    }
    for (names, place) in [(["a", "a"], "outputs.4.name = a: [outputs.3]"), (["a", " "], "outputs.4.name =")]
    {
        let [one, other] = names.map(|name| format!("name = {name:?}\n"));
        let said = refused(&format!("{PLAIN_LATHE}\n[outputs.3]\n{one}[outputs.4]\n{other}"));
        assert!(said.starts_with(place), "{said}");
    }
}

/// What a dialect has for itself goes first: with no other to read, such a code would do nothing.
#[test]
fn a_code_that_can_never_act_is_refused() {
    let file = |dialect: &str, code: u32| {
        let machine = PLAIN_LATHE.replace("dialect = \"auto\"", &format!("dialect = \"{dialect}\""));
        format!("{machine}\n[m_codes]\n{code} = \"ignore\"\n")
    };
    for (dialect, code) in [("linuxcnc", 19), ("linuxcnc", 68), ("linuxcnc", 70), ("fanuc", 97)] {
        let said = refused(&file(dialect, code));
        assert!(said.starts_with(&format!("m_codes = {code}: it would never act")), "{said}");
    }
    for (dialect, code) in
        [("fanuc", 19), ("auto", 19), ("fanuc", 68), ("auto", 68), ("linuxcnc", 97), ("linuxcnc", 69)]
    {
        assert!(Machine::from_toml(&file(dialect, code)).is_ok(), "{dialect} M{code}");
    }
}

#[test]
fn analog_outputs_have_a_range() {
    let file = |keys: &str| format!("{PLAIN_LATHE}\n[analog_outputs.1]\nname = \"air\"\n{keys}\n");
    let machine = Machine::from_toml(&file("range = [0, 10]\ninitial = 2\nsafe = 0.5")).unwrap();
    assert_eq!(machine.analog_outputs_at(|output| output.initial), [0.0, 2.0, 0.0, 0.0]);
    assert_eq!(Machine::from_toml(&toml::to_string(&machine).unwrap()).unwrap(), machine);
    for (keys, place) in [
        ("range = [10, 0]\ninitial = 2\nsafe = 0", "analog_outputs.1.range"),
        ("range = [0, inf]\ninitial = 2\nsafe = 0", "analog_outputs.1.range"),
        ("range = [0, 1]\ninitial = 2\nsafe = 0", "analog_outputs.1.initial = 2"),
        ("range = [0, 1]\ninitial = 0\nsafe = nan", "analog_outputs.1.safe"),
    ] {
        let said = refused(&file(keys));
        assert!(said.starts_with(place), "{keys}: {said}");
    }
    let said = refused(&format!(
        "{PLAIN_LATHE}\n[analog_outputs.4]\nname = \"a\"\nrange = [0, 1]\ninitial = 0\nsafe = 0\n"
    ));
    assert!(said.starts_with("analog_outputs = 4: each is declared by its number, 0 to 3"), "{said}");
}

#[test]
fn a_code_may_wait_for_an_input_that_is_declared() {
    let file = |deed: &str| {
        format!("{PLAIN_LATHE}\n[m_codes]\n36 = {{ {deed} }}\n[inputs.2]\nname = \"door\"\ninitial = true\n")
    };
    for (written, until) in
        [("rise", Until::Rise), ("fall", Until::Fall), ("high", Until::High), ("low", Until::Low)]
    {
        let deed = format!("does = \"wait-input\", number = 2, until = \"{written}\", within_s = 5");
        let machine = Machine::from_toml(&file(&deed)).unwrap();
        let codes: Vec<_> = machine.machine_codes().collect();
        assert_eq!(codes, [(36, MachineCode::Input { number: 2, until, within_s: 5.0 })]);
        assert_eq!(machine.inputs_with(|input| input.initial), 4);
        assert_eq!(Machine::from_toml(&toml::to_string(&machine).unwrap()).unwrap(), machine);
    }
    let deed = "does = \"wait-input\", number = 2, until = \"high\", within_s = 5";
    for (wrong, place) in [
        (
            deed.replace("= 2", "= 3"),
            "m_codes.36.number = 3: input 3 is not in the machine file: add [inputs.3]",
        ),
        (deed.replace("= 5", "= 0"), "m_codes.36.within_s = 0: give the longest wait"),
        (deed.replace("= 5", "= nan"), "m_codes.36.within_s"),
    ] {
        let said = refused(&file(&wrong));
        assert!(said.starts_with(place), "{said}");
    }
    assert!(refused(&file(&deed.replace("high", "on"))).contains("wait-input"));
}
