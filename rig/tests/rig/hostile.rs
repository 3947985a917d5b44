//! One hostile sample on one wire: a field that is no number, that is infinite, huge, negative, or anything,
//! under a right seal. Whatever it is, no module panics, no drive is told less than a number, nothing moves
//! faster or farther than it may, a run goes to an end, its own or that of a fault, and a fault has a name.

use std::{cell::Cell, rc::Rc};

use machine::Machine;
use protocol::{Axis, AxisFrame, AxisState, AxisStatus, Cycle, DriveCommand, FAULTS, Measurement};
use rig::{
    Exchange, Rig,
    observe::{Observer, Outcome},
    wires::{Disturbance, Message, Straight, Wire, Wires},
};
use sim_plant::Scenario;
use testing::{Seed, count};
use zerocopy::{FromBytes, IntoBytes};

use crate::stand::compiled;

/// A pass and timed motion.
const PROGRAM: &str =
    "G18 G21 G90 G8\nM3 S900\nG0 X12 Z12\nG0 X9\nG33 Z6 K1.5\nG0 X12\nG1 Z12 F3000\nM5\nM2\n";
/// Samples in a run of the tests; `PITCHLOCK_HOSTILE` asks for more.
const SAMPLES: u64 = 300;
/// The longest run: a spindle that does not stop is waited for.
const LONGEST: u64 = 400_000;

const WIRES: [Wire; 11] = [
    Wire::Code,
    Wire::TickMeasurement,
    Wire::Measurement(Axis::X),
    Wire::Measurement(Axis::Z),
    Wire::Frame(Axis::X),
    Wire::Frame(Axis::Z),
    Wire::Status(Axis::X),
    Wire::Status(Axis::Z),
    Wire::Spindle,
    Wire::Drive(Axis::X),
    Wire::Drive(Axis::Z),
];

/// Changes the first message on a wire from a cycle on.
struct Hostile {
    wire: Wire,
    from: u64,
    seed: Seed,
    sent: Rc<Cell<bool>>,
}

/// What stands in a field: words of eight bytes.
pub(crate) fn word(seed: &mut Seed) -> u64 {
    let values = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e308, -1e308, 1e-308, 1e6, -1.0, 0.0];
    match seed.below(values.len() + 5) {
        0 => u64::MAX,
        1 => i64::MIN as u64,
        2 => i64::MAX as u64,
        3 => seed.next(),
        4 => 1 << seed.below(64),
        at => values[at - 5].to_bits(),
    }
}

/// The bytes with a right seal, so that nobody takes them for damaged.
fn sealed(wire: Wire, bytes: &[u8]) -> Vec<u8> {
    let read = |what: &str| format!("{what} has its length");
    match wire {
        Wire::TickMeasurement | Wire::Measurement(_) => {
            let message = Measurement::read_from_bytes(bytes).unwrap_or_else(|_| panic!("{}", read("it")));
            message.sealed().as_bytes().to_vec()
        }
        Wire::Frame(_) => {
            let message = AxisFrame::read_from_bytes(bytes).unwrap_or_else(|_| panic!("{}", read("it")));
            message.sealed().as_bytes().to_vec()
        }
        Wire::Drive(_) => {
            let message = DriveCommand::read_from_bytes(bytes).unwrap_or_else(|_| panic!("{}", read("it")));
            message.sealed().as_bytes().to_vec()
        }
        _ => bytes.to_vec(),
    }
}

impl Disturbance for Hostile {
    fn carry<M: Message>(&mut self, wire: Wire, now: Cycle, sent: Option<M>) -> Option<M> {
        let message = sent?;
        if wire != self.wire || now.0 < self.from || self.sent.get() {
            return Some(message);
        }
        self.sent.set(true);
        let mut bytes = message.as_bytes().to_vec();
        // A packet of machine code has as many bytes as its item takes, and behind them nothing.
        let words = if wire == Wire::Code { 8 } else { bytes.len() / 8 };
        let at = 8 * self.seed.below(words);
        bytes[at..at + 8].copy_from_slice(&word(&mut self.seed).to_le_bytes());
        M::read_from_bytes(&sealed(wire, &bytes)).ok()
    }
}

/// How far beyond its travel an axis is commanded at most, and how far it is in truth, mm.
const BESIDE_MM: [f64; 2] = [0.001, 0.5];
/// How much faster it is commanded at most, for a law that is at its limit already.
const FASTER: f64 = 1.15;

/// What every control cycle has to keep. `before` are the statuses of the one before.
fn within_limits(machine: &Machine, exchange: &Exchange, before: &mut Vec<(Axis, AxisStatus)>, case: &str) {
    let record = &exchange.record;
    let cycle_s = machine.general.cycle_s;
    for (axis, config) in machine.axes() {
        let [low, high] = config.travel_mm;
        let true_mm = record.truth.axes[axis.index()].slide_mm;
        let beside_mm = (low - true_mm).max(true_mm - high);
        assert!(beside_mm <= BESIDE_MM[1], "{case}: {axis} is {beside_mm} mm beside its travel");
        let of =
            |all: &[(Axis, AxisStatus)]| all.iter().find(|(other, _)| *other == axis).map(|(_, own)| *own);
        let (Some(now), Some(before)) = (of(record.axes), of(before)) else { continue };
        // Before an axis follows anything, and in fault, commanded is where it is measured.
        let free = |status: &AxisStatus| matches!(status.state(), AxisState::Idle | AxisState::Fault);
        if free(&now) || free(&before) {
            continue;
        }
        let beside_mm = (low - now.commanded_mm).max(now.commanded_mm - high);
        assert!(beside_mm <= BESIDE_MM[0], "{case}: {axis} is commanded {beside_mm} mm beside its travel");
        let most_mm = FASTER * config.velocity_mm_s * cycle_s * (now.cycle.0 - before.cycle.0) as f64;
        let step_mm = (now.commanded_mm - before.commanded_mm).abs();
        assert!(step_mm <= most_mm, "{case}: {axis} is commanded {step_mm} mm in a cycle");
    }
    *before = record.axes.to_vec();
}

#[test]
fn one_hostile_sample_on_any_wire_breaks_nothing() {
    let machine = Machine::plain();
    let items = compiled(&machine, PROGRAM);
    let (mut reached, mut named) = (0, 0);
    let samples = count("PITCHLOCK_HOSTILE", SAMPLES);
    for number in 0..samples {
        let mut seed = Seed::of_case(number);
        let (wire, from) = (WIRES[seed.below(WIRES.len())], seed.within(0..3200));
        let sent = Rc::new(Cell::new(false));
        let hostile = Hostile { wire, from, seed, sent: Rc::clone(&sent) };
        let wires = Straight.with(hostile);
        let mut rig = Rig::with_wires(&machine, items.iter().copied(), Scenario::none(), 1, wires)
            .expect("the machine can be built");
        let mut observer = Observer::new(&machine, &items).in_brief();
        let case = format!("sample {number}, {wire:?} from cycle {from}");
        let (mut cycles, mut before) = (0, Vec::new());
        while rig.exchange(None, |exchange| {
            for drive in exchange.drives {
                let finite = drive.target_velocity_mm_s.is_finite() && drive.velocity_offset_mm_s.is_finite();
                let own = matches!(wire, Wire::Drive(_));
                assert!(finite || own, "{case}: {drive:?}");
            }
            let truth = &exchange.record.truth;
            assert!(truth.axes.iter().all(|axis| axis.motor_mm.is_finite()), "{case}: {:?}", truth.axes);
            within_limits(&machine, exchange, &mut before, &case);
            observer.cycle(&exchange.record);
        }) {
            cycles += 1;
            assert!(cycles < LONGEST, "{case}: no end");
        }
        let observation = observer.finish();
        let first = observation.faults.first();
        let known = |code: &str| FAULTS.iter().any(|row| row.fault.code() == code);
        assert!(first.is_none_or(|fault| known(&fault.code)), "{case}: {first:?}");
        let silent = observation.outcome == Outcome::Faulted && first.is_none();
        assert!(!silent, "{case}: a fault without a name");
        reached += u64::from(sent.get());
        named += u64::from(first.is_some());
    }
    assert!(reached > samples / 2, "only {reached} samples were sent");
    assert!(named > samples / 20, "only {named} of {reached} were worth a word");
}
