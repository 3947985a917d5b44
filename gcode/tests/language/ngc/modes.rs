//! Order of execution, units, G7 G8, feed, path and plane modes, spindle, outputs, stops; M70 to M73.

use super::printed::printed;
use super::recorded::{calls, errors, messages, outcome};

/// The names of the calls of a block.
fn names(text: &str) -> Vec<String> {
    calls(text).iter().map(|call| call.split(['(', ' ']).next().unwrap_or_default().to_owned()).collect()
}

#[test]
fn a_block_is_executed_in_the_order_of_the_language() {
    let block = "X1 G1 G61 G55 G90 G21 G17 M8 M3 M6 T0 S100 F50 G94 G97 (first) M49 M64 P1 G49 M60 G40";
    let expected = "Comment SetSpindleMode Note SetFeedMode SetFeedRate SetFeedRate SetSpindleSpeed SelectTool \
        SetAuxOutputBit StopSpindle ChangeTool StartSpindle FloodOn EnableFeedOverride EnableSpeedOverride SelectPlane \
        UseLengthUnits Note UseToolLengthOffset SetG5xOffset SetG92Offset SetXyRotation SetMotionControlMode \
        StraightFeed PalletShuttle ProgramStop";
    assert_eq!(names(block).join(" "), expected);
}

#[test]
fn a_change_of_units_keeps_the_place() {
    let text =
        "G10 L2 P1 X25.4\nG92 Z2.54\nG0 X50.8 A30\nG20\n(debug,#<_x> #<_z> #<_abs_x> #<_a> #5221 #5213)";
    assert_eq!(messages(text), ["2.000000 0.100000 3.000000 30.000000 25.400000 -2.540000"]);
}

#[test]
fn feed_and_tool_offset_are_converted_with_the_units() {
    assert_eq!(
        messages("F254\nG43.1 Z25.4\nG20\n(debug,#<_feed> #5083 #<_z>)"),
        ["10.000000 1.000000 -1.000000"]
    );
}

#[test]
fn another_feed_mode_forgets_f() {
    assert_eq!(errors("F100\nG94\nG1 X1\nM2\n"), [(3, "no-feed")]);
    assert_eq!(errors("F100\nG93\nG1 X1\nM2\n"), [(3, "no-feed")]);
    assert_eq!(errors("G93\nG1 X1 F2\nM2\n"), []);
}

#[test]
fn x_is_a_diameter_under_g7() {
    let text = "G7\nG0 X10\n(debug,#<_x>)\nG92 X4\n(debug,#<_x>)\nG8 G0 X4\n(debug,#<_x>)";
    assert_eq!(messages(text), ["5.000000", "2.000000", "4.000000"]);
    assert_eq!(
        messages("G7\nG10 L2 P1 X6\n(debug,#5221)\nG43.1 X2\n(debug,#5081)"),
        ["3.000000", "1.000000"]
    );
}

#[test]
fn negative_speeds_and_feeds_are_refused() {
    assert_eq!(errors("S-1\nF-1\nM2\n"), [(1, "bad-value"), (2, "bad-value")]);
}

#[test]
fn planes_of_u_v_w_are_refused_by_name() {
    assert_eq!(
        errors("G17.1\nG18.1\nG19.1\nM2\n").iter().filter(|(_, code)| *code == "not-available").count(),
        3
    );
}

#[test]
fn what_is_probably_wrong_is_a_warning() {
    let codes = |text: &str| outcome(text).warnings.iter().map(|warning| warning.code).collect::<Vec<_>>();
    assert_eq!(codes("G96 S100\nM2\n"), ["no-highest-speed"]);
    assert_eq!(codes("G96 S100 D2000\nM2\n"), [""; 0]);
    assert_eq!(codes("M3\nM2\n"), ["no-spindle-speed"]);
    assert_eq!(codes("M6\nM2\n"), ["no-tool"]);
    assert_eq!(codes("T5\nM2\n"), [""; 0], "without a table there is no tool to miss");
    assert_eq!(codes("G95 F0.1 S100\nG1 X1\nM2\n"), ["spindle-not-turning"]);
    assert_eq!(codes("G95 F0.1 S100 M3\nG1 X1\nX2\nM2\n"), [""; 0]);
    assert_eq!(codes("M73\nM2\n"), ["no-effect"]);
}

#[test]
fn inputs_need_a_number_a_way_and_a_time() {
    for bad in [
        "M66",
        "M66 P1 L0",
        "M66 E1",
        "M66 P1 E1",
        "M66 P1 L1",
        "M66 P1 L5 Q1",
        "M66 E1 L1 Q1",
        "M66 P-1",
        "M62",
        "M67 E1",
        "M68 Q1",
    ] {
        assert_eq!(errors(&format!("{bad}\nM2\n")).len(), 1, "{bad}");
    }
    let wait = "WaitInput { index: 2, analog: false, wait: 3, timeout: 1.5 }";
    assert_eq!(calls("M66 P2 L3 Q1.5"), [wait]);
    // Behind a wait the input is what was waited for.
    for (l, level) in [(1, 1.0), (2, 0.0), (3, 1.0), (4, 0.0)] {
        let told = calls(&format!("#5399=7\nM66 P2 L{l} Q1.5\nG4 P#5399"));
        assert_eq!(told.last().map(String::as_str), Some(format!("Dwell({level:?})").as_str()), "L{l}");
    }
}

#[test]
fn the_end_puts_back_what_the_language_says() {
    let outcome = outcome("G18 G91 G55 G95 G96 S9 D99 M3 M8 M49 F1\nM2\n");
    assert!(outcome.program.is_ended());
    assert_eq!(outcome.program.parameter(5220), Some(1.0), "G54");
    let end: Vec<&str> = outcome
        .sink
        .calls
        .iter()
        .skip_while(|call| *call != "SetFeedRate(1.0)")
        .map(String::as_str)
        .collect();
    for call in [
        "SelectPlane(Xy)",
        "SetFeedMode(PerMinute)",
        "SetFeedRate(0.0)",
        "EnableFeedOverride(true)",
        "EnableSpeedOverride(true)",
        "StopSpindle",
        "SetSpindleMode(0.0)",
        "FloodOff",
        "ProgramEnd",
    ] {
        assert!(end.contains(&call), "{call} is not among {end:?}");
    }
}

#[test]
fn m19_without_words_orients_the_spindle() {
    let oriented = |text: &str| calls(&format!("S100 M3\n{text}")).split_off(2);
    assert_eq!(oriented("M19"), ["OrientSpindle(0.0, 0)"]);
    assert_eq!(oriented("M19 Q3"), ["OrientSpindle(0.0, 0)", "WaitSpindleOrient(3.0)"]);
    assert_eq!(oriented("M19 R90 P1"), ["OrientSpindle(90.0, 1)"]);
}

#[test]
fn m72_restores_what_m70_saved() {
    let change = "G20 G91 G18 G55 G7 G90.1 G99 G61 G95 F0.2 S9 M4";
    let text = format!("G21 G98 G64 P0.1 Q0.2 F0.123 S12.5 M3\nM70\n{change}\nM72\nM2\n");
    let outcome = outcome(&text);
    assert!(outcome.errors.is_empty());
    let tail = outcome.sink.calls;
    let restored = |call: &str| tail.iter().rposition(|other| other == call);
    let changed = restored("StartSpindle(Counterclockwise)");
    for call in [
        "UseLengthUnits(Millimetre)",
        "SetFeedMode(PerMinute)",
        "SetFeedRate(0.123)",
        "SetSpindleSpeed(12.5)",
        "StartSpindle(Clockwise)",
        "SelectPlane(Xy)",
        "SetMotionControlMode(Continuous(0.1))",
        "SetNaivecamTolerance { tolerance: 0.2, programmed: true }",
        "Note(\"distance mode changed to absolute\")",
        "Note(\"retract mode set to old_z\")",
    ] {
        assert!(restored(call) > changed, "{call}");
    }
}

#[test]
fn coolant_and_overrides_are_restored_whatever_they_were() {
    for saved in ["M9", "M7", "M8", "M7\nM8"] {
        for then in ["M9", "M7", "M8", "M7\nM8"] {
            let shown = |text: &str| messages(&format!("{text}\n(debug,#<_mist> #<_flood>)"));
            assert_eq!(shown(&format!("{saved}\nM70\nM9\n{then}\nM72")), shown(saved), "{saved} {then}");
        }
    }
    for saved in ["M48", "M49", "M50 P0", "M51 P0"] {
        for then in ["M48", "M49", "M50 P0", "M51 P0\nM52\nM53"] {
            let all = "#<_feed_override> #<_speed_override> #<_adaptive_feed> #<_feed_hold>";
            let shown = |text: &str| messages(&format!("{text}\n(debug,{all})"));
            assert_eq!(shown(&format!("{saved}\nM70\n{then}\nM72")), shown(saved), "{saved} {then}");
        }
    }
}

#[test]
fn m73_is_restored_by_the_return() {
    let text =
        "G90\no1 sub\nM73\nG91 F5\n(debug,#<_absolute>)\no1 endsub\no1 call\n(debug,#<_absolute> #<_feed>)";
    assert_eq!(messages(text), ["0.000000", "1.000000 0.000000"]);
    let text = "G90\no1 sub\nM70\nG91\no1 endsub\no1 call\n(debug,#<_absolute>)";
    assert_eq!(messages(text), ["0.000000"]);
}

#[test]
fn m72_without_m70_is_an_error() {
    assert_eq!(errors("M72\nM2\n"), [(1, "nothing-saved")]);
    assert_eq!(errors("M70\nM71\nM72\nM2\n"), [(3, "nothing-saved")]);
}

#[test]
fn r_of_g64_asks_for_a_planner_before_the_path_mode() {
    let modes = |text: &str| -> Vec<String> {
        printed(text)
            .into_iter()
            .filter(|call| call.contains("PLANNER") || call.contains("CONTROL"))
            .collect()
    };
    let smooth = |scale: &str| format!("SET_PLANNER_MODE type=1 peak_scale={scale}");
    for (word, asked) in [("R0.5", smooth("0.5")), ("R2.5", smooth("1")), ("R0.05", smooth("0.1"))] {
        let said = modes(&format!("G64 P1 {word}"));
        assert_eq!((said.len(), &said[0]), (2, &asked), "{said:?}");
    }
    assert!(modes("G64 P1 R0")[0].contains("type=0"));
    assert_eq!(modes("G64 P1").len(), 1);
    assert_eq!(errors("G64 R1 M19\nM2"), [(1, "ambiguous-word")]);
}
