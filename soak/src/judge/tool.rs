//! The tool in the material. In: the truth of each cycle. Out: the first cycle in which the tool is where it
//! may not be, or still there when it should have left.

use std::borrow::Cow;
use std::collections::BTreeMap;

use machine::Machine;
use protocol::{Axis, AxisState, AxisStatus, Fault, ThreadPass, WayOut};
use rig::Exchange;

use super::{
    Broken, Frame, Known, bounds, excuse,
    groove::{Seen, TOLERANCE_MM, beside},
    is_led,
    leaves::makes_leave,
    stock::{Contact, PassStock},
    torque,
};
use crate::event::{Button, Event, SpindleFault, Trouble, What};

/// A spindle turns the wrong way that does so faster than this, 1/min; it is noticed within so many s.
const BACKWARDS_RPM: f64 = 30.0;
const NOTICED_S: f64 = 0.5;
/// So far a slide lags behind its motor at most where that is measured free, mm.
const LAGS_MM: f64 = 0.02;
/// Damping of a slide, where a machine does not say.
const DAMPING: f64 = 0.03;
/// What it has done to observers and loops fades away within this at least, s.
const LEAST_S: f64 = 0.05;
/// A spindle that is slower than this stands, 1/min.
const STANDS_RPM: f64 = 1.0;

/// The tool, from cycle to cycle.
#[derive(Clone, Debug)]
pub(crate) struct Tool {
    /// The measures of X and Z.
    frames: [Frame; 2],
    /// The pass that was cut last.
    pass: Option<u32>,
    /// Last cycle in which an axis had torque.
    led: [Option<u64>; 2],
    /// Angle since when the tool touches the part without X being able to leave, degrees, and how many turns
    /// it may.
    stuck: Option<(f64, f64)>,
    /// Where it was in the cycle before, in which pass.
    place: Option<(u32, Contact)>,
    touching: bool,
    /// How deep it was when X began to leave, mm.
    left_mm: Option<f64>,
    /// Deeper than a slide lags behind its motor.
    cutting: bool,
    /// And Z brakes there, or has.
    braking: bool,
    /// Cycle in which somebody has said that something is wrong that makes the axes leave, and what.
    said: Option<(u64, Fault)>,
    /// Largest changes of the spindle's speed in a cycle, 1/min, up and down, fading away; its speed.
    uneven: [f64; 2],
    /// What is left of them after a cycle, a share.
    fades: f64,
    rpm: Option<f64>,
    /// Cycle since when the spindle turns the wrong way in a pass.
    backwards: Option<u64>,
    /// What the speed of the spindle was when its encoder began to count wrongly, 1/min, and by how much it
    /// has turned otherwise since, turns: nobody sees that who does not believe the encoder.
    unseen: Option<(f64, f64)>,
    /// Whether a module has said so.
    disbelieved: bool,
    /// How fast X was when Z had torque last, mm/s.
    x_mm_s: f64,
}

impl Tool {
    pub(crate) fn new(machine: &Machine) -> Tool {
        Tool {
            frames: [Axis::X, Axis::Z].map(|axis| Frame::of(machine, axis)),
            pass: None,
            led: [Some(0); 2],
            stuck: None,
            place: None,
            touching: false,
            left_mm: None,
            cutting: false,
            braking: false,
            said: None,
            uneven: [0.0; 2],
            fades: 1.0 - machine.general.cycle_s / swings_s(machine),
            rpm: None,
            backwards: None,
            unseen: None,
            disbelieved: false,
            x_mm_s: 0.0,
        }
    }

    /// Whether the tool was in the material in the cycle taken last.
    pub(crate) fn is_touching(&self) -> bool {
        self.touching
    }

    /// Whether X had torque in it, or could have it for all that has happened.
    pub(crate) fn can_leave(&self, known: &Known, now: u64) -> bool {
        self.led[0] == Some(now) || !torque::is_explained(known, Axis::X, now)
    }

    pub(crate) fn cycle(
        &mut self,
        known: &Known,
        exchange: &Exchange,
        servo: &mut BTreeMap<u32, (f64, f64)>,
    ) -> Option<Broken> {
        let truth = exchange.record.truth;
        let now = truth.cycle.0;
        let let_go = self.lets_go(known, exchange);
        if let_go.is_some() {
            return let_go;
        }
        let in_hand = exchange.record.axes.iter().find(|(_, status)| status.state().is_in_pass());
        if let Some((_, status)) = in_hand {
            self.pass = Some(status.pass);
        }
        self.hear(exchange);
        self.spindle(known, now, truth.spindle_rpm);
        let (pass, stock) = known.passes.get(&self.pass?)?;
        let backwards = truth.spindle_rpm * pass.direction < -BACKWARDS_RPM;
        self.backwards = if backwards { self.backwards.or(Some(now)) } else { None };
        let stock = stock.as_ref()?;
        let [x_mm, z_mm] = self.frames.map(|frame| frame.place_mm(truth));
        let place = stock.place(x_mm, z_mm, truth.spindle_deg, known.tan_flank);
        let before = self.place.replace((pass.pass, place)).filter(|(before, _)| *before == pass.pass);
        let skin = before.and_then(|(_, before)| stock.through_skin(&before, &place));
        let contact = Some(place).filter(|place| stock.touches(place));
        let leaves =
            |(axis, status): &(Axis, AxisStatus)| *axis == Axis::X && status.state() == AxisState::Leaving;
        let leaves = exchange.record.axes.iter().any(leaves);
        self.left_mm = leaves.then(|| self.left_mm.unwrap_or(place.depth_mm));
        self.touching = contact.is_some();
        self.cutting = contact.is_some_and(|contact| contact.depth_mm > LAGS_MM);
        self.braking = contact.is_some_and(|contact| stock.brakes(&contact));
        let [x_led, z_led] = self.led.map(|led| led == Some(now));
        if x_led && z_led {
            let servo = servo.entry(pass.pass).or_insert((0.0, 0.0));
            contact.iter().chain(&skin).for_each(|contact| measure(stock, contact, servo));
        }
        let Some(contact) = contact else {
            self.stuck = None;
            return None;
        };
        let turn = turn_cycles(known, pass);
        let blind = self.disbelieved || known.events.iter().any(|event| excuse::blinds(&event.what));
        let unseen = self.unseen.filter(|_| blind).map_or(0.0, |(_, turns)| turns.abs());
        // From the one to the other a slide swings twice as far.
        let (uneven, rpm, x_mm_s) = (self.uneven.iter().sum(), truth.spindle_rpm, self.x_mm_s);
        let (led, left_mm) = ([x_led, z_led], self.left_mm);
        let seen = Seen { contact, now, turn, uneven, led, rpm, unseen, x_mm_s, left_mm };
        if let Some(broken) = beside(known, pass, stock, &seen) {
            return Some(broken);
        }
        if !x_led {
            return self.stuck(known, exchange, pass, stock.angle_deg(&contact));
        }
        self.late(known, pass, now)
    }

    /// An axis has had torque until now, and the tool touched in the cycle before. Behind an X that was taken
    /// away the spindle stands in the end, or Z at the end of its way: then it may let go. And nobody knows
    /// whether a spindle stands whose encoder has failed, or is so noisy that a module has said that it does
    /// not believe it: without an angle Z can only come to rest where it is.
    fn lets_go(&mut self, known: &Known, exchange: &Exchange) -> Option<Broken> {
        let truth = exchange.record.truth;
        let now = truth.cycle.0;
        let mut let_go = None;
        for (axis, led) in [Axis::X, Axis::Z].into_iter().zip(&mut self.led) {
            if is_led(exchange, axis) {
                *led = Some(now);
            } else if now > 0 && *led == Some(now - 1) && !torque::is_explained(known, axis, now) {
                let_go = let_go.or(Some(axis));
            }
        }
        if self.led[1] == Some(now) {
            self.x_mm_s = truth.axes[Axis::X.index()].velocity_mm_s.abs();
        }
        let fails = |what: &What| excuse::blinds(what) || self.disbelieved && excuse::miscounts(what);
        let blind = known.events.iter().any(|event| now >= event.at && fails(&event.what));
        let turns = truth.spindle_rpm.abs() > STANDS_RPM && !self.braking && !blind;
        let holds = self.led[0] == Some(now) || turns;
        let axis = let_go.filter(|axis| self.cutting && (*axis == Axis::X || holds))?;
        let text = format!("{axis} has no torque any more, the tool is in the material, nothing explains it");
        Some(Broken::new("let-go", now, text))
    }

    /// What the spindle does, and what of it nobody can see.
    fn spindle(&mut self, known: &Known, now: u64, rpm: f64) {
        let cycle_s = known.machine.general.cycle_s;
        let change = rpm - self.rpm.replace(rpm).unwrap_or(rpm);
        let ([up, down], fades) = (self.uneven, self.fades);
        self.uneven = [(up * fades).max(change), (down * fades).max(-change)];
        let blind = |fault: Fault| matches!(fault, Fault::EncoderGlitch | Fault::EncoderStands);
        self.disbelieved |= self.said.is_some_and(|(_, fault)| blind(fault));
        if known.events.iter().any(|event| now >= event.at && excuse::miscounts(&event.what)) {
            let (before, turns) = self.unseen.get_or_insert((rpm, 0.0));
            *turns += (rpm - *before) / 60.0 * cycle_s;
        }
    }

    /// What the modules say of themselves.
    fn hear(&mut self, exchange: &Exchange) {
        let record = &exchange.record;
        let codes = record.axes.iter().map(|(_, status)| status.fault).chain([record.machine.fault]);
        let said = codes.filter_map(Fault::from_code).find(|fault| makes_leave(*fault));
        let now = record.truth.cycle.0;
        self.said = said.map(|fault| self.said.unwrap_or((now, fault)));
    }

    /// The tool should have left by now.
    fn late(&self, known: &Known, pass: &ThreadPass, now: u64) -> Option<Broken> {
        let by_z = self.led[1].filter(|led| *led > 0).map(|led| (led, Cow::from("Z lost its torque")));
        let pressed = known.events.iter().filter_map(|event| {
            let leaves = |policy| pass.out.on(policy);
            let (cause, until) = match event.what {
                What::Press(Button::EmergencyStop) | What::Plant(Trouble::PowerLost) => (true, u64::MAX),
                What::Press(Button::Stop | Button::Abort) => (leaves(WayOut::ON_STOP), u64::MAX),
                What::Press(Button::Hold(cycles)) => {
                    (leaves(WayOut::ON_HOLD), released(known, event.at, cycles))
                }
                _ => (false, 0),
            };
            (cause && now <= until).then(|| (event.at, event.told().into()))
        });
        let due = |since: u64| now > since && now > since + bounds::way_out(known.machine, pass);
        let said = self.said.map(|(since, fault)| (since, format!("{fault:?} was said").into()));
        let noticed = (NOTICED_S / known.machine.general.cycle_s) as u64;
        let backwards =
            self.backwards.map(|since| (since + noticed, Cow::from("the spindle turned the wrong way")));
        let stands = known.events.iter().find(|event| event.what == What::Plant(Trouble::Stands(None)));
        let stands = stands.map(|event| (event.at + 2 * noticed, event.told().into()));
        by_z.into_iter()
            .chain(pressed)
            .chain(said)
            .chain(backwards)
            .chain(stands)
            .find(|(since, _)| due(*since))
            .map(|(since, why)| {
                let text = format!(
                    "pass {}: the tool is still in the material {} cycles after: {why}",
                    pass.pass,
                    now - since
                );
                Broken::new("leaves", now, text)
            })
    }

    /// The tool cannot leave: the spindle stands before it has turned much further. It is told to at once, or
    /// at the end of the pass; who is told to brake while it is not led, or against its will, brakes when
    /// that is over. Without mains it only coasts.
    fn stuck(
        &mut self,
        known: &Known,
        exchange: &Exchange,
        pass: &ThreadPass,
        angle_deg: f64,
    ) -> Option<Broken> {
        let truth = exchange.record.truth;
        let now = truth.cycle.0;
        let coasts = |event: &Event| match event.what {
            What::Plant(Trouble::PowerLost) => now >= event.at,
            // Loaded to its limit, a drive swings over when the load lets go.
            What::Plant(Trouble::Load(_, s)) => (event.at
                ..=event.at + ((s + excuse::UNWINDS_S) / known.machine.general.cycle_s) as u64)
                .contains(&now),
            What::Plant(Trouble::Spindle(fault, s)) if fault != SpindleFault::Jam => {
                (event.at..=event.at + (s / known.machine.general.cycle_s) as u64).contains(&now)
            }
            _ => false,
        };
        if truth.spindle_rpm.abs() < STANDS_RPM || known.events.iter().any(coasts) {
            self.stuck = None;
            return None;
        }
        let rest_deg = if pass.out.on(WayOut::ON_FAULT) { 0.0 } else { pass.done_deg() - angle_deg };
        let most = bounds::run_down_turns(known.machine, truth.spindle_rpm) + rest_deg.max(0.0) / 360.0;
        let (from, most) = *self.stuck.get_or_insert((truth.spindle_deg, most));
        let turns = (truth.spindle_deg - from).abs() / 360.0;
        (turns > most).then(|| {
            let text = format!(
                "pass {}: X stuck at depth, the spindle has turned {turns:.2} times since, {most:.2} allowed",
                pass.pass
            );
            Broken::new("ring", now, text)
        })
    }
}

/// What the servo does where the tool touches: by how much it is too deep, and beside the groove, mm.
fn measure(stock: &PassStock, contact: &Contact, (bottom_mm, flank_mm): &mut (f64, f64)) {
    *flank_mm = flank_mm.max(contact.flank_mm);
    // Where X strokes steeply, or Z brakes, only that is too deep which is so wherever Z is beside.
    *bottom_mm = bottom_mm.max(stock.bottom_mm(contact, *flank_mm + TOLERANCE_MM));
}

/// When a hold that was pressed at `at` for so many cycles is released: any cycle start ends it.
pub(crate) fn released(known: &Known, at: u64, cycles: u64) -> u64 {
    let ends = known.events.iter().filter_map(|event| match event.what {
        What::Press(Button::Hold(cycles)) => Some(event.at + cycles),
        What::Press(Button::Start) => Some(event.at),
        _ => None,
    });
    // In single block cycle start is pressed all the time.
    if known.events.iter().any(|event| matches!(event.what, What::Press(Button::SingleBlock(_)))) {
        return at;
    }
    ends.filter(|end| *end >= at).fold(at + cycles, u64::min)
}

/// What a spindle has done to the slide of Z fades away with this time, s: 1/ζω.
fn swings_s(machine: &Machine) -> f64 {
    let damping = excuse::in_truth(machine, Axis::Z, "mode_damping", DAMPING);
    let rad_s = core::f64::consts::TAU * excuse::in_truth(machine, Axis::Z, "mode_hz", 100.0);
    (1.0 / (damping * rad_s)).max(LEAST_S)
}

/// Cycles in a turn of the programmed speed.
fn turn_cycles(known: &Known, pass: &ThreadPass) -> u64 {
    (60.0 / pass.s_rpm / known.machine.general.cycle_s) as u64
}
