//! What tuning changes of an axis: each key with its value before and after, its deviation, and how it was
//! found. In: a tuned axis. Out: rows.

use machine::AxisConfig;
use protocol::Axis;
use serde::Serialize;
use tune::{Estimate, Tuned, Wave};

/// A key that tuning writes.
pub(super) struct Key {
    name: &'static str,
    unit: &'static str,
    /// What an axis has of it; `None` if the key is absent and need not be there.
    pub(super) of: fn(&AxisConfig) -> Option<f64>,
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
pub(super) const KEYS: [Key; 11] = [
    Key {
        name: "position_gain_1_s",
        unit: "1/s",
        of: |axis| Some(axis.position_gain_1_s),
        deviation: |_| None,
        how: "margins of the position loop on the measured response",
    },
    Key {
        name: "velocity_bandwidth_hz",
        unit: "Hz",
        of: |axis| Some(axis.velocity_bandwidth_hz),
        deviation: |_| None,
        how: "margins of the velocity loop on the measured response",
    },
    Key {
        name: "velocity_integral_s",
        unit: "s",
        of: |axis| Some(axis.velocity_integral_s),
        deviation: |_| None,
        how: "4/(2π velocity_bandwidth_hz)",
    },
    Key {
        name: "mass_kg",
        unit: "kg",
        of: |axis| Some(axis.mass_kg),
        deviation: |tuned| Some(tuned.mass_kg.deviation),
        how: "impulses of runs both ways",
    },
    Key {
        name: "coulomb_n",
        unit: "N",
        of: |axis| Some(axis.coulomb_n),
        deviation: |tuned| Some(tuned.coulomb_n.deviation),
        how: "impulses of runs both ways",
    },
    Key {
        name: "presliding_n_mm",
        unit: "N/mm",
        of: |axis| Some(axis.presliding_n_mm),
        deviation: |tuned| tuned.presliding_n_mm.map(|found| found.deviation),
        how: "torque over way in small reversals",
    },
    Key {
        name: "viscous_n_s_mm",
        unit: "N·s/mm",
        of: |axis| Some(axis.viscous_n_s_mm),
        deviation: |tuned| Some(tuned.viscous_n_s_mm.deviation),
        how: "impulses of runs both ways",
    },
    Key {
        name: "velocity_lead_s",
        unit: "s",
        of: |axis| Some(axis.velocity_lead_s),
        deviation: |_| None,
        how: "half a cycle back",
    },
    Key {
        name: "acceleration_lead_s",
        unit: "s",
        of: |axis| Some(axis.acceleration_lead_s),
        deviation: |tuned| Some(both(tuned.delay_s, tuned.lag_s)),
        how: "delay + half a cycle + lag, by phase",
    },
    Key {
        name: "gravity_n",
        unit: "N",
        of: |axis| (axis.gravity_n != 0.0).then_some(axis.gravity_n),
        deviation: |tuned| Some(tuned.constant_n.deviation),
        how: "impulses of runs both ways",
    },
    Key {
        name: "mode_hz",
        unit: "Hz",
        of: |axis| axis.mode_hz,
        deviation: |tuned| tuned.approach_s.and(tuned.mode).map(|mode| mode.hz.deviation),
        how: "frequency response",
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
    /// Nothing where the key is absent.
    pub(super) before: Option<f64>,
    pub(super) after: Option<f64>,
    /// Standard deviation of what was identified; nothing for what was chosen.
    pub(super) deviation: Option<f64>,
    pub(super) how: &'static str,
}

/// The changes that a tuned axis proposes to its configuration. What neither has is left out.
pub(super) fn changes(before: &AxisConfig, tuned: &Tuned) -> Vec<Change> {
    let change = |key: &Key| Change {
        key: format!("axis.{}.{}", tuned.axis.name(), key.name_on(tuned.axis)),
        unit: on(key.unit, tuned.axis),
        before: (key.of)(before),
        after: (key.of)(&tuned.proposal),
        deviation: (key.deviation)(tuned),
        how: match key.name {
            "presliding_n_mm" if tuned.presliding_n_mm.is_none() => "kept: too little friction to tell",
            "mode_hz" if tuned.approach_s.is_none() => "kept: no mode that can be trusted",
            _ => key.how,
        },
    };
    let keys = KEYS.iter().map(change);
    let rows = keys.chain(cogging(before, tuned));
    rows.filter(|change| change.before.is_some() || change.after.is_some()).collect()
}

/// Torque and phase of cogging, for each number of times a turn.
fn cogging(before: &AxisConfig, tuned: &Tuned) -> Vec<Change> {
    let Some(waves) = &tuned.cogging else { return Vec::new() };
    let mut all: Vec<f64> =
        before.cogging.iter().chain(&tuned.proposal.cogging).map(|[times, ..]| *times).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    let change = |times: f64, column: usize| {
        let of = |axis: &AxisConfig| axis.cogging.iter().find(|row| row[0] == times).map(|row| row[column]);
        let wave = waves.iter().find(|wave| f64::from(wave.times) == times);
        let deviation = |wave: &Wave| [wave.torque_nm, wave.phase_deg][column - 1].deviation;
        Change {
            key: format!("axis.{}.cogging, {times} a turn", tuned.axis.name()),
            unit: ["N·m", "°"][column - 1].into(),
            before: of(before),
            after: of(&tuned.proposal),
            deviation: wave.map(deviation),
            how: ["slow turns both ways", "its phase"][column - 1],
        }
    };
    all.iter().flat_map(|times| [change(*times, 1), change(*times, 2)]).collect()
}
