//! Bad programs: each error with its code, line and column, and a remedy.

use interpreter::{Severity, check};
use machine::Machine;

use crate::jobs::mill;

/// `(program, line, column, code)` of the first diagnostic.
const SPELLING: [(&str, u32, u32, &str); 24] = [
    ("G0 X1\n?\nM2", 2, 1, "bad-character"),
    ("G0 X1 %\nM2", 1, 7, "bad-character"),
    ("G0 X1 /\nM2", 1, 7, "bad-character"),
    ("G0 X1 é\nM2", 1, 7, "bad-character"),
    ("G0 X1 (open\nM2", 1, 7, "unclosed-comment"),
    ("(a (b) c)\nM2", 1, 1, "nested-comment"),
    ("G0 X Z1\nM2", 1, 6, "missing-value"),
    ("G0 X\nM2", 1, 5, "missing-value"),
    ("#1 5\nM2", 1, 5, "missing-value"),
    ("G0 X1.2.3\nM2", 1, 5, "bad-number"),
    ("G0 X.\nM2", 1, 5, "bad-number"),
    ("G0 X[1+[2]\nM2", 1, 5, "missing-bracket"),
    ("G0 X SIN 30\nM2", 1, 10, "missing-bracket"),
    ("G0 X[1 plus 2]\nM2", 1, 8, "unknown-operator"),
    ("G0 XTANH[1]\nM2", 1, 8, "missing-bracket"),
    ("G0 X[1/0]\nM2", 1, 6, "arithmetic"),
    ("G0 XSQRT[-4]\nM2", 1, 5, "arithmetic"),
    ("G0 X[[0-2]**.5]\nM2", 1, 6, "arithmetic"),
    ("G0 XLN[0]\nM2", 1, 5, "arithmetic"),
    ("#0=1\nM2", 1, 1, "bad-parameter"),
    ("G0 X#6000\nM2", 1, 5, "bad-parameter"),
    ("G0 X#1.5\nM2", 1, 5, "bad-parameter"),
    ("G0 N5 X1\nM2", 1, 4, "misplaced-line-number"),
    ("N X1\nM2", 1, 1, "bad-line-number"),
];

const MEANING: [(&str, u32, u32, &str); 30] = [
    ("G0 X1\n", 1, 1, "no-program-end"),
    ("%\nG0 X1\n", 2, 1, "no-program-end"),
    ("G63\nM2", 1, 1, "unknown-g-code"),
    ("G1.55 X1\nM2", 1, 1, "unknown-g-code"),
    ("M44\nM2", 1, 1, "unknown-m-code"),
    ("G17 F60 G2 X60 I5\nM2", 1, 1, "not-available"),
    ("M62 P1\nM2", 1, 1, "unknown-output"),
    ("M64 P1\nM2", 1, 1, "unknown-output"),
    ("M19 R90\nM2", 1, 1, "not-available"),
    ("F60 G18 G2 X70 I5 Z130\nM2", 1, 16, "arc-radius"),
    ("o100 sub\nM2", 1, 1, "missing-end"),
    ("G0 X#<width>\nM2", 1, 5, "unknown-name"),
    ("#5420=1\nM2", 1, 1, "bad-parameter"),
    ("G0 X1 Y2\nM2", 1, 7, "no-such-axis"),
    ("G0 X1 D2\nM2", 1, 7, "unused-word"),
    ("G0 X3 X4\nM2", 1, 7, "repeated-word"),
    ("G0 G1 X2\nM2", 1, 4, "modal-group"),
    ("M3 S5 M5\nM2", 1, 7, "modal-group"),
    ("G90 G91\nM2", 1, 5, "modal-group"),
    ("G0 X1 P3\nM2", 1, 7, "unused-word"),
    ("X1\nM2", 1, 1, "no-motion-mode"),
    ("G4\nM2", 1, 1, "missing-word"),
    ("G4 P-1\nM2", 1, 4, "bad-value"),
    ("G1 X2\nM2", 1, 1, "no-feed"),
    ("F100\nG95 G1 X2\nM2", 2, 1, "no-feed"),
    ("S100 G95 F.1 G1 X2\nM2", 1, 1, "spindle-not-turning"),
    ("S4000 M3\nM2", 1, 1, "speed-limit"),
    ("F-1 G1 X1\nM2", 1, 1, "bad-value"),
    ("G0 X10 Z500\nM2", 1, 8, "travel-limit"),
    ("T1.5\nM2", 1, 1, "bad-value"),
];

/// After a preamble of one line: G21 G90 S400 M3 G0 X7 Z4.
const THREADS: [(&str, u32, u32, &str); 24] = [
    ("M5\nG33 Z-20 K1\nG0 X20\n", 3, 1, "spindle-not-turning"),
    ("G33 Z-20 K1 F100\nG0 X20\n", 2, 13, "feed-in-thread"),
    ("G33 Z-20\nG0 X20\n", 2, 1, "missing-word"),
    ("G33 Z-20 K-1\nG0 X20\n", 2, 10, "bad-value"),
    ("G33 X20 K1\nM8\nG33 X30 K1\n", 4, 1, "not-available"),
    ("G33 Z-20 K1\nG0 X20\nG33 Z-40 K1\nX25 K1\n", 5, 1, "bad-value"),
    ("G33 Z-20 K1 I1\nG0 X20\n", 2, 13, "unused-word"),
    ("G33 Z4.01 K1\nG0 X20\n", 2, 1, "pass-not-feasible"),
    ("G33 Z-100 K90\nG0 X20\n", 2, 1, "pass-not-feasible"),
    ("G76 P1 Z-20 I-2 J.2\n", 2, 1, "missing-word"),
    ("G76 P1 Z-20 I0 J.2 K.6\n", 2, 13, "bad-value"),
    ("G76 P1 Z-20 I-2 J.7 K.6\n", 2, 17, "bad-value"),
    ("G76 P1 Z-20 I-2 J-.2 K.6\n", 2, 17, "bad-value"),
    ("G76 P0 Z-20 I-2 J.2 K.6\n", 2, 5, "bad-value"),
    ("G76 P1 Z-20 I-2 J.2 K.6 R.5\n", 2, 25, "bad-value"),
    ("G76 P1 Z-20 I-2 J.2 K.6 Q85\n", 2, 25, "bad-value"),
    ("G76 P1 Z-20 I-2 J.2 K.6 H1.5\n", 2, 25, "bad-value"),
    ("G76 P1 Z-20 I-2 J.2 K.6 L4\n", 2, 25, "bad-value"),
    ("G76 P1 Z-20 I-2 J.2 K.6 L1\n", 2, 25, "bad-value"),
    ("G76 P1 Z-20 I-2 J.2 K.6 E25 L1\n", 2, 25, "bad-value"),
    ("G76 P1 Z-20 I-2 J.2 K.6 E.001 L2\n", 2, 1, "pass-not-feasible"),
    ("G76 P1 Z-20 I-2 J.00001 K.6\n", 2, 1, "bad-value"),
    ("G76 P1 Z-20 I-2 J.2 K.6 X5\n", 2, 25, "unused-word"),
    ("G76 P1 Z-20 I-2 J.2 K.6\nX5\n", 3, 1, "missing-word"),
];

/// What is wrong with the first error of a program, as a line to read; nothing if it is as expected.
fn compare(source: &str, expected: (u32, u32, &str)) -> Option<String> {
    let check = check("bad.ngc", source, &Machine::plain());
    let first = check.diagnostics.iter().find(|diagnostic| diagnostic.severity == Severity::Error);
    let Some(first) = first else { return Some(format!("no error in {source:?}")) };
    let shown = first.render(false);
    let found = (first.line, first.column, first.code);
    let (line, column, code) = found;
    let complete = shown.starts_with(&format!("bad.ngc:{line}:{column}: error[{code}]: "))
        && !first.help.is_empty()
        && shown.contains("help:")
        && shown.contains('^');
    (found != expected || !complete).then(|| format!("{expected:?} but {found:?} in {source:?}\n{shown}"))
}

fn assert_all(programs: impl Iterator<Item = (String, u32, u32, &'static str)>) {
    let wrong: Vec<String> =
        programs.filter_map(|(source, line, column, code)| compare(&source, (line, column, code))).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn assert_first(source: &str, expected: (u32, u32, &str)) {
    assert_eq!(compare(source, expected), None);
}

#[test]
fn spelling() {
    assert_all(
        SPELLING.into_iter().map(|(source, line, column, code)| (source.to_owned(), line, column, code)),
    );
}

#[test]
fn meaning() {
    assert_all(
        MEANING.into_iter().map(|(source, line, column, code)| (source.to_owned(), line, column, code)),
    );
}

#[test]
fn threads() {
    let whole = |blocks: &str| format!("G21 G90 S400 M3 G0 X7 Z4\n{blocks}M2\n");
    assert_all(THREADS.into_iter().map(|(blocks, line, column, code)| (whole(blocks), line, column, code)));
}

#[test]
fn limits_are_named() {
    let long = format!("G0 X1 {}\nM2", " ".repeat(5000));
    assert_first(&long, (1, 4097, "line-too-long"));
    let deep = format!("G0 X{}1{}\nM2", "[".repeat(80), "]".repeat(80));
    assert_first(&deep, (1, 70, "expression-too-deep"));
    let signs = format!("G0 X{}1\nM2", "-".repeat(100));
    assert_first(&signs, (1, 70, "expression-too-deep"));
    for (source, named) in [
        ("S4000 M3\nM2", "3000"),
        ("G0 X130\nM2", "axis.x.travel_mm = [-5, 120]"),
        ("G0 X#6000\nM2", "6000"),
        (&deep, "64"),
        (&long, "4096"),
    ] {
        let check = check("bad.ngc", source, &Machine::plain());
        let shown = check.diagnostics[0].render(false);
        assert!(shown.contains(named), "{shown}");
    }
}

#[test]
fn unknown_tools_are_refused_once_there_is_a_table() {
    let mut machine = Machine::plain();
    assert!(check("t.ngc", "T7\nM2", &machine).is_good());
    machine.tools.insert("3".into(), machine::Tool::default());
    assert!(check("t.ngc", "T3\nM2", &machine).is_good());
    assert_eq!(check("t.ngc", "T7\nM2", &machine).diagnostics[0].code, "unknown-tool");
}

#[test]
fn several_errors_are_reported_at_once() {
    let source = "G0 X500 Y1\nG2 M8 X1\nG0 Z900\nG1 X5\nM2\n";
    let check = check("bad.ngc", source, &Machine::plain());
    let found: Vec<_> = check.diagnostics.iter().map(|d| (d.line, d.column, d.code)).collect();
    assert_eq!(
        found,
        [(1, 9, "no-such-axis"), (2, 1, "no-feed"), (3, 4, "travel-limit"), (4, 1, "spindle-not-turning")],
        "a feed that is missed is missed once"
    );
}

#[test]
fn a_diagnostic_shows_place_words_and_remedy() {
    let source = "G21 G90\nS4000 M3 (too fast)\nM2\n";
    let check = check("part.ngc", source, &Machine::plain());
    let expected = "\
part.ngc:2:1: error[speed-limit]: S4000 is outside what the spindle can do: 0.01 to 3000 1/min (spindle.max_rpm)
  |
2 | S4000 M3 (too fast)
  | ^^^^^
  |
  = help: give at most S3000
";
    assert_eq!(check.diagnostics[0].render(false), expected);
}

#[test]
fn colour_is_only_colour() {
    let source = "G2 X1\nM2\n";
    let check = check("bad.ngc", source, &Machine::plain());
    let (plain, colour) = (check.diagnostics[0].render(false), check.diagnostics[0].render(true));
    assert!(!plain.contains('\u{1b}') && colour.contains('\u{1b}'), "{plain}{colour}");
}

#[test]
fn a_program_that_moves_for_ever_is_not_read_for_ever() {
    assert_first("o1 while [1]\nG0 X10\nG4 P80000\nX20\no1 endwhile\nM2\n", (3, 1, "endless-program"));
}

#[test]
fn feeds_that_are_none_are_refused_and_not_waited_for() {
    let errors = |text: &str| -> Vec<(u32, &'static str)> {
        let diagnostics = interpreter::check("part.ngc", text, &Machine::plain()).diagnostics;
        diagnostics
            .iter()
            .filter(|one| one.severity == Severity::Error)
            .map(|one| (one.line, one.code))
            .collect()
    };
    assert_eq!(errors("G1 Z0 F0.0000001\nM2\n"), [(1, "no-feed")]);
    assert_eq!(errors("S1 M3\nG95 F0.01\nG1 Z0\nM2\n"), [(3, "no-feed")]);
    // S of G96 is too much for G97: the spindle stands, and a feed per revolution with it.
    let text = "G96 S6000 D1000 M3\nG97\nG95 F0.1\nG1 Z0\nM2\n";
    assert!(errors(text).contains(&(4, "spindle-not-turning")), "{:?}", errors(text));
    assert_eq!(errors("G96 S100 D1000 M3\nG95 F0.05\nG1 Z0\nM2\n"), []);
}

#[test]
fn a_mistake_gives_one_message() {
    let codes = |text: &str| -> Vec<&'static str> {
        check("part.ngc", text, &Machine::plain()).diagnostics.iter().map(|one| one.code).collect()
    };
    assert_eq!(codes("S500 M3\nG1 X10 Z0 F1000000000000\nX20\nZ-5\nM2\n"), ["bad-value"]);
    // The arc would begin where the line beyond the travel did not end; what stays there has the same cause.
    assert_eq!(
        codes("F100 S500 M3\nG1 X10 Z0\nX500\nG2 X490 Z-10 I-10\nG1 X20 Z-20\nM2\n"),
        ["travel-limit"]
    );
    assert_eq!(codes("S500 M3\nG0 X500\nX510\nX10\nZ900\nX500\nM2\n"), ["travel-limit"; 3]);
}

const CURVE: &str = "X9 Z-5 R1 K0\nX9 Z-9 R1 K0\nG6.2 K1\nG6.2 K1\nG6.2 K1\nG3 X5 Z-13 R4\nG1 X20\nM2\n";

/// A refused block leaves behind what it says, but for the word that is wrong: those after it are not blamed.
#[test]
fn blocks_behind_a_refused_one_are_not_blamed() {
    let arcs = "G3 X20 Z-3 K-3\nG1 Z-18\nG2 X28 Z-22 I4\nG1 X30\nM2\n";
    let threads = "G0 X12 Z5\nG33 Z-10 K1\nG0 X20\nZ5\nX11\nG33 Z-10 K1\nG0 X20\nM2\n";
    for (text, line, code) in [
        // A word too much: modes, feed, speed and the end of the block count.
        (format!("G18 G90 G7 A5\nS500 M3 F100\nG0 X14 Z2\nG1 Z0\n{arcs}"), 1, "no-motion-mode"),
        (format!("G18 G90 G7 J5\nS500 M3 F100\nG0 X14 Z2\nG1 Z0\n{arcs}"), 1, "unused-word"),
        (format!("G18 G90 G7\nS500 M3 F100 Q1\nG0 X14 Z2\nG1 Z0\n{arcs}"), 2, "unused-word"),
        (format!("G18 G90 G7\nS500 M3 F100\nG0 X14 Z2\nG1 Z0 V1\n{arcs}"), 4, "not-available"),
        (format!("G18 G90 G7\nS500 M3 F100\nG0 X14 Z2 X14\nG1 Z0\n{arcs}"), 3, "repeated-word"),
        (format!("G18 G90 G7 G360\nS500 M3 F100\nG0 X14 Z2\nG1 Z0\n{arcs}"), 1, "unknown-g-code"),
        // An arc that cannot be, and a line beyond the travel.
        (format!("G18 G90 G7\nS500 M3 F100\nG0 X10 Z2\nG1 Z0\nG2 X14 Z0 R0.5\n{arcs}"), 5, "arc-radius"),
        (format!("G18 G90 G7\nS500 M3 F100\nG0 X14 Z2\nG1 Z0 X900\n{arcs}"), 4, "travel-limit"),
        // A spindle that was not started, one that is too fast, one that turns back.
        (format!("G18 M-3 S500\n{threads}"), 1, "unknown-m-code"),
        (format!("G18 M3 R500\n{threads}"), 1, "unused-word"),
        (format!("G18 M3 S-500\n{threads}"), 1, "bad-value"),
        (format!("G18 M3 S3500\n{threads}"), 1, "speed-limit"),
        // The curve of G6.2 without its order, or a weight: what follows begins where it would have ended.
        (format!("G18 G90 G8 F100 S500 M3\nG0 X0 Z0\nG6.2 Q1 X0 Z0 R1 K0\n{CURVE}"), 3, "missing-word"),
        (format!("G18 G90 G8 F100 S500 M3\nG0 X0 Z0\nG6.2 P3 Q1 X0 Z0 K0\n{CURVE}"), 3, "missing-word"),
        (format!("G18 G90 G8 F100 S500 M3\nG0 X0 Z0\nG6.2 P3 X0 Z0 R1 K0\n{CURVE}"), 3, "missing-word"),
        // Words of a cycle that stay in force are blamed once.
        ("G17 F100 S500 M3\nG0 X0 Z5\nG83 X0 Z-5 R2 Q0\nX0\nX0 Z-6\nG80\nM2\n".into(), 3, "bad-value"),
    ] {
        let found = check("part.ngc", &text, &Machine::plain()).diagnostics;
        let found: Vec<_> = found.iter().filter(|one| one.severity == Severity::Error).collect();
        let places: Vec<_> = found.iter().map(|one| (one.line, one.code)).collect();
        assert_eq!(places, [(line, code)], "{text}");
    }
}

/// The same of FANUC programs, on a lathe and on a mill.
#[test]
fn blocks_behind_a_refused_one_are_not_blamed_in_fanuc() {
    let head = "O1\nG97 S500 M03\nT0101\nG00 X50. Z2.\n";
    let contour = "N10 G00 X20.\nG01 Z-5. F0.1\nN20 X50.\nG70 P10 Q20\nM30\n";
    let lathe = [
        (format!("{head}G71 U2. R0.5 L1\nG71 P10 Q20 U0.2 W0.1 F0.2\n{contour}"), 5, "unused-word"),
        (format!("{head}G92 X48. Z-10. F0\nX47.\nX46.\nG00 X60.\nM30\n"), 5, "bad-value"),
        (format!("{head}G01 X40. ,R1. F0.1\nZ-10. E5\nX50.\nM30\n"), 6, "unused-word"),
        (format!("{head}G01 X40. ,C1. F0.1\nZ-10. Z-10.\nX50.\nM30\n"), 6, "repeated-word"),
        (format!("{head}#1=0\nWHILE [#1 LL 3] DO 1\n#1=#1+1\nEND 1\nM30\n"), 6, "unknown-operator"),
        (
            format!("{head}#1=5\nIF [#1 NE #0] GOTO 10 P5\n#3000=1 (NO NUMBER)\nN10 G00 X60.\nM30\n"),
            6,
            "unused-word",
        ),
    ];
    let milled = [
        (
            "O1\nG90 G21\nS1000 M03\nG00 X0 Y0 Z10.\nG83 X10. Y10. Z-10. R2. Q0 F100.\nX20.\nX30.\nG80\nM30\n",
            5,
            "bad-value",
        ),
        (
            "O1\nG90 G21\nS1000 M03\nG00 X0. Y0. Z10.\nG01 X20. F100. B1.\nG02 X30. Y0. R5.\nM30\n",
            5,
            "no-such-axis",
        ),
    ];
    let milled = milled.map(|(text, line, code)| (text.to_owned(), line, code));
    for (machine, programs) in [(Machine::plain(), &lathe[..]), (mill(), &milled)] {
        for (text, line, code) in programs {
            let language = interpreter::Language::default();
            let program = interpreter::open_text("part.nc", text.clone().into_bytes(), &language, &machine)
                .expect("a program");
            let check = interpreter::check_program(program, &machine, |_| {});
            let found: Vec<_> =
                check.diagnostics.iter().filter(|one| one.severity == Severity::Error).collect();
            let places: Vec<_> = found.iter().map(|one| (one.line, one.code)).collect();
            assert_eq!(places, [(*line, *code)], "{text}{found:#?}");
        }
    }
}

/// Posts differ in what X and the centre of an arc are: where another reading fits, the help says which.
#[test]
fn an_arc_that_fits_in_another_reading_says_so() {
    let help = |text: &str| {
        let found = check("part.ngc", text, &Machine::plain()).diagnostics;
        found.iter().find(|one| one.code == "arc-radius").map(|one| one.help.clone()).unwrap_or_default()
    };
    let head = "G18 G90 F100 S500 M3\n";
    // A quarter of 0.6 mm, X as a diameter.
    let diameters = help(&format!("{head}G0 X18 Z1\nG1 Z0\nG3 X19.2 Z-0.6 I0 K-0.6\nM2\n"));
    assert!(diameters.contains("with X as a diameter the arc fits: write G7"), "{diameters}");
    let points = help(&format!("{head}G0 X20 Z0\nG2 X25 Z-5 I25 K0\nM2\n"));
    assert!(points.contains("as a point of the program (G90.1)"), "{points}");
    let relative = help(&format!("{head}G90.1\nG0 X20 Z0\nG2 X25 Z-5 I5 K0\nM2\n"));
    assert!(relative.contains("from the start of the arc (G91.1)"), "{relative}");
    let neither = help(&format!("{head}G0 X20 Z0\nG2 X25 Z-5 I7 K1\nM2\n"));
    assert!(neither.contains("more digits"), "{neither}");
}
