//! O words, M98 and M99, subroutine files.

use super::recorded::{Outcome, blamed, errors, messages, outcome, run};
use gcode::{Limits, Options, Program};

#[test]
fn loops_turn_as_often_as_they_say() {
    let text =
        "o1 while [#1 lt 4]\n#1=[#1+1]\no2 if [#1 eq 2]\no1 continue\no2 endif\n(debug,%d#1)\no1 endwhile";
    assert_eq!(messages(text), ["1", "3", "4"]);
    let text = "o1 do\n#1=[#1+1]\no2 if [#1 eq 3]\no1 break\no2 endif\n(debug,%d#1)\no1 while [1]\n(msg,out)";
    assert_eq!(messages(text), ["1", "2", "out"]);
    let text = "#1=2\no1 repeat [#1]\n#1=[#1*2]\no2 repeat [2]\n(debug,%d#1)\no2 endrepeat\no1 endrepeat";
    assert_eq!(messages(text), ["4", "4", "8", "8"]);
    assert_eq!(
        messages("o1 while [0]\n(msg,no)\no1 endwhile\no2 repeat [0]\n(msg,no)\no2 endrepeat"),
        [""; 0]
    );
}

#[test]
fn break_leaves_what_was_begun_inside_of_the_loop() {
    let text = "o1 while [#1 lt 2]\n#1=[#1+1]\no2 repeat [5]\no3 if [1]\no1 continue\no3 endif\no2 endrepeat\no1 endwhile\n\
        o4 do\no5 while [1]\no4 break\no5 endwhile\no4 while [1]\no4 do\n(debug,%d#1)\n#1=[#1+1]\no4 while [#1 lt 4]";
    assert_eq!(messages(text), ["2", "3"]);
}

#[test]
fn one_branch_of_an_if_is_executed_and_the_others_are_not_looked_at() {
    let text = |n: u32| {
        format!(
            "#1={n}\no1 if [#1 eq 0]\n(msg,zero)\no1 elseif [1/#1 gt 0.5]\n(msg,one)\no1 elseif [1/[#1-1] gt 0.5]\n(msg,two)\n\
             o1 else\n(msg,many)\nG0 X[1/[#1-3+1]]\no1 endif"
        )
    };
    assert_eq!(messages(&text(0)), ["zero"]);
    assert_eq!(messages(&text(1)), ["one"]);
    assert_eq!(messages(&text(2)), ["two"]);
    assert_eq!(messages(&text(9)), ["many"]);
    assert_eq!(messages("o1 if [0]\nthis is $ no line\no1 endif\n(msg,fine)"), ["fine"]);
}

#[test]
fn subroutines_have_arguments_names_and_a_value_of_their_own() {
    let text = "o<fact> sub\no1 if [#1 le 1]\no<fact> return [1]\no1 endif\no<fact> call [#1-1]\no<fact> endsub [#1*#<_value>]\n\
        #1=77\no<fact> call [5]\n(debug,%d#<_value> #<_value_returned> #1)";
    assert_eq!(messages(text), ["120 1 77"]);
    let text = "o1 call [3]\no1 sub\n(debug,%d#1 #2)\no1 endsub\n(debug,%d#<_value> #<_value_returned>)";
    assert_eq!(messages(text), ["3 0", "0 0"], "a sub may be called before it is defined");
    let text = "#1=7\no[#1+1] sub\n(msg,eight)\no8 endsub\no[4*2] call (why)\nO 8 CALL ; again";
    assert_eq!(messages(text), ["eight", "eight"], "labels may be computed");
}

#[test]
fn m98_calls_a_program_of_the_file_with_the_parameters_of_the_caller() {
    let text = "M98 P500 L3\nM98 P500 L0\n(debug,%d#1)\nM98 P600\nM2\no500\n#1=[#1+1]\nM99\no600\nM98 P500\n(debug,%d#1)\nM99";
    assert_eq!(messages(text), ["3", "4"]);
    assert_eq!(messages("(msg,one)\nM99\n(msg,never)"), ["one"], "M99 ends a program that nobody called");
}

#[test]
fn subroutine_files_are_found_in_the_folder_of_the_program_and_in_others() {
    let (here, there) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let write = |folder: &tempfile::TempDir, name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let main = write(&here, "main.ngc", "o<near> call\no<far> call [2]\nM98 P700\no<helper> call\nM2\n");
    write(&here, "near.ngc", "o<near> sub\n(msg,near)\no<near> endsub\n");
    write(
        &there,
        "far.ngc",
        "o<helper> sub\n(msg,helper)\no<helper> endsub\no<far> sub\no<helper> call\n(debug,far %d#1)\no<far> endsub\nM2\n",
    );
    write(&there, "700.ngc", "o700\n(msg,700)\nM99\n");
    let options = Options { subroutine_folders: vec![there.path().to_owned()], ..Options::default() };
    let outcome = run(Program::open(&main, &options).unwrap());
    let said: Vec<_> =
        outcome.sink.calls.iter().filter(|call| call.starts_with("Message")).cloned().collect();
    assert_eq!(said, ["near", "helper", "far 2", "700", "helper"].map(|text| format!("Message({text:?})")));
    assert!(outcome.errors.is_empty());

    write(&there, "far.ngc", "o<far> sub\no5 call\no<far> endsub\no5 sub\no5 endsub\n");
    let outcome = run(Program::open(&main, &options).unwrap());
    assert_eq!(
        (outcome.errors[0].line, outcome.errors[0].code),
        (2, "no-subroutine"),
        "it stands further down"
    );

    write(&there, "far.ngc", "o<far> sub\nG0 X[1/0]\no<far> endsub\n");
    let outcome = run(Program::open(&main, &options).unwrap());
    assert_eq!((outcome.errors[0].line, outcome.errors[0].code), (2, "arithmetic"));
    assert!(outcome.errors[0].file.ends_with("far.ngc"), "an error in a subroutine file names that file");

    let limits = Limits { subroutine_bytes: 20, ..Limits::default() };
    let outcome = run(Program::open(&main, &Options { limits, ..options }).unwrap());
    assert!(outcome.errors[0].message.contains("subroutine_bytes"), "{}", outcome.errors[0].message);
}

/// What comes of a program with a contour in a file of its own.
fn with_contour(main: &str, contour: &str) -> (Outcome, Vec<(String, u32, &'static str)>) {
    let folder = tempfile::tempdir().expect("there is room");
    let path = folder.path().join("main.ngc");
    std::fs::write(&path, main).expect("there is room");
    std::fs::write(folder.path().join("7.ngc"), contour).expect("there is room");
    let outcome = run(Program::open(&path, &Options::default()).expect("there is room"));
    let name = |file: &str| file.rsplit(['/', '\\']).next().unwrap_or_default().to_owned();
    let said = outcome.errors.iter().map(|error| (name(&error.file), error.line, error.code)).collect();
    (outcome, said)
}

#[test]
fn what_is_wrong_with_a_cycle_is_said_of_its_line_in_its_file() {
    let main = "G18 F100\nG0 X20 Z2\n\nG71 Q7\n\nG71 Q7 I0.0000001\nM2\n";
    let (outcome, said) = with_contour(main, "o7 sub\nG0 X4\no7 endsub\n");
    let main = |line, code| ("main.ngc".to_owned(), line, code);
    assert_eq!(said, [main(4, "bad-contour"), main(6, "bad-contour")]);
    assert_eq!(outcome.errors[0].text, "G71 Q7");
    let text = "G18 F100\nG0 X20 Z2\n\n(one)\n(two)\nG71 Q7 I0.000001\nM2\n";
    let (outcome, said) = with_contour(text, "o7 sub\nG0 X4\nG1 Z-9\nX20\no7 endsub\n");
    assert_eq!(said, [main(6, "bad-value")]);
    assert!(outcome.errors[0].message.contains("moves_of_block"), "{}", outcome.errors[0].message);
}

#[test]
fn a_contour_without_end_is_given_up_and_the_rest_is_checked() {
    let main = "G18 F100\nG0 X20 Z2\nG71 Q7\nG1 X5\nG1 X[1/0]\nG0 Q5\nM2\n";
    let (outcome, said) = with_contour(main, "o7 sub\nG0 X4\nG1 Z-9\nX20\n");
    let codes: Vec<_> = said.iter().map(|(file, line, code)| (file.as_str(), *line, *code)).collect();
    let main = |line, code| ("main.ngc", line, code);
    assert_eq!(codes[1..], [main(5, "arithmetic"), main(6, "unused-word")], "{codes:?}");
    assert_eq!((codes[0].0, codes[0].2), ("7.ngc", "missing-end"));
    let moved = outcome.sink.calls.iter().any(|call| call.starts_with("StraightFeed([5.0"));
    assert!(moved, "what follows is executed: {:?}", outcome.sink.calls);
    assert!(outcome.program.is_ended());
}

#[test]
fn a_subroutine_that_is_not_found_tells_where_it_was_looked_for() {
    let options = Options { subroutine_folders: vec!["/nowhere/subs".into()], ..Options::default() };
    let outcome = run(Program::from_text("t", "o<drill> call [1]\no<../x> call\nM2\n", &options));
    assert_eq!(outcome.errors[0].code, "no-subroutine");
    assert!(outcome.errors[0].message.contains("/nowhere/subs/drill.ngc"), "{}", outcome.errors[0].message);
    assert!(!outcome.errors[1].message.contains("nowhere"), "a name cannot lead out of the folder");
}

#[test]
fn what_does_not_belong_together_is_refused() {
    for (text, line, code) in [
        ("o5 endwhile\nM2", 1, "unmatched"),
        ("o5 endif\nM2", 1, "unmatched"),
        ("o5 else\nM2", 1, "unmatched"),
        ("o5 break\nM2", 1, "unmatched"),
        ("o5 repeat [2]\no5 break\no5 endrepeat\nM2", 2, "unmatched"),
        ("o5 endsub\nM2", 1, "unmatched"),
        ("o1 while [1]\no2 if [1]\no1 endwhile\nM2", 3, "unmatched"),
        ("o1 while [0]\nM2", 1, "missing-end"),
        ("o1 while [#1 lt 1]\n#1=1\n%", 3, "bad-character"),
        ("o1 do\n", 1, "missing-end"),
        ("o1 sub\nM2\n", 1, "missing-end"),
        ("o1 sub\no1 endsub\no1 sub\no1 endsub\nM2", 3, "nested-subroutine"),
        ("o1 call\nM2\no1 sub\no2 sub\no2 endsub\no1 endsub", 4, "nested-subroutine"),
        ("o1 sub\no1 if [1]\no1 endsub\no1 call\nM2", 2, "missing-end"),
        ("M98 P1\nM2\no1 sub\no1 endsub", 1, "wrong-call"),
        ("o1 call\nM2\no1\nM99", 1, "wrong-call"),
        ("o1 call\nM2\no1 sub\nM99\no1 endsub", 4, "unmatched"),
        ("M98\nM2", 1, "missing-word"),
        ("M98 P1.5\nM2", 1, "bad-value"),
        ("o1 repeat [2.5]\no1 endrepeat\nM2", 1, "bad-value"),
        ("o1 repeat [-1]\no1 endrepeat\nM2", 1, "bad-value"),
        ("o1 if\no1 endif\nM2", 1, "missing-value"),
        ("o1 goto [5]\nM2", 1, "unknown-o-word"),
        ("o1.5 sub\nM2", 1, "bad-label"),
        ("o1 if [1] G0 X1\no1 endif\nM2", 1, "unused-word"),
        ("G0 X1\n", 1, "no-program-end"),
        ("%\nG0 X1\n", 2, "no-program-end"),
    ] {
        assert_eq!(errors(text).first(), Some(&(line, code)), "{text}");
    }
}

#[test]
fn after_an_error_each_line_is_looked_at_once_and_the_program_ends() {
    let text =
        "o1 while [#1 lt 10]\n#1=[#1+\nG0 X[1/0]\no1 endwhile\no2 while [#3 lt]\nG99999\no2 endwhile\nM2\n";
    assert_eq!(
        errors(text),
        [(2, "missing-value"), (3, "arithmetic"), (5, "missing-value"), (6, "unknown-g-code")]
    );
}

#[test]
fn a_label_without_a_keyword_that_the_program_runs_into_is_warned_of() {
    for (text, expected) in [
        ("G90\no2\nG0 X1\nM2", &[2][..]),
        ("G0 X1\no<drill>\nM2", &[2]),
        ("M98 P2\no2\nG0 X1\nM99\nM2", &[2]),
        // The name of the program; what M98 enters.
        ("(by hand)\no2\nG0 X1\nM2", &[]),
        ("M98 P2 L3\nM2\no2\nG91 G0 X1\nM99", &[]),
    ] {
        let warnings = outcome(text).warnings;
        let here: Vec<u32> =
            warnings.iter().filter(|one| one.code == "no-effect").map(|one| one.line).collect();
        assert_eq!(here, expected, "{text}");
    }
}

#[test]
fn limits_end_what_would_never_end() {
    let limits = Limits { blocks_without_motion: 1000, call_depth: 5, ..Limits::default() };
    let options = Options { limits, ..Options::default() };
    let first = |text: &str| run(Program::from_text("t", text, &options)).errors.remove(0);
    let error = first("o1 while [1]\nG90\no1 endwhile\nM2\n");
    assert_eq!(error.code, "endless-loop");
    assert!(error.message.contains("blocks_without_motion"));
    let error = first("o1 sub\no1 call\no1 endsub\no1 call\nM2\n");
    assert_eq!((error.code, error.line), ("calls-too-deep", 2));
    assert!(error.message.contains("call_depth"));
    let turning = "o1 while [#1 lt 5000]\n#1=[#1+1]\nG0 X#1\no1 endwhile\nM2\n";
    assert!(run(Program::from_text("t", turning, &options)).errors.is_empty(), "a loop that moves may go on");
}

#[test]
fn an_unmatched_end_names_what_is_open() {
    let outcome = outcome("o1 while [1]\no2 if [1]\no1 endwhile\nM2\n");
    assert!(outcome.errors[0].message.contains("o2 if in line 2"), "{}", outcome.errors[0].message);
    assert_eq!(blamed("o1 if [1/0]\no1 endif\nM2").2, "1/0");
}

/// Lines that a random program is made of.
const PIECES: [&str; 32] = [
    "o1 while [#1 lt 3]",
    "o1 endwhile",
    "o1 do",
    "o1 while [#1 lt 5]",
    "o1 if [#1 gt 1]",
    "o1 elseif [#2]",
    "o1 else",
    "o1 endif",
    "o1 repeat [2]",
    "o1 endrepeat",
    "o1 break",
    "o1 continue",
    "o2 while [1]",
    "o2 endwhile",
    "o2 if [0]",
    "o2 endif",
    "o2 break",
    "o<a> sub",
    "o<a> endsub",
    "o<a> call [#1] [2]",
    "o<a> return [#1]",
    "o3",
    "M98 P3 L2",
    "M99",
    "#1=[#1+1]",
    "#2=[1/#1]",
    "G0 X#1",
    "%",
    "/ #1=9",
    "(debug,#1 #<a>)",
    "o[#1] if [1]",
    "M2",
];

proptest::proptest! {
    /// However lines are put together, the program ends, and each line has at most one error.
    #[test]
    fn any_program_ends(picks in proptest::collection::vec(0..PIECES.len(), 0..40)) {
        let text: String = picks.iter().map(|pick| format!("{}\n", PIECES[*pick])).collect();
        let limits = Limits { blocks_without_motion: 500, call_depth: 8, ..Limits::default() };
        let mut program = Program::from_text("t", text.as_str(), &Options { limits, ..Options::default() });
        let (mut record, mut lines) = (super::recorded::Record::default(), Vec::new());
        for _ in 0..20_000 {
            match program.step(&mut record) {
                Ok(gcode::Step::Ended) => break,
                Ok(gcode::Step::More) => {}
                Err(error) => lines.push(error.line),
            }
        }
        let before = lines.len();
        lines.sort_unstable();
        lines.dedup();
        proptest::prop_assert_eq!(before, lines.len());
        if before > 0 {
            proptest::prop_assert!(program.is_ended() || program.step(&mut record).is_ok_and(|step| step == gcode::Step::Ended));
        }
    }
}

#[test]
fn an_end_that_was_forgotten_is_missed_though_the_program_ends_before() {
    for (begin, line) in [("o1 repeat [3]", 1), ("o1 while [1]", 1), ("o1 if [1]", 1), ("o1 do", 1)] {
        assert_eq!(errors(&format!("{begin}\nG0 X1\nM2\n")), [(line, "missing-end")], "{begin}");
    }
    assert!(errors("o1 if [1]\nM2\no1 endif\nG0 X1\nM2\n").is_empty(), "M2 may stand in a branch");
}

#[test]
fn a_subroutine_knows_how_many_arguments_it_was_given() {
    let text = "o1 sub\n(debug,#<n_args> #1 #2)\no1 endsub\n";
    let turns = "o2 repeat [2]\no1 call [7]\no2 endrepeat\no1 call\no1 call [1] [2] [0]\n";
    assert_eq!(
        messages(&format!("{text}{turns}")),
        [
            "1.000000 7.000000 0.000000",
            "1.000000 7.000000 0.000000",
            "0.000000 0.000000 0.000000",
            "3.000000 1.000000 2.000000"
        ]
    );
    assert_eq!(errors("#1=#<n_args>\nM2"), [(1, "unknown-name")]);
}
