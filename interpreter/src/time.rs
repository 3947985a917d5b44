//! How long machine code takes. In: codes in the order of the program. Out: seconds at 100 % override.
//!
//! Moves are planned by the same chain that the interpolator runs (M16–M26, M66), so look-ahead, blends and path modes
//! count as they do on the machine; a chain ends on an interpolator cycle. The spindle follows its ramp while rapids
//! move; a feed waits until it is at speed. A pass takes its angle at the programmed speed and, in the mean, half a
//! turn of waiting for the index. How long a pause lasts is up to the operator; it counts as nothing.

use motion::chain::{Ask, Chain, Ratios};
use protocol::{
    Axis, Code, Feed, Leg, Machine, PerAxis, Position, Route, Routed, SpindleMode, SpindleSpeed, units::AXES,
};

/// Interpolator cycles from the decision to arm a pass to the first index that counts, and back to timed motion.
const PASS_CYCLES: f64 = 8.0;

/// Adds up time.
pub(crate) struct Clock<'m> {
    machine: &'m Machine,
    route: Route,
    chain: Chain<AXES, Leg>,
    last: Option<Leg>,
    at: PerAxis<Position>,
    mode: SpindleMode,
    speed: SpindleSpeed,
    /// Signed speed that the spindle has, 1/min.
    rpm: f64,
    /// Time of the chain in hand, s.
    moved: f64,
    seconds: f64,
}

impl<'m> Clock<'m> {
    pub(crate) fn new(machine: &'m Machine) -> Clock<'m> {
        let mut at = PerAxis::<Position>::default();
        for (axis, config) in machine.axes() {
            at[axis.index()] = Position::from_mm(config.home_mm);
        }
        Clock {
            machine,
            route: Route::new(machine),
            chain: Chain::new(Route::settings(machine)),
            last: None,
            at,
            mode: SpindleMode::Stop,
            speed: SpindleSpeed::Rpm(0.0),
            rpm: 0.0,
            moved: 0.0,
            seconds: 0.0,
        }
    }

    pub(crate) fn seconds(&self) -> f64 {
        self.seconds + self.moved
    }

    pub(crate) fn add(&mut self, line: u32, code: &Code) {
        match code {
            Code::Line { .. } | Code::Arc { .. } => return self.travel(line, code),
            Code::PathMode(mode) => return self.route.set_mode(*mode),
            _ => self.finish(),
        }
        match code {
            Code::Dwell { seconds } => self.pass_time(*seconds),
            Code::Spindle { mode, speed } => (self.mode, self.speed) = (*mode, *speed),
            Code::Pass(pass) => {
                self.wait_for_spindle();
                for (axis, _) in self.machine.axes() {
                    self.at[axis.index()] = pass.axis(axis).end;
                }
                let arming = PASS_CYCLES * self.machine.machine.interpolator_cycle_s;
                self.pass_time((pass.done_deg() + 180.0) / (6.0 * pass.s_rpm) + arming);
            }
            Code::End => self.mode = SpindleMode::Stop,
            _ => {}
        }
    }

    /// A move behind the last one: planned when the chain is full, or over.
    fn travel(&mut self, line: u32, code: &Code) {
        let from = self.last.map_or(self.at, |last| last.to);
        let Ok(Routed::Block(block)) = self.route.block(line, code, &from) else { return };
        if self.last.is_some_and(|last| !last.joins(&block.tag)) {
            self.finish();
        }
        if self.last.is_none() && block.tag.feed != Feed::Rapid {
            self.wait_for_spindle();
        }
        while !self.chain.has_room() && self.leap() {}
        self.last = Some(block.tag);
        self.chain.push(block);
    }

    /// Plans the chain to its end, which lies on an interpolator cycle.
    pub(crate) fn finish(&mut self) {
        self.chain.close();
        while self.leap() {}
        let cycle = self.machine.machine.interpolator_cycle_s;
        let moved = (self.moved / cycle).ceil() * cycle;
        self.moved = 0.0;
        self.chain.clear();
        if let Some(last) = self.last.take() {
            self.at = last.to;
        }
        self.pass_time(moved);
    }

    /// One law of the chain; false at its end.
    fn leap(&mut self) -> bool {
        let x = self.chain.here().map_or(self.at, |leg| leg.from)[Axis::X.index()];
        let ratios = Ratios::full(self.speed.rpm(x) / 60.0);
        let ask = Ask { ratios, hold: false, single: false, more: true };
        let time = self.chain.skip(&ask);
        self.moved += time.unwrap_or(0.0);
        time.is_some()
    }

    /// Time passes; the spindle comes nearer to its speed.
    fn pass_time(&mut self, seconds: f64) {
        self.seconds += seconds;
        let (wanted, way) = (self.wanted(), self.machine.spindle.ramp_rpm_s * seconds);
        self.rpm += (wanted - self.rpm).clamp(-way, way);
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
