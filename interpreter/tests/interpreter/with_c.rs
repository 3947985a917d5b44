//! A lathe with an axis C: it moves with the others, and rests during threads.

use interpreter::check;
use machine::Machine;
use protocol::{Axis, Code, Feed, Position};

use crate::passes;

fn lathe() -> Machine {
    let mut machine = Machine::plain();
    let mut c = machine.axis[&Axis::Z].clone();
    (c.travel_mm, c.home_mm) = ([-360.0, 360.0], 0.0);
    machine.axis.insert(Axis::C, c);
    machine.check().expect("a lathe may have C");
    machine
}

#[test]
fn c_moves_and_holds_still_in_a_thread() {
    let source = "G18 S400 M3\nG0 X12 Z5 C90\nG1 Z4 C120 F100\nG33 Z-10 K1\nG0 X15\nG1 C0\nM2\n";
    let check = check("test.ngc", source, &lathe());
    assert!(check.is_good(), "{:?}", check.diagnostics);
    let c = Axis::C.index();
    let ends: Vec<f64> = check
        .items
        .iter()
        .filter_map(
            |item| if let Code::Line { target, .. } = item.code { Some(target[c].mm()) } else { None },
        )
        .collect();
    assert_eq!(ends, [90.0, 120.0, 0.0]);
    let pass = passes(&check.items)[0];
    let law = pass.axis(Axis::C);
    assert_eq!((law.start, law.end), (Position::from_mm(120.0), Position::from_mm(120.0)));
    assert!(pass.check().is_ok() && lathe().can_follow(&pass));
    let feed = |item: &protocol::Item| matches!(item.code, Code::Line { feed: Feed::PerMinute(100.0), .. });
    assert_eq!(check.items.iter().filter(|item| feed(item)).count(), 2);
}

#[test]
fn a_thread_does_not_turn_c() {
    let source = "G18 S400 M3\nG0 X12 Z5\nG33 Z-10 C90 K1\nM2\n";
    let check = check("test.ngc", source, &lathe());
    let errors: Vec<_> = check.diagnostics.iter().map(|one| (one.line, one.code)).collect();
    assert_eq!(errors, [(3, "not-available")]);
}
