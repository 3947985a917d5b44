//! Blocks: spelling, modal state, order of execution. The expectation is a listing of the items.

use crate::{good, listing, mill::good_on};

fn assert_items(source: &str, expected: &str) {
    let expected: String = expected.lines().map(|line| format!("{}\n", line.trim())).collect();
    assert_eq!(listing(&good(source).items), expected.trim_start().to_owned(), "{source}");
}

#[test]
fn words_in_every_legal_spelling() {
    assert_items(
        "g 0 x 1 0 . 5 z - 3\n\tG01 X+0007.250 z-.5 F01 50\n/ N0010 x5.(on)z5;off\n  \nm002\n",
        "1 rapid X10.5 Z-3
         2 feed 150/min X7.25 Z-0.5
         3 feed 150/min X5 Z5
         5 end",
    );
}

#[test]
fn a_tape_ends_at_its_second_percent_sign() {
    assert_items("\n%\nG0 X1 Z1\n % \nG0 X99 Y1\n", "3 rapid X1 Z1\n3 end");
}

#[test]
fn motion_stays_in_force() {
    assert_items(
        "G0 X10 Z10\nX9\nG1 F60\nZ1\nX2 Z3\nG0\nX4\nM30\nG2 nothing here is read",
        "1 rapid X10 Z10
         2 rapid X9 Z10
         4 feed 60/min X9 Z1
         5 feed 60/min X2 Z3
         7 rapid X4 Z3
         8 end",
    );
}

#[test]
fn units_diameters_and_increments() {
    assert_items(
        "G0 X20 Z0\nG91 X-1 Z2\nG7 X-1\nG90 X20\nG20 X1 Z-1\nG91 X-.2\nG8 G90 X1 F2\nG1 Z0\nG21 Z1 F30\nM2",
        "1 rapid X20 Z0
         2 rapid X19 Z2
         3 rapid X18.5 Z2
         4 rapid X10 Z2
         5 rapid X12.7 Z-25.4
         6 rapid X10.16 Z-25.4
         7 rapid X25.4 Z-25.4
         8 feed 50.8/min X25.4 Z0
         9 feed 762/min X25.4 Z1
         10 end",
    );
}

#[test]
fn a_block_is_executed_in_the_order_of_the_standard() {
    assert_items(
        "M30 X12 Z1 G4 P0.5 M3 T2 S500 F100 G1 G95 (all at once)\n",
        "1 tool 2
         1 spindle 500
         1 dwell 0.5
         1 feed 100/rev X12 Z1
         1 spindle stop
         1 end",
    );
}

#[test]
fn the_spindle_is_told_when_something_changes() {
    assert_items(
        "S400\nM3\nM3\nS500\nS500 M4\nM5\nS600\nM5\nG0 X1\nM3\nM2",
        "2 spindle 400
         4 spindle 500
         5 spindle -500
         6 spindle stop
         9 rapid X1 Z100
         10 spindle 600
         11 spindle stop
         11 end",
    );
}

#[test]
fn feed_per_revolution_is_a_mode_with_its_own_feed() {
    assert_items(
        "S100 M3 F100\nG1 X10\nG95 F.2\nX11\nG94 F80 X12\nM2",
        "1 spindle 100
         2 feed 100/min X10 Z100
         4 feed 0.2/rev X11 Z100
         5 feed 80/min X12 Z100
         6 spindle stop
         6 end",
    );
}

#[test]
fn codes_that_name_the_only_state_there_is_are_taken() {
    assert_items("G18 G54 G97 G91.1 G8 G94\nG90.1\nM2", "3 end");
}

#[test]
fn parameters_take_effect_after_their_line() {
    assert_items(
        "#1=5 #2=7\n#1=6 G0 X#1 Z#2\nX#1 #2=#1\nZ#2\n#4=1 #4=2 #4=3\nX#4\n#[#4+1]=9\n#5=4\nX##5 Z-#4\nM2",
        "2 rapid X5 Z7
         3 rapid X6 Z7
         4 rapid X6 Z6
         6 rapid X3 Z6
         9 rapid X9 Z-9
         10 end",
    );
}

#[test]
fn messages_have_their_place_in_the_program() {
    let check = good(
        "(MSG, load the bar)\n( plain, text )\nG0 X12\n#1=2\n(DEBUG, X #1)\nG0 Z5\nM0\n(PRINT, on)\nM2\n",
    );
    assert!(check.diagnostics.is_empty(), "{:?}", check.diagnostics);
    let told: Vec<_> = check.messages.iter().map(|note| (note.line, note.after, &*note.text)).collect();
    assert_eq!(told, [(1, 0, "load the bar"), (5, 1, "X 2.000000"), (8, 3, "on")]);
}

#[test]
fn messages_without_end_are_told_to_an_end() {
    let check = good("o1 repeat [2000]\n(MSG, again)\no1 endrepeat\nM2\n");
    assert_eq!(check.messages.len(), 1000);
    assert_eq!((check.diagnostics[0].code, check.diagnostics[0].line), ("message-not-shown", 2));
}

#[test]
fn a_spindle_without_speed_is_a_warning() {
    let check = good("M3\nS100\nM2\n");
    assert_eq!(check.diagnostics[0].code, "no-spindle-speed");
    assert_eq!(listing(&check.items), "1 spindle 0\n2 spindle 100\n3 spindle stop\n3 end\n");
}

#[test]
fn time_adds_up() {
    // 2 s of dwell, 400 1/min at 800 1/min per s but for the band that counts as at speed, 60 mm at 60 mm/min
    // (ramps add little), and half a second until the spindle stands, 0.1 s more until that is seen.
    let check = good("G0 X10 Z0\nG4 P2\nS400 M3\nG1 Z-60 F60\nM2\n");
    let rapid = good("G0 X10 Z0\nM2\n").time_s;
    assert!(rapid > 0.5 && rapid < 2.0, "{rapid}");
    let rest = check.time_s - rapid;
    assert!((63.0..63.2).contains(&rest), "{rest}");
    // Behind a move the axes settle for three cycles of 2 ms; a second output as long again, so that a
    // pulse is seen.
    let mut machine = machine::Machine::plain();
    machine.outputs.insert("3".into(), machine::Output::default());
    let time = |text: &str| good_on(&machine, text).time_s;
    for (outputs, cycles) in [("", 0.0), ("M62 P3\n", 0.0), ("M64 P3\n", 3.0), ("M64 P3\nM65 P3\n", 6.0)] {
        let more = time(&format!("G0 X10 Z0\n{outputs}M2\n")) - rapid;
        assert!((more - 2e-3 * cycles).abs() < 1e-9, "{outputs:?} takes {more} s");
    }
}

/// Each output by its code, what it is set to, and whether it goes with the move; a chain is not broken by
/// it.
#[test]
fn outputs_are_set_as_the_program_says() {
    let mut machine = machine::Machine::plain();
    let chuck = machine::Output { name: "chuck".into(), standstill: true, ..Default::default() };
    machine.outputs = [("3".to_owned(), machine::Output::default()), ("4".to_owned(), chuck)].into();
    let air = machine::AnalogOutput { name: "air".into(), range: [0.0, 10.0], ..Default::default() };
    machine.analog_outputs.insert("1".into(), air);
    let check = good_on(
        &machine,
        "M62 P3\nG0 X10\nM63 P3 X20\nM64 P4\nM65 P3\nM67 E1 Q2.5\nM68 E1 Q10\nG0 X30\nM2\n",
    );
    let outputs = listing(&check.items);
    let outputs: Vec<&str> = outputs.lines().filter(|line| line.contains("output")).collect();
    let expected = [
        "1 output 3 Digital(true) in step true",
        "3 output 3 Digital(false) in step true",
        "4 output 4 Digital(true) in step false",
        "5 output 3 Digital(false) in step false",
        "6 output 1 Analog(2.5) in step true",
        "7 output 1 Analog(10.0) in step false",
    ];
    assert_eq!(outputs, expected);
    for (text, code, said) in [
        ("M62 P4\nG0 X10\nM2\n", "needs-standstill", "the axes move"),
        ("S100 M3\nM64 P4\nM2\n", "needs-standstill", "the spindle turns"),
        ("M67 E1 Q10.5\nG0 X10\nM2\n", "bad-value", "air, cannot be 10.5"),
        ("M68 E0 Q1\nM2\n", "unknown-output", "analog output 0 is not"),
        ("M62 P5\nG0 X10\nM2\n", "unknown-output", "output 5 is not"),
    ] {
        let found = interpreter::check("test.ngc", text, &machine).diagnostics;
        let [one] = &found[..] else { panic!("{text}: {found:?}") };
        assert!(one.code == code && one.message.contains(said), "{text}: {one:?}");
    }
    assert!(interpreter::check("test.ngc", "S100 M3\nM5\nM64 P4\nM2\n", &machine).is_good());
}

/// Tools that somebody puts in: M6 asks, T alone names the next one, and the spindle stands meanwhile.
#[test]
fn a_tool_by_hand_is_changed_at_m6_with_the_spindle_at_rest() {
    let mut machine = machine::Machine::plain();
    let text = "S100 M3\nT2\nG0 X10\nM6\nG0 X20\nT2 M6\nT3 M6\nM2\n";
    let tools = |machine: &machine::Machine| {
        let listed = listing(&good_on(machine, text).items);
        listed.lines().filter(|line| line.contains("tool")).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(tools(&machine), ["2 tool 2", "7 tool 3"], "a turret has it from T on");
    let automatic_s = good_on(&machine, text).time_s;
    machine.general.tool_change = machine::ToolChange::ByHand;
    assert_eq!(tools(&machine), ["4 tool 2", "7 tool 3"]);
    let by_hand_s = good_on(&machine, text).time_s;
    // From 100 1/min the spindle has to come to a stand first; nobody foretells how long somebody takes.
    assert!(by_hand_s > automatic_s + 0.1, "{by_hand_s} {automatic_s}");
    machine.general.dialect = machine::ProgramDialect::Fanuc;
    let found = interpreter::check("test.nc", "O1\nG97 S100 M3\nT0202\nM30\n", &machine).diagnostics;
    let [one] = &found[..] else { panic!("{found:?}") };
    assert!(one.code == "needs-standstill" && one.message.contains("the spindle turns"), "{one:?}");
    assert!(interpreter::check("test.nc", "O1\nT0202\nG97 S100 M3\nM30\n", &machine).is_good());
}

/// M66 becomes a wait; what cannot be waited for is refused with the remedy.
#[test]
fn inputs_are_waited_for_as_the_program_says() {
    let mut machine = machine::Machine::plain();
    machine.inputs.insert("2".into(), machine::Input::default());
    let check =
        good_on(&machine, "M66 P2 L1 Q0.5\nM66 P2 L4 Q5\no1 if [#5399 EQ -1]\nM66 P9 L1 Q1\no1 endif\nM2\n");
    assert_eq!(listing(&check.items), "1 await 2 Rise 0.5\n2 await 2 Low 5\n6 end\n");
    for (text, code, said) in [
        ("M66 P3 L3 Q5\nM2\n", "unknown-input", "input 3 is not"),
        ("M66 P2 L0\nM2\n", "unknown-input", "known when the machine runs"),
        ("M66 E2\nM2\n", "unknown-input", "known when the machine runs"),
        ("M66 P2 L3 Q86401\nM2\n", "bad-value", "cannot wait 86401 s"),
    ] {
        let found = interpreter::check("test.ngc", text, &machine).diagnostics;
        let [one] = &found[..] else { panic!("{text}: {found:?}") };
        assert!(one.code == code && one.message.contains(said), "{text}: {one:?}");
    }
}
