//! Hostile packets, one module at a time: each module as it was at a moment of a run gets one message with
//! fields that are no numbers, infinite, huge, negative or anything, and right ones behind it. It does not
//! panic, and what it says are numbers. Thousands of each packet in a run of the tests, and as many as one
//! likes by hand: no machine has to run for them.
//!
//! The same with a whole machine around it is `hostile`.

use interpolator::Interpolator;
use machine::Machine;
use protocol::{
    Arrival, Axis, AxisFrame, AxisStatus, CodePacket, Cycle, DriveCommand, Item, MachineStatus, Measurement,
    PerAxis, SpindleCommand, Truth, operator::OperatorRequest,
};
use regulator::Regulator;
use rig::{
    Exchange, Rig,
    observe::{Observer, Record},
    replay::{Arrivals, Collector},
    supervisor::Supervisor,
};
use sim_plant::{Plant, Scenario};
use testing::{Seed, count};
use zerocopy::{FromBytes, Immutable, IntoBytes};

use crate::hostile::word;
use crate::stand::compiled;

const PROGRAM: &str =
    "G18 G21 G90 G8\nM3 S900\nG0 X12 Z12\nG0 X9\nG33 Z6 K1.5\nG0 X12\nG1 Z12 F3000\nM5\nM2\n";
/// Of each packet in a run of the tests; `PITCHLOCK_PACKETS` asks for more.
const PACKETS: u64 = 10_000;
/// Moments of the run at which modules are taken, and right messages behind the hostile one, control cycles.
const MOMENTS: usize = 40;
const BEHIND: usize = 12;

/// What went between the modules in a cycle.
#[derive(Clone)]
struct Tape {
    truth: Truth,
    frames: PerAxis<Option<AxisFrame>>,
    /// Of the cycle before, and of this one.
    statuses: PerAxis<AxisStatus>,
    axes: Vec<(Axis, AxisStatus)>,
    status: MachineStatus,
    drives: PerAxis<DriveCommand>,
    spindle: SpindleCommand,
}

fn recorded(machine: &Machine, items: &[Item]) -> Vec<Tape> {
    let mut rig = Rig::new(machine, items.iter().copied(), Scenario::none(), 1).expect("a rig");
    let (mut statuses, mut tape) = (PerAxis::<AxisStatus>::default(), Vec::new());
    while rig.exchange(None, |exchange| {
        let Exchange { record, frames, drives, spindle } = *exchange;
        tape.push(Tape {
            truth: *record.truth,
            frames: *frames,
            statuses,
            axes: record.axes.to_vec(),
            status: *record.machine,
            drives: *drives,
            spindle: *spindle,
        });
        record.axes.iter().for_each(|(axis, status)| statuses[axis.index()] = *status);
    }) {}
    tape
}

/// The modules before a cycle.
#[derive(Clone)]
struct Moment {
    at: usize,
    regulators: [Regulator; 2],
    interpolator: Interpolator,
    plant: Plant,
    observer: Observer,
    supervisor: Supervisor,
}

fn moments(machine: &Machine, items: &[Item], tape: &[Tape]) -> Vec<Moment> {
    let mut interpolator = Interpolator::new(machine);
    for (sequence, item) in (0..).zip(items) {
        assert!(interpolator.wants() && interpolator.push(&CodePacket::pack(sequence, item)).is_ok());
    }
    let mut moment = Moment {
        at: 0,
        regulators: [Axis::X, Axis::Z].map(|axis| Regulator::new(machine, axis)),
        interpolator,
        plant: Plant::new(machine, Scenario::none(), 1).expect("a plant"),
        observer: Observer::new(machine, items),
        supervisor: Supervisor::new(machine, items),
    };
    // At ticks: there every module takes what it is sent.
    let tick = machine.cycles_per_tick() as usize;
    let every = (tape.len() - BEHIND - 1) / MOMENTS / tick * tick;
    let mut moments = Vec::new();
    for (at, cycle) in tape[..tape.len() - BEHIND].iter().enumerate() {
        if at % every == 0 && moments.len() < MOMENTS {
            moments.push(Moment { at, ..moment.clone() });
        }
        let [x, z] = &mut moment.regulators;
        regulate(x, cycle, Axis::X);
        regulate(z, cycle, Axis::Z);
        interpolate(&mut moment.interpolator, machine, cycle, at);
        moment.plant.tick(&cycle.drives, &cycle.spindle, None);
        watch(&mut moment.observer, &mut moment.supervisor, cycle);
    }
    moments
}

fn regulate(regulator: &mut Regulator, cycle: &Tape, axis: Axis) {
    let frame = cycle.frames[axis.index()].as_ref();
    let measurement = &cycle.truth.measurement.sealed();
    let drive = regulator.tick(&regulator::In { measurement, frame }).drive;
    let said = [drive.target_velocity_mm_s, drive.velocity_offset_mm_s, drive.torque_offset_nm];
    assert!(said.iter().all(|number| number.is_finite()), "{drive:?}");
}

fn interpolate(interpolator: &mut Interpolator, machine: &Machine, cycle: &Tape, at: usize) {
    if machine.is_tick(Cycle(at as u64)) || machine.is_tick(cycle.truth.cycle) {
        let input = interpolator::In { measurement: &cycle.truth.measurement, axes: &cycle.statuses };
        let refused = interpolator.tick(&input).map(|out| out.spindle.check());
        assert!(refused.is_none_or(|checked| checked.is_ok()), "{refused:?}");
    }
}

/// What the launcher does with what it is told.
fn watch(observer: &mut Observer, supervisor: &mut Supervisor, cycle: &Tape) {
    let record = Record { truth: &cycle.truth, axes: &cycle.axes, machine: &cycle.status };
    observer.cycle(&record);
    let _ = supervisor.cycle(&record);
}

/// A message with one to three words of something else in it.
fn spoilt<M: IntoBytes + FromBytes + Immutable>(message: &M, seed: &mut Seed) -> M {
    let mut bytes = message.as_bytes().to_vec();
    for _ in 0..seed.within(1..4) {
        let at = 8 * seed.below(bytes.len() / 8);
        bytes[at..at + 8].copy_from_slice(&word(seed).to_le_bytes());
    }
    M::read_from_bytes(&bytes).unwrap_or_else(|_| panic!("it has its length"))
}

/// Who gets which packet.
#[derive(Clone, Copy, Debug)]
enum Packet {
    Measurement,
    Frame,
    TickMeasurement,
    Status,
    Drive,
    Spindle,
    Operator,
    Truth,
    SeenStatus,
    SeenMachine,
    Arrival,
}

const ALL: [Packet; 11] = [
    Packet::Measurement,
    Packet::Frame,
    Packet::TickMeasurement,
    Packet::Status,
    Packet::Drive,
    Packet::Spindle,
    Packet::Operator,
    Packet::Truth,
    Packet::SeenStatus,
    Packet::SeenMachine,
    Packet::Arrival,
];

/// One hostile packet, and right ones behind it.
fn suffer(machine: &Machine, moment: &Moment, tape: &[Tape], packet: Packet, seed: &mut Seed) {
    let cycles = &tape[moment.at..moment.at + BEHIND];
    let mut first = cycles[0].clone();
    let which = seed.below(2);
    let name = [Axis::X, Axis::Z][which];
    let axis = name.index();
    let mut request = None;
    match packet {
        Packet::Measurement | Packet::TickMeasurement => {
            first.truth.measurement = spoilt::<Measurement>(&first.truth.measurement, seed).sealed();
        }
        Packet::Frame => {
            let frame = cycles.iter().find_map(|cycle| cycle.frames[axis]).unwrap_or_default();
            first.frames[axis] = Some(spoilt(&frame, seed).sealed());
        }
        Packet::Status => first.statuses[axis] = spoilt(&first.statuses[axis], seed),
        Packet::Drive => first.drives[axis] = spoilt(&first.drives[axis], seed).sealed(),
        Packet::Spindle => {
            let spindle = spoilt(&first.spindle, seed);
            // What is refused has not arrived.
            first.spindle = if spindle.check().is_ok() { spindle } else { first.spindle };
        }
        Packet::Operator => {
            let asked = OperatorRequest { kind: seed.below(14) as u32, ..OperatorRequest::default() };
            request = spoilt(&asked, seed).unpack().ok();
        }
        Packet::Truth => first.truth = spoilt(&first.truth, seed),
        Packet::SeenStatus => first.axes[which].1 = spoilt(&first.axes[which].1, seed),
        Packet::SeenMachine => first.status = spoilt(&first.status, seed),
        Packet::Arrival => {
            let mut collector = Collector::new(false, machine.cycles_per_tick());
            collector.take(&spoilt(&Arrival::default(), seed));
            let text = collector.finish().text();
            assert!(Arrivals::from_text(&text).is_ok(), "{text}");
            return;
        }
    }
    let cycles = std::iter::once(&first).chain(&cycles[1..]);
    match packet {
        Packet::Measurement | Packet::Frame => {
            let mut regulator = moment.regulators[which].clone();
            cycles.for_each(|cycle| regulate(&mut regulator, cycle, name));
        }
        Packet::TickMeasurement | Packet::Status => {
            let mut interpolator = moment.interpolator.clone();
            (moment.at..)
                .zip(cycles)
                .for_each(|(at, cycle)| interpolate(&mut interpolator, machine, cycle, at));
        }
        Packet::Drive | Packet::Spindle | Packet::Operator => {
            let mut plant = moment.plant.clone();
            for cycle in cycles {
                plant.tick(&cycle.drives, &cycle.spindle, request.take());
                let axes = plant.truth().axes;
                assert!(axes.iter().all(|axis| axis.motor_mm.is_finite()), "{axes:?}");
            }
        }
        _ => {
            let (mut observer, mut supervisor) = (moment.observer.clone(), moment.supervisor.clone());
            cycles.for_each(|cycle| watch(&mut observer, &mut supervisor, cycle));
        }
    }
}

/// Tells which packet is at work when a module panics.
struct Watched(Packet, u64);

impl Drop for Watched {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("{:?} {}", self.0, self.1);
        }
    }
}

#[test]
fn hostile_packets_of_every_kind_break_no_module() {
    let machine = Machine::plain();
    let items = compiled(&machine, PROGRAM);
    let tape = recorded(&machine, &items);
    let moments = moments(&machine, &items, &tape);
    assert_eq!(moments.len(), MOMENTS);
    let packets = count("PITCHLOCK_PACKETS", PACKETS);
    for packet in ALL {
        for number in 0..packets {
            let _watched = Watched(packet, number);
            let mut seed = Seed::of_case(number * ALL.len() as u64 + packet as u64);
            let moment = &moments[seed.below(moments.len())];
            suffer(&machine, moment, &tape, packet, &mut seed);
        }
    }
}
