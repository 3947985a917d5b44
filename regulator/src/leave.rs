//! How an axis leaves what it does: a pass, from wherever it is, or a stream. In: what makes it leave, the
//! state and motion of the axis. Out: the way, and what follows it.
//!
//! | axis | way | ends |
//! |---|---|---|
//! | the one that lifts the tool | timed: by (M99) to where the tool is clear | there |
//! | the same, where that would take it deeper than the pass goes | timed: first by (M100) to rest, then by (M99) | there |
//! | the same, so fast on its way to depth that it would go deeper than the pass | along the law, until it would not | as above |
//! | the same, where that would, too, on the law of a spindle that jams | timed: at once by (M101) to rest, then by (M99) | there |
//! | the same, on the way to a cone that rises | timed: first by (M100) to the speed at which it rises, then by (M99) | there |
//! | the same, where a cone of a chain begins that rises faster than it lifts | along the law, until it would not meet it | as above |
//! | the same, once its retract ends sooner anyway | along the law of the pass | at the end of the pass |
//! | every other one, in the run-in, if the lift is long, or nobody lifts, and it can come to rest in front of the part | timed: by (M100) | where it stands |
//! | every other one | along the law of the pass, on the helix, until the tool is measured free; then timed: by (M100) | where it stands |
//! | any, in a tap that has not moved yet | timed: where it stands | there |
//! | any, in a tap | along the law of the pass, in or out, as the spindle turns; timed: by (M100) once the spindle has stood for long | at the start of the pass, else where it stands |
//! | any, in timed motion | dry: by (M101) on the tangent, all axes in the same time | where it stands |
//!
//! The way out is a law of time: a spindle that stands, turns back, or whose encoder is dead does not keep
//! the tool in the part. No spindle changes its speed much meanwhile, so it is bounded in angle too. The
//! helix is followed by the angle, so that the groove stays what it is until the tool is out of it. Nothing
//! goes beyond the end of the pass: there every axis brakes by its law.

use motion::{Exit, Limits, Sample, SpindleMotion};
use protocol::{Cycle, Fault, Position};

use crate::reference::Reference;
use crate::state::{Pass, Stage, State};

/// An axis on the helix of a spindle that has stood for so long brakes where it is, s.
const STANDS_S: f64 = 0.1;
/// One on the helix of a spindle whose angle nobody has known for so long, too: the axis that lifts the tool
/// has left by then, or cannot.
const LOST_S: f64 = 0.5;
/// A tap is led on along the helix of a spindle that stands for so long, s: it may turn back yet, and who
/// turns it gives up before. Not behind an emergency stop or without mains.
const TAP_STANDS_S: f64 = 1.0;
/// A way out that goes deeper than the pass by more than this is not taken yet, mm.
const TOO_DEEP_MM: f64 = 0.02;
/// A way out that goes farther beyond where the tool is clear than this is not taken if there is another, mm.
const PAST_MM: f64 = 1.0;
/// A lift is long that is longer than a thread is deep, mm.
const LONG_MM: f64 = 5.0;
/// The retract of the pass is kept if its end comes no later than so many times a way out of its own.
const SOON: f64 = 1.2;
/// And if it asks for no more than so many times the highest acceleration.
const HARDER: f64 = 1.2;

/// What ends what an axis does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The axis cannot be led any more: it has no torque, or nobody knows where it is.
    Lost(Fault),
    /// It leaves, because of a fault or of the operator.
    Leave(Option<Fault>),
}

/// An axis that leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leaving {
    /// The pass it leaves; none in timed motion.
    pub pass: Option<Pass>,
    /// On which way.
    pub way: Way,
    /// What is latched when it is over.
    pub fault: Option<Fault>,
}

/// The way on which an axis leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // there is one of it, and it must not allocate
pub enum Way {
    /// On the law of the pass.
    Along(Stage),
    /// By a law of time.
    Timed {
        /// The law.
        exit: Exit,
        /// The cycle in which it begins.
        from: Cycle,
    },
    /// Behind the last setpoint of the stream.
    Dry,
}

/// The way out of a pass that has begun, from where the axis is, with so far to go for the tool until it is
/// free; nothing in any other state.
pub(crate) fn way_out(reference: &Reference, axis: usize, lift_mm: f64, limits: &Limits) -> Option<Way> {
    let State::InPass { pass, stage } = reference.state else { return None };
    match stage {
        Stage::Armed => Some(Way::Along(*stage)),
        Stage::WaitingForC0 if pass.returns() => {
            Some(Way::Timed { exit: Exit::stop(&reference.now(), limits), from: reference.cycle })
        }
        _ if pass.returns() => Some(Way::Along(*stage)),
        _ if pass.lifts(axis) => Some(lift(reference, pass, *stage, limits)),
        Stage::WaitingForC0 | Stage::RunIn if lift_mm > LONG_MM => {
            Some(in_front(reference, pass, limits).unwrap_or(Way::Along(*stage)))
        }
        _ => Some(Way::Along(*stage)),
    }
}

/// On the way to the part: the groove begins where the lead is reached, and who can stand before it does. A
/// cone that rises faster than the tool lifts would meet it.
fn in_front(reference: &Reference, pass: &Pass, limits: &Limits) -> Option<Way> {
    let exit = Exit::stop(&reference.now(), limits);
    let beyond = (exit.end() - pass.place(pass.law.locked_deg())) * pass.law.lead_mm.signum();
    (pass.law.lead_mm != 0.0 && beyond < 0.0).then_some(Way::Timed { exit, from: reference.cycle })
}

/// The way of the axis that lifts the tool.
fn lift(reference: &Reference, pass: &Pass, stage: Stage, limits: &Limits) -> Way {
    let now = reference.now();
    let turning = reference.spindle.since(pass, 0.0);
    let begins = matches!(stage, Stage::WaitingForC0 | Stage::RunIn);
    // A spindle that runs away drives a stroke harder than the axis may.
    let driven = pass.hardest(stage, 6.0 * reference.spindle.rpm().abs()) > HARDER * limits.a;
    let (exit, beyond_mm) = no_deeper(&now, pass, begins, !begins || driven, limits);
    if begins {
        // The law comes to rest at depth, whatever the speed of the spindle.
        if beyond_mm > TOO_DEEP_MM && turning.speed > 0.0 && stage == Stage::RunIn {
            return Way::Along(stage);
        }
        let rising = rising(&now, pass, turning.speed / pass.programmed_deg_s, limits);
        return Way::Timed { exit: rising.unwrap_or(exit), from: reference.cycle };
    }
    if pass.law.steepest_mm != 0.0 && meets(&exit, pass, &now, &turning) {
        return Way::Along(stage);
    }
    // And faster than it may.
    let fastest = now.v.abs().max((now.v + 0.5 * now.a * now.a.abs() / limits.j).abs());
    let soon = turns_in(pass.law.done_deg() - turning.angle, &turning) <= SOON * exit.duration()
        && fastest <= limits.v
        && !driven;
    match stage {
        Stage::Locked | Stage::RunOut if soon && pass.law.retract_mm != 0.0 => Way::Along(stage),
        _ => Way::Timed { exit, from: reference.cycle },
    }
}

/// Whether a chain rises into the way of a tool that lifts, before that is out of the groove, if the spindle
/// goes on as it does: the other axis goes on along the thread meanwhile.
fn meets(exit: &Exit, pass: &Pass, now: &Sample, turning: &SpindleMotion) -> bool {
    const LOOKS: u32 = 24;
    let into = (now.s - pass.out.clear.mm()).signum();
    let deeper = |s: f64, angle: f64| (s - pass.place(angle)) * into;
    let begins = deeper(now.s, turning.angle);
    let looks = (1..=LOOKS).map(|look| exit.duration() * f64::from(look) / f64::from(LOOKS));
    let tools = looks.map(|t| (exit.at(t).s, turning.angle + turning.speed.max(0.0) * t));
    let in_groove = tools
        .take_while(|(s, angle)| !pass.out.is_free(Position::from_mm(*s)) && *angle < pass.law.leaves_deg());
    in_groove.into_iter().any(|(s, angle)| deeper(s, angle) - begins > TOO_DEEP_MM)
}

/// In which time a spindle turns so far, degrees, if it goes on as it does, s: one that is being stopped may
/// never.
fn turns_in(deg: f64, turning: &SpindleMotion) -> f64 {
    let SpindleMotion { speed, acceleration, .. } = *turning;
    let then = speed * speed + 2.0 * acceleration.min(0.0) * deg.max(0.0);
    if speed > 0.0 && then >= 0.0 { 2.0 * deg / (speed + then.sqrt()) } else { f64::INFINITY }
}

/// On the way to a cone that rises: where Z cannot stand in front of it any more, the tool has to go up as
/// fast as it will.
fn rising(now: &Sample, pass: &Pass, ratio: f64, limits: &Limits) -> Option<Exit> {
    let v = ratio * pass.motion.at(pass.law.locked_deg()).v;
    let clear = pass.out.clear.mm();
    let rises = v * (clear - now.s) > 0.0 && now.v * v > 0.0;
    rises.then(|| Exit::by_speed(now, v.clamp(-limits.v, limits.v), clear, limits))
}

/// To where the tool is clear, and neither deeper nor far beyond. Turned round at once, a tool on its way to
/// depth, or that a spindle takes back, would go deeper than to come to rest first, and perhaps deeper than
/// the pass, or than it is: a cone may begin below where it ends. One that a spindle that runs away has
/// thrown out of the groove would go far beyond. `hard`: at once, whatever the jerk, if nothing else does.
/// And by how much it is too deep then, mm.
fn no_deeper(now: &Sample, pass: &Pass, begins: bool, hard: bool, limits: &Limits) -> (Exit, f64) {
    let clear = pass.out.clear.mm();
    let into = (now.s - clear).signum();
    let locked = pass.place(pass.law.locked_deg());
    let depth = if begins && (locked - now.s) * into > 0.0 { locked } else { now.s };
    let deeper = |exit: &Exit| (exit.farthest(into) - depth) * into;
    let past = |exit: &Exit| (clear - exit.farthest(-into)) * into - PAST_MM;
    let wrong = |exit: &Exit| deeper(exit).max(past(exit));
    let mut best = Exit::to(now, clear, limits);
    let better = |best: Exit, exit: Exit| if wrong(&exit) < wrong(&best) { exit } else { best };
    if wrong(&best) > 0.0 {
        best = better(best, Exit::by_rest(now, clear, limits));
    }
    if wrong(&best) > TOO_DEEP_MM && hard {
        best = better(best, Exit::by_sudden_rest(now, clear, limits));
    }
    (best, deeper(&best))
}

/// How an axis that follows the law of a pass it leaves goes on by time: the one that lifts the tool when its
/// retract gets slow, any other once the tool is out of the groove (`free`), or the spindle stands or is
/// lost; in a tap once the spindle has stood, `young` telling whether it leaves for fewer cycles yet, or is
/// taken to have been braked to rest. Where a spindle turns out to have jammed that was taken to turn on,
/// every axis goes from where it was led `last` to where it belongs.
pub(crate) fn brake(
    reference: &Reference,
    last: &Sample,
    axis: usize,
    free: bool,
    young: impl Fn(u64) -> bool,
    limits: &Limits,
) -> Option<Way> {
    let State::Leaving(Leaving { pass: Some(pass), way: Way::Along(stage), fault }) = reference.state else {
        return None;
    };
    if reference.spindle.is_back() {
        let exit = match pass.lifts(axis) {
            true => no_deeper(last, pass, false, true, limits).0,
            false => Exit::to(last, pass.place(reference.spindle.since(pass, 0.0).angle), limits),
        };
        return Some(Way::Timed { exit, from: Cycle(reference.cycle.0 - 1) });
    }
    if pass.lifts(axis) {
        // Along the law the stage goes on by itself.
        let way = lift(reference, pass, *stage, limits);
        return matches!(way, Way::Timed { .. }).then_some(way);
    }
    let cycles = |s: f64| (s / reference.cycle_s) as u64;
    let dead = matches!(fault, Some(Fault::EmergencyStop | Fault::PowerLost));
    let stands_s = if pass.returns() && !dead { TAP_STANDS_S } else { STANDS_S };
    let waits = pass.returns() && young(cycles(stands_s));
    let stood = reference.spindle.stands_for(cycles(stands_s)) && !waits;
    let lost = reference.spindle.is_lost_for(cycles(LOST_S)) && !pass.returns();
    let stands = stood || lost || pass.returns() && reference.spindle.has_coasted();
    if !(free && !pass.returns() || stands) {
        return None;
    }
    let exit = Exit::stop(&reference.now(), limits);
    // The law of the pass ends where it should, a brake that begins shortly before it does not.
    let beyond = (exit.end() - pass.law.end.mm()) * pass.law.lead_mm.signum() > 0.0;
    (stands || !beyond).then_some(Way::Timed { exit, from: reference.cycle })
}

/// Whether a timed way, or what is left of the stream, is over.
pub(crate) fn is_over(reference: &Reference) -> bool {
    match reference.state {
        State::Leaving(Leaving { way: Way::Timed { exit, from }, .. }) => {
            (reference.cycle.0 - from.0) as f64 * reference.cycle_s >= exit.duration()
        }
        State::Leaving(_) => reference.stream.rests(reference.cycle),
        _ => false,
    }
}

/// Where an axis rests that goes back from a pass, or from a way out of it, to the stream.
pub(crate) fn rest_of(state: &State) -> Option<Position> {
    match state {
        State::InPass { pass, stage: Stage::RunOut } => Some(pass.law.end),
        State::Leaving(Leaving { pass: Some(pass), way: Way::Along(_), .. }) => Some(pass.law.end),
        State::Leaving(Leaving { way: Way::Timed { exit, .. }, .. }) => Some(Position::from_mm(exit.end())),
        _ => None,
    }
}
