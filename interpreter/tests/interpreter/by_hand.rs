//! Blocks given by hand one by one are the machine code of the same blocks in a program.

use interpreter::{ByHand, Interpreter, Language};
use machine::{Machine, ProgramDialect};
use protocol::{Axis, Code, PerAxis, Position};

use super::project;

/// A machine of the examples that reads a dialect.
fn machine(name: &str, dialect: ProgramDialect) -> Machine {
    let mut machine = match name {
        "lathe" => Machine::plain(),
        name => {
            let path = project().join("examples/machines").join(name);
            Machine::from_toml(&std::fs::read_to_string(path).expect("it is there")).expect("it is right")
        }
    };
    machine.general.dialect = dialect;
    machine
}

/// The machine code of a program; `None` if the machine refuses something of it.
fn whole(source: &str, machine: &Machine) -> Option<Vec<Code>> {
    let items: Result<Vec<_>, _> = Interpreter::of_text("test", source, machine).collect();
    Some(items.ok()?.into_iter().map(|item| item.code).filter(is_work).collect())
}

/// That of its lines, each of which begins where the axes were left. In front of each stands one that is
/// refused, and of which nothing may stay.
fn by_hand(source: &str, machine: &Machine) -> Vec<Code> {
    let mut hand = ByHand::new(&Language::default(), machine).expect("nothing is beside it");
    let (mut at, mut codes) = (machine.home(), Vec::new());
    for line in source.lines().filter(|line| line.trim() != "%") {
        let refused = hand.block("G91 G98 G1 X900. Z900. F77. T9 M8 M98", &at);
        assert!(refused.is_err(), "that is no block");
        let items = hand.block(line, &at).unwrap_or_else(|errors| panic!("{line}: {errors:?}\nof {source}"));
        for item in items {
            left_at(&item.code, &mut at);
            codes.push(item.code);
        }
    }
    codes.into_iter().filter(is_work).collect()
}

/// Neither an end nor a beginning: those of a program and of a block differ.
fn is_work(code: &Code) -> bool {
    !matches!(code, Code::ByHand(_) | Code::End)
}

/// Where the axes are behind a code.
fn left_at(code: &Code, at: &mut PerAxis<Position>) {
    match code {
        Code::Line { target, .. } => *at = *target,
        Code::Arc { arc, .. } => *at = arc.target,
        Code::Pass(pass) => [Axis::X, Axis::Z].into_iter().for_each(|axis| {
            at[axis.index()] = pass.axis(axis).end;
        }),
        _ => {}
    }
}

fn assert_same(name: &str, source: &str, machine: &Machine) {
    let whole = whole(source, machine).unwrap_or_else(|| panic!("{name} is right"));
    let given = by_hand(source, machine);
    for (n, (one, other)) in whole.iter().zip(&given).enumerate() {
        assert_eq!(one, other, "code {n} of {name}, as a program and by hand:\n{source}");
    }
    assert_eq!(whole.len(), given.len(), "{name}:\n{source}");
}

/// A part of a FANUC lathe program in which a word stays in force, behind tool and spindle.
const OF_A_LATHE: [&str; 13] = [
    "G01 X22. F.3\nZ5.\nG00 X24.\nZ8.",
    "G98\nG01 X22. F100.\nZ5.\nG99\nG01 X24. F.2",
    "G92 X21.2 Z-2. F2.\nX20.8\nX20.5\nG00 Z9.\nX25.",
    "G90 X21. Z-1. F0.3\nX20.5\nG00 Z9.",
    "G94 X20. Z4. F0.2\nZ3.\nZ2.\nG00 X30.",
    "G76 P010060 Q100 R20\nG76 X20.16 Z-2. P920 Q300 F1.5\nG00 X30.",
    "G83 X0 Z-6. R-2. Q2. F.1\nZ-8.\nG80\nG00 X30.",
    "G74 R.5\nG74 X10. Z-6. P1000 Q2000 F.1\nG75 R.5\nG75 X16. Z4. P1000 Q2000 F.1",
    "#500=7\n#1=3\n#100=[#500+#1]\nG00 X[#500+20.]\nZ[#1+#100]",
    "G50 S1000\nG96 S100 M03\nG01 X22. F.2\nG97 S500\nX25.",
    "G01 X24. Z5. F.2\nU-2.\nW-3.\nG04 U.5\nG02 U4. W-2. R2.\nG01 U1.",
    "G20\nG01 X.9 F.01\nZ.1\nG21\nX23.\nG55\nG00 X24.",
    "G42 G01 X22. Z4. F.2\nZ-3.\nX24.\nG40 G00 X26.",
];

/// The same of a mill.
const OF_A_MILL: [&str; 5] = [
    "G81 X5. Y5. Z-3. R1. F200.\nX10.\nX15. Y8.\nG80\nX0. Y0.",
    "G91\nG83 X2. Z-6. R-1. Q2. F100.\nX2. K2\nG90\nG99 G82 X3. Y3. Z-4. R1. P200\nY6.\nG80",
    "G01 X5. F300.\nY5.\nG91 X2.\nX2.\nG03 X2. Y2. R2.\nG90 G00 Z5.",
    "#500=7\nG00 X#500\nG52 X2. Y1.\nG00 X0. Y0.\nG52 X0 Y0",
    "G54.1 P3\nG68 X0. Y0. R30.\nG01 X5. F100.\nY2.\nG69\nX0.",
];

#[test]
fn modes_cycles_and_variables_of_fanuc_stay_from_block_to_block_by_hand() {
    let lathe = machine("lathe", ProgramDialect::Fanuc);
    for part in OF_A_LATHE {
        assert_same(part, &format!("T0101\nG97 S600 M03\nG00 X25. Z9.\n{part}\nM30\n"), &lathe);
    }
    let mill = machine("small-mill.toml", ProgramDialect::Fanuc);
    for part in OF_A_MILL {
        assert_same(part, &format!("T1 M06\nS900 M03\nG00 X0. Y0. Z5.\n{part}\nM30\n"), &mill);
    }
}

/// Whether a line by itself means what it means in its program: it begins no loop or subroutine, and neither
/// compensation nor G33 asks what comes behind it.
fn is_line_by_line(source: &str) -> bool {
    let source = source.to_lowercase();
    let asks = ["m98", "m99", "g41", "g42", "g33 ", "%"].iter().any(|word| source.contains(word));
    !asks && source.lines().all(|line| !line.trim_start().starts_with('o'))
}

#[test]
fn programs_of_linuxcnc_given_by_hand_are_the_same_machine_code() {
    let programs = std::fs::read_dir(project().join("tests/conformance/programs")).expect("they are there");
    let mut paths: Vec<_> = programs.map(|entry| entry.expect("it can be read").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "ngc"));
    let mut compared = 0;
    for machine in ["lathe", "small-mill.toml"].map(|name| machine(name, ProgramDialect::Linuxcnc)) {
        for path in &paths {
            let source = std::fs::read_to_string(path).expect("it can be read");
            if is_line_by_line(&source) && whole(&source, &machine).is_some() {
                assert_same(&path.display().to_string(), &source, &machine);
                compared += 1;
            }
        }
    }
    assert!(compared > 60, "{compared} programs");
}

/// Each block is a pass of its own here, since the machine rests between them.
#[test]
fn a_thread_of_fanuc_goes_on_in_the_next_block_by_hand() {
    let blocks = "T0303\nG97 S900 M03\nG00 X21. Z6.\nG32 Z0. F1.5\nZ-3.\nG00 X24.";
    let given = by_hand(blocks, &machine("lathe", ProgramDialect::Fanuc));
    let passes: Vec<_> = given
        .iter()
        .filter_map(|code| if let Code::Pass(pass) = code { Some(*pass) } else { None })
        .map(|pass| (pass.axis(Axis::Z).start.mm(), pass.lead_mm))
        .collect();
    assert_eq!(passes, [(6.0, -1.5), (0.0, -1.5)]);
}

#[test]
fn what_is_in_force_by_hand_is_told_in_the_words_of_the_dialect() {
    use ProgramDialect::{Fanuc, Linuxcnc};
    for (name, dialect, block, told) in [
        ("lathe", Fanuc, "M9", "FANUC: G0 G18 G21 G99 G54 T0 F0 S0"),
        ("lathe", Fanuc, "G98 G01 X22. F100.", "FANUC: G1 G18 G21 G98 G54 T0 F100 S0"),
        ("lathe", Fanuc, "G95 F.2", "FANUC: G0 G18 G21 G95 G54 T0 F0.2 S0"),
        ("lathe", Fanuc, "G98 G83 X0 Z9. R-1. F100.", "FANUC: G83 G18 G21 G98 G54 T0 F100 S0"),
        ("lathe", Fanuc, "G98 G01 X22. F100.\nM30", "FANUC: G0 G18 G21 G99 G54 T0 F0 S0"),
        ("lathe", Linuxcnc, "G7", "LinuxCNC: G80 G18 G21 G90 G94 G7 G54 T0 F0 S0"),
        ("small-mill.toml", Fanuc, "G91 G81 X1. Z-1. R-1. F90.", "FANUC: G81 G17 G21 G91 G94 G54 T0 F90 S0"),
    ] {
        let machine = machine(name, dialect);
        let mut hand = ByHand::new(&Language::default(), &machine).expect("nothing is beside it");
        let at = machine.home();
        hand.block(block, &at).unwrap_or_else(|errors| panic!("{block}: {errors:?}"));
        // What M30 puts back is there for the next block.
        hand.block("(nothing)", &at).expect("it is right");
        assert_eq!(hand.in_force(), told, "{block}");
    }
}
