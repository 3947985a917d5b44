//! A run that loses its power in any cycle, gone on with by new controls: the journal, the program and the
//! machine file are all that they know. Judged by the truth of the plant: the thread lies where it lay, all of
//! it is cut, and the tool goes through nothing on its way.

use machine::Machine;
use protocol::{Axis, Code, Item};
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

/// A tool in the groove that is moved along it by time, mm: what no way through a part may do.
#[derive(Default)]
struct Ploughed {
    z_mm: Option<f64>,
    mm: f64,
}

impl Ploughed {
    fn cycle(&mut self, record: &Record) {
        let [x, z] = [Axis::X, Axis::Z].map(|axis| record.truth.axes[axis.index()].slide_mm);
        let led = record.axes.iter().any(|(_, status)| status.state().is_in_pass());
        let within = x < CREST_MM - 0.05 && (THREAD_MM[0]..THREAD_MM[1]).contains(&z) && !led;
        let before = self.z_mm.replace(z).filter(|_| within);
        self.mm += before.map_or(0.0, |before| (z - before).abs());
    }
}

/// Runs to the end.
fn observed(machine: &Machine, items: Vec<Item>, plant: Plant) -> (Observation, Ploughed) {
    let (mut observer, mut ploughed) = (Observer::new(machine, &items), Ploughed::default());
    let mut rig = Rig::on_plant(machine, plant, items.into_iter(), Straight);
    for _ in 0..PATIENCE {
        let goes_on = rig.cycle(None, |record| {
            observer.cycle(record);
            ploughed.cycle(record);
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

fn cut(machine: &Machine, items: &[Item], seed: u64, at: u64) -> Cut {
    let mut rig = Rig::new(machine, items.iter().copied(), Scenario::none(), seed).expect("a rig");
    let mut keeper = Keeper::new(machine, Origin { seed, ..Origin::default() }, items);
    let (mut observer, mut known, mut moment) = (Observer::new(machine, items), None, String::new());
    for cycle in 0..at {
        rig.cycle(None, |record| {
            observer.cycle(record);
            known = keeper.cycle(record).or(known);
            if cycle + 1 == at {
                let states: Vec<&str> = record.axes.iter().map(|(_, status)| status.state().name()).collect();
                moment = format!("cycle {cycle}, line {}, {}", record.machine.line, states.join(" "));
            }
        });
    }
    let mut plant = rig.lose_power(|_| {});
    plant.switch_on(Scenario::none()).expect("the same machine");
    Cut { known: known.expect("the first cycle is written"), seen: observer.finish(), plant, moment }
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

/// Cuts one run in a cycle and goes on with it; the plan, and how far its passes lie from those before.
fn go_on(machine: &Machine, items: &[Item], seed: u64, at: u64) -> (Plan, f64) {
    let cut = cut(machine, items, seed, at);
    let what = format!("seed {seed}, {}", cut.moment);
    let plan = planned(machine, items, &cut).unwrap_or_else(|error| panic!("{what}: {error}"));
    let done = cut.seen.passes.iter().filter(|pass| pass.complete).count();
    assert!(plan.modal.passes as usize <= done, "{what}: pass {} is left out", done + 1);
    assert_eq!(plan.modal.passes, cut.known.passes, "{what}: what is known to be cut is not cut again");
    let passes = items.iter().filter(|item| matches!(item.code, Code::Pass(_))).count();
    let (seen, ploughed) = observed(machine, rest(&plan, items), cut.plant);
    assert_eq!((seen.outcome, &seen.faults[..]), (Outcome::Completed, &[][..]), "{what}: {:?}", plan.stands);
    assert_eq!(seen.passes.len(), passes - plan.modal.passes as usize, "{what}");
    assert!(ploughed.mm < 0.05, "{what}: the tool goes {:.3} mm along in the thread, {:?}", ploughed.mm, plan.way);
    let apart_um = apart_um(&cut.seen.passes, &seen.passes);
    assert!(apart_um <= SAME_GROOVE_UM, "{what}: {apart_um:.2} um from the groove");
    (plan, apart_um)
}

#[test]
fn a_run_that_is_cut_in_any_cycle_is_finished_in_its_groove() {
    let machine = Machine::default();
    let items = compiled(&machine, PROGRAM);
    let (whole, _) = observed(&machine, items.clone(), new_plant(&machine, 1));
    assert_eq!(whole.outcome, Outcome::Completed);
    let cuts = std::env::var("PITCHLOCK_CUTS").ok().and_then(|cuts| cuts.parse().ok()).unwrap_or(24);
    let (mut random, mut most_um, mut stood) = (Seed::new(190), 0.0_f64, [0; 4]);
    for _ in 0..cuts {
        let (seed, at) = (1 + random.within(0..10), random.within(1..whole.cycles));
        let (plan, apart_um) = go_on(&machine, &items, seed, at);
        most_um = most_um.max(apart_um);
        stood[match plan.stands {
            Stands::InPass(_) => 0,
            Stands::OnRapid(_) => 1,
            Stands::OnContour(_) => 2,
            Stands::AtRest => 3,
        }] += 1;
    }
    println!("{cuts} cuts: in a pass, on a rapid, on a contour, at rest {stood:?}; {most_um:.3} um apart at most");
    assert!(stood[0] > cuts / 8 && stood[1] > 0 && stood[2] > 0, "{stood:?}");
}
