//! Jobs said in straight lines: read again they are programs, and lie within the chord error of the true path.

use interpreter::{Interpreter, g1};
use protocol::{Code, Feed, Item, Machine, Trace, Work};
use shape::{Curve, Formula, Leg, Plan, Surface};

const MILL: &str = include_str!("../../examples/machines/small-mill.toml");

fn mill() -> Machine {
    Machine::from_toml(MILL).expect("it is a machine")
}

/// A program around a job, as items.
fn items(program: &str, machine: &Machine) -> Vec<Item> {
    let items: Result<_, _> = Interpreter::of_text("job.ngc", program, machine).collect();
    items.expect("the program is good")
}

fn lines(items: &[Item], machine: &Machine) -> (Vec<String>, g1::Size) {
    let mut lines = Vec::new();
    let size =
        g1::write(items, machine, &mut |line| lines.push(line.to_owned())).expect("it can be said in lines");
    (lines, size)
}

fn trace(items: &[Item]) -> Trace {
    let trace = |item: &Item| if let Code::Trace(trace) = item.code { Some(trace) } else { None };
    items.iter().find_map(trace).expect("there is a trace")
}

/// The ends of all lines of feed, and where the first begins, mm of the machine.
fn cut(items: &[Item]) -> Vec<[f64; 3]> {
    let mut points = Vec::new();
    let mut last = [0.0; 3];
    for item in items {
        let Code::Line { target, feed } = item.code else { continue };
        let [x, y, z, ..] = target.map(|axis| axis.mm());
        if feed != Feed::Rapid {
            if points.is_empty() {
                points.push(last);
            }
            points.push([x, y, z]);
        }
        last = [x, y, z];
    }
    points
}

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

const WAVE: &str = "G21 G90 G94 G54
G10 L2 P1 X-10 Y-5 Z-100
S8000 M3
;@ kind = \"surface\"
;@ z = \"0.02*x^2 + 8*sin(x/15)*cos(y/20)\"
;@ x = [0, 40]
;@ y = [0, 4]
;@ tool = { kind = \"ball\", diameter_mm = 6 }
;@ path = { pattern = \"lines\", along = \"x\", step_mm = 1 }
;@ feed_mm_min = 1500
;@ chord_mm = 0.002
;@ clearance_mm = 5
M2
";

#[test]
fn a_wave_in_lines_is_a_program_within_the_chord_error() {
    let machine = mill();
    let job = items(WAVE, &machine);
    let (text, size) = lines(&job, &machine);
    assert_eq!(size.blocks, text.len() as u64);
    assert_eq!(size.bytes, text.iter().map(|line| line.len() as u64 + 1).sum::<u64>());

    let program = items(&(text.join("\n") + "\n"), &machine);
    let trace = trace(&job);
    let Work::Surface(surface) = trace.work else { panic!("it is a surface") };
    let formulas: Vec<Formula> = job
        .iter()
        .filter_map(|item| if let Code::Formula { formula, .. } = item.code { Some(formula) } else { None })
        .collect();
    let psi = &formulas[0];
    let places = true_path(&surface, [psi; 3], trace.origin.map(|axis| axis.mm()), 0.02);
    let points = cut(&program);
    // What comes before the surface is the way down to it.
    let off = farthest(&places, &points[1..]);
    assert!(off <= 0.002, "{off}");
    // And no finer than it must be.
    assert!(off > 0.0016, "{off}");
    let chord_mm = 40.0 / (points.len() as f64 / 5.0);
    assert!(chord_mm > 0.4, "{chord_mm}");
}
