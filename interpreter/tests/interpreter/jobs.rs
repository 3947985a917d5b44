//! Jobs from outside: what becomes of them, where they stand in a program, where a message points.

use interpreter::{Check, Severity, check, check_job};
use machine::{Machine, SMALL_MILL};
use protocol::{Axis, Code, Feed, Item, Position, Shape, Work};
use shape::{Correction, Formula, Surface};

pub(super) const WAVE: &str = include_str!("../../../examples/shape/wave.toml");
const CONTOUR: &str = include_str!("../../../examples/shape/contour.toml");
const INLINE: &str = include_str!("../../../examples/shape/inline.ngc");

pub(super) fn mill() -> Machine {
    Machine::from_toml(SMALL_MILL).expect("the built-in mill")
}

fn said(check: &Check) -> String {
    check.diagnostics.iter().map(|diagnostic| diagnostic.render(false)).collect()
}

pub(super) fn good(text: &str, machine: &Machine) -> Check {
    let check = check_job("job.toml", text, machine);
    assert!(check.is_good(), "{}", said(&check));
    check
}

fn trace(items: &[Item]) -> Work {
    let trace =
        items.iter().find_map(|item| if let Code::Work(trace) = item.code { Some(trace) } else { None });
    trace.expect("there is a trace")
}

pub(super) fn formulas(items: &[Item]) -> Vec<Formula> {
    let formula =
        |item: &Item| if let Code::Formula { formula, .. } = item.code { Some(formula) } else { None };
    items.iter().filter_map(formula).collect()
}

pub(super) fn surface(items: &[Item]) -> Surface {
    match trace(items).shape {
        Shape::Surface(surface) => surface,
        other => panic!("{other:?}"),
    }
}

/// X, Y, Z of a line.
fn line(item: &Item) -> ([f64; 3], Feed) {
    let Code::Line { target, feed } = item.code else { panic!("{item:?}") };
    ([Axis::X, Axis::Y, Axis::Z].map(|axis| target[axis.index()].mm()), feed)
}

#[test]
fn a_surface_becomes_an_approach_a_formula_a_trace_and_a_retract() {
    let check = good(WAVE, &mill());
    let kinds: Vec<String> = super::listing(&check.items).lines().map(str::to_owned).collect();
    let kinds: Vec<&str> = kinds.iter().map(|line| line.split(" X").next().unwrap()).collect();
    let expected = [
        "1 tool 3",
        "1 spindle 12000",
        "1 coolant",
        "1 rapid",
        "1 rapid",
        "1 feed 3000/min",
        "1 formula 0",
        "1 trace at 3000/min",
        "1 rapid",
        "1 spindle stop",
        "1 coolant",
        "1 end",
    ];
    assert_eq!(kinds.len(), expected.len(), "{kinds:?}");
    assert!(kinds.iter().zip(expected).all(|(is, should)| is.starts_with(should)), "{kinds:?}");

    let trace = trace(&check.items);
    assert_eq!(trace.origin, [-50.0, -40.0, -170.0].map(Position::from_mm));
    assert_eq!((trace.chord_mm, trace.correction), (0.002, Correction::Exact));
    let (psi, surface) = (formulas(&check.items)[0], surface(&check.items));
    let plunge = check.items.iter().position(|item| matches!(item.code, Code::Formula { .. })).unwrap() - 1;
    let (start, _) = line(&check.items[plunge]);
    let tip = surface.tip(&psi, [0.0, 0.0]);
    let origin = [-50.0, -40.0, -170.0];
    assert!((0..3).all(|i| (start[i] - origin[i] - tip[i]).abs() < 2e-9), "{start:?} {tip:?}");
    let (above, _) = line(&check.items[plunge - 1]);
    assert_eq!(above[..2], start[..2]);
    let top = (0..=400).map(|n| psi.eval([100.0, f64::from(n) * 0.2])).fold(0.0, f64::max);
    assert!((above[2] - (top - 170.0 + 5.0)).abs() < 1e-3, "5 mm above the highest place");
}

#[test]
fn behind_a_job_in_a_program_the_programmed_point_is_where_the_tool_is() {
    let check = check("part.ngc", INLINE, &mill());
    assert!(check.diagnostics.is_empty(), "{}", said(&check));
    assert_eq!(trace(&check.items).feed_mm_min, 2000.0, "F");
    assert_eq!(trace(&check.items).origin, [-30.0, -20.0, -30.0].map(Position::from_mm), "G54");
    let at = check.items.iter().position(|item| matches!(item.code, Code::Work(_))).unwrap();
    let ((retract, _), (next, _)) = (line(&check.items[at + 1]), line(&check.items[at + 2]));
    assert_eq!(retract[..2], next[..2], "G0 Z30 keeps X and Y");
    assert_eq!(next[2], 0.0);
}

#[test]
fn incremental_moves_inches_and_offsets_count_behind_a_job() {
    let job =
        ";@ kind = \"contour\"\n;@ y = \"x/2\"\n;@ x = [0, 20]\n;@ depth_z_mm = -1\n;@ clearance_mm = 4\n";
    let head = "G17 G90 G94 S1000 M3 F300\nG10 L2 P1 X5 Y6 Z7\nG92 X0 Y0 Z3\nG0 Z30\n";
    let program =
        format!("G20\n{head}F10\n{job}G91 G0 X1\nG90 G0 Y0\nM2\n", head = head.replace("Z30", "Z1"));
    let check = check("part.ngc", &program, &mill());
    assert!(check.diagnostics.is_empty(), "{}", said(&check));
    let at = check.items.iter().position(|item| matches!(item.code, Code::Work(_))).unwrap();
    assert_eq!(trace(&check.items).feed_mm_min, 254.0, "F in inches");
    let lines: Vec<[f64; 3]> = check.items[at + 1..at + 4].iter().map(|item| line(item).0).collect();
    let origin = trace(&check.items).origin.map(Position::mm);
    let near = |a: f64, b: f64| (a - b).abs() < 2e-9;
    assert!(
        near(lines[0][0], origin[0] + 20.0) && near(lines[0][1], origin[1] + 10.0),
        "mm, whatever G20 says"
    );
    assert!(near(lines[1][0], lines[0][0] + 25.4) && near(lines[1][1], lines[0][1]), "{lines:?}");
    assert!(near(lines[2][1], origin[1]), "{lines:?}");
}

#[test]
fn a_job_within_a_loop_is_done_each_time() {
    let job = ";@ kind = \"contour\"\n;@ y = \"x/2\"\n;@ x = [0, 20]\n;@ depth_z_mm = -1\n";
    let program = format!(
        "G21 S1000 M3 F300\no1 repeat [3]\nG91 G0 Y2\nG90\n{job}o1 endrepeat\no2 if [0]\n{job}o2 endif\nM2\n"
    );
    let check = check("part.ngc", &program, &mill());
    assert!(check.diagnostics.is_empty(), "{}", said(&check));
    let traces = check.items.iter().filter(|item| matches!(item.code, Code::Work(_))).count();
    assert_eq!((traces, check.jobs.len()), (3, 3));
}

#[test]
fn contours_on_a_mill_and_on_a_lathe() {
    let check = good(CONTOUR, &mill());
    let Shape::Contour(contour, axes) = trace(&check.items).shape else { panic!("a contour") };
    assert_eq!((contour.radius_mm, axes), (5.0, [Axis::X, Axis::Y]));
    let lathe = "kind = \"contour\"\nx = \"12 - z^2/100\"\nz = [0, -20]\norigin_mm = [0, 0, 0]\nspindle_rpm = 900\n\
                 feed_mm_min = 80\ntool = { diameter_mm = 0.8, side = \"right\" }";
    let check = good(lathe, &Machine::plain());
    let Shape::Contour(contour, axes) = trace(&check.items).shape else { panic!("a contour") };
    assert_eq!(
        (contour.above_mm(), axes),
        (0.4, [Axis::Z, Axis::X]),
        "right of the way towards the chuck is outside"
    );
}

#[test]
fn a_wrong_value_has_a_caret_below_it() {
    let text = WAVE.replace("8*sin(x/15)", "8*abs(x/15)");
    let check = check_job("wave.toml", &text, &mill());
    let [wrong] = check.diagnostics.as_slice() else { panic!("{}", said(&check)) };
    assert_eq!((wrong.line, &wrong.text[wrong.span.clone()]), (14, "abs"));
    let text = WAVE.replace("diameter_mm = 6", "diameter_mm = 60");
    let check = check_job("wave.toml", &text, &mill());
    let [wrong] = check.diagnostics.as_slice() else { panic!("{}", said(&check)) };
    assert!(wrong.line == 17 && wrong.text[wrong.span.clone()].starts_with("tool = "), "{}", said(&check));

    let inline = INLINE.replace("diameter_mm = 8", "diameter_mm = -8");
    let check = super::check("part.ngc", &inline, &mill());
    let [wrong] = check.diagnostics.as_slice() else { panic!("{}", said(&check)) };
    assert_eq!((wrong.line, &wrong.text[wrong.span.clone()]), (15, "diameter_mm = -8"));
}

/// What is said of a job file that is refused.
fn refused(text: &str) -> String {
    let check = check_job("job.toml", text, &mill());
    assert!(!check.is_good(), "{:?}", check.jobs);
    said(&check)
}

#[test]
fn the_tool_is_clear_of_what_a_path_goes_over_between_the_nodes_of_the_grid() {
    let text = "kind = \"surface\"\norigin_mm = [-50, -40, -100]\nspindle_rpm = 9000\nfeed_mm_min = 3000\n\
                z = \"-cos(4*pi*x)/50\"\nx = [0, 100]\ny = [0, 20]\ntool = { kind = \"ball\", diameter_mm = 0.08 }\n\
                path = { pattern = \"lines\", step_mm = 20, one_way = true }\nclearance_mm = 0.01";
    let check = good(text, &mill());
    let clear = surface(&check.items).clear_mm;
    assert!((0.03..0.031).contains(&clear), "0.02 mm is the highest place: {clear}");
}

#[test]
fn a_path_that_is_too_long_is_refused_before_memory_is_full() {
    let spiral =
        "path = { pattern = \"curve\", x = \"5 + 4*cos(8*t)\", y = \"5 + 4*sin(8*t)\", t = [0, 1e5] }";
    let text = format!(
        "kind = \"surface\"\norigin_mm = [-50, -40, -100]\nspindle_rpm = 9000\nfeed_mm_min = 3000\nz = \"x\"\n\
         x = [0, 10]\ny = [0, 10]\ntool = {{ kind = \"ball\", diameter_mm = 6 }}\n{spiral}"
    );
    assert!(refused(&text).contains("too long to be looked at: more than 2000000 places"));
}

#[test]
fn detail_that_the_pieces_of_a_path_step_over_is_refused() {
    let head = "origin_mm = [-50, -40, -100]\nspindle_rpm = 9000\nfeed_mm_min = 3000\nx = [0, 20]\n";
    let bump = |t: &str| format!("0.01*exp(-(({t} - 10.13)/0.02)^2)");
    let contour = format!("{head}kind = \"contour\"\ny = \"{}\"\ndepth_z_mm = -1", bump("x"));
    let said = refused(&contour);
    assert!(said.contains("finer detail than the pieces of the path follow, at x = 10."), "{said}");
    let surface = format!(
        "{head}kind = \"surface\"\nz = \"0.1*x\"\ny = [0, 20]\ntool = {{ kind = \"ball\", diameter_mm = 6 }}\n\
         path = {{ pattern = \"curve\", x = \"t\", y = \"9 + {}\", t = [0, 20] }}",
        bump("t")
    );
    let said = refused(&surface);
    assert!(said.contains("finer detail than the pieces of the path follow, at x = 10."), "{said}");
}

/// A surface under lines along X, on the mill.
fn lines(z: &str, x: [f64; 2], diameter_mm: f64, path: &str) -> String {
    format!(
        "kind = \"surface\"\norigin_mm = [-50, -40, -100]\nspindle_rpm = 9000\nfeed_mm_min = 3000\nz = \"{z}\"\n\
         x = {x:?}\ny = [0, 20]\ntool = {{ kind = \"ball\", diameter_mm = {diameter_mm} }}\n\
         path = {{ pattern = \"lines\", {path} }}\n"
    )
}

/// What `check` says of the first job.
fn fact(check: &Check, name: &str) -> String {
    check.jobs[0].facts.iter().find(|(is, _)| *is == name).map(|(_, text)| text.clone()).expect("it is told")
}

#[test]
fn the_net_that_is_looked_at_follows_the_tool() {
    let fine = good(&lines("0.1*x", [0.0, 100.0], 1.0, "step_mm = 0.5"), &mill());
    assert_eq!(fact(&fine, "looked at"), "1601 x 321 places, 0.062 mm x 0.062 mm apart");
    let most = good(&lines("0.1*x", [0.0, 100.0], 0.1, "step_mm = 0.09"), &mill());
    let net = fact(&most, "looked at");
    let places: f64 = net.split(' ').step_by(2).take(2).map(|word| word.parse::<f64>().unwrap()).product();
    assert!((0.99e6..1.01e6).contains(&places), "{net}");
    // The groove is between the nodes of a net of 200 cells, and shallow enough for the lines to get over it.
    let groove = lines("0.05*x - 0.02*exp(-((x - 50.25)/0.08)^2)", [0.0, 100.0], 1.0, "step_mm = 0.5");
    assert!(refused(&groove).contains("hollow there with a radius of"));
    let contour = "kind = \"contour\"\norigin_mm = [-50, 0, 0]\nspindle_rpm = 6000\nfeed_mm_min = 1200\ny = \"x/10\"\n\
                   x = [0, 100]\ndepth_z_mm = -4\n";
    assert_eq!(fact(&good(contour, &mill()), "looked at"), "4001 places along x");
    let tool = format!("{contour}tool = {{ diameter_mm = 0.2, side = \"left\" }}\n");
    assert_eq!(fact(&good(&tool, &mill()), "looked at"), "8001 places along x");
}

#[test]
fn paths_that_do_not_overlap_are_a_warning_and_no_figure() {
    let material = "paths do not overlap, material is left between them";
    for (z, step) in [("0*x", 4.0), ("0*x", 1.0), ("5*y", 0.5)] {
        let text = lines(z, [0.0, 20.0], 1.0, &format!("step_mm = {step}"));
        let check = good(&text, &mill());
        let [one] = check.diagnostics.as_slice() else { panic!("{}", said(&check)) };
        assert_eq!((one.severity, one.line, one.message.as_str()), (Severity::Warning, 9, material));
        assert!(fact(&check, "spacing").ends_with(material), "{:?}", check.jobs);
    }
    let near = good(&lines("0*x", [0.0, 20.0], 1.0, "step_mm = 0.9"), &mill());
    assert!(
        near.diagnostics.is_empty() && fact(&near, "spacing").contains("ridges of at most 253.09"),
        "{near:?}"
    );
    // What is asked for as a ridge never lets the paths part.
    let hollow = good(&lines("y^2/13 - 3*y", [0.0, 20.0], 12.0, "scallop_mm = 3"), &mill());
    assert!(hollow.diagnostics.is_empty(), "{}", said(&hollow));
    let bull =
        lines("0.9*y", [0.0, 20.0], 8.0, "step_mm = 4").replace("\"ball\"", "\"bull\", corner_mm = 0.5");
    let bull = good(&bull, &mill());
    assert!(
        bull.diagnostics.is_empty() && fact(&bull, "spacing").ends_with("steps where it is steep"),
        "{bull:?}"
    );
}

#[test]
fn a_tool_that_does_not_fit_between_the_nodes_of_the_grid_is_said_not_to_fit() {
    // Level at every node.
    let alias = refused(&lines("0.5*sin(4*pi*x)", [0.0, 100.0], 12.0, "step_mm = 5"));
    assert!(alias.contains("the surface is hollow there with a radius of"), "{alias}");
    let upright = refused(&lines("1e300*x", [0.0, 10.0], 6.0, "step_mm = 5"));
    assert!(upright.contains("the surface is as good as upright at x = 0.0000"), "{upright}");
}

#[test]
fn a_value_that_is_not_written_as_it_reads_is_blamed_as_a_whole() {
    let job = |y: &str| {
        format!(
            "kind = \"contour\"\norigin_mm = [-50, 0, 0]\nfeed_mm_min = 9\nx = [0, 9]\ndepth_z_mm = -4\ny = {y}\n"
        )
    };
    for (y, blamed) in [
        ("\"x + q\"", "q"),
        ("'x + q'", "q"),
        ("\"\\u0078 + q\"", "\"\\u0078 + q\""),
        ("\"\"\"\nx + q\"\"\"", "\"\"\""),
        ("\"\"\"x + q\"\"\"", "\"\"\"x + q\"\"\""),
    ] {
        let check = check_job("job.toml", &job(y), &mill());
        let [wrong] = check.diagnostics.as_slice() else { panic!("{}", said(&check)) };
        assert_eq!((wrong.line, &wrong.text[wrong.span.clone()]), (6, blamed), "{}", said(&check));
    }
}

#[test]
fn a_line_of_a_job_file_may_be_as_long_as_the_file() {
    let long = format!("{WAVE}# {}\n", "x".repeat(5000));
    good(&long, &mill());
    let check = check_job("job.toml", &format!("{WAVE}# {}\n", "x".repeat(600_000)), &mill());
    let [wrong] = check.diagnostics.as_slice() else { panic!("{}", said(&check)) };
    assert_eq!(wrong.line as usize, WAVE.lines().count() + 1, "{}", wrong.message);
}

#[test]
fn lines_that_are_nearly_those_of_a_job_are_a_warning() {
    let head = "G21 S1000 M3 F300\nG0 X0\n";
    for line in [
        "; @ kind = \"contour\"",
        "G1 X10 ;@ y = \"x/3\"",
        "N10 ;@ kind = \"contour\"",
        "/;@ kind = \"contour\"",
    ] {
        let check = check("part.ngc", &format!("{head}{line}\nM2\n"), &mill());
        let [one] = check.diagnostics.as_slice() else { panic!("{line}: {}", said(&check)) };
        assert_eq!((one.severity, one.line, one.code), (Severity::Warning, 3, "job"), "{}", one.message);
        assert!(wrong_text(one).starts_with(';'));
    }
    let plain = check("part.ngc", &format!("{head}; mail to a@b.c\n; @home\nM2\n"), &mill());
    assert!(plain.diagnostics.is_empty(), "{}", said(&plain));
    let split = INLINE.replacen("\n;@ x", "\n\n;@ x", 1);
    assert!(split != INLINE);
    let check = check("part.ngc", &split, &mill());
    assert!(said(&check).contains("an empty one ends it"), "{}", said(&check));
}

fn wrong_text(one: &interpreter::Diagnostic) -> &str {
    &one.text[one.span.clone()]
}
