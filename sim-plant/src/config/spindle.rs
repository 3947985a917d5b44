//! `[plant.spindle]`: what is true of the spindle. In: its table. Out: checked values in the units of their
//! names.

use core::f64::consts::TAU;

use serde::Deserialize;

use super::{PlantError, range};

/// Most harmonics of the ripple and of the encoder.
const MOST: usize = 8;
/// Steepest error of an encoder, a share of the angle.
const STEEPEST: f64 = 0.05;
/// Seconds of arc in a turn.
const TURN_ARCSEC: f64 = 1_296_000.0;

/// A number or several.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged, expecting = "must be a number or a list of numbers")]
pub(crate) enum Numbers {
    /// Without brackets.
    One(f64),
    /// A list.
    More(Vec<f64>),
}

impl Numbers {
    /// All of them.
    pub(crate) fn all(&self) -> &[f64] {
        match self {
            Numbers::One(number) => core::slice::from_ref(number),
            Numbers::More(numbers) => numbers,
        }
    }

    /// The key of one of them.
    fn key(&self, name: &str, index: usize) -> String {
        match self {
            Numbers::One(_) => format!("plant.spindle.{name}"),
            Numbers::More(_) => format!("plant.spindle.{name}[{index}]"),
        }
    }
}

/// `[plant.spindle]`: motor and drive, everything that turns, what makes its speed uneven, and what its
/// encoder makes of the angle.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct SpindleTrain {
    /// What the controller believes, too; that is true if nothing is said here.
    pub(crate) encoder_lines: Option<u32>,
    pub(crate) ramp_rpm_s: Option<f64>,
    pub(crate) max_rpm: Option<f64>,
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
    /// Ripple of the speed, per cent of it, and how often a turn it comes; of each harmonic.
    pub(crate) ripple_pct: Numbers,
    pub(crate) ripple_per_rev: Numbers,
    /// Errors of the encoder: how often a turn each comes, and its size, seconds of arc.
    pub(crate) encoder_error_arcsec: Vec<[f64; 2]>,
    /// The index is latched so long too late or too early at most, s.
    pub(crate) index_jitter_s: f64,
    /// The spindle is seen as it was so long before the axes, s.
    pub(crate) encoder_delay_s: f64,
}

impl Default for SpindleTrain {
    fn default() -> Self {
        SpindleTrain {
            encoder_lines: None,
            ramp_rpm_s: None,
            max_rpm: None,
            inertia_kg_m2: 0.15,
            peak_torque_nm: 60.0,
            peak_power_kw: 7.5,
            coulomb_nm: 1.0,
            viscous_nm_s: 0.01,
            speed_bandwidth_hz: 3.0,
            speed_integral_s: 0.15,
            torque_lag_s: 0.002,
            ripple_pct: Numbers::One(0.2),
            ripple_per_rev: Numbers::One(2.0),
            encoder_error_arcsec: Vec::new(),
            index_jitter_s: 0.0,
            encoder_delay_s: 0.0,
        }
    }
}

impl SpindleTrain {
    pub(super) fn check(&self) -> Result<(), PlantError> {
        for (name, value, low, high) in [
            ("inertia_kg_m2", self.inertia_kg_m2, 1e-4, 1e4),
            ("peak_torque_nm", self.peak_torque_nm, 0.1, 1e5),
            ("peak_power_kw", self.peak_power_kw, 0.01, 1e4),
            ("coulomb_nm", self.coulomb_nm, 0.0, 0.9 * self.peak_torque_nm),
            ("viscous_nm_s", self.viscous_nm_s, 0.0, 10.0),
            ("speed_bandwidth_hz", self.speed_bandwidth_hz, 0.1, 50.0),
            ("speed_integral_s", self.speed_integral_s, 0.005, 100.0),
            ("torque_lag_s", self.torque_lag_s, 1e-5, 0.1),
            ("index_jitter_s", self.index_jitter_s, 0.0, 1e-4),
            ("encoder_delay_s", self.encoder_delay_s, -2e-4, 2e-4),
        ] {
            range(&format!("plant.spindle.{name}"), value, low, high)?;
        }
        for (name, value, low, high) in [
            ("encoder_lines", self.encoder_lines.map(f64::from), 1.0, 250_000.0),
            ("ramp_rpm_s", self.ramp_rpm_s, 1.0, 1e6),
            ("max_rpm", self.max_rpm, 1.0, 1e5),
        ] {
            value.map_or(Ok(()), |value| range(&format!("plant.spindle.{name}"), value, low, high))?;
        }
        self.check_ripple()?;
        self.check_encoder()
    }

    fn check_ripple(&self) -> Result<(), PlantError> {
        let (pct, per_rev) = (self.ripple_pct.all(), self.ripple_per_rev.all());
        for (key, numbers) in [("ripple_pct", pct), ("ripple_per_rev", per_rev)] {
            let fits = (1..=MOST).contains(&numbers.len()) && numbers.len() == pct.len();
            if !fits {
                let reason = format!(
                    "harmonics were found; ripple_pct and ripple_per_rev have the same number, 1 to {MOST}"
                );
                return refuse(format!("plant.spindle.{key}"), numbers.len() as f64, reason);
            }
        }
        for (index, (pct, times)) in pct.iter().zip(per_rev).enumerate() {
            range(&self.ripple_pct.key("ripple_pct", index), *pct, 0.0, 10.0)?;
            whole(&self.ripple_per_rev.key("ripple_per_rev", index), *times, 100.0)?;
        }
        Ok(())
    }

    fn check_encoder(&self) -> Result<(), PlantError> {
        let rows = &self.encoder_error_arcsec;
        let section = "plant.spindle.encoder_error_arcsec";
        if rows.len() > MOST {
            return refuse(section.into(), rows.len() as f64, format!("rows were found; at most {MOST}"));
        }
        for (index, [per_turn, arcsec]) in rows.iter().enumerate() {
            whole(&format!("{section}[{index}][0]"), *per_turn, 1e6)?;
            range(&format!("{section}[{index}][1]"), *arcsec, 0.0, 3600.0)?;
        }
        let steepness: f64 =
            rows.iter().map(|[per_turn, arcsec]| TAU * per_turn * arcsec / TURN_ARCSEC).sum();
        if steepness > STEEPEST {
            let reason = format!("is the steepness of all rows together; it must be at most {STEEPEST}");
            return refuse(section.into(), steepness, reason);
        }
        Ok(())
    }
}

fn refuse(key: String, value: f64, reason: String) -> Result<(), PlantError> {
    Err(PlantError::Value { key, value, reason })
}

/// A number of times a turn.
fn whole(key: &str, value: f64, most: f64) -> Result<(), PlantError> {
    range(key, value, 1.0, most)?;
    if value.fract() == 0.0 { Ok(()) } else { refuse(key.into(), value, "must be a whole number".into()) }
}
