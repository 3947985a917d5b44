//! Timed motion between setpoints: a quintic through position, speed and acceleration of two neighbours.
//!
//! Time in control cycles, lengths in mm. Before the first setpoint the axis holds. Behind the last one it
//! brakes to rest (M101) in the time that the frame of that setpoint says, the same on every axis; so a
//! stream that runs dry ends on the tangent of its path, and feedforward that looks ahead sees no step.

use motion::{Exit, Limits, Sample};
use protocol::{Cycle, Position, Refused, Setpoint};

/// How many setpoints are kept: one behind, and three to interpolate and look ahead in.
const KEPT: usize = 4;
/// A setpoint may go beyond a limit by this share: rounding, and what an axis does besides its path.
const SPARE: f64 = 1.1;
/// What a lead in control cycles is rounded by at most.
const ROUNDING: f64 = 1e-6;

/// The setpoints around the present.
#[derive(Clone, Debug)]
pub struct Stream {
    nodes: [Setpoint; KEPT],
    /// The motion from each of them to the next.
    spans: [Quintic; KEPT - 1],
    /// What follows the last of them.
    stop: Exit,
    begun: bool,
    /// The axis has rested behind the last setpoint, and the next one cannot be reached from there.
    torn: bool,
    cycle_s: f64,
}

impl Stream {
    /// A stream that has not begun. `cycle_s` is the control cycle.
    pub fn new(cycle_s: f64) -> Stream {
        Stream {
            nodes: [Setpoint::default(); KEPT],
            spans: [Quintic::default(); KEPT - 1],
            stop: Exit::default(),
            begun: false,
            torn: false,
            cycle_s,
        }
    }

    /// Whether there is a setpoint at all.
    pub fn begun(&self) -> bool {
        self.begun
    }

    /// Forgets the past and rests at a position from `cycle` on.
    pub fn rest_at(&mut self, position: Position, cycle: Cycle) {
        self.nodes = [Setpoint { cycle, position, ..Setpoint::default() }; KEPT];
        self.stop = Exit::stop_in(&rest(self.last()), 0.0);
        (self.begun, self.torn) = (true, false);
    }

    /// The present is `cycle`: an axis that has come to rest behind its last setpoint rests there until now.
    /// Of a stream that has begun.
    pub fn rest_until(&mut self, cycle: Cycle) {
        if self.rests(cycle) {
            self.rest_at(Position::from_mm(self.stop.end()), cycle);
        }
    }

    /// The next setpoint was refused, since the axis cannot be there in time from where it rests.
    pub fn tear(&mut self) {
        self.torn = true;
    }

    /// Whether the axis has come to rest behind the last setpoint.
    pub fn rests(&self, cycle: Cycle) -> bool {
        cycle >= self.last().cycle && self.behind(cycle, 0.0) >= self.stop.duration()
    }

    /// Seconds from the last setpoint to `cycle` plus `offset` cycles.
    fn behind(&self, cycle: Cycle, offset: f64) -> f64 {
        (cycle.0 as f64 - self.last().cycle.0 as f64 + offset) * self.cycle_s
    }

    /// Adds the next setpoint, and in how many s the axis brakes if it is the last; false if it is not later
    /// than the one before. The first one has nothing before it.
    pub fn push(&mut self, node: Setpoint, stop_s: f64) -> bool {
        if !self.begun {
            self.rest_at(node.position, node.cycle);
            return true;
        }
        if node.cycle <= self.last().cycle {
            return false;
        }
        let span = Quintic::between(self.last(), &node, self.cycle_s);
        self.nodes.rotate_left(1);
        self.nodes[KEPT - 1] = node;
        self.spans.rotate_left(1);
        self.spans[KEPT - 2] = span;
        // One that rests is there already: behind it nothing is on its way for as long as the others brake.
        let rests = node.velocity_mm_s == 0.0 && node.acceleration_mm_s2 == 0.0;
        self.stop = Exit::stop_in(&sample(&node), if rests { 0.0 } else { stop_s });
        true
    }

    /// Whether an axis can follow a setpoint from the one before, if it does, and brake from it in that time.
    ///
    /// # Errors
    /// What is out of range.
    pub fn check(&self, next: &Setpoint, stop_s: f64, limits: &Limits, follows: bool) -> Result<(), Refused> {
        let last = self.last();
        let (v, a) = (next.velocity_mm_s, next.acceleration_mm_s2);
        if v.abs() > SPARE * limits.v || a.abs() > SPARE * limits.a {
            return Err(Refused::OutOfRange("setpoint"));
        }
        if stop_s < Exit::stop_s(v, a, limits) {
            return Err(Refused::OutOfRange("braking time"));
        }
        if !self.begun || next.cycle <= last.cycle || !follows {
            return Ok(());
        }
        let h = (next.cycle.0 - last.cycle.0) as f64 * self.cycle_s;
        let mean = 0.5 * (last.velocity_mm_s + v) * h + (last.acceleration_mm_s2 - a) * h * h / 12.0;
        let apart = (next.position.mm_from(last.position) - mean).abs();
        // Twice what the highest jerk can do in that time, h³/31 for j and −j in turns; and what a pass ends
        // beside the first setpoint behind it.
        if apart > limits.j * h * h * h / 15.0 + 2e-5 {
            return Err(Refused::OutOfRange("setpoint position"));
        }
        Ok(())
    }

    /// The last setpoint.
    pub fn last(&self) -> &Setpoint {
        &self.nodes[KEPT - 1]
    }

    /// Whether `cycle` lies behind the last setpoint although that one still moves, or setpoints are missing.
    pub fn starved(&self, cycle: Cycle) -> bool {
        let last = self.last();
        self.torn || cycle > last.cycle && (last.velocity_mm_s != 0.0 || last.acceleration_mm_s2 != 0.0)
    }

    /// The commanded motion at `cycle` plus `offset` cycles, mm and s.
    pub fn at(&self, cycle: Cycle, offset: f64) -> Sample {
        let time = |node: &Setpoint| node.cycle.0.wrapping_sub(cycle.0) as i64 as f64;
        let later = self.nodes.iter().position(|node| time(node) > offset);
        // A lead that reaches as far as the setpoints do is on its way to the last of them, not behind it: it
        // brakes there only if no other comes, with a jerk that nobody was to see.
        let [before, last] = [KEPT - 2, KEPT - 1].map(|i| time(&self.nodes[i]));
        let arrives = before < last && offset - last < ROUNDING;
        match later.or(arrives.then_some(KEPT - 1)) {
            None => self.stop.at(self.behind(cycle, offset)),
            Some(0) => rest(&self.nodes[0]),
            Some(i) => self.spans[i - 1].at(offset - time(&self.nodes[i - 1])),
        }
    }
}

fn rest(node: &Setpoint) -> Sample {
    Sample { s: node.position.mm(), ..Sample::default() }
}

fn sample(node: &Setpoint) -> Sample {
    Sample { v: node.velocity_mm_s, a: node.acceleration_mm_s2, ..rest(node) }
}

/// Quintic Hermite interpolation between two setpoints; its coefficients are found once, it is evaluated at
/// every lead of every cycle.
#[derive(Clone, Copy, Debug, Default)]
struct Quintic {
    from_mm: f64,
    /// How long it is, control cycles and s.
    cycles: f64,
    h: f64,
    /// Of the powers of the share of it that has gone by, from the first one on, mm.
    c: [f64; 5],
}

impl Quintic {
    fn between(a: &Setpoint, b: &Setpoint, cycle_s: f64) -> Quintic {
        let cycles = (b.cycle.0 - a.cycle.0) as f64;
        let h = cycles * cycle_s;
        let d = b.position.mm_from(a.position);
        let (v0, v1) = (a.velocity_mm_s * h, b.velocity_mm_s * h);
        let (a0, a1) = (a.acceleration_mm_s2 * h * h, b.acceleration_mm_s2 * h * h);
        let c2 = 0.5 * a0;
        let c3 = 10.0 * d - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1;
        let c4 = -15.0 * d + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1;
        let c5 = 6.0 * d - 3.0 * (v0 + v1) + 0.5 * (a1 - a0);
        Quintic { from_mm: a.position.mm(), cycles, h, c: [v0, c2, c3, c4, c5] }
    }

    /// The motion so many control cycles after its beginning.
    fn at(&self, gone: f64) -> Sample {
        let Quintic { from_mm, cycles, h, c: [v0, c2, c3, c4, c5] } = *self;
        let u = gone / cycles;
        Sample {
            s: from_mm + u * (v0 + u * (c2 + u * (c3 + u * (c4 + u * c5)))),
            v: (v0 + u * (2.0 * c2 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5)))) / h,
            a: (2.0 * c2 + u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5))) / (h * h),
            j: (6.0 * c3 + u * (24.0 * c4 + u * 60.0 * c5)) / (h * h * h),
            dj: (24.0 * c4 + u * 120.0 * c5) / (h * h * h * h),
        }
    }
}
