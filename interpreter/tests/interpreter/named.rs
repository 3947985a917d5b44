//! What is told of a thread that is not the one that the program names, and of an insert that is not the one
//! that it is written for: the message, and what to do about it.

use machine::{Machine, Tool};

/// Messages of a code with their remedies.
fn told(program: &str, code: &str, machine: &Machine) -> Vec<(String, String)> {
    let check = interpreter::check("named.ngc", program, machine);
    let of = check.diagnostics.into_iter().filter(|one| one.code == code);
    of.map(|one| (one.message, one.help)).collect()
}

#[test]
fn the_remedy_is_that_of_what_differs() {
    let helps = |name: &str, x: f64, back: f64| {
        let program = format!(
            "(thread, {name})\nG18 G21 G90 G8 G97\nS400 M3\nG0 X{x} Z8\nG33 Z-20 K2\nG0 X{back}\nM2\n"
        );
        told(&program, "gauge-differs", &Machine::plain()).pop().unwrap_or_default().1
    };
    let pitch = helps("M20x1.5-6g", 9.0, 20.0);
    assert!(pitch.contains("a lead of 1.5 mm is that of M20x1.5-6g") && !pitch.contains("6G"), "{pitch}");
    let side = helps("M20x2-6H", 9.0, 20.0);
    assert!(side.contains("6g is a screw, 6H and 6G are nuts") && !side.contains("lead"), "{side}");
    let starts = helps("M20xPh2P1-6g", 9.0, 20.0);
    assert!(starts.contains("cut 2 grooves"), "{starts}");
    let hand = helps("M20x2-6g LH", 9.0, 20.0);
    assert!(hand.contains("LH behind a name is left-hand") && !hand.contains("lead of"), "{hand}");
    assert_eq!(helps("M20x2-6g", 9.0, 20.0), "");
}

#[test]
fn an_insert_is_compared_with_what_the_machine_file_has() {
    let program = |tool: &str| {
        format!("(thread_insert, A60 R0.2)\n{tool}G18 G8 S400 M3\nG0 X12 Z5\nG33 Z-30 K1.5\nG0 X40\nM2\n")
    };
    let none = Machine::plain();
    let one = |tool: &str, machine: &Machine| {
        let [(message, help)] = &told(&program(tool), "other-insert", machine)[..] else { panic!("one") };
        (message.clone(), help.clone())
    };
    let (message, help) = one("T3 M6\n", &none);
    assert!(message.starts_with("nobody described tool 3, which is taken to be sharp"), "{message}");
    assert!(
        help.contains("[tools.3] with a name, angle_deg = 60, nose_mm = 0.2 into the machine file"),
        "{help}"
    );
    assert!(help.contains("not by (thread_insert, ...)"), "{help}");
    let (message, _) = one("", &none);
    assert!(message.starts_with("the program calls for no tool"), "{message}");
    let mut other = none.clone();
    let tool = Tool { name: "threading".into(), nose_mm: Some(0.1), ..Tool::default() };
    other.tools.insert("3".into(), tool.clone());
    let (message, _) = one("T3 M6\n", &other);
    assert!(message.ends_with("tool 3 of the machine file has a nose of 0.100 mm, not 0.200"), "{message}");
    other.tools.insert("3".into(), Tool { nose_mm: Some(0.2), ..tool });
    assert_eq!(told(&program("T3 M6\n"), "other-insert", &other), []);
}
