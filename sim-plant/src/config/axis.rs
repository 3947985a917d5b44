//! `[plant.axis.*]`: what is true of an axis. In: its table. Out: checked values in the units of their names.

use machine::{AxisConfig, Method, ReferenceConfig};
use serde::Deserialize;

use super::{PlantError, range};
use crate::friction::Pair;

/// The weight that a brake holds, a share of its force.
const HELD: f64 = 0.9;
/// Where a motor begins to lose its torque, a share of the speed at which it has none.
const FULL: f64 = 0.75;

/// What is true of an axis where its controller believes something, too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Facts {
    /// Way per turn of the motor, mm.
    pub(crate) screw_lead_mm: f64,
    /// Counts per turn of the motor.
    pub(crate) encoder_counts: u32,
    /// Where the slide truly stands when the controller takes it to be at home, mm.
    pub(crate) home_mm: f64,
    /// Where it is home as motor and screw are built into the machine, mm: an encoder that is believed from
    /// the start has been set there, and whoever makes a reference run may be switched on anywhere.
    pub(crate) built_home_mm: f64,
    /// Step of the scale, mm, if there is one.
    pub(crate) scale_step_mm: Option<f64>,
    /// Limit of the drive's torque, as the drive believes its torque, N·m.
    pub(crate) torque_limit_nm: f64,
}

/// What may be wrong with switch and index of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum ReferenceFault {
    /// The switch is never on.
    SwitchOpen,
    /// It is always on.
    SwitchClosed,
    /// The encoder shows no index.
    NoIndex,
}

/// The way on which a slide goes onto its switch, and on to the end of its travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum SwitchWay {
    /// Towards higher positions.
    Positive,
    /// Towards lower ones.
    Negative,
}

/// `[plant.axis.*]`: motor and screw, slide, guide, and what the drive does when it is left alone.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct AxisTrain {
    /// What the controller believes, too; that is true if nothing is said here.
    pub(crate) screw_lead_mm: Option<f64>,
    pub(crate) encoder_counts: Option<u32>,
    pub(crate) scale_step_mm: Option<f64>,
    pub(crate) torque_limit_nm: Option<f64>,
    /// How far beside where it believes to be at home the slide truly stands, mm.
    pub(crate) home_off_mm: f64,
    /// Of an axis with a reference: where its switch goes on and where an index of its motor lies, mm; what
    /// the controller believes if nothing is said, the switch half a turn before an index behind it.
    pub(crate) switch_mm: Option<f64>,
    pub(crate) index_mm: Option<f64>,
    /// On which side of its place it is on; where the controller looks for it if nothing is said.
    pub(crate) switch_way: Option<SwitchWay>,
    /// How far back the switch goes off, and how far beside its place it goes on at most, mm.
    pub(crate) switch_hysteresis_mm: f64,
    pub(crate) switch_scatter_mm: f64,
    /// What is wrong with them.
    pub(crate) reference_fault: Option<ReferenceFault>,
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
    /// Friction of the screw, referred to the slide; from rest it is the same if nothing is said.
    pub(crate) screw_coulomb_n: f64,
    pub(crate) screw_static_n: Option<f64>,
    pub(crate) screw_stribeck_mm_s: f64,
    pub(crate) screw_presliding_n_mm: f64,
    pub(crate) screw_bristle_n_s_mm: f64,
    pub(crate) screw_viscous_n_s_mm: f64,
    /// Friction of the guide.
    pub(crate) slide_coulomb_n: f64,
    pub(crate) slide_static_n: f64,
    pub(crate) slide_stribeck_mm_s: f64,
    pub(crate) slide_presliding_n_mm: f64,
    pub(crate) slide_bristle_n_s_mm: f64,
    pub(crate) slide_viscous_n_s_mm: f64,
    /// Constant force on the slide, N: what hangs has its weight. The machine was referenced under it.
    pub(crate) gravity_n: f64,
    /// First-order lag of the current loop, s.
    pub(crate) current_lag_s: f64,
    /// What the motor gives more than its drive believes, per cent.
    pub(crate) torque_constant_pct: f64,
    /// Noise of the torque that the drive measures, root of its mean square, and its step, N·m.
    pub(crate) torque_noise_nm: f64,
    pub(crate) torque_step_nm: f64,
    /// Torque by which the magnets hold the rotor at the teeth, N·m, how often a turn, and its phase at home;
    /// drawn from the seed if nothing is said.
    pub(crate) cogging_nm: f64,
    pub(crate) cogging_per_rev: u32,
    pub(crate) cogging_deg: Option<f64>,
    /// Speeds up to which the voltage lets the motor give all its torque, and at which it gives none, mm/s.
    pub(crate) full_torque_mm_s: Option<f64>,
    pub(crate) no_torque_mm_s: Option<f64>,
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
            screw_lead_mm: None,
            encoder_counts: None,
            home_off_mm: 0.0,
            switch_mm: None,
            index_mm: None,
            switch_way: None,
            switch_hysteresis_mm: 0.05,
            switch_scatter_mm: 0.002,
            reference_fault: None,
            scale_step_mm: None,
            torque_limit_nm: None,
            inertia_kg_m2: 12e-4,
            slide_mass_kg: 110.0,
            mode_hz: 100.0,
            mode_damping: 0.03,
            backlash_mm: 0.0,
            screw_error: Vec::new(),
            screw_wobble_um: 0.0,
            screw_coulomb_n: 150.0,
            screw_static_n: None,
            screw_stribeck_mm_s: 1.5,
            screw_presliding_n_mm: 30_000.0,
            screw_bristle_n_s_mm: 0.0,
            screw_viscous_n_s_mm: 2.0,
            slide_coulomb_n: 120.0,
            slide_static_n: 160.0,
            slide_stribeck_mm_s: 1.5,
            slide_presliding_n_mm: 15_000.0,
            slide_bristle_n_s_mm: 0.0,
            slide_viscous_n_s_mm: 0.6,
            gravity_n: 0.0,
            current_lag_s: 0.0005,
            torque_constant_pct: 0.0,
            torque_noise_nm: 0.0,
            torque_step_nm: 0.0,
            cogging_nm: 0.0,
            cogging_per_rev: 24,
            cogging_deg: None,
            full_torque_mm_s: None,
            no_torque_mm_s: None,
            quick_stop_mm_s2: 3000.0,
            overspeed_mm_s: 290.0,
            brake_n: 10_000.0,
        }
    }
}

impl AxisTrain {
    pub(super) fn check(&self, section: &str) -> Result<(), PlantError> {
        let corner = self.no_torque_mm_s.unwrap_or(1e5);
        for (name, value, low, high) in [
            ("inertia_kg_m2", self.inertia_kg_m2, 1e-6, 1.0),
            ("slide_mass_kg", self.slide_mass_kg, 0.1, 1e5),
            ("mode_hz", self.mode_hz, 5.0, 1000.0),
            ("mode_damping", self.mode_damping, 0.0, 1.0),
            ("backlash_mm", self.backlash_mm, 0.0, 10.0),
            ("screw_coulomb_n", self.screw_coulomb_n, 0.0, 1e5),
            (
                "screw_static_n",
                self.screw_static_n.unwrap_or(self.screw_coulomb_n),
                self.screw_coulomb_n,
                1e5,
            ),
            ("screw_stribeck_mm_s", self.screw_stribeck_mm_s, 0.01, 1e3),
            ("screw_presliding_n_mm", self.screw_presliding_n_mm, 1.0, 1e6),
            ("screw_bristle_n_s_mm", self.screw_bristle_n_s_mm, 0.0, 1e3),
            ("screw_viscous_n_s_mm", self.screw_viscous_n_s_mm, 0.0, 1e3),
            ("slide_coulomb_n", self.slide_coulomb_n, 0.0, 1e5),
            ("slide_static_n", self.slide_static_n, self.slide_coulomb_n, 1e5),
            ("slide_stribeck_mm_s", self.slide_stribeck_mm_s, 0.01, 1e3),
            ("slide_presliding_n_mm", self.slide_presliding_n_mm, 1.0, 1e6),
            ("slide_bristle_n_s_mm", self.slide_bristle_n_s_mm, 0.0, 1e3),
            ("slide_viscous_n_s_mm", self.slide_viscous_n_s_mm, 0.0, 1e3),
            ("current_lag_s", self.current_lag_s, 1e-6, 0.1),
            ("torque_constant_pct", self.torque_constant_pct, -50.0, 50.0),
            ("torque_noise_nm", self.torque_noise_nm, 0.0, 100.0),
            ("torque_step_nm", self.torque_step_nm, 0.0, 100.0),
            ("cogging_nm", self.cogging_nm, 0.0, 100.0),
            ("cogging_per_rev", f64::from(self.cogging_per_rev), 1.0, 1000.0),
            ("cogging_deg", self.cogging_deg.unwrap_or(0.0), -360.0, 360.0),
            ("no_torque_mm_s", corner, 1.0, 1e5),
            ("full_torque_mm_s", self.full_torque_mm_s.unwrap_or(0.0), 0.0, 0.99 * corner),
            ("quick_stop_mm_s2", self.quick_stop_mm_s2, 1.0, 1e6),
            ("overspeed_mm_s", self.overspeed_mm_s, 1.0, 1e5),
            ("brake_n", self.brake_n, 1.0, 1e6),
            ("home_off_mm", self.home_off_mm, -100.0, 100.0),
            ("switch_mm", self.switch_mm.unwrap_or(0.0), -1e5, 1e5),
            ("index_mm", self.index_mm.unwrap_or(0.0), -1e5, 1e5),
            ("switch_scatter_mm", self.switch_scatter_mm, 0.0, 1.0),
            ("switch_hysteresis_mm", self.switch_hysteresis_mm, 2.0 * self.switch_scatter_mm, 10.0),
            ("gravity_n", self.gravity_n, -HELD * self.brake_n, HELD * self.brake_n),
        ] {
            range(&format!("{section}.{name}"), value, low, high)?;
        }
        for (name, value, low, high) in [
            ("screw_lead_mm", self.screw_lead_mm, 1e-6, 1e3),
            ("encoder_counts", self.encoder_counts.map(f64::from), 16.0, 4e9),
            ("scale_step_mm", self.scale_step_mm, 1e-7, 10.0),
            ("torque_limit_nm", self.torque_limit_nm, 1e-6, 1e4),
        ] {
            value.map_or(Ok(()), |value| range(&format!("{section}.{name}"), value, low, high))?;
        }
        if let (Some(value), None) = (self.full_torque_mm_s, self.no_torque_mm_s) {
            let reason =
                "says nothing without no_torque_mm_s, the speed at which the voltage is used up".into();
            return Err(PlantError::Value { key: format!("{section}.full_torque_mm_s"), value, reason });
        }
        Ok(())
    }

    /// What is said of switch and index is said of such as the axis has.
    pub(super) fn check_marks(
        &self,
        section: &str,
        reference: Option<&ReferenceConfig>,
    ) -> Result<(), PlantError> {
        use ReferenceFault::{NoIndex, SwitchClosed, SwitchOpen};
        let method = reference.map(|reference| reference.method);
        let has_switch = matches!(method, Some(Method::Switch | Method::SwitchAndIndex));
        let has_index = matches!(method, Some(Method::Index | Method::SwitchAndIndex));
        let dead_switch = matches!(self.reference_fault, Some(SwitchOpen | SwitchClosed));
        for (name, is_given, is_there, mark) in [
            ("switch_mm", self.switch_mm.is_some(), has_switch, "switch"),
            ("switch_way", self.switch_way.is_some(), has_switch, "switch"),
            ("index_mm", self.index_mm.is_some(), has_index, "index"),
            ("reference_fault", dead_switch, has_switch, "switch"),
            ("reference_fault", self.reference_fault == Some(NoIndex), has_index, "index"),
        ] {
            if is_given && !is_there {
                return Err(PlantError::NoSuchMark { key: format!("{section}.{name}"), mark });
            }
        }
        Ok(())
    }

    /// What is true where a controller believes this.
    pub(crate) fn facts(&self, belief: &AxisConfig) -> Facts {
        let home_mm = belief.home_mm + self.home_off_mm;
        Facts {
            screw_lead_mm: self.screw_lead_mm.unwrap_or(belief.screw_lead_mm),
            encoder_counts: self.encoder_counts.unwrap_or(belief.encoder_counts),
            home_mm,
            built_home_mm: if belief.reference.is_some() { belief.home_mm } else { home_mm },
            scale_step_mm: belief.scale_step_mm.map(|step_mm| self.scale_step_mm.unwrap_or(step_mm)),
            torque_limit_nm: self.torque_limit_nm.unwrap_or(belief.torque_limit_nm),
        }
    }

    /// Up to which speed the motor has all its torque and from which on none, mm/s; `None` if the voltage is
    /// always enough.
    pub(crate) fn fading_mm_s(&self) -> Option<[f64; 2]> {
        self.no_torque_mm_s.map(|none| [self.full_torque_mm_s.unwrap_or(FULL * none), none])
    }

    /// The pair of screw and nut. Without a breakaway of its own its curve is flat, whatever its speed.
    pub(crate) fn screw(&self) -> Pair {
        Pair {
            coulomb_n: self.screw_coulomb_n,
            static_n: self.screw_static_n.unwrap_or(self.screw_coulomb_n),
            stribeck_m_s: self.screw_static_n.map_or(1.0, |_| self.screw_stribeck_mm_s * 1e-3),
            stiffness_n_m: self.screw_presliding_n_mm * 1e3,
            damping_n_s_m: self.screw_bristle_n_s_mm * 1e3,
        }
    }

    /// The pair of slide and guide.
    pub(crate) fn guide(&self) -> Pair {
        Pair {
            coulomb_n: self.slide_coulomb_n,
            static_n: self.slide_static_n,
            stribeck_m_s: self.slide_stribeck_mm_s * 1e-3,
            stiffness_n_m: self.slide_presliding_n_mm * 1e3,
            damping_n_s_m: self.slide_bristle_n_s_mm * 1e3,
        }
    }
}
