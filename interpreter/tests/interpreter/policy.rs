//! What the program says of leaving a thread, in both dialects: it holds for the passes that follow.

use machine::{Machine, ProgramDialect};
use protocol::{Code, WayOut};

const HOLD: u32 = WayOut::ON_HOLD;
const STOP: u32 = WayOut::ON_STOP;
const FAULT: u32 = WayOut::ON_FAULT;

/// What makes the axes leave each pass of a program.
fn leaves(program: &str, dialect: ProgramDialect) -> Vec<u32> {
    let mut machine = Machine::plain();
    machine.general.dialect = dialect;
    let check = interpreter::check("test", program, &machine);
    assert!(check.is_good(), "{:#?}", check.diagnostics);
    let pass = |item: &protocol::Item| match &item.code {
        Code::Pass(pass) => Some(pass.out.leaves),
        _ => None,
    };
    check.items.iter().filter_map(pass).collect()
}

const NGC: &str = "G18 G21 G90 G8 G94 G97\nM3 S600\nG0 X12 Z8\nG0 X9.5\nG33 Z0 K2\n(on_hold, leave)\nG0 X12\n\
    G0 Z8\nG0 X9.5\nG33 Z0 K2\nG0 X12\nG0 Z8\n(ON_STOP, finish)\nG76 P2 Z0 I-1 J0.4 K0.8\nM2\n";

#[test]
fn a_word_holds_for_the_passes_behind_it_and_not_for_one_that_waits_for_its_retract() {
    let seen = leaves(NGC, ProgramDialect::Linuxcnc);
    assert_eq!(seen[..2], [STOP | FAULT, STOP | FAULT | HOLD]);
    assert!(seen.len() > 3 && seen[2..].iter().all(|bits| *bits == FAULT | HOLD), "{seen:?}");
}

#[test]
fn fanuc_says_it_in_its_comments_too() {
    let program = "%\nO0001 (ON_HOLD, LEAVE)\nG21 G97 M03 S600\nG00 X24. Z8.\n(ON_FAULT, FINISH)\n\
        G92 X19. Z0. F2.\nX18.6\nG00 X40.\nM30\n%\n";
    let seen = leaves(program, ProgramDialect::Fanuc);
    assert_eq!(seen, [STOP | HOLD; 2]);
}

#[test]
fn a_misspelt_word_is_an_error_at_its_line() {
    let program = "G18 G90\n(on_stop, leav)\nM2\n";
    let check = interpreter::check("test", program, &Machine::plain());
    let [found] = &check.diagnostics[..] else { panic!("{:#?}", check.diagnostics) };
    assert_eq!((found.code, found.line), ("bad-value", 2));
    assert!(found.help.contains("(on_stop, leave)"), "{}", found.help);
}
