//! ns per tick of each module, and control cycles per second of the whole machine: in one process, and as
//! processes over iceoryx2. The real machine makes 2000 cycles a second.
//!
//! The modules replay what they were given in a run of `examples/m20x2.ngc`, from the start, so that a figure
//! is the mean over idling, timed motion and threads. criterion prints elements per second; an element is a
//! tick or a cycle.
#![allow(missing_docs, clippy::unwrap_used)]

use std::{hint::black_box, process::Command, time::Duration};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use interpolator::Interpolator;
use machine::Machine;
use protocol::{Axis, AxisFrame, AxisStatus, CodePacket, DriveCommand, Item, PerAxis, SpindleCommand, Truth};
use regulator::Regulator;
use rig::{Exchange, Rig, observe::Observer};
use sim_plant::{Plant, Scenario};

const PROGRAM: &str = "examples/m20x2.ngc";

/// Cycles that are replayed: the first moves and passes.
const CYCLES: usize = 40_000;

fn items(machine: &Machine) -> Vec<Item> {
    let source = std::fs::read_to_string(PROGRAM).unwrap();
    let check = interpreter::check(PROGRAM, &source, machine);
    assert!(check.is_good());
    check.items
}

/// What every module was given in one cycle.
struct Cycle {
    truth: Truth,
    frames: PerAxis<Option<AxisFrame>>,
    /// Of the cycle before.
    statuses: PerAxis<AxisStatus>,
    drives: PerAxis<DriveCommand>,
    spindle: SpindleCommand,
}

/// Runs the machine once and keeps what went between the modules.
fn record(machine: &Machine, items: &[Item]) -> Vec<Cycle> {
    let mut rig = Rig::new(machine, items.iter().copied(), Scenario::none(), 1).unwrap();
    let mut statuses = PerAxis::<AxisStatus>::default();
    let mut tape = Vec::with_capacity(CYCLES);
    for _ in 0..CYCLES {
        rig.exchange(None, |exchange| {
            let Exchange { record, frames, drives, spindle } = *exchange;
            tape.push(Cycle {
                truth: *record.truth,
                frames: *frames,
                statuses,
                drives: *drives,
                spindle: *spindle,
            });
            record.axes.iter().for_each(|(axis, status)| statuses[axis.index()] = *status);
        });
    }
    tape
}

/// An interpolator with as much of the program as it takes at once.
fn interpolator(machine: &Machine, items: &[Item]) -> Interpolator {
    let mut interpolator = Interpolator::new(machine);
    for (sequence, item) in (0..).zip(items) {
        if interpolator.wants() {
            interpolator.push(&CodePacket::pack(sequence, item)).unwrap();
        }
    }
    interpolator
}

fn modules(criterion: &mut Criterion) {
    let machine = Machine::plain();
    let items = items(&machine);
    let tape = record(&machine, &items);
    let mut group = criterion.benchmark_group("tick");
    group.throughput(Throughput::Elements(CYCLES as u64)).sample_size(20);
    for axis in [Axis::X, Axis::Z] {
        group.bench_function(format!("regulator-{}", axis.name()), |bench| {
            bench.iter(|| {
                let mut regulator = Regulator::new(&machine, axis);
                for cycle in &tape {
                    let frame = cycle.frames[axis.index()].as_ref();
                    let input = regulator::In { measurement: &cycle.truth.measurement, frame };
                    black_box(regulator.tick(&input));
                }
            });
        });
    }
    group.bench_function("sim-plant", |bench| {
        bench.iter(|| {
            let mut plant = Plant::new(&machine, Scenario::none(), 1).unwrap();
            for cycle in &tape {
                plant.tick(&cycle.drives, &cycle.spindle, None);
            }
            black_box(plant.truth().cycle)
        });
    });
    let ticks: Vec<&Cycle> = tape.iter().filter(|cycle| machine.is_tick(cycle.truth.cycle)).collect();
    group.throughput(Throughput::Elements(ticks.len() as u64));
    group.bench_function("interpolator", |bench| {
        bench.iter(|| {
            let mut interpolator = interpolator(&machine, &items);
            for cycle in &ticks {
                let input = interpolator::In { measurement: &cycle.truth.measurement, axes: &cycle.statuses };
                black_box(interpolator.tick(&input));
            }
        });
    });
    group.finish();
}

fn whole_machine(criterion: &mut Criterion) {
    let machine = Machine::plain();
    let items = items(&machine);
    let run = |observed: bool| {
        let mut rig = Rig::new(&machine, items.iter().copied(), Scenario::none(), 1).unwrap();
        let mut observer = Observer::new(&machine, &items);
        let mut cycles = 1;
        while rig.cycle(None, |record| {
            if observed {
                observer.cycle(record);
            }
        }) {
            cycles += 1;
        }
        black_box(observer.finish());
        cycles
    };
    let cycles = run(false);
    let mut group = criterion.benchmark_group("machine");
    group.throughput(Throughput::Elements(cycles)).sample_size(10);
    group.bench_function("rig", |bench| bench.iter(|| run(false)));
    group.bench_function("rig-observed", |bench| bench.iter(|| run(true)));
    group.bench_function("processes", |bench| {
        bench.iter_custom(|runs| (0..runs).map(|_| processes(cycles)).sum());
    });
    group.finish();
}

/// Time from the first cycle to the last of a run over iceoryx2, as `summary.json` has it.
fn processes(cycles: u64) -> Duration {
    let folder = tempfile::tempdir().unwrap();
    let out = Command::new(env!("CARGO_BIN_EXE_pitchlock"))
        .args(["run", PROGRAM, "--json", "--trace", "none", "--out"])
        .arg(folder.path())
        .output()
        .unwrap();
    let summary: rig::observe::Summary = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!(summary.cycles, cycles);
    Duration::from_secs_f64(summary.wall_s)
}

criterion_group!(benches, modules, whole_machine);
criterion_main!(benches);
