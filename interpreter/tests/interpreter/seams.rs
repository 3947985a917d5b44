//! Seams as jobs on the built-in positioner: what becomes of them, and what is said of bad ones.

#![allow(clippy::unwrap_used)]

use interpreter::{Check, check, check_job};
use machine::{Machine, POSITIONER, POSITIONER_AXES};
use proptest::prelude::*;
use protocol::{Axis, Code, Position, Shape, Work};
use route::positioner::{drives, geometry};
use shape::{Curve, Formula, Positioner, Seam, SeamCurve};

fn machine() -> Machine {
    Machine::from_toml(POSITIONER).unwrap()
}

fn said(check: &Check) -> String {
    check.diagnostics.iter().map(|diagnostic| diagnostic.render(false)).collect()
}

fn good(text: &str) -> Check {
    let check = check_job("seam.toml", text, &machine());
    assert!(check.diagnostics.is_empty(), "{}", said(&check));
    check
}

fn seams(check: &Check) -> Vec<Seam> {
    let seam = |code: &Code| match code {
        Code::Work(Work { shape: Shape::Seam(seam), .. }) => Some(*seam),
        _ => None,
    };
    check.items.iter().filter_map(|item| seam(&item.code)).collect()
}

fn formulas(check: &Check) -> Vec<Formula> {
    let formula = |code: &Code| if let Code::Formula { formula, .. } = code { Some(*formula) } else { None };
    check.items.iter().filter_map(|item| formula(&item.code)).collect()
}

/// Where the axes are when the first trace begins: the target of the line before.
fn start(check: &Check) -> [f64; 4] {
    let target = check.items.iter().find_map(|item| match item.code {
        Code::Line { target, .. } => Some(target),
        _ => None,
    });
    POSITIONER_AXES.map(|axis| target.unwrap()[axis.index()].mm())
}

/// Every seam begins where the axes are, and has point and direction under the beam.
fn holds(check: &Check) -> usize {
    let (machine, formulas, all) = (machine(), formulas(check), seams(check));
    let positioner = machine.positioner.unwrap();
    let mut here = start(check);
    for seam in &all {
        let path = seam.on(&formulas, geometry(&positioner), positioner.beam_mm);
        let from = path.near(seam.t[0], &here).axes.map(|axis| axis.value());
        assert!(from.iter().zip(here).all(|(a, b)| (a - b).abs() < 1e-8), "{from:?} {here:?}");
        here = from;
        for step in 0..=200 {
            let t = seam.t[0] + (seam.t[1] - seam.t[0]) * f64::from(step) / 200.0;
            let next = path.near(t, &here).axes.map(|axis| axis.value());
            assert!((next[3] - here[3]).abs() < 20.0, "{t}: {here:?} {next:?}");
            here = next;
            let [point, direction] = path.place(t).map(|vector| vector.map(|c| c.value()));
            let mut axes = protocol::PerAxis::default();
            POSITIONER_AXES.iter().zip(here).for_each(|(axis, at)| axes[axis.index()] = at);
            let drives = drives(&axes);
            let [x, y, _] = geometry(&positioner).forward(point, &drives);
            let [beam_x, beam_y] = positioner.beam_mm;
            assert!((x - beam_x).abs() < 1e-9 && (y - beam_y).abs() < 1e-9);
            let l = Positioner::turned(direction, &drives);
            assert!(l[0].abs() < 1e-9 && l[1].abs() < 1e-9 && l[2] > 0.0);
        }
    }
    let end: Vec<Position> = here.iter().map(|at| Position::from_mm(*at)).collect();
    assert!(end.iter().zip(POSITIONER_AXES).all(|(at, axis)| {
        let [low, high] = machine.axis[&axis].travel_mm;
        (low..=high).contains(&at.mm())
    }));
    all.len()
}

const CYLINDERS: &str = include_str!("../../../examples/positioner/cylinders.toml");
const POINTS: &str = include_str!("../../../examples/positioner/points.toml");
const WAVE: &str = include_str!("../../../examples/positioner/wave.toml");

#[test]
fn the_shipped_jobs_become_traces() {
    let check = good(CYLINDERS);
    assert_eq!((holds(&check), formulas(&check).len()), (1, 0));
    let [Seam { curve: SeamCurve::Meeting(meeting), .. }] = seams(&check)[..] else { panic!("a meeting") };
    assert_eq!((meeting.first.radius_mm, meeting.second.c[0], meeting.share), (20.0, -900.0, 0.5));
    assert_eq!((holds(&good(POINTS)), holds(&good(WAVE))), (5, 1));
    assert_eq!(formulas(&good(WAVE)).len(), 6);
    let facts = &good(CYLINDERS).jobs[0].facts;
    let fact = |name: &str| &facts.iter().find(|(key, _)| *key == name).unwrap().1;
    assert_eq!(fact("seam"), "cylinder Ø40 meets cylinder Ø60, 0 to 370 deg");
    assert!(fact("A").starts_with("-65.9"), "{facts:?}");
}

/// Where pieces through points meet, the axes have equal derivatives by the way of the beam up to the third.
#[test]
fn pieces_through_points_join_smoothly() {
    let (check, positioner) = (good(POINTS), machine().positioner.unwrap());
    let all = seams(&check);
    let by_way = |seam: &Seam, t: f64| {
        let point = seam.on(&[], geometry(&positioner), positioner.beam_mm).at(t);
        let onwards = shape::length(&point.tip).reversed();
        point.axes.map(|axis| axis.of(onwards))
    };
    for pair in all.windows(2) {
        let (before, behind) = (by_way(&pair[0], 1.0), by_way(&pair[1], 0.0));
        for (a, b) in before.iter().zip(&behind) {
            for n in 0..4 {
                let (a, b) = (a.derivative(n), b.derivative(n));
                assert!((a - b).abs() < 1e-9 * (1.0 + a.abs()), "derivative {n}: {a} {b}");
            }
        }
    }
    let [first, .., last] = &all[..] else { panic!("pieces") };
    let bend = |seam: &Seam, t: f64| {
        let SeamCurve::Polynomials(c) = seam.curve else { panic!("polynomials") };
        c.map(|c| 6.0 * c[3] + 24.0 * c[4] * t + 60.0 * c[5] * t * t)
    };
    assert!(bend(first, 0.0).iter().chain(&bend(last, 1.0)).all(|third| third.abs() < 1e-9), "natural ends");
}

/// Of both solutions that whose angles are nearest; a branch that is asked for; C by the turn nearest to
/// where it stands.
#[test]
fn the_solution_is_that_which_is_nearest() {
    let placed = |a: f64, c: f64, job: &str| {
        let lines: String = job
            .lines()
            .filter(|line| !line.starts_with("name") && !line.starts_with('['))
            .map(|line| format!(";@ {line}\n"))
            .collect();
        let check = check("seam.ngc", &format!("G0 A{a} C{c}\n{lines}M2\n"), &machine());
        assert!(check.diagnostics.is_empty(), "{}", said(&check));
        let lines: Vec<_> = check
            .items
            .iter()
            .filter_map(|item| match item.code {
                Code::Line { target, .. } => Some(target),
                _ => None,
            })
            .collect();
        POSITIONER_AXES.map(|axis| lines.last().unwrap()[axis.index()].mm())
    };
    let near = |[_, _, a, c]: [f64; 4], want: [f64; 2]| {
        assert!((a - want[0]).abs() < 1e-9 && (c - want[1]).abs() < 1e-9, "{a} {c}");
    };
    near(placed(0.0, 60.0, CYLINDERS), [45.0, 90.0]);
    near(placed(30.0, -90.0, CYLINDERS), [-45.0, -90.0]);
    near(placed(-30.0, 100.0, CYLINDERS), [45.0, 90.0]);
    near(placed(-45.0, 300.0, &format!("{CYLINDERS}branch = \"negative\"")), [-45.0, 270.0]);
    near(placed(-45.0, 80.0, &format!("{CYLINDERS}branch = \"positive\"")), [45.0, 90.0]);
}

/// C may turn from −720 to 720: a seam of a whole turn that would begin too near to the end is taken a turn
/// back.
#[test]
fn the_turn_leaves_room_for_the_whole_seam() {
    let mut machine = machine();
    machine.axis.get_mut(&Axis::C).unwrap().travel_mm = [-300.0, 380.0];
    let check = check_job("seam.toml", CYLINDERS, &machine);
    assert!(check.diagnostics.is_empty(), "{}", said(&check));
    let [.., c] = start(&check);
    assert!(c >= -300.0 && c + 370.0 <= 380.0, "{c}");
    machine.axis.get_mut(&Axis::C).unwrap().travel_mm = [-180.0, 180.0];
    let refused = said(&check_job("seam.toml", CYLINDERS, &machine));
    assert!(refused.contains("the seam takes C from") && refused.contains("axis.c.travel_deg"), "{refused}");
    let mut flat = machine;
    flat.axis.get_mut(&Axis::A).unwrap().travel_mm = [-60.0, 60.0];
    flat.axis.get_mut(&Axis::C).unwrap().travel_mm = [-720.0, 720.0];
    let refused = said(&check_job("seam.toml", CYLINDERS, &flat));
    assert!(
        refused.contains("takes A from -65.9") && refused.contains("axis.a.travel_deg is [-60, 60]"),
        "{refused}"
    );
}

const CURVE: &str = "kind = \"seam\"\nfeed_mm_min = 600\nt = [-1, 1]\n";

#[test]
fn what_is_no_seam_is_refused_with_its_place() {
    for (text, message) in [
        ("kind = \"seam\"\nfeed_mm_min = 600", "one of three ways"),
        (&format!("{CYLINDERS}x = \"t\""), "one of three ways"),
        (&CYLINDERS.replace("diameter_mm = 40.0", "diameter_mm = 70.0"), "the seam bends too sharply at 5"),
        (&CYLINDERS.replace("diameter_mm = 40.0", "diameter_mm = -1"), "first.diameter_mm = -1"),
        (&CYLINDERS.replace("diameter_mm = 40.0", "half_angle_deg = 5"), "first.diameter_mm is missing"),
        (&CYLINDERS.replace(", diameter_mm = 60.0", ""), "second.diameter_mm is missing"),
        (&CYLINDERS.replace("axis = [1.0, 0.0, 0.0]", "axis = [0, 0, 0]"), "length 0"),
        (&CYLINDERS.replace("first = { kind = \"cylinder\"", "first = { kind = \"torus\""), "torus"),
        (&CYLINDERS.replace("share = 0.5", "share = 1.5"), "share = 1.5"),
        (&CYLINDERS.replace("share = 0.5", "part = 0.5"), "docs/positioner.md lists the others"),
        (&CYLINDERS.replace("share = 0.5", "share = \"half\""), "docs/positioner.md lists the keys"),
        (&CYLINDERS.replace("share = 0.5", "zero = [0, 0, 2]"), "zero points along the axis"),
        ("kind = \"seam\"\nfeed_mm_min = 600\npoints = [[0, 0, 0, 0, 1, 1]]", "a seam cannot have 1 points"),
        (
            "kind = \"seam\"\nfeed_mm_min = 600\npoints = [[0, 0, 0, 0, 1, 1], [5, 0, 0, 0, 0, 0]]",
            "point 2 has no place or no direction",
        ),
        (
            "kind = \"seam\"\nfeed_mm_min = 600\npoints = [[0, 0, 0, 0, 1, 1], [0, 0, 0, 0, 1, 1]]",
            "points 1 and 2 are one",
        ),
        (
            &format!("{CURVE}x = \"20*t\"\ny = \"0\"\nz = \"9\"\ndirection = [\"(t+1)^2\", \"0\", \"1\"]"),
            "the direction stands still in that of the turn axis at t = -1",
        ),
        (
            &format!("{CURVE}x = \"20*t\"\ny = \"0\"\nz = \"9\"\ndirection = [\"t\", \"1e-7\", \"1\"]"),
            "the direction is",
        ),
        (
            &format!("{CURVE}x = \"20*t\"\ny = \"0\"\nz = \"9\"\ndirection = [\"t\", \"t\", \"t\"]"),
            "its direction nowhere 0",
        ),
        (
            &format!("{CURVE}x = \"20*ln(t)\"\ny = \"0\"\nz = \"9\"\ndirection = [\"t\", \"1\", \"1\"]"),
            "there is no seam at t = -1",
        ),
        (
            &format!("{CURVE}x = \"3\"\ny = \"0\"\nz = \"9\"\ndirection = [\"t\", \"1\", \"1\"]"),
            "the seam stands still at t = -1",
        ),
        (&format!("{CURVE}x = \"20*t\"\ny = \"0\"\nz = \"9\""), "direction is missing"),
        (
            &format!("{CURVE}x = \"200*t\"\ny = \"0\"\nz = \"9\"\ndirection = [\"0\", \"1\", \"1\"]"),
            "mm at t = ",
        ),
        // What would take seconds to look at to its end.
        (
            &format!("{CURVE}x = \"1e9*t\"\ny = \"0\"\nz = \"9\"\ndirection = [\"0\", \"1\", \"1\"]"),
            "the seam takes X from",
        ),
    ] {
        let check = check_job("seam.toml", text, &machine());
        assert!(!check.is_good() && said(&check).contains(message), "{text}\n{}", said(&check));
        assert!(seams(&check).is_empty());
    }
    let check = check_job("seam.toml", CYLINDERS, &Machine::plain());
    assert!(said(&check).contains("a seam needs a positioner"), "{}", said(&check));
}

/// Straight through the direction of the turn axis A goes on and C stands, inside a seam, at its start, at
/// its end, in a point and between points; and the other solution can be asked for.
#[test]
fn a_direction_may_go_through_that_of_the_turn_axis() {
    let line = |t: &str, branch: &str| {
        format!(
            "kind = \"seam\"\nfeed_mm_min = 600\nt = {t}\nx = \"t\"\ny = \"0\"\nz = \"20\"\n\
             direction = [\"0.02*t\", \"0\", \"1\"]\n{branch}"
        )
    };
    let points = |rows: &[f64]| {
        let row = |x: &f64| format!("[{x}, 0, 20, {}, {}, 1]", 0.012 * x, 0.016 * x);
        let rows: Vec<String> = rows.iter().map(row).collect();
        format!("kind = \"seam\"\nfeed_mm_min = 600\npoints = [{}]", rows.join(", "))
    };
    let lean = |x: f64| (0.02 * x).atan().to_degrees();
    for (text, ends, seams) in [
        (line("[-20, 20]", ""), [-20.0, 20.0], 1),
        (line("[0, 20]", ""), [0.0, -20.0], 1),
        (line("[-20, 0]", ""), [-20.0, 0.0], 1),
        (line("[-20, 20]", "branch = \"positive\""), [20.0, -20.0], 1),
        (line("[0, 20]", "branch = \"positive\""), [0.0, 20.0], 1),
        (points(&[-20.0, -10.0, 0.0, 10.0, 20.0]), [-20.0, 20.0], 4),
        (points(&[-20.0, -3.0, 4.0, 20.0]), [-20.0, 20.0], 3),
        (points(&[0.0, 7.0, 20.0]), [0.0, -20.0], 2),
    ] {
        let check = good(&text);
        assert_eq!(holds(&check), seams, "{text}");
        let [a, b] = ends.map(lean);
        let facts = &check.jobs[0].facts;
        let fact = |name: &str| facts.iter().find(|(key, _)| *key == name).unwrap().1.as_str();
        assert_eq!(fact("A"), format!("{:.3} to {:.3} deg", a.min(b), a.max(b)), "{text}");
        let (from, to) = fact("C").trim_end_matches(" deg").split_once(" to ").unwrap();
        assert_eq!(from, to, "{text}");
    }
}

/// Near the direction of the turn axis C turns fast: it is said where, and what is left of the feed.
#[test]
fn a_feed_that_the_turn_cannot_keep_is_said() {
    let text = format!("{CURVE}x = \"20*t\"\ny = \"0\"\nz = \"9\"\ndirection = [\"t\", \"0.05\", \"1\"]");
    let check = check_job("seam.toml", &text, &machine());
    assert!(
        check.is_good() && said(&check).contains("C turns so fast that the feed falls to"),
        "{}",
        said(&check)
    );
    let text = text.replace("0.05", "0.00005");
    let check = check_job("seam.toml", &text, &machine());
    assert!(!check.is_good(), "{}", said(&check));
}

/// An upright direction all along is no singular place: C stands, X and Y make the seam.
#[test]
fn an_upright_seam_keeps_c_where_it_stands() {
    let job = ";@ kind = \"seam\"\n;@ x = \"20*cos(t)\"\n;@ y = \"20*sin(t)\"\n;@ z = \"9\"\n;@ direction = [\"0\", \"0\", \"1\"]\n;@ t = [0, 3]\n;@ feed_mm_min = 300\n";
    let check = check("seam.ngc", &format!("G0 C37.5\n{job}M2\n"), &machine());
    assert!(check.diagnostics.is_empty(), "{}", said(&check));
    let [seam] = seams(&check)[..] else { panic!("one seam") };
    assert_eq!(seam.idle_beta_deg, 37.5);
}

/// G-code moves the axes by name; a spindle it has none.
#[test]
fn words_of_g_code_are_axis_positions() {
    let check_of = |text: &str| check("part.ngc", text, &machine());
    let good = check_of("G21 G90 G94\nG0 X10 Y-5 A20 C-300\nG1 C-90 F1200\nG1 X0 Y0 F600\nM2\n");
    assert!(good.diagnostics.is_empty(), "{}", said(&good));
    let lines: Vec<_> = good
        .items
        .iter()
        .filter_map(|item| match item.code {
            Code::Line { target, .. } => Some(POSITIONER_AXES.map(|axis| target[axis.index()].mm())),
            _ => None,
        })
        .collect();
    assert_eq!(lines, [[10.0, -5.0, 20.0, -300.0], [10.0, -5.0, 20.0, -90.0], [0.0, 0.0, 20.0, -90.0]]);
    for (text, message) in [
        ("M3 S100\nM2", "beam positioner has no spindle"),
        ("S100\nM2", "S: beam positioner has no spindle"),
        ("M4\nM2", "M4: beam positioner has no spindle"),
        ("G96 D500 S100\nM2", "has no spindle"),
        ("G95 G1 X1 F0.1\nM2", "feed per revolution: beam positioner has no spindle"),
        ("G0 Z1\nM2", "this positioner has no axis Z"),
        ("G0 B1\nM2", "this positioner has no axis B"),
        ("G0 A111\nM2", "axis.a.travel_deg"),
        ("G33 X1 K1\nM2", "G33 follows the spindle"),
    ] {
        let check = check_of(text);
        assert!(!check.is_good() && said(&check).contains(message), "{text}: {}", said(&check));
    }
    assert!(check_of("M5\nG0 X1\nM30\n").diagnostics.is_empty());
}

/// Every fence `toml positioner` of the page is a job without a fault.
#[test]
fn the_jobs_of_the_page_can_be_done() {
    let page = include_str!("../../../docs/positioner.md");
    let jobs: Vec<&str> =
        page.split("```toml positioner\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert_eq!(jobs.len(), 3);
    jobs.iter().for_each(|job| assert!(holds(&good(job)) > 0));
}

proptest! {
    /// Any numbers: an answer, and no panic.
    #[test]
    fn no_numbers_make_it_panic(numbers in prop::collection::vec(any::<f64>(), 12), which in 0..3_usize) {
        let list = |numbers: &[f64]| format!("{numbers:?}").to_lowercase();
        let text = match which {
            0 => format!("points = [{}, {}]", list(&numbers[..6]), list(&numbers[6..])),
            1 => format!(
                "first = {{ kind = \"cone\", at_mm = {}, axis = {}, diameter_mm = {:?}, half_angle_deg = 5.0 }}\nsecond = {{ kind = \"sphere\", at_mm = {}, diameter_mm = {:?} }}",
                list(&numbers[..3]), list(&numbers[3..6]), numbers[6], list(&numbers[7..10]), numbers[10]
            ).to_lowercase(),
            _ => format!("x = \"t\"\ny = \"0\"\nz = \"0\"\ndirection = [\"1\", \"t\", \"0\"]\nt = {}", list(&numbers[..2])),
        };
        check_job("seam.toml", &format!("kind = \"seam\"\nfeed_mm_min = 60\n{text}"), &machine());
    }
}

#[test]
fn a_seam_in_a_program_says_itself_where_the_part_lies() {
    let keys = [
        "kind = \"seam\"",
        "x = \"20*cos(t)\"",
        "y = \"20*sin(t)\"",
        "z = \"9\"",
        "direction = [\"cos(t)\", \"sin(t)\", \"1\"]",
        "t = [0, 1]",
        "feed_mm_min = 300",
        "origin_mm = [1, 2, 3]",
    ];
    let lines: String = keys.iter().map(|key| format!(";@ {key}\n")).collect();
    let program = check("part.ngc", &format!("G21\nG92 X5\n{lines}M2\n"), &machine());
    assert!(program.diagnostics.is_empty(), "{}", said(&program));
    let file = good(&(keys.join("\n") + "\n"));
    assert_eq!((formulas(&program), start(&program)), (formulas(&file), start(&file)));
    let at_zero = check("part.ngc", &format!("{}M2\n", lines.replace("[1, 2, 3]", "[0, 0, 0]")), &machine());
    assert_ne!(start(&at_zero), start(&program));
}
