//! `[plant.*]` of the machine file: the truth about the simulated machine, which no controller reads.
//! In: the table that `machine::Machine` passes on unread. Out: checked values; every key has a default: a
//! 1 kW servo axis on a 5 mm screw (plausible, not identified). Units are in the names of the keys.

mod axis;
mod spindle;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use machine::Machine;
use protocol::Axis;
use serde::Deserialize;

use crate::chatter::ChatterMode;

pub(crate) use axis::{AxisTrain, Facts, ReferenceFault, SwitchWay};
pub(crate) use spindle::SpindleTrain;

/// What a plant that cannot be built has wrong.
#[derive(Debug, thiserror::Error)]
pub enum PlantError {
    /// An unknown key, or a value of the wrong type.
    #[error("[plant] of the machine file: {0}")]
    Syntax(#[from] Box<toml::de::Error>),
    /// A value that no plant can have.
    #[error("{key} = {value}: {reason}")]
    Value {
        /// Path of the key.
        key: String,
        /// The value given.
        value: f64,
        /// What is allowed, and why.
        reason: String,
    },
    /// A key of a switch or an index that the axis is not referenced by.
    #[error(
        "{key}: the axis is not referenced by any {mark}: choose a method of its [axis.*.reference] that is, or remove \
         this key"
    )]
    NoSuchMark {
        /// Path of the key.
        key: String,
        /// `switch` or `index`.
        mark: &'static str,
    },
    /// A section for an axis that the machine does not have.
    #[error("[plant.axis.{0}]: the machine has no [axis.{0}]; add it or remove this section")]
    NoSuchAxis(&'static str),
    /// An event of the scenario for an axis that the machine does not have.
    #[error("event {event} of the scenario acts on axis {axis}: the machine has no [axis.{axis}]")]
    NoAxisToActOn {
        /// Which event, from 1.
        event: usize,
        /// Name of the axis.
        axis: &'static str,
    },
    /// An event of the scenario for an input that the machine does not have.
    #[error(
        "event {event} of the scenario acts on input {number}: the machine has no [inputs.{number}]; add it, and below \
         it name = \"what it tells\""
    )]
    NoInputToActOn {
        /// Which event, from 1.
        event: usize,
        /// Number of the input.
        number: u32,
    },
}

/// `[plant]`
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct PlantConfig {
    /// `[plant.axis.x]`, `[plant.axis.z]`
    pub(crate) axis: BTreeMap<Axis, AxisTrain>,
    /// `[plant.spindle]`
    pub(crate) spindle: SpindleTrain,
    /// `[plant.cutting]`
    pub(crate) cutting: Cutting,
    /// `[plant.chatter]`
    pub(crate) chatter: ChatterConfig,
    /// `[plant.power]`
    pub(crate) power: Power,
    /// `[plant.bus]`
    pub(crate) bus: Bus,
}

/// `[plant.cutting]`
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Cutting {
    /// Time in which a force or load of a scenario comes on, and goes, s.
    pub(crate) rise_s: f64,
    /// Specific cutting force (M75), N/mm²; 0 cuts air.
    pub(crate) specific_force_n_mm2: f64,
    /// How much more a V chip takes than a straight one.
    pub(crate) form_factor: f64,
    /// Forces on X and on Z as shares of the tangential force.
    pub(crate) radial_share: f64,
    pub(crate) axial_share: f64,
    /// Half angle of the threading tool, degrees.
    pub(crate) flank_half_angle_deg: f64,
    /// Where the stock begins and where it ends along Z, mm, if it is said.
    pub(crate) face_mm: Option<f64>,
    pub(crate) back_mm: Option<f64>,
}

impl Cutting {
    /// Where the stock ends and begins along Z, mm.
    pub(crate) fn stock_mm(&self) -> [f64; 2] {
        [self.back_mm.unwrap_or(-1e4), self.face_mm.unwrap_or(0.0)]
    }
}

impl Default for Cutting {
    fn default() -> Self {
        Cutting {
            rise_s: 0.01,
            specific_force_n_mm2: 0.0,
            form_factor: 1.5,
            radial_share: 0.5,
            axial_share: 0.2,
            flank_half_angle_deg: 30.0,
            face_mm: None,
            back_mm: None,
        }
    }
}

/// `[plant.chatter]`
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct ChatterConfig {
    /// Stiffness of the tool across the groove (M234), N/mm; 0: it does not give way.
    pub(crate) stiffness_n_mm: f64,
    /// Frequency of its mode, Hz, and its damping.
    pub(crate) mode_hz: f64,
    pub(crate) damping: f64,
}

impl Default for ChatterConfig {
    fn default() -> Self {
        ChatterConfig { stiffness_n_mm: 0.0, mode_hz: 120.0, damping: 0.04 }
    }
}

/// `[plant.power]`
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Power {
    /// For how long the drives of the axes have torque after the mains have failed, s.
    pub(crate) link_hold_s: f64,
}

impl Default for Power {
    fn default() -> Self {
        Power { link_hold_s: 0.1 }
    }
}

/// `[plant.bus]`
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Bus {
    /// Control cycles for which a measurement is under way to the regulators, and a command to the drives.
    pub(crate) input_cycles: u32,
    pub(crate) output_cycles: u32,
    /// A drive trips when so many commands in a row have not come.
    pub(crate) lost_commands: u32,
}

impl Default for Bus {
    fn default() -> Self {
        Bus { input_cycles: 0, output_cycles: 0, lost_commands: 12 }
    }
}

impl PlantConfig {
    /// Reads and checks the truth about a machine.
    pub(crate) fn of(machine: &Machine) -> Result<PlantConfig, PlantError> {
        let config: PlantConfig = machine.plant.clone().try_into().map_err(Box::new)?;
        for (axis, train) in &config.axis {
            let belief = machine.axis.get(axis).ok_or(PlantError::NoSuchAxis(axis.name()))?;
            let section = format!("plant.axis.{}", axis.name());
            train.check(&section)?;
            train.check_marks(&section, belief.reference.as_ref())?;
            if let (Some(value), None) = (train.scale_step_mm, belief.scale_step_mm) {
                let reason = format!("the axis has no scale: [axis.{}] has no scale_step_mm", axis.name());
                return Err(PlantError::Value { key: format!("{section}.scale_step_mm"), value, reason });
            }
        }
        config.spindle.check()?;
        config.cutting.check()?;
        config.chatter.check(&config.cutting)?;
        range("plant.power.link_hold_s", config.power.link_hold_s, 0.0, 10.0)?;
        let (longest, bus) = (f64::from(machine::LONGEST_CYCLES), config.bus);
        range("plant.bus.input_cycles", f64::from(bus.input_cycles), 0.0, longest)?;
        range("plant.bus.output_cycles", f64::from(bus.output_cycles), 0.0, longest)?;
        range("plant.bus.lost_commands", f64::from(bus.lost_commands), 3.0, 1000.0)?;
        Ok(config)
    }
}

impl ChatterConfig {
    /// The mode, if the tool gives way.
    pub(crate) fn mode(&self) -> Option<ChatterMode> {
        let ChatterConfig { stiffness_n_mm, mode_hz: hz, damping } = *self;
        (stiffness_n_mm > 0.0).then_some(ChatterMode { stiffness_n_mm, hz, damping })
    }

    fn check(&self, cutting: &Cutting) -> Result<(), PlantError> {
        range("plant.chatter.stiffness_n_mm", self.stiffness_n_mm, 0.0, 1e7)?;
        range("plant.chatter.mode_hz", self.mode_hz, 5.0, 5000.0)?;
        range("plant.chatter.damping", self.damping, 1e-4, 0.5)?;
        if self.mode().is_some() && cutting.specific_force_n_mm2 == 0.0 {
            let reason = "nothing is cut without a force: give plant.cutting.specific_force_n_mm2, about 2000 for steel";
            let key = "plant.chatter.stiffness_n_mm".into();
            return Err(PlantError::Value { key, value: self.stiffness_n_mm, reason: reason.into() });
        }
        Ok(())
    }
}

impl Cutting {
    fn check(&self) -> Result<(), PlantError> {
        let [back_mm, face_mm] = self.stock_mm();
        for (name, value, low, high) in [
            ("rise_s", self.rise_s, 0.0, 10.0),
            ("specific_force_n_mm2", self.specific_force_n_mm2, 0.0, 20_000.0),
            ("form_factor", self.form_factor, 0.1, 10.0),
            ("radial_share", self.radial_share, 0.0, 5.0),
            ("axial_share", self.axial_share, 0.0, 5.0),
            ("flank_half_angle_deg", self.flank_half_angle_deg, 1.0, 60.0),
            ("face_mm", face_mm, -1e5, 1e5),
            ("back_mm", back_mm, -1e5, face_mm),
        ] {
            range(&format!("plant.cutting.{name}"), value, low, high)?;
        }
        Ok(())
    }
}

pub(crate) fn range(key: &str, value: f64, low: f64, high: f64) -> Result<(), PlantError> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(PlantError::Value { key: key.into(), value, reason: format!("must lie between {low} and {high}") })
}
