//! Programs that would not end, or take all memory: each limit ends them with a message that names it, and
//! the work that is done until then is counted in lines, not in seconds.

use std::fmt::Write as _;
use std::fs;

use gcode::{Call, Diagnostic, Dialect, Limits, Options, Place, Problem, Program, Sink, Step};

/// Counts the calls.
#[derive(Default)]
struct Count {
    calls: u64,
    /// More than these are refused.
    most: u64,
}

impl Sink for Count {
    fn call(&mut self, _: Place, _: Call<'_>) -> Result<(), Box<Problem>> {
        self.calls += 1;
        match self.calls > self.most {
            true => Err(Problem::error("too-many", gcode::problem::Blame::Block, "enough", "none")),
            false => Ok(()),
        }
    }
}

struct Ended {
    errors: Vec<Diagnostic>,
    lines: u64,
}

impl Ended {
    /// Whether one of the errors has this code and names this limit.
    fn names(&self, code: &str, limit: &str) -> bool {
        self.errors.iter().any(|error| error.code == code && error.message.contains(limit))
    }
}

fn run(mut program: Program, most: u64) -> Ended {
    let mut sink = Count { calls: 0, most };
    let (mut errors, mut lines) = (Vec::new(), 0);
    loop {
        lines += 1;
        assert!(lines < 3_000_000, "it does not end");
        match program.step(&mut sink) {
            Ok(Step::More) => {}
            Ok(Step::Ended) => return Ended { errors, lines },
            Err(error) => errors.push(*error),
        }
    }
}

fn small(dialect: Dialect) -> Options {
    let limits = Limits {
        blocks_without_motion: 500,
        moves_of_block: 100_000,
        call_depth: 7,
        expression_depth: 10,
        line_length: 300,
        subroutine_bytes: 1000,
    };
    Options { dialect, limits, ..Options::default() }
}

fn ended(dialect: Dialect, text: &str) -> Ended {
    run(Program::from_text("limits", text, &small(dialect)), 10_000)
}

#[test]
fn loops_that_lead_nowhere_end() {
    let programs = [
        (Dialect::Linuxcnc, "o1 while [1]\no1 endwhile\nM2\n"),
        (Dialect::Linuxcnc, "o1 do\n#1=[#1+1]\no1 while [#1 GT 0]\nM2\n"),
        (Dialect::Linuxcnc, "o1 repeat [1000000000]\nS100\no1 endrepeat\nM2\n"),
        (
            Dialect::Linuxcnc,
            "o1 while [1]\no2 while [1]\no2 break\no2 endwhile\no1 continue\no1 endwhile\nM2\n",
        ),
        (Dialect::Linuxcnc, "M98 P5 L4000000000\nM2\no5\nS1\nM99\n"),
        (Dialect::Fanuc, "O1\nWHILE [1 EQ 1] DO 1\nEND 1\nM30\n"),
        (Dialect::Fanuc, "O1\nDO 1\n#1=#1+1\nEND 1\nM30\n"),
        (Dialect::Fanuc, "O1\nN10 #1=1\nGOTO 10\nM30\n"),
        (Dialect::Fanuc, "O1\nM98 P5 L9999\nM30\nO5\nS1\nM99\n"),
        (Dialect::Fanuc, "O1\nM98 P5\nM30\nO5\nN1\nM99 P1\n"),
        (Dialect::FanucMill, "O1\nM97 P5 L9999\nM30\nN5 S1\nM99\n"),
        (Dialect::FanucMill, "O1\nG68 X0. Y0. R9.\nN10 G01 X1. F9.\nGOTO 10\nM30\n"),
        // Moves without length, and to and fro.
        (Dialect::Fanuc, "O1\nN10 G00 X10.\nGOTO 10\nM30\n"),
        (Dialect::Linuxcnc, "o1 while [1]\nG91 G0 X0.001\nG0 X-0.001\no1 endwhile\nM2\n"),
        (Dialect::Linuxcnc, "o1 while [1]\nG90 G1 X1 Z1 F1\no1 endwhile\nM2\n"),
    ];
    for (dialect, text) in programs {
        let ended = ended(dialect, text);
        let endless = ended.names("endless-loop", "the limit blocks_without_motion");
        // M99 P1 in the last one goes to a block that its caller has not.
        assert!(endless || text.contains("M99 P1"), "{text}: {:?}", ended.errors);
        assert!(ended.lines < 520, "{text}: {} lines", ended.lines);
    }
}

/// An endless loop of moves is as legal as a long program. Whoever receives the calls ends it.
#[test]
fn loops_of_moves_end_when_the_receiver_refuses() {
    let loops = [
        (Dialect::Linuxcnc, "F100\no1 while [1]\nG1 X1\nX2\no1 endwhile\nM2\n"),
        (
            Dialect::Linuxcnc,
            "F100\no1 sub\nG1 X1\nX2\no1 endsub\no2 repeat [1000000]\no1 call\no2 endrepeat\nM2\n",
        ),
        (Dialect::Linuxcnc, "F100 G81 X1 Z-1 R1 L20000\nM2\n"),
        (Dialect::Linuxcnc, "F100 G83 X1 Z-1000 R1 Q0.05\nM2\n"),
        (Dialect::Fanuc, "O1\nG98 F100\nN1 G01 X1.\nX2.\nGOTO 1\nM30\n"),
        (Dialect::FanucMill, "O1\nF100.\nG81 X1. Z-1. R1. K9999\nM30\n"),
        (Dialect::FanucMill, "O1\nF100.\nG66 P5\nN1 G01 X1.\nX2.\nGOTO 1\nM30\nO5\nG01 Y#5002\nM99\n"),
        (Dialect::Fanuc, "O1\nG98 F100\nG00 X50. Z5.\nG74 R.001\nG74 X48. Z-900. P1000 Q50 F100\nM30\n"),
    ];
    for (dialect, text) in loops {
        let ended = ended(dialect, text);
        assert!(ended.names("too-many", "enough"), "{text}: {:?}", ended.errors);
        assert!(ended.lines < 30_100, "{text}: {} lines", ended.lines);
    }
}

/// One block alone is not without end either, and nothing of it is sent.
#[test]
fn blocks_of_too_many_moves_are_refused() {
    let start = "G18 F100 G0 X20 Z1\n";
    let contour = "\nM2\no1 sub\nG0 X4\nG1 Z-8\nX10\no1 endsub\n";
    let blocks = [
        ("F100 G91 G83 X0.001 Z-1 R0 Q0.000001 L1000000\nM2\n".to_owned(), 0),
        ("F100 G91 G81 X0.001 Z-1 R0 L1000000\nM2\n".to_owned(), 0),
        ("F100 G73 X1 Z-1 R1 Q0.00001\nM2\n".to_owned(), 0),
        (format!("{start}G70 Q1 P900000000{contour}"), 1),
        (format!("{start}G71 Q1 I0.000002{contour}"), 1),
        (format!("{start}G72 Q1 I0.000002{contour}"), 1),
    ];
    for (text, before) in blocks {
        let mut moves = 0;
        let mut count = |call: Call<'_>| {
            moves += u64::from(matches!(call, Call::StraightTraverse(_) | Call::StraightFeed(_)));
        };
        let errors = said(&text, &mut count);
        assert_eq!(errors.len(), 1, "{text}: {errors:?}");
        assert_eq!(errors[0].code, "bad-value", "{text}");
        assert!(
            errors[0].message.contains("100000 moves: the limit moves_of_block"),
            "{}",
            errors[0].message
        );
        // The move to where a cycle along a contour starts is made before the contour is read.
        assert!(moves <= 2 * before, "{text}: {moves} moves");
    }
}

/// Far from 0 a peck is lost in rounding: the depth stays, and still the pecks end.
#[test]
fn pecks_that_do_not_change_the_depth_end() {
    let text = "F100 G83 X0 Y0 R100000000000000000 Z99999999999999936 Q1\nM2\n";
    let ended = ended(Dialect::Linuxcnc, text);
    assert!(ended.errors.is_empty(), "{:?}", ended.errors);
}

/// What is said of a program whose calls are counted.
fn said(text: &str, count: &mut dyn FnMut(Call<'_>)) -> Vec<Diagnostic> {
    struct Each<'a>(&'a mut dyn FnMut(Call<'_>));
    impl Sink for Each<'_> {
        fn call(&mut self, _: Place, call: Call<'_>) -> Result<(), Box<Problem>> {
            (self.0)(call);
            Ok(())
        }
    }
    let mut program = Program::from_text("limits", text, &small(Dialect::Linuxcnc));
    let (mut sink, mut errors) = (Each(count), Vec::new());
    loop {
        match program.step(&mut sink) {
            Ok(Step::More) => {}
            Ok(Step::Ended) => return errors,
            Err(error) => errors.push(*error),
        }
    }
}

#[test]
fn recursion_ends() {
    let deep = "o1 sub\no1 call\no1 endsub\no1 call\nM2\n";
    let two = "o1 sub\no2 call\no1 endsub\no2 sub\no1 call\no2 endsub\no1 call\nM2\n";
    let m98 = "M98 P1\nM2\no1\nM98 P1\nM99\n";
    for text in [deep, two, m98] {
        assert!(ended(Dialect::Linuxcnc, text).names("calls-too-deep", "the limit call_depth"), "{text}");
    }
    for text in
        ["O1\nM98 P1\nM30\n", "O1\nG65 P2\nM30\nO2\nM98 P2\nM99\n", "O1\nG65 P2\nM30\nO2\nG65 P2 A1.\nM99\n"]
    {
        assert!(
            ended(Dialect::Fanuc, text)
                .names("calls-too-deep", "7 calls inside each other, the limit call_depth"),
            "{text}"
        );
    }
}

/// Each program calls the next one ten times: after the error each is looked through once, not 10^6 times.
#[test]
fn after_an_error_calls_are_not_repeated() {
    let (mut linuxcnc, mut fanuc) = (String::new(), "O1\nG28 X\nM98 P2\nM30\n".to_owned());
    for n in (2..8).rev() {
        let calls = if n < 7 { format!("o{} call\n", n + 1).repeat(10) } else { String::new() };
        let _ = write!(linuxcnc, "o{n} sub\n{calls}G0 X{n}\no{n} endsub\n");
        let calls = if n < 7 { format!("M98 P{}\n", n + 1).repeat(10) } else { String::new() };
        let _ = write!(fanuc, "O{n}\n{calls}G00 X{n}.\nM99\n");
    }
    for (dialect, text) in
        [(Dialect::Linuxcnc, format!("{linuxcnc}G99999\no2 call\nM2\n")), (Dialect::Fanuc, fanuc)]
    {
        let ended = ended(dialect, &text);
        assert!(!ended.errors.is_empty() && ended.lines < 200, "{} lines: {:?}", ended.lines, ended.errors);
    }
}

#[test]
fn deep_expressions_end() {
    let nested = |open: &str, inner: &str, close: &str| {
        format!("#1=1\n#100={}{inner}{}\n", open.repeat(12), close.repeat(12))
    };
    let linuxcnc = [
        ("[", "1", "]"),
        ("-", "#1", ""),
        ("#", "1", ""),
        ("SQRT[", "1", "]"),
        ("+", "[1]", ""),
        ("ATAN[1]/[", "1", "]"),
    ];
    let fanuc = [("[", "1", "]"), ("-", "#1", ""), ("#", "1", ""), ("SQRT[", "1", "]")];
    for (dialect, shapes) in Dialect::ALL.into_iter().zip([&linuxcnc[..], &fanuc[..], &fanuc[..]]) {
        for (open, inner, close) in shapes {
            let ended = ended(dialect, &format!("{}M2\n", nested(open, inner, close)));
            assert!(
                ended.names(
                    "expression-too-deep",
                    "more than 10 brackets, signs or # inside each other, the limit expression_depth"
                ),
                "{open}: {:?}",
                ended.errors
            );
        }
        // The same at full length and with the limit that is in force without another one.
        let options = Options { dialect, ..Options::default() };
        let text = format!("#100={}1\nM2\n", "[".repeat(4000));
        let ended = run(Program::from_text("deep", text, &options), 10);
        assert!(ended.names("expression-too-deep", "more than 64"), "{:?}", ended.errors);
    }
}

#[test]
fn long_lines_end() {
    for dialect in Dialect::ALL {
        for text in [
            format!("G0 X{}\nM2\n", "1".repeat(300)),
            format!("({})\nM2\n", "x".repeat(10_000_000)),
            "x".repeat(10_000_000),
            format!("{}\nM2\n", "\0".repeat(301)),
            format!("{}G0 X1\nM2\n", "\0".repeat(10_000)),
            format!("{}\rG0 X1\nM2\n", "\0".repeat(300)),
        ] {
            let ended = ended(dialect, &text);
            assert!(
                ended.names("line-too-long", "more than 300 bytes, the limit line_length"),
                "{:?}",
                ended.errors.first()
            );
            assert!(ended.lines < 5);
        }
        let fits = ended(dialect, &format!("({})\nM2\n", "x".repeat(298)));
        assert!(!fits.names("line-too-long", ""), "{:?}", fits.errors);
    }
}

#[test]
fn big_subroutine_files_end() {
    let folder = tempfile::tempdir().expect("there is room");
    let filler = "(nothing)\n".repeat(200);
    fs::write(folder.path().join("100.ngc"), format!("o100 sub\n{filler}o100 endsub\nM2\n"))
        .expect("written");
    fs::write(folder.path().join("O0100.nc"), format!("O100\n{filler}M99\n")).expect("written");
    let programs = [(Dialect::Linuxcnc, "o100 call\nM2\n"), (Dialect::Fanuc, "O1\nM98 P100\nM30\n")];
    for (dialect, text) in programs {
        let path = folder.path().join("main.ngc");
        fs::write(&path, text).expect("written");
        let ended = run(Program::open(&path, &small(dialect)).expect("it exists"), 1000);
        assert!(
            ended.names("file-too-large", "more than 1000 bytes, the limit subroutine_bytes"),
            "{:?}",
            ended.errors
        );
    }
}

/// Each line is wrong: the text of a line is found for its message without reading the file from its
/// beginning.
#[test]
fn a_hundred_thousand_faulty_lines_take_a_moment() {
    for dialect in Dialect::ALL {
        let text = "G1 X1 X2\n".repeat(100_000) + "M2\n";
        let ended = ended(dialect, &text);
        assert_eq!(ended.errors.iter().filter(|error| error.code == "repeated-word").count(), 500);
        let moving = "G0 X1.\nG1 X1 X2\nG0 X2.\nG1 X1 X2\n".repeat(25_000) + "M2\n";
        let ended = run(Program::from_text("faulty", moving, &small(dialect)), 1_000_000);
        let faulty: Vec<_> = ended.errors.iter().filter(|error| error.code == "repeated-word").collect();
        assert_eq!(faulty.len(), 50_000);
        assert!(faulty.iter().all(|error| error.text == "G1 X1 X2" && error.line % 2 == 0));
    }
}
