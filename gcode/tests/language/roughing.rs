//! Programs with G70, G71 and G72.

use gcode::canon::{Arc, X, Z};
use gcode::{Call, Diagnostic, Options, Place, Problem, Program, Sink};

use crate::driven::{Driven, driven};

/// Moves as text: R and F with X and Z, A with its centre and turns.
#[derive(Default)]
struct Moves(Vec<String>);

fn text(letter: char, x: f64, z: f64) -> String {
    let round = |value: f64| (value * 1000.0).round() / 1000.0 + 0.0;
    format!("{letter} {} {}", round(x), round(z))
}

impl Sink for Moves {
    fn call(&mut self, _: Place, call: Call<'_>) -> Result<(), Box<Problem>> {
        match call {
            Call::StraightTraverse(to) => self.0.push(text('R', to[X], to[Z])),
            Call::StraightFeed(to) => self.0.push(text('F', to[X], to[Z])),
            Call::ArcFeed(Arc { end: [z, x], center, turns, .. }) => {
                self.0.push(format!("{} {}{turns:+}", text('A', x, z), text('c', center[1], center[0])));
            }
            Call::StartSpindle(_) | Call::FloodOn => self.0.push("?".into()),
            _ => {}
        }
        Ok(())
    }
}

/// What a program does, and what is said about it.
fn run(program: &str) -> (Vec<String>, Vec<Diagnostic>) {
    let program = format!("G21 G18 G90 G94 F200\n{program}\nM2\n");
    let program = Program::from_text("part.ngc", program, &Options::default());
    let Driven { sink, mut errors, warnings, .. } = driven(program, Moves::default());
    errors.extend(warnings);
    (sink.0, errors)
}

fn good(program: &str) -> String {
    let (moves, said) = run(program);
    assert!(said.is_empty(), "{}", said[0].render(false));
    moves.join(", ")
}

fn error(program: &str) -> Diagnostic {
    let (_, mut said) = run(program);
    assert_eq!(said.len(), 1, "{said:?}");
    said.remove(0)
}

const STEP: &str = "o1 sub\nG0 X4\nG1 Z-8\nX10\no1 endsub\n";

#[test]
fn a_step_is_roughed_from_its_start() {
    let passes = good(&format!("{STEP}G71 Q1 X10 Z2 D0.5 I4 R1"));
    let expected = "R 10 2, R 10 2, R 10 2, F 10 -7.5, R 11 -6.5, R 11 1, R 10 2, R 6 2, F 6 -7.5, R 7 -6.5, R 7 1, \
                    R 6 2, R 4.5 2, F 4.5 -7.5, F 10 -7.5";
    assert_eq!(passes, expected);
}

#[test]
fn without_words_it_starts_where_the_tool_is_and_takes_the_defaults() {
    let [short, long] =
        ["G71 Q1", "G71 Q1 X10 Z2 D0 I1 R0.5"].map(|cycle| good(&format!("{STEP}G0 X10 Z2\n{cycle}")));
    assert_eq!(short, long);
}

#[test]
fn finishing_comes_nearer_pass_by_pass() {
    let passes = good(&format!("{STEP}G70 Q1 X10 Z2 D1.2 E0.2 P2"));
    let expected = "R 10 2, R 10 2, R 4.7 2, F 4.7 -7.3, F 10 -7.3, R 10 2, R 4.2 2, F 4.2 -7.8, F 10 -7.8";
    assert_eq!(passes, expected);
}

#[test]
fn facing_passes_run_along_x() {
    let passes = good("o1 sub\nG0 Z-4\nG1 X6\nZ0\nX2\no1 endsub\nG72 Q1 X10 Z2 D0 I3 R1");
    let expected = "R 10 2, R 10 2, R 10 2, F 2 2, R 3 3, R 9 3, R 10 2, R 10 -1, F 6 -1, R 7 0, R 9 0, R 10 -1, \
                    R 10 -4, F 6 -4, F 6 0, F 2 0, F 2 2";
    assert_eq!(passes, expected);
}

#[test]
fn finishing_a_face_keeps_to_the_side_of_the_tool() {
    let passes = good("o1 sub\nG0 Z-4\nG1 X6\nZ0\nX2\no1 endsub\nG70 Q1 X10 Z2 E0.5");
    assert!(passes.ends_with("R 10 -3.5, F 6.5 -3.5, F 6.5 0, A 6 0.5 c 6 0-1, F 2 0.5"), "{passes}");
}

/// A face that sinks in steps towards the middle, from there outwards: material beyond −Z and +X.
const DISH: &str =
    "o1 sub\nG0 X0 Z-10\no2 repeat [3]\nG1 X[#<_x>+5] Z[#<_z>+3]\nX[#<_x>+5]\no2 endrepeat\no1 endsub\n";

#[test]
fn finishing_from_the_middle_of_a_face_keeps_out_of_it() {
    // LinuxCNC's sample lathe_g7x_face_boring; 0.25 from the flats is Z-6.75, Z-3.75, Z-0.75
    let passes = good(&format!("{DISH}G70 Q1 X1 Z1 D0.5 P2"));
    let expected = "R 1 1, R 0 1, R -0.129 -9.786, F 4.871 -6.786, A 5 -6.75 c 5 -7+1, F 9.931 -6.75, F 14.871 -3.786, \
                    A 15 -3.75 c 15 -4+1, F 19.931 -3.75, F 24.871 -0.786, A 25 -0.75 c 25 -1+1, F 30 -0.75, R 0 1, \
                    R 0 -10, F 5 -7, F 10 -7, F 15 -4, F 20 -4, F 25 -1, F 30 -1";
    assert_eq!(passes, expected);
}

#[test]
fn finishing_keeps_its_distance_on_the_side_of_the_tool_however_the_part_is_turned() {
    let stairs = [(4.0, 2.0), (4.0, -8.0), (10.0, -8.0), (12.0, -12.0), (20.0, -12.0)];
    for (x, z, swap) in [1.0, -1.0]
        .into_iter()
        .flat_map(|x| [(x, 1.0), (x, -1.0)])
        .flat_map(|(x, z)| [(x, z, false), (x, z, true)])
    {
        let point = |(r, l): (f64, f64)| if swap { (z * l, x * r) } else { (x * r, z * l) };
        let contour: Vec<String> =
            stairs.into_iter().map(point).map(|(x, z)| format!("G1 X{x} Z{z}\n")).collect();
        for (start, side) in [((22.0, 4.0), 1.0), ((2.0, 4.0), -1.0)] {
            let (sx, sz) = point(start);
            let passes = good(&format!("o1 sub\n{}o1 endsub\nG70 Q1 X{sx} Z{sz} E0.5", contour.concat()));
            let begin = passes.split(", ").nth(2).unwrap_or_default().to_string();
            let (bx, bz) = point((4.0 + side * 0.5, 2.0));
            assert_eq!(begin, text('R', bx, bz), "{passes}");
            let end = passes.rsplit(", ").next().unwrap_or_default().to_string();
            let (ex, ez) = point((20.0, -12.0 + side * 0.5));
            assert_eq!(end, text('F', ex, ez), "{passes}");
        }
    }
}

#[test]
fn what_is_beyond_the_end_of_a_contour_gets_no_ring_of_the_allowance() {
    // the flat ends at Z-20, the allowance is on X alone there
    let open = good("o1 sub\nG0 X4\nG1 Z-20\no1 endsub\nG71 Q1 X10 Z2 D0.3 I4 R0");
    let expected = "R 10 2, R 10 2, R 10 2, F 10 -20, R 10 -20, R 10 2, R 10 2, R 6 2, F 6 -20, R 6 -20, R 6 2, R 6 2, \
                    R 4.3 2, F 4.3 -20, F 10 -20";
    assert_eq!(open, expected);
    // a taper: around its end up to Z-20
    let taper = good("o1 sub\nG0 X4 Z0\nG1 X8 Z-20\no1 endsub\nG71 Q1 X10 Z2 D0.5 I5 R0");
    assert!(taper.ends_with("F 8.49 -19.902, A 8.5 -20 c 8 -20+1, F 10 -20"), "{taper}");
    let face = good(&format!("{DISH}G72 Q1 X1 Z1 D0.5 I10 R0"));
    assert!(face.ends_with("F 30 -0.5, F 30 1"), "{face}");
}

#[test]
fn what_a_chamfer_leaves_of_a_line_is_not_a_move_if_it_is_rounding() {
    // 0.00005 of the face is left before the chamfer
    let passes = good("o1 sub\nG0 X4.49995 Z0\nG1 X5 C0.5\nZ-5\nX8\no1 endsub\nG70 Q1 X10 Z2");
    assert_eq!(passes, "R 10 2, R 10 2, R 4.5 0, F 5 -0.5, F 5 -5, F 8 -5");
}

#[test]
fn pockets_are_cut_bridged_or_cut_alone() {
    let pocket = "o1 sub\nG0 X8\nG1 Z-2\nX6\nZ-6\nX8\nZ-8\nX10\no1 endsub\n";
    let [whole, bridged, alone] =
        ["G71", "G71.1", "G71.2"].map(|code| good(&format!("{pocket}{code} Q1 X10 Z1 I5 R0")));
    assert!(whole.ends_with("R 8 1, F 8 -2, F 6 -2, F 6 -6, F 8 -6, F 8 -8, F 10 -8"), "{whole}");
    assert!(
        bridged.ends_with("R 8 1, F 8 1, F 8 -2, F 8 -6, F 8 -6, F 8 -6, F 8 -8, F 8 -8, F 10 -8"),
        "{bridged}"
    );
    let expected = "R 10 1, R 10 1, R 8 1, F 8 -2, F 8 -2, F 8 -6, R 8 -6, R 8 -2, F 8 -2, F 6 -2, F 6 -6, F 8 -6, \
                    F 8 -8, F 10 -8";
    assert_eq!(alone, expected);
}

#[test]
fn the_contour_can_be_written_in_many_ways() {
    let of = |contour: &str| good(&format!("o1 sub\n{contour}\no1 endsub\nG0 X20 Z2\nG70 Q1"));
    let plain = of("G0 X4 Z2\nG1 Z-8\nG2 X7 Z-11 I3 K0\nG1 X12");
    assert_eq!(plain, of("X4\nG1 Z-8\nG2 X7 Z-11 R3\nG1 X12"));
    assert_eq!(plain, of("G0 X4\nG1 W-10\nG2 U3 W-3 R3\nG1 U5"));
    assert_eq!(
        plain,
        of("#1=0\nG0 X4\no2 while [#1 lt 10]\nG1 W-10\n#1=[#1+10]\no2 endwhile\nG2 U3 W-3 R3\nG1 X12")
    );
    assert_eq!(plain, of("G0 X[2+2]\nG1 Z[#<_z>-13] A3\nX[#<_x>+8]"));
    assert_eq!(plain.replace("A 7 -11 c 7 -8-1", "F 7 -11"), of("G0 X4\nG1 Z-11 C3\nX12"));
}

#[test]
fn diameters_and_distances_mean_the_same() {
    let plain = good(&format!("G0 X10 Z2\n{STEP}G71 Q1 X11 Z3 I2"));
    let diameters = "G7\nG0 X20 Z2\no1 sub\nG0 X8\nG1 Z-8\nX20\no1 endsub\nG71 Q1 X22 Z3 I2";
    assert_eq!(plain, good(diameters));
    let distances = "G0 X10 Z2\nG91\no1 sub\nG0 X-7\nG1 Z-11\nX6\no1 endsub\nG71 Q1 X1 Z1 I2";
    assert_eq!(plain, good(distances));
}

#[test]
fn nothing_of_a_contour_is_executed_and_that_is_said() {
    let (moves, said) = run("o1 sub\nG0 X4\nG1 Z-8 F20 (text)\nM3 S100\nX10 M8\no1 endsub\nG70 Q1 X10 Z2");
    assert_eq!(moves.join(", "), "R 10 2, R 10 2, R 4 2, F 4 -8, F 10 -8");
    let lines: Vec<u32> = said.iter().map(|warning| warning.line).collect();
    assert_eq!(lines, [4, 5, 6]);
    assert!(said.iter().all(|warning| warning.code == "unused-word"));
}

#[test]
fn the_program_goes_on_at_the_end_of_the_contour() {
    let passes = good(&format!("{STEP}G70 Q1 X10 Z2\nX12\nG0 Z5"));
    assert!(passes.ends_with("F 10 -8, F 12 -8, R 12 5"), "{passes}");
}

#[test]
fn a_contour_that_begins_where_the_tool_is_has_a_way_to_it_of_no_length() {
    assert_eq!(good(&format!("{STEP}G0 X4 Z2\nG70 Q1")), "R 4 2, R 4 2, R 4 2, R 4 2, F 4 -8, F 10 -8");
}

#[test]
fn what_cannot_be_cut_is_refused_where_it_stands() {
    let cycle = |cycle: &str| error(&format!("{STEP}{cycle}"));
    for (block, code) in [
        ("G71 X10 Z2", "missing-word"),
        ("G71 Q2 X10 Z2", "no-subroutine"),
        ("G71 Q1.5 X10 Z2", "bad-value"),
        ("G71 Q1 X10 Z2 I0", "bad-value"),
        ("G71 Q1 X10 Z2 R-1", "bad-value"),
        ("G71 Q1 X10 Z2 D-1", "bad-value"),
        ("G70 Q1 X10 Z2 P0", "bad-value"),
        ("G70 Q1 X10 Z2 P1.5", "bad-value"),
        ("G17 G71 Q1 X10 Z2", "bad-value"),
        ("G93 G71 Q1 X10 Z2 F1", "bad-value"),
        ("G71 Q1 X10 Z2 U1", "not-available"),
        ("G42.1 D1 L3 G71 Q1 X10 Z2", "compensation-on"),
    ] {
        let said = if block.starts_with("G42") {
            error(&format!("{STEP}G42.1 D1 L3\nG71 Q1 X10 Z2\nG40 G0 X20"))
        } else {
            cycle(block)
        };
        assert_eq!(said.code, code, "{block}: {}", said.headline());
    }
}

#[test]
fn contours_that_are_none_are_refused() {
    let of = |contour: &str| error(&format!("o1 sub\n{contour}\no1 endsub\nG71 Q1 X20 Z2 D0.5"));
    for (contour, code, line) in [
        ("G0 X4", "bad-contour", 5),
        ("G0 X4\nG1 Z-8\nX8\nZ-6\nX10", "bad-contour", 9),
        ("G0 X4\nG1 Z-8 A9\nX10", "bad-contour", 7),
        ("G0 X4\nG1 Z-8 A1 C1\nX10", "bad-value", 4),
        ("G0 X4\nG1 Z-8 A-1\nX10", "bad-value", 4),
        ("G0 X4\nG1 Z-8\nX10 A1", "bad-contour", 7),
        ("G0 X4\nG2 X8 Z-4", "missing-word", 4),
        ("G0 X4\nG2 X8 Z-4 R1", "arc-radius", 4),
        ("G0 X4\nG2 X8 Z-4 I3 K0", "arc-radius", 4),
        ("G0 X4\nG1 X5 U1", "bad-value", 4),
        ("G0 X4\nG81 X5 Z3 R2", "not-available", 4),
    ] {
        let said = of(contour);
        assert_eq!((said.code, said.line), (code, line), "{contour}: {}", said.headline());
    }
}
