//! Jobs said in straight lines: read again they are programs, and lie within the chord error of the true
//! path.

use std::path::Path;

use interpreter::{Interpreter, Language};
use machine::Machine;
use protocol::{Axis, Code, Feed, Item, Shape, Work};
use route::positioner;
use shape::{Curve, Drives, Formula, Leg, Plan, Surface};

fn mill() -> Machine {
    Machine::from_toml(include_str!("../../../examples/machines/small-mill.toml")).expect("it is a machine")
}

/// A program around a job, as items.
fn items(program: &str, machine: &Machine) -> Vec<Item> {
    let items: Result<_, _> = Interpreter::of_text("job.ngc", program, machine).collect();
    items.expect("the program is good")
}

/// A job or a program that is shipped, as items.
fn example(name: &str, machine: &Machine) -> Vec<Item> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name);
    let program = interpreter::open(&path, &Language::default(), machine).expect("it is there");
    let items: Result<_, _> = Interpreter::new(program, machine).collect();
    items.expect("the program is good")
}

fn lines(items: &[Item], machine: &Machine) -> (Vec<String>, super::Size) {
    let mut lines = Vec::new();
    let size = written(items, machine, &mut |line| lines.push(line.to_owned()));
    (lines, size.expect("it can be said in lines"))
}

fn written(
    items: &[Item],
    machine: &Machine,
    line: &mut dyn FnMut(&str),
) -> Result<super::Size, super::NoLines> {
    super::write(&about(items), items.iter().copied().map(Ok), machine, line)
}

fn about(items: &[Item]) -> super::About {
    let mut about = super::About::default();
    items.iter().for_each(|item| about.item(item));
    about
}

fn trace(items: &[Item]) -> Work {
    let trace = |item: &Item| if let Code::Work(trace) = item.code { Some(trace) } else { None };
    items.iter().find_map(trace).expect("there is a trace")
}

/// The ends of all lines of feed, and where the first begins: some axes of the machine, mm and degrees.
fn cut<const N: usize>(items: &[Item], axes: [Axis; N]) -> Vec<[f64; N]> {
    let mut points = Vec::new();
    let mut last = [0.0; N];
    for item in items {
        let Code::Line { target, feed } = item.code else { continue };
        let at = axes.map(|axis| target[axis.index()].mm());
        if feed != Feed::Rapid {
            if points.is_empty() {
                points.push(last);
            }
            points.push(at);
        }
        last = at;
    }
    points
}

const XYZ: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

fn apart(at: [f64; 3], from: [f64; 3], to: [f64; 3]) -> f64 {
    let sub = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (along, out) = (sub(to, from), sub(at, from));
    let share = (dot(out, along) / dot(along, along).max(1e-30)).clamp(0.0, 1.0);
    let off = [0, 1, 2].map(|i| out[i] - share * along[i]);
    dot(off, off).sqrt()
}

/// Places along the true path of the tip, `gap` apart in the parameter.
fn true_path(surface: &Surface, formulas: [&Formula; 3], origin: [f64; 3], gap: f64) -> Vec<[f64; 3]> {
    let mut places = Vec::new();
    for leg in 0..surface.legs() {
        let Some(Leg::Cut(plan)) = surface.leg(leg) else { continue };
        let plan: Plan = plan;
        let [from, to] = plan.t();
        let steps = ((to - from) / gap).ceil();
        for step in 0..=steps as u32 {
            let point = surface.curve(plan, formulas).at(from + (to - from) * f64::from(step) / steps);
            places.push([0, 1, 2].map(|i| point.axes[i].value() + origin[i]));
        }
    }
    places
}

/// The farthest that places lie from a line of points, both in order.
fn farthest(places: &[[f64; 3]], points: &[[f64; 3]]) -> f64 {
    let (mut at, mut most) = (0, 0.0_f64);
    for place in places {
        let off = |k: usize| points.get(k + 1).map_or(f64::INFINITY, |to| apart(*place, points[k], *to));
        while (1..4).any(|ahead| off(at + ahead) <= off(at)) {
            at += 1;
        }
        most = most.max(off(at));
    }
    most
}

/// Formulas by number; those that are missing are 0.
fn formulas(items: &[Item]) -> [Formula; 6] {
    let mut all = [Formula::default(); 6];
    for item in items {
        if let Code::Formula { slot, formula } = item.code {
            all[usize::from(slot)] = formula;
        }
    }
    all
}

/// How far the true path of a trace lies from the lines of feed of a program, mm, and how long these are, mm.
fn compared(job: &[Item], program: &[Item]) -> (f64, f64) {
    let trace = trace(job);
    let [psi, x, y, ..] = formulas(job);
    let origin = trace.origin.map(|axis| axis.mm());
    let places = match trace.shape {
        Shape::Surface(surface) => true_path(&surface, [&psi, &x, &y], origin, 0.05),
        Shape::Contour(contour, [Axis::X, Axis::Y]) => {
            let curve = contour.curve(&psi);
            let [from, to] = contour.t();
            let at = |k: u32| curve.at(from + (to - from) * f64::from(k) / 10_000.0).axes;
            let height = cut(program, XYZ)[1][2];
            (0..=10_000)
                .map(|k| at(k).map(|axis| axis.value()))
                .map(|[x, y]| [x + origin[0], y + origin[1], height])
                .collect()
        }
        work => panic!("{work:?}"),
    };
    // What comes before the work is the way down to it.
    let points = &cut(program, XYZ)[1..];
    let length: f64 = points.windows(2).map(|ends| apart(ends[0], ends[1], ends[1])).sum();
    (farthest(&places, points), length)
}

#[test]
fn jobs_in_lines_are_programs_within_the_chord_error_and_no_finer_than_they_must_be() {
    let machine = mill();
    for name in ["shape/wave.toml", "shape/contour.toml", "shape/inline.ngc"] {
        let job = example(name, &machine);
        let (text, size) = lines(&job, &machine);
        assert_eq!(size.blocks, text.len() as u64);
        assert_eq!(size.bytes, text.iter().map(|line| line.len() as u64 + 1).sum::<u64>());

        let program = items(&(text.join("\n") + "\n"), &machine);
        let (off, _) = compared(&job, &program);
        let chord_mm = trace(&job).chord_mm;
        assert!(off <= chord_mm, "{name}: {off}");
        assert!(off > 0.8 * chord_mm, "{name}: {off}");
    }
}

/// The beam on a seam: where the drives of a line stand for a point of the seam, it passes by so near.
#[test]
fn a_seam_in_lines_keeps_the_beam_within_the_chord_error() {
    let text = include_str!("../../../examples/machines/positioner.toml");
    let machine = Machine::from_toml(text).expect("it is a machine");
    let config = machine.positioner.expect("it is a positioner");
    let (geometry, beam) = (positioner::geometry(&config), config.beam_mm);
    for name in ["positioner/cylinders.toml", "positioner/wave.toml"] {
        let job = example(name, &machine);
        let (text, _) = lines(&job, &machine);
        let program = items(&(text.join("\n") + "\n"), &machine);
        let trace = trace(&job);
        let Shape::Seam(seam) = trace.shape else { panic!("it is a seam") };
        let formulas = formulas(&job);
        let path = seam.on(&formulas, geometry, beam);
        let points = cut(&program, [Axis::X, Axis::Y, Axis::A, Axis::C]);
        let passes_by = |point: [f64; 3], line: usize, share: f64| {
            let (Some(from), Some(to)) = (points.get(line), points.get(line + 1)) else {
                return f64::INFINITY;
            };
            let [x, y, a, c] = [0, 1, 2, 3].map(|i| from[i] + share * (to[i] - from[i]));
            let at = geometry.forward(point, &Drives { x, y, alpha: a.to_radians(), beta: c.to_radians() });
            libm::hypot(at[0] - beam[0], at[1] - beam[1])
        };
        let nearest = |point: [f64; 3], line: usize| {
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..60 {
                let third = (high - low) / 3.0;
                if passes_by(point, line, low + third) < passes_by(point, line, high - third) {
                    high -= third;
                } else {
                    low += third;
                }
            }
            passes_by(point, line, 0.5 * (low + high))
        };
        let (mut line, mut most) = (0, 0.0_f64);
        for k in 0..=3000 {
            let t = seam.t[0] + (seam.t[1] - seam.t[0]) * f64::from(k) / 3000.0;
            let point = path.place(t)[0].map(|p| p.value());
            while (1..4).any(|ahead| nearest(point, line + ahead) < nearest(point, line)) {
                line += 1;
            }
            most = most.max(nearest(point, line));
        }
        assert!(line + 3 > points.len() - 1, "{name}: {line} of {}", points.len());
        assert!(most <= trace.chord_mm && most > 0.8 * trace.chord_mm, "{name}: {most}");
    }
}

/// Chords of a circle have a length that is known: l = (8 R d)^½ (M44).
#[test]
fn an_arc_has_as_many_chords_as_its_radius_asks_for() {
    let machine = mill();
    let circle = items("G21 G90 G17 G61 F600\nG0 X40 Y0 Z0\nG2 I-40\nM2\n", &machine);
    let (text, _) = lines(&circle, &machine);
    let points = cut(&items(&(text.join("\n") + "\n"), &machine), XYZ);
    let length = std::f64::consts::TAU * 40.0 / (points.len() - 1) as f64;
    let longest = (8.0 * 40.0 * 0.9 * machine.path.chord_mm).sqrt();
    assert!(length <= longest && length > 0.95 * longest, "{length} {longest}");
}

#[test]
fn moves_around_a_job_are_said_as_they_are() {
    let machine = mill();
    let program = "G21 G90 G94 G61.1\nT2 M6\nS500 M4\nM7\nG0 X10 Y5.5 Z1\nG1 Z-1 F200\nX12\nX12\nG4 P0.5\nM0\nG95 F0.2\nY0\nM9\nM5\nM2\n";
    let (text, _) = lines(&items(program, &machine), &machine);
    let wanted = [
        "G17",
        "G21 G90 G94 G40 G49 G80 G54",
        "G10 L2 P1 X0 Y0 Z0",
        "G64 P0.008 Q0.002",
        "T2 M6",
        "G97 S500 M4",
        "M7",
        "G61.1",
        "G0 X10 Y5.5 Z1",
        "G1 Z-1 F200",
        "X12",
        "G4 P0.5",
        "M0",
        "G95",
        "Y0 F0.2",
        "M9",
        "M5",
        "M2",
    ];
    assert_eq!(text, wanted);
}

#[test]
fn a_formula_is_told_as_people_write_it() {
    let machine = mill();
    let surface = |z: &str| {
        let program = format!(
            "G21 G17 G90 G94\nG10 L2 P1 X-30 Y-20 Z-100\nT3 M6\nS9000 M3\nG0 X0 Y0 Z60\nF2000\n;@ kind = \"surface\"\n\
             ;@ z = \"{z}\"\n;@ x = [1, 2]\n;@ y = [1, 2]\n;@ tool = {{ kind = \"ball\", diameter_mm = 0.2 }}\n\
             ;@ path = {{ pattern = \"lines\", step_mm = 0.5 }}\nM2\n"
        );
        let items = items(&program, &machine);
        let told = about(&items).header(&machine, "job.ngc").join("\n");
        let (_, formula) = told.split_once("z = ").expect("it is a surface");
        (formula.split(", tool").next().unwrap_or_default().to_owned(), formulas(&items)[0])
    };
    for z in [
        "x - (y - 1)",
        "x/(y*2)/3",
        "-(x + y)^2*sin(x - y)",
        "(-x)^3 + x^(-2)",
        "exp(-(x - y)^2/200)",
        "(2*x)^2",
    ] {
        let (told, formula) = surface(z);
        let (again, read) = surface(&told);
        assert_eq!(told, again, "{z}");
        for at in [[1.0, 1.5], [1.7, 1.1], [2.0, 2.0]] {
            let [one, other] = [formula.eval(at), read.eval(at)];
            assert!((one - other).abs() <= 1e-12 * one.abs(), "{z}: {told}");
        }
    }
}

#[test]
fn a_thread_is_refused_with_its_line() {
    let machine = Machine::default();
    let thread = items("G21 G90 G18 G8\nS500 M3\nG0 X11 Z5\nG33 Z-20 K1\nM2\n", &machine);
    let error = written(&thread, &machine, &mut |_| {}).expect_err("a thread follows the spindle");
    assert_eq!(error.to_string(), "line 4: a pass of a thread is not said in lines");
}

#[test]
fn outputs_and_inputs_are_the_codes_that_they_came_from() {
    let mut machine = mill();
    machine.outputs.insert("3".into(), machine::Output::default());
    machine.inputs.insert("2".into(), machine::Input::default());
    let air = machine::AnalogOutput { range: [0.0, 10.0], ..Default::default() };
    machine.analog_outputs.insert("1".into(), air);
    let codes = [
        "M62 P3",
        "M63 P3",
        "M64 P3",
        "M65 P3",
        "M67 E1 Q2.5",
        "M68 E1 Q10",
        "M66 P2 L1 Q0.5",
        "M66 P2 L2 Q1",
        "M66 P2 L3 Q2",
        "M66 P2 L4 Q3",
    ];
    let program = format!("F1000\nG1 X10\n{}\nG1 X20\nM2\n", codes.join("\n"));
    let (lines, _) = lines(&items(&program, &machine), &machine);
    let said: Vec<&String> = lines.iter().filter(|line| line.starts_with("M6")).collect();
    assert_eq!(said, codes);
}
