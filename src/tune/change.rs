//! What tuning changes of an axis: each key with its value before and after, its deviation, and how it was
//! found. In: a tuned axis. Out: rows.

use machine::AxisConfig;
use protocol::Axis;
use serde::Serialize;
use tune::{Estimate, Tuned};

/// A key that tuning writes.
pub(super) struct Key {
    name: &'static str,
    unit: &'static str,
    pub(super) of: fn(&AxisConfig) -> f64,
    deviation: fn(&Tuned) -> Option<f64>,
    how: &'static str,
}

impl Key {
    /// The key as a machine file spells it for an axis.
    pub(super) fn name_on(&self, axis: Axis) -> String {
        on(self.name, axis)
    }
}

/// A key or a unit of a linear axis, on any axis.
fn on(text: &str, axis: Axis) -> String {
    if axis.is_rotary() { text.replace("mm", "deg") } else { text.into() }
}

/// The keys in the order of the machine file.
pub(super) const KEYS: [Key; 9] = [
    Key {
        name: "position_gain_1_s",
        unit: "1/s",
        of: |axis| axis.position_gain_1_s,
        deviation: |_| None,
        how: "margins of the position loop on the measured response",
    },
    Key {
        name: "velocity_bandwidth_hz",
        unit: "Hz",
        of: |axis| axis.velocity_bandwidth_hz,
        deviation: |_| None,
        how: "margins of the velocity loop on the measured response",
    },
    Key {
        name: "velocity_integral_s",
        unit: "s",
        of: |axis| axis.velocity_integral_s,
        deviation: |_| None,
        how: "4/(2π velocity_bandwidth_hz)",
    },
    Key {
        name: "mass_kg",
        unit: "kg",
        of: |axis| axis.mass_kg,
        deviation: |tuned| Some(tuned.mass_kg.deviation),
        how: "impulses of runs both ways",
    },
    Key {
        name: "coulomb_n",
        unit: "N",
        of: |axis| axis.coulomb_n,
        deviation: |tuned| Some(tuned.coulomb_n.deviation),
        how: "impulses of runs both ways",
    },
    Key {
        name: "presliding_n_mm",
        unit: "N/mm",
        of: |axis| axis.presliding_n_mm,
        deviation: |tuned| tuned.presliding_n_mm.map(|found| found.deviation),
        how: "torque over way in small reversals",
    },
    Key {
        name: "viscous_n_s_mm",
        unit: "N·s/mm",
        of: |axis| axis.viscous_n_s_mm,
        deviation: |tuned| Some(tuned.viscous_n_s_mm.deviation),
        how: "impulses of runs both ways",
    },
    Key {
        name: "velocity_lead_s",
        unit: "s",
        of: |axis| axis.velocity_lead_s,
        deviation: |_| None,
        how: "half a cycle back",
    },
    Key {
        name: "acceleration_lead_s",
        unit: "s",
        of: |axis| axis.acceleration_lead_s,
        deviation: |tuned| Some(both(tuned.delay_s, tuned.lag_s)),
        how: "delay + half a cycle + lag, by phase",
    },
];

fn both(delay: Estimate, lag: Estimate) -> f64 {
    libm::hypot(delay.deviation, lag.deviation)
}

/// One key before and after.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Change {
    pub(super) key: String,
    pub(super) unit: String,
    pub(super) before: f64,
    pub(super) after: f64,
    /// Standard deviation of what was identified; nothing for what was chosen.
    pub(super) deviation: Option<f64>,
    pub(super) how: &'static str,
}

/// The changes that a tuned axis proposes to its configuration.
pub(super) fn changes(before: &AxisConfig, tuned: &Tuned) -> Vec<Change> {
    let change = |key: &Key| Change {
        key: format!("axis.{}.{}", tuned.axis.name(), key.name_on(tuned.axis)),
        unit: on(key.unit, tuned.axis),
        before: (key.of)(before),
        after: (key.of)(&tuned.proposal),
        deviation: (key.deviation)(tuned),
        how: if key.name == "presliding_n_mm" && tuned.presliding_n_mm.is_none() {
            "kept: too little friction to tell"
        } else {
            key.how
        },
    };
    KEYS.iter().map(change).collect()
}
