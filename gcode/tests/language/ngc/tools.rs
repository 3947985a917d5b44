//! T, M6, M61, G43 to G49, G10 L1 L10 L11.

use gcode::files::ToolTable;
use gcode::{Options, Program};

use super::recorded::{Outcome, run};

const TABLE: &str = "T1 P1 Z-85.2 D10\nT12 P3 X-12.4 Z-35.6 D1.6 I95 J155 Q2\n";

fn with_table(text: &str) -> Outcome {
    let tools = ToolTable::parse("tool.tbl", TABLE).expect("a table");
    let options = Options { tools, ..Options::default() };
    run(Program::from_text("test.ngc", format!("{text}\nM2\n"), &options))
}

fn messages(text: &str) -> Vec<String> {
    let outcome = with_table(text);
    assert!(outcome.errors.is_empty(), "{text}: {:?}", outcome.errors);
    let quoted = |call: &String| Some(call.strip_prefix("Message(\"")?.strip_suffix("\")")?.to_owned());
    outcome.sink.calls.iter().filter_map(quoted).collect()
}

fn error(text: &str) -> (&'static str, String) {
    let outcome = with_table(text);
    let error = outcome.errors.first().unwrap_or_else(|| panic!("{text} is taken"));
    (error.code, error.text[error.span.clone()].to_owned())
}

#[test]
fn a_tool_that_the_table_does_not_have_is_refused() {
    assert_eq!(error("T5"), ("unknown-tool", "T5".into()));
    assert_eq!(error("T99 M6"), ("unknown-tool", "T99".into()));
    assert!(with_table("T12 M6\nT0 M6\n").errors.is_empty());
}

#[test]
fn the_tool_in_the_spindle_can_be_read() {
    let all = "(debug,#5400 #5401 #5403 #5410 #5411 #5412 #5413 #<_current_pocket>)";
    let expected = "12.000000 -12.400000 -35.600000 1.600000 95.000000 155.000000 2.000000 3.000000";
    assert_eq!(messages(&format!("T12 M6\n{all}")), [expected]);
    assert_eq!(messages(&format!("M61 Q12\n{all}")), [expected]);
    assert_eq!(messages("T12 M6\nT0 M6\n(debug,#5400 #5410)"), ["0.000000 0.000000"]);
}

#[test]
fn a_tool_offset_keeps_the_point_of_the_machine() {
    let text = "T1 M6 G43\n(debug,#<_z> #<_abs_z> #5083)\nG43.2 H12\n(debug,#<_z> #<_x>)\nG49\n(debug,#<_z>)";
    let expected = ["85.200000 0.000000 -85.200000", "120.800000 12.400000", "0.000000"];
    assert_eq!(messages(text), expected);
    assert_eq!(
        messages("G43.1 Z4\nG43.1 X1\n(debug,#5081 #5083)\nG43.2 X1\n(debug,#5081)"),
        ["1.000000 4.000000", "2.000000"]
    );
    // Beside H an axis is for the move, and not left out.
    assert_eq!(messages("T1 M6 G43\nG43.2 H12 G0 X7\n(debug,#<_x>)"), ["7.000000"]);
    assert_eq!(error("G80 G43.2 H1 X3"), ("unused-word", "X3".into()));
}

#[test]
fn tools_that_must_be_known_are_refused() {
    assert_eq!(error("G43 H99"), ("unknown-tool", "H99".into()));
    assert_eq!(error("M61 Q99"), ("unknown-tool", "Q99".into()));
    assert_eq!(error("G10 L1 P99 Z1"), ("unknown-tool", "P99".into()));
    assert_eq!(error("T99 M6\nG43").0, "unknown-tool");
    assert_eq!(error("T1.5"), ("bad-value", "T1.5".into()));
    assert_eq!(error("T-1"), ("bad-value", "T-1".into()));
    assert_eq!(error("M61"), ("missing-word", "M61".into()));
}

#[test]
fn g10_l1_writes_the_table() {
    let text = "T12 M6\nG10 L1 P12 X-8 R0.2 Q3 I90\n(debug,#5401 #5403 #5410 #5411 #5413)";
    assert_eq!(messages(text), ["-8.000000 -35.600000 0.400000 90.000000 3.000000"]);
    assert_eq!(messages("G10 L1 P1 Z5\nT1 M6\n(debug,#5403)"), ["5.000000"]);
    assert_eq!(messages("G20\nG10 L1 P1 Z1\nT1 M6\n(debug,#5403)"), ["25.400000"]);
}

#[test]
fn g10_l10_measures_where_the_tool_is() {
    let text = "T1 M6 G43\nG0 Z10\nG10 L10 P1 Z0\n(debug,#5403)\nG43\n(debug,#<_z>)";
    assert_eq!(messages(text), ["-75.200000", "0.000000"]);
    let turned =
        "G10 L2 P1 X7 R30\nT1 M6 G43\nG0 X4 Y5 Z9\nG10 L10 P1 X3 Y5 Z9\nG43\n(debug,#<_x> #<_y> #<_z>)";
    assert_eq!(messages(turned), ["3.000000 5.000000 9.000000"]);
    let fixture = "G10 L2 P9 Z-4\nT1 M6 G43\nG0 Z1\nG92 Z30\nG10 L11 P1 Z0\nG43 G59.3 G92.1\n(debug,#<_z>)";
    assert_eq!(messages(fixture), ["0.000000"]);
}

#[test]
fn m6_stops_the_spindle() {
    assert_eq!(messages("M3 S100\nT1 M6\n(debug,#<_spindle_on>)"), ["0.000000"]);
}

#[test]
fn the_stand_alone_driver_of_linuxcnc_does_not_follow_tool_offsets() {
    let text = "G0 Z50\nT1 M6 G43\nG0 X1\nG20\n(debug,#5083)\nM2\n";
    let ends = |stand_alone| {
        let tools = ToolTable::parse("tool.tbl", TABLE).expect("a table");
        let options = Options { tools, stand_alone, ..Options::default() };
        let calls = run(Program::from_text("test.ngc", text, &options)).sink.calls;
        let told =
            calls.into_iter().filter(|call| call.starts_with("StraightT") || call.starts_with("Message"));
        told.skip(1).collect::<Vec<_>>()
    };
    assert_eq!(ends(true), ["StraightTraverse([1.0, 0.0, 50.0, 0.0, 0.0, 0.0])", "Message(\"-85.200000\")"]);
    assert_eq!(ends(false), ["StraightTraverse([1.0, 0.0, 135.2, 0.0, 0.0, 0.0])", "Message(\"-3.354331\")"]);
}
