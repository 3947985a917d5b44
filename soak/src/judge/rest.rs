//! Timed motion of a machine that has lost an axis. In: the truth of each cycle, what the regulators say.
//! Out: the first cycle in which another axis still follows its stream when it should have come to rest.

use protocol::{AxisState, MachineState};
use rig::Exchange;

use super::{Broken, Known, bounds, is_led};

/// An axis that is commanded slower than this stands, mm/s.
const STANDS_MM_S: f64 = 0.5;

/// Axes that had torque and lost it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rest {
    was_led: Vec<bool>,
    since: Option<u64>,
}

impl Rest {
    pub(crate) fn cycle(&mut self, known: &Known, exchange: &Exchange) -> Option<Broken> {
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
        let moving = record.axes.iter().find(|(axis, status)| {
            is_led(exchange, *axis)
                && status.state() == AxisState::Streaming
                && status.velocity_mm_s.abs() > STANDS_MM_S
        });
        let (axis, status) = moving.filter(|_| now > since + bounds::stop(known.machine))?;
        let text = format!(
            "{axis} still moves at {:.2} mm/s, {} cycles after {lost} lost its torque",
            status.velocity_mm_s,
            now - since
        );
        Some(Broken::new("goes-on", now, text))
    }
}
