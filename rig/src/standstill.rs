//! A machine that waits at its panel for somebody who will not come. In: every control cycle a [`Record`].
//! Out: what it waits for, once it has stood for [`WAIT_S`] on the machine.
//!
//! It waits for the operator while feed hold is pressed or an override stands at 0. Nobody will come if no
//! event of the scenario by the clock is left, and nothing changes: then its other events, which wait for
//! the motion of the machine, do not come either. In virtual time nobody else stands at the panel.

use machine::{Machine, SpindleConfig};
use protocol::{MachineState, Panel, PerAxis, units::AXES};
use sim_plant::Scenario;

use crate::observe::Record;

/// So long nothing has changed, s.
pub const WAIT_S: f64 = 60.0;
/// An axis that is led no farther than this meanwhile stands, mm.
const STANDS_MM: f64 = 0.01;

/// What would be different if the machine went on: state, line, pass, moves, items taken, panel.
type Stand = (u32, u32, u32, u64, u64, Panel);

/// Watches over one run.
#[derive(Clone, Debug)]
pub struct Standstill {
    /// The cycle of the last event by the clock.
    last_event: u64,
    wait: u64,
    /// How the machine stands, where its axes are led, mm, and since which cycle.
    since: Option<(Stand, PerAxis<f64>, u64)>,
}

impl Standstill {
    /// Of a machine and of what happens to it.
    pub fn new(machine: &Machine, scenario: &Scenario) -> Standstill {
        let cycle_s = machine.general.cycle_s;
        let last_event = scenario.last_by_clock(cycle_s);
        Standstill { last_event, wait: (WAIT_S / cycle_s).ceil() as u64, since: None }
    }

    /// One control cycle; every one, in order. What the machine waits for in vain; then the wait begins anew.
    pub fn cycle(&mut self, record: &Record) -> Option<&'static str> {
        let now = record.truth.cycle.0;
        let Some(waits_for) = waits_for(record).filter(|_| now > self.last_event) else {
            self.since = None;
            return None;
        };
        let (machine, panel) = (record.machine, record.truth.measurement.panel);
        let stand = (machine.state, machine.line, machine.pass, machine.moves, machine.taken, panel);
        let mut led = [0.0; AXES];
        record.axes.iter().for_each(|(axis, status)| led[axis.index()] = status.commanded_mm);
        let near = |(a, b): (&f64, &f64)| (a - b).abs() < STANDS_MM;
        let same = |(before, place, _): &&(Stand, PerAxis<f64>, u64)| {
            *before == stand && place.iter().zip(&led).all(near)
        };
        match self.since.as_ref().filter(same) {
            None => self.since = Some((stand, led, now)),
            Some((.., since)) if now - since >= self.wait => {
                self.since = None;
                return Some(waits_for);
            }
            Some(_) => {}
        }
        None
    }
}

/// What the operator would have to do for the machine to go on.
fn waits_for(record: &Record) -> Option<&'static str> {
    let panel = &record.truth.measurement.panel;
    let stands = record.truth.spindle_rpm.abs() < SpindleConfig::STANDSTILL_RPM;
    match record.machine.state() {
        MachineState::Ready | MachineState::Moving | MachineState::Paused | MachineState::ToolChange => {}
        // A pass goes on as long as the spindle turns.
        MachineState::Threading if stands => {}
        _ => return None,
    }
    match () {
        () if panel.pressed(Panel::FEED_HOLD) => Some("feed hold is on, and no cycle_start = true"),
        () if panel.spindle_override_pct == 0.0 => {
            Some("the spindle override is 0, and no spindle_override_pct above 0")
        }
        () if panel.feed_override_pct == 0.0 => {
            Some("the feed override is 0, and no feed_override_pct above 0")
        }
        () if panel.rapid_override_pct == 0.0 => {
            Some("the rapid override is 0, and no rapid_override_pct above 0")
        }
        () => None,
    }
}
