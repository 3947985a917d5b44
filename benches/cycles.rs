//! Control cycles per second of the whole machine in one process on one core: the modules and the plant
//! alone, and with the observer that measures and hashes every cycle, as `pitchlock run --in-process` has it.
//! A thread with its passes, a part with timed motion, and the plant by itself with its axes and its spindle
//! turning. And soak, which draws machines and programs and judges every cycle, beside such a run.
//!
//! criterion prints elements per second; an element is a control cycle. The real machine makes 2000 a second.
#![allow(missing_docs, clippy::unwrap_used)]

use std::hint::black_box;
use std::ops::Range;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use machine::Machine;
use protocol::{ControlWord, DriveCommand, Item, PerAxis, SpindleCommand};
use rig::{Rig, observe::Observer};
use sim_plant::{Plant, Scenario};

const PROGRAMS: [&str; 2] = ["examples/m20x2.ngc", "examples/shaft.ngc"];

/// Seeds of a soak that is timed.
const SEEDS: Range<u64> = 0..20;

/// Most cycles of a run that are timed.
const CYCLES: u64 = 40_000;

fn items(machine: &Machine, program: &str) -> Vec<Item> {
    let source = std::fs::read_to_string(program).unwrap();
    let check = interpreter::check(program, &source, machine);
    assert!(check.is_good());
    check.items
}

fn rig<'a>(machine: &Machine, items: &'a [Item]) -> Rig<impl Iterator<Item = Item> + use<'a>> {
    Rig::new(machine, items.iter().copied(), Scenario::none(), 1).unwrap()
}

/// Runs a machine for a while; how many cycles it made.
fn run(machine: &Machine, items: &[Item]) -> u64 {
    let mut rig = rig(machine, items);
    (1..=CYCLES)
        .find(|_| {
            !rig.cycle(None, |record| {
                black_box(record.truth.cycle);
            })
        })
        .unwrap_or(CYCLES)
}

/// The same, observed.
fn observed(machine: &Machine, items: &[Item]) -> u64 {
    let (mut rig, mut observer) = (rig(machine, items), Observer::new(machine, items));
    let cycles = (1..=CYCLES).find(|_| !rig.cycle(None, |record| observer.cycle(record))).unwrap_or(CYCLES);
    black_box(observer.finish());
    cycles
}

fn whole(criterion: &mut Criterion) {
    let machine = Machine::plain();
    for program in PROGRAMS {
        let items = items(&machine, program);
        let mut group = criterion.benchmark_group(program);
        group.sample_size(20).throughput(Throughput::Elements(run(&machine, &items)));
        group.bench_function("modules and plant", |bench| bench.iter(|| run(&machine, &items)));
        group.bench_function("observed", |bench| bench.iter(|| observed(&machine, &items)));
        group.finish();
    }
}

/// The plant with nobody but a hand that gives it speeds.
fn alone(machine: &Machine) -> f64 {
    let mut plant = Plant::new(machine, Scenario::none(), 1).unwrap();
    let spindle = SpindleCommand { rpm: 600.0, ..SpindleCommand::default() };
    let mut drives = PerAxis::<DriveCommand>::default();
    for cycle in 0..CYCLES {
        let measured = plant.measurement();
        for (drive, axis) in drives.iter_mut().zip(&measured.axes) {
            let word = axis.drive().towards_operation().unwrap_or(ControlWord::DisableVoltage);
            (drive.cycle, drive.control_word) = (measured.cycle, word as u32);
            drive.target_velocity_mm_s = if cycle / 1000 % 2 == 0 { 20.0 } else { -20.0 };
        }
        plant.tick(&drives, &spindle, None);
    }
    plant.truth().spindle_deg
}

fn plant(criterion: &mut Criterion) {
    let machine = Machine::plain();
    let mut group = criterion.benchmark_group("plant");
    group.sample_size(20).throughput(Throughput::Elements(CYCLES));
    group.bench_function("alone", |bench| bench.iter(|| alone(&machine)));
    group.finish();
}

/// Soak on one core and a run in one process, in turns. What a seed costs before it runs is counted.
fn soaked(criterion: &mut Criterion) {
    let machine = Machine::plain();
    let items = items(&machine, PROGRAMS[0]);
    let soak = || soak::driver::soak(SEEDS, 1, &|_, _, _| true).cycles;
    let mut group = criterion.benchmark_group("a core");
    group.sample_size(10);
    for turn in 1..=2 {
        group.throughput(Throughput::Elements(soak()));
        group.bench_function(format!("soak {turn}"), |bench| bench.iter(soak));
        group.throughput(Throughput::Elements(run(&machine, &items)));
        group.bench_function(format!("in one process {turn}"), |bench| {
            bench.iter(|| observed(&machine, &items));
        });
    }
    group.finish();
}

criterion_group!(benches, whole, plant, soaked);
criterion_main!(benches);
