//! `at`: when an event happens. In: its table. Out: a checked trigger.

use serde::Deserialize;

use super::{Trigger, range};

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawTrigger {
    pass: Option<u32>,
    z_mm: Option<f64>,
    angle_deg: Option<f64>,
    after_pass: Option<u32>,
    time_s: Option<f64>,
    cycle: Option<u64>,
    line: Option<u32>,
}

pub(super) const TRIGGERS: &str =
    "{ pass, z_mm }, { pass, angle_deg }, { after_pass }, { time_s }, { cycle } or { line }";

impl RawTrigger {
    pub(super) fn check(&self) -> Result<Trigger, String> {
        let given =
            (self.pass, self.z_mm, self.angle_deg, self.after_pass, self.time_s, self.cycle, self.line);
        match given {
            (Some(pass), Some(z_mm), None, None, None, None, None) => {
                range("at.z_mm", z_mm, -1e5, 1e5)?;
                Ok(Trigger::PassZ { pass: at_least_one("at.pass", pass)?, z_mm })
            }
            (Some(pass), None, Some(angle_deg), None, None, None, None) => {
                range("at.angle_deg", angle_deg, 0.0, 1e7)?;
                Ok(Trigger::PassAngle { pass: at_least_one("at.pass", pass)?, angle_deg })
            }
            (None, None, None, Some(pass), None, None, None) => {
                Ok(Trigger::AfterPass { pass: at_least_one("at.after_pass", pass)? })
            }
            (None, None, None, None, Some(time_s), None, None) => {
                range("at.time_s", time_s, 0.0, 1e6)?;
                Ok(Trigger::Time { time_s })
            }
            (None, None, None, None, None, Some(cycle), None) => Ok(Trigger::Cycle { cycle }),
            (None, None, None, None, None, None, Some(line)) => {
                Ok(Trigger::Line { line: at_least_one("at.line", line)? })
            }
            (None, None, None, None, None, None, None) => {
                Err(format!("at: no trigger; give one of {TRIGGERS}"))
            }
            _ => Err(format!("at: these keys do not make one trigger; give one of {TRIGGERS}")),
        }
    }
}

fn at_least_one(key: &str, value: u32) -> Result<u32, String> {
    if value > 0 { Ok(value) } else { Err(format!("{key} = 0: counted from 1")) }
}
