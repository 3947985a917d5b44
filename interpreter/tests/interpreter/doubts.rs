//! Warnings of what can be meant, but hardly is.

use interpreter::{Language, check};
use machine::{Machine, ProgramDialect, Tool};

/// Line and code of what is said of a program.
fn said(text: &str) -> Vec<(u32, &'static str)> {
    let found = check("part.ngc", text, &Machine::plain());
    found.diagnostics.iter().map(|one| (one.line, one.code)).collect()
}

fn message(text: &str) -> String {
    let found = check("part.ngc", text, &Machine::plain());
    found.diagnostics.first().map(|one| one.message.clone()).unwrap_or_default()
}

#[test]
fn a_feed_with_the_spindle_standing_is_told_once_until_it_turns() {
    assert_eq!(said("G0 X40 Z2\nG1 Z-30 F100\nX45\nM2\n"), [(2, "spindle-not-turning")]);
    assert_eq!(said("S500 M3\nG0 X40 Z2\nG1 Z-30 F100\nM5\nX45\nX50\nM2\n"), [(5, "spindle-not-turning")]);
    assert_eq!(said("M3\nG0 X40 Z2\nG2 Z-30 X45 R100 F100\nM2\n")[1..], [(3, "spindle-not-turning")]);
    assert_eq!(said("S500 M3\nG0 X40 Z2\nG1 Z-30 F100\nM2\n"), []);
    // Where the part is known, moves beside it are not asked.
    assert_eq!(said("(part, bar D40 L60)\nG0 X50 Z2\nG1 Z-30 F100\nM2\n"), []);
}

#[test]
fn feeds_of_the_other_mode_are_told_with_what_they_make() {
    let turned = "S500 M3\nG0 X40 Z2\n";
    for (text, words) in [
        ("G95 G1 Z-10 F200\nM2\n", "F is 200 mm in each turn of the spindle, 100000 mm/min"),
        ("G94 G1 Z-13 F0.2\nM2\n", "at F0.2 mm/min this takes 4500 s"),
        ("G95 G20 (inch)\nG1 Z-0.4 F0.3\nM2\n", "F is 0.3 inch in each turn of the spindle, 150 inch/min"),
    ] {
        let codes: Vec<_> = said(&format!("{turned}{text}")).into_iter().map(|(_, code)| code).collect();
        assert_eq!(codes, ["unlikely-feed"], "{text}");
        assert!(
            message(&format!("{turned}{text}")).contains(words),
            "{}",
            message(&format!("{turned}{text}"))
        );
    }
    for usual in ["G95 G1 Z-10 F0.2", "G95 G1 Z-10 F4.5", "G94 G1 Z-10 F200", "G94 G1 Z1.99 F0.5"] {
        assert_eq!(said(&format!("{turned}{usual}\nM2\n")), [], "{usual}");
    }
    // Once for each F, not once for each move.
    assert_eq!(said(&format!("{turned}G95 G1 Z-10 F200\nZ-11\nZ-12\nM2\n")), [(3, "unlikely-feed")]);
}

#[test]
fn a_feed_that_an_axis_clips_is_told_with_what_is_left() {
    let machine = Machine::plain();
    let z = machine.axis[&protocol::Axis::Z].velocity_mm_s * 60.0;
    let program = |feed: f64| format!("S500 M3\nG0 X40 Z2\nG1 Z-40 F{feed}\nM2\n");
    assert_eq!(said(&program(z)), []);
    assert_eq!(said(&program(z + 1.0)), [(3, "feed-clipped")]);
    assert!(
        message(&program(2.0 * z)).ends_with(&format!("held to {z} mm/min")),
        "{}",
        message(&program(2.0 * z))
    );
}

/// S2500 P3 to Z-20: 7 of 16 mm are as deep as they should be.
#[test]
fn a_thread_that_is_mostly_run_out_is_told() {
    let thread = |s: u32, p: f64| format!("S{s} M3\nG0 X22 Z5\nG76 P{p} Z-20 I-1 J0.3 K1.8\nM2\n");
    assert_eq!(said(&thread(2500, 3.0)), [(3, "mostly-shallow")]);
    assert_eq!(said(&thread(500, 2.0)), []);
    let chamfered = "S500 M3\nG0 X22 Z5\nG76 P2 Z-20 I-1 J0.3 K1.2 L2 E18\nM2\n";
    assert_eq!(said(chamfered), [], "a taper that the program asks for is no slip");
}

/// G92 names where the tool goes, not where the crest is.
#[test]
fn the_depth_of_g92_is_not_invented() {
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("g92.nc");
    let text = "G97 S500 M03\nG00 X28. Z5.\nG92 X23.4 Z-18. F1.5\nX22.9\nG00 X40.\nM30\n";
    std::fs::write(&path, text).expect("a file");
    let machine = Machine::plain();
    let language = Language { dialect: Some(ProgramDialect::Fanuc), ..Language::default() };
    let program = interpreter::open(&path, &language, &machine).expect("a program");
    let found = interpreter::check_program(program, &machine, |_| ());
    let known: Vec<_> = found.passes.iter().map(|pass| (pass.depth_mm, pass.across_mm)).collect();
    assert_eq!(known, [(None, 11.7), (None, 11.45)]);
}

/// Passes by G33, each from a Z and to an X of its own; the line of a pass and what is said of it.
fn beside(lead: f64, passes: &[(f64, f64)]) -> Vec<String> {
    let cut = |(z, x): &(f64, f64)| format!("G0 X14 Z{z}\nG0 X{x}\nG33 Z-22 K{lead}\nG0 X14\n");
    let program = format!("G7 S400 M3\n{}M2\n", passes.iter().map(cut).collect::<String>());
    let found = check("part.ngc", &program, &Machine::plain());
    let told = found.diagnostics.iter().filter(|one| one.code == "beside-groove");
    told.map(|one| format!("{}: {}", one.line, one.message)).collect()
}

#[test]
fn a_pass_beside_the_groove_is_told_with_how_far() {
    for um in [5.0, 20.0, 100.0, 200.0] {
        let z = 8.0 + 1e-3 * um;
        let said = [format!("8: this pass runs {} mm beside the groove of line 4", 1e-3 * um)];
        assert_eq!(beside(2.0, &[(8.0, 9.0), (z, 9.0)]), said);
        // Deeper by more than an infeed along a flank would be.
        let deeper = 9.0 - 2.0 * 6e-3 * um;
        assert_eq!(beside(2.0, &[(8.0, 9.0), (z, deeper)]), said);
        // Of two starts.
        let three = [(8.0, 9.0), (9.0, 9.0), (z, 9.0)];
        assert_eq!(beside(2.0, &three), [said[0].replace("8:", "12:")]);
    }
    let many: Vec<_> = (0..40).map(|k| (8.0 + 0.005 * f64::from(k), 9.0)).collect();
    assert_eq!(beside(2.0, &many).len(), 39);
}

#[test]
fn starts_and_infeed_along_a_flank_are_not_beside_a_groove() {
    let even = |starts: u32| -> Vec<_> {
        let start = |k: u32| (8.0 + 4.0 * f64::from(k) / f64::from(starts), 9.0);
        (0..starts).map(start).collect()
    };
    for starts in 1..=8 {
        assert_eq!(beside(4.0, &even(starts)), [""; 0], "{starts}");
    }
    for tangent in [0.577, 0.53, 0.268, 0.25] {
        let depths = [0.3, 0.55, 0.75, 0.92, 1.07, 1.2, 1.25];
        let along: Vec<_> = depths.iter().map(|h| (8.0 - tangent * h, 10.0 - 2.0 * h)).collect();
        assert_eq!(beside(2.0, &along), [""; 0], "{tangent}");
        let side = |i: usize| if i.is_multiple_of(2) { tangent } else { -tangent };
        let zigzag = depths.iter().enumerate().map(|(i, h)| (8.0 - side(i) * h, 10.0 - 2.0 * h));
        let said = beside(2.0, &zigzag.collect::<Vec<_>>());
        assert!(said.len() <= 1, "{said:?}");
    }
}

#[test]
fn a_gauge_without_a_thread_is_warned_of_where_it_is_asked_for() {
    let text = "G21\n(thread, M20x2-6g)\nG0 X30 Z5\nM2\n";
    assert_eq!(said(text), [(2, "gauge-differs")]);
    assert!(message(text).contains("for M20x2-6g, and the program cuts no thread"), "{}", message(text));
    let wrong = "(thread, M20x2-6g)\nG18 G0 X12 Z5\nG33 Z-30 K2\nM2\n";
    assert_eq!(said(wrong), [(3, "spindle-not-turning")], "one that could not be cut is not missed");
}

#[test]
fn another_insert_than_the_program_was_written_for_is_told_once_for_each_tool() {
    let pass = "G0 X12 Z5\nG33 Z-30 K2\nG0 X40\nZ5\n";
    let text = |units: &str, insert: &str| {
        format!("G18 {units} G8\n(thread_insert, {insert})\nT3 M6\nS400 M3\n{pass}{pass}M2\n")
    };
    let found = |machine: &Machine, text: &str| -> Vec<(u32, String)> {
        let check = interpreter::check("insert.ngc", text, machine);
        check.diagnostics.into_iter().map(|one| (one.line, one.message)).collect()
    };
    let mut nosed = Machine::plain();
    let (angle_deg, nose_mm) = (Some(60.0), Some(0.144));
    nosed.tools.insert("3".into(), Tool { name: "16ER".into(), angle_deg, nose_mm, width_mm: None });
    assert_eq!(found(&nosed, &text("G21", "A60 R0.144")), []);
    assert_eq!(found(&nosed, &text("G21", "A60 R0.145")), [], "as near as words of inch programs are");
    let others = found(&nosed, &text("G21", "A55 W0.3"));
    let [(6, message)] = others.as_slice() else { panic!("{others:?}") };
    for part in [
        "tool 3",
        "60 degrees",
        "not 55",
        "a nose of 0.144 mm, not 0.000",
        "a flat tip of 0.000 mm, not 0.300",
    ] {
        assert!(message.contains(part), "{part}: {message}");
    }
    // Who does not describe a tool is taken to have a sharp one.
    let plain = Machine::plain();
    assert_eq!(found(&plain, &text("G21", "A60")), []);
    assert_eq!(found(&plain, &text("G21", "A60 R0.1")).len(), 1);
}

#[test]
fn an_insert_is_described_in_the_units_of_its_program_or_not_at_all() {
    let read = |text: &str, unit_mm: f64| machine::Insert::from_comment(text, unit_mm);
    let inch = read("THREAD_INSERT, A60 R0.01 W.02", 25.4).expect("it is right").expect("an insert");
    assert_eq!([inch.angle_deg, inch.nose_mm, inch.width_mm], [60.0, 0.254, 0.508]);
    assert_eq!(read("insert, VNMG 160404", 1.0), Ok(None));
    assert_eq!(read("thread_insert", 1.0), Err(machine::InsertError::Angle));
    for (words, wrong) in
        [("A60 A55", "A55"), ("A60 Rx", "Rx"), ("A60 Q1", "Q1"), ("A60 R-1", "R-1"), ("A200", "A200")]
    {
        let refused = read(&format!("thread_insert, {words}"), 1.0);
        assert_eq!(refused, Err(machine::InsertError::Word(wrong.into())), "{words}");
    }
}

#[test]
fn a_comment_that_means_a_gauge_is_not_passed_over() {
    for (comment, says) in [
        ("(thread M20x2-6g)", "a comma is missing behind thread"),
        ("(thread: M20x2-6g)", "a comma is missing behind thread"),
        ("(threads, M20x2-6g)", "asks for no gauge"),
        ("(gauge M20x2-6g)", "asks for no gauge"),
        ("(gauge, M20x2-6g)", "asks for no gauge"),
    ] {
        let text = format!("{comment}\nM2\n");
        assert_eq!(said(&text), [(1, "bad-thread")], "{comment}");
        assert!(message(&text).contains(says), "{comment}: {}", message(&text));
    }
    for comment in
        ["(thread the hose)", "(threads, two of them)", "(gauge it by hand)", "(thread: see drawing)"]
    {
        assert_eq!(said(&format!("{comment}\nM2\n")), [], "{comment}");
    }
}

/// The message at a line of a program.
fn message_of(program: &str, code: &str) -> String {
    let found = check("part.ngc", program, &Machine::plain());
    let told = found.diagnostics.iter().find(|one| one.code == code);
    told.map_or_else(|| format!("{:#?}", found.diagnostics), |one| format!("{}; {}", one.message, one.help))
}

/// G20, G7: numbers are those of the program, and say what they are.
#[test]
fn what_is_told_is_in_the_units_of_the_program() {
    let head = "G18 G90 G94 G97 G61 S300 M3\n";
    for (program, code, part) in [
        ("G20 G8\n(part, bar D2 L4)\nG0 X0.5 Z-0.5\nM2\n", "rapid-in-stock", "(X as a radius, inch)"),
        ("G20 G7\n(part, bar D2 L4)\nG0 X1 Z-0.5\nM2\n", "rapid-in-stock", "(X as a diameter, inch)"),
        ("G21 G7\n(part, bar D40 L60)\nG0 X20 Z-5\nM2\n", "rapid-in-stock", "(X as a diameter, mm)"),
        (
            "G20\n(part, bar D2 L4 C-2)\nG0 X1.2 Z-1\nZ-2.5\nM2\n",
            "into-chuck",
            "to Z-2.5, and the chuck begins at Z-2 (inch)",
        ),
        ("G20 G0 X1 Z0\nG1 Z-1 F5000\nM2\n", "feed-clipped", "5000 inch/min is more than Z can do"),
        (
            "G20 G7\nG0 X12\nM2\n",
            "travel-limit",
            "here the program may write X from -0.3937 to 9.4488 (inch, as a diameter)",
        ),
        ("G20 G10 L2 P1 Z-2\nG0 Z-20\nM2\n", "travel-limit", "may write Z from"),
        (
            "G20 G0 X1 Z0\nG1 Z-1 F0.0001\nM2\n",
            "no-feed",
            "0.0001 inch a minute is too slow to be one; give at least 0.0024 inch/min",
        ),
        (
            "G20 (thread, 1/4-20 UNC-2A external)\nG0 X0.2 Z0.3\nG33 Z-1 K0.08\nG0 X1\nM2\n",
            "gauge-differs",
            "advances by 0.08 inch in a turn, and 1/4-20 UNC-2A external by 0.05 inch",
        ),
        ("G20 G0 X1 Z0\nG33 Z-1 K50\nM2\n", "bad-value", "50 inch is not a lead"),
        ("G20 G64 P1000\nM2\n", "bad-value", "1000 inch is not a tolerance"),
        (
            "G20 S2500 M3\nG0 X0.9 Z0.2\nG76 P0.118 Z-0.8 I-0.04 J0.012 K0.07\nM2\n",
            "mostly-shallow",
            "0.2006 inch of its 0.6678 inch",
        ),
    ] {
        let told = message_of(&format!("{head}{program}"), code);
        assert!(told.contains(part), "{program}{told}");
    }
}

/// M2 takes G92 back where LinuxCNC's description of the machine says so.
#[test]
fn g92_does_not_outlast_a_program_where_the_description_says_so() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    let kept = |value: u8| {
        let (path, ini) = (folder.join("g92.ngc"), folder.join(format!("g92-{value}.ini")));
        std::fs::write(&path, "G92 X5\nM2\n").expect("a file");
        std::fs::write(&ini, format!("[RS274NGC]\nDISABLE_G92_PERSISTENCE = {value}\n")).expect("a file");
        let language = Language { ini: Some(ini), ..Language::default() };
        let machine = Machine::plain();
        let program = interpreter::open(&path, &language, &machine).expect("a program");
        let left = interpreter::check_program(program, &machine, |_| ()).outlasting.parameters;
        left.values.iter().find(|(number, _)| *number == 5210).map(|(_, value)| *value)
    };
    assert_eq!([0, 1].map(kept), [Some(1.0), Some(0.0)]);
}

/// An output that waits for a motion changes with one, or somebody is told that it does not.
#[test]
fn an_output_that_no_motion_follows_is_told() {
    let outputs = "\n[outputs.1]\nname = \"air\"\n[analog_outputs.1]\nname = \"valve\"\nrange = [0.0, 10.0]\ninitial = 0.0\nsafe = 0.0\n";
    let machine = Machine::from_toml(&format!("{}{outputs}", machine::SMALL_LATHE)).expect("a machine");
    let said = |text: &str| {
        let found = check("part.ngc", &format!("S500 M3\n{text}M2\n"), &machine);
        found.diagnostics.iter().map(|one| (one.line, one.code)).collect::<Vec<_>>()
    };
    assert_eq!(said("M62 P1\nG0 X40\nM63 P1\nG0 X30\n"), []);
    assert_eq!(said("M62 P1\n"), [(2, "no-effect")], "the program ends before");
    assert_eq!(
        said("G0 X40\nM62 P1\nG4 P1\nG0 X40\n"),
        [(3, "no-effect")],
        "a move to where it stands is none"
    );
    assert_eq!(said("M62 P1\nM63 P1\nG0 X40\n"), [(2, "no-effect")], "the second one counts");
    assert_eq!(said("M62 P1\nM64 P1\nG0 X40\n"), [(2, "no-effect")], "the first one would undo it");
    assert_eq!(said("M67 E1 Q2\nM62 P1\nG0 X40\n"), [], "they are two outputs");
    assert_eq!(said("M67 E1 Q2\nM67 E1 Q3\nG0 X40\n"), [(2, "no-effect")]);
    assert_eq!(said("M62 P1\nG0 X22 Z8\nG76 P2 Z-10 I-1 J0.3 K0.98 R2\nM63 P1\nG0 X40\n"), []);
}

/// What is said of thin chips: line and message.
fn thin(program: &str) -> Vec<(u32, String)> {
    let found = check("part.ngc", program, &Machine::plain());
    let told = found.diagnostics.iter().filter(|one| one.code == "thin-chip");
    told.map(|one| (one.line, one.message.clone())).collect()
}

/// A name holds for what follows, up to the next one; what comes before the first belongs to the first. In a
/// chain it holds from its block on.
#[test]
fn a_name_holds_up_to_the_next_one() {
    let head = "G18 G21 G90 G8 G97\nS400 M3\n";
    let single = |z: f64| format!("G0 X9 Z8\nG33 Z-{z} K2\nG0 X20\n");
    let passes = |body: &str| {
        let check = interpreter::check("named.ngc", &format!("{head}{body}M2\n"), &Machine::plain());
        assert!(check.is_good(), "{body}: {:?}", check.diagnostics);
        let thread =
            |thread: interpreter::GaugedThread| (thread.nominal.name, Vec::from_iter(thread.from_mm));
        check.gauges.into_iter().map(thread).collect::<Vec<_>>()
    };
    let (a, b) = ("(thread, M20x2-6g)\n", "(thread, M24x2-6g)\n");
    let [one, two, three] = [20.0, 21.0, 22.0].map(single);
    let told = |of: &str, passes: &[u32]| (of.to_owned(), passes.iter().map(|pass| (*pass, None)).collect());
    assert_eq!(
        passes(&format!("{one}{a}{two}{b}{three}")),
        [told("M20x2-6g", &[1, 2]), told("M24x2-6g", &[3])]
    );
    assert_eq!(
        passes(&format!("{a}{one}{b}{two}{a}{three}")),
        [told("M20x2-6g", &[1, 3]), told("M24x2-6g", &[2])],
        "the first again"
    );
    let chain = format!("G0 X9 Z8\n{a}G33 Z-18 K2\nG33 Z-20 K2\n{b}G33 Z-34 K3\nG0 X20\n{a}{one}");
    let [first, second] = &passes(&chain)[..] else { panic!("two threads") };
    assert_eq!(first.1, [(1, None), (2, None)]);
    assert_eq!(second.1.len(), 1);
    assert!(matches!(second.1[0], (1, Some(z)) if (z + 20.0).abs() < 1e-9), "{second:?}");
    let missing = format!("{head}{a}{b}{one}M2\n");
    assert_eq!(said(&missing), [(3, "gauge-differs")]);
}

/// An edge that rubs is told once for a thread, however many passes do; a spring pass is none.
#[test]
fn a_pass_that_rubs_is_told_once_for_its_thread() {
    let cycle = |words: &str| {
        format!("G18 G21 G7 S400 M3\nG0 X22 Z8\nG76 P2 Z-20 I-2 {words} Q29.5 H2\nG0 X40\nM2\n")
    };
    assert_eq!(thin(&cycle("J0.8 K1.6 R1")), [], "two cuts of 0.4 mm and two spring passes");
    // Radii: 0.4, 0.4 and 0.02.
    let said = "a pass goes no more than 0.02 mm deeper than the one before in this groove: below 0.025 mm an edge \
                rubs instead of cutting";
    assert_eq!(thin(&cycle("J0.8 K1.64 R1")), [(3, said.into())]);
    assert_eq!(thin(&cycle("J0.8 K1.65 R1")), [], "just enough");
    let many = thin(&cycle("J0.2 K2 R2"));
    // 0.1 √n up to 1 mm: 100 passes, the last of which go 0.005 mm deeper.
    let rubs = (2..=100).filter(|n| 0.1 * (f64::from(*n).sqrt() - f64::from(n - 1).sqrt()) < 0.025).count();
    assert_eq!(many.len(), 1, "{many:?}");
    assert!(
        many[0].1.starts_with(&format!("{rubs} passes go as little as 0.005 mm deeper")),
        "{many:?} {rubs}"
    );
    // G33, of which nobody told the depth; outside it goes down, inside up; one that is shallower cuts air.
    let singles = |start: f64, step: f64, out: f64| {
        let pass = |n: i32| format!("G0 X{} Z8\nG33 Z-20 K2\nG0 X{out}\n", start + step * f64::from(n));
        format!("G18 G21 G7 S400 M3\nG0 X{out} Z8\n{}M2\n", (0..4).map(pass).collect::<String>())
    };
    for (start, out, inwards) in [(20.0, 24.0, -1.0), (20.0, 16.0, 1.0)] {
        assert_eq!(thin(&singles(start, 0.2 * inwards, out)), [], "{inwards}");
        let told = thin(&singles(start, 0.03 * inwards, out));
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(told[0].0 == 7 && told[0].1.starts_with("3 passes go as little as 0.015 mm"), "{told:?}");
        assert_eq!(thin(&singles(start, -0.03 * inwards, out)), [], "they cut air: {inwards}");
    }
    // Each start has its own last pass.
    let two =
        "G18 G21 G7 S400 M3\nG0 X24 Z8\nX20\nG33 Z-20 K4\nG0 X24\nZ10\nX19.97\nG33 Z-20 K4\nG0 X24\nM2\n";
    assert_eq!(thin(two), [], "0.015 mm deeper, in another groove");
}
