//! A mill: moves in all axes, arcs and helices in every plane, cycles, offsets, and what only a lathe does.

use gcode::Program;
use gcode::files::ToolTable;
use interpreter::{Check, Language, check, check_program, open};
use machine::{Kinematics, Machine};
use protocol::{Arc, Axis, Code, Feed, PathMode, Plane, Position};

use crate::project;

/// The built-in mill.
fn example() -> Machine {
    Machine::from_toml(Kinematics::Mill.example()).expect("the built-in mill")
}

/// The same with travels and homes that these tests count on.
pub(crate) fn mill() -> Machine {
    let mut machine = example();
    let x = (Axis::X, [-200.0, 200.0], 0.0);
    for (axis, travel, home) in [x, (Axis::Y, [-150.0, 150.0], 0.0), (Axis::Z, [-250.0, 0.0], -50.0)] {
        let config = machine.axis.get_mut(&axis).expect("a mill has X, Y and Z");
        (config.travel_mm, config.home_mm) = (travel, home);
    }
    machine
}

/// The mill with a rotary axis C of one turn either way.
pub(crate) fn mill_with_c() -> Machine {
    let mut machine = mill();
    let mut c = machine.axis[&Axis::X].clone();
    (c.travel_mm, c.home_mm) = ([-360.0, 360.0], 0.0);
    machine.axis.insert(Axis::C, c);
    machine.check().expect("a mill may have C");
    machine
}

pub(crate) fn good_on(machine: &Machine, source: &str) -> Check {
    let check = check("test.ngc", source, machine);
    let said: String = check.diagnostics.iter().map(|diagnostic| diagnostic.render(false)).collect();
    assert!(check.is_good(), "{said}");
    check
}

fn errors(machine: &Machine, source: &str) -> Vec<(u32, &'static str)> {
    check("test.ngc", source, machine).diagnostics.iter().map(|error| (error.line, error.code)).collect()
}

/// Ends of the moves: X, Y, Z, A, B, C.
fn ends(check: &Check) -> Vec<[f64; 6]> {
    let end = |code: &Code| match code {
        Code::Line { target, .. } | Code::Arc { arc: Arc { target, .. }, .. } => Some(*target),
        _ => None,
    };
    let point = |target: [Position; 8]| std::array::from_fn(|axis| target[axis].mm());
    check.items.iter().filter_map(|item| end(&item.code)).map(point).collect()
}

fn arcs(check: &Check) -> Vec<Arc> {
    check
        .items
        .iter()
        .filter_map(|item| if let Code::Arc { arc, .. } = item.code { Some(arc) } else { None })
        .collect()
}

fn feeds(check: &Check) -> Vec<Feed> {
    let feed = |code: &Code| match code {
        Code::Line { feed, .. } | Code::Arc { feed, .. } => Some(*feed),
        _ => None,
    };
    check.items.iter().filter_map(|item| feed(&item.code)).collect()
}

#[test]
fn every_axis_moves_and_x_is_no_diameter() {
    let check = good_on(&mill(), "G0 X20 Y-10\nG1 Z-60 F200\nX-20 Y10 Z-55\nM2\n");
    let expected = [
        [20.0, -10.0, -50.0, 0.0, 0.0, 0.0],
        [20.0, -10.0, -60.0, 0.0, 0.0, 0.0],
        [-20.0, 10.0, -55.0, 0.0, 0.0, 0.0],
    ];
    assert_eq!(ends(&check), expected);
}

#[test]
fn arcs_and_helices_lie_in_their_plane() {
    let text = "F300\nG0 X10 Y0 Z-50\nG17 G3 X0 Y10 I-10\nG18 G2 X10 Z-60 I0 K-10\nG19 G2 Y20 Z-50 J0 K10\n\
                G17 G3 X10 Y20 Z-54 I5 J0 P3\nM2\n";
    let arcs = arcs(&good_on(&mill(), text));
    let planes: Vec<Plane> = arcs.iter().map(|arc| arc.plane).collect();
    assert_eq!(planes, [Plane::Xy, Plane::Zx, Plane::Yz, Plane::Xy]);
    let centers: Vec<[f64; 2]> = arcs.iter().map(|arc| arc.center.map(Position::mm)).collect();
    assert_eq!(centers, [[0.0, 0.0], [-60.0, 0.0], [10.0, -50.0], [15.0, 20.0]]);
    let turns: Vec<i32> = arcs.iter().map(|arc| arc.turns).collect();
    assert_eq!(turns, [1, -1, -1, 3]);
    assert_eq!(arcs[3].target[Axis::Z.index()], Position::from_mm(-54.0), "a helix");
}

#[test]
fn the_whole_arc_lies_within_the_travel() {
    // X 200 is the end of the travel; the quadrant of the arc lies beyond it, its ends do not.
    let text = |plane: &str, arc: &str| format!("F300 S500 M3\n{plane}\n{arc}\nM2\n");
    let xy = text("G17 G0 X195 Y0", "G3 X195 Y10 I0 J5");
    assert_eq!(errors(&mill(), &xy), []);
    let xy = text("G17 G0 X195 Y0", "G3 X195 Y12 I0 J6");
    assert_eq!(errors(&mill(), &xy), [(3, "travel-limit")]);
    let yz = text("G19 G0 Y10 Z-1", "G2 Y14 Z-1 J2 K0 (over Z 1)");
    assert_eq!(errors(&mill(), &yz), [(3, "travel-limit")]);
    let zx = text("G18 G0 X0 Z-4", "G3 X4 Z-4 I2 K0");
    assert_eq!(errors(&mill(), &zx), []);
    let helix = text("G17 G0 X10 Y0 Z-4", "G3 X10 Y0 Z1 I-10 P5");
    assert_eq!(errors(&mill(), &helix), [(3, "travel-limit")]);
}

#[test]
fn rotary_axes_move_with_the_others_and_alone_by_degrees() {
    let check = good_on(&mill_with_c(), "G20\nF10 G1 X1 C90\nC180\nG2 X1 Y0 I-1 C0\nM2\n");
    let c: Vec<f64> = ends(&check).iter().map(|end| end[5]).collect();
    assert_eq!(c, [90.0, 180.0, 0.0]);
    let expected = [254.0, 10.0, 254.0].map(Feed::PerMinute);
    assert_eq!(feeds(&check), expected, "in/min become mm/min, degrees/min stay");
    assert_eq!(errors(&mill(), "G0 C90\nM2\n"), [(1, "no-such-axis")]);
    assert_eq!(errors(&mill_with_c(), "G0 C400\nM2\n"), [(1, "travel-limit")]);
}

#[test]
fn drilling_cycles_go_along_z() {
    for cycle in
        ["G81 R-50", "G82 R-50 P0.1", "G83 R-50 Q2", "G73 R-50 Q2", "G85 R-50", "G86 R-50 P0", "G89 R-50 P0"]
    {
        let check =
            good_on(&mill(), &format!("S1000 M3 F100\nG0 Z-45\n{cycle} X10 Y20 Z-60\nX20\nG80\nM2\n"));
        let ends = ends(&check);
        for x in [10.0, 20.0] {
            assert!(ends.contains(&[x, 20.0, -60.0, 0.0, 0.0, 0.0]), "{cycle} at X{x}");
        }
    }
}

#[test]
fn lengths_offsets_and_rotation_shift_the_program() {
    let text = "G10 L2 P1 X10 Y20 Z-30\nG54 G0 X1 Y2 Z-20\nG92 X0 Y0\nG0 X5 Y5\nG92.1\nG10 L2 P1 R90\nG0 X5 Y0\n\
                F100\nG1 X10\nG3 X0 Y10 I-10\nM2\n";
    let check = good_on(&mill(), text);
    let near = |one: &[f64; 6], other: [f64; 3]| one.iter().zip(other).all(|(a, b)| (a - b).abs() < 1e-8);
    let expected = [
        [11.0, 22.0, -50.0],
        [16.0, 27.0, -50.0],
        [10.0, 25.0, -50.0],
        [10.0, 30.0, -50.0],
        [0.0, 20.0, -50.0],
    ];
    for (end, expected) in ends(&check).iter().zip(expected) {
        assert!(near(end, expected), "{end:?}, not {expected:?}");
    }
    let center = arcs(&check)[0].center.map(Position::mm);
    assert!((center[0] - 10.0).abs() < 1e-8 && (center[1] - 20.0).abs() < 1e-8, "{center:?}");
    let across = "G10 L2 P1 R30\nF100\nG0 X0 Y0 Z-50\nG18 G2 X10 Z-50 I5 K0\nM2\n";
    assert_eq!(errors(&mill(), across), [(4, "not-available")]);

    let table = ToolTable::parse("tools", "T1 P1 Z40\n").expect("a table");
    let options =
        gcode::Options { tools: table, position: [0.0, 0.0, -50.0, 0.0, 0.0, 0.0], ..Default::default() };
    let program = Program::from_text("o", "T1 M6 G43\nG0 Z-100\nM2\n", &options);
    let mut items = Vec::new();
    let check = check_program(program, &mill(), |item| items.push(item));
    assert!(check.is_good());
    let check = Check { items, ..check };
    assert_eq!(ends(&check).last().map(|end| end[2]), Some(-60.0));
}

#[test]
fn threads_need_a_lathe() {
    for thread in ["G33 Z-60 K1", "G76 P1 Z-60 I-1 J0.1 K0.5"] {
        let check = check("test.ngc", &format!("G18 S500 M3\n{thread}\nM2\n"), &mill());
        let errors: Vec<_> =
            check.diagnostics.iter().filter(|one| one.severity == interpreter::Severity::Error).collect();
        assert_eq!(errors.len(), 1, "{thread}: {errors:?}");
        assert_eq!((errors[0].line, errors[0].code), (2, "not-available"), "{thread}");
    }
}

#[test]
fn the_jobs_of_the_conformance_set_run_on_the_mill() {
    let job = |name: &str, machine: &Machine| {
        let path = project().join("tests/conformance/programs").join(name);
        let tools = Some(project().join("tests/conformance/tool.tbl"));
        let language = Language { tools, ..Language::default() };
        check_program(open(&path, &language, machine).expect("it is there"), machine, |_| ())
    };
    let pocket = job("job_mill_pocket_helix.ngc", &example());
    let said: String = pocket.diagnostics.iter().map(|one| one.render(false)).collect();
    assert!(pocket.is_good(), "{said}");
    assert!(pocket.moves > 20 && pocket.time_s > 10.0, "{} moves, {} s", pocket.moves, pocket.time_s);

    // The plate was written for a larger mill, and taps with a spindle that this one does not have.
    let mut larger = example();
    for config in larger.axis.values_mut() {
        config.travel_mm = [-500.0, 500.0];
    }
    let plate = job("job_mill_plate.ngc", &larger);
    let errors: Vec<&str> = plate.diagnostics.iter().map(|one| one.message.as_str()).collect();
    assert!(errors.iter().all(|message| message.starts_with("rigid tapping (G33.1)")), "{errors:?}");
    assert!(plate.moves > 50);
}

#[test]
fn path_modes_are_sent_before_the_move_they_are_for() {
    let text = "F100\nG1 X1\nG64 P0.02\nG61\nG64 P0.05 Q0.01\nX2\nG61.1\nX3\nG64\nM5\nX4\nG20 G64 P0.001\nX0.2\nM2\n";
    let check = good_on(&mill(), text);
    let modes: Vec<(u32, PathMode)> = check
        .items
        .iter()
        .filter_map(|item| if let Code::PathMode(mode) = item.code { Some((item.line, mode)) } else { None })
        .collect();
    let blend = |tolerance_mm, merge_mm| PathMode::Blend { tolerance_mm, merge_mm };
    let expected = [
        (6, blend(0.05, 0.01)),
        (8, PathMode::ExactStop),
        (11, PathMode::within(0.01)),
        (13, PathMode::within(0.025_4)),
    ];
    assert_eq!(modes, expected);
    assert_eq!(errors(&mill(), "G64 P11\nM2\n"), [(1, "bad-value")]);
    assert_eq!(errors(&mill(), "G64 P0.1 Q11\nM2\n"), [(1, "bad-value")]);
}

#[test]
fn a_spline_becomes_arcs_that_touch_and_keep_to_it() {
    let text = "G17 G21 F600 S4000 M3\nG0 X-20 Y40 Z-10\nG5.1 X20 I20 J-80\nM2\n";
    let check = good_on(&mill(), text);
    let arcs = arcs(&check);
    assert!((20..400).contains(&arcs.len()), "{} arcs", arcs.len());
    let mut at = [-20.0, 40.0];
    let mut before: Option<[f64; 2]> = None;
    for arc in &arcs {
        // the parabola through the origin: y is x²/10
        let center = [arc.center[0].mm(), arc.center[1].mm()];
        let end = [arc.target[0].mm(), arc.target[1].mm()];
        assert!((end[1] - end[0] * end[0] / 10.0).abs() < 1e-3, "{end:?}");
        let radius = libm::hypot(at[0] - center[0], at[1] - center[1]);
        let tangent = |at: [f64; 2]| [-(at[1] - center[1]) / radius, (at[0] - center[0]) / radius];
        let (begin, finish) = (tangent(at), tangent(end));
        if let Some(before) = before {
            let turn = before[0] * begin[1] - before[1] * begin[0];
            assert!(turn.abs() < 1e-6, "arcs turn by {turn} where they meet");
        }
        (at, before) = (end, Some(finish));
    }
    assert_eq!(at, [20.0, 40.0]);
}

#[test]
fn a_spline_takes_no_longer_than_an_arc_of_its_length() {
    let time = |curve: &str| {
        let text = format!("G17 G21 G61 F3000 S4000 M3\nG0 X40 Y0 Z-10\n{curve}\nM2\n");
        good_on(&mill(), &text).time_s
    };
    let arc = time("G3 X0 Y40 I-40");
    let curve = time("G5.2 P1 L3\nX40 Y40 P0.707106781\nX0 Y40\nG5.3");
    assert!((curve / arc - 1.0).abs() < 0.01, "{curve} s, and {arc} s for the arc");
    let knotted =
        time("G6.2 P3 Q1 X40 Y0 R1 K0\nX40 Y40 R0.707106781 K0\nX0 Y40 R1 K0\nG6.2 K3\nG6.2 K3\nG6.2 K3");
    assert!((knotted / curve - 1.0).abs() < 1e-6, "the same curve: {knotted} s, and {curve} s by G5.2");
    // one whose curvature changes all the time
    let wavy = time("G5 X0 Y40 I0 J25 P30 Q5");
    assert!(wavy < 1.1 * arc, "{wavy} s, and {arc} s for the arc");
}

#[test]
fn a_spline_beyond_the_travel_is_refused_once() {
    let text = "G17 F300 S500 M3\nG0 X190 Y0\nG5.1 X190 Y40 I30 J20\nM2\n";
    assert_eq!(errors(&mill(), text), [(3, "travel-limit")]);
}

/// G84 and G74 of LinuxCNC feed a floating holder. Here they are the rigid tap that goes to the same place,
/// in either mode of feed, at every hole, and that is told.
#[test]
fn a_tap_for_a_floating_holder_is_a_rigid_one() {
    let of = |taps: &str| {
        let program = format!("T1 M6\n{taps}M2\n");
        let found = check("test.ngc", &program, &mill());
        let codes: Vec<_> = found.diagnostics.iter().map(|one| (one.line, one.code)).collect();
        let leads: Vec<_> = crate::passes(&found.items)
            .iter()
            .map(|pass| (pass.axis(Axis::Z).lead_mm, pass.axis(Axis::Z).start.mm(), pass.direction))
            .collect();
        (codes, leads)
    };
    let rigid = of("S500 M3\nG0 X1 Y1 Z-5\nG0 Z-8\nG33.1 Z-15 K1.25\nG0 X6\nG33.1 Z-15 K1.25\n");
    let (codes, leads) = of("S500 M3\nG0 X1 Y1 Z-5\nF625 G84 X1 Y1 Z-15 R-8\nG99 X6\nG80\n");
    assert_eq!((codes, &leads), (vec![(4, "rigid-tap"), (5, "rigid-tap")], &rigid.1));
    let (codes, leads) = of("S500 M4\nG0 X1 Y1 Z-5\nG95 F1.25 G99 G74 X1 Y1 Z-15 R-8\nG80\n");
    assert_eq!((codes, leads.len(), leads[0].0, leads[0].2), (vec![(4, "rigid-tap")], 1, -1.25, -1.0));
    assert_eq!(of("S500\nG0 X1 Y1 Z-5\nF625 G84 X1 Y1 Z-15 R-8\n").0, [(4, "spindle-not-turning")]);
}
