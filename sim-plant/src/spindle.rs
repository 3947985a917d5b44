//! The spindle: drive with ramp and speed loop, inertia, friction, load, ripple, encoder with index. In:
//! commanded speed in 1/min, load torque in N·m. Out: true angle in turns, true speed, encoder counts, the
//! index.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | w, J | rad/s, kg m² | speed and inertia of everything that turns |
//! | set | rad/s | speed on the drive's ramp |
//! | tau | N·m | torque of the motor, with a first-order lag, limited by torque and by power |
//! | r, n, phi | –, –, rad | a harmonic of the ripple as a share of the speed, how often a turn, its phase |
//!
//! ```text
//! tau_cmd = J 2π f (set − w) + I + J dset/dt,    J dw/dt = tau − b w − (friction + load) against the motion
//! angle = q + Σ r/(2π n) sin(2π n q + phi)  with q the turns of the rotor,
//!     so speed = w (1 + Σ r cos(2π n q + phi))                                                       (M112)
//! count = floor(4 lines · angle + offset);  the index lies where the angle is a whole number of turns
//! ```
//! How the count comes about in a real encoder is `reading`.
//!
//! Friction and load only hold back: they can stop the spindle, and never drive it. A drive can be at fault
//! or without power; then it does not what is commanded ([`Drive`]).

use core::f64::consts::TAU;

use machine::SpindleConfig;
use protocol::{Cycle, Measurement};

use crate::config::SpindleTrain;
use crate::encoder::Disturbance;
use crate::reading::Reading;
use crate::seed::Seed;

/// Longest step of the mechanics, s.
const LONGEST_STEP_S: f64 = 125e-6;
/// rad/s in one 1/min.
const RAD_S_PER_RPM: f64 = TAU / 60.0;

/// What the torque of something that jams is more than that of the motor.
const JAM: f64 = 10.0;
/// How far beyond its top speed a spindle runs away, a share of it.
const RUNAWAY: f64 = 1.2;

/// What the drive of the spindle does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Drive {
    /// It goes to a speed on its ramp, 1/min.
    To(f64),
    /// It gives no torque.
    Coasts,
    /// It gives all its torque in the direction of the motion, at rest in that of a command.
    RunsAway(f64),
}

/// A harmonic of the ripple.
#[derive(Clone, Copy, Debug)]
struct Harmonic {
    share: f64,
    per_rev: f64,
    phase: f64,
}

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
    ripple: Vec<Harmonic>,
    reading: Reading,
    set: f64,
    integral_nm: f64,
    torque_nm: f64,
    speed: f64,
    rotor_turns: f64,
    turns: f64,
    rpm: f64,
    /// Angles that were sampled in this cycle and in the one before.
    sampled: f64,
    sampled_before: f64,
    index_turn: f64,
}

impl Spindle {
    /// At rest at an angle, a phase of the ripple and a place within a count that only the seed knows; what
    /// else there is to draw comes from `own`. The encoder counts from where the spindle stands.
    pub(crate) fn new(
        config: &SpindleConfig,
        train: SpindleTrain,
        cycle_s: f64,
        seed: &mut Seed,
        own: &Seed,
    ) -> Spindle {
        let steps = (cycle_s / LONGEST_STEP_S - 1e-9).ceil() as u32;
        let step_s = cycle_s / f64::from(steps);
        let gain = train.inertia_kg_m2 * TAU * train.speed_bandwidth_hz;
        let counts_per_turn = 4.0 * f64::from(train.encoder_lines.unwrap_or(config.encoder_lines));
        let mut spindle = Spindle {
            cycle_s,
            steps,
            step_s,
            lag_left: libm::exp(-step_s / train.torque_lag_s),
            gain,
            integral_gain: gain * cycle_s / train.speed_integral_s,
            ramp_step: train.ramp_rpm_s.unwrap_or(config.ramp_rpm_s) * RAD_S_PER_RPM * cycle_s,
            top_speed: train.max_rpm.unwrap_or(config.max_rpm) * RAD_S_PER_RPM,
            counts_per_turn,
            count_offset: 0.0,
            ripple: ripple(&train, TAU * seed.fraction(), own.branch(0)),
            reading: Reading::new(&train, counts_per_turn, &own.branch(1)),
            set: 0.0,
            integral_nm: 0.0,
            torque_nm: 0.0,
            speed: 0.0,
            rotor_turns: seed.fraction(),
            turns: 0.0,
            rpm: 0.0,
            sampled: 0.0,
            sampled_before: 0.0,
            index_turn: 0.0,
            train,
        };
        spindle.look();
        spindle.sampled_before = spindle.sampled;
        let at = spindle.sampled;
        spindle.count_offset = seed.fraction() - (at * counts_per_turn + spindle.reading.ahead(at));
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

    /// Control cycle, s.
    pub(crate) fn cycle_s(&self) -> f64 {
        self.cycle_s
    }

    /// True torque of the motor at the spindle, N·m.
    pub(crate) fn torque_nm(&self) -> f64 {
        self.torque_nm
    }

    /// True angle of the last index seen, turns.
    pub(crate) fn index_turn(&self) -> f64 {
        self.index_turn
    }

    /// Its drive is switched on again: it gives no torque yet, and the encoder counts from where the spindle
    /// stands. Lines and index of its disc are where they were, so the count at an index is another one by
    /// whole counts only.
    pub(crate) fn switch_on(&mut self) {
        (self.set, self.integral_nm, self.torque_nm) = (self.speed, 0.0, 0.0);
        self.sampled_before = self.sampled;
        let at = self.sampled;
        let shown = (at * self.counts_per_turn + self.count_offset + self.reading.ahead(at)).floor();
        self.count_offset -= shown;
    }

    /// What holds the spindle back when it jams, N·m.
    pub(crate) fn jam_nm(&self) -> f64 {
        JAM * self.train.peak_torque_nm
    }

    /// One control cycle, held back by a load in N·m, 0 or more.
    pub(crate) fn advance(&mut self, drive: Drive, load_nm: f64) {
        let command_nm = match drive {
            Drive::To(rpm) => self.speed_loop(rpm),
            Drive::Coasts => {
                self.torque_nm = 0.0;
                self.left_alone(0.0)
            }
            Drive::RunsAway(rpm) => {
                let direction = if self.speed == 0.0 { rpm } else { self.speed };
                let free = self.speed.abs() < RUNAWAY * self.top_speed;
                let torque_nm = if free { self.limit_nm().copysign(direction) } else { 0.0 };
                self.left_alone(torque_nm)
            }
        };
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
        let limit_nm = self.limit_nm();
        let limited = torque.clamp(-limit_nm, limit_nm);
        if torque == limited || (torque > limited) != (error > 0.0) {
            self.integral_nm = integral_nm;
        }
        limited
    }

    /// Most torque of the motor at its speed, N·m.
    fn limit_nm(&self) -> f64 {
        let power_limit_nm = self.train.peak_power_kw * 1e3 / self.speed.abs().max(1e-3);
        self.train.peak_torque_nm.min(power_limit_nm)
    }

    /// A torque past the speed loop, which goes on from the speed that there is.
    fn left_alone(&mut self, torque_nm: f64) -> f64 {
        (self.set, self.integral_nm) = (self.speed, 0.0);
        torque_nm
    }

    /// From the rotor to what turns before the tool.
    fn look(&mut self) {
        let in_turn = self.rotor_turns - self.rotor_turns.floor();
        let mut slope = 1.0;
        self.turns = self.rotor_turns;
        for Harmonic { share, per_rev, phase } in &self.ripple {
            let (sin, cos) = libm::sincos(TAU * per_rev * in_turn + phase);
            self.turns += share / (TAU * per_rev) * sin;
            slope += share * cos;
        }
        self.rpm = self.speed * slope / RAD_S_PER_RPM;
        self.sampled_before = self.sampled;
        self.sampled = self.reading.sampled(self.turns, self.rpm);
    }

    /// Writes what the encoder shows in a cycle.
    ///
    /// Between two cycles the angle only grows or only falls but for the one cycle in which the spindle
    /// reverses, so the whole numbers between the two angles are the indexes that passed. The count at an
    /// index does not depend on when in the cycle it passed. Both are what a disturbed encoder makes of them.
    pub(crate) fn measure(&mut self, now: Cycle, encoder: &mut Disturbance, measurement: &mut Measurement) {
        let (per_turn, offset, reading) = (self.counts_per_turn, self.count_offset, &self.reading);
        let count = |turns: f64, ahead: f64| {
            (turns * per_turn + offset + (ahead + reading.ahead(turns))).floor() as i64
        };
        measurement.spindle_count = encoder.show(now, count(self.sampled, encoder.ahead(self.sampled)));
        let (low, high) = (self.sampled_before.floor(), self.sampled.floor());
        if low == high {
            return;
        }
        let turn = if high > low { high } else { high + 1.0 };
        let at = reading.latched(turn, self.rpm, measurement.index_number);
        if let Some(index_count) = encoder.latch(now, count(at, encoder.ahead(at))) {
            measurement.index_count = index_count;
            self.index_turn = turn;
            measurement.index_number += (high - low).abs() as u64;
            measurement.index_cycle = now;
        }
    }
}

/// The harmonics of the ripple; the phase of the first is drawn first.
fn ripple(train: &SpindleTrain, first_phase: f64, mut phases: Seed) -> Vec<Harmonic> {
    let rows = train.ripple_pct.all().iter().zip(train.ripple_per_rev.all()).enumerate();
    let harmonic = |(index, (pct, per_rev)): (usize, (&f64, &f64))| Harmonic {
        share: 0.01 * pct,
        per_rev: *per_rev,
        phase: if index == 0 { first_phase } else { TAU * phases.fraction() },
    };
    rows.map(harmonic).collect()
}
