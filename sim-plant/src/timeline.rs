//! The scenario being played: which event is due, and what it does to the panel and to the cut. In: once a
//! control cycle, the cycle, the true Z in mm, the true angle of the spindle in degrees, the index, and the
//! tags of the program. Out: the panel, the load of the spindle in N·m, the forces on the slides in N, what
//! is wrong with the spindle encoder, what else is broken, what whoever runs the machine is to do. What an
//! event does to the panel and what it orders is there in the cycle in which it is due, the rest in the next.

use protocol::operator::Request;
use protocol::{Cycle, Panel, SpindleCommand};

use crate::breakages::Breakages;
use crate::drive::Trip;
use crate::encoder::Disturbance;
use crate::orders::{Order, Orders};
use crate::ramped::Ramped;
use crate::scenario::{Action, Burden, Event, Knob, Scenario, Trigger};

/// How long the program waits for cycle start if nobody will press it, s.
const UNATTENDED_S: f64 = 1.0;

/// What triggers look at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment {
    pub(crate) cycle: Cycle,
    pub(crate) z_mm: f64,
    pub(crate) spindle_deg: f64,
    pub(crate) spindle_rpm: f64,
    /// True angle of the last index, degrees, and the first cycle that showed it; `None` before the first.
    pub(crate) index: Option<(f64, Cycle)>,
}

/// The pass in hand, and where its angle counts from.
#[derive(Clone, Copy, Debug, Default)]
struct PassInHand {
    pass: u32,
    index_not_before: Cycle,
    origin_deg: Option<f64>,
}

/// A scenario and how far it got.
#[derive(Clone, Debug)]
pub(crate) struct Timeline {
    events: Vec<Event>,
    due: Vec<bool>,
    /// A person stands at the panel.
    attended: bool,
    pub(crate) cycle_s: f64,
    rise_cycles: f64,
    knobs: [Ramped; 3],
    /// Buttons; its overrides mean nothing.
    pressed: Panel,
    /// Cycles for which nobody has confirmed the jog key.
    silent: u64,
    /// Cycles for which the program has waited for cycle start with nobody to press it.
    unattended: u64,
    burdens: [Ramped; 3],
    burden_until: [Option<u64>; 3],
    encoder: Disturbance,
    breakages: Breakages,
    orders: Orders,
    pass: PassInHand,
    z_before: f64,
    /// The inputs that there are, and those that are on, bit by bit; and what becomes of them later: when,
    /// which, on or off.
    known_inputs: u64,
    inputs: u64,
    later: Vec<(Cycle, u8, bool)>,
}

impl Timeline {
    /// Nothing happens.
    pub(crate) fn new(cycle_s: f64, rise_s: f64, z_mm: f64) -> Timeline {
        Timeline {
            due: Vec::new(),
            attended: false,
            encoder: Disturbance::none(),
            breakages: Breakages::default(),
            orders: Orders::none(),
            events: Vec::new(),
            cycle_s,
            rise_cycles: rise_s / cycle_s,
            knobs: [Ramped::at(100.0); 3],
            pressed: Panel::default(),
            unattended: 0,
            silent: 0,
            burdens: [Ramped::at(0.0); 3],
            burden_until: [None; 3],
            pass: PassInHand::default(),
            z_before: z_mm,
            known_inputs: 0,
            inputs: 0,
            later: Vec::new(),
        }
    }

    /// These events happen; so far there were none.
    pub(crate) fn play(&mut self, scenario: Scenario) {
        self.events = scenario.events;
        self.attended = scenario.attended;
        self.due = vec![true; self.events.len()];
        self.encoder.make_room(self.events.len());
        self.orders.make_room(self.events.len());
        self.later = Vec::with_capacity(self.events.len());
    }

    /// The mains fail, and nobody does anything any more.
    pub(crate) fn lose_power(&mut self) {
        self.events.clear();
        self.due.clear();
        self.pressed.press(Panel::POWER_LOST, true);
    }

    /// The machine is switched on again: knobs and inputs are as they were left, buttons are released, and
    /// what was broken is mended.
    pub(crate) fn switch_on(&mut self) {
        *self = Timeline {
            knobs: self.knobs.map(|knob| Ramped::at(knob.value())),
            known_inputs: self.known_inputs,
            inputs: self.inputs,
            rise_cycles: self.rise_cycles,
            ..Timeline::new(self.cycle_s, 0.0, self.z_before)
        };
    }

    /// Numbers, from 1, of the events that did not happen yet.
    pub(crate) fn pending(&self) -> impl Iterator<Item = usize> {
        self.due.iter().enumerate().filter(|(_, due)| **due).map(|(index, _)| index + 1)
    }

    /// The panel as it stands.
    pub(crate) fn panel(&self) -> Panel {
        let [spindle, feed, rapid] = &self.knobs;
        Panel {
            spindle_override_pct: spindle.value(),
            feed_override_pct: feed.value(),
            rapid_override_pct: rapid.value(),
            ..self.pressed
        }
    }

    /// There are these inputs, and these of them are on before anything happens, bit by bit.
    pub(crate) fn begin_inputs(&mut self, known: u64, on: u64) {
        (self.known_inputs, self.inputs) = (known, on);
    }

    /// The inputs that there are, bit by bit.
    pub(crate) fn known_inputs(&self) -> u64 {
        self.known_inputs
    }

    /// The inputs that are on, bit by bit.
    pub(crate) fn inputs(&self) -> u64 {
        self.inputs
    }

    /// Inputs change whose time has come.
    fn change_inputs(&mut self, now: Cycle) {
        let inputs = &mut self.inputs;
        self.later.retain(|(due, number, on)| {
            let bit = 1 << u32::from(*number);
            if *due <= now {
                *inputs = if *on { *inputs | bit } else { *inputs & !bit };
            }
            *due > now
        });
    }

    /// Torque that holds the spindle back, N·m; force on the slide of Z, of X, N.
    pub(crate) fn burdens(&self) -> [f64; 3] {
        self.burdens.map(|burden| burden.value())
    }

    /// What is wrong with the spindle encoder.
    pub(crate) fn encoder(&mut self) -> &mut Disturbance {
        &mut self.encoder
    }

    /// What else is broken.
    pub(crate) fn breakages(&mut self) -> &mut Breakages {
        &mut self.breakages
    }

    /// What whoever runs the machine is to do in the present cycle.
    pub(crate) fn order(&self) -> Option<Order> {
        self.orders.now()
    }

    /// Whoever stands at the machine does something at the panel.
    pub(crate) fn operate(&mut self, request: Request) {
        match request {
            Request::SpindleOverride(pct) => self.knobs[Knob::Spindle as usize].go(pct, 0.0),
            Request::FeedOverride(pct) => self.knobs[Knob::Feed as usize].go(pct, 0.0),
            Request::RapidOverride(pct) => self.knobs[Knob::Rapid as usize].go(pct, 0.0),
            Request::FeedHold => self.pressed.press(Panel::FEED_HOLD, true),
            Request::CycleStart => self.pressed.start_cycle(),
            Request::Stop => self.pressed.press(Panel::STOP, true),
            Request::SingleBlock(on) => self.pressed.press(Panel::SINGLE_BLOCK, on),
            Request::OptionalStop(on) => self.pressed.press(Panel::PASSES_M1, !on),
            Request::Abort => self.pressed.press(Panel::ABORT, true),
            Request::EmergencyStop => self.pressed.press(Panel::EMERGENCY_STOP, true),
            Request::Jog(on) => {
                self.pressed.press(Panel::JOG, on);
                self.silent = 0;
            }
            Request::Block => self.pressed.press(Panel::BLOCK, !self.pressed.pressed(Panel::BLOCK)),
        }
    }

    /// One control cycle.
    pub(crate) fn advance(&mut self, moment: &Moment, tags: &SpindleCommand) {
        let pass_before = self.pass.pass;
        self.follow_pass(moment, tags);
        self.encoder.advance(moment.cycle.0 + 1);
        self.breakages.advance(moment.cycle.0);
        for index in 0..self.events.len() {
            let Event { trigger, action } = self.events[index];
            if self.due[index] && self.fires(trigger, pass_before, moment, tags) {
                self.due[index] = false;
                self.act(action, moment);
            }
        }
        self.let_go();
        self.change_inputs(moment.cycle);
        self.orders.advance(moment.cycle.0);
        self.attend(tags);
        self.z_before = moment.z_mm;
        self.knobs.iter_mut().for_each(Ramped::advance);
        for (burden, until) in self.burdens.iter_mut().zip(&mut self.burden_until) {
            if until.is_some_and(|until| moment.cycle.0 >= until) {
                *until = None;
                burden.go(0.0, self.rise_cycles);
            }
            burden.advance();
        }
    }

    /// A jog key that nobody confirms is let go.
    fn let_go(&mut self) {
        self.silent += 1;
        if self.silent > (Panel::JOG_SILENT_S / self.cycle_s).round() as u64 {
            self.pressed.press(Panel::JOG, false);
        }
    }

    /// Nobody stands at a simulated machine: a pause that no event of the scenario can end is ended here. A
    /// hold is not a pause: whoever pressed it has a reason, and releases it.
    fn attend(&mut self, tags: &SpindleCommand) {
        let held = self.pressed.pressed(Panel::FEED_HOLD);
        if tags.paused == 0 || held || self.attended || self.somebody_will_come() {
            self.unattended = 0;
            return;
        }
        self.unattended += 1;
        if self.unattended == (UNATTENDED_S / self.cycle_s).round() as u64 {
            self.operate(Request::CycleStart);
        }
    }

    /// Whether the scenario still ends a pause by the clock; its other moments do not come while the program
    /// waits.
    fn somebody_will_come(&self) -> bool {
        let ends = |event: &Event| {
            (event.action.ends() || event.action == Action::Press(Request::CycleStart))
                && matches!(event.trigger, Trigger::Time { .. } | Trigger::Cycle { .. })
        };
        self.events.iter().zip(&self.due).any(|(event, due)| *due && ends(event))
    }

    fn follow_pass(&mut self, moment: &Moment, tags: &SpindleCommand) {
        if (tags.pass, tags.index_not_before) != (self.pass.pass, self.pass.index_not_before) {
            self.pass =
                PassInHand { pass: tags.pass, index_not_before: tags.index_not_before, origin_deg: None };
        }
        if self.pass.origin_deg.is_none() {
            self.pass.origin_deg = moment
                .index
                .filter(|(_, seen)| *seen >= self.pass.index_not_before)
                .map(|(index_deg, _)| index_deg);
        }
    }

    fn fires(&self, trigger: Trigger, pass_before: u32, moment: &Moment, tags: &SpindleCommand) -> bool {
        match trigger {
            Trigger::PassZ { pass, z_mm } => {
                let (before, now) = (self.z_before - z_mm, moment.z_mm - z_mm);
                pass == tags.pass && pass == pass_before && (before > 0.0) != (now > 0.0)
            }
            Trigger::PassAngle { pass, angle_deg } => {
                pass == tags.pass
                    && self.pass.origin_deg.is_some_and(|origin_deg| {
                        (moment.spindle_deg - origin_deg) * tags.direction >= angle_deg
                    })
            }
            Trigger::AfterPass { pass } => pass == pass_before && pass != tags.pass,
            Trigger::Time { time_s } => moment.cycle.0 as f64 >= time_s / self.cycle_s - 1e-6,
            Trigger::Cycle { cycle } => moment.cycle.0 >= cycle,
            Trigger::Line { line } => line == tags.line,
        }
    }

    fn act(&mut self, action: Action, moment: &Moment) {
        match action {
            Action::Turn { knob, pct, ramp_s } => self.knobs[knob as usize].go(pct, ramp_s / self.cycle_s),
            Action::Press(request) => self.operate(request),
            Action::Burden { burden, amount, for_s } => self.burden(burden, amount, for_s, moment.cycle),
            Action::LoadBySpeed { nm_per_rpm, for_s } => {
                let amount = nm_per_rpm * moment.spindle_rpm.abs();
                self.burden(Burden::Spindle, amount, for_s, moment.cycle);
            }
            Action::PowerLost => self.pressed.press(Panel::POWER_LOST, true),
            Action::Spike { axis, force_n, for_s } => {
                let until = self.until(Some(for_s), moment.cycle).unwrap_or_default();
                self.breakages.spike(axis, force_n, until.max(moment.cycle.0 + 1));
            }
            Action::AxisJump { axis, mm } => self.breakages.jump(axis, mm),
            Action::DriveFault { axis, torque_lost } => {
                self.breakages.trip(axis, if torque_lost { Trip::TorqueLost } else { Trip::Brakes });
            }
            Action::SpindleFault { fault, for_s } => {
                self.breakages.break_spindle(fault, self.until(for_s, moment.cycle));
            }
            Action::Doom { doom, module, for_s } => {
                self.orders.give(Order::Doom(doom, module), self.until(for_s, moment.cycle));
            }
            Action::Packet(packet) => self.orders.give(Order::Packet(packet), None),
            Action::Input { number, on, after_s } => {
                let due = moment.cycle.after((after_s / self.cycle_s).round() as u64);
                self.later.push((due, number, on));
            }
            encoder => self.disturb(encoder, moment.cycle.after(1)),
        }
    }

    /// What the encoder shows from the cycle `next` on.
    fn disturb(&mut self, action: Action, next: Cycle) {
        match action {
            Action::Glitch { counts, for_s } => self.encoder.jump(counts, self.until(for_s, next)),
            Action::IndexLost { for_s } => self.encoder.lose_index(self.until(for_s, next)),
            Action::EncoderStands { for_s } => self.encoder.stand(self.until(for_s, next)),
            Action::EncoderNoise { counts } => self.encoder.be_noisy(counts),
            Action::EncoderEccentricity { counts } => self.encoder.be_eccentric(counts),
            _ => {}
        }
    }

    /// The cycle in which something is over that began now.
    fn until(&self, for_s: Option<f64>, now: Cycle) -> Option<u64> {
        for_s.map(|for_s| now.0 + (for_s / self.cycle_s).round() as u64)
    }

    fn burden(&mut self, burden: Burden, amount: f64, for_s: Option<f64>, now: Cycle) {
        self.burdens[burden as usize].go(amount, self.rise_cycles);
        self.burden_until[burden as usize] = self.until(for_s, now);
    }
}
