//! The machine of the reference simulation. Out: a machine whose plant, loops, encoders and beliefs are those
//! that it prints, whatever the machine file says; what it does not print is identified here.
//!
//! | what | where from |
//! |---|---|
//! | masses, mode, friction of the guide, stiffness of the bristles, lags, loops, encoders | printed |
//! | breakaway of the screw: 1.25 × Coulomb, at the speed of that of the guide | printed |
//! | observer and held references once in 1 ms, all else once in 0.5 ms; no ripple taken off the angle | printed |
//! | damping of the bristles: a tenth of the critical one of the mass on its bristles | identified, [`DAMPING`] |
//!
//! ```text
//! s1 = 2 ζ √(s0 M)   with M = J (2π/lead)² = 1895 kg for the screw, 110 kg for the guide
//! ```

use machine::{Bus, Feedforward, Machine};
use protocol::Axis;
use sim_plant::Belief;

use super::published::{Angle, Structure};
use crate::ExperimentError;

/// Damping ratio of the bristles. With it the slide creeps as that of the reference does.
pub(super) const DAMPING: f64 = 0.1;

/// The truth about the lathe of the reference.
const TRUTH: &str = "
    inertia_kg_m2 = 12e-4
    slide_mass_kg = 110.0
    mode_hz = 100.0
    mode_damping = 0.03
    screw_coulomb_n = 150.0
    screw_stribeck_mm_s = 1.5
    screw_presliding_n_mm = 30000.0
    screw_viscous_n_s_mm = 2.0
    slide_coulomb_n = 120.0
    slide_static_n = 160.0
    slide_stribeck_mm_s = 1.5
    slide_presliding_n_mm = 15000.0
    slide_viscous_n_s_mm = 0.6
    current_lag_s = 0.0005
";

/// What may be left out of the reference to see what it does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Switches {
    /// Whether the screw holds more from rest than it does sliding.
    pub(super) breakaway: bool,
    /// Damping ratio of the bristles.
    pub(super) damping: f64,
    /// Control cycles from one look of the observer to the next.
    pub(super) observer_cycles: u32,
}

/// All of it.
pub(super) const AS_PRINTED: Switches = Switches { breakaway: true, damping: DAMPING, observer_cycles: 2 };

/// Errors beyond which a machine is stopped, mm: wide enough for every structure.
const WIDE_MM: f64 = 10.0;
/// A bandwidth at which an observer is the count itself, Hz.
const NO_FILTER_HZ: f64 = 1e5;

/// The machine of the reference with a structure of feedforward.
///
/// # Errors
/// The plant cannot be built.
pub(super) fn machine(structure: &Structure, switches: Switches) -> Result<Machine, ExperimentError> {
    let failed = |error: String| ExperimentError::Machine(error);
    let damped = |n_m: f64, kg: f64| 2e-3 * switches.damping * (n_m * kg).sqrt();
    let plant = format!(
        "[axis.x]{TRUTH}\nscrew_static_n = {:?}\nscrew_bristle_n_s_mm = {:?}\nslide_bristle_n_s_mm = {:?}\n\
         [spindle]\nripple_pct = 0.2\nripple_per_rev = 2\n",
        if switches.breakaway { 187.5 } else { 150.0 },
        damped(3e7, 1895.0),
        damped(1.5e7, 110.0),
    );
    let plant = plant.parse().map_err(|error: toml::de::Error| failed(error.to_string()))?;
    let mut machine = Machine { plant, ..Machine::plain() };
    let truth = Belief::of_truth(&machine, Axis::X).map_err(|error| failed(error.to_string()))?;
    machine.bus = Bus::default();
    let spindle = &mut machine.spindle;
    spindle.encoder_delay_s = 0.0;
    spindle.plain_observer_cycles = Some(switches.observer_cycles);
    (spindle.encoder_lines, spindle.observer_hz, spindle.stroke_observer_hz) = match structure.angle {
        Angle::Raw => (1024, 30.0, NO_FILTER_HZ),
        Angle::Observed => (1024, 30.0, 30.0),
        Angle::Fine => (2500, 30.0, 15.0),
    };
    if let Some(x) = machine.axis.get_mut(&Axis::X) {
        let tight = structure.angle == Angle::Fine;
        (x.position_gain_1_s, x.velocity_bandwidth_hz, x.velocity_integral_s) =
            if tight { (100.0, 80.0, 0.008) } else { (60.0, 60.0, 0.012) };
        truth.put_into(x);
        // Nothing of this was in the reference.
        (x.mode_hz, x.unload_mm, x.backlash_mm, x.scale_step_mm) = (None, 0.0, 0.0, None);
        if !structure.friction {
            (x.coulomb_n, x.viscous_n_s_mm) = (0.0, 0.0);
        }
        x.feedforward = structure.feedforward;
        if structure.feedforward != Feedforward::Full {
            (x.following_error_mm, x.thread_error_mm) = (WIDE_MM, WIDE_MM);
        }
    }
    Ok(machine)
}
