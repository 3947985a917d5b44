//! The judge: sees the truth, knows the program, and asks nobody else. In: a machine, its machine code, the
//! events, what the case does undisturbed; every control cycle the [`Exchange`] between the modules. Out: the
//! first invariant that is broken.
//!
//! | invariant | says |
//! |---|---|
//! | `position-step`, `speed-change` | commanded: a step within V T, a change of speed within A T, in every state |
//! | `travel`, `speed`, `not-a-number` | commanded: within the travel, the speed of timed motion, finite |
//! | `bottom`, `flank` | a tool in the material is in its groove, as long as X, or Z, has torque |
//! | `let-go` | no axis gives up its torque while the tool touches, unless an event takes it |
//! | `leaves` | what makes the axes leave has taken the tool out of the material in a bounded time |
//! | `ring` | a tool that cannot leave stands still against the part in so many turns |
//! | `goes-on` | in timed motion, no axis goes on without one that has lost its torque |
//! | `stops` | in timed motion, every axis stands once somebody has told it to |
//! | `twice` | no item is executed twice |
//! | `moves-after-end` | the end is the end |
//! | `no-end`, `no-rest` | every run ends in a bounded time, and then nothing moves |
//! | `in-the-part` | at the end the tool is out of the material, unless an event has taken the torque of X |
//! | `untrue`, `broken-off` | the summary says what happened; only a stop stops, only a fault faults |

pub(crate) mod bounds;
pub(crate) mod excuse;
mod finish;
mod frame;
mod groove;
mod leaves;
mod limits;
mod rest;
pub mod stock;
mod tool;
mod torque;

use std::collections::BTreeMap;

use machine::Machine;
use protocol::{Axis, AxisState, DriveState, MachineState, ThreadPass};
use rig::Exchange;

use crate::case::Ready;
use crate::event::{Event, Trouble, What};
pub use finish::Ending;
use frame::Frame;
use limits::Limits;
use rest::Rest;
use stock::PassStock;
use tool::Tool;

/// After the end a position is the same within ten nanometres, counts of 1e-9 mm: laws end with rounded
/// tails.
const STILL: i64 = 10_000;

/// An invariant that did not hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Broken {
    /// Its name.
    pub invariant: &'static str,
    /// The first cycle in which it did not hold.
    pub cycle: u64,
    /// What was seen.
    pub text: String,
}

impl Broken {
    pub(crate) fn new(invariant: &'static str, cycle: u64, text: String) -> Broken {
        Broken { invariant, cycle, text }
    }
}

/// What a case does when nothing happens.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reference {
    /// How long it takes, control cycles.
    pub cycles: u64,
    /// Turns of the spindle.
    pub turns: f64,
    /// Timed moves, and steps of machine code.
    pub moves: u64,
    /// Steps of progress.
    pub taken: u64,
    /// Cycle of the last of them: what follows is the spindle that runs down.
    pub worked: u64,
    /// Where the axes are led in the end, mm.
    pub end_mm: Vec<f64>,
    /// Where their slides truly are then, mm.
    pub slides_mm: Vec<f64>,
    /// Cycles in which an axis, or the machine, goes from one state to another.
    pub borders: Vec<u64>,
    /// What the servo does in each pass: by how much the tool is too deep, and beside the groove, mm.
    pub servo: BTreeMap<u32, (f64, f64)>,
}

/// What a judge knows of a case.
#[derive(Clone)]
pub(crate) struct Known<'a> {
    pub(crate) machine: &'a Machine,
    /// Tangent of the half angle of the flank.
    pub(crate) tan_flank: f64,
    pub(crate) passes: BTreeMap<u32, (ThreadPass, Option<PassStock>)>,
    pub(crate) events: &'a [Event],
    pub(crate) reference: Option<&'a Reference>,
}

impl Known<'_> {
    /// Whether a force of the case has only just let go, or still holds, or an encoder has jumped: a slide
    /// swings then.
    fn pushed(&self, now: u64) -> bool {
        let swings = (0.1 / self.machine.general.cycle_s) as u64;
        self.events.iter().any(|event| match event.what {
            What::Plant(Trouble::Force(_, _, s) | Trouble::Spike(_, _, s)) => {
                let until = event.at + (s / self.machine.general.cycle_s) as u64 + swings;
                (event.at..until).contains(&now)
            }
            What::Plant(Trouble::Jump(..)) => (event.at..event.at + swings).contains(&now),
            _ => false,
        })
    }
}

/// Judges one run.
#[derive(Clone)]
pub struct Judge<'a> {
    known: Known<'a>,
    limits: Limits,
    tool: Tool,
    rest: Rest,
    measured: Reference,
    states: Vec<u32>,
    ended: Option<Vec<i64>>,
    /// First cycle in which somebody said that something is wrong.
    reacted: Option<u64>,
    broken: Option<Broken>,
    turns_from: Option<f64>,
}

impl<'a> Judge<'a> {
    /// A judge before cycle 0. Without a reference it measures one.
    pub fn new(ready: &'a Ready, events: &'a [Event], reference: Option<&'a Reference>) -> Judge<'a> {
        let mut passes: BTreeMap<u32, (ThreadPass, Option<PassStock>)> =
            ready.passes().map(|pass| (pass.pass, (*pass, PassStock::of(pass)))).collect();
        let faces: Vec<_> = passes.values().filter_map(|(_, stock)| Some(stock.as_ref()?.face())).collect();
        for stock in passes.values_mut().filter_map(|(_, stock)| stock.as_mut()) {
            faces.iter().for_each(|face| stock.begins(*face));
        }
        let machine = &ready.machine;
        let tan_flank = libm::tan(machine.threading.flank_half_angle_deg.to_radians());
        Judge {
            known: Known { machine, tan_flank, passes, events, reference },
            limits: Limits::default(),
            tool: Tool::new(machine),
            rest: Rest::default(),
            measured: Reference::default(),
            states: Vec::new(),
            ended: None,
            reacted: None,
            broken: None,
            turns_from: None,
        }
    }

    /// The same judge who is told what will happen from here on, and what the case does undisturbed.
    pub(crate) fn told(self, events: &'a [Event], reference: &'a Reference) -> Judge<'a> {
        Judge { known: Known { events, reference: Some(reference), ..self.known }, ..self }
    }

    /// One control cycle; every one, in order.
    pub fn cycle(&mut self, exchange: &Exchange) {
        let record = &exchange.record;
        let now = record.truth.cycle.0;
        self.measure(exchange);
        let limits = self.limits.cycle(&self.known, record);
        let tool = self.tool.cycle(&self.known, exchange, &mut self.measured.servo);
        let later = self.after_end(exchange);
        let rest = self.rest.cycle(&self.known, exchange);
        for broken in [limits, tool, later, rest].into_iter().flatten() {
            self.broken.get_or_insert(broken);
        }
        let from = self.known.events.first().map_or(u64::MAX, |event| event.at);
        if self.reacted.is_none() && now >= from && is_reaction(exchange) {
            self.reacted = Some(now);
        }
    }

    /// The first invariant that was broken so far.
    pub fn broken(&self) -> Option<&Broken> {
        self.broken.as_ref()
    }

    /// Cycles from the first event to the first word about it.
    pub fn reacted_after(&self) -> Option<u64> {
        Some(self.reacted? - self.known.events.first()?.at)
    }

    /// What was measured, of an undisturbed run.
    pub fn reference(self) -> Reference {
        self.measured
    }

    fn measure(&mut self, exchange: &Exchange) {
        let record = &exchange.record;
        let states = record.axes.iter().map(|(_, status)| status.state).chain([record.machine.state]);
        if !states.clone().eq(self.states.iter().copied()) {
            self.measured.borders.push(record.truth.cycle.0);
            self.states.clear();
            self.states.extend(states);
        }
        let from = *self.turns_from.get_or_insert(record.truth.spindle_deg);
        let measured = &mut self.measured;
        measured.cycles = record.truth.cycle.0 + 1;
        measured.turns = measured.turns.max((record.truth.spindle_deg - from).abs() / 360.0);
        let worked = (record.machine.moves, record.machine.taken);
        if worked != (measured.moves, measured.taken) {
            measured.worked = record.truth.cycle.0;
        }
        (measured.moves, measured.taken) = worked;
        measured.end_mm.clear();
        measured.end_mm.extend(record.axes.iter().map(|(_, status)| status.commanded_mm));
        let slides = record.axes.iter().map(|(axis, _)| record.truth.axes[axis.index()].slide_mm);
        measured.slides_mm.clear();
        measured.slides_mm.extend(slides);
    }

    /// After the end of the program nothing is commanded any more.
    fn after_end(&mut self, exchange: &Exchange) -> Option<Broken> {
        let record = &exchange.record;
        let follows = record.axes.iter().all(|(_, status)| status.state() == AxisState::Streaming);
        if record.machine.state() != MachineState::Ended || !follows {
            self.ended = None;
            return None;
        }
        let counts = record.axes.iter().map(|(_, status)| (1e9 * status.commanded_mm).round() as i64);
        let before = self.ended.get_or_insert_with(|| counts.clone().collect());
        let moved = before.iter().zip(counts.clone()).any(|(before, now)| (before - now).abs() > STILL);
        moved.then(|| {
            let counts: Vec<i64> = counts.collect();
            Broken::new(
                "moves-after-end",
                record.truth.cycle.0,
                format!("from {before:?} to {counts:?} (1e-9 mm)"),
            )
        })
    }
}

/// Whether anybody says that something is wrong, or leaves.
fn is_reaction(exchange: &Exchange) -> bool {
    let record = &exchange.record;
    let axis = |status: &protocol::AxisStatus| {
        status.fault != 0
            || status.refused != 0
            || status.encoder_counts != 0
            || matches!(status.state(), AxisState::Leaving | AxisState::Fault)
    };
    record.machine.fault != 0 || record.axes.iter().any(|(_, status)| axis(status))
}

/// Whether the drive of an axis does what its regulator says.
pub(crate) fn is_led(exchange: &Exchange, axis: Axis) -> bool {
    let drive = exchange.record.truth.measurement.axes[axis.index()].drive();
    drive.state() == Some(DriveState::OperationEnabled)
}
