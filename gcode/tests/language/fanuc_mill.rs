//! FANUC and Haas mills, held against the same part in RS274/NGC and against points computed by hand, both in
//! coordinates of the machine.

use gcode::canon::{Arc, X, Y, Z};
use gcode::files::ToolTable;
use gcode::{Call, Dialect, Options, Place, Pose, Problem, Program, Sink};

use crate::driven::{Driven, driven};

/// Moves where the machine makes them, and what else acts on the part.
#[derive(Default)]
struct Shop {
    system: Pose,
    shift: Pose,
    rotation: f64,
    tool: Pose,
    seen: Vec<String>,
}

impl Shop {
    fn at(&self, point: &Pose) -> Vec<f64> {
        let (x, y) = (point[X] + self.shift[X], point[Y] + self.shift[Y]);
        let (sin, cos) = libm::sincos(self.rotation.to_radians());
        let flat = [x * cos - y * sin, x * sin + y * cos, point[Z] + self.shift[Z]];
        [X, Y, Z].map(|axis| flat[axis] + self.system[axis] + self.tool[axis]).to_vec()
    }

    fn note(&mut self, what: &str, numbers: &[f64]) {
        let numbers: Vec<String> = numbers.iter().map(|number| format!("{:.3}", number + 0.0)).collect();
        self.seen.push(format!("{what} {}", numbers.join(" ").replace("-0.000", "0.000")));
    }
}

impl Sink for Shop {
    fn call(&mut self, _: Place, call: Call<'_>) -> Result<(), Box<Problem>> {
        match call {
            Call::SetG5xOffset(_, offset) => self.system = offset,
            Call::SetG92Offset(offset) => self.shift = offset,
            Call::SetXyRotation(degrees) => self.rotation = degrees,
            Call::UseToolLengthOffset(offset) => self.tool = offset,
            Call::StraightTraverse(end) => self.note("G0", &self.at(&end)),
            Call::StraightFeed(end) => self.note("G1", &self.at(&end)),
            Call::ArcFeed(Arc { end, center, along, turns, .. }) => {
                self.note("arc", &[end[0], end[1], center[0], center[1], along, f64::from(turns)]);
            }
            Call::Dwell(seconds) => self.note("dwell", &[seconds]),
            Call::SetFeedRate(feed) if feed > 0.0 => self.note("F", &[feed]),
            Call::StartSpindle(..)
            | Call::StopSpindle
            | Call::ChangeTool(_)
            | Call::FloodOn
            | Call::ProgramStop => {
                self.seen.push(format!("{call:?}"));
            }
            _ => {}
        }
        Ok(())
    }
}

fn run(dialect: Dialect, text: &str) -> Driven<Shop> {
    let tools = ToolTable::parse("tools", "T1 Z50 D10\nT2 Z30 D6\n").expect("a table");
    let options = Options { dialect, tools, ..Options::default() };
    driven(Program::from_text("O0001.nc", format!("{text}\nM30\n"), &options), Shop::default())
}

fn seen(dialect: Dialect, text: &str) -> Vec<String> {
    let outcome = run(dialect, text);
    let errors: String = outcome.errors.iter().map(|error| error.render(false)).collect();
    assert!(errors.is_empty(), "{errors}");
    outcome.sink.seen
}

fn mill(text: &str) -> Vec<String> {
    seen(Dialect::FanucMill, text)
}

fn same(fanuc: &str, ngc: &str) {
    let (fanuc, ngc) = (mill(fanuc), seen(Dialect::Linuxcnc, ngc));
    assert!(ngc.len() > 2, "{ngc:?}");
    assert_eq!(fanuc, ngc);
}

fn errors(text: &str) -> Vec<(u32, &'static str)> {
    run(Dialect::FanucMill, text).errors.iter().map(|error| (error.line, error.code)).collect()
}

#[test]
fn a_contour_with_compensation_is_that_of_the_other_dialect() {
    same(
        "%\nO1000 (PLATE)\nG00 G17 G21 G40 G49 G80 G90 G94\nT1 M06\nG54 X-20. Y-20. S2000 M03\nG43 H01 Z5. M08\n\
         G01 Z-2. F100.\nG41 D01 X0. F200.\nY30.\nG02 X10. Y40. R10.\nG01 X40.\nG03 X50. Y30. I0. J-10.\nG01 Y0.\n\
         X-10.\nG40 X-20. Y-20.\nG00 Z50. M05",
        "G17 G21 G40 G49 G90 G94\nT1 M6\nS2000 M3\nG54 G0 X-20 Y-20\nM8\nG43 H1 G0 Z5\nG1 Z-2 F100\n\
         G41 D1 G1 X0 F200\nY30\nG2 X10 Y40 R10\nG1 X40\nG3 X50 Y30 I0 J-10\nG1 Y0\nX-10\nG40 X-20 Y-20\nG0 Z50\nM5",
    );
}

#[test]
fn holes_have_the_moves_of_the_other_dialect() {
    let start = "S1000 M3\nG0 X0 Y0 Z20\n".replace("X0 Y0 Z20", "X0. Y0. Z20.");
    let ngc = "G98\nS1000 M3\nG0 X0 Y0 Z20\n";
    for (fanuc, other) in [
        ("G81 X10. Y5. Z-8. R2. F80.\nX20.\nG99 X30.\nG80", "G81 X10 Y5 Z-8 R2 F80\nX20\nG99 X30\nG80"),
        ("G82 X10. Z-8. R2. P500 F80.", "G82 X10 Z-8 R2 P0.5 F80"),
        ("G83 X10. Z-8. R2. Q3. F80.\nG80", "G83 X10 Z-8 R2 Q3 F80\nG80"),
        ("G73 X10. Z-8. R2. Q3. F80.", "G73 X10 Z-8 R2 Q3 F80"),
        ("G85 X10. Z-8. R2. F80.", "G85 X10 Z-8 R2 F80"),
        ("G86 X10. Z-8. R2. F80.", "G86 X10 Z-8 R2 P0 F80"),
        ("G89 X10. Z-8. R2. P200 F80.", "G89 X10 Z-8 R2 P0.2 F80"),
        ("G91 G81 X5. Z-6. R-18. K3 F80.", "G91 G81 X5 Z-6 R-18 L3 F80"),
        // words stay in force from one cycle to another, and K0 keeps them for the next block
        ("G81 X10. Z-8. R2. F80.\nG83 X20. Q3.", "G81 X10 Z-8 R2 F80\nG83 X20 Z-8 R2 Q3"),
        ("G81 Z-8. R2. F80. L0\nX10.\nY10.\nG80 G00 Z50.", "G81 X10 Z-8 R2 F80\nY10\nG80\nG0 Z50"),
        ("G81 X10. Z-8. F80.", "G81 X10 Z-8 R20 F80"),
        // without a point: increments
        ("G83 X10000 Z-8000 R2000 Q3000 F80", "G83 X10 Z-8 R2 Q3 F80"),
    ] {
        let fanuc = format!("{start}{fanuc}");
        let bare =
            if fanuc.contains("10000") { fanuc.replace("X0. Y0. Z20.", "X0 Y0 Z20000") } else { fanuc };
        same(&bare, &format!("{ngc}{other}"));
    }
}

#[test]
fn codes_of_group_01_end_a_cycle_and_g80_leaves_them_in_force() {
    let start = "S1000 M03 F80.\nG00 X0. Y0. Z20.\n";
    let moved = mill(&format!("{start}G81 X10. Z-8. R2.\nG80\nX20.\nG01 Y5."));
    assert_eq!(
        moved[moved.len() - 4..moved.len() - 1],
        ["G0 10.000 0.000 20.000", "G0 20.000 0.000 20.000", "G1 20.000 5.000 20.000"]
    );
}

#[test]
fn f_counts_in_every_block() {
    let moved = mill("S1000 M03\nG01 X1. F80.\nF90.\nX2.\nG81 X3. Z-2. R1.\nX4. F70.\nG80\nM30");
    let feeds: Vec<&String> = moved.iter().filter(|call| call.starts_with('F')).collect();
    assert_eq!(feeds, ["F 80.000", "F 90.000", "F 70.000"], "{moved:?}");
    let place = |call: &str| moved.iter().position(|one| one.starts_with(call));
    assert!(place("F 70.000") < place("G0 4.000"), "{moved:?}");
    same("S1000 M03\nG93 G01 X1. F4.\nX2. F2.", "S1000 M3\nG93 G1 X1 F4\nX2 F2");
    let idle = run(Dialect::FanucMill, "S1000 M03\nG93\nF4.\nG00 X1. F4.\nG81 X1. Z-5. R2. F80.\nK2");
    let warned: Vec<_> = idle.warnings.iter().map(|one| (one.line, one.code)).collect();
    assert_eq!(warned[..2], [(3, "no-effect"), (4, "no-effect")], "{warned:?}");
    assert_eq!(warned.last(), Some(&(6, "no-effect")), "{warned:?}");
}

#[test]
fn words_that_another_one_says_or_another_l_takes_are_refused() {
    assert_eq!(errors("G10 L2 P1 X1. R1.\nG10 L20 P1 R1."), [(1, "unused-word"), (2, "unused-word")]);
    assert_eq!(errors("G10 L10 P1 R5. X3.\nG09"), [(1, "unused-word"), (2, "missing-word")]);
    assert_eq!(errors("F80.\nG81 X1. Z-5. R2. K2 L3"), [(2, "repeated-word")]);
}

#[test]
fn coordinate_systems_and_more_of_them() {
    same(
        "G10 L2 P2 X10. Y20. Z-5.\nG55 G00 X1. Y1. Z1.\nG91 G10 L2 P2 X5.\nG90 X1.\nG52 X3.\nX1.\nG52 X0.\nG92 X0.\nX1.",
        "G10 L2 P2 X10 Y20 Z-5\nG55 G0 X1 Y1 Z1\nG10 L2 P2 X15\nG0 X1\nG52 X3\nG0 X1\nG52 X0\nG92 X0\nG0 X1",
    );
    let moved = mill(
        "G10 L20 P7 X100. Y10.\nG54.1 P7 G00 X1. Y2.\nG154 P8 X1.\nG54 X1.\nG10 L20 P8 X-3.\nG154 P8 X1.",
    );
    assert_eq!(
        moved[..4],
        [
            "G0 101.000 12.000 0.000",
            "G0 1.000 12.000 0.000",
            "G0 1.000 12.000 0.000",
            "G0 -2.000 12.000 0.000"
        ]
    );
    assert_eq!(errors("G54.1 X1."), [(1, "missing-word")]);
    assert_eq!(errors("G10 L2 P9 X1."), [(1, "not-available")]);
    assert_eq!(errors("G10 L50\nG10 L11 P1 R1."), [(1, "not-available"), (2, "not-available")]);
}

#[test]
fn lengths_of_tools() {
    same(
        "G43 H2 G00 Z10.\nH1 Z10.\nG49 Z10.\nG44 H1 Z10.\nG49 G00 G53 Z0.\nG91 G28 Z0.\nG90",
        "G43 H2 G0 Z10\nG43 H1 G0 Z10\nG49 G0 Z10\nG43.1 Z-50\nG0 Z10\nG49\nG53 G0 Z0\nG91 G28 Z0\nG90",
    );
    assert_eq!(mill("G10 L10 P1 R80.\nG43 H1 G00 Z1.")[0], "G0 0.000 0.000 81.000");
    let outcome = run(Dialect::FanucMill, "G43 H7 G00 Z10.\nG01 G41 D9 X5. F80.");
    assert!(outcome.errors.is_empty(), "{:?}", outcome.errors);
    let warned: Vec<_> = outcome.warnings.iter().map(|warning| (warning.line, warning.code)).collect();
    assert_eq!(warned, [(1, "unknown-tool"), (2, "unknown-tool")]);
}

#[test]
fn a_rotation_turns_about_its_centre() {
    // 90 degrees about (10, 0): (20, 0) is at (10, 10), (10, 5) at (5, 0)
    let turned = mill("G00 X0. Y0.\nG68 X10. Y0. R90.\nX20. Y0.\nG01 X10. Y5. F80.\nG69\nG00 X20. Y0.");
    assert_eq!(
        turned,
        [
            "G0 0.000 0.000 0.000",
            "G0 10.000 10.000 0.000",
            "F 80.000",
            "G1 5.000 0.000 0.000",
            "G0 20.000 0.000 0.000",
            "StopSpindle"
        ]
    );
    // the same in a system that is shifted, and by steps under G91
    let shifted = "G10 L2 P1 X100. Y0. Z0.\nG54 G52 X1.\nG00 X0. Y0.\n";
    let steps = mill(&format!("{shifted}G68 X10. Y0. R60.\nG91 G68 R30. X0. Y0.\nG90 X20. Y0."));
    assert!(steps.len() == 3, "{steps:?}");
    assert_eq!(mill(&format!("{shifted}G68 X10. Y0. R90.\nX20. Y0."))[1], "G0 111.000 10.000 0.000");
    assert_eq!(errors("G68 X0. Y0. R30.\nG55"), [(2, "not-available")]);
    assert_eq!(errors("G18 G68 X0. Y0. R30."), [(1, "not-available")]);
    assert_eq!(errors("G68 X0. Y0."), [(1, "missing-word")]);
}

#[test]
fn subprograms_and_macros() {
    let sub = "\nM30\nO2000\nG91 X1.\nG90\nM99\n";
    assert_eq!(mill(&format!("G00 X0.\nM98 P32000{sub}")).len(), 5);
    assert_eq!(mill(&format!("G00 X0.\nM98 P2000 L3{sub}")).len(), 5);
    // M97: a part of the same program
    let local = "G00 X0.\nM97 P100 L2\nX9.\nM30\nN100 G91 X1.\nG90\nM99";
    assert_eq!(
        mill(local)[..4],
        ["G0 0.000 0.000 0.000", "G0 1.000 0.000 0.000", "G0 2.000 0.000 0.000", "G0 9.000 0.000 0.000"]
    );
    assert_eq!(errors("M97 P5"), [(1, "unknown-label")]);
    // G66: behind each move, until G67; #5003 is Z
    let modal = "G00 X0. Y0. Z5.\nG66 P3000 Z-2. F80.\nX10.\nY10.\nG67\nX0.\nM30\nO3000\n#30=#5003\nG01 Z#26 F#9\nG00 Z#30\nM99";
    let moves: Vec<String> = mill(modal).into_iter().filter(|call| call.starts_with("G1")).collect();
    assert_eq!(moves, ["G1 10.000 0.000 -2.000", "G1 10.000 10.000 -2.000"]);
}

#[test]
fn what_does_nothing_and_what_is_refused_by_name() {
    assert_eq!(mill("G15 G50 G69 G67 G64\nG187 P2\nG05.1 Q1\nG00 X1.")[0], "G0 1.000 0.000 0.000");
    for (text, reason) in [
        ("G76 X1. Z-5. R2. Q1. F80.", "does not stop at an angle"),
        ("G87 X1. Z-5. R2. F80.", "does not stop at an angle"),
        ("G51 X0. Y0. P2.", "scaled"),
        ("G16", "polar"),
        ("G96 S100", "surface speed"),
        ("G33 Z-5. F1.", "follow"),
    ] {
        let outcome = run(Dialect::FanucMill, text);
        let [error] = outcome.errors.as_slice() else { panic!("{text}: {:?}", outcome.errors) };
        assert_eq!(error.code, "not-available", "{text}");
        assert!(error.message.contains(reason), "{}", error.message);
    }
    assert_eq!(errors("G00 U1."), [(1, "not-available")]);
    assert_eq!(errors("G00 X1. Q2."), [(1, "unused-word")]);
    assert_eq!(errors("G01 X1. ,C2. F80."), [(1, "unused-word")]);
    let kept = run(Dialect::FanucMill, "G81 X1. Z-5. R2. Q1. F80.\nG83 X2.");
    assert!(kept.errors.is_empty(), "{:?}", kept.errors);
    assert_eq!(kept.warnings.iter().map(|one| (one.line, one.code)).collect::<Vec<_>>(), [(1, "no-effect")]);
    assert_eq!(errors("G81 X1. Z-5. R2. G00"), [(1, "modal-group")]);
    assert_eq!(errors("G54.1 G04 P500"), [(1, "modal-group")]);
    assert_eq!(errors("M29 S500\nM12"), [(2, "unknown-m-code")]);
    assert_eq!(errors("S100 M03\nG01 X5. F80.\nX40"), [(3, "no-decimal-point")]);
}
