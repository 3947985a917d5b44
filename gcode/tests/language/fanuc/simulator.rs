//! Lines that begin with `[`, for simulators of schools.

use super::recorded::{errors, fanuc, outcome, run};
use gcode::{Dialect, Options, Program};

const OTHERS: &str = "[STEP\n[TOOLDEF T1 D6\n[CLEAR X1 Y1\n";

/// Comments of a program, with how often somebody was told of such lines.
fn stock(dialect: Dialect, text: &str) -> (Vec<String>, usize) {
    let options = Options { dialect, ..fanuc() };
    let outcome = run(Program::from_text("O1", format!("{text}\nM30\n"), &options));
    assert!(outcome.errors.is_empty(), "{:?}", outcome.errors);
    let comments = outcome.sink.others.into_iter().filter(|call| call.starts_with("Comment")).collect();
    let told = outcome.warnings.iter().filter(|warning| warning.code == "simulator-line").count();
    (comments, told)
}

#[test]
fn a_billet_is_the_stock_before_the_first_coordinate() {
    let lathe = |text| stock(Dialect::Fanuc, text);
    let bar = |text: &str| (vec![format!("Comment({text:?})")], 1);
    assert_eq!(lathe("[BILLET X50 Z80\nO1000\nG21\nG00 X40. Z2."), bar("part, bar D50 L80"));
    // a simulator may write blanks and the end of the block, in any case, in front of the units
    assert_eq!(lathe("[billet  x2.25 z4.5 ;\nO1\nG20\nG00 U1. W1."), bar("part, bar D2.25 L4.5"));
    let mill = |text| stock(Dialect::FanucMill, text);
    assert_eq!(
        mill("[BILLET X100 Y80 Z30\nO1\nG21 G90\nG00 X5. Y5."),
        bar("part, block X0 Y0 Z-30 X100 Y80 Z0")
    );
}

#[test]
fn what_says_no_stock_is_told_once_and_does_nothing() {
    let lathe = |text: &str| stock(Dialect::Fanuc, &format!("{text}\nO1\nG00 X40. Z2.\nX41."));
    let none = Vec::<String>::new();
    for billet in
        ["[BILLET X50", "[BILLET X50 Y50 Z30", "[BILLET X-50 Z80", "[BILLET X50 Z80 ZERO", "[BILLET"]
    {
        assert_eq!(lathe(billet), (none.clone(), 1), "{billet}");
    }
    assert_eq!(lathe(OTHERS), (none.clone(), 1));
    assert_eq!(lathe("[BILLET X50 Z80\n[EDGEMOVE X5 Z0"), (none, 1), "the stock lies elsewhere");
    assert_eq!(errors("G00 X1. [BILLET X50 Z80\n"), [(1, "bad-character")], "inside of a block it is none");
}

#[test]
fn such_a_line_is_no_block_that_a_program_number_cannot_follow() {
    assert!(outcome("%\n[BILLET X50 Z80\nO1000\nG00 X40. Z2.\nM30\n%").errors.is_empty());
}
