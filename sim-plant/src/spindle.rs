//! The spindle: drive with ramp and speed loop, inertia, friction, load, ripple, encoder with index. In:
//! commanded speed in 1/min, load torque in N·m. Out: true angle in turns, true speed, encoder counts, the
//! index.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | w, J | rad/s, kg m² | speed and inertia of everything that turns |
//! | set | rad/s | speed on the drive's ramp |
//! | tau | N·m | torque of the motor, with a first-order lag, limited by torque and by power |
//! | r, n, phi | –, –, rad | ripple as a share of the speed, how often a turn, its phase |
//!
//! ```text
//! tau_cmd = J 2π f (set − w) + I + J dset/dt,    J dw/dt = tau − b w − (friction + load) against the motion
//! angle = q + r/(2π n) sin(2π n q + phi)  with q the turns of the rotor,
//!     so speed = w (1 + r cos(2π n q + phi))
//! count = floor(4 lines · angle + offset);  the index lies where the angle is a whole number of turns
//! ```
//! Friction and load only hold back: they can stop the spindle, and never drive it.

use core::f64::consts::TAU;

use machine::SpindleConfig;
use protocol::{Cycle, Measurement};

use crate::config::SpindleTrain;
use crate::encoder::Disturbance;
use crate::seed::Seed;

/// Longest step of the mechanics, s.
const LONGEST_STEP_S: f64 = 125e-6;
/// rad/s in one 1/min.
const RAD_S_PER_RPM: f64 = TAU / 60.0;

/// The spindle and its drive.
#[derive(Clone, Debug)]
pub(crate) struct Spindle {
    train: SpindleTrain,
    cycle_s: f64,
    steps: u32,
    step_s: f64,
    lag_left: f64,
    gain: f64,
    integral_gain: f64,
    ramp_step: f64,
    top_speed: f64,
    counts_per_turn: f64,
    count_offset: f64,
    ripple_phase: f64,
    set: f64,
    integral_nm: f64,
    torque_nm: f64,
    speed: f64,
    rotor_turns: f64,
    turns: f64,
    rpm: f64,
    index_turn: f64,
}

impl Spindle {
    /// At rest at an angle, a phase of the ripple and a place within a count that only the seed knows. The
    /// encoder counts from where the spindle stands.
    pub(crate) fn new(config: &SpindleConfig, train: SpindleTrain, cycle_s: f64, seed: &mut Seed) -> Spindle {
        let steps = (cycle_s / LONGEST_STEP_S - 1e-9).ceil() as u32;
        let step_s = cycle_s / f64::from(steps);
        let gain = train.inertia_kg_m2 * TAU * train.speed_bandwidth_hz;
        let mut spindle = Spindle {
            train,
            cycle_s,
            steps,
            step_s,
            lag_left: libm::exp(-step_s / train.torque_lag_s),
            gain,
            integral_gain: gain * cycle_s / train.speed_integral_s,
            ramp_step: config.ramp_rpm_s * RAD_S_PER_RPM * cycle_s,
            top_speed: config.max_rpm * RAD_S_PER_RPM,
            counts_per_turn: 4.0 * f64::from(config.encoder_lines),
            count_offset: 0.0,
            ripple_phase: TAU * seed.fraction(),
            set: 0.0,
            integral_nm: 0.0,
            torque_nm: 0.0,
            speed: 0.0,
            rotor_turns: seed.fraction(),
            turns: 0.0,
            rpm: 0.0,
            index_turn: 0.0,
        };
        spindle.look();
        spindle.count_offset = seed.fraction() - spindle.turns * spindle.counts_per_turn;
        spindle
    }

    /// True angle, unwrapped turns clockwise; the index lies at every whole number.
    pub(crate) fn turns(&self) -> f64 {
        self.turns
    }

    /// True speed, 1/min, signed.
    pub(crate) fn rpm(&self) -> f64 {
        self.rpm
    }

    /// True torque of the motor at the spindle, N·m.
    pub(crate) fn torque_nm(&self) -> f64 {
        self.torque_nm
    }

    /// True angle of the last index seen, turns.
    pub(crate) fn index_turn(&self) -> f64 {
        self.index_turn
    }

    /// One control cycle towards a speed in 1/min, held back by a load in N·m, 0 or more.
    pub(crate) fn advance(&mut self, command_rpm: f64, load_nm: f64) {
        let command_nm = self.speed_loop(command_rpm);
        let holding = (self.train.coulomb_nm + load_nm) * self.step_s / self.train.inertia_kg_m2;
        for _ in 0..self.steps {
            self.torque_nm = command_nm + (self.torque_nm - command_nm) * self.lag_left;
            let driving = self.torque_nm - self.train.viscous_nm_s * self.speed;
            let free = self.speed + driving * self.step_s / self.train.inertia_kg_m2;
            let speed = if free.abs() > holding { free - holding.copysign(free) } else { 0.0 };
            self.rotor_turns += 0.5 * (self.speed + speed) * self.step_s / TAU;
            self.speed = speed;
        }
        self.look();
    }

    fn speed_loop(&mut self, command_rpm: f64) -> f64 {
        // A speed that is no number commands nothing: the drive stops.
        let target = if command_rpm.is_finite() { command_rpm * RAD_S_PER_RPM } else { 0.0 };
        let before = self.set;
        let target = target.clamp(-self.top_speed, self.top_speed);
        self.set = target.clamp(before - self.ramp_step, before + self.ramp_step);
        let acceleration = (self.set - before) / self.cycle_s;
        let error = self.set - self.speed;
        let integral_nm = self.integral_nm + self.integral_gain * error;
        let torque = self.gain * error + integral_nm + self.train.inertia_kg_m2 * acceleration;
        let power_limit_nm = self.train.peak_power_kw * 1e3 / self.speed.abs().max(1e-3);
        let limit_nm = self.train.peak_torque_nm.min(power_limit_nm);
        let limited = torque.clamp(-limit_nm, limit_nm);
        if torque == limited || (torque > limited) != (error > 0.0) {
            self.integral_nm = integral_nm;
        }
        limited
    }

    /// From the rotor to what turns before the tool.
    fn look(&mut self) {
        let share = 0.01 * self.train.ripple_pct;
        let per_rev = f64::from(self.train.ripple_per_rev);
        let in_turn = self.rotor_turns - self.rotor_turns.floor();
        let (sin, cos) = libm::sincos(TAU * per_rev * in_turn + self.ripple_phase);
        self.turns = self.rotor_turns + share / (TAU * per_rev) * sin;
        self.rpm = self.speed * (1.0 + share * cos) / RAD_S_PER_RPM;
    }

    /// Writes what the encoder shows in a cycle; `before` is the true angle one cycle earlier, in turns.
    ///
    /// Between two cycles the angle only grows or only falls but for the one cycle in which the spindle
    /// reverses, so the whole numbers between the two angles are the indexes that passed. The count at an
    /// index does not depend on when in the cycle it passed. Both are what a disturbed encoder makes of them.
    pub(crate) fn measure(
        &mut self,
        before: f64,
        now: Cycle,
        encoder: &mut Disturbance,
        measurement: &mut Measurement,
    ) {
        let count = |turns: f64| (turns * self.counts_per_turn + self.count_offset).floor() as i64;
        measurement.spindle_count = count(self.turns) + encoder.shift();
        let (low, high) = (before.floor(), self.turns.floor());
        if low != high && encoder.sees_index(now.0) {
            let turn = if high > low { high } else { high + 1.0 };
            measurement.index_count = count(turn) + encoder.shift();
            self.index_turn = turn;
            measurement.index_number += (high - low).abs() as u64;
            measurement.index_cycle = now;
        }
    }
}
