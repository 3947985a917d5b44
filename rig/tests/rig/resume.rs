//! A run that loses its power in any cycle, gone on with by new controls: the journal, the program and the
//! machine file are all that they know. Judged by the truth of the plant: the thread lies where it lay, all
//! of it is cut, and the tool goes through nothing on its way.

use machine::{Machine, ProgramDialect};
use protocol::{Axis, Code, Item, PerAxis, Position};
use rig::{
    Rig,
    journal::{Keeper, Origin, State},
    observe::{Observation, Observer, Outcome, PassReport, Record},
    resume::{Plan, Refusal, Stands, plan},
    wires::Straight,
};
use sim_plant::{Plant, Scenario};
use testing::Seed;

use crate::stand::compiled;

/// Faced, turned, threaded in four passes and a spring pass.
const PROGRAM: &str = "G18 G21 G90 G8 G94 G97\nT1\nM3 S800\nG0 X12 Z0\nG1 X-0.4 F400\nG0 Z1\nG0 X9.9\nG1 Z-20 F400\n\
    G3 X11 Z-21.1 K0 I1.1\nG1 X12\nG0 Z8\nT3\nM3 S600\nG0 X11 Z8\nG76 P2 Z-16 I-1.1 J0.6 K1.2 R2 Q29.5 H1\nG0 X20\nM5\nM2\n";
/// Within the thread: Z, and below the crest, mm.
const THREAD_MM: [f64; 2] = [-15.5, -0.5];
const CREST_MM: f64 = 9.9;
/// A pass that is cut again lies where it lay, µm.
const SAME_GROOVE_UM: f64 = 1.5;
/// Far beyond the end of every program here, control cycles.
const PATIENCE: u64 = 400_000;
/// Records of the journal that a cut may cost besides.
const LOST: usize = 3;

/// A tool in the groove that is moved along it by time, mm: what no way through a part may do.
#[derive(Default)]
pub(crate) struct Ploughed {
    z_mm: Option<f64>,
    pub(crate) mm: f64,
}

impl Ploughed {
    pub(crate) fn cycle(&mut self, record: &Record) {
        let [x, z] = [Axis::X, Axis::Z].map(|axis| record.truth.axes[axis.index()].slide_mm);
        let led = record.axes.iter().any(|(_, status)| status.state().is_in_pass());
        let within = x < CREST_MM - 0.05 && (THREAD_MM[0]..THREAD_MM[1]).contains(&z) && !led;
        let before = self.z_mm.replace(z).filter(|_| within);
        self.mm += before.map_or(0.0, |before| (z - before).abs());
    }
}

/// Runs to the end; `see` is shown every cycle.
fn observed(
    machine: &Machine,
    items: Vec<Item>,
    plant: Plant,
    mut see: impl FnMut(&Record),
) -> (Observation, Ploughed) {
    let (mut observer, mut ploughed) = (Observer::new(machine, &items), Ploughed::default());
    let mut rig = Rig::on_plant(machine, plant, items.into_iter(), Straight);
    for _ in 0..PATIENCE {
        let goes_on = rig.cycle(None, |record| {
            observer.cycle(record);
            ploughed.cycle(record);
            see(record);
        });
        if !goes_on {
            return (observer.finish(), ploughed);
        }
    }
    panic!("the program does not end")
}

fn new_plant(machine: &Machine, seed: u64) -> Plant {
    Plant::new(machine, Scenario::none(), seed).expect("a plant")
}

/// A run that is cut behind a cycle: what the journal has of it, what was seen, and the machine when it is
/// switched on again.
struct Cut {
    known: State,
    seen: Observation,
    plant: Plant,
    /// What the axes did in the last cycle, for a message.
    moment: String,
}

/// The journal has lost so many of its last records.
fn cut(machine: &Machine, items: &[Item], [seed, at]: [u64; 2], lost: usize) -> Cut {
    let mut rig = Rig::new(machine, items.iter().copied(), Scenario::none(), seed).expect("a rig");
    let mut keeper = Keeper::new(machine, Origin { seed, ..Origin::default() }, items);
    let (mut observer, mut written, mut moment) = (Observer::new(machine, items), Vec::new(), String::new());
    for cycle in 0..at {
        rig.cycle(None, |record| {
            observer.cycle(record);
            written.extend(keeper.cycle(record));
            if cycle + 1 == at {
                let states: Vec<&str> = record.axes.iter().map(|(_, status)| status.state().name()).collect();
                moment = format!("cycle {cycle}, line {}, {}", record.machine.line, states.join(" "));
            }
        });
    }
    let mut plant = rig.lose_power(|_| {});
    plant.switch_on(Scenario::none()).expect("the same machine");
    let known = written[(written.len() - 1).saturating_sub(lost)];
    Cut { known, seen: observer.finish(), plant, moment }
}

fn planned(machine: &Machine, items: &[Item], cut: &Cut) -> Result<Plan, Refusal> {
    let here = cut.plant.measurement().axes.map(|axis| axis.position);
    plan(machine, || items.iter().copied(), &cut.known, &here)
}

/// What is executed: the way there, then the rest of the program.
fn rest(plan: &Plan, items: &[Item]) -> Vec<Item> {
    let left = items.iter().skip(plan.modal.items as usize);
    plan.before.iter().chain(left).copied().collect()
}

/// How far passes of two runs lie from each other, where both touched the material for a turn, µm.
fn apart_um(one: &[PassReport], other: &[PassReport]) -> f64 {
    let touched = |pass: &&PassReport| pass.tool.contact_deg > 360.0;
    let mut phases: Vec<f64> =
        one.iter().chain(other).filter(touched).map(|pass| pass.tool.phase_um).collect();
    phases.sort_by(f64::total_cmp);
    phases.last().zip(phases.first()).map_or(0.0, |(high, low)| high - low)
}

/// Goes on with a run that was cut; the plan, how far its passes lie from those before, µm, and how far the
/// tool was moved along in the groove, mm.
fn go_on(machine: &Machine, items: &[Item], cut: Cut) -> (Plan, [f64; 2]) {
    let what = &cut.moment;
    let plan = planned(machine, items, &cut).unwrap_or_else(|error| panic!("{what}: {error}"));
    let done = cut.seen.passes.iter().filter(|pass| pass.complete).count();
    assert!(plan.modal.passes as usize <= done, "{what}: pass {} is left out", done + 1);
    assert_eq!(plan.modal.passes, cut.known.passes, "{what}: what is known to be cut is not cut again");
    let passes = items.iter().filter(|item| matches!(item.code, Code::Pass(_))).count();
    let (seen, ploughed) = observed(machine, rest(&plan, items), cut.plant, |_| {});
    assert_eq!((seen.outcome, &seen.faults[..]), (Outcome::Completed, &[][..]), "{what}: {:?}", plan.stands);
    assert_eq!(seen.passes.len(), passes - plan.modal.passes as usize, "{what}");
    let apart_um = apart_um(&cut.seen.passes, &seen.passes);
    assert!(apart_um <= SAME_GROOVE_UM, "{what}: {apart_um:.2} um from the groove");
    (plan, [apart_um, ploughed.mm])
}

/// How long a run takes, and the cycles in which an axis changes its state.
fn borders(machine: &Machine, items: &[Item], seed: u64) -> (u64, Vec<u64>) {
    let (mut states, mut borders) = (Vec::new(), Vec::new());
    let (whole, _) = observed(machine, items.to_vec(), new_plant(machine, seed), |record| {
        let now: Vec<_> = record.axes.iter().map(|(_, status)| status.state()).collect();
        if states != now {
            borders.push(record.truth.cycle.0);
            states = now;
        }
    });
    assert_eq!(whole.outcome, Outcome::Completed, "{:?}", whole.faults);
    (whole.cycles, borders)
}

/// In any cycle, and round those in which a pass is armed, begins, is at depth, leaves, is over.
#[test]
fn a_run_that_is_cut_in_any_cycle_is_finished_in_its_groove() {
    let machine = Machine::default();
    let items = compiled(&machine, PROGRAM);
    let seeds: Vec<_> = (1..=3).map(|seed| borders(&machine, &items, seed)).collect();
    let cuts = std::env::var("PITCHLOCK_CUTS").ok().and_then(|cuts| cuts.parse().ok()).unwrap_or(60);
    let (mut random, mut most_um, mut stood) = (Seed::new(190), 0.0_f64, [0; 4]);
    for number in 0..cuts {
        let seed = random.below(seeds.len());
        let (cycles, borders) = &seeds[seed];
        let at = match number % 2 {
            0 => random.within(1..*cycles),
            _ => (borders[random.below(borders.len())] + random.within(0..5)).clamp(3, *cycles) - 2,
        };
        let cut = cut(&machine, &items, [seed as u64 + 1, at], random.below(2) * random.below(LOST + 1));
        if cut.known.is_complete() {
            let refused = planned(&machine, &items, &cut).expect_err("it is over");
            assert_eq!(refused, Refusal::Complete, "{}", cut.moment);
            continue;
        }
        let moment = cut.moment.clone();
        let (plan, [apart_um, ploughed_mm]) = go_on(&machine, &items, cut);
        assert!(ploughed_mm < 0.05, "{moment}: {ploughed_mm:.3} mm along in the thread, {:?}", plan.way);
        most_um = most_um.max(apart_um);
        stood[match plan.stands {
            Stands::InPass(_) => 0,
            Stands::OnRapid(_) => 1,
            Stands::OnContour(_) => 2,
            Stands::Above | Stands::AtRest => 3,
        }] += 1;
    }
    println!(
        "{cuts} cuts: in a pass, on a rapid, on a contour, at rest {stood:?}; {most_um:.3} um apart at most"
    );
    assert!(stood[0] > cuts / 4 && stood[1] > 0 && stood[2] > 0, "{stood:?}");
}

/// Two starts in a bore, a left-hand worm whose passes start as deep as they cut, corners that are rounded.
#[test]
fn examples_that_are_cut_are_finished_too() {
    let mut random = Seed::new(191);
    for name in ["internal-m30", "worm-left", "shaft"] {
        let machine = Machine::default();
        let text = std::fs::read_to_string(format!("../examples/{name}.ngc")).expect("an example");
        let items = compiled(&machine, &text);
        let (cycles, _) = borders(&machine, &items, 1);
        for _ in 0..3 {
            let at = random.within(1..cycles);
            let (plan, [apart_um, _]) = go_on(&machine, &items, cut(&machine, &items, [1, at], 0));
            println!("{name}, cycle {at}: {:?}, {apart_um:.3} um apart", plan.stands);
        }
    }
}

/// A state with nothing done, of a machine that stands at home.
fn at_home(machine: &Machine) -> (State, [Position; protocol::units::AXES]) {
    (State::nothing(), machine.home())
}

#[test]
fn what_does_not_fit_is_refused_by_its_name() {
    let machine = Machine::default();
    let items = compiled(&machine, PROGRAM);
    let refused = |machine: &Machine, state: State, here| {
        plan(machine, || items.iter().copied(), &state, &here).expect_err("it cannot be gone on with")
    };
    let (nothing, home) = at_home(&machine);
    let ended = State { machine: protocol::MachineState::Ended as u32, ..nothing };
    assert_eq!(refused(&machine, ended, home), Refusal::Complete);
    let beyond = State { step: 1 << 20, passes: 99, ..nothing };
    assert_eq!(refused(&machine, beyond, home), Refusal::OtherProgram);
    let cut_short = || items[..4].iter().copied();
    let few = State { step: 9, ..nothing };
    assert_eq!(plan(&machine, cut_short, &few, &home).expect_err("too few items"), Refusal::OtherProgram);
    let inconsistent = State { passes: 1, ..nothing };
    assert_eq!(refused(&machine, inconsistent, home), Refusal::OtherProgram);
    let other = State { passes: 1, open: 7, step: 1 << 10, ..nothing };
    assert_eq!(refused(&machine, other, home), Refusal::OtherPass { open: 7, next: 2 });
    let positioner = Machine::from_toml(machine::POSITIONER).expect("a positioner");
    assert_eq!(refused(&positioner, nothing, home), Refusal::Positioner);
    let tap = compiled(&machine, "G18 G21 G90 G8 G94 G97\nM3 S300\nG0 X0 Z5\nG33.1 Z-12 K1.5\nM5\nM2\n");
    let mut hole = [Position(0); protocol::units::AXES];
    hole[Axis::Z.index()] = Position::from_mm(-7.0);
    let open = State { open: 1, step: 3, ..nothing };
    let refused_tap = plan(&machine, || tap.iter().copied(), &open, &hole).expect_err("a tap in its hole");
    assert_eq!(refused_tap, Refusal::Tap { line: 4 });
    let mut moved = home;
    moved[Axis::X.index()] = Position::from_mm(-3.0);
    moved[Axis::Z.index()] = Position::from_mm(50.0);
    let text = refused(&machine, nothing, moved).to_string();
    assert!(text.contains("X -3.000") && text.contains("by hand"), "{text}");
}

/// Records of the journal are lost, and the tool stands behind a change: what the other tool did is not gone
/// back over by this one, which may be longer.
#[test]
fn what_another_tool_did_is_not_gone_back_over() {
    let machine = Machine::default();
    let items = compiled(&machine, PROGRAM);
    let (nothing, mut here) = at_home(&machine);
    // As far as it is known the contour of line 8 is in hand; measured is the rapid of the next tool.
    let step = items.iter().filter(|item| item.line < 8).map(Item::steps).sum();
    let known = State { step, ..nothing };
    here[Axis::X.index()] = Position::from_mm(11.5);
    here[Axis::Z.index()] = Position::from_mm(8.0);
    let plan = plan(&machine, || items.iter().copied(), &known, &here).expect("it goes on");
    assert_eq!((plan.stands, plan.modal.tool, plan.line), (Stands::OnRapid(14), Some(3), 15));
    let [way] = &plan.way[..] else { panic!("{:?}", plan.way) };
    let Code::Line { target, .. } = way.code else { panic!("{way:?}") };
    assert_eq!(target[Axis::X.index()].mm(), 11.0);
}

/// A dwell, a pause or a wait for an input that was broken off is not left out for the rapid behind it.
#[test]
fn what_was_waited_for_is_waited_for_again() {
    let machine = Machine::default();
    let text = "G18 G21 G90 G94\nG0 X20 Z20\nG4 P2\nG0 X10 Z10\nG4 P1\nG1 X9 F100\nM2\n";
    let items = compiled(&machine, text);
    let (cycles, _) = borders(&machine, &items, 1);
    let mut waited = 0;
    for at in (100..cycles).step_by(250) {
        let cut = cut(&machine, &items, [1, at], 0);
        let (line, moment) = (cut.known.line, cut.moment.clone());
        let Ok(plan) = planned(&machine, &items, &cut) else { continue };
        let left: Vec<u32> = rest(&plan, &items)
            .iter()
            .filter(|item| matches!(item.code, Code::Dwell { .. }))
            .map(|item| item.line)
            .collect();
        if matches!(line, 3 | 5) {
            assert!(left.contains(&line), "{moment}: {:?}", plan.way);
            waited += 1;
        }
    }
    assert!(waited > 10, "{waited}");
}

#[test]
fn a_speed_that_is_varied_is_varied_again() {
    let machine = Machine::default();
    let text = std::fs::read_to_string("../examples/varied.ngc").expect("an example");
    let items = compiled(&machine, &text);
    let cut = cut(&machine, &items, [1, 60_000], 0);
    assert!(cut.known.passes > 0, "{}", cut.moment);
    let plan = planned(&machine, &items, &cut).unwrap_or_else(|error| panic!("{}: {error}", cut.moment));
    assert!(
        plan.before.iter().any(|item| matches!(item.code, Code::Variation(Some(_)))),
        "{:?}",
        plan.before
    );
}

/// Cut all over a program of one pass, it is gone on with from its way, and from no place under it, X and Z
/// in mm; where it stood in the pass along an axis, mm.
fn stood_in_pass(machine: &Machine, text: &str, along: Axis, under: [[f64; 2]; 2]) -> Vec<f64> {
    let items = compiled(machine, text);
    let (cycles, _) = borders(machine, &items, 1);
    let mut stood = Vec::new();
    for at in (1..16).map(|share| cycles * share / 16) {
        let cut = cut(machine, &items, [1, at], 0);
        if cut.known.open != 1 {
            continue;
        }
        let here = cut.plant.measurement().axes.map(|axis| axis.position);
        let planned = |here: &PerAxis<Position>| plan(machine, || items.iter().copied(), &cut.known, here);
        let stands = |here: &PerAxis<Position>| planned(here).map(|plan| plan.stands);
        assert_eq!(stands(&here), Ok(Stands::InPass(1)), "{}", cut.moment);
        stood.push(here[along.index()].mm());
        for [x_mm, z_mm] in under {
            let mut under = here;
            (under[Axis::X.index()], under[Axis::Z.index()]) =
                (Position::from_mm(x_mm), Position::from_mm(z_mm));
            let refused = stands(&under);
            assert!(matches!(refused, Err(Refusal::Elsewhere { .. })), "{}: {refused:?}", cut.moment);
        }
        if stood.len() == 4 {
            go_on(machine, &items, cut);
        }
    }
    stood
}

/// A cylinder, a cone towards the axis, a cylinder again: the way of the pass is known in every section; so
/// it is along an arc on a face.
#[test]
fn a_pass_that_is_cut_in_any_section_is_gone_on_with() {
    let mut machine = Machine::default();
    let text = "G18 G21 G90 G7 G94 G97\nS300 M3\nG0 X36 Z8\nG0 X25\nG33 Z-12 K2\nG33 X17 Z-24 K2\nG33 Z-44 K2\n\
        G0 X36\nG0 Z8\nM5\nM2\n";
    // The first is as deep as the last section, where the cone is still far.
    let stood = stood_in_pass(&machine, text, Axis::Z, [[8.5, 0.0], [7.5, -35.0]]);
    let in_section = |from: f64, to: f64| stood.iter().any(|z| (to..from).contains(z));
    assert!(in_section(8.0, -12.0) && in_section(-12.0, -24.0) && in_section(-24.0, -44.0), "{stood:?}");

    machine.general.dialect = ProgramDialect::Fanuc;
    let text = "%\nO0003\nG21 G97 G99\nS300 M03\nG00 X24. Z5.\nG00 Z0.\nG36 X90. Z-4. R140. F4.\nG00 Z5.\n\
        G00 X24.\nM05\nM30\n%\n";
    let stood = stood_in_pass(&machine, text, Axis::X, [[13.0, -3.5], [44.0, -5.5]]);
    assert!(stood.len() > 3 && stood.iter().any(|x| *x > 38.0), "{stood:?}");
}
