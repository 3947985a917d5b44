//! `[plant.*]` of the machine file: the truth about the simulated machine, which no controller reads.
//! In: the table that `machine::Machine` passes on unread. Out: checked values; every key has a default: a
//! 1 kW servo axis on a 5 mm screw (plausible, not identified). Units are in the names of the keys.

use std::collections::BTreeMap;

use machine::Machine;
use protocol::Axis;
use serde::Deserialize;

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
    /// `[plant.power]`
    pub(crate) power: Power,
}

/// `[plant.axis.*]`: motor and screw, slide, guide, and what the drive does when it is left alone.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct AxisTrain {
    /// Everything that turns: rotor, coupling, screw, kg m².
    pub(crate) inertia_kg_m2: f64,
    /// Slide with its tool, kg.
    pub(crate) slide_mass_kg: f64,
    /// Mode of the slide against the standing motor, Hz, and its damping ratio.
    pub(crate) mode_hz: f64,
    pub(crate) mode_damping: f64,
    /// Way of the nut from flank to flank that does not move the slide, mm.
    pub(crate) backlash_mm: f64,
    /// Error of the screw: pairs of motor position in mm, rising, and how much too far the nut stands, µm.
    pub(crate) screw_error: Vec<[f64; 2]>,
    /// Size of the error that comes back with every turn of the screw, µm.
    pub(crate) screw_wobble_um: f64,
    /// Friction of the screw, referred to the slide.
    pub(crate) screw_coulomb_n: f64,
    pub(crate) screw_presliding_n_mm: f64,
    pub(crate) screw_viscous_n_s_mm: f64,
    /// Friction of the guide.
    pub(crate) slide_coulomb_n: f64,
    pub(crate) slide_static_n: f64,
    pub(crate) slide_stribeck_mm_s: f64,
    pub(crate) slide_presliding_n_mm: f64,
    pub(crate) slide_viscous_n_s_mm: f64,
    /// First-order lag of the current loop, s.
    pub(crate) current_lag_s: f64,
    /// Ramp of a quick stop and of the reaction to a fault, mm/s².
    pub(crate) quick_stop_mm_s2: f64,
    /// Speed at which the drive trips, mm/s.
    pub(crate) overspeed_mm_s: f64,
    /// Force at the slide with which the brake of the motor stops and holds it, N.
    pub(crate) brake_n: f64,
}

impl Default for AxisTrain {
    fn default() -> Self {
        AxisTrain {
            inertia_kg_m2: 12e-4,
            slide_mass_kg: 110.0,
            mode_hz: 100.0,
            mode_damping: 0.03,
            backlash_mm: 0.0,
            screw_error: Vec::new(),
            screw_wobble_um: 0.0,
            screw_coulomb_n: 150.0,
            screw_presliding_n_mm: 30_000.0,
            screw_viscous_n_s_mm: 2.0,
            slide_coulomb_n: 120.0,
            slide_static_n: 160.0,
            slide_stribeck_mm_s: 1.5,
            slide_presliding_n_mm: 15_000.0,
            slide_viscous_n_s_mm: 0.6,
            current_lag_s: 0.0005,
            quick_stop_mm_s2: 3000.0,
            overspeed_mm_s: 290.0,
            brake_n: 10_000.0,
        }
    }
}

/// `[plant.spindle]`: motor and drive, everything that turns, and what makes its speed uneven.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct SpindleTrain {
    /// Everything that turns, referred to the spindle, kg m².
    pub(crate) inertia_kg_m2: f64,
    /// Limits of the motor at the spindle: torque below, power above the corner speed.
    pub(crate) peak_torque_nm: f64,
    pub(crate) peak_power_kw: f64,
    /// Friction of belt and bearings.
    pub(crate) coulomb_nm: f64,
    pub(crate) viscous_nm_s: f64,
    /// Speed loop of the drive: Kp = inertia × 2π × bandwidth, integral time, and lag of the torque.
    pub(crate) speed_bandwidth_hz: f64,
    pub(crate) speed_integral_s: f64,
    pub(crate) torque_lag_s: f64,
    /// Ripple of the speed, per cent of it, and how often a turn it comes.
    pub(crate) ripple_pct: f64,
    pub(crate) ripple_per_rev: u32,
}

impl Default for SpindleTrain {
    fn default() -> Self {
        SpindleTrain {
            inertia_kg_m2: 0.15,
            peak_torque_nm: 60.0,
            peak_power_kw: 7.5,
            coulomb_nm: 1.0,
            viscous_nm_s: 0.01,
            speed_bandwidth_hz: 3.0,
            speed_integral_s: 0.15,
            torque_lag_s: 0.002,
            ripple_pct: 0.2,
            ripple_per_rev: 2,
        }
    }
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
    /// Where the stock begins and where it ends along Z, mm.
    pub(crate) face_mm: f64,
    pub(crate) back_mm: f64,
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
            face_mm: 0.0,
            back_mm: -1e4,
        }
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

impl PlantConfig {
    /// Reads and checks the truth about a machine.
    pub(crate) fn of(machine: &Machine) -> Result<PlantConfig, PlantError> {
        let config: PlantConfig = machine.plant.clone().try_into().map_err(Box::new)?;
        for (axis, train) in &config.axis {
            if !machine.axis.contains_key(axis) {
                return Err(PlantError::NoSuchAxis(axis.name()));
            }
            train.check(&format!("plant.axis.{}", axis.name()))?;
        }
        config.spindle.check()?;
        config.cutting.check()?;
        range("plant.power.link_hold_s", config.power.link_hold_s, 0.0, 10.0)?;
        Ok(config)
    }
}

impl AxisTrain {
    fn check(&self, section: &str) -> Result<(), PlantError> {
        for (name, value, low, high) in [
            ("inertia_kg_m2", self.inertia_kg_m2, 1e-6, 1.0),
            ("slide_mass_kg", self.slide_mass_kg, 0.1, 1e5),
            ("mode_hz", self.mode_hz, 5.0, 1000.0),
            ("mode_damping", self.mode_damping, 0.0, 1.0),
            ("backlash_mm", self.backlash_mm, 0.0, 10.0),
            ("screw_coulomb_n", self.screw_coulomb_n, 0.0, 1e5),
            ("screw_presliding_n_mm", self.screw_presliding_n_mm, 1.0, 1e6),
            ("screw_viscous_n_s_mm", self.screw_viscous_n_s_mm, 0.0, 1e3),
            ("slide_coulomb_n", self.slide_coulomb_n, 0.0, 1e5),
            ("slide_static_n", self.slide_static_n, self.slide_coulomb_n, 1e5),
            ("slide_stribeck_mm_s", self.slide_stribeck_mm_s, 0.01, 1e3),
            ("slide_presliding_n_mm", self.slide_presliding_n_mm, 1.0, 1e6),
            ("slide_viscous_n_s_mm", self.slide_viscous_n_s_mm, 0.0, 1e3),
            ("current_lag_s", self.current_lag_s, 1e-6, 0.1),
            ("quick_stop_mm_s2", self.quick_stop_mm_s2, 1.0, 1e6),
            ("overspeed_mm_s", self.overspeed_mm_s, 1.0, 1e5),
            ("brake_n", self.brake_n, 1.0, 1e6),
        ] {
            range(&format!("{section}.{name}"), value, low, high)?;
        }
        Ok(())
    }
}

impl SpindleTrain {
    fn check(&self) -> Result<(), PlantError> {
        for (name, value, low, high) in [
            ("inertia_kg_m2", self.inertia_kg_m2, 1e-4, 1e4),
            ("peak_torque_nm", self.peak_torque_nm, 0.1, 1e5),
            ("peak_power_kw", self.peak_power_kw, 0.01, 1e4),
            ("coulomb_nm", self.coulomb_nm, 0.0, 0.9 * self.peak_torque_nm),
            ("viscous_nm_s", self.viscous_nm_s, 0.0, 10.0),
            ("speed_bandwidth_hz", self.speed_bandwidth_hz, 0.1, 50.0),
            ("speed_integral_s", self.speed_integral_s, 0.005, 100.0),
            ("torque_lag_s", self.torque_lag_s, 1e-5, 0.1),
            ("ripple_pct", self.ripple_pct, 0.0, 10.0),
            ("ripple_per_rev", f64::from(self.ripple_per_rev), 1.0, 100.0),
        ] {
            range(&format!("plant.spindle.{name}"), value, low, high)?;
        }
        Ok(())
    }
}

impl Cutting {
    fn check(&self) -> Result<(), PlantError> {
        for (name, value, low, high) in [
            ("rise_s", self.rise_s, 0.0, 10.0),
            ("specific_force_n_mm2", self.specific_force_n_mm2, 0.0, 20_000.0),
            ("form_factor", self.form_factor, 0.1, 10.0),
            ("radial_share", self.radial_share, 0.0, 5.0),
            ("axial_share", self.axial_share, 0.0, 5.0),
            ("flank_half_angle_deg", self.flank_half_angle_deg, 1.0, 60.0),
            ("face_mm", self.face_mm, -1e5, 1e5),
            ("back_mm", self.back_mm, -1e5, self.face_mm),
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

#[cfg(test)]
mod tests {
    use super::*;

    fn with(plant: &str) -> Result<PlantConfig, PlantError> {
        PlantConfig::of(&Machine { plant: plant.parse().unwrap(), ..Machine::default() })
    }

    #[test]
    fn the_small_lathe_has_the_default_plant() {
        let config = PlantConfig::of(&Machine::default()).unwrap();
        assert_eq!(config.spindle, SpindleTrain::default());
        assert_eq!(config.cutting, Cutting::default());
        assert!(config.axis.values().all(|train| *train == AxisTrain::default()));
        assert_eq!(with("").unwrap(), PlantConfig::default());
    }

    #[test]
    fn refusals_name_the_key_and_what_is_allowed() {
        for (text, expected) in [
            ("[axis.x]\nmode_hz = 0.5", "plant.axis.x.mode_hz = 0.5: must lie between 5 and 1000"),
            ("[axis.z]\nslide_static_n = 100", "plant.axis.z.slide_static_n = 100: must lie between 120"),
            ("[spindle]\nripple_pct = -1", "plant.spindle.ripple_pct = -1: must lie between 0 and 10"),
            ("[cutting]\nrise_s = nan", "plant.cutting.rise_s = NaN: must lie between"),
            (
                "[cutting]\nspecific_force_n_mm2 = -1",
                "plant.cutting.specific_force_n_mm2 = -1: must lie between 0 and",
            ),
            (
                "[cutting]\nface_mm = -5\nback_mm = 0",
                "plant.cutting.back_mm = 0: must lie between -100000 and -5",
            ),
            ("[axis.x]\nbrake_n = 0", "plant.axis.x.brake_n = 0: must lie between 1 and"),
            ("[power]\nlink_hold_s = 11", "plant.power.link_hold_s = 11: must lie between 0 and 10"),
            ("[axis.y]\nmode_hz = 80", "[plant.axis.y]: the machine has no [axis.y]"),
            ("[axis.x]\nmode = 80", "unknown field `mode`"),
            ("[spindle]\nripple_per_rev = 1.5", "ripple_per_rev"),
        ] {
            let message = with(text).unwrap_err().to_string();
            assert!(message.contains(expected), "{text}: {message}");
        }
    }
}
