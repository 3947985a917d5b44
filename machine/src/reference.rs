//! `[axis.*.reference]` of the machine file: the reference run of an axis as the controller believes in it.
//! In: mm, mm/s; degrees of a rotary axis. Out: checked values, or the path of the key and the reason.
//!
//! The terms are those of LinuxCNC's homing (`HOME_SEARCH_VEL`, `HOME_LATCH_VEL`, `HOME_OFFSET`,
//! `HOME_SEQUENCE`) and of CiA 402's methods: by a home switch (19 to 22), by a home switch and the index
//! behind it (3 to 6), by an index alone (33, 34).

use motion::Exit;
use protocol::Axis;
use serde::{Deserialize, Serialize};

use super::{AxisConfig, General, MachineError, axis::key, range, refuse};

/// Behind where a switch must have changed by all that is believed, the axis goes on so far in vain, mm.
pub const BEYOND_MM: f64 = 10.0;
/// An index is looked for over so many turns of the motor.
pub const TURNS: f64 = 1.5;
/// Setpoints are so many interpolator cycles ahead of the axis at most, when a switch is seen.
const REACTS_TICKS: f64 = 6.0;

/// `[axis.*.reference]`
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferenceConfig {
    /// What the axis is referenced to.
    pub method: Method,
    /// Position of the axis where the switch goes on, or with an index at the index, mm.
    #[serde(alias = "position_deg")]
    pub position_mm: f64,
    /// Speed of the way to the switch, mm/s; its sign is the direction. Of an index alone only that counts.
    #[serde(alias = "search_deg_s")]
    pub search_mm_s: f64,
    /// Speed of the last way, on which the position is taken, mm/s, > 0.
    #[serde(alias = "latch_deg_s")]
    pub latch_mm_s: f64,
    /// A program begins with the reference runs of the axes in this order; axes of one number in that of the
    /// wire.
    #[serde(default)]
    pub sequence: u32,
}

/// What an axis is referenced to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// A switch that is on from a place to the end of travel.
    Switch,
    /// The first index of the motor behind that place.
    SwitchAndIndex,
    /// The index of the motor that is nearest to where the axis believes it to be.
    Index,
}

impl ReferenceConfig {
    /// Direction of the search, ±1.
    pub fn way(&self) -> f64 {
        self.search_mm_s.signum()
    }

    pub(super) fn check(
        &self,
        axis: Axis,
        config: &AxisConfig,
        general: &General,
    ) -> Result<(), MachineError> {
        let key = |name: &str| key(axis, &format!("reference.{name}"));
        let [low, high] = config.travel_mm;
        range(&key("position_mm"), self.position_mm, low, high)?;
        range(&key("search_mm_s"), self.search_mm_s, -config.velocity_mm_s, config.velocity_mm_s)?;
        let search = self.search_mm_s.abs();
        if search == 0.0 {
            return Err(refuse(
                &key("search_mm_s"),
                0,
                "must not be 0: its sign is the direction of the search",
            ));
        }
        // No two indexes in one tick.
        let fastest = search.min(0.1 * config.screw_lead_mm / general.interpolator_cycle_s);
        range(&key("latch_mm_s"), self.latch_mm_s, 1e-3, fastest)?;
        range(&key("sequence"), f64::from(self.sequence), 0.0, 1000.0)?;
        let reacts_s = REACTS_TICKS * general.interpolator_cycle_s;
        let brakes = |speed: f64| speed * (reacts_s + 0.5 * Exit::stop_s(speed, 0.0, &config.limits()));
        let end = if self.way() > 0.0 { high } else { low };
        if self.method == Method::Index {
            let (takes_mm, left) =
                (config.screw_lead_mm + brakes(self.latch_mm_s), (end - config.home_mm).abs());
            let reason = format!(
                "from home_mm the next index may be a whole turn away, {takes_mm:.3} with the way to brake, and the end of \
                 its travel is {left:.3} away: search the other way, or move home_mm"
            );
            let has_room = left >= takes_mm;
            return if has_room {
                Ok(())
            } else {
                Err(refuse(&key("search_mm_s"), self.search_mm_s, &reason))
            };
        }
        let brakes_mm = brakes(search);
        let left = (end - self.position_mm).abs();
        if left < brakes_mm {
            let reason = format!(
                "an axis that searches so fast stands {brakes_mm:.3} behind its switch, and the end of its travel \
                 is {left:.3} behind it: search more slowly, or move the switch"
            );
            return Err(refuse(&key("search_mm_s"), self.search_mm_s, &reason));
        }
        Ok(())
    }
}
