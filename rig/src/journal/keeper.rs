//! When there is something to write. In: every control cycle, of which only what the control itself said and
//! measured is kept; the passes of the program. Out: a [`State`] when an event came (a pass begins, goes on,
//! ends; the operator acts; a fault; a tool), and of mere progress at most every 0.25 s on the machine.

use std::collections::BTreeMap;

use machine::Machine;
use protocol::{
    Axis, AxisStatus, Code, Item, MachineState, MachineStatus, Measurement, Panel, PerAxis, Position,
};

use super::state::{ACTIONS, Act, Action, State};
use crate::observe::Record;

/// Progress is written at most so often, s on the machine.
const PROGRESS_S: f64 = 0.25;
/// Two places are the same, mm.
const SAME_MM: f64 = 0.001;

/// Which run it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Origin {
    /// Hash of all that decides what the program does.
    pub input: [u8; 16],
    /// Seed of the plant.
    pub seed: u64,
    /// Where in the program it began, in steps of progress.
    pub begun_at: u64,
    /// Steps of this run before it got there.
    pub before: u64,
    /// Passes of the program before that place.
    pub passes: u32,
}

/// Watches a run for what its journal has to know. Give it every control cycle in order.
#[derive(Clone, Debug)]
pub struct Keeper {
    run: Origin,
    /// Where each pass of the program ends, and where zero of the program lies in it.
    ends: BTreeMap<u32, PerAxis<Position>>,
    origins_mm: BTreeMap<u32, [f64; 2]>,
    /// Items taken when a pass was last in hand.
    taken: u64,
    every: u64,
    /// Knobs at the tick before: an action is one that has come to rest.
    knobs: [f64; 3],
    /// What is known, once anything was seen: changed where it lies, for it is long.
    state: State,
    seen: bool,
    written: Option<State>,
}

impl Keeper {
    /// A keeper of one run; of the program the passes are enough.
    pub fn new(machine: &Machine, run: Origin, program: &[Item]) -> Keeper {
        let passes = program.iter().filter_map(|item| match &item.code {
            Code::Pass(pass) => Some((pass.pass, pass.axes.map(|law| law.end))),
            _ => None,
        });
        Keeper {
            run,
            ends: passes.collect(),
            origins_mm: BTreeMap::new(),
            taken: 0,
            every: (PROGRESS_S / machine.general.cycle_s).round() as u64,
            knobs: [100.0; 3],
            state: State {
                input: run.input,
                seed: run.seed,
                step: run.begun_at,
                passes: run.passes,
                ..State::nothing()
            },
            seen: false,
            written: None,
        }
    }

    /// The same where it is known at which X and Z of the machine zero of the program lies in each pass, mm.
    #[must_use]
    pub fn lying_at(self, origins_mm: BTreeMap<u32, [f64; 2]>) -> Keeper {
        Keeper { origins_mm, ..self }
    }

    /// Takes one control cycle; what is to be written now, if anything.
    pub fn cycle(&mut self, record: &Record) -> Option<State> {
        // The rest of the control looks at the panel and at the statuses at its ticks as well.
        if record.machine.cycle != record.truth.cycle {
            return None;
        }
        self.take(record.machine, record.axes, &record.truth.measurement);
        let state = &self.state;
        let due = self.written.as_ref().is_none_or(|written| {
            is_event(written, state) || state.cycle - written.cycle >= self.every && differs(written, state)
        });
        due.then(|| *self.written.insert(self.state))
    }

    /// What is known last, at the end of a run.
    pub fn last(&self) -> Option<State> {
        self.seen.then_some(self.state)
    }

    fn take(&mut self, machine: &MachineStatus, axes: &[(Axis, AxisStatus)], measurement: &Measurement) {
        self.seen = true;
        let (panel, state) = (&measurement.panel, &mut self.state);
        // What was still to come is thrown away when a program is ended, and would count as taken.
        if machine.fault == 0 && machine.stopped == 0 && machine.state() != MachineState::Fault {
            state.step = state.step.max(self.run.begun_at + machine.taken.saturating_sub(self.run.before));
        }
        state.cycle = measurement.cycle.0;
        state.moves = machine.moves;
        state.spindle_count = measurement.spindle_count;
        state.index_count = measurement.index_count;
        state.index_number = measurement.index_number;
        state.spindle_rpm = machine.spindle_rpm;
        state.measured = measurement.axes.map(|axis| axis.position);
        state.overrides_pct = [panel.spindle_override_pct, panel.feed_override_pct, panel.rapid_override_pct];
        state.line = machine.line;
        state.pass = machine.pass;
        state.machine = machine.state;
        state.fault = machine.fault;
        state.stopped = u32::from(machine.stopped);
        state.tool = machine.tool;
        state.coolant = u32::from(machine.coolant);
        state.unreferenced = u32::from(machine.unreferenced);
        state.outputs = machine.outputs;
        state.analog = machine.analog;
        state.inputs = measurement.inputs;
        if let Some(origin_mm) = self.origins_mm.get(&machine.pass) {
            state.origin_mm = *origin_mm;
        }
        self.follow_pass(machine, axes);
        self.act(panel);
    }

    /// Whether a pass is armed, goes on, is cut to its end.
    fn follow_pass(&mut self, machine: &MachineStatus, axes: &[(Axis, AxisStatus)]) {
        let state = &mut self.state;
        for (axis, status) in axes {
            state.axes[axis.index()] = status.state as u8;
        }
        if let Some((_, status)) = axes.iter().find(|(_, status)| status.state().is_in_pass()) {
            (state.open, state.angle_deg) = (status.pass, status.angle_deg);
            self.taken = machine.taken;
            return;
        }
        let Some(end) = self.ends.get(&state.open) else { return };
        let off_mm = |(axis, status): &(Axis, AxisStatus)| status.commanded_mm - end[axis.index()].mm();
        let at_its_end = axes.iter().all(|own| off_mm(own).abs() < SAME_MM);
        // One that was left where the tool was nearly out is over, too: the program goes on behind it.
        let went_on = machine.taken > self.taken && machine.fault == 0 && machine.stopped == 0;
        if at_its_end || went_on {
            (state.open, state.passes) = (0, state.passes + 1);
        }
    }

    /// What the operator did since the tick before.
    fn act(&mut self, panel: &Panel) {
        let state = &mut self.state;
        let mut acts = [None; 5];
        let knobs = [Act::SpindleOverride, Act::FeedOverride, Act::RapidOverride];
        for (index, act) in knobs.into_iter().enumerate() {
            let now = state.overrides_pct[index];
            let rests = now == self.knobs[index];
            self.knobs[index] = now;
            if rests && now != state.rested_pct[index] {
                state.rested_pct[index] = now;
                acts[index] = Some((act, now));
            }
        }
        if panel.buttons != state.buttons {
            state.buttons = panel.buttons;
            acts[3] = Some((Act::Buttons, f64::from(panel.buttons)));
        }
        if panel.cycle_starts != state.cycle_starts {
            state.cycle_starts = panel.cycle_starts;
            acts[4] = Some((Act::CycleStart, f64::from(panel.cycle_starts)));
        }
        for (act, value) in acts.into_iter().flatten() {
            state.actions.rotate_left(1);
            state.actions[ACTIONS - 1] = Action { cycle: state.cycle, value, act: act as u32, reserved: 0 };
            state.acted += 1;
        }
    }
}

/// What is written at once.
fn is_event(written: &State, state: &State) -> bool {
    let of = |state: &State| {
        let State { open, passes, fault, stopped, tool, coolant, acted, axes, unreferenced, .. } = *state;
        (
            (open, passes, fault, stopped, tool, coolant, acted, axes),
            unreferenced,
            state.outputs,
            state.inputs,
        )
    };
    let over = |state: &State| state.machine == MachineState::Ended as u32;
    of(written) != of(state) || over(written) != over(state)
}

/// Whether there is anything new but the time.
fn differs(written: &State, state: &State) -> bool {
    State { cycle: 0, ..*written } != State { cycle: 0, ..*state }
}
