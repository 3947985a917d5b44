//! What a tool that stands in its groove while the spindle runs down does to the thread, told apart from
//! everything else: without it the gauge has nothing to say, in whatever cycle the power was lost.

use machine::Machine;
use protocol::{AxisState, Item};
use rig::{
    Rig,
    journal::{Keeper, Origin},
    observe::{GaugeAsked, Observation, Observer, Outcome, PartVerdict, ResumedReport},
    resume::plan,
    wires::Straight,
};
use sim_plant::Scenario;
use testing::Seed;

use crate::{resume::Ploughed, stand::compiled};

/// Turned, then threaded in few passes.
const PROGRAM: &str = "G18 G21 G90 G8 G94 G97\nT1\nM3 S800\nG0 X9.91 Z1\nG1 Z-16 F600\nG1 X12\nG0 Z8\n\
    T3\nM3 S900\nG0 X11 Z8\nG76 P2 Z-14 I-1.09 J0.8 K1.4845 R2 Q29.5 H1\nG0 X20\nM5\nM2\n";

/// More records than the journal of this program has.
const ALL: usize = 1 << 20;

fn gauged(machine: &Machine, items: &[Item]) -> Observer {
    let nominal = "M20x2-6g".parse().expect("a name");
    Observer::new(machine, items).with_gauge(GaugeAsked {
        nominal,
        origins_mm: Default::default(),
        passes: None,
    })
}

fn rig(machine: &Machine, items: &[Item]) -> Rig<impl Iterator<Item = Item>, Straight> {
    Rig::new(machine, items.iter().copied(), Scenario::none(), 1).expect("a rig")
}

/// A run that loses its power behind a cycle and is gone on with, by a journal without its last records; and
/// how far the tool was moved along in the thread, mm.
fn gone_on(machine: &Machine, items: &[Item], at: u64, older: usize) -> (Observation, f64) {
    let mut rig = rig(machine, items);
    let mut keeper = Keeper::new(machine, Origin { seed: 1, ..Origin::default() }, items);
    let (mut before, mut known) = (gauged(machine, items), Vec::new());
    for _ in 0..at {
        rig.cycle(None, |record| {
            before.cycle(record);
            known.extend(keeper.cycle(record));
        });
    }
    let mut plant = rig.lose_power(|truth| before.run_down(truth));
    plant.switch_on(Scenario::none()).expect("the same machine");
    let here = plant.measurement().axes.map(|axis| axis.position);
    let known = known[(known.len() - 1).saturating_sub(older % known.len())];
    let plan = plan(machine, || items.iter().copied(), &known, &here).expect("it is gone on with");
    let left = items.iter().skip(plan.modal.items as usize);
    let rest: Vec<Item> = plan.before.iter().chain(left).copied().collect();
    let mut observer = gauged(machine, &rest).going_on(before).resumed(ResumedReport::default());
    let mut rig = Rig::on_plant(machine, plant, rest.into_iter(), Straight);
    let mut ploughed = Ploughed::default();
    while rig.cycle(None, |record| {
        observer.cycle(record);
        ploughed.cycle(record);
    }) {}
    (observer.finish(), ploughed.mm)
}

/// However old the journal is: a tool in a groove is not taken for one that turns the crest beside it.
#[test]
fn nothing_but_rings_is_wrong_with_a_thread_that_lost_its_power() {
    let machine = Machine::default();
    let items = compiled(&machine, PROGRAM);
    let (mut cycles, mut in_pass, mut rig) = (0, [Vec::new(), Vec::new()], rig(&machine, &items));
    while rig.cycle(None, |record| {
        cycles += 1;
        let state = record.axes[0].1.state();
        if state.is_in_pass() {
            in_pass[usize::from(state == AxisState::RunOut)].push(cycles);
        }
    }) {}
    let (mut random, mut rings) = (Seed::new(190), 0);
    for number in 0..testing::count("PITCHLOCK_CUTS", 12) {
        let moments = &in_pass[usize::from(number % 3 != 0)];
        let at = moments[random.below(moments.len())];
        let older = if number % 2 == 0 { 0 } else { random.below(ALL) };
        let (seen, ploughed_mm) = gone_on(&machine, &items, at, older);
        let what = format!("cut behind cycle {at}, a journal without its last {older} records");
        assert_eq!((seen.outcome, &seen.faults[..]), (Outcome::Completed, &[][..]), "{what}");
        assert!(ploughed_mm < 0.05, "{what}: {ploughed_mm:.3} mm along in the thread");
        let (report, gauge) = (seen.resumed.expect("it goes on"), seen.gauge.expect("it is asked for"));
        let apart = report.gauge_without_rings.unwrap_or(gauge.verdict);
        assert_eq!(apart, PartVerdict::Good, "{what}: {:?} {:?}", report.rings, gauge.reasons);
        rings += report.rings.len();
    }
    assert!(rings > 0, "no tool stood in its groove");
}

/// A tool that stands so far in front of the face that its flanks do not reach it cuts no ring, and the
/// thread that is finished is good; nearer it cuts one, and that is told.
#[test]
fn a_tool_that_coasts_in_front_of_the_face_cuts_no_ring() {
    let machine = Machine::default();
    let items = compiled(&machine, PROGRAM);
    let mut told = [0; 2];
    for at in (8445..8645).step_by(25) {
        let (seen, _) = gone_on(&machine, &items, at, 0);
        let (report, gauge) = (seen.resumed.expect("it goes on"), seen.gauge.expect("it is asked for"));
        let is_good = gauge.verdict == PartVerdict::Good;
        assert_eq!(report.rings.is_empty(), is_good, "cycle {at}: {:?} {:?}", report.rings, gauge.reasons);
        told[usize::from(is_good)] += 1;
    }
    assert!(told[0] > 0 && told[1] > 1, "{told:?}");
}
