//! Shape from formulas in the whole machine: what is commanded lies on the curve, the feed along it is what
//! is asked for, and the operator can do what he does in any other move.
#![allow(clippy::unwrap_used)]

use machine::Machine;
use protocol::{
    Axis, Code, Feed, Item, MachineState, PathMode, PerAxis, Position, Shape, Work, operator::Request,
};
use rig::observe::{Observation, Outcome, Record};
use route::{Unworkable, positioner::geometry};
use shape::{
    Branch, Contour, Correction, Curve, Formula, Function, Leg, Op, Pattern, Seam, SeamCurve, Side, Surface,
    Tool,
};

use crate::stand::{Stand, pressed};

const FEED_MM_MIN: f64 = 1200.0;

fn mill() -> Machine {
    Machine::from_toml(machine::SMALL_MILL).unwrap()
}

/// 8 sin(x/15).
fn wave() -> Formula {
    let ops =
        [Op::Variable(0), Op::Constant(15.0), Op::Div, Op::Apply(Function::Sin), Op::Constant(8.0), Op::Mul];
    Formula::new(&ops).unwrap()
}

/// 0.02 x² + 8 sin(x/15) cos(y/20).
fn hill() -> Formula {
    let (x, y) = (Op::Variable(0), Op::Variable(1));
    let cosine = [y, Op::Constant(20.0), Op::Div, Op::Apply(Function::Cos), Op::Mul];
    let square = [x, Op::Powi(2), Op::Constant(0.02), Op::Mul, Op::Add];
    let ops: Vec<Op> = wave().ops().chain(cosine).chain(square).collect();
    Formula::new(&ops).unwrap()
}

fn at(x: f64, y: f64, z: f64) -> PerAxis<Position> {
    let mut at = PerAxis::default();
    (at[0], at[1], at[2]) = (Position::from_mm(x), Position::from_mm(y), Position::from_mm(z));
    at
}

fn trace(work: Shape, origin: [f64; 3]) -> Work {
    let origin = origin.map(Position::from_mm);
    Work { shape: work, origin, feed_mm_min: FEED_MM_MIN, chord_mm: 0.002, correction: Correction::Exact }
}

fn items(codes: &[Code]) -> Vec<Item> {
    (1..).zip(codes).map(|(line, code)| Item { line, code: *code }).collect()
}

fn run(items: &[Item], requests: &[(u64, Request)], see: impl FnMut(&Record)) -> Observation {
    run_on(&mill(), items, requests, see)
}

fn run_on(
    machine: &Machine,
    items: &[Item],
    requests: &[(u64, Request)],
    mut see: impl FnMut(&Record),
) -> Observation {
    Stand { machine, items, scenario: "", seed: 5 }.run(|record| {
        see(record);
        pressed(requests, record)
    })
}

/// A wave in the plane of X and Y about X 100, Y 80, beginning where it is.
fn waves() -> Vec<Item> {
    let contour = Contour { x: [-40.0, 40.0], radius_mm: 0.0, side: Side::On };
    let start = 8.0 * libm::sin(-40.0 / 15.0);
    items(&[
        Code::Line { target: at(60.0, 80.0 + start, -20.0), feed: Feed::Rapid },
        Code::Formula { slot: 0, formula: wave() },
        Code::Work(trace(Shape::Contour(contour, [Axis::X, Axis::Y]), [100.0, 80.0, 0.0])),
        Code::End,
    ])
}

/// Lines of a ball over a hill about X 20, Y −30, Z −100, beginning at its start.
fn lines(zigzag: bool) -> Vec<Item> {
    let surface = Surface {
        x: [0.0, 20.0],
        y: [-5.0, 5.0],
        tool: Tool { radius_mm: 3.0, corner_mm: 3.0 },
        pattern: Pattern::Lines { along_y: false, count: 5, zigzag },
        clear_mm: 25.0,
    };
    let Some(Leg::Cut(plan)) = surface.leg(0) else { panic!("a surface begins with a cut") };
    let hill = hill();
    let [x, y, z] = surface.curve(plan, [&hill; 3]).at(plan.t()[0]).axes.map(|axis| axis.value());
    items(&[
        Code::Line { target: at(20.0 + x, y - 30.0, z - 60.0), feed: Feed::Rapid },
        Code::Line { target: at(20.0 + x, y - 30.0, z - 100.0), feed: Feed::PerMinute(FEED_MM_MIN) },
        Code::Formula { slot: 0, formula: hill },
        Code::Work(trace(Shape::Surface(surface), [20.0, -30.0, -100.0])),
        Code::Line { target: at(20.0, 0.0, -60.0), feed: Feed::Rapid },
        Code::End,
    ])
}

/// How far the ball is from touching the hill, mm: its centre lies 3 mm above the plane that touches the hill
/// nearest to it.
fn off_the_hill(tip: [f64; 3]) -> f64 {
    let [x, y, z] = [tip[0] - 20.0, tip[1] + 30.0, tip[2] + 103.0];
    let height = |x: f64, y: f64| 0.02 * x * x + 8.0 * libm::sin(x / 15.0) * libm::cos(y / 20.0);
    let slopes = |x: f64, y: f64| {
        let along = 0.04 * x + 8.0 / 15.0 * libm::cos(x / 15.0) * libm::cos(y / 20.0);
        [along, -0.4 * libm::sin(x / 15.0) * libm::sin(y / 20.0)]
    };
    let (mut u, mut v) = (x, y);
    for _ in 0..60 {
        let [p, q] = slopes(u, v);
        let up = (height(u, v) - z) / 1.0;
        (u, v) = (u + 0.5 * (x - u - p * up) / (1.0 + p * p), v + 0.5 * (y - v - q * up) / (1.0 + q * q));
    }
    let distance = libm::sqrt((x - u) * (x - u) + (y - v) * (y - v) + (z - height(u, v)).powi(2));
    (distance - 3.0).abs()
}

#[test]
fn a_contour_is_commanded_exactly_at_its_feed() {
    let (mut worst, mut feeds, mut before) = (0.0_f64, Vec::new(), None);
    let seen = run(&waves(), &[], |record| {
        let [x, y] = [0, 1].map(|i| record.axes[i].1.commanded_mm);
        if record.axes[0].1.line != 3 {
            return;
        }
        worst = worst.max((y - 80.0 - 8.0 * libm::sin((x - 100.0) / 15.0)).abs());
        if let Some((x0, y0)) = before.replace((x, y)) {
            feeds.push(libm::hypot(x - x0, y - y0) / 0.0005 * 60.0);
        }
    });
    assert_eq!(seen.outcome, Outcome::Completed, "{:?}", seen.faults);
    assert_eq!((seen.moves.count, seen.moves.limit_violations), (2, 0));
    assert!(worst < 1e-5, "{worst} mm off the contour");
    let middle = &feeds[feeds.len() / 4..3 * feeds.len() / 4];
    let (low, high) =
        middle.iter().fold((f64::MAX, 0.0_f64), |(low, high), feed| (low.min(*feed), high.max(*feed)));
    assert!(low > 0.999 * FEED_MM_MIN && high < 1.001 * FEED_MM_MIN, "{low} to {high} mm/min");
}

/// The cycles of the trace in line 4 of [`lines`] by what the interpolator says of them.
#[derive(Default)]
struct Seen {
    /// Farthest from touching the hill while the axes cut, mm.
    off_mm: f64,
    /// Highest Z, mm.
    highest_mm: f64,
    /// Progress, cycle by cycle.
    taken: Vec<u64>,
    /// What `tracing` was three ticks ago: the setpoints of a tick are for three ticks later.
    cuts: [u32; 12],
}

impl Seen {
    fn see(&mut self, record: &Record) {
        self.cuts.rotate_left(1);
        self.cuts[11] = record.machine.work;
        let tip = [0, 1, 2].map(|i| record.axes[i].1.commanded_mm);
        if self.cuts == [1; 12] {
            self.off_mm = self.off_mm.max(off_the_hill(tip));
        }
        if record.machine.line == 4 {
            self.taken.push(record.machine.taken);
            self.highest_mm = self.highest_mm.max(tip[2]);
        }
    }
}

#[test]
fn a_surface_is_cut_leg_by_leg() {
    for zigzag in [true, false] {
        let (program, mut watched) = (lines(zigzag), Seen { highest_mm: -100.0, ..Seen::default() });
        let seen = run(&program, &[], |record| watched.see(record));
        assert_eq!(seen.outcome, Outcome::Completed, "{:?}", seen.faults);
        assert_eq!((seen.moves.count, seen.moves.limit_violations, seen.moves.starved), (4, 0, 0));
        let (foretold, taken) =
            (interpreter::time_s(&program, &mill()).unwrap(), seen.cycles as f64 * 0.0005);
        assert!((taken - foretold).abs() < 0.01 * foretold, "{taken} s, foretold {foretold} s");
        let Seen { off_mm, highest_mm, taken, .. } = watched;
        assert!(off_mm < 2e-3, "{off_mm} mm off the surface");
        assert!(
            (highest_mm - if zigzag { -85.02 } else { -75.0 }).abs() < 0.1,
            "retracts to Z −75: {highest_mm}"
        );
        assert!(
            taken.is_sorted() && taken.iter().any(|taken| (400..600).contains(taken)),
            "progress goes on"
        );
    }
}

/// The published ratios of a step leave what they are known to leave: most without correction, and nothing
/// adds up.
#[test]
fn corrections_lead_the_followers_as_they_are_known_to() {
    let off_mm = |correction: Correction| {
        let (mut program, mut watched) = (lines(true), Seen::default());
        for item in &mut program {
            if let Code::Work(trace) = &mut item.code {
                (trace.correction, trace.feed_mm_min) = (correction, 6000.0);
            }
        }
        let seen = run(&program, &[], |record| watched.see(record));
        assert_eq!((seen.outcome, seen.moves.limit_violations), (Outcome::Completed, 0), "{correction:?}");
        watched.off_mm
    };
    let [none, published, signs, mixed, exact] = Correction::ALL.map(off_mm);
    assert!(
        none > 1e-4 && none < 2e-3 && published > signs && signs < 0.2 * none,
        "{none} {published} {signs}"
    );
    assert!(mixed < none && exact < 1e-6, "{mixed} {exact}");
}

#[test]
fn the_operator_leaves_the_tool_on_the_surface() {
    let (program, mut watched) = (lines(true), Seen::default());
    let plain = run(&program, &[], |_| ());
    let requests = [
        (9000, Request::FeedOverride(180.0)),
        (9800, Request::FeedHold),
        (11_000, Request::CycleStart),
        (12_000, Request::FeedOverride(30.0)),
        (15_000, Request::FeedOverride(100.0)),
    ];
    let mut stood = 0;
    let seen = run(&program, &requests, |record| {
        watched.see(record);
        stood += u64::from(
            (10_200..11_000).contains(&record.truth.cycle.0) && record.axes[0].1.velocity_mm_s == 0.0,
        );
    });
    assert_eq!(seen.outcome, Outcome::Completed, "{:?}", seen.faults);
    assert_eq!((seen.moves.count, seen.moves.limit_violations), (4, 0));
    assert!(watched.off_mm < 2e-3 && stood > 700, "{} mm, stood {stood} cycles", watched.off_mm);
    assert!(seen.cycles > plain.cycles + 1000, "the operator changed nothing");

    let mut watched = Seen::default();
    let seen = run(&program, &[(12_000, Request::Stop)], |record| watched.see(record));
    assert_eq!((seen.outcome, seen.moves.count), (Outcome::Stopped, 2));
    assert!(watched.off_mm < 2e-3 && seen.cycles < plain.cycles, "{} mm", watched.off_mm);
}

/// Single block waits at the end of a trace, and nowhere in it, although one way only it takes many chains.
#[test]
fn a_trace_is_one_block() {
    let requests = [(1, Request::SingleBlock(true))];
    let mut pauses = Vec::new();
    let seen = run(&lines(false), &requests, |record| {
        if record.machine.state() == MachineState::Paused && pauses.last() != Some(&record.machine.line) {
            pauses.push(record.machine.line);
        }
    });
    assert_eq!((seen.outcome, seen.moves.count), (Outcome::Completed, 4), "{:?}", seen.faults);
    assert_eq!(pauses, [1, 2, 4, 5]);
}

#[test]
fn traces_that_cannot_be_followed_are_faults_that_stop_the_axes_before() {
    // The square root of x ends at 0, a quarter on the way; so does a travel of 62 mm.
    let root = Formula::new(&[Op::Variable(0), Op::Apply(Function::Sqrt)]).unwrap();
    let fault = |formulas: &[Formula], from_x: f64, origin: [f64; 3], start: f64| {
        let contour = Contour { x: [60.0, -20.0], radius_mm: 0.0, side: Side::On };
        let mut codes = vec![Code::Line { target: at(from_x, start, 0.0), feed: Feed::Rapid }];
        codes.extend((0..).zip(formulas).map(|(slot, formula)| Code::Formula { slot, formula: *formula }));
        codes.push(Code::Work(trace(Shape::Contour(contour, [Axis::X, Axis::Y]), origin)));
        codes.push(Code::End);
        let program = items(&codes);
        let (mut end, mut fastest) = ([0.0; 2], 0.0_f64);
        let seen = run(&program, &[], |record| {
            end = [0, 1].map(|i| record.axes[i].1.commanded_mm);
            fastest = fastest.max(record.axes[0].1.acceleration_mm_s2.abs());
        });
        assert_eq!(seen.outcome, Outcome::Faulted);
        let (_, reason) = interpreter::time_s(&program, &mill()).unwrap_err();
        (seen.faults[0].code.clone(), reason.to_string(), end, seen.moves.limit_violations)
    };
    let start = libm::sqrt(60.0);
    let (code, reason, end, violations) = fault(&[root], 60.0, [0.0; 3], start);
    assert_eq!((code.as_str(), violations), ("bad-machine-code", 0));
    assert!(reason.starts_with("x = "), "{reason}");
    assert!(end[0] > -1e-6 && end[0] < 1.0, "stopped before x = 0: {end:?}");
    let (code, reason, ..) = fault(&[], 60.0, [0.0; 3], start);
    assert_eq!(
        (code.as_str(), reason.as_str()),
        ("bad-machine-code", "formula 0 is missing: it has to come before the work")
    );
    let (code, reason, end, _) = fault(&[root], 60.0, [0.0; 3], start + 0.02);
    assert!((end[1] - start - 0.02).abs() < 1e-6, "{end:?}");
    assert_eq!((code.as_str(), end[0]), ("bad-machine-code", 60.0));
    assert_eq!(reason, "Y stands 0.020000 from the start of the path: move the axes there first");
    let (code, reason, end, violations) = fault(&[wave()], -140.0, [-200.0, 0.0, 0.0], 8.0 * libm::sin(4.0));
    assert_eq!((code.as_str(), violations), ("travel-limit", 0));
    assert!(reason.starts_with("the path leaves the travel of X near x = "), "{reason}");
    assert!((-200.0..-190.0).contains(&end[0]), "{end:?}");
}

/// A rapid through the part: the machine refuses it before, whichever end of the way across is the higher
/// one.
#[test]
fn a_retract_below_the_surface_is_refused() {
    for (clear_mm, deeper) in [(-1.0, 0.5), (-6.0, 5.0)] {
        let mut program = lines(false);
        for item in &mut program {
            if let Code::Work(Work { shape: Shape::Surface(surface), .. }) = &mut item.code {
                surface.clear_mm = clear_mm;
            }
        }
        let mut fastest = 0.0_f64;
        let seen = run(&program, &[], |record| {
            if record.machine.line == 4 {
                fastest = fastest.max(record.axes[2].1.velocity_mm_s.abs());
            }
        });
        assert_eq!((seen.outcome, seen.faults[0].code.as_str()), (Outcome::Faulted, "bad-machine-code"));
        assert!(fastest < FEED_MM_MIN / 60.0, "{fastest} mm/s");
        let (line, reason) = interpreter::time_s(&program, &mill()).unwrap_err();
        assert!(matches!(reason, Unworkable::TooLow { mm, .. } if mm > deeper), "{reason:?}");
        assert!(line == 4 && reason.to_string().contains("below the path at x = 20.0000"), "{reason}");
    }
}

/// Two halves of one seam: a line over a turning part, in formulas that are polynomials.
fn halves() -> (Machine, Vec<Item>) {
    let machine = Machine::from_toml(machine::POSITIONER).unwrap();
    let mut coefficients = [[0.0; 8]; 6];
    (coefficients[0][1], coefficients[2][0]) = (1.0, 20.0);
    (coefficients[3][0], coefficients[4][1], coefficients[5][0]) = (0.2, 0.01, 1.0);
    let curve = SeamCurve::Polynomials(coefficients);
    let half = |t| Seam { curve, t, branch: Branch::Negative, idle_beta_deg: 0.0, moved: None };
    let positioner = machine.positioner.as_ref().unwrap();
    let first = half([-20.0, 0.0]);
    let start = first.on(&[], geometry(positioner), positioner.beam_mm).at(-20.0).axes;
    let mut target = PerAxis::default();
    for (axis, at) in machine::POSITIONER_AXES.into_iter().zip(start) {
        target[axis.index()] = Position::from_mm(at.value());
    }
    let seam = |t| Code::Work(trace(Shape::Seam(half(t)), [0.0; 3]));
    let program =
        items(&[Code::Line { target, feed: Feed::Rapid }, seam([-20.0, 0.0]), seam([0.0, 20.0]), Code::End]);
    (machine, program)
}

#[test]
fn seams_that_meet_are_one_path() {
    let (machine, program) = halves();
    let (mut slowest, mut traced, mut taken) = (f64::INFINITY, Vec::new(), Vec::new());
    let seen = run_on(&machine, &program, &[], |record| {
        taken.push(record.machine.taken);
        if record.machine.work > 0 {
            traced.push(record.machine.work);
        }
        if (300..2000).contains(&traced.len()) {
            slowest = slowest.min(record.axes.iter().map(|(_, axis)| axis.velocity_mm_s.abs()).sum());
        }
    });
    assert_eq!(seen.outcome, Outcome::Completed, "{:?}", seen.faults);
    assert_eq!((seen.moves.count, seen.moves.limit_violations), (3, 0));
    assert!(slowest > 10.0 && traced.is_sorted() && traced.ends_with(&[2]), "{slowest} mm/s");
    assert!(taken.is_sorted() && taken.ends_with(&[2002]), "{:?}", taken.last());
    let foretold = interpreter::time_s(&program, &machine).unwrap();
    let took = seen.cycles as f64 * 0.0005;
    assert!((took - foretold).abs() < 0.01 * foretold, "{took} s, foretold {foretold} s");
}

#[test]
fn seams_that_meet_stop_between_them_in_single_block_and_at_a_path_mode() {
    let (machine, program) = halves();
    let mut pauses = Vec::new();
    let seen = run_on(&machine, &program, &[(1, Request::SingleBlock(true))], |record| {
        let paused = record.machine.state() == MachineState::Paused;
        if paused && pauses.last() != Some(&record.machine.line) {
            pauses.push(record.machine.line);
        }
    });
    assert_eq!((seen.outcome, seen.moves.count), (Outcome::Completed, 3), "{:?}", seen.faults);
    assert_eq!(pauses, [1, 2, 3]);

    let mut codes: Vec<Code> = program.iter().map(|item| item.code).collect();
    codes.insert(2, Code::PathMode(PathMode::ExactPath));
    let stopping = items(&codes);
    let [together, apart] = [&program, &stopping].map(|items| interpreter::time_s(items, &machine).unwrap());
    let took = run_on(&machine, &stopping, &[], |_| ()).cycles as f64 * 0.0005;
    // How many sections a law passes depends a little on when pieces arrive.
    assert!(apart.min(took) > together + 0.02, "{together} s, {apart} s, {took} s");
    assert!((took - apart).abs() < 0.005 * apart, "{together} s, {apart} s, {took} s");
}
