//! What the cut does to the machine: loads and forces. In: the values of an event. Out: checked actions.

use protocol::Axis;
use serde::Deserialize;

use super::{Action, Burden, check_duration, range};

/// Largest force, N.
const MOST_N: f64 = 1e5;

/// `spindle_load`
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawLoad {
    torque_nm: Option<f64>,
    nm_per_rpm: Option<f64>,
    for_s: Option<f64>,
}

impl RawLoad {
    pub(super) fn check(&self) -> Result<Action, String> {
        const KEY: &str = "spindle_load";
        match (self.torque_nm, self.nm_per_rpm) {
            (Some(torque_nm), None) => {
                range("spindle_load.torque_nm", torque_nm, 0.0, 1e5)?;
                burden(KEY, Burden::Spindle, torque_nm, self.for_s)
            }
            (None, Some(nm_per_rpm)) => {
                range("spindle_load.nm_per_rpm", nm_per_rpm, 0.0, 1e3)?;
                check_duration(KEY, self.for_s)?;
                Ok(Action::LoadBySpeed { nm_per_rpm, for_s: self.for_s })
            }
            _ => Err(format!("{KEY} takes either torque_nm or nm_per_rpm")),
        }
    }
}

/// `axial_force_n`, `radial_force_n`
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a force in N, or { force_n, for_s }")]
pub(super) enum RawForce {
    Constant(f64),
    Passing(RawPassingForce),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawPassingForce {
    force_n: f64,
    for_s: Option<f64>,
}

impl RawForce {
    pub(super) fn check(&self, key: &str, which: Burden) -> Result<Action, String> {
        let (force_n, for_s) = match self {
            RawForce::Constant(force_n) => (*force_n, None),
            RawForce::Passing(RawPassingForce { force_n, for_s }) => (*force_n, *for_s),
        };
        range(key, force_n, -MOST_N, MOST_N)?;
        burden(key, which, force_n, for_s)
    }
}

/// `force_spike`
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawSpike {
    axis: Axis,
    force_n: f64,
    for_s: f64,
}

impl RawSpike {
    pub(super) fn check(&self) -> Result<Action, String> {
        range("force_spike.force_n", self.force_n, -MOST_N, MOST_N)?;
        check_duration("force_spike", Some(self.for_s))?;
        Ok(Action::Spike { axis: self.axis, force_n: self.force_n, for_s: self.for_s })
    }
}

fn burden(key: &str, burden: Burden, amount: f64, for_s: Option<f64>) -> Result<Action, String> {
    check_duration(key, for_s)?;
    Ok(Action::Burden { burden, amount, for_s })
}
