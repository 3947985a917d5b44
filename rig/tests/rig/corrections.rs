//! How fast work from formulas may be followed: what a correction leaves of its steps stays within the chord
//! error, and pieces of small bends are ahead of the axes at any feed.
#![allow(clippy::unwrap_used)]

use machine::Machine;
use protocol::{Axis, Code, Feed, Item, PerAxis, Position, Shape, Work};
use rig::observe::{Observation, Outcome};
use shape::{Contour, Correction, Curve, Formula, Function, Leg, Op, Pattern, Side, Surface, Tool};

use crate::stand::Stand;

const FEED_MM_MIN: f64 = 9000.0;

fn mill() -> Machine {
    Machine::from_toml(machine::SMALL_MILL).unwrap()
}

/// a sin(b x).
fn wave(a: f64, b: f64) -> Formula {
    let ops = [Op::Variable(0), Op::Constant(b), Op::Mul, Op::Apply(Function::Sin), Op::Constant(a), Op::Mul];
    Formula::new(&ops).unwrap()
}

/// A rapid to the start of a trace of one formula, and the trace.
fn program(start: [f64; 3], formula: Formula, trace: Work) -> Vec<Item> {
    let mut target = PerAxis::default();
    for (axis, mm) in target.iter_mut().zip(start) {
        *axis = Position::from_mm(mm);
    }
    let codes = [
        Code::Line { target, feed: Feed::Rapid },
        Code::Formula { slot: 0, formula },
        Code::Work(trace),
        Code::End,
    ];
    (1..).zip(codes).map(|(line, code)| Item { line, code }).collect()
}

fn run(items: &[Item]) -> Observation {
    run_as(items, items)
}

/// A program, and the one that the observer takes it for.
fn run_as(items: &[Item], observed: &[Item]) -> Observation {
    Stand { machine: &mill(), items, scenario: "", seed: 5 }.run_as(observed, |_| None)
}

/// A line over z = 2 sin(x/3) under a ball of 3 mm, faster than a chord error of half a micrometre lets it
/// be: what a correction leaves of its steps stays within that error, and steps along the tangent are half as
/// long as exact ones.
#[test]
fn the_chord_error_binds_with_every_correction() {
    let formula = wave(2.0, 1.0 / 3.0);
    let surface = Surface {
        x: [0.0, 20.0],
        y: [-1.0, 1.0],
        tool: Tool { radius_mm: 1.5, corner_mm: 1.5 },
        pattern: Pattern::Lines { along_y: false, count: 2, zigzag: true },
        clear_mm: 25.0,
    };
    let Some(Leg::Cut(plan)) = surface.leg(0) else { panic!("a surface begins with a cut") };
    let [x, y, z] = surface.curve(plan, [&formula; 3]).at(plan.t()[0]).axes.map(|axis| axis.value());
    let cut = |correction| {
        let (work, origin) = (Shape::Surface(surface), [20.0, 0.0, -100.0].map(Position::from_mm));
        let trace = Work { shape: work, origin, feed_mm_min: FEED_MM_MIN, chord_mm: 5e-4, correction };
        let seen = run(&program([20.0 + x, y, z - 100.0], formula, trace));
        assert_eq!((seen.outcome, seen.moves.limit_violations), (Outcome::Completed, 0), "{correction:?}");
        let report = &seen.traces[0];
        (report.commanded.max_abs_um().max(report.feed.chord_max_um), report.cut_cycles as f64)
    };
    let [none, published, signs, mixed, exact] = Correction::ALL.map(cut);
    for (off_um, _) in [none, published, signs, mixed, exact] {
        assert!(off_um < 0.505, "{off_um} µm");
    }
    assert!(none.0 > 0.4 && exact.0 > 0.4 && published.0 > 0.3, "it binds: {none:?} {published:?} {exact:?}");
    assert!(
        none.1 > 1.2 * exact.1 && published.1 > none.1,
        "{none:?} {published:?} {signs:?} {mixed:?} {exact:?}"
    );
}

/// A contour with bends of 0.2 mm radius, whose zero lies at so many mm in Y.
fn bends(y: f64) -> Vec<Item> {
    let contour = Contour { x: [0.0, 20.0], radius_mm: 0.0, side: Side::On };
    let work = Shape::Contour(contour, [Axis::X, Axis::Y]);
    let origin = [40.0, y, 0.0].map(Position::from_mm);
    let correction = Correction::Exact;
    let trace = Work { shape: work, origin, feed_mm_min: FEED_MM_MIN, chord_mm: 0.002, correction };
    program([40.0, 0.0, 0.0], wave(0.2, 5.0), trace)
}

/// At 9000 mm/min: pieces are a hundredth of a millimetre long, and still ahead of the axes.
#[test]
fn small_bends_at_high_feed_do_not_run_dry() {
    let program = bends(0.0);
    let seen = run(&program);
    assert_eq!((seen.outcome, seen.moves.limit_violations), (Outcome::Completed, 0), "{:?}", seen.faults);
    assert_eq!(seen.moves.starved, 0);
    assert!(seen.traces[0].commanded.max_abs_um() < 2.0, "{:?}", seen.traces[0].commanded);
    let foretold = interpreter::time_s(&program, &mill()).unwrap();
    let took = seen.cycles as f64 * 0.0005;
    assert!((took - foretold).abs() < 0.01 * foretold, "{took} s, foretold {foretold} s");
}

/// What is commanded beside the path is wrong, however true the axes are. With a correction its error is what
/// is looked at.
#[test]
fn a_command_farther_off_than_the_chord_error_is_wrong() {
    let seen = |observed: &[Item]| run_as(&bends(0.0), observed).traces.remove(0);
    let right = seen(&bends(0.0015));
    assert!(right.most_um == Some(2.0) && !right.is_wrong(), "{:?}", right.commanded);
    let wrong = seen(&bends(0.0025));
    assert!(wrong.is_wrong() && (wrong.commanded.max_abs_um() - 2.5).abs() < 0.01, "{:?}", wrong.commanded);
    let mut led = bends(0.0025);
    for item in &mut led {
        if let Code::Work(trace) = &mut item.code {
            trace.correction = Correction::None;
        }
    }
    assert!(!seen(&led).is_wrong());
}
