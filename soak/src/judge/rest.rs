//! Timed motion of a machine that has lost an axis, or is told to stand. In: the truth of each cycle, what
//! the regulators say. Out: the first cycle in which an axis still follows its stream when it should have
//! come to rest.

use protocol::{Axis, AxisState, AxisStatus, MachineState, WayOut};
use rig::Exchange;

use super::{Broken, Known, bounds, is_led, tool::released};
use crate::event::{Button, Event, Trouble, What};

/// An axis that is commanded slower than this stands, mm/s.
const STANDS_MM_S: f64 = 0.5;

/// Axes that had torque and lost it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rest {
    was_led: Vec<bool>,
    since: Option<u64>,
    /// Last cycle in which a pass was in hand.
    passed: Option<u64>,
}

impl Rest {
    pub(crate) fn cycle(&mut self, known: &Known, exchange: &Exchange) -> Option<Broken> {
        if exchange.record.machine.state() == MachineState::Threading {
            self.passed = Some(exchange.record.truth.cycle.0);
        }
        self.goes_on(known, exchange).or_else(|| stops(known, exchange, self.passed))
    }

    fn goes_on(&mut self, known: &Known, exchange: &Exchange) -> Option<Broken> {
        let record = &exchange.record;
        let now = record.truth.cycle.0;
        self.was_led.resize(record.axes.len(), false);
        let mut lost = None;
        for ((axis, _), was_led) in record.axes.iter().zip(&mut self.was_led) {
            let led = is_led(exchange, *axis);
            lost = lost.or((*was_led && !led).then_some(*axis));
            *was_led |= led;
        }
        let Some(lost) = lost.filter(|_| record.machine.state() != MachineState::Ended) else {
            self.since = None;
            return None;
        };
        let since = *self.since.get_or_insert(now);
        let (axis, status) = moving(exchange).filter(|_| now > since + bounds::stop(known.machine))?;
        let text = format!(
            "{axis} still moves at {:.2} mm/s, {} cycles after {lost} lost its torque",
            status.velocity_mm_s,
            now - since
        );
        Some(Broken::new("goes-on", now, text))
    }
}

/// An axis of timed motion that is led, and moves.
fn moving<'a>(exchange: &Exchange<'a>) -> Option<&'a (Axis, AxisStatus)> {
    exchange.record.axes.iter().find(|(axis, status)| {
        is_led(exchange, *axis)
            && status.state() == AxisState::Streaming
            && status.velocity_mm_s.abs() > STANDS_MM_S
    })
}

/// Somebody has pressed what makes the axes of timed motion stand, or the mains are away, and one goes on. A
/// hold that makes a pass be left leads the tool back to its start.
fn stops(known: &Known, exchange: &Exchange, passed: Option<u64>) -> Option<Broken> {
    let now = exchange.record.truth.cycle.0;
    let leaves = || known.passes.values().any(|(pass, _)| pass.out.on(WayOut::ON_HOLD));
    let led_back = |at: u64| passed.is_some_and(|last| last >= at) && leaves();
    let due = |event: &&Event| {
        let until = match event.what {
            What::Press(Button::EmergencyStop | Button::Stop | Button::Abort)
            | What::Plant(Trouble::PowerLost) => u64::MAX,
            What::Press(Button::Hold(cycles)) if !led_back(event.at) => released(known, event.at, cycles),
            _ => return false,
        };
        now > event.at + bounds::stop(known.machine) && now < until
    };
    let event = known.events.iter().find(due)?;
    let (axis, status) = moving(exchange)?;
    let text = format!(
        "{axis} still moves at {:.2} mm/s, {} cycles after: {}",
        status.velocity_mm_s,
        now - event.at,
        event.told()
    );
    Some(Broken::new("stops", now, text))
}
