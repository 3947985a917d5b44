//! The worst of a million ticks of the interpolator. `cargo bench --bench worst` prints what a tick costs:
//! median, 99.9 % and worst.
//!
//! The machine follows short lines of 0.2 mm round and round, on a smooth curve and on one with sharp
//! corners, and a ball over a surface of which it has the formula, while the operator turns the feed override
//! and holds now and then: both make the interpolator plan again. Timed is what the process does in a tick:
//! it takes the machine code it has asked for, and ticks. Every run makes the same ticks, so the least cost
//! of a tick over the runs is what it costs by itself; one run alone has also what the system does meanwhile.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout, clippy::disallowed_methods)] // measures time

use std::{f64::consts::TAU, hint::black_box, time::Instant};

use machine::Machine;
use protocol::{Axis, Code, Cycle, Feed, Item, Measurement, Panel, PerAxis, Position, Shape, Work};
use rig::Rig;
use rig::wires::Wires;
use shape::{Correction, Curve, Formula, Function, Leg, Op, Pattern, Surface, Tool};
use sim_plant::Scenario;

const TICKS: usize = 1_000_000;
const ROUNDS: usize = 3;
/// Lines of one turn, which is 0.2 mm times as long.
const LINES: usize = 640;
const FEED_MM_MIN: f64 = 6000.0;

/// Radius at an angle: of a smooth closed curve, and of a star.
type Radius = fn(f64) -> f64;

fn smooth(angle: f64) -> f64 {
    20.0 + libm::sin(5.0 * angle)
}

fn star(angle: f64) -> f64 {
    let wave = 8.0 * angle / TAU;
    20.0 + 4.0 * (2.0 * (wave - wave.floor()) - 1.0).abs()
}

/// One turn of machine code in the plane of X and Z.
fn turn(curve: Radius) -> Vec<Item> {
    let line = |number: usize| {
        let angle = TAU * number as f64 / LINES as f64;
        let (s, c) = libm::sincos(angle);
        let mut target = PerAxis::<Position>::default();
        target[Axis::X.index()] = Position::from_mm(50.0 + curve(angle) * s);
        target[Axis::Z.index()] = Position::from_mm(-100.0 + curve(angle) * c);
        Item { line: number as u32 + 1, code: Code::Line { target, feed: Feed::PerMinute(FEED_MM_MIN) } }
    };
    (0..LINES).map(line).collect()
}

/// The panel at a tick: a new feed override every half second, and a hold now and then.
fn operator(tick: usize) -> Panel {
    let turn = tick / 250;
    let buttons = if turn % 13 == 12 { Panel::FEED_HOLD } else { 0 };
    Panel { feed_override_pct: 40.0 + 40.0 * (turn * 7 % 5) as f64, buttons, ..Panel::default() }
}

/// Wires that put the operator's hand on every panel, and take the time from the measurement that starts a
/// tick of the interpolator to the next message, which is sent when the tick is over.
#[derive(Default)]
struct Watched {
    measurement: Measurement,
    begun: Option<Instant>,
    costs: Vec<f64>,
}

impl Watched {
    fn at_the_panel(&mut self, sent: Option<&Measurement>) -> Option<&Measurement> {
        self.measurement = *sent?;
        self.measurement.panel = operator(self.costs.len());
        self.measurement = self.measurement.sealed();
        Some(&self.measurement)
    }
}

impl Wires for Watched {
    fn tick_measurement<'a>(
        &'a mut self,
        _: Cycle,
        sent: Option<&'a Measurement>,
    ) -> Option<&'a Measurement> {
        self.at_the_panel(sent)?;
        self.begun = Some(Instant::now());
        Some(&self.measurement)
    }

    fn measurement<'a>(
        &'a mut self,
        _: Cycle,
        _: Axis,
        sent: Option<&'a Measurement>,
    ) -> Option<&'a Measurement> {
        if let Some(begun) = self.begun.take() {
            self.costs.push(begun.elapsed().as_secs_f64() * 1e9);
        }
        self.at_the_panel(sent)
    }
}

/// One run: the cost of every tick, ns, and how far it went, in lines or thousandths of a surface.
fn run(machine: &Machine, code: &[Item]) -> (Vec<f64>, u64) {
    let wires = Watched { costs: Vec::with_capacity(TICKS), ..Watched::default() };
    let code = code.iter().copied().cycle();
    let mut rig = Rig::with_wires(machine, code, Scenario::none(), 1, wires).unwrap();
    let mut steps = 0;
    while rig.wires_mut().costs.len() < TICKS {
        rig.cycle(None, |record| steps = black_box(record.machine).taken);
    }
    (std::mem::take(&mut rig.wires_mut().costs), steps)
}

/// Cost of every tick, ns: of one run, and the least of all runs; and how far one run goes.
fn costs(machine: &Machine, code: &[Item]) -> ([Vec<f64>; 2], u64) {
    let mut least = vec![f64::INFINITY; TICKS];
    let (mut one, mut steps) = (Vec::new(), 0);
    for _ in 0..ROUNDS {
        (one, steps) = run(machine, code);
        least.iter_mut().zip(&one).for_each(|(least, ns)| *least = least.min(*ns));
    }
    ([one, least], steps)
}

/// A ball of 6 mm over 0.02 x² + 8 sin(x/15) cos(y/20), 0.25 mm from line to line, from corner to corner.
fn surface() -> Vec<Item> {
    let (x, y, number) = (Op::Variable(0), Op::Variable(1), Op::Constant);
    let wave = [x, number(15.0), Op::Div, Op::Apply(Function::Sin), y, number(20.0), Op::Div];
    let square =
        [Op::Apply(Function::Cos), Op::Mul, number(8.0), Op::Mul, x, Op::Powi(2), number(0.02), Op::Mul];
    let formula = Formula::new(&[&wave[..], &square[..], &[Op::Add]].concat()).unwrap();
    let surface = Surface {
        x: [-50.0, 50.0],
        y: [-40.0, 40.0],
        tool: Tool { radius_mm: 3.0, corner_mm: 3.0 },
        pattern: Pattern::Lines { along_y: false, count: 321, zigzag: true },
        clear_mm: 80.0,
    };
    let Some(Leg::Cut(plan)) = surface.leg(0) else { panic!("a surface begins with a cut") };
    let tip = surface.curve(plan, [&formula; 3]).at(plan.t()[0]).axes;
    let mut target = PerAxis::<Position>::default();
    for (at, tip) in target.iter_mut().zip(tip) {
        *at = Position::from_mm(tip.value());
    }
    let down = Position::from_mm(-150.0);
    let (work, origin) = (Shape::Surface(surface), [Position(0), Position(0), down]);
    let correction = Correction::Exact;
    let trace = Work { shape: work, origin, feed_mm_min: FEED_MM_MIN, chord_mm: 0.002, correction };
    target[Axis::Z.index()] = target[Axis::Z.index()].moved(down.mm());
    let codes =
        [Code::Line { target, feed: Feed::Rapid }, Code::Formula { slot: 0, formula }, Code::Work(trace)];
    codes.map(|code| Item { line: 1, code }).into()
}

fn main() {
    let mill = Machine::from_toml(machine::SMALL_MILL).unwrap();
    let lathe = Machine::plain();
    let runs =
        [("smooth", &lathe, turn(smooth)), ("star", &lathe, turn(star)), ("surface", &mill, surface())];
    for (name, machine, code) in runs {
        let (costs, steps) = costs(machine, &code);
        let least = if name == "surface" { 1000 } else { TICKS as u64 / 100 };
        assert!(steps > least, "the machine stands: {steps} steps");
        println!("{name}: {TICKS} ticks, {steps} steps of its progress");
        for (mut costs, what) in costs.into_iter().zip(["one run", "least of runs"]) {
            costs.sort_by(f64::total_cmp);
            let [median, most, worst] =
                [0.5, 0.999, 1.0].map(|share| costs[(share * (TICKS - 1) as f64) as usize]);
            println!("  {what:<14} median {median:>6.0} ns, 99.9 % {most:>7.0} ns, worst {worst:>9.0} ns");
        }
    }
}
