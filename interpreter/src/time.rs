//! How long machine code takes. In: codes in the order of the program. Out: seconds at 100 % override.
//!
//! Moves are planned by the same chain that the interpolator runs (M16–M26, M66), so look-ahead, blends and
//! path modes count as they do on the machine; a chain ends on an interpolator cycle. The spindle follows its
//! ramp while rapids move; a feed waits until it is at speed, a pass until it has been so for a while. A pass
//! begins at an index: the first one half a turn after it was armed, in the mean, the others a whole number
//! of turns after the one before. Before an output is switched at rest the axes come to where they are led. A
//! program is over when the spindle stands. How long a pause lasts is up to the operator; it counts as
//! nothing.

use machine::{Machine, SpeedLaw, SpindleConfig};
use motion::chain::{Ask, Block, Chain, Ratios};
use protocol::{
    Axis, ByHand, Code, Feed, PerAxis, Position, Set, SpindleMode, SpindleSpeed, ThreadPass, Variation, Work,
    frame::SETPOINT_LEAD, units::AXES,
};
use route::{Advance, Course, Move, Route, Routed, Unworkable};

/// Until it is sure that axes stand, s.
const STOOD_S: f64 = 0.05;
/// From there until it is sure that a spindle stands, s: three means of a tenth, and the one that they fall
/// in.
const REST_S: f64 = 0.35;
/// Interpolator cycles until the drives are on, and setpoints act.
const START_CYCLES: f64 = 7.0;
/// Interpolator cycles from rest to the first index that counts: in position, armed, looked at, called off in
/// time.
const ARMING_CYCLES: f64 = 9.0;
/// Bandwidth of the filter through which the interpolator watches the spindle, rad/s.
const WATCH: f64 = SpindleConfig::WATCH_HZ * core::f64::consts::TAU;

/// A program that takes longer on the machine than this, s, is taken for one without end: thirty days.
pub(crate) const LONGEST_S: f64 = 30.0 * 86_400.0;

/// How long a pass takes from its index, s: at an even speed, or by its law (M230).
fn pass_s(pass: &ThreadPass, variation: Option<Variation>) -> f64 {
    /// Steps of the sum in a turn.
    const STEPS: f64 = 64.0;
    let even = pass.done_deg() / (6.0 * pass.s_rpm);
    let Some(variation) = variation else { return even };
    let law = SpeedLaw::new(variation, u64::from(pass.pass));
    let (turns, turn_s) = (pass.done_deg() / 360.0, 60.0 / pass.s_rpm);
    let steps = (turns * STEPS).ceil().clamp(1.0, 1e6);
    let step = turns / steps;
    let slower = (0..steps as u32).map(|n| 1.0 / law.share((f64::from(n) + 0.5) * step));
    slower.sum::<f64>() * step * turn_s
}

/// Adds up time.
pub(crate) struct Clock<'m> {
    machine: &'m Machine,
    route: Route,
    chain: Chain<AXES, Move>,
    last: Option<Move>,
    /// X within the chain, where the spindle follows it.
    x: Option<Position>,
    at: PerAxis<Position>,
    mode: SpindleMode,
    speed: SpindleSpeed,
    /// Signed speed that the spindle has, 1/min.
    rpm: f64,
    /// How long it has been at the speed programmed, s.
    even: f64,
    /// When the last pass began at its index, s, while the spindle goes on at that speed.
    index: Option<f64>,
    /// How the speed is varied in passes.
    variation: Option<Variation>,
    /// Time of the chain in hand, s.
    moved: f64,
    seconds: f64,
    /// The trace that the chain in hand ends with.
    traced: Option<Work>,
    /// The first trace that cannot be followed: its line, and why.
    trouble: Option<(u32, Unworkable)>,
}

impl<'m> Clock<'m> {
    pub(crate) fn new(machine: &'m Machine) -> Clock<'m> {
        Clock {
            machine,
            route: Route::new(machine),
            chain: Chain::growing(Route::settings(machine)),
            last: None,
            x: None,
            at: machine.home(),
            mode: SpindleMode::Stop,
            speed: SpindleSpeed::Rpm(0.0),
            rpm: 0.0,
            even: 0.0,
            index: None,
            variation: None,
            moved: 0.0,
            seconds: START_CYCLES * machine.general.interpolator_cycle_s,
            traced: None,
            trouble: None,
        }
    }

    pub(crate) fn seconds(&self) -> f64 {
        self.seconds + self.moved
    }

    /// The first trace that cannot be followed, if there is one: its line, and why.
    pub(crate) fn trouble(&self) -> Option<(u32, Unworkable)> {
        self.trouble
    }

    pub(crate) fn add(&mut self, line: u32, code: &Code) {
        match code {
            Code::Line { .. } | Code::Arc { .. } | Code::Curve { .. } => {
                if self.traced.is_some() {
                    self.finish();
                }
                return self.travel(line, code);
            }
            Code::PathMode(mode) => {
                if self.traced.is_some() {
                    self.finish();
                }
                return self.route.set_mode(*mode);
            }
            Code::Work(trace) if self.goes_on(trace) => {}
            _ => self.finish(),
        }
        match code {
            Code::Dwell { seconds } => self.pass_time(*seconds),
            code if self.waits_for_rest(code) => {
                let turned = self.rpm != 0.0;
                self.run_down();
                self.pass_time(if turned { REST_S } else { STOOD_S });
            }
            Code::Output { in_step: false, .. } | Code::Await { .. } => {
                self.pass_time(SETPOINT_LEAD as f64 * self.machine.general.interpolator_cycle_s);
            }
            Code::Spindle { mode, speed } => {
                if (*mode, *speed) != (self.mode, self.speed) {
                    self.even = 0.0;
                }
                (self.mode, self.speed, self.index) = (*mode, *speed, None);
            }
            // What was jogged before has led somewhere else than its move says.
            Code::ByHand(ByHand::Begins { at, .. }) => self.at = *at,
            Code::Pass(pass) => self.pass(pass),
            Code::Variation(variation) => self.variation = *variation,
            Code::Formula { slot, formula } => self.route.set_formula(*slot, *formula),
            Code::Work(trace) => {
                if let Err(reason) = self.follow(line, trace) {
                    self.trouble = self.trouble.or(Some((line, reason)));
                }
                self.traced = Some(*trace);
            }
            Code::End => {
                self.mode = SpindleMode::Stop;
                self.run_down();
            }
            _ => {}
        }
    }

    /// A pass, from the wait for its spindle to where its axes rest.
    fn pass(&mut self, pass: &ThreadPass) {
        self.wait_for_spindle();
        let (turns, known_s) = SpindleConfig::KNOWN;
        self.pass_time(((turns * 60.0 / pass.s_rpm).min(known_s) - self.even).max(0.0));
        for (axis, _) in self.machine.axes() {
            self.at[axis.index()] = pass.axis(axis).end;
        }
        let turn = 60.0 / pass.s_rpm;
        let armed = self.seconds + ARMING_CYCLES * self.machine.general.interpolator_cycle_s;
        let index = match self.index {
            Some(before) => before + ((armed - before) / turn).ceil() * turn,
            None => armed + 0.5 * turn,
        };
        self.index = Some(index);
        self.pass_time(index - self.seconds);
        if pass.returns() {
            self.seconds += self.machine.tap_s(pass);
            (self.rpm, self.even) = (-self.wanted() * pass.return_ratio, 0.0);
            self.index = None;
        } else {
            self.pass_time(pass_s(pass, self.variation));
            if self.variation.is_some() {
                // Where the spindle will be then is not known to a turn, and its speed has to settle.
                (self.index, self.even) = (None, 0.0);
            }
        }
    }

    /// Whether axes and spindle have to stand: of an output that asks for it, and of a tool that is put in by
    /// hand.
    fn waits_for_rest(&self, code: &Code) -> bool {
        match code {
            Code::Output { number, set: Set::Digital(_), .. } => {
                self.machine.output((*number).into()).is_some_and(|output| output.standstill)
            }
            Code::Tool { .. } => !self.machine.general.tool_change.is_automatic(),
            _ => false,
        }
    }

    /// The spindle, told to stop, comes to a stand.
    fn run_down(&mut self) {
        let ramp = self.machine.spindle.ramp_rpm_s;
        if self.rpm != 0.0 {
            // What the filter still sees when the ramp is over dies away.
            let tail = libm::log((ramp / WATCH / SpindleConfig::STANDSTILL_RPM).max(1.0)) / WATCH;
            self.pass_time(self.rpm.abs() / ramp + tail.max(SpindleConfig::SETTLES_S));
        }
    }

    /// A move behind the last one: planned when the chain is full, or over.
    fn travel(&mut self, line: u32, code: &Code) {
        let from = self.last.map_or(self.at, |last| last.to);
        if let Ok(Routed::Block(block)) = self.route.block(line, code, &from) {
            self.append(block);
        }
    }

    /// A trace from where the axes rest, to its end, or to where a program has no end.
    fn follow(&mut self, line: u32, trace: &Work) -> Result<(), Unworkable> {
        let from = self.last.map_or(self.at, |last| last.to);
        let mut tracer = Course::new(&self.route, line, trace, &from)?;
        while self.seconds() < LONGEST_S {
            match tracer.next(&self.route)? {
                Advance::Block(block) => self.append(block),
                Advance::Nowhere => {}
                Advance::Over => break,
            }
        }
        Ok(())
    }

    /// Whether a trace goes on where the chain in hand ends.
    fn goes_on(&self, trace: &Work) -> bool {
        let (Some(before), Some(last)) = (&self.traced, &self.last) else { return false };
        Course::new(&self.route, 0, trace, &last.to).is_ok_and(|tracer| tracer.goes_on(before))
    }

    fn append(&mut self, block: Block<AXES, Move>) {
        if self.last.is_some_and(|last| !last.joins(&block.tag)) {
            self.finish();
        }
        if self.last.is_none() && block.tag.feed != Feed::Rapid {
            self.wait_for_spindle();
        }
        while !self.chain.has_room() {
            if !self.leap() {
                self.finish();
            }
        }
        self.last = Some(block.tag);
        self.chain.push(block);
    }

    /// Plans the chain to its end, which lies on an interpolator cycle.
    pub(crate) fn finish(&mut self) {
        self.traced = None;
        self.chain.close();
        while self.leap() {}
        let cycle = self.machine.general.interpolator_cycle_s;
        let moved = (self.moved / cycle).ceil() * cycle;
        let turned = self.x.take().is_some();
        self.moved = 0.0;
        self.chain.clear();
        if let Some(last) = self.last.take() {
            self.at = last.to;
        }
        self.seconds += moved;
        if !turned {
            self.turn_towards(self.wanted().abs(), moved);
        }
    }

    /// One law of the chain, or one cycle where the feed follows a spindle that follows X; false at its end.
    fn leap(&mut self) -> bool {
        let Some(leg) = self.chain.here().copied() else { return false };
        let follows =
            matches!((leg.feed, self.speed), (Feed::PerRevolution(_), SpindleSpeed::Surface { .. }));
        let i = Axis::X.index();
        let x = self.x.unwrap_or(leg.from[i]);
        let at = |rpm: f64| Ask { ratios: Ratios::full(rpm / 60.0), hold: false, single: false, more: true };
        if !follows {
            let rested = self.chain.rests();
            let Some(time) = self.chain.skip(&at(self.speed.rpm(x))) else { return false };
            self.moved += time;
            // A chain that stays at rest has a feed that is none: it takes no time here, and for ever on the
            // machine.
            return !(rested && time == 0.0 && self.chain.rests());
        }
        let cycle = self.machine.general.interpolator_cycle_s;
        self.turn_towards(self.speed.rpm(x), cycle);
        let rpm = self.rpm.abs();
        let Some(step) = self.chain.tick(&at(rpm)) else { return false };
        if step.along.v == 0.0 && rpm == 0.0 {
            return false;
        }
        self.x = Some(step.tag.from[i].moved(step.axes[i].s));
        self.moved += cycle;
        true
    }

    /// Time passes; the spindle comes nearer to its speed.
    fn pass_time(&mut self, seconds: f64) {
        self.seconds += seconds;
        self.turn_towards(self.wanted().abs(), seconds);
    }

    /// The spindle's ramp towards a speed in its programmed direction.
    fn turn_towards(&mut self, rpm: f64, seconds: f64) {
        let ramp = self.machine.spindle.ramp_rpm_s;
        let (way, off) = (ramp * seconds, self.mode.sign() * rpm - self.rpm);
        self.rpm += off.clamp(-way, way);
        let band = self.machine.spindle.at_speed_pct / 100.0 * rpm;
        self.even += (seconds - (off.abs() - band).max(0.0) / ramp).max(0.0);
    }

    /// Signed speed of the spindle that the program asks for where the axes are, 1/min.
    fn wanted(&self) -> f64 {
        self.mode.sign() * self.speed.rpm(self.at[Axis::X.index()])
    }

    /// Until the spindle is in its band.
    fn wait_for_spindle(&mut self) {
        let spindle = &self.machine.spindle;
        let wanted = self.wanted();
        let band = spindle.at_speed_pct / 100.0 * wanted.abs();
        let off = ((wanted - self.rpm).abs() - band).max(0.0);
        self.pass_time(off / spindle.ramp_rpm_s);
    }
}
