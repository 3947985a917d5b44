//! Where the axis shall be: at the sample instant, and at the leads of the two feedforwards (M54).
//!
//! Whatever the master is (time in a stream, the spindle angle in a pass), the result is the same three samples in
//! mm and s; position is absolute.

use motion::Sample;
use protocol::{Axis, Cycle, Machine};

use crate::{spindle::Spindle, state::State, stream::Stream};

/// The commanded motion at three instants.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reference {
    /// At the sample instant of the measurement.
    pub now: Sample,
    /// At the lead of the velocity feedforward.
    pub at_velocity_lead: Sample,
    /// At the lead of the acceleration feedforward.
    pub at_acceleration_lead: Sample,
    /// C at the sample instant, degrees; 0 outside a pass.
    pub angle_deg: f64,
}

/// The leads of an axis, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leads {
    velocity_s: f64,
    acceleration_s: f64,
    cycle_s: f64,
}

impl Leads {
    /// The leads of an axis of a machine file. The axis must exist.
    pub fn of(machine: &Machine, axis: Axis) -> Leads {
        let config = &machine.axis[&axis];
        Leads {
            velocity_s: config.velocity_lead_s,
            acceleration_s: config.acceleration_lead_s,
            cycle_s: machine.machine.cycle_s,
        }
    }

    /// The control cycle, s.
    pub fn cycle_s(&self) -> f64 {
        self.cycle_s
    }
}

/// The reference in a state. `measured_mm` is where an axis without command stays.
pub fn reference(
    state: &State,
    stream: &Stream,
    spindle: &Spindle,
    cycle: Cycle,
    leads: &Leads,
    measured_mm: f64,
) -> Reference {
    let still = |mm: f64| {
        let rest = Sample { s: mm, ..Sample::default() };
        Reference { now: rest, at_velocity_lead: rest, at_acceleration_lead: rest, angle_deg: 0.0 }
    };
    match state {
        State::Idle | State::Fault(_) => still(measured_mm),
        State::Streaming => {
            let at = |lead_s: f64| stream.at(cycle, lead_s / leads.cycle_s);
            Reference {
                now: at(0.0),
                at_velocity_lead: at(leads.velocity_s),
                at_acceleration_lead: at(leads.acceleration_s),
                angle_deg: 0.0,
            }
        }
        State::Armed(pass) => still(pass.law.start.mm()),
        State::WaitingForC0(pass) | State::RunIn(pass) | State::Locked(pass) | State::RunOut(pass) => {
            let at = |lead_s: f64| {
                let c = spindle.since(pass.index_count, pass.direction, lead_s);
                let ratio = c.speed / pass.programmed_deg_s;
                let ratio_rate = c.acceleration / pass.programmed_deg_s;
                let mut sample = pass.motion.at(c.angle).driven(ratio, ratio_rate);
                sample.s += pass.law.start.mm();
                (sample, c.angle)
            };
            let (now, angle_deg) = at(0.0);
            Reference {
                now,
                at_velocity_lead: at(leads.velocity_s).0,
                at_acceleration_lead: at(leads.acceleration_s).0,
                angle_deg,
            }
        }
    }
}
