//! The machine file: what the controller believes about its machine, and, passed through unread, the truth about
//! the simulated plant.
//!
//! Every key has a default (the built-in small lathe), unknown keys are refused, and [`Machine::check`] refuses
//! impossible values with the path of the key. Units are in the names of the keys.

use serde::{Deserialize, Serialize};

use crate::{Arc, Axis, Cycle, PerAxis, Position, ThreadPass, units::AXES};

/// What a machine file that cannot be used has wrong.
#[derive(Debug, thiserror::Error)]
pub enum MachineError {
    /// Not TOML, an unknown key, a missing key, or a value of the wrong type; the message shows the place.
    #[error("in {section}: {error}")]
    Syntax {
        /// The section of the file, as in `[axis.x]`.
        section: String,
        /// Line, column and reason.
        error: Box<toml::de::Error>,
    },
    /// A value that no machine can have.
    #[error("{key} = {value}: {reason}")]
    Value {
        /// Path of the key.
        key: String,
        /// The value given.
        value: String,
        /// What is allowed, and why.
        reason: String,
    },
}

/// A machine file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// `[machine]`
    pub machine: General,
    /// `[axis.x]`, `[axis.z]` …
    pub axis: std::collections::BTreeMap<Axis, AxisConfig>,
    /// `[spindle]`
    pub spindle: SpindleConfig,
    /// `[threading]`
    #[serde(default)]
    pub threading: Threading,
    /// `[tools]`: number → description.
    #[serde(default)]
    pub tools: std::collections::BTreeMap<String, Tool>,
    /// `[plant.*]`: the truth about the simulated plant; the controller never reads it.
    #[serde(default)]
    pub plant: toml::Table,
}

/// `[machine]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct General {
    /// Name, for people.
    pub name: String,
    /// Control cycle, s.
    pub cycle_s: f64,
    /// Interpolator cycle, s: a whole number of control cycles.
    pub interpolator_cycle_s: f64,
    /// Dialect of part programs.
    #[serde(default)]
    pub dialect: Dialect,
    /// Kinematics.
    #[serde(default)]
    pub kinematics: Kinematics,
}

/// Dialect of G-code.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Dialect {
    /// RS274/NGC as LinuxCNC speaks it.
    #[default]
    Linuxcnc,
    /// FANUC lathe programs, G-code system A.
    Fanuc,
}

/// Kinematics of the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kinematics {
    /// X across, Z along the spindle.
    #[default]
    Lathe,
}

/// `[axis.*]`: limits, encoder scale, loops, and what the controller believes about the mechanics.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisConfig {
    /// Lowest and highest position, mm (X: radius).
    pub travel_mm: [f64; 2],
    /// Position at the start of the machine, mm.
    pub home_mm: f64,
    /// Highest speed, mm/s.
    pub velocity_mm_s: f64,
    /// Highest acceleration, mm/s².
    pub acceleration_mm_s2: f64,
    /// Highest jerk, mm/s³.
    pub jerk_mm_s3: f64,
    /// Highest rate of jerk, mm/s⁴.
    pub jerk_rate_mm_s4: f64,
    /// Lead of the screw, mm per turn of the motor.
    pub screw_lead_mm: f64,
    /// Encoder counts per turn of the motor.
    pub encoder_counts: u32,
    /// Gain of the position loop in the regulator, 1/s.
    pub position_gain_1_s: f64,
    /// Bandwidth of the velocity loop in the drive, Hz: Kp = believed inertia × 2π × bandwidth.
    pub velocity_bandwidth_hz: f64,
    /// Integral time of the velocity loop in the drive, s.
    pub velocity_integral_s: f64,
    /// Torque limit of the drive, N·m.
    pub torque_limit_nm: f64,
    /// Moving mass as believed: everything that accelerates, referred to the slide, kg.
    pub mass_kg: f64,
    /// Coulomb friction as believed, N at the slide.
    pub coulomb_n: f64,
    /// Stiffness of friction before it slides, as believed, N/mm.
    pub presliding_n_mm: f64,
    /// Viscous friction as believed, N·s/mm.
    pub viscous_n_s_mm: f64,
    /// Lead of the velocity feedforward (M54), s.
    pub velocity_lead_s: f64,
    /// Lead of the acceleration feedforward (M54), s.
    pub acceleration_lead_s: f64,
    /// Largest servo error in timed motion, mm; beyond it the axis faults.
    pub following_error_mm: f64,
    /// Largest servo error on the helix, mm; beyond it the axis faults.
    pub thread_error_mm: f64,
    /// Servo error below which an axis at rest counts as in position, mm.
    pub in_position_mm: f64,
}

/// `[spindle]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpindleConfig {
    /// Highest speed, 1/min.
    pub max_rpm: f64,
    /// Lines of the encoder (four counts each).
    pub encoder_lines: u32,
    /// Ramp of the drive, 1/min per s.
    pub ramp_rpm_s: f64,
    /// Bandwidth of the angle observer (M53), Hz.
    pub observer_hz: f64,
    /// Highest spindle override, per cent.
    pub override_max_pct: f64,
    /// Band around the commanded speed that counts as "at speed", per cent.
    pub at_speed_pct: f64,
}

/// `[threading]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Threading {
    /// Where the run-out ends.
    pub run_out: RunOut,
    /// Spindle override that run-ins are laid out for, per cent, ≥ 100.
    pub design_override_pct: f64,
    /// Share of the axis limits that a law may use at that override, per cent; the rest is for changes of the
    /// spindle's speed (M8).
    pub limit_share_pct: f64,
    /// Half angle of the flank that a run-out must not touch, degrees: the smallest among the threads to cut.
    pub flank_half_angle_deg: f64,
}

impl Default for Threading {
    fn default() -> Self {
        Threading {
            run_out: RunOut::Within,
            design_override_pct: 120.0,
            limit_share_pct: 90.0,
            flank_half_angle_deg: 14.5,
        }
    }
}

/// Where the run-out of a thread ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RunOut {
    /// At the programmed end: nothing moves beyond it.
    #[default]
    Within,
    /// Full depth to the programmed end, at rest after it.
    Beyond,
}

/// A tool.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tool {
    /// What it is, for people.
    pub name: String,
}

impl MachineError {
    fn syntax(text: &str, error: toml::de::Error) -> MachineError {
        let before = error.span().and_then(|span| text.get(..span.end)).unwrap_or_default();
        let header = before.lines().rev().find_map(|line| line.trim().strip_prefix('[')?.split(']').next());
        let section = header.map_or("the first lines".into(), |name| format!("[{name}]"));
        MachineError::Syntax { section, error: Box::new(error) }
    }
}

impl Default for Machine {
    /// The built-in small lathe, `examples/machines/small-lathe.toml`.
    fn default() -> Self {
        Machine::from_toml(SMALL_LATHE).expect("the built-in machine file is tested")
    }
}

/// The built-in machine file, as `pitchlock machine` prints it.
pub const SMALL_LATHE: &str = include_str!("../../examples/machines/small-lathe.toml");

impl Machine {
    /// Reads and checks a machine file.
    ///
    /// # Errors
    /// [`MachineError`] names the key and the reason.
    pub fn from_toml(text: &str) -> Result<Machine, MachineError> {
        let machine: Machine = toml::from_str(text).map_err(|error| MachineError::syntax(text, error))?;
        machine.check()?;
        Ok(machine)
    }

    /// The axes that exist, in the order of the wire.
    pub fn axes(&self) -> impl Iterator<Item = (Axis, &AxisConfig)> {
        self.axis.iter().map(|(axis, config)| (*axis, config))
    }

    /// Control cycles in one interpolator cycle.
    pub fn cycles_per_tick(&self) -> u64 {
        (self.machine.interpolator_cycle_s / self.machine.cycle_s).round() as u64
    }

    /// Whether the interpolator ticks in a control cycle.
    pub fn is_tick(&self, cycle: Cycle) -> bool {
        cycle.0.is_multiple_of(self.cycles_per_tick())
    }

    /// Feasibility rule: whether every axis can follow a pass up to the ratio it claims (M7, M11), within its travel,
    /// to the end the law names. The pass has been checked.
    pub fn can_follow(&self, pass: &ThreadPass) -> bool {
        self.axes().all(|(axis, config)| {
            let law = pass.axis(axis);
            let (start, way) = (law.start.mm(), law.law(pass.s_rpm));
            let top = config.limits().top_ratio(&way.peak());
            let end = start + way.at(law.done_deg()).s;
            let travel = config.travel_mm[0]..=config.travel_mm[1];
            top >= pass.max_ratio * (1.0 - 1e-9)
                && (end - law.end.mm()).abs() < 1e-6
                && [start, start + law.stroke_mm, end].iter().all(|mm| travel.contains(mm))
        })
    }

    /// Whether a point lies within the travel of every axis.
    pub fn can_reach(&self, point: &PerAxis<Position>) -> bool {
        self.axes().all(|(axis, config)| {
            (config.travel_mm[0]..=config.travel_mm[1]).contains(&point[axis.index()].mm())
        })
    }

    /// Whether the whole of an arc lies within the travel of every axis; false for what is no arc from there.
    pub fn can_turn(&self, from: &PerAxis<Position>, arc: &Arc) -> bool {
        arc.bounds(from).is_ok_and(|corners| corners.iter().all(|corner| self.can_reach(corner)))
    }

    /// The limits of every axis as paths take them; an axis that does not exist has none.
    pub fn limits(&self) -> PerAxis<motion::Limits> {
        let mut limits = [motion::Limits::NONE; AXES];
        self.axes().for_each(|(axis, config)| limits[axis.index()] = config.limits());
        limits
    }

    /// Encoder counts in one turn of the spindle.
    pub fn spindle_counts(&self) -> f64 {
        4.0 * f64::from(self.spindle.encoder_lines)
    }

    /// Refuses values that no machine can have.
    ///
    /// # Errors
    /// [`MachineError::Value`] with the path of the first such key.
    pub fn check(&self) -> Result<(), MachineError> {
        let general = &self.machine;
        range("machine.cycle_s", general.cycle_s, 0.000_1, 0.004)?;
        range("machine.interpolator_cycle_s", general.interpolator_cycle_s, general.cycle_s, 0.02)?;
        let ratio = general.interpolator_cycle_s / general.cycle_s;
        if (ratio - ratio.round()).abs() > 1e-9 * ratio {
            return Err(refuse(
                "machine.interpolator_cycle_s",
                general.interpolator_cycle_s,
                "must be a whole multiple of machine.cycle_s",
            ));
        }
        if self.axis.len() > AXES || !self.axis.contains_key(&Axis::X) || !self.axis.contains_key(&Axis::Z) {
            return Err(refuse("axis", self.axis.len(), "a lathe needs [axis.x] and [axis.z]"));
        }
        if let Some(other) = self.axis.keys().find(|axis| !matches!(axis, Axis::X | Axis::Z)) {
            return Err(refuse("axis", other.name(), "a lathe has the axes x and z only"));
        }
        self.axes().try_for_each(|(axis, config)| config.check(axis))?;
        self.spindle.check()?;
        self.threading.check()?;
        for number in self.tools.keys() {
            if number.parse::<u32>().is_err() {
                return Err(refuse("tools", number, "a tool is named by its number, as in [tools.3]"));
            }
        }
        Ok(())
    }
}

impl AxisConfig {
    /// The limits of the axis as laws of motion take them.
    pub fn limits(&self) -> motion::Limits {
        motion::Limits {
            v: self.velocity_mm_s,
            a: self.acceleration_mm_s2,
            j: self.jerk_mm_s3,
            dj: self.jerk_rate_mm_s4,
        }
    }

    fn check(&self, axis: Axis) -> Result<(), MachineError> {
        let key = |name: &str| format!("axis.{}.{name}", axis.name());
        let [low, high] = self.travel_mm;
        range(&key("travel_mm[0]"), low, -1e5, 1e5)?;
        range(&key("travel_mm[1]"), high, low + 1e-3, 1e5)?;
        range(&key("home_mm"), self.home_mm, low, high)?;
        for (name, value, high) in [
            ("velocity_mm_s", self.velocity_mm_s, 1e4),
            ("acceleration_mm_s2", self.acceleration_mm_s2, 1e6),
            ("jerk_mm_s3", self.jerk_mm_s3, 1e9),
            ("jerk_rate_mm_s4", self.jerk_rate_mm_s4, 1e13),
            ("screw_lead_mm", self.screw_lead_mm, 1e3),
            ("position_gain_1_s", self.position_gain_1_s, 1e3),
            ("velocity_bandwidth_hz", self.velocity_bandwidth_hz, 1e3),
            ("velocity_integral_s", self.velocity_integral_s, 10.0),
            ("torque_limit_nm", self.torque_limit_nm, 1e4),
            ("mass_kg", self.mass_kg, 1e6),
            ("presliding_n_mm", self.presliding_n_mm, 1e9),
            ("following_error_mm", self.following_error_mm, 100.0),
            ("thread_error_mm", self.thread_error_mm, 10.0),
            ("in_position_mm", self.in_position_mm, 10.0),
        ] {
            range(&key(name), value, 1e-6, high)?;
        }
        range(&key("encoder_counts"), f64::from(self.encoder_counts), 16.0, 4e9)?;
        range(&key("coulomb_n"), self.coulomb_n, 0.0, 1e6)?;
        range(&key("viscous_n_s_mm"), self.viscous_n_s_mm, 0.0, 1e6)?;
        range(&key("velocity_lead_s"), self.velocity_lead_s, -0.01, 0.01)?;
        range(&key("acceleration_lead_s"), self.acceleration_lead_s, -0.01, 0.01)
    }
}

impl SpindleConfig {
    fn check(&self) -> Result<(), MachineError> {
        range("spindle.max_rpm", self.max_rpm, 1.0, 1e5)?;
        range("spindle.encoder_lines", f64::from(self.encoder_lines), 25.0, 250_000.0)?;
        range("spindle.ramp_rpm_s", self.ramp_rpm_s, 1.0, 1e6)?;
        range("spindle.observer_hz", self.observer_hz, 1.0, 500.0)?;
        range("spindle.override_max_pct", self.override_max_pct, 100.0, 200.0)?;
        range("spindle.at_speed_pct", self.at_speed_pct, 0.5, 100.0)
    }
}

impl Threading {
    fn check(&self) -> Result<(), MachineError> {
        range("threading.design_override_pct", self.design_override_pct, 100.0, 200.0)?;
        range("threading.limit_share_pct", self.limit_share_pct, 10.0, 100.0)?;
        range("threading.flank_half_angle_deg", self.flank_half_angle_deg, 1.0, 60.0)
    }
}

fn range(key: &str, value: f64, low: f64, high: f64) -> Result<(), MachineError> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(refuse(key, value, &format!("must lie between {low} and {high}")))
}

fn refuse(key: &str, value: impl std::fmt::Display, reason: &str) -> MachineError {
    MachineError::Value { key: key.into(), value: value.to_string(), reason: reason.into() }
}
