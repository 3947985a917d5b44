//! Turns the spindle round in a tap. In: a pass that returns, once a tick the angle and the speed that the
//! axis along it has been led by, degrees since the index and degrees/s, growing inwards. Out: the speed for
//! the spindle, 1/min, signed; nothing as long as program and override say it.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | C, w | deg, deg/s | angle and speed when a command of this tick is in force |
//! | C_t | deg | programmed depth |
//! | b | deg/s² | 6 β: what a turn is planned with (`machine/src/tapping.rs`) |
//! | δ | s | what drive and observer may be behind: four ticks |
//!
//! ```text
//! r = C_t − b δ²/2 − C                             what is left until the tool shall rest
//! w = √(2 b r), 0 from r = 0 on                    inwards                                        (M212)
//! |dw/dt| ≤ 6/5 b                                  inwards, through rest, and outwards
//! ∫ w_e − 10 |ΔC_counted| ≤ 15°, never below 0         else it is stopped                        (M213)
//!     w_e = |w|, but no more than what it was counted to be last, and b from there
//! ```
//! A drive that has lost its torque, or most of it, neither holds the speed nor changes it:
//!
//! ```text
//! n = speed by the count, over 20 ms;  b' = b/4;  d = 2 at_speed of S
//! in          r = min(asked, r + b' dt)                  ∫ r/2 − n ≤ 15°, never below 0
//! from there  r = max(command, min(r, n) − b' dt)       ∫ n − r − d ≤ 15°, never below 0        (M205)
//! ```
//! A spindle that is told to turn outwards and gets faster inwards, by more than 180 deg/s, or that turns
//! outwards as fast before it is told to, does the opposite of what it is told.
//!
//! So the spindle is braked by where it *is*: one that is braked late or lags is braked harder, as long as
//! its ramp has more to give, and comes to rest in front of the depth, not behind it. While it turns round it
//! is not overridden. A tool that leaves is braked at once and taken out likewise, from wherever it is.
//!
//! Where nobody may turn the spindle round, or it does not turn, it is stopped and stays so; the axes stay on
//! the helix until it rests.

use machine::Machine;
use protocol::{Cycle, ThreadPass};

/// δ, ticks.
const BEHIND_TICKS: f64 = 4.0;
/// How much faster than planned the speed may change.
const FASTER: f64 = 1.2;
/// A spindle that is slower than this does not turn outwards yet, deg/s.
const STANDS_DEG_S: f64 = 6.0;
/// It does the opposite of what it is told if it is that much faster than it could be, deg/s.
const WRONG_DEG_S: f64 = 180.0;
/// A spindle that was told to turn so far, degrees, and whose count says less than a tenth of it, does not
/// turn, or its encoder is dead: at the turn nobody else can tell (M213).
const STUCK_DEG: f64 = 15.0;
const STUCK_SHARE: f64 = 0.1;

/// It has no torque if it changes its speed by less than this share of what is planned, or has less than that
/// share of its speed on the way in (M205); its speed by the count is a mean over so long, s.
const WEAK_SHARE: f64 = 0.25;
const SLOW_SHARE: f64 = 0.5;
const MEAN_S: f64 = 0.02;

/// How far the spindle is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    /// As fast as program and override say.
    In,
    /// It is braked towards the depth, or, of a tool that leaves, at once.
    Brakes { leaves: bool },
    /// It stands at the depth for so many ticks more.
    Rests { left: f64 },
    /// It turns outwards. `turned`: it was at the depth, and nobody told the tool to leave before.
    Out { turned: bool },
    /// It is stopped in the hole.
    Stopped,
}

/// What is known of the spindle in a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turning {
    /// Angle since the index and speed, in the direction of the pass, deg and deg/s, and their cycle.
    pub(crate) angle_deg: f64,
    pub(crate) speed: f64,
    pub(crate) of: Cycle,
    /// The tick.
    pub(crate) tick: Cycle,
    /// Its count.
    pub(crate) count: i64,
    /// What program and override ask for, 1/min, positive.
    pub(crate) asked_rpm: f64,
    /// The axes leave the pass.
    pub(crate) leaves: bool,
    /// The spindle may be turned round.
    pub(crate) reversible: bool,
}

/// The spindle of a tap.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tap {
    phase: Phase,
    /// Commanded speed, inwards, deg/s.
    command: f64,
    /// What it was told to turn beyond ten times what it did, degrees; the last count, and a count, degrees.
    missing_deg: f64,
    /// How fast it should be by now, deg/s.
    expected: f64,
    /// Its lowest speed inwards since it was told to turn outwards, deg/s.
    slowest: f64,
    count: Option<i64>,
    count_deg: f64,
    /// Its speed by the count, inwards, the one it should have by now at worst, deg/s; what it is behind,
    /// degrees.
    counted: f64,
    due: f64,
    lag_deg: f64,
    band: f64,
    brake: f64,
    tick_s: f64,
    cycle_s: f64,
}

impl Tap {
    pub(crate) fn new(machine: &Machine) -> Tap {
        Tap {
            phase: Phase::In,
            command: 0.0,
            missing_deg: 0.0,
            expected: 0.0,
            slowest: f64::INFINITY,
            count: None,
            count_deg: 360.0 / machine.spindle_counts(),
            counted: 0.0,
            due: 0.0,
            lag_deg: 0.0,
            band: 2.0 * machine.spindle.at_speed_pct / 100.0,
            brake: 6.0 * machine.tap_ramp_rpm_s(),
            tick_s: machine.general.interpolator_cycle_s,
            cycle_s: machine.general.cycle_s,
        }
    }

    /// A pass that returns was armed, or none is in hand.
    pub(crate) fn reset(&mut self) {
        (self.phase, self.command, self.count) = (Phase::In, 0.0, None);
        (self.missing_deg, self.expected, self.slowest) = (0.0, 0.0, f64::INFINITY);
        self.lag_deg = 0.0;
    }

    /// Whether the tool was at the programmed depth and is on its way out, or out.
    pub(crate) fn has_turned(&self) -> bool {
        self.phase == Phase::Out { turned: true }
    }

    /// Whether the spindle is told to turn, and does: nobody waits in vain meanwhile.
    pub(crate) fn goes_on(&self) -> bool {
        matches!(self.phase, Phase::Brakes { .. } | Phase::Rests { .. } | Phase::Out { .. })
            && !self.is_stuck()
    }

    /// Whether the spindle was told to turn and does not, as far as its encoder shows.
    pub(crate) fn is_stuck(&self) -> bool {
        self.missing_deg > STUCK_DEG
    }

    /// Whether its drive has so little torque that it does not do what it is told (M205).
    pub(crate) fn lags(&self) -> bool {
        self.lag_deg > STUCK_DEG
    }

    /// The direction in which the spindle should turn by now, inwards positive; none while it turns round.
    pub(crate) fn direction(&self, speed: f64) -> Option<f64> {
        match self.phase {
            Phase::In => Some(1.0),
            Phase::Brakes { .. } | Phase::Rests { .. } if speed < -WRONG_DEG_S => Some(1.0),
            // What an observer sees for a moment of a turn that does not come is none.
            Phase::Out { .. } if speed.max(self.counted) < -STANDS_DEG_S => Some(-1.0),
            Phase::Out { .. } if speed > self.slowest + WRONG_DEG_S => Some(-1.0),
            _ => None,
        }
    }

    /// One tick of a pass that has begun. The speed for the spindle, 1/min, inwards positive; nothing as long
    /// as that is for program and override.
    pub(crate) fn tick(&mut self, pass: &ThreadPass, turning: &Turning) -> Option<f64> {
        let begins_deg = pass.axis(pass.along()).run_in_c0_deg;
        match self.phase {
            Phase::Stopped => {}
            _ if turning.leaves && !turning.reversible || self.is_stuck() || self.lags() => {
                self.phase = Phase::Stopped;
            }
            Phase::In if turning.leaves && turning.angle_deg >= begins_deg => {
                (self.phase, self.command) = (Phase::Brakes { leaves: true }, 6.0 * turning.asked_rpm);
            }
            Phase::In if self.wanted(pass, turning) < 6.0 * turning.asked_rpm => {
                (self.phase, self.command) = (Phase::Brakes { leaves: false }, 6.0 * turning.asked_rpm);
            }
            Phase::Brakes { .. } | Phase::Rests { .. } if turning.leaves => {
                self.phase = if self.command > 0.0 { Phase::Brakes { leaves: true } } else { OUT_EARLY };
            }
            _ => {}
        }
        self.turn(pass, turning);
        let counts = turning.count.saturating_sub(self.count.unwrap_or(turning.count));
        let turned = counts as f64 * self.count_deg * pass.direction;
        if matches!(self.phase, Phase::Out { .. }) {
            self.slowest = self.slowest.min(turning.speed.max(turned / self.tick_s).max(0.0));
        }
        self.obeys(pass, turned, 6.0 * turning.asked_rpm);
        self.compare(turning.count);
        (self.phase != Phase::In).then_some(self.command / 6.0)
    }

    fn turn(&mut self, pass: &ThreadPass, turning: &Turning) {
        let out = -6.0 * pass.s_rpm * pass.return_ratio;
        let step = FASTER * self.brake * self.tick_s;
        match self.phase {
            Phase::In => {}
            Phase::Brakes { leaves } => {
                let wanted = if leaves { 0.0 } else { self.wanted(pass, turning) };
                self.command = wanted.clamp(self.command - step, self.command).max(0.0);
                if self.command == 0.0 {
                    self.phase = match (leaves, pass.dwell_s > 0.0) {
                        (true, _) => OUT_EARLY,
                        (false, true) => Phase::Rests { left: pass.dwell_s / self.tick_s },
                        (false, false) => Phase::Out { turned: true },
                    };
                }
            }
            Phase::Rests { left } if left <= 1.0 => self.phase = Phase::Out { turned: true },
            Phase::Rests { left } => self.phase = Phase::Rests { left: left - 1.0 },
            Phase::Out { .. } => self.command = out.max(self.command - self.brake * self.tick_s),
            Phase::Stopped => self.command = 0.0,
        }
    }

    /// (M213)
    fn compare(&mut self, count: i64) {
        let before = self.count.replace(count).unwrap_or(count);
        if !matches!(self.phase, Phase::Brakes { .. } | Phase::Out { .. }) || self.is_stuck() {
            return;
        }
        let turned = count.saturating_sub(before).unsigned_abs() as f64 * self.count_deg;
        // From where it is it gets faster by its ramp at most: a drive that is late comes through rest late.
        let before = if turned > 0.0 { turned / self.tick_s } else { self.expected };
        self.expected = (before + self.brake * self.tick_s).min(self.command.abs());
        let missing = self.expected * self.tick_s - turned / STUCK_SHARE;
        self.missing_deg = (self.missing_deg + missing).max(0.0);
    }

    /// (M205)
    fn obeys(&mut self, pass: &ThreadPass, turned: f64, asked: f64) {
        let fresh = (self.tick_s / MEAN_S).min(1.0);
        self.counted = match self.count {
            Some(_) => self.counted + fresh * (turned / self.tick_s - self.counted),
            None => asked,
        };
        let step = WEAK_SHARE * self.brake * self.tick_s;
        let behind = match self.phase {
            Phase::In => {
                self.due = if self.count.is_some() { asked.min(self.due + step) } else { asked };
                SLOW_SHARE * self.due - self.counted
            }
            Phase::Stopped => return,
            _ => {
                self.due = self.command.max(self.due.min(self.counted) - step);
                self.counted - self.due - self.band * 6.0 * pass.s_rpm
            }
        };
        self.lag_deg = (self.lag_deg + behind * self.tick_s).max(0.0);
    }

    /// (M212)
    fn wanted(&self, pass: &ThreadPass, turning: &Turning) -> f64 {
        let behind_s = BEHIND_TICKS * self.tick_s;
        let ahead_s = (turning.tick.0.saturating_sub(turning.of.0)) as f64 * self.cycle_s + self.tick_s;
        let slows = if self.phase == Phase::In { 0.0 } else { self.brake };
        let angle = turning.angle_deg + (turning.speed - 0.5 * slows * ahead_s) * ahead_s;
        let left = pass.thread_end_deg - 0.5 * self.brake * behind_s * behind_s - angle;
        (2.0 * self.brake * left.max(0.0)).sqrt()
    }
}

/// Out of the hole from in front of the depth.
const OUT_EARLY: Phase = Phase::Out { turned: false };
