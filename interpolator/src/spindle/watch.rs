//! Whether the spindle does what it was told. In: once a tick its count, the speed commanded and observed in
//! 1/min, the direction of a pass in hand. Out: a fault, or none.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | n, c | 1/min | speed by the counts of one tick, speed commanded |
//! | r | 1/min per s | a third of the drive's ramp: a spindle that is slow is not at fault |
//! | m | 1/min | the highest speed that the commands explain: max(\|c\|, m − r t) |
//! | u | 1/min | the lowest speed since it is faster than m, as long as it goes on losing speed; else m |
//! | d | 1/min | the speed it should have by now: grows to c, at r |
//! | b | – | share that counts as at speed |
//!
//! ```text
//! runs away       ∫ \|n\| − (1 + 2b) u − 2 % of the highest speed, never below 0, exceeds a turn
//! reversed        three ticks backwards at 5 % of c, or a turn back: in a pass
//! stalls          observed < \|d\|/10 for a second and a quarter turn of c: in a pass
//! does not stop   c = 0, m = 0, and five seconds later it does not rest (`rest.rs`)
//! may rest        c = 0 for as long as the drive's ramp takes, and 0.2 s
//! loses speed     by a hundredth of its highest speed within five seconds; these begin anew then
//! ```
//! A drive without torque coasts: a spindle that only gets slower has not run away.

use machine::{Machine, SpindleConfig};
use protocol::Fault;

use super::rest::Rest;

/// How much slower than its ramp a spindle may change its speed.
const SLOWER: f64 = 3.0;
/// How far it may turn beyond what its commands explain, turns.
const BEYOND_TURNS: f64 = 1.0;
/// What of its highest speed is never taken for running away.
const BEYOND_SHARE: f64 = 0.02;
/// It turns the wrong way if it does so for so many ticks, at this share of the speed commanded and at least
/// at so many counts a tick and 1/min,
const WRONG_TICKS: u32 = 3;
const WRONG_SHARE: f64 = 0.05;
const WRONG_COUNTS: f64 = 4.0;
const WRONG_RPM: f64 = 20.0;
/// or if it has turned so far back, turns.
const BACK_TURNS: f64 = 1.0;
/// It stalls if it is below this share of its speed for so long and so far, s and turns.
const STALL_SHARE: f64 = 0.1;
const STALL_S: f64 = 1.0;
const STALL_TURNS: f64 = 0.25;
/// Time beyond its ramp until a spindle that was told to stop does not, s.
const STOP_S: f64 = 5.0;
/// What of its highest speed it has to lose in that time, or it does not slow down.
const SIGN_SHARE: f64 = 0.01;

/// An encoder that shows less than this share of what it should may be dead.
const DOUBT_SHARE: f64 = 0.5;

/// What is known of the spindle's obedience.
#[derive(Clone, Debug)]
pub(super) struct Watch {
    tick_s: f64,
    turn_counts: f64,
    rate: f64,
    max_rpm: f64,
    band: f64,
    count: Option<i64>,
    /// m and d.
    most: f64,
    due: f64,
    /// u, as long as it loses speed; what it was at the last sign of that, and for how many s there was none.
    slowest: f64,
    sign_rpm: f64,
    sign_s: f64,
    beyond_turns: f64,
    wrong_ticks: u32,
    back_turns: f64,
    stalled: (f64, f64),
    /// Ticks for which it should have stood.
    late: u64,
    /// The speed it has by the ramp of its drive at most, 1/min, and for how many s that has been none.
    ramped: f64,
    ramped_s: f64,
    rest: Rest,
    /// It was to turn, and its encoder showed less than half of that.
    doubtful: bool,
}

impl Watch {
    pub(super) fn new(machine: &Machine) -> Watch {
        Watch {
            tick_s: machine.general.interpolator_cycle_s,
            turn_counts: machine.spindle_counts(),
            rate: machine.spindle.ramp_rpm_s / SLOWER,
            max_rpm: machine.spindle.max_rpm,
            band: machine.spindle.at_speed_pct / 100.0,
            count: None,
            most: 0.0,
            due: 0.0,
            slowest: 0.0,
            sign_rpm: 0.0,
            sign_s: 0.0,
            beyond_turns: 0.0,
            wrong_ticks: 0,
            back_turns: 0.0,
            stalled: (0.0, 0.0),
            late: 0,
            ramped: 0.0,
            ramped_s: f64::INFINITY,
            rest: Rest::new(machine),
            doubtful: false,
        }
    }

    /// One tick. `pass` is the direction of a pass in hand.
    pub(super) fn update(&mut self, count: i64, commanded: f64, observed: f64, pass: Option<f64>) {
        let before = self.count.replace(count).unwrap_or(count);
        let step = self.rate * self.tick_s;
        self.most = commanded.abs().max(self.most - step);
        self.ramped = commanded.abs().max(self.ramped - SLOWER * step);
        self.ramped_s = if self.ramped > 0.0 { 0.0 } else { self.ramped_s + self.tick_s };
        // A spindle may well be slower than it was: what it should have grows alone.
        let turned = commanded * self.due < 0.0;
        self.due =
            if turned { 0.0 } else { (self.due.abs() + step).min(commanded.abs()).copysign(commanded) };
        // A count that jumps is a matter of the encoder: no spindle turns that fast.
        let most = 2.0 * self.max_rpm / 60.0 * self.tick_s;
        let turns = ((count.wrapping_sub(before)) as f64 / self.turn_counts).clamp(-most, most);
        if self.due != 0.0 {
            self.doubtful = observed.abs() < DOUBT_SHARE * self.due.abs();
        }
        self.slow_down(observed.abs());
        self.run_away(turns);
        self.rest.update(count);
        self.stop(commanded);
        let ahead = pass.map(|direction| turns * direction);
        self.reverse(ahead, commanded);
        self.stall(pass.is_some(), commanded, observed);
    }

    fn slow_down(&mut self, rpm: f64) {
        if rpm <= self.most {
            (self.slowest, self.sign_rpm, self.sign_s) = (self.most, self.most, 0.0);
            return;
        }
        self.slowest = self.slowest.min(rpm).max(self.most);
        self.sign_s += self.tick_s;
        if self.slowest <= self.sign_rpm - SIGN_SHARE * self.max_rpm {
            (self.sign_rpm, self.sign_s, self.late) = (self.slowest, 0.0, 0);
        }
    }

    fn run_away(&mut self, turns: f64) {
        let had = if self.sign_s <= STOP_S { self.slowest } else { self.most };
        let explained = (1.0 + 2.0 * self.band) * had + BEYOND_SHARE * self.max_rpm;
        let beyond = turns.abs() - explained / 60.0 * self.tick_s;
        self.beyond_turns = (self.beyond_turns + beyond).max(0.0);
    }

    fn reverse(&mut self, ahead: Option<f64>, commanded: f64) {
        let Some(ahead) = ahead else {
            (self.wrong_ticks, self.back_turns) = (0, 0.0);
            return;
        };
        let rpm = WRONG_RPM.max(WRONG_SHARE * commanded.abs());
        let least = (rpm / 60.0 * self.tick_s).max(WRONG_COUNTS / self.turn_counts);
        self.wrong_ticks = if ahead < -least { self.wrong_ticks + 1 } else { 0 };
        self.back_turns = (self.back_turns - ahead).max(0.0);
    }

    fn stall(&mut self, in_pass: bool, commanded: f64, observed: f64) {
        let stalls = in_pass && commanded != 0.0 && observed.abs() < STALL_SHARE * self.due.abs();
        let (s, turns) = if stalls { self.stalled } else { (-self.tick_s, 0.0) };
        self.stalled = (s + self.tick_s, turns + commanded.abs() / 60.0 * self.tick_s);
    }

    fn stop(&mut self, commanded: f64) {
        let late = commanded == 0.0 && self.most <= 0.0 && !self.rests();
        self.late = if late { self.late + 1 } else { 0 };
    }

    /// Whether it rests.
    pub(super) fn rests(&self) -> bool {
        self.rest.holds()
    }

    /// Whether its drive has had the time to bring it to rest: an encoder that stands sooner has died.
    pub(super) fn may_rest(&self) -> bool {
        self.ramped_s >= SpindleConfig::SETTLES_S
    }

    /// Whether its encoder showed less than half of its speed when it was to turn last.
    pub(super) fn is_doubtful(&self) -> bool {
        self.doubtful
    }

    /// Whether it turns faster than it was told to.
    pub(super) fn runs_away(&self) -> bool {
        self.beyond_turns > BEYOND_TURNS
    }

    /// It is braked otherwise from here on: the time it has for that begins anew, at the speed it has by now;
    /// at its highest if nobody sees it.
    pub(super) fn wait_anew(&mut self, unseen: bool) {
        self.late = 0;
        if unseen {
            self.ramped = SLOWER * self.max_rpm;
        }
        (self.slowest, self.sign_rpm, self.sign_s) = (f64::INFINITY, f64::INFINITY, 0.0);
    }

    /// Whether it was told to stop, and goes on.
    pub(super) fn never_stops(&self) -> bool {
        self.late as f64 * self.tick_s > STOP_S
    }

    /// Whether its commands give it no reason to turn any more, whatever its encoder shows.
    pub(super) fn ran_down(&self) -> bool {
        self.most <= 0.0
    }

    /// What is wrong.
    pub(super) fn fault(&self) -> Option<Fault> {
        match () {
            () if self.wrong_ticks >= WRONG_TICKS || self.back_turns > BACK_TURNS => {
                Some(Fault::SpindleReversed)
            }
            () if self.runs_away() => Some(Fault::SpindleRunaway),
            () if self.never_stops() => Some(Fault::SpindleDoesNotStop),
            () if self.stalled.0 >= STALL_S && self.stalled.1 >= STALL_TURNS => {
                Some(Fault::SpindleNotAtSpeed)
            }
            () => None,
        }
    }
}
