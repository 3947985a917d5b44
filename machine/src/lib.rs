//! The machine file: what the controller believes about its machine, and, passed through unread, the truth
//! about the simulated plant.
//!
//! Every key has a default (the built-in small lathe), unknown keys are refused, and [`Machine::check`]
//! refuses impossible values with the path of the key. Units are in the names of the keys.

mod axis;
mod bus;
mod feasibility;
mod inputs;
mod insert;
pub mod kinematics;
mod m_codes;
mod outputs;
mod part;
mod path;
mod positioner;
mod reference;
pub mod screw;
mod spindle;
mod tapping;
mod told;
mod tool;
mod variation;

use serde::{Deserialize, Serialize};

pub use axis::{AxisConfig, CLOSEST_MM, Difference, Feedforward, MOST_A_TURN, MOST_COGGING, MOST_ROWS};
pub use bus::{Bus, LONGEST_CYCLES};
pub use inputs::{INPUTS, Input};
pub use insert::{Insert, InsertError};
pub use m_codes::MachineCode;
pub use outputs::{ANALOG_OUTPUTS, AnalogOutput, OUTPUTS, Output, SignalFault, SignalRefused};
pub use part::{Corners, Part, PartError};
pub use path::PathConfig;
pub use positioner::{POSITIONER_AXES, PositionerConfig};
use protocol::{Axis, Cycle, PerAxis, Position, code_file::Identity, units::AXES};
pub use reference::{BEYOND_MM, Method, ReferenceConfig, TURNS};
pub use spindle::{Reaction, RunOut, SpindleConfig, Threading};
pub use tool::{Tool, ToolChange};
pub use variation::{NotVaried, SpeedLaw, VariationConfig, Varied};

/// What a machine file that cannot be used has wrong.
#[derive(Debug, thiserror::Error)]
pub enum MachineError {
    /// Not TOML, an unknown key, a missing key, or a value of the wrong type; the message shows the place.
    #[error("in {section}: {}", told::syntax(error))]
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

/// Longest interpolator cycle of a machine that cuts threads, s. The first setpoint behind a pass finds none
/// a cycle before it, so the axis sets off with what a move covers in its first cycle: within this one, less
/// than its limits.
pub const LONGEST_ON_A_LATHE_S: f64 = 0.005;

/// A machine file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// `[machine]`
    #[serde(rename = "machine")]
    pub general: General,
    /// `[axis.x]`, `[axis.z]` …
    #[serde(serialize_with = "axis::spelled")]
    pub axis: std::collections::BTreeMap<Axis, AxisConfig>,
    /// `[spindle]`: only a positioner has none.
    #[serde(default = "SpindleConfig::none", skip_serializing_if = "SpindleConfig::is_none")]
    pub spindle: SpindleConfig,
    /// `[positioner]`: only a positioner has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub positioner: Option<PositionerConfig>,
    /// `[bus]`
    #[serde(default)]
    pub bus: Bus,
    /// `[path]`
    #[serde(default)]
    pub path: PathConfig,
    /// `[threading]`
    #[serde(default)]
    pub threading: Threading,
    /// `[tools]`: number → description.
    #[serde(default)]
    pub tools: std::collections::BTreeMap<String, Tool>,
    /// `[m_codes]`: number → what the control does with a code of this machine.
    #[serde(default, skip_serializing_if = "std::collections::BTreeMap::is_empty")]
    pub m_codes: std::collections::BTreeMap<String, MachineCode>,
    /// `[outputs]`: number → digital output.
    #[serde(default, skip_serializing_if = "std::collections::BTreeMap::is_empty")]
    pub outputs: std::collections::BTreeMap<String, Output>,
    /// `[analog_outputs]`: number → analog output.
    #[serde(default, skip_serializing_if = "std::collections::BTreeMap::is_empty")]
    pub analog_outputs: std::collections::BTreeMap<String, AnalogOutput>,
    /// `[inputs]`: number → digital input.
    #[serde(default, skip_serializing_if = "std::collections::BTreeMap::is_empty")]
    pub inputs: std::collections::BTreeMap<String, Input>,
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
    pub dialect: ProgramDialect,
    /// What a coordinate of a FANUC program without a decimal point is; without this key the program has to
    /// say it by having none with one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub decimal_point: Option<BareNumbers>,
    /// Tool table of part programs (LinuxCNC's format), beside the machine file if its path is relative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tool_table: Option<std::path::PathBuf>,
    /// Parameter file of part programs (LinuxCNC's format), beside the machine file if its path is relative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parameters: Option<std::path::PathBuf>,
    /// Kinematics.
    #[serde(default)]
    pub kinematics: Kinematics,
    /// Who puts the next tool in.
    #[serde(default, skip_serializing_if = "ToolChange::is_automatic")]
    pub tool_change: ToolChange,
}

/// Dialect of part programs, as the machine file names it. What it means is the business of whoever reads
/// programs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ProgramDialect {
    /// That of the program, by what only one of them has.
    #[default]
    Auto,
    /// RS274/NGC as LinuxCNC speaks it.
    Linuxcnc,
    /// FANUC lathe programs, G-code system A.
    Fanuc,
}

impl ProgramDialect {
    /// As the machine file names it.
    pub const fn name(self) -> &'static str {
        match self {
            ProgramDialect::Auto => "auto",
            ProgramDialect::Linuxcnc => "linuxcnc",
            ProgramDialect::Fanuc => "fanuc",
        }
    }
}

/// What a coordinate without a decimal point is, as the machine file names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BareNumbers {
    /// So many least input increments, 0.001 mm or 0.0001 inch.
    Conventional,
    /// So many mm or inch.
    PocketCalculator,
    /// Refused.
    Refuse,
}

/// Kinematics of the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kinematics {
    /// X across, Z along the spindle, and, where it exists, C about it.
    #[default]
    Lathe,
    /// X, Y, Z, and what exists of A, B, C about them.
    Mill,
    /// X, Y, a tilt A and a turn C that bring a seam under a beam that stands.
    Positioner,
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

/// The built-in machine file.
pub const SMALL_LATHE: &str = include_str!("../../examples/machines/small-lathe.toml");

/// The same lathe without what a shop adds: on it one sees what the control alone does.
pub const PLAIN_LATHE: &str = include_str!("../../examples/machines/plain-lathe.toml");

/// A mill to begin with.
pub const SMALL_MILL: &str = include_str!("../../examples/machines/small-mill.toml");

/// A positioner to begin with.
pub const POSITIONER: &str = include_str!("../../examples/machines/positioner.toml");

impl Kinematics {
    /// As the machine file names it.
    pub const fn name(self) -> &'static str {
        match self {
            Kinematics::Lathe => "lathe",
            Kinematics::Mill => "mill",
            Kinematics::Positioner => "positioner",
        }
    }

    /// A machine file of this kinematics, as `pitchlock machine` prints it.
    pub fn example(self) -> &'static str {
        match self {
            Kinematics::Lathe => SMALL_LATHE,
            Kinematics::Mill => SMALL_MILL,
            Kinematics::Positioner => POSITIONER,
        }
    }
}

impl Machine {
    /// The lathe of `examples/machines/plain-lathe.toml`.
    pub fn plain() -> Machine {
        Machine::from_toml(PLAIN_LATHE).expect("the shipped machines are tested")
    }

    /// Reads and checks a machine file.
    ///
    /// # Errors
    /// [`MachineError`] names the key and the reason.
    pub fn from_toml(text: &str) -> Result<Machine, MachineError> {
        let machine: Machine = toml::from_str(text).map_err(|error| MachineError::syntax(text, error))?;
        machine.check()?;
        units(text).map(|()| machine)
    }

    /// The axes that exist, in the order of the wire.
    pub fn axes(&self) -> impl Iterator<Item = (Axis, &AxisConfig)> {
        self.axis.iter().map(|(axis, config)| (*axis, config))
    }

    /// Where the axes stand at the start of the machine; 0 for those that do not exist.
    pub fn home(&self) -> PerAxis<Position> {
        let mut home = PerAxis::<Position>::default();
        self.axes().for_each(|(axis, config)| home[axis.index()] = Position::from_mm(config.home_mm));
        home
    }

    /// Control cycles in one interpolator cycle.
    pub fn cycles_per_tick(&self) -> u64 {
        (self.general.interpolator_cycle_s / self.general.cycle_s).round() as u64
    }

    /// Whether the interpolator ticks in a control cycle.
    pub fn is_tick(&self, cycle: Cycle) -> bool {
        cycle.0.is_multiple_of(self.cycles_per_tick())
    }

    /// The limits of every axis as paths take them; an axis that does not exist has none.
    pub fn limits(&self) -> PerAxis<motion::Limits> {
        let mut limits = [motion::Limits::NONE; AXES];
        self.axes().for_each(|(axis, config)| limits[axis.index()] = config.limits());
        limits
    }

    /// What a machine-code file for this machine says of it.
    pub fn identity(&self) -> Identity {
        let General { name, cycle_s, interpolator_cycle_s, .. } = &self.general;
        Identity { name: name.clone(), cycle_s: *cycle_s, interpolator_cycle_s: *interpolator_cycle_s }
    }

    /// The tool of a number, if the file has it.
    pub fn tool(&self, number: u32) -> Option<&Tool> {
        self.tools.iter().find(|(name, _)| name.parse() == Ok(number)).map(|(_, tool)| tool)
    }

    /// What it does with M codes of its own, by number.
    pub fn machine_codes(&self) -> impl Iterator<Item = (u16, MachineCode)> {
        self.m_codes.iter().filter_map(|(key, code)| Some((m_codes::number(key)?, *code)))
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
        let general = &self.general;
        range("machine.cycle_s", general.cycle_s, 0.000_1, 0.004)?;
        let longest_s = if general.kinematics == Kinematics::Lathe { LONGEST_ON_A_LATHE_S } else { 0.02 };
        range("machine.interpolator_cycle_s", general.interpolator_cycle_s, general.cycle_s, longest_s)?;
        let ratio = general.interpolator_cycle_s / general.cycle_s;
        if (ratio - ratio.round()).abs() > 1e-9 * ratio {
            return Err(refuse(
                "machine.interpolator_cycle_s",
                general.interpolator_cycle_s,
                "must be a whole multiple of machine.cycle_s",
            ));
        }
        let (needed, allowed, reason) = general.kinematics.axis_set();
        if needed.iter().any(|axis| !self.axis.contains_key(axis)) {
            let names: Vec<_> = self.axis.keys().map(|axis| axis.name()).collect();
            return Err(refuse("axis", names.join(", "), reason));
        }
        if let Some(other) = self.axis.keys().find(|axis| !needed.contains(axis) && !allowed.contains(axis)) {
            return Err(refuse("axis", other.name(), reason));
        }
        self.bus.check(general)?;
        self.axes().try_for_each(|(axis, config)| config.check(axis, general, &self.bus))?;
        self.check_positioner()?;
        self.check_spindle()?;
        self.path.check()?;
        self.threading.check()?;
        outputs::check(self)?;
        inputs::check(self)?;
        m_codes::check(self)?;
        for (number, tool) in &self.tools {
            if number.parse::<u32>().is_err() {
                return Err(refuse("tools", number, "a tool is named by its number, as in [tools.3]"));
            }
            tool.check(&format!("tools.{number}"))?;
        }
        Ok(())
    }
}

/// Refuses keys that name a unit their axis does not have. The file has been read before.
fn units(text: &str) -> Result<(), MachineError> {
    let file: toml::Table = toml::from_str(text).map_err(|error| MachineError::syntax(text, error))?;
    let axes = file.get("axis").and_then(toml::Value::as_table).into_iter().flatten();
    for (name, keys) in axes {
        let (Some(axis), Some(keys)) = (Axis::from_name(name), keys.as_table()) else { continue };
        let (own, other) = if axis.is_rotary() { ("deg", "mm") } else { ("mm", "deg") };
        let tables = keys.iter().filter_map(|(key, value)| Some((format!("{key}."), value.as_table()?)));
        for (table, keys) in std::iter::once((String::new(), keys)).chain(tables) {
            let wrong = |(key, _): &(&String, &toml::Value)| key.split('_').any(|word| word == other);
            if let Some((key, value)) = keys.iter().find(wrong) {
                let reason = format!("{axis} is measured in {own}: write {}", key.replace(other, own));
                return Err(refuse(&format!("axis.{name}.{table}{key}"), spelled(value), &reason));
            }
        }
    }
    Ok(())
}

/// A value of the file as people write it; a table is only named.
fn spelled(value: &toml::Value) -> String {
    match value {
        toml::Value::Integer(number) => number.to_string(),
        toml::Value::Float(number) => format!("{number:?}"),
        toml::Value::Boolean(is) => is.to_string(),
        toml::Value::Datetime(date) => date.to_string(),
        toml::Value::String(text) => format!("{text:?}"),
        toml::Value::Array(values) => {
            format!("[{}]", values.iter().map(spelled).collect::<Vec<_>>().join(", "))
        }
        toml::Value::Table(_) => "a table".into(),
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
