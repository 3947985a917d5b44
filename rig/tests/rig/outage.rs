//! A machine whose controls and mains fail at once, and which is switched on again with new controls: nothing
//! moves meanwhile that is not braking, what they measure is what there is, and the thread lies where it lay.

use machine::Machine;
use protocol::{Axis, Code, Feed, Item, Position, Truth};
use rig::{
    Rig,
    observe::{Observer, Outcome, PassReport},
    wires::Straight,
};
use sim_plant::{Plant, Scenario};
use testing::Seed;

use crate::stand::compiled;

const PROGRAM: &str =
    "G18 G21 G90 G8 G94 G97\nM3 S600\nG0 X12 Z8\nG76 P2 Z-12 I-1 J0.3 K1.2 R1.5 Q29.5\nM5\nM2\n";

/// Runs machine code for so many cycles, or to its end.
fn run(rig: &mut Rig<impl Iterator<Item = Item>>, observer: &mut Observer, cycles: u64) {
    for _ in 0..cycles {
        if !rig.cycle(None, |record| observer.cycle(record)) {
            return;
        }
    }
}

fn observed(machine: &Machine, items: &[Item], plant: Plant) -> (Outcome, Vec<PassReport>, u64) {
    let mut observer = Observer::new(machine, items);
    let mut rig = Rig::on_plant(machine, plant, items.iter().copied(), Straight);
    run(&mut rig, &mut observer, 2_000_000);
    let seen = observer.finish();
    assert!(seen.faults.is_empty(), "{:?}", seen.faults);
    (seen.outcome, seen.passes, seen.cycles)
}

fn new_plant(machine: &Machine, seed: u64) -> Plant {
    Plant::new(machine, Scenario::none(), seed).expect("a plant")
}

/// A straight way for X alone, from where the axes are measured.
fn lifts(plant: &Plant, x_mm: f64) -> Item {
    let mut target = plant.measurement().axes.map(|axis| axis.position);
    target[Axis::X.index()] = Position::from_mm(x_mm);
    Item { line: 1, code: Code::Line { target, feed: Feed::Rapid } }
}

fn moved(before: &Truth, after: &Truth, axis: Axis) -> f64 {
    (after.axes[axis.index()].slide_mm - before.axes[axis.index()].slide_mm).abs()
}

#[test]
fn a_machine_that_is_switched_on_again_stands_where_it_stood() {
    let machine = Machine::default();
    let items = compiled(&machine, PROGRAM);
    for seed in 1..=4 {
        let (_, reference, cycles) = observed(&machine, &items, new_plant(&machine, seed));
        let mut random = Seed::of_case(seed);
        for _ in 0..3 {
            let at = random.within(1..cycles);
            let mut first =
                Rig::new(&machine, items.clone().into_iter(), Scenario::none(), seed).expect("a rig");
            let mut last = None;
            (0..at).for_each(|_| {
                first.cycle(None, |record| last = Some(*record.truth));
            });
            let mut last: Truth = last.expect("a cycle");
            let begun = last;
            let mut plant = first.lose_power(|truth| {
                // The cycle behind the last record is not shown: two at the highest speed are no jump.
                for axis in [Axis::X, Axis::Z] {
                    let most = 2.1 * machine.axis[&axis].velocity_mm_s * machine.general.cycle_s;
                    assert!(moved(&last, truth, axis) < most, "{axis} jumps in {at}");
                }
                last = *truth;
            });
            assert!(last.spindle_rpm.abs() < 0.01, "the spindle stands: {}", last.spindle_rpm);
            for (axis, most_mm) in [(Axis::X, 4.0), (Axis::Z, 6.0)] {
                assert!(
                    moved(&begun, &last, axis) < most_mm,
                    "{axis} brakes over {} mm",
                    moved(&begun, &last, axis)
                );
            }
            plant.switch_on(Scenario::none()).expect("it is the same machine");
            let again = *plant.truth();
            assert_eq!((again.cycle.0, again.spindle_deg), (0, last.spindle_deg));
            assert_eq!(again.axes.map(|axis| axis.slide_mm), last.axes.map(|axis| axis.slide_mm));
            assert_eq!((again.measurement.spindle_count, again.measurement.index_number), (0, 0));
            for (axis, _) in machine.axes() {
                let i = axis.index();
                let measured = [&again, &last].map(|truth| truth.measurement.axes[i].position);
                assert!(
                    (measured[0].mm() - measured[1].mm()).abs() < 1e-9,
                    "{axis}: the encoder is absolute"
                );
            }
            let mut second = vec![lifts(&plant, 12.0)];
            second.extend(&items);
            let (outcome, passes, _) = observed(&machine, &second, plant);
            assert_eq!((outcome, passes.len()), (Outcome::Completed, reference.len()));
            for (pass, before) in passes.iter().zip(&reference) {
                let off_um = pass.tool.phase_um - before.tool.phase_um;
                println!("seed {seed}, cut in {at}, pass {}: {off_um:.3} um", pass.pass);
                assert!(off_um.abs() < 1.5, "pass {} lies {off_um:.2} um off", pass.pass);
            }
        }
    }
}
