//! Two equivalent programs, one in each dialect, give the same machine code.

use interpreter::check;
use machine::{Machine, ProgramDialect};
use protocol::Code;

/// The machine code of a program, without lines, changes of tool and the order of the spindle's words.
fn codes(dialect: ProgramDialect, source: &str) -> Vec<Code> {
    let mut machine = Machine::plain();
    machine.general.dialect = dialect;
    let check = check("test", source, &machine);
    let said: String = check.diagnostics.iter().map(|diagnostic| diagnostic.render(false)).collect();
    assert!(check.is_good(), "{said}");
    check.items.into_iter().map(|item| item.code).collect()
}

fn assert_same(linuxcnc: &str, fanuc: &str) {
    let (one, other) = (codes(ProgramDialect::Linuxcnc, linuxcnc), codes(ProgramDialect::Fanuc, fanuc));
    assert!(one.len() > 4, "the programs do something");
    for (n, (one, other)) in one.iter().zip(&other).enumerate() {
        assert_eq!(one, other, "code {n} of\n{linuxcnc}\n{fanuc}");
    }
    assert_eq!(one.len(), other.len(), "{linuxcnc}\n{fanuc}");
}

#[test]
fn moves_feeds_and_arcs() {
    assert_same(
        "G21 G18 G7 G90 G95 G97 S600 M3\nG0 X40 Z2 M8\nG1 Z-10 F0.2\nG2 X50 Z-15 R5\nG3 X60 Z-20 I0 K-5\nG4 P1.5\n\
         G94 G1 X62 F100\nM9\nG0 X80 Z50\nM30\n",
        "O1\nG21 G99 G97 S600 M03\nG00 X40. Z2. M08\nG01 Z-10. F0.2\nG02 X50. Z-15. R5.\nG03 U10. W-5. I0. K-5.\nG04 P1500\n\
         G98 G01 U2. F100.\nM09\nG00 X80. Z50.\nM30\n",
    );
}

#[test]
fn a_thread_in_one_block_of_either_dialect() {
    // Depth 1.227, first cut 0.35, constant area, drive line 2.5 mm outside the crest, flank infeed of 30
    // degrees.
    let fanuc =
        "O1\nG21 G97 S400 M03\nG00 X25. Z8.\nG76 P010060 Q0 R0\nG76 X17.546 Z-20. P1227 Q350 F2.\nM30\n";
    let linuxcnc =
        "G21 G18 G7 G90 G97 S400 M3\nG0 X25 Z8\nG76 P2 Z-20 I-5 J0.7 K2.454 R2 Q30 H1\nG0 Z8\nM30\n";
    assert_same(linuxcnc, fanuc);
}

#[test]
fn a_single_pass_and_its_retract() {
    assert_same(
        "G21 G18 G7 G90 S300 M3\nG0 X38 Z6\nG33 Z-22 K1.5\nG0 X45\nZ6\nM2\n",
        "O1\nG21 G97 S300 M03\nG00 X38. Z6.\nG32 Z-22. F1.5\nG00 X45.\nZ6.\nM30\n",
    );
}

#[test]
fn a_start_angle_moves_the_pass_along_the_spindle() {
    let pass = |q: u32| {
        let source = format!("O1\nG21 G97 S300 M03\nG00 X38. Z6.\nG32 Z-22. F1.5 Q{q}\nG00 X45.\nM30\n");
        let codes = codes(ProgramDialect::Fanuc, &source);
        let pass = |code: &Code| if let Code::Pass(pass) = code { Some(*pass) } else { None };
        codes.iter().find_map(pass).expect("a pass")
    };
    let (first, second) = (pass(0), pass(120_000));
    assert_eq!(first.axes.len(), second.axes.len());
    for (one, other) in first.axes.iter().zip(second.axes) {
        let moved = other.run_in_c0_deg - one.run_in_c0_deg;
        assert!(one.lead_mm == 0.0 || (moved.rem_euclid(360.0) - 120.0).abs() < 1e-9, "{moved}");
    }
    assert_same(
        "G21 G18 G7 G90 S300 M3\nG0 X38 Z6\nG33 Z-22 K1.5 Q120\nG0 X45\nM2\n",
        "O1\nG21 G97 S300 M03\nG00 X38. Z6.\nG32 Z-22. F1.5 Q120000\nG00 X45.\nM30\n",
    );
}

/// A chamfer of half a lead at 800 1/min is steeper than X of the small lathe: then it is that of `00`, as
/// steep as X can, and the warning says over what way; slow enough it is kept.
#[test]
fn a_chamfer_that_x_cannot_follow_is_as_steep_as_it_can() {
    let mut machine = Machine::plain();
    machine.general.dialect = ProgramDialect::Fanuc;
    for cycle in
        ["G76 P01{r}60 Q20 R0.02\nG76 X17.546 Z-20. P1227 Q200 F2.", "G76 P01{r}60 Q0 R0\nG92 X23. Z-20. F2."]
    {
        let source = |s: f64, r: &str| {
            format!("O1\nG21 G97 S{s} M03\nG00 X24. Z8.\n{}\nG00 X40.\nM30\n", cycle.replace("{r}", r))
        };
        let told = |s: f64, r: &str| {
            let mut told = check("t", &source(s, r), &machine).diagnostics;
            told.retain(|one| one.code != "thin-chip");
            told
        };
        let steep = told(800.0, "05");
        assert_eq!(
            steep.iter().map(|one| (one.line, one.code)).collect::<Vec<_>>(),
            [(5, "steep-chamfer")],
            "{cycle}"
        );
        let [least, steepest] = ["05", "00"].map(|r| codes(ProgramDialect::Fanuc, &source(800.0, r)));
        assert_eq!(least, steepest, "{cycle}");
        assert!(steep[0].message.contains("the chamfer of 1 mm"), "{}", steep[0].message);
        let speed = steep[0].help.split("lower S: S").nth(1).and_then(|rest| rest.split(' ').next());
        let slow: f64 = speed.and_then(|number| number.parse().ok()).expect("the help names a speed");
        assert!(told(slow, "05").is_empty() && told(slow + 1.0, "05").len() == 1, "{}", steep[0].help);
        let kept = ["05", "00"].map(|r| codes(ProgramDialect::Fanuc, &source(slow, r)));
        assert_ne!(kept[0], kept[1], "{cycle}");
    }
}
