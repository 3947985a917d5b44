//! The part: what a program says of it in either dialect, and what it is warned of while it cuts it.

use machine::{Machine, Part, ProgramDialect};

/// Codes and lines of what is found in a program.
fn found(program: &str) -> Vec<(&'static str, u32)> {
    let check = interpreter::check("part.ngc", program, &Machine::plain());
    check.diagnostics.iter().map(|one| (one.code, one.line)).collect()
}

const HEAD: &str = "G18 G21 G90 G8 G94 G97 G61\n";

#[test]
fn a_good_program_is_not_warned_of_anything() {
    // Face, roughing, a groove, a thread with its relief, in steps that leave and come back.
    let turning = "(part, bar D40 L60 Z1 C-50)\nS800 M3 F100\nG0 X22 Z3\nG0 Z0\nG1 X-0.5\nG0 Z1\nG0 X18\nG1 Z-40\nG1 X21\n\
                   G0 Z1\nG0 X15\nG1 Z-30\nG1 X21\nG0 Z1\nG0 X12\nG1 X15 Z-2\nG3 X16 Z-3 K-1\nG1 Z-30\nG0 X22\nG0 Z5\n\
                   G0 X17\nG76 P2 Z-25 I-1 J0.3 K1.2\nG0 X40\nG0 Z60\nM5\nM2\n";
    assert_eq!(found(&format!("{HEAD}{turning}")), []);
    let boring = "(part, tube D40 I20 L60)\nS800 M3 F100\nG0 X9 Z3\nG0 X12\nG1 Z-30\nG0 X11\nG0 Z3\nG0 X13\nG1 Z-20\n\
                  G0 X12\nG0 Z5\nG0 X40\nM5\nM2\n";
    assert_eq!(found(&format!("{HEAD}{boring}")), []);
}

#[test]
fn each_warning_has_its_line() {
    for (program, expected) in [
        ("(part, bar D40 L60)\nG0 X10 Z-5\n", ("rapid-in-stock", 3)),
        ("(part, bar D40 L60)\nF100\nG0 X10 Z2\nG1 Z-5\n", ("cut-at-rest", 5)),
        ("(part, bar D40 L60)\nF100\nG0 X22 Z-10\nG3 X18 Z-14 R4\n", ("cut-at-rest", 5)),
        ("(part, bar D40 L60 C-50)\nG0 X30 Z-40\nG0 Z-55\n", ("into-chuck", 4)),
        ("(part, bar D40 L60 C-50)\nF100 S300 M3\nG0 X30 Z-40\nG1 Z-55\n", ("into-chuck", 5)),
        ("(part, bar D40 L60 Z7.9)\nS600 M3\nG0 X12 Z8\nG33 Z-20 K2\nG0 X40\n", ("run-in-in-stock", 5)),
        (
            "(part, bar D60 L60 Z-12)\nS600 M3\nG0 X28 Z5\nG76 P2 Z-20 I-1.5 J0.3 K1.2\n",
            ("retract-in-stock", 5),
        ),
        ("(part, bar D40 L60 C-10)\nS600 M3\nG0 X12 Z8\nG33 Z-20 K2\nG0 X40\n", ("into-chuck", 5)),
    ] {
        assert_eq!(found(&format!("{HEAD}{program}M2\n")), [expected], "{program}");
    }
}

/// A shoulder that the program turns or that is said of the stock, by a cycle and by G33; in front of it, and
/// in a blank that is somewhat too thick, nothing is wrong.
#[test]
fn a_thread_through_a_shoulder_is_warned_of_wherever_it_retracts_to() {
    let shoulder = "(part, profile Z0 D20 Z-18 D20 Z-18 D30 Z-60 D30)\nS600 M3\n";
    let outside =
        |z: f64| format!("{shoulder}G0 X16 Z8\nG76 P2 Z{z} I-6.09 J0.35 K1.485 R2 Q29.5 H2\nG0 X40\n");
    let g33 = |z: f64| format!("{shoulder}G0 X16 Z8\nG0 X9\nG33 Z{z} K2\nG0 X25\n");
    let turned = |z: f64| {
        format!(
            "(part, bar D30 L60)\nS600 M3 F100\nG0 X10 Z3\nG1 Z-18\nG0 X16\nG0 Z8\nG76 P2 Z{z} I-6 J0.3 K1.2\n"
        )
    };
    for (program, line) in [(outside(-22.0), 5), (g33(-22.0), 6), (turned(-24.0), 8)] {
        assert_eq!(found(&format!("{HEAD}{program}M2\n")), [("thread-in-stock", line)], "{program}");
    }
    for program in [outside(-14.0), g33(-14.0), turned(-14.0)] {
        assert_eq!(found(&format!("{HEAD}{program}M2\n")), [], "{program}");
    }
    let thick = "(part, bar D22 L60)\nS600 M3\nG0 X16 Z8\nG76 P2 Z-22 I-6 J0.35 K1.2\n";
    assert_eq!(found(&format!("{HEAD}{thick}M2\n")), []);
}

#[test]
fn a_thread_through_a_step_of_a_bore_is_warned_of() {
    let mut machine = Machine::plain();
    for (number, width_mm) in [("1", 8.0), ("2", 18.0)] {
        let drill =
            machine::Tool { name: "drill".into(), width_mm: Some(width_mm), ..machine::Tool::default() };
        machine.tools.insert(number.into(), drill);
    }
    let bored = |through: f64, z: f64| {
        let drilled =
            format!("T1 M6\nS600 M3 F100\nG0 X0 Z8\nG1 Z-{through}\nG0 Z8\nT2 M6\nM3\nG1 Z-18\nG0 Z8\n");
        let program = format!("{HEAD}(part, bar D40 L60)\n{drilled}G0 X3\nG76 P2 Z{z} I6 J0.3 K1.2\nM2\n");
        let check = interpreter::check("part.ngc", &program, &machine);
        check.diagnostics.iter().map(|one| (one.code, one.line)).collect::<Vec<_>>()
    };
    assert_eq!(bored(40.0, -14.0), []);
    assert_eq!(bored(40.0, -22.0), [("thread-in-stock", 13)]);
    assert_eq!(bored(9.0, -22.0), [("retract-in-stock", 13)], "its bottom");
}

/// Programs of the project are not warned of what they do not do.
#[test]
fn no_example_is_warned_of_a_shoulder_or_of_lengths() {
    let project = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let machines = [Machine::plain(), Machine::from_toml(SMALL_MILL).expect("shipped")];
    let mut looked_at = 0;
    for folder in [
        "examples",
        "examples/fanuc",
        "examples/first-hour",
        "examples/mill",
        "examples/shape",
        "tests/conformance/programs",
    ] {
        for entry in std::fs::read_dir(project.join(folder)).expect("a folder of programs") {
            let path = entry.expect("a file").path();
            let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
            if !["ngc", "nc"].contains(&ending) {
                continue;
            }
            let Ok(text) = std::fs::read_to_string(&path) else { continue };
            let mill = ["examples/mill", "examples/shape"].contains(&folder);
            let mut machine = machines[usize::from(mill)].clone();
            if folder == "examples/fanuc" {
                machine.general.dialect = ProgramDialect::Fanuc;
            }
            let check = interpreter::check(&path.display().to_string(), &text, &machine);
            let new = ["thread-in-stock", "other-length", "no-length", "comment-units"];
            let found: Vec<_> = check.diagnostics.iter().filter(|one| new.contains(&one.code)).collect();
            assert!(found.is_empty(), "{found:#?}");
            looked_at += 1;
        }
    }
    assert!(looked_at > 60, "{looked_at}");
}

#[test]
fn the_part_lies_where_the_program_has_its_zero() {
    let at = |z: f64| {
        format!("{HEAD}G10 L2 P1 X0 Z{z}\nG54\n(part, bar D40 L60)\nG0 X30 Z5\nG0 Z-5\nG0 X10\nM2\n")
    };
    assert_eq!(found(&at(-100.0)), [("rapid-in-stock", 7)], "by the coordinates of the program");
    let machine =
        format!("{HEAD}G10 L2 P1 X0 Z-100\nG54\n(part, bar D40 L60)\nG0 X30 Z5\nG53 G0 X10 Z-94\nM2\n");
    assert_eq!(found(&machine), [], "Z6 of the program");
    let mut program = at(-100.0);
    program.insert_str(
        program.find("M2").expect("an end"),
        "S600 M3\nG0 X40\nG0 Z8\nG76 P2 Z-20 I-1 J0.3 K1.2\n",
    );
    let check = interpreter::check("part.ngc", &program, &Machine::plain());
    assert!(!check.passes.is_empty() && check.passes.iter().all(|pass| pass.origin_mm == [0.0, -100.0]));
    assert_eq!(check.part, Part::from_comment("part, bar D40 L60", 1.0).expect("a part"));
}

#[test]
fn a_comment_is_in_inch_where_the_program_is_and_fanuc_has_it_too() {
    let part = |program: &str, dialect| {
        let mut machine = Machine::plain();
        machine.general.dialect = dialect;
        let check = interpreter::check("part", program, &machine);
        assert!(check.is_good(), "{:#?}", check.diagnostics);
        check.part.expect("it says what the part is")
    };
    let bar = |text: &str| Part::from_comment(text, 1.0).expect("a part").expect("a part");
    let inch = part("G18 G20 G90\n(part, bar D2 L4)\nM2\n", ProgramDialect::Linuxcnc);
    assert_eq!(inch, bar("part, bar D50.8 L101.6"));
    let fanuc = part("%\nO0001 (PART, TUBE D40 I20 L60 C-50)\nG21 M30\n%\n", ProgramDialect::Fanuc);
    assert_eq!(fanuc, bar("part, tube D40 I20 L60 C-50"));
}

#[test]
fn numbers_above_the_unit_that_is_meant_are_warned_of() {
    let inch = "(part, bar D2 L4)\nG18 G20 G90\nM2\n";
    let check = interpreter::check("part.ngc", inch, &Machine::plain());
    let [said] = &check.diagnostics[..] else { panic!("{:#?}", check.diagnostics) };
    assert_eq!((said.code, said.line), ("comment-units", 1));
    assert!(said.message.contains("in mm") && said.message.contains("G20"), "{said:#?}");
    assert_eq!(found("(part, bar D40 L60)\nG18 G21 G90\nM2\n"), []);
    assert_eq!(found("G18 G90 G8\n(part, bar D40 L60)\nG0 X30 Z5\nG20\nG0 X2\nM2\n"), [], "later");
    assert_eq!(found("G20\n(part, bar D2 L4)\nM2\n"), []);
    assert_eq!(found("(thread_insert, A60 R0.005)\nG20\nM2\n"), [("comment-units", 1)]);
}

#[test]
fn what_cannot_be_is_an_error_at_its_line() {
    for (program, words) in [
        ("(part, bra D40 L60)\n", "cannot be \"bra\""),
        ("(part bar D40 L60)\n", "a comma is missing"),
        ("(part, bar D40 L60)\n(part, bar D40 L60)\n", "said before"),
    ] {
        let check = interpreter::check("part.ngc", &format!("{program}M2\n"), &Machine::plain());
        let [found] = &check.diagnostics[..] else { panic!("{:#?}", check.diagnostics) };
        assert_eq!((found.code, found.line as usize), ("bad-part", program.lines().count()));
        assert!(found.message.contains(words) && !found.help.is_empty(), "{found:#?}");
    }
    assert_eq!(found("(PART NO 4711)\n(part 1 of 2)\nM2\n"), []);
}

/// What is found in a program of a mill with a tool of 10 mm.
fn milled(program: &str) -> Vec<(&'static str, u32)> {
    let mut machine = Machine::from_toml(SMALL_MILL).expect("shipped");
    let tool = machine::Tool { name: "end mill".into(), width_mm: Some(10.0), ..machine::Tool::default() };
    machine.tools.insert("1".into(), tool.clone());
    machine.tools.insert("2".into(), machine::Tool { width_mm: None, ..tool });
    let program = format!("G17 G21 G90 G94 F800\n{program}M5\nM2\n");
    let check = interpreter::check("part.ngc", &program, &machine);
    check.diagnostics.iter().map(|one| (one.code, one.line)).collect()
}

const SMALL_MILL: &str = include_str!("../../../examples/machines/small-mill.toml");
const BLOCK: &str = "(part, block X0 Y0 Z-20 X50 Y40 Z0)\n";

#[test]
fn a_mill_is_warned_of_what_goes_into_its_block() {
    // Face, pocket, slot from outside, a hole with pecks; and back where it was cut.
    let good = "T1 M6\nS3000 M3\nG0 X-10 Y10 Z5\nG0 Z-1\nG1 X60\nG0 Y19\nG1 X-10\nG0 Z5\nG0 X20 Y20\nG1 Z-4\nG1 X30\nG3 X30 Y24 J2\n\
                G0 Z5\nG0 X20 Y20\nG0 Z-3.9\nG0 Z5\nG83 X40 Y35 Z-12 R2 Q3\nG80\nG0 Z50\n";
    assert_eq!(milled(&format!("{BLOCK}{good}")), []);
    for (program, expected) in [
        ("T1 M6\nS3000 M3\nG0 X10 Y10 Z5\nG0 Z-1\n", vec![("rapid-in-stock", 6)]),
        ("T1 M6\nG0 X-10 Y10 Z5\nG0 Z-1\nG1 X60\n", vec![("cut-at-rest", 6)]),
        ("T1 M6\nG0 X-3 Y-20 Z5\nG0 Z-4\nG1 Y60\n", vec![("cut-at-rest", 6)]),
        (
            "T2 M6\nG0 X10 Y10 Z5\nG1 Z-1\nG0 Z5\nG0 X20\nG0 Z-5\n",
            vec![("cut-at-rest", 5), ("stock-unknown", 5)],
        ),
        ("G54\nG10 L2 P1 X-30 Y-30 Z0\nT1 M6\nG0 X10 Y10 Z5\nG0 Z-1\n", vec![("rapid-in-stock", 7)]),
        ("G10 L2 P1 R30\nT1 M6\nG0 X10 Y10 Z5\nG0 Z-1\n", vec![("stock-unknown", 5)]),
    ] {
        assert_eq!(milled(&format!("{BLOCK}{program}")), expected, "{program}");
    }
}

#[test]
fn a_mill_has_a_block_and_a_lathe_has_none() {
    assert_eq!(milled("(part, bar D40 L60)\n"), [("bad-part", 2)]);
    assert_eq!(milled(&format!("{BLOCK}{BLOCK}")), [("bad-part", 3)]);
    assert_eq!(found(&format!("{HEAD}{BLOCK}M2\n")), [("bad-part", 2)]);
}

/// X and Y of the block are those of the machine once it is cut: there the report draws it.
#[test]
fn a_block_lies_where_the_program_has_its_zero() {
    let mill = Machine::from_toml(SMALL_MILL).expect("shipped");
    let program = format!(
        "G17 G21 G90 G94 F800\n{BLOCK}G10 L2 P1 X-30 Y-20 Z0\nS900 M3\nG0 X-9 Y0 Z5\nG1 Z-1\nM5\nM2\n"
    );
    let check = interpreter::check("part.ngc", &program, &mill);
    let block = check.part.and_then(|part| part.block()).expect("a block");
    assert_eq!((block.low_mm, block.high_mm), ([-30.0, -20.0, -20.0], [20.0, 20.0, 0.0]));
}
