//! What a program means does not change when it is written as the house does; what a word means is what the
//! pages say, of every word.

use std::path::{Path, PathBuf};

use gcode::canon::{PlainPrinter, Units};
use gcode::codes::{G, M, g_group, m_group};
use gcode::{Dialect, Options, Program, Step};
use lsp::{Around, formatted, meaning};
use testing::Seed;

fn project() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Every program of the project, with its dialect.
fn programs() -> Vec<(PathBuf, Dialect)> {
    let folders =
        ["tests/conformance/programs", "examples", "examples/fanuc", "examples/shape", "examples/bar-feeder"];
    let entries =
        folders.iter().flat_map(|folder| std::fs::read_dir(project().join(folder)).expect("a folder"));
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let mut programs: Vec<_> = paths
        .filter_map(|path| match path.extension()?.to_str()? {
            "ngc" => Some((path, Dialect::Linuxcnc)),
            "nc" => Some((path, Dialect::Fanuc)),
            _ => None,
        })
        .collect();
    programs.sort_by(|(a, _), (b, _)| a.cmp(b));
    assert!(programs.len() > 120, "{}", programs.len());
    programs
}

/// The calls of a program, and the codes of what is wrong with it.
fn calls(text: &str, dialect: Dialect) -> (String, Vec<&'static str>) {
    let folder = project().join("tests/conformance/programs");
    let options = Options { dialect, subroutine_folders: vec![folder], ..Options::default() };
    let mut program = Program::from_text("program", text, &options);
    let (mut printed, mut wrong) = (Vec::new(), Vec::new());
    let mut printer = PlainPrinter::new(&mut printed, Units::Millimetre);
    loop {
        match program.step(&mut printer) {
            Ok(Step::More) => {}
            Ok(Step::Ended) => break,
            Err(error) => wrong.push(error.code),
        }
    }
    printer.flush().expect("it is written to memory");
    drop(printer);
    (String::from_utf8(printed).expect("text"), wrong)
}

fn written(text: &str, dialect: Dialect) -> String {
    let lines: Vec<&str> = text.split('\n').collect();
    let new = formatted(lines.iter().copied(), dialect);
    let lines: Vec<String> =
        lines.iter().zip(new).map(|(line, new)| new.unwrap_or_else(|| (*line).into())).collect();
    lines.join("\n")
}

/// A program as somebody else may write it: other blanks, other letters.
fn otherwise(text: &str, random: &mut Seed) -> String {
    let mut out = String::new();
    let mut inside = false;
    for c in text.chars() {
        inside = match c {
            '(' | ';' | '<' => true,
            ')' | '>' | '\n' => false,
            _ => inside,
        };
        match c {
            ' ' if !inside && random.chance(0.2) => out.push_str("  "),
            c if !inside && c.is_ascii_alphabetic() && random.chance(0.3) => out.push(c.to_ascii_lowercase()),
            c => out.push(c),
        }
        if c == '\n' && random.chance(0.3) {
            out.push_str("   ");
        }
    }
    out
}

#[test]
fn a_program_means_the_same_as_the_house_writes_it() {
    let mut random = Seed::new(11);
    let mut changed = 0;
    for (path, dialect) in programs() {
        let text = gcode::readable(&std::fs::read(&path).expect("read"));
        for text in [text.clone(), otherwise(&text, &mut random), otherwise(&text, &mut random)] {
            let new = written(&text, dialect);
            changed += u32::from(new != text);
            assert_eq!(calls(&new, dialect), calls(&text, dialect), "{}:\n{new}", path.display());
            assert_eq!(written(&new, dialect), new, "{}: once is enough", path.display());
        }
    }
    assert!(changed > 200, "{changed} were changed");
}

/// What is said of the first word of a line.
fn said(line: &str, byte: usize, dialect: Dialect) -> String {
    said_in(line, byte, &Around { dialect, system_b: false, modal: None })
}

fn said_in(line: &str, byte: usize, around: &Around) -> String {
    meaning(line, byte, around).map_or(String::new(), |(_, told)| told)
}

/// The same behind a code that is in force.
fn said_behind(line: &str, byte: usize, dialect: Dialect, modal: &str) -> String {
    said_in(line, byte, &Around { dialect, system_b: false, modal: Some(modal) })
}

#[test]
fn every_code_is_explained() {
    for number in 0..2000 {
        let (g, m) = (G(number), M(number));
        if g_group(g).is_some() {
            assert!(said(&g.to_string(), 1, Dialect::Linuxcnc).starts_with(&format!("**{g}**")), "{g}");
        }
        if m_group(m).is_some() {
            assert!(said(&m.to_string(), 1, Dialect::Linuxcnc).starts_with(&format!("**{m}**")), "{m}");
        }
    }
    assert!(
        said("G01 X1.", 1, Dialect::Fanuc).contains("line")
            && !said("G01 X1.", 1, Dialect::Fanuc).contains("rapid")
    );
    assert!(said("G31", 1, Dialect::Fanuc).contains("measure before"));
    assert!(said("M03", 1, Dialect::Fanuc).contains("spindle clockwise"));
}

#[test]
fn every_word_is_explained_by_the_code_of_its_block() {
    use Dialect::{Fanuc, Linuxcnc};
    for (line, at, dialect, words) in [
        ("G76 P2 Z-22 I-2 J0.7 K2.454 R2 Q29.5 H2", 16, Linuxcnc, "depth of the first pass"),
        ("G76 P2 Z-22 I-2 J0.7 K2.454 R2 Q29.5 H2", 4, Linuxcnc, "lead, along Z"),
        ("G83 X0 Z-12 R2 Q4", 15, Linuxcnc, "Q"),
        ("G1 Z-30 F120", 8, Linuxcnc, "G93, G94, G95"),
        ("G1 Z-30 F120", 3, Linuxcnc, "mm (G21) or inch (G20)"),
        ("S800 M3", 0, Linuxcnc, "spindle speed"),
        ("T1 M6", 0, Linuxcnc, "tool for the next M6"),
        ("G01 Z-30. F0.2", 10, Fanuc, "per revolution (G99)"),
        ("G01 X40.", 4, Fanuc, "diameter"),
        ("T0101", 2, Fanuc, "tool and offset"),
        ("O1001 (SHAFT)", 2, Fanuc, "number of a program"),
        ("G0 X#5220", 6, Linuxcnc, "system in force (1 is G54)"),
        ("#5162=1", 2, Linuxcnc, "points of G28, G30"),
        ("#31=1", 2, Linuxcnc, "the program"),
        ("#5=1", 1, Linuxcnc, "its arguments"),
        ("G0 X#<_feed>", 7, Linuxcnc, "F and S"),
        ("#<depth>=1", 3, Linuxcnc, "the subroutine that sets it"),
        ("#3006=1", 2, Fanuc, "message and stop"),
        ("#500=1", 2, Fanuc, "common"),
        ("o100 call [1]", 6, Linuxcnc, "up to 30 arguments"),
        ("o<a> while [1]", 6, Linuxcnc, "while"),
        ("G0 X[sqrt[#1]]", 6, Linuxcnc, "SQRT"),
        ("IF [#1 EQ 2] GOTO 10", 15, Fanuc, "GOTO n"),
        ("(MSG, change the insert)", 3, Linuxcnc, "the text"),
        ("(thread, M20x2-6g)", 3, Linuxcnc, "A gauge judges it"),
        ("( part, bar D40 L60)", 3, Linuxcnc, "bar D40 L60"),
        ("(on_hold, leave)", 3, Linuxcnc, "interrupted"),
    ] {
        let told = said(line, at, dialect);
        assert!(told.contains(words), "{line}: {words}: {told}");
        assert!(!told.contains("]("), "no link leads out of an editor: {told}");
    }
    assert!(said_behind("X30", 0, Linuxcnc, "G83").contains("of G83: the hole"));
    // A code of the block takes the place of the one in force, and what a letter is to a code is told alone.
    for (line, at, words) in [
        ("G1 Z-5", 3, "where the move goes"),
        ("M66 P1 L3 Q2", 4, "number of the input"),
        ("G71 Q100 R1", 9, "retracts"),
        ("G64 P0.01", 4, "rounded"),
        ("G33 Z-10 K1.5", 9, "in a turn"),
        ("G41 D2", 4, "tool whose radius"),
        ("G96 S150 D2000", 9, "highest speed"),
    ] {
        let told = said_behind(line, at, Linuxcnc, "G83");
        assert!(told.contains(words) && !told.contains("G83"), "{line}: {told}");
        assert!(!told.contains("belong to a code"), "{line}: {told}");
    }
    assert!(said("G3 X1 R2", 1, Linuxcnc).contains("G2 G3: arc clockwise, counterclockwise"));
    for (line, at) in [("(thread of the bolt)", 3), ("G0 X1 (note)", 8), ("G123", 1), ("", 0)] {
        assert_eq!(said(line, at, Linuxcnc), "", "{line}");
    }
}

/// A word of FANUC is what it is to the code of its block, not what the other dialect or another code takes
/// it for.
#[test]
fn words_of_fanuc_mean_what_their_codes_say() {
    use Dialect::{Fanuc, FanucMill};
    for (line, at, dialect, words) in [
        ("G71 U2. R0.5", 4, Fanuc, "depth of a cut"),
        ("G71 P10 Q20 U0.4 W0.1", 4, Fanuc, "first block of the contour"),
        ("G73 U5. W2. R3", 12, Fanuc, "number of passes"),
        ("G75 X10. P2000 Q3000", 9, Fanuc, "step along X"),
        ("G76 X26. Z-20. P1840 Q400 F1.5", 15, Fanuc, "height of the thread"),
        ("G76 P020060 Q100 R0.05", 17, Fanuc, "allowance of the finishing passes"),
        ("G92 X29. Z-20. F1.5", 15, Fanuc, "lead, mm or inch"),
        ("G04 X1.5", 4, Fanuc, "time, s"),
        ("G50 S2000", 4, Fanuc, "highest speed"),
        ("G65 P9100 A1. F0.1", 14, Fanuc, "#7 to #9"),
        ("M98 P21000", 4, Fanuc, "how often"),
        ("G01 X40. ,C2.", 10, Fanuc, "cut off"),
        ("G01 Z-30.", 4, Fanuc, "least input increments"),
        ("G96 S150 M03", 4, Fanuc, "surface speed"),
        ("G81 X1. Z-8. R2. K3", 17, FanucMill, "how often"),
        ("G83 Z-8. Q3.", 9, FanucMill, "depth of a peck"),
        ("G43 H02 Z5.", 4, FanucMill, "length (H)"),
        ("G54.1 P3 X1.", 6, FanucMill, "1 to 99"),
        ("G68 X1. Y0. R30.", 12, FanucMill, "angle"),
        ("G10 L12 P2 R5.", 11, FanucMill, "radius of the tool"),
        ("G02 X1. I5. J0.", 8, FanucMill, "centre"),
        ("G01 A30. F100.", 4, FanucMill, "degrees"),
        ("G65 P9100 A1.", 10, FanucMill, "#1 to #3"),
        ("S2000 M03", 6, FanucMill, "spindle clockwise"),
    ] {
        let told = said(line, at, dialect);
        assert!(told.contains(words), "{line}: {words}: {told}");
        assert!(told.lines().count() <= 4 && !told.contains("]("), "{line}: {told}");
    }
    // What has a meaning of its own has no other one.
    assert!(!said("G71 U2. R0.5", 4, Fanuc).contains("from the programmed point"));
    assert!(!said("G65 P9100 F0.1", 10, Fanuc).contains("per revolution"));
    assert!(said_behind("X30. Z-5.", 5, FanucMill, "G83").contains("bottom of the hole"));
    assert!(said("X30. Z-5.", 5, FanucMill).contains("where the move goes"));
}

/// A code of system B is not what it is in system A, and neither are the words of its block.
#[test]
fn codes_of_system_b_are_explained_as_system_b_has_them() {
    let said = |line: &str, at: usize, modal| {
        said_in(line, at, &Around { dialect: Dialect::Fanuc, system_b: true, modal })
    };
    for (line, at, modal, words, not) in [
        ("G77 X24. Z-20.", 1, None, "cycle along Z", "thread"),
        ("G78 X24. Z-20.", 1, None, "thread", "along X"),
        ("G79 X24. Z-20.", 1, None, "along X", "thread"),
        ("G33 Z-20. F1.5", 1, None, "thread move", "cycle"),
        ("G33 Z-20. F1.5", 10, None, "lead along the axis", "per minute"),
        ("G90 G00 X1.", 1, None, "absolute", "cycle"),
        ("G92 S3000", 1, None, "highest speed", "cycle"),
        ("G92 S3000", 4, None, "highest speed of the spindle", "surface"),
        ("G92 X10. Z5.", 4, None, "coordinates that this point has", "corner"),
        ("G94", 1, None, "per minute", "cycle"),
        ("G95 F0.2", 1, None, "per revolution", "cycle"),
        ("G95 F0.2", 4, None, "per revolution", "per minute"),
        ("G98 G81 Z-9.", 1, None, "holes", "feed"),
        ("G78 X24. Z-20. F1.5", 4, None, "of G78: far corner", "G92"),
        ("X23.", 0, Some("G77"), "of G77: far corner", "G90"),
        ("X23.", 0, Some("G0"), "diameter", "corner"),
    ] {
        let told = said(line, at, modal);
        assert!(told.contains(words) && !told.contains(not), "{line}: {told}");
    }
}

/// Every word that the tables of codes of FANUC name is explained.
#[test]
fn every_word_of_fanuc_codes_is_explained() {
    for (page, dialect) in [("gcode-fanuc.md", Dialect::Fanuc), ("gcode-fanuc-mill.md", Dialect::FanucMill)] {
        let text = std::fs::read_to_string(project().join("docs").join(page)).expect("a page");
        let (_, table) = text.split_once("## G codes").expect("a table");
        let (table, _) = table.split_once("\n## ").expect("another section");
        let mut words = 0;
        for row in table.lines().filter(|line| line.starts_with("| G")) {
            let cells: Vec<&str> = row.trim_matches('|').split(" | ").collect();
            let letters = cells[2].split([' ', ',', ':', ';']).filter(|word| word.len() == 1);
            for letter in letters.filter(|letter| *letter != "s") {
                let mut codes = cells[0].trim_start().split(' ');
                let told = |code: &str| said(&format!("{code} {letter}1."), code.len() + 1, dialect);
                assert!(codes.any(|code| told(code).lines().count() > 1), "{page}: {letter} of {}", cells[0]);
                words += 1;
            }
        }
        assert!(words > 40, "{words}");
    }
}
