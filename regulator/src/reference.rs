//! Where the axis shall be, in the present and about it: feedforwards look ahead and back (M54), and what is
//! measured is as old as the bus makes it.
//!
//! Whatever the master is (time in a stream, the spindle angle in a pass), a lead in s becomes a sample in mm
//! and s; position is absolute. [`Reference::axis`] is the motion of the axis. That of the motor behind it,
//! which turns a little more or less where screw and backlash are compensated (M68, M69), is [`Motor`].

use motion::{Sample, SpindleMotion};
use protocol::Cycle;

use crate::{
    compensation::Compensation,
    elastic::Elastic,
    leave::{Leaving, Way},
    spindle::Spindle,
    state::{Pass, Stage, State},
    stream::Stream,
};

/// The commanded motion about one cycle.
#[derive(Clone, Copy, Debug)]
pub struct Reference<'a> {
    /// The state that says what is followed.
    pub state: &'a State,
    /// Setpoints of timed motion.
    pub stream: &'a Stream,
    /// The spindle, master of a pass.
    pub spindle: &'a Spindle,
    /// The present cycle.
    pub cycle: Cycle,
    /// The control cycle, s.
    pub cycle_s: f64,
    /// Where an axis without command stays, mm.
    pub measured_mm: f64,
}

impl Reference<'_> {
    /// The motion of the axis now, as estimated.
    pub fn now(&self) -> Sample {
        self.sample(0.0, Spindle::since)
    }

    /// The motion of the axis so long ago, as estimated by now.
    pub fn ago(&self, ago_s: f64) -> Sample {
        self.sample(-ago_s, Spindle::since)
    }

    /// The motion of the axis `lead_s` from now, as it is fed forward.
    pub fn axis(&self, lead_s: f64) -> Sample {
        self.sample(lead_s, Spindle::followed_since)
    }

    fn sample(&self, lead_s: f64, since: fn(&Spindle, &Pass, f64) -> SpindleMotion) -> Sample {
        let still = |mm: f64| Sample { s: mm, ..Sample::default() };
        match self.state {
            State::Idle | State::Fault(_) => still(self.measured_mm),
            State::InPass { pass, stage: Stage::Armed } => still(pass.law.start.mm()),
            State::Leaving(Leaving { way: Way::Timed { exit, from }, .. }) => {
                let t = (self.cycle.0 - from.0) as f64 * self.cycle_s + lead_s;
                let begun = exit.at(t.max(0.0));
                // Before it the axis came as it begins.
                let before = t.min(0.0);
                Sample { s: begun.s + (begun.v + 0.5 * begun.a * before) * before, ..begun }
            }
            State::Leaving(Leaving { way: Way::Along(_), pass: Some(pass), .. })
            | State::InPass { pass, .. } => {
                let c = since(self.spindle, pass, lead_s);
                let ratio = |value: f64| value / pass.programmed_deg_s;
                let mut sample =
                    pass.motion.at(c.angle).driven([c.speed, c.acceleration, c.jerk, c.snap].map(ratio));
                sample.s += pass.law.start.mm();
                sample
            }
            State::Streaming | State::Leaving(_) => self.stream.at(self.cycle, lead_s / self.cycle_s),
        }
    }

    /// C now, degrees; 0 as long as it is not counted.
    pub fn angle_deg(&self) -> f64 {
        match self.state {
            State::Idle | State::Fault(_) | State::Streaming => 0.0,
            State::InPass { stage: Stage::Armed, .. } | State::Leaving(Leaving { pass: None, .. }) => 0.0,
            State::InPass { pass, .. } | State::Leaving(Leaving { pass: Some(pass), .. }) => {
                self.spindle.since(pass, 0.0).angle
            }
        }
    }

    /// How far a count of the spindle moves the axis, mm; 0 outside a pass.
    pub fn count_mm(&self) -> f64 {
        let mm_per_degree = self.state.pass().map_or(0.0, |pass| pass.mm_per_degree(self.angle_deg()));
        mm_per_degree * self.spindle.degrees_per_count()
    }
}

/// The commanded motion of the motor behind an axis.
#[derive(Clone, Copy, Debug)]
pub struct Motor<'a> {
    /// What the axis shall do.
    pub reference: Reference<'a>,
    /// What the measurement should have shown, mm.
    pub sampled_mm: f64,
    /// What the drive train gives.
    pub elastic: Elastic,
    /// What the motor does besides, if anything.
    pub compensation: Option<&'a Compensation>,
}

impl Motor<'_> {
    /// The motion of the motor `lead_s` from now: position, speed, acceleration.
    pub fn at(&self, lead_s: f64) -> Sample {
        let axis = self.elastic.nut(&self.reference.axis(lead_s));
        self.compensation.map_or(axis, |compensation| compensation.motor(&axis, lead_s))
    }
}
