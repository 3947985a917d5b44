//! `[axis.*.reference]` of the machine file: the reference run of an axis as the controller believes in it.
//! In: mm, mm/s; degrees of a rotary axis. Out: checked values, or the path of the key and the reason.
//!
//! The terms are those of LinuxCNC's homing (`HOME_SEARCH_VEL`, `HOME_LATCH_VEL`, `HOME_OFFSET`,
//! `HOME_SEQUENCE`) and of CiA 402's methods: by a home switch (19 to 22), by a home switch and the index
//! behind it (3 to 6), by an index alone (33, 34).

use motion::Exit;
use protocol::Axis;
use serde::{Deserialize, Serialize};

use super::{AxisConfig, General, Machine, MachineError, axis::key, range, refuse, screw::Screw};

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
    /// Where the slide is when the switch goes on, mm; with an index where the motor is at the index, with a
    /// scale the slide.
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

impl Method {
    /// For people.
    pub const fn in_words(self) -> &'static str {
        match self {
            Method::Switch => "switch",
            Method::SwitchAndIndex => "switch and index",
            Method::Index => "index",
        }
    }
}

impl Machine {
    /// The reference runs that a program begins with, in their order.
    pub fn reference_runs(&self) -> Vec<(Axis, ReferenceConfig)> {
        let has = |(axis, config): (Axis, &AxisConfig)| Some((axis, config.reference?));
        let mut runs: Vec<_> = self.axes().filter_map(has).collect();
        runs.sort_by_key(|(axis, reference)| (reference.sequence, *axis));
        runs
    }
}

impl ReferenceConfig {
    /// Direction of the search, ±1.
    pub fn way(&self) -> f64 {
        self.search_mm_s.signum()
    }

    /// Where the axis is measured when its switch or index comes, mm. A switch is at the slide, an index at
    /// the motor; between both is what is believed of the screw (M68), and half of the backlash on the flank
    /// that the axis came by. What measures is a scale at the slide, or the motor.
    pub fn measured_mm(&self, config: &AxisConfig) -> f64 {
        let ahead_mm = 0.5 * config.backlash_mm * self.way();
        match (self.method, config.scale_step_mm) {
            (Method::Switch, None) => {
                let screw = Screw::new(&config.screw_error);
                let error_mm = |s| screw.as_ref().map_or(0.0, |screw| screw.error(s)[0]);
                self.position_mm - error_mm(self.position_mm) + error_mm(config.home_mm) + ahead_mm
            }
            (Method::Switch, Some(_)) | (_, None) => self.position_mm,
            (_, Some(_)) => self.position_mm - ahead_mm,
        }
    }

    /// Where an axis with an index alone may stand and make its run within its travel, mm: it stands up to
    /// half a turn elsewhere than it believes, and its way is up to a turn and what it brakes in.
    pub fn run_begins_within(&self, config: &AxisConfig, general: &General) -> [f64; 2] {
        let [low, high] = config.travel_mm;
        let (half, way_mm) = (
            0.5 * config.screw_lead_mm,
            config.screw_lead_mm + self.brakes_mm(self.latch_mm_s, config, general),
        );
        match self.way() > 0.0 {
            true => [low + half, high - half - way_mm],
            false => [low + half + way_mm, high - half],
        }
    }

    /// How far an axis goes on at this speed when switch or index come, mm.
    fn brakes_mm(&self, speed: f64, config: &AxisConfig, general: &General) -> f64 {
        let reacts_s = REACTS_TICKS * general.interpolator_cycle_s;
        speed * (reacts_s + 0.5 * Exit::stop_s(speed, 0.0, &config.limits()))
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
            let reason = "must not be 0: its sign is the direction of the search";
            return Err(refuse(&key("search_mm_s"), 0, reason));
        }
        range(&key("latch_mm_s"), self.latch_mm_s, 1e-3, search)?;
        range(&key("sequence"), f64::from(self.sequence), 0.0, 1000.0)?;
        let (ahead, back) = if self.way() > 0.0 { (high, low) } else { (low, high) };
        let brakes_mm = self.brakes_mm(search, config, general);
        let (way_mm, left, reason) = if self.method == Method::Index {
            let way_mm = config.screw_lead_mm + self.brakes_mm(self.latch_mm_s, config, general);
            (way_mm, (ahead - config.home_mm).abs(), "from home_mm the next index may be a whole turn away")
        } else if (ahead - self.position_mm).abs() < brakes_mm {
            (
                brakes_mm,
                (ahead - self.position_mm).abs(),
                "an axis that searches so fast stands behind its switch",
            )
        } else {
            let before = if self.method == Method::Switch { 0.0 } else { config.screw_lead_mm };
            (
                before + brakes_mm,
                (back - self.position_mm).abs(),
                "an axis that backs off stands before its switch",
            )
        };
        if left < way_mm {
            let unit = if axis.is_rotary() { "°" } else { "mm" };
            let remedy = match self.method {
                Method::Index => "search the other way, or move home_mm",
                _ => "search more slowly, or move the switch",
            };
            let reason = format!(
                "{reason}, {way_mm:.3} {unit} with the way to brake, and its travel ends after {left:.3} {unit}: {remedy}"
            );
            return Err(refuse(&key("search_mm_s"), self.search_mm_s, &reason));
        }
        Ok(())
    }
}
