//! Drive of one axis: velocity loop, quick stop, trips (cyclic synchronous velocity mode). In: the command of
//! a cycle and the encoder's count in it. Out: the torque that acts from the next cycle on, N·m.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | v_cmd | mm/s | target velocity + velocity offset |
//! | v_meas | mm/s | one difference of the encoder: the mean speed of the cycle before |
//! | Kp, Ti | N·m s/mm, s | gain M 2π f_v lead/2π of the believed mass M, and integral time |
//! | T | N·m | limit of the torque |
//! | v_f, v_0 | mm/s | speeds up to which the voltage lets the motor give it all, and at which it is used up |
//!
//! ```text
//! torque = Kp (v_cmd − v_meas) + I + torque offset,   dI/dt = Kp/Ti (v_cmd − v_meas)                   (M54)
//! |torque| ≤ T; in the direction of v_meas ≤ T (v_0 − |v_meas|)/(v_0 − v_f), at least 0, above v_f     (M110)
//! ```
//! A motor that brakes keeps T: the voltage is on its side. The integral stands still while the torque is at
//! its limit and the error would drive it further.
//!
//! A command that no regulator gives trips the drive: numbers that are none, a speed beyond that of the trip,
//! a torque offset well beyond the limit, the answer to a measurement that was not made yet.
//!
//! One that does not come in time is made up for: the one before is held, and an axis that braked brakes on.
//! With d the velocity offset's change per cycle and n the cycles that the command in force is old,
//!
//! ```text
//! offset = v + n d where v d < 0, not beyond 0, else v                                                (M270)
//! ```
//! The third in a row is told in the status word; after `lost_commands` the drive trips.

use core::f64::consts::TAU;

use machine::AxisConfig;
use protocol::{Cycle, DriveCommand, DriveState, StatusWord};

use crate::config::AxisTrain;
use crate::drive_state::StateMachine;

/// A command this many cycles old is told in the status word.
const LATE: u64 = 3;
/// Below this measured speed a braking axis stands still, mm/s.
const STANDSTILL_MM_S: f64 = 1.0;
/// Largest torque offset that is believed, by the limit: differences of coarsely rounded positions ask for
/// many times what a drive has.
const OFFSET_SHARE: f64 = 100.0;

/// What happens to a drive from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Trip {
    /// It reports a fault and brakes on its ramp.
    Brakes,
    /// Its motor has no torque any more, and the brake holds.
    TorqueLost,
}

/// The drive of one axis.
#[derive(Clone, Debug)]
pub(crate) struct Drive {
    machine: StateMachine,
    gain: f64,
    integral_gain: f64,
    limit_nm: f64,
    fading_mm_s: Option<[f64; 2]>,
    braking_step: f64,
    overspeed_mm_s: f64,
    /// A command so many cycles old trips the drive.
    lost_commands: u64,
    /// The newest velocity offset and its cycle, mm/s, and by how much it changes per cycle.
    newest: (Cycle, f64),
    change_mm_s: f64,
    integral_nm: f64,
    braking_mm_s: f64,
    calls: bool,
    late: bool,
    trip: Option<Trip>,
}

impl Drive {
    pub(crate) fn new(config: &AxisConfig, train: &AxisTrain, lost_commands: u32, cycle_s: f64) -> Drive {
        // N at the slide per m/s, to N·m at the motor per mm/s.
        let torque_per_force = config.screw_lead_mm * 1e-3 / TAU;
        let gain = config.mass_kg * TAU * config.velocity_bandwidth_hz * torque_per_force * 1e-3;
        Drive {
            machine: StateMachine::new(),
            gain,
            integral_gain: gain * cycle_s / config.velocity_integral_s,
            limit_nm: train.facts(config).torque_limit_nm,
            fading_mm_s: train.fading_mm_s(),
            braking_step: train.quick_stop_mm_s2 * cycle_s,
            overspeed_mm_s: train.overspeed_mm_s,
            lost_commands: lost_commands.into(),
            newest: Default::default(),
            change_mm_s: 0.0,
            integral_nm: 0.0,
            braking_mm_s: 0.0,
            calls: false,
            late: false,
            trip: None,
        }
    }

    /// As it is when it is switched on again: before its first command, without a fault.
    pub(crate) fn switch_on(&mut self) {
        (self.machine, self.calls, self.late, self.trip) = (StateMachine::new(), false, false, None);
        (self.integral_nm, self.braking_mm_s) = (0.0, 0.0);
        (self.newest, self.change_mm_s) = Default::default();
    }

    /// The state, what the regulator wants the others to see, and whether it is late.
    pub(crate) fn status_word(&self) -> StatusWord {
        let StatusWord(word) = StatusWord::of(self.machine.state());
        let calls = if self.calls { StatusWord::CALLS } else { 0 };
        let late = if self.late { StatusWord::LATE } else { 0 };
        StatusWord(word | calls | late)
    }

    /// Whether the drive follows its regulator.
    pub(crate) fn is_enabled(&self) -> bool {
        self.machine.state() == DriveState::OperationEnabled
    }

    /// Something happens to the drive in its next cycle.
    pub(crate) fn trip(&mut self, trip: Trip) {
        self.trip = Some(trip);
    }

    /// The answer to a command in a cycle, which was under way for `late` cycles: torque for the next one, or
    /// `None` without power, when the brake holds.
    pub(crate) fn answer(
        &mut self,
        now: Cycle,
        late: u64,
        command: &DriveCommand,
        v_meas: f64,
    ) -> Option<f64> {
        let old = now.0.saturating_sub(command.cycle.0.saturating_add(late));
        let (offset_mm_s, offset_nm) = self.offsets(old, command);
        let v_cmd = command.target_velocity_mm_s + offset_mm_s;
        let was_powered = self.machine.powered();
        self.late = was_powered && old >= LATE;
        let late = was_powered && old >= self.lost_commands;
        let overspeed = was_powered && v_meas.abs() > self.overspeed_mm_s;
        let standstill = !was_powered || (self.braking_mm_s == 0.0 && v_meas.abs() < STANDSTILL_MM_S);
        let tripped = !self.believes(now, command, v_cmd) || late || overspeed;
        self.calls = command.control_word & DriveCommand::CALLS != 0;
        match self.trip.take() {
            Some(Trip::TorqueLost) => self.machine.fail(command.control_word),
            trip => self.machine.step(command.control_word, tripped || trip.is_some(), standstill),
        }
        if !self.machine.powered() {
            self.integral_nm = 0.0;
            self.braking_mm_s = 0.0;
            return None;
        }
        if self.is_enabled() {
            self.braking_mm_s = v_meas;
            return Some(self.velocity_loop(v_cmd, v_meas, offset_nm));
        }
        let left = self.braking_mm_s.abs() - self.braking_step;
        self.braking_mm_s = if left > 0.0 { left.copysign(self.braking_mm_s) } else { 0.0 };
        Some(self.velocity_loop(self.braking_mm_s, v_meas, 0.0))
    }

    /// The offsets of a command that is so many cycles old (M270), mm/s and N·m.
    fn offsets(&mut self, old: u64, command: &DriveCommand) -> (f64, f64) {
        let (offset_mm_s, (before, before_mm_s)) = (command.velocity_offset_mm_s, self.newest);
        if command.cycle != before {
            let cycles = command.cycle.0.abs_diff(before.0) as f64;
            self.change_mm_s = (offset_mm_s - before_mm_s) / cycles;
            self.newest = (command.cycle, offset_mm_s);
        }
        let braked_mm_s = offset_mm_s + old as f64 * self.change_mm_s;
        match (self.change_mm_s * offset_mm_s < 0.0, braked_mm_s * offset_mm_s > 0.0) {
            (false, _) => (offset_mm_s, command.torque_offset_nm),
            (true, true) => (braked_mm_s, command.torque_offset_nm),
            (true, false) => (0.0, 0.0),
        }
    }

    /// Whether a regulator could have meant this. Comparisons with what is no number are false.
    fn believes(&self, now: Cycle, command: &DriveCommand, v_cmd: f64) -> bool {
        v_cmd.abs() <= self.overspeed_mm_s
            && command.torque_offset_nm.abs() <= OFFSET_SHARE * self.limit_nm
            && command.cycle <= now
    }

    fn velocity_loop(&mut self, v_cmd: f64, v_meas: f64, offset_nm: f64) -> f64 {
        let error_mm_s = v_cmd - v_meas;
        let integral_nm = self.integral_nm + self.integral_gain * error_mm_s;
        let torque = self.gain * error_mm_s + integral_nm + offset_nm;
        let [low, high] = self.limits_nm(v_meas);
        let limited = torque.clamp(low, high);
        if torque == limited || (torque > limited) != (error_mm_s > 0.0) {
            self.integral_nm = integral_nm.clamp(-self.limit_nm, self.limit_nm);
        }
        limited
    }

    /// Lowest and highest torque at a speed (M110), N·m.
    fn limits_nm(&self, v_meas: f64) -> [f64; 2] {
        let share = self
            .fading_mm_s
            .map_or(1.0, |[full, none]| ((none - v_meas.abs()) / (none - full)).clamp(0.0, 1.0));
        let motoring = share * self.limit_nm;
        if v_meas < 0.0 { [-motoring, self.limit_nm] } else { [-self.limit_nm, motoring] }
    }
}
