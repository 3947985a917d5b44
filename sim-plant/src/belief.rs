//! What a controller would believe about an axis if it knew the truth, and how to believe something else. In:
//! a machine file. Out: mass in kg and friction in N, N/mm, N·s/mm at the slide, as `[axis.*]` has them. For
//! experiments that ask what a wrong belief costs; no controller sees it.
//!
//! | symbol | unit | meaning |
//! |---|---|---|
//! | P, N | mm, – | true lead of the screw and counts of its encoder; P0, N0 as believed |
//! | e | – | what the motor gives more than its drive believes, a share |
//! | s | – | true way by the way that the controller takes it for |
//!
//! ```text
//! mass = J (2π/P)² + slide      Coulomb, presliding, viscous: screw + guide
//! in the torque, the turns and the counts that the controller has to do with:
//! a force times P/(P0 (1 + e));  mass, presliding and viscous also times s = P N0/(P0 N)              (M117)
//! ```

use core::f64::consts::TAU;

use machine::{AxisConfig, Machine};
use protocol::Axis;

use crate::config::{PlantConfig, PlantError};

/// Mass and friction of an axis as `[axis.*]` states them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Belief {
    /// Everything that moves, referred to the slide, kg.
    pub mass_kg: f64,
    /// Coulomb friction, N.
    pub coulomb_n: f64,
    /// Stiffness of friction before it slides, N/mm.
    pub presliding_n_mm: f64,
    /// Viscous friction, N·s/mm.
    pub viscous_n_s_mm: f64,
}

impl Belief {
    /// What is true of an axis.
    ///
    /// # Errors
    /// [`PlantError`] if the truth cannot be, or the machine has no such axis.
    pub fn of_truth(machine: &Machine, axis: Axis) -> Result<Belief, PlantError> {
        let train = PlantConfig::of(machine)?.axis.get(&axis).cloned().unwrap_or_default();
        let config = machine.axis.get(&axis).ok_or(PlantError::NoSuchAxis(axis.name()))?;
        let facts = train.facts(config);
        let turns = TAU / (facts.screw_lead_mm / 1000.0);
        let lead = facts.screw_lead_mm / config.screw_lead_mm;
        let force = lead / (1.0 + 0.01 * train.torque_constant_pct);
        let way = force * lead * f64::from(config.encoder_counts) / f64::from(facts.encoder_counts);
        Ok(Belief {
            mass_kg: way * (train.inertia_kg_m2 * turns * turns + train.slide_mass_kg),
            coulomb_n: force * (train.screw_coulomb_n + train.slide_coulomb_n),
            presliding_n_mm: way * (train.screw_presliding_n_mm + train.slide_presliding_n_mm),
            viscous_n_s_mm: way * (train.screw_viscous_n_s_mm + train.slide_viscous_n_s_mm),
        })
    }

    /// The same with the mass off by a share of it, and all friction off by another: −0.15 is 15 % too low.
    #[must_use]
    pub fn off_by(self, mass: f64, friction: f64) -> Belief {
        let (mass, friction) = (1.0 + mass, 1.0 + friction);
        Belief {
            mass_kg: mass * self.mass_kg,
            coulomb_n: friction * self.coulomb_n,
            presliding_n_mm: friction * self.presliding_n_mm,
            viscous_n_s_mm: friction * self.viscous_n_s_mm,
        }
    }

    /// Makes a controller believe it.
    pub fn put_into(self, config: &mut AxisConfig) {
        config.mass_kg = self.mass_kg;
        config.coulomb_n = self.coulomb_n;
        config.presliding_n_mm = self.presliding_n_mm;
        config.viscous_n_s_mm = self.viscous_n_s_mm;
    }
}

/// Lag of the current loop of an axis as it truly is, s: with it the torque that a drive asked for follows
/// from the torque that its motor gave.
///
/// # Errors
/// As [`Belief::of_truth`].
pub fn current_lag_s(machine: &Machine, axis: Axis) -> Result<f64, PlantError> {
    let train = PlantConfig::of(machine)?.axis.get(&axis).cloned().unwrap_or_default();
    machine.axis.get(&axis).map(|_| train.current_lag_s).ok_or(PlantError::NoSuchAxis(axis.name()))
}

/// Inertia of everything that turns with the spindle as it truly is, kg m²: what torque takes how much of its
/// speed.
///
/// # Errors
/// [`PlantError`] if the truth cannot be.
pub fn spindle_inertia_kg_m2(machine: &Machine) -> Result<f64, PlantError> {
    Ok(PlantConfig::of(machine)?.spindle.inertia_kg_m2)
}

/// What the motor of the spindle can at most, at the spindle: torque, N·m, and power, kW.
///
/// # Errors
/// [`PlantError`] if the truth cannot be.
pub fn spindle_peak(machine: &Machine) -> Result<[f64; 2], PlantError> {
    let train = PlantConfig::of(machine)?.spindle;
    Ok([train.peak_torque_nm, train.peak_power_kw])
}

/// Where the stock truly ends and begins along Z of the machine, mm, if the machine file says so.
///
/// # Errors
/// [`PlantError`] if the truth cannot be.
pub fn stock_mm(machine: &Machine) -> Result<Option<[f64; 2]>, PlantError> {
    let cutting = PlantConfig::of(machine)?.cutting;
    Ok((cutting.face_mm.is_some() || cutting.back_mm.is_some()).then(|| cutting.stock_mm()))
}
