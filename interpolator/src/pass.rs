//! A pass that is next: whether it may be armed here and now; a pass in hand: what a tick finds. In: the
//! pass, where the axes rest, what they and the spindle say. Out: what to do about it in this tick.
//!
//! Nothing has moved when a pass is called off, whatever the moment. Tick n looks at the statuses of cycle n
//! − 1. While they say that no index has been seen, the index comes at cycle n at the earliest, and a frame
//! that calls the pass off is in force at n + K, with K control cycles to a tick. [`Machine::can_follow`]
//! proves that no axis moves so early, and every regulator gives a pass up until then, and none of them after
//! it.

use machine::Machine;
use protocol::{Axis, Cycle, Fault, Panel, PerAxis, Position, ThreadPass, Variation, frame::SETPOINT_LEAD};
use route::START_REACH_MM;

use crate::{
    axes::Axes,
    spindle::Spindle,
    task::{Back, Event, InHand, Task, Trouble, Wait, Way, Why},
};

/// Interpolator cycles from arming to the first index that counts: one for the way there, one for the status
/// to come back, one for calling off, one to spare.
const ARMING_TICKS: u64 = 4;

/// Ticks after which a status answers a frame: one for the way there, one for the way back.
const ANSWER_TICKS: u64 = 2;

/// The regulators have watched the spindle for so many periods of their observer before a pass: what they did
/// not know of its speed when they began is forgotten then.
const WATCHED_PERIODS: f64 = 10.0;

/// What becomes of a pass that is next.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant)] // lives on the stack for one tick
pub(crate) enum Ready {
    /// The axes have to be led there first: they are a little beside its start.
    Lead(PerAxis<Position>),
    /// Axes or spindle are not ready.
    Wait,
    /// It is armed.
    Arm(InHand),
}

/// What the machine is for a pass: what it can do, what its axes and its spindle say.
pub(crate) struct Stand<'a> {
    /// The machine.
    pub(crate) machine: &'a Machine,
    /// Commanded position of every axis.
    pub(crate) here: &'a PerAxis<Position>,
    /// What the axes say.
    pub(crate) axes: &'a Axes<'a>,
    /// The tick.
    pub(crate) cycle: Cycle,
    /// For how many ticks the axes have been told to rest.
    pub(crate) rested: u64,
    /// How the speed is varied in it.
    pub(crate) variation: Option<Variation>,
}

/// What becomes of a pass that is next. From here on the spindle keeps below its ceiling.
///
/// # Errors
/// The fault, if it cannot be cut from here.
pub(crate) fn prepare(pass: &ThreadPass, stand: &Stand, spindle: &mut Spindle) -> Result<Ready, Fault> {
    let Stand { machine, here, axes, cycle, rested, variation } = stand;
    let mut start = **here;
    machine.axes().for_each(|(axis, _)| start[axis.index()] = pass.axis(axis).start);
    let beside_mm = |axis: Axis| start[axis.index()].mm_from(here[axis.index()]).abs();
    if machine.axes().any(|(axis, _)| beside_mm(axis) > START_REACH_MM) {
        return Err(Fault::BadMachineCode);
    }
    if start != **here {
        return Ok(Ready::Lead(start));
    }
    if !machine.can_follow(pass) {
        return Err(Fault::PassNotFeasible);
    }
    if (pass.direction * pass.s_rpm - spindle.programmed()).abs() > 1e-9 * pass.s_rpm {
        return Err(Fault::BadMachineCode);
    }
    // The ceiling of this pass holds from here on, so that the spindle settles below it before arming. Under
    // a variation it is that at which its peaks are followed (M233).
    let ceiling = match variation.as_ref().filter(|_| !pass.returns()) {
        None => pass.max_ratio,
        Some(variation) => machine.varied(pass, variation).map_err(|_| Fault::PassNotFeasible)?.max_ratio,
    };
    spindle.set_ceiling(ceiling * 100.0);
    // A status tells of rest only when the last setpoint, which lies ahead, has been reached.
    let at_rest = *rested > SETPOINT_LEAD && axes.in_position();
    let watched_s = cycle.0 as f64 * machine.general.cycle_s;
    let watched = watched_s * machine.spindle.slowest_observer_hz() >= WATCHED_PERIODS;
    if !at_rest || !watched || !spindle.at_speed() || !spindle.is_known() {
        return Ok(Ready::Wait);
    }
    let not_before = cycle.after(ARMING_TICKS * machine.cycles_per_tick());
    Ok(Ready::Arm(InHand { pass: *pass, not_before }))
}

/// What a tick looks at while a pass is in hand.
pub(crate) struct Look<'a> {
    /// What the axes say.
    pub(crate) axes: &'a Axes<'a>,
    /// The tick, and the control cycles of a tick.
    pub(crate) cycle: Cycle,
    /// The same.
    pub(crate) tick: u64,
    /// The operator's panel.
    pub(crate) panel: &'a Panel,
    /// What cycle start had been pressed before this tick.
    pub(crate) cycle_starts: u32,
    /// The cycle in which every axis leaves if it is told so now.
    pub(crate) leave_at: Cycle,
    /// Nobody waits for the axes any longer.
    pub(crate) in_vain: bool,
    /// A tap that is at its start has been at its depth: it begins where it ends.
    pub(crate) returned: bool,
}

impl Look<'_> {
    fn presses(&self, button: u32) -> bool {
        self.panel.pressed(button)
    }

    /// Whether a button was pressed that makes axes leave. They look at the panel in every control cycle: a
    /// hold that was released since the tick before shows in cycle start alone.
    fn pressed(&self) -> bool {
        let released = self.panel.cycle_starts != self.cycle_starts;
        self.ends() || self.presses(Panel::FEED_HOLD) || released
    }

    fn ends(&self) -> bool {
        self.presses(Panel::STOP) || self.presses(Panel::ABORT)
    }

    /// Why an axis leaves that tells of no fault.
    fn why(&self) -> Why {
        let held =
            if self.presses(Panel::FEED_HOLD) { Back::Held } else { Back::CycleStart(self.cycle_starts) };
        if self.ends() { Why::Stopped } else { Why::Held(held) }
    }

    /// Whether a pass whose axes rest where it ends has been cut.
    fn is_cut(&self, pass: &ThreadPass) -> bool {
        self.axes.at_end_of(pass) && (self.returned || !pass.returns())
    }

    fn answered(&self, sent: Cycle) -> bool {
        self.cycle >= sent.after(ANSWER_TICKS * self.tick)
    }
}

/// What a pass in hand finds in a tick: `task` is one of those that have one.
pub(crate) fn watch(task: &Task, look: &Look) -> Event {
    let Look { axes, cycle, panel, .. } = look;
    match task {
        Task::Arming { sent, .. } if !look.answered(*sent) => Event::Nothing,
        Task::Arming { pass, .. } if axes.armed_with(pass.pass.pass) => Event::Armed,
        Task::Arming { pass, .. } => called_off(look, axes.unarmed(pass.pass.pass)),
        Task::Leaving { pass, why, way } => leaving(pass, *why, *way, look),
        _ if axes.leave() => Event::Leaves(look.why(), look.leave_at),
        Task::Armed(_) if axes.begun() => Event::Begun,
        Task::CallingOff { sent, .. } if look.answered(*sent) && axes.under_law() => Event::Begun,
        Task::Armed(pass) | Task::CallingOff { pass, .. } | Task::Cutting(pass) if axes.stream() => {
            let calling_off = matches!(task, Task::CallingOff { .. });
            match () {
                () if calling_off && axes.at_start_of(&pass.pass) => Event::CalledOff,
                () if look.is_cut(&pass.pass) => Event::Cut(Wait::behind_block(panel)),
                // They have left it within one tick.
                () if look.pressed() => Event::Leaves(look.why(), look.leave_at),
                () => called_off(look, None),
            }
        }
        Task::Armed(_) if look.presses(Panel::FEED_HOLD) || look.ends() => Event::TakenBack(*cycle),
        _ => Event::Nothing,
    }
}

fn called_off(look: &Look, axis: Option<Axis>) -> Event {
    let way = Way::Leave(look.leave_at);
    Event::Fault(Trouble { fault: Fault::PassCalledOff, axis, at_once: false, way })
}

/// What a tick finds on the way out of a pass.
fn leaving(pass: &InHand, why: Why, way: Way, look: &Look) -> Event {
    let axes = look.axes;
    match why {
        _ if way == Way::CallOff && (axes.under_law() || axes.leave()) => Event::Leaves(why, look.leave_at),
        _ if axes.stream() && axes.rest() && look.is_cut(&pass.pass) => {
            Event::Cut(Wait::behind_block(look.panel))
        }
        _ if axes.rest() || look.in_vain => Event::Left,
        Why::Held(back) if back.after(look.panel) != back => Event::Waiting(back.after(look.panel)),
        _ => Event::Nothing,
    }
}
