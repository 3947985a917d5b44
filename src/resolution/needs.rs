//! What each axis needs (M30–M33), beside what it counts in. In: limits of an axis, tolerance of the part,
//! into how many steps each is divided. Out: steps in mm or degrees per cycleⁿ, and what they are in counts
//! (M29, M34).

use adviser::resolution::{Counts, Demand, Required, Steps, order};
use machine::AxisConfig;
use protocol::Axis;

/// One axis, or the motion that was given.
#[derive(Clone, Debug)]
pub(super) struct AxisNeeds {
    /// Which axis of a machine file; none for a motion that was given.
    pub(super) axis: Option<(Axis, AxisConfig)>,
    /// Its limits and the tolerance: in mm, or in degrees where it turns.
    pub(super) demand: Demand,
    /// The steps it needs.
    pub(super) required: Required,
    /// What its encoder counts, and its cycle.
    pub(super) encoder: Counts,
}

/// One of position, speed, acceleration, jerk.
#[derive(Clone, Debug)]
pub(super) struct Quantity {
    pub(super) name: &'static str,
    /// Tolerance, or highest value.
    pub(super) highest: f64,
    pub(super) unit: String,
    /// K: into how many steps that is divided.
    pub(super) divided: f64,
    /// The step that is needed, mm or degrees per cycleⁿ.
    pub(super) step: f64,
    pub(super) step_unit: String,
    /// The highest value in counts per cycleⁿ (M29); none for a position.
    pub(super) internal: Option<f64>,
    /// How many times a count is coarser than the step (M34).
    pub(super) discrepancy: f64,
}

/// What the n-th difference of counts errs by (M28).
#[derive(Clone, Debug)]
pub(super) struct Difference {
    /// What it gives.
    pub(super) of: &'static str,
    pub(super) order: u16,
    pub(super) unit: String,
    /// At most, counts per cycleⁿ and in `unit`.
    pub(super) counts: f64,
    pub(super) largest: f64,
    /// If errors of rounding are independent.
    pub(super) rms: f64,
    /// The largest in per cent of the limit of the axis.
    pub(super) of_limit_pct: f64,
}

pub(super) const QUANTITIES: [&str; 4] = ["position", "speed", "acceleration", "jerk"];
const POWERS: [&str; 4] = ["", "/cycle", "/cycle²", "/cycle³"];

/// µm on a radius in mm, as thousandths of a degree (M95).
pub(super) fn turned(tolerance_um: f64, radius_mm: f64) -> f64 {
    (tolerance_um / radius_mm).to_degrees()
}

impl AxisNeeds {
    /// An axis of a machine; `tolerance_um` is in thousandths of its unit.
    pub(super) fn of(
        axis: Axis,
        config: &AxisConfig,
        tolerance_um: f64,
        cycle_s: f64,
        steps: &Steps,
    ) -> AxisNeeds {
        let demand = Demand {
            tolerance_um,
            feed_mm_min: 60.0 * config.velocity_mm_s,
            acceleration_m_s2: 1e-3 * config.acceleration_mm_s2,
            jerk_m_s3: 1e-3 * config.jerk_mm_s3,
            cycle_hz: 1.0 / cycle_s,
        };
        let per_mm = f64::from(config.encoder_counts) / config.screw_lead_mm;
        AxisNeeds::given(demand, per_mm, steps).named(axis, config)
    }

    /// A motion that was given, in a control that counts `per_mm`.
    pub(super) fn given(demand: Demand, per_mm: f64, steps: &Steps) -> AxisNeeds {
        let encoder = Counts { per_mm, cycle_hz: demand.cycle_hz };
        AxisNeeds { axis: None, demand, required: Required::of(&demand, steps), encoder }
    }

    fn named(self, axis: Axis, config: &AxisConfig) -> AxisNeeds {
        AxisNeeds { axis: Some((axis, config.clone())), ..self }
    }

    pub(super) fn name(&self) -> String {
        self.axis.as_ref().map_or("given".into(), |(axis, _)| axis.to_string())
    }

    /// mm or deg.
    pub(super) fn unit(&self) -> &'static str {
        self.axis.as_ref().map_or("mm", |(axis, _)| axis.unit())
    }

    /// Step of what the position loop closes over: the scale, or the encoder.
    pub(super) fn position_step(&self) -> f64 {
        let scale = self.axis.as_ref().and_then(|(_, config)| config.scale_step_mm);
        scale.unwrap_or(self.encoder.increment_mm())
    }

    /// Limits in mm or degrees by s, s², s³.
    pub(super) fn limits(&self) -> [f64; 3] {
        let Demand { feed_mm_min, acceleration_m_s2, jerk_m_s3, .. } = self.demand;
        [feed_mm_min / 60.0, 1e3 * acceleration_m_s2, 1e3 * jerk_m_s3]
    }

    /// Position, speed, acceleration, jerk.
    pub(super) fn quantities(&self, steps: &Steps) -> [Quantity; 4] {
        let Demand { tolerance_um, feed_mm_min, acceleration_m_s2, jerk_m_s3, .. } = self.demand;
        let unit = self.unit();
        let (highest, units) = if unit == "mm" {
            let units = ["µm", "mm/min", "m/s²", "m/s³"].map(str::to_owned);
            ([tolerance_um, feed_mm_min, acceleration_m_s2, jerk_m_s3], units)
        } else {
            let values = [1e-3 * tolerance_um, feed_mm_min, 1e3 * acceleration_m_s2, 1e3 * jerk_m_s3];
            (values, ["", "/min", "/s²", "/s³"].map(|by| format!("{unit}{by}")))
        };
        let internal = [
            None,
            Some(self.encoder.speed(feed_mm_min)),
            Some(self.encoder.acceleration(acceleration_m_s2)),
            Some(self.encoder.jerk(jerk_m_s3)),
        ];
        let divided = [steps.tolerance, steps.feed, steps.acceleration, steps.jerk];
        let [position, speed, acceleration, jerk] = self.required.steps();
        let needed = [position, speed, acceleration, jerk];
        std::array::from_fn(|n| Quantity {
            name: QUANTITIES[n],
            highest: highest[n],
            unit: units[n].clone(),
            divided: divided[n],
            step: needed[n],
            step_unit: format!("{unit}{}", POWERS[n]),
            internal: internal[n],
            discrepancy: self.encoder.discrepancy(needed[n]),
        })
    }

    /// What speed, acceleration and jerk err by that are made by differences of counts.
    pub(super) fn differences(&self) -> [Difference; 3] {
        let (limits, unit) = (self.limits(), self.unit());
        [1_u16, 2, 3].map(|n| {
            let place = usize::from(n);
            let largest = self.encoder.difference_bound(n);
            Difference {
                of: QUANTITIES[place],
                order: n,
                unit: format!("{unit}/s{}", ["", "", "²", "³"][place]),
                counts: adviser::resolution::difference_bound(n),
                largest,
                rms: self.encoder.difference_rms(n),
                of_limit_pct: 100.0 * largest / limits[place - 1],
            }
        })
    }

    /// Whether two axes need and have the same, so that one line says it of both.
    pub(super) fn is_like(&self, other: &AxisNeeds) -> bool {
        (self.unit(), self.demand, self.encoder) == (other.unit(), other.demand, other.encoder)
    }
}

impl Quantity {
    /// Decimal order of the step (M35).
    pub(super) fn order(&self) -> i32 {
        order(self.step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tolerance of 25 µm at 57.2958 mm, where a degree is a millimetre, is 0.025 degrees.
    #[test]
    fn a_tolerance_on_a_radius_is_an_angle() {
        assert!((turned(25.0, 180.0 / std::f64::consts::PI) - 25.0).abs() < 1e-12);
        assert!((turned(25.0, 25.0) - 57.295_779_513).abs() < 1e-8);
    }

    #[test]
    fn a_rotary_axis_is_asked_in_degrees() {
        let mut config = machine::Machine::default().axis[&Axis::X].clone();
        (config.velocity_mm_s, config.screw_lead_mm, config.encoder_counts) = (60.0, 4.0, 40_000);
        let needs = AxisNeeds::of(Axis::C, &config, turned(20.0, 40.0), 5e-4, &Steps::PUBLISHED);
        let [position, speed, ..] = needs.quantities(&Steps::PUBLISHED);
        assert!((position.step - 0.02 / 40.0 / 10.0 * 57.295_779_513).abs() < 1e-12);
        assert!((speed.step - 60.0 / 2000.0 / 1e4).abs() < 1e-15);
        assert_eq!((position.unit.as_str(), speed.step_unit.as_str()), ("deg", "deg/cycle"));
        assert!((needs.encoder.increment_mm() - 1e-4).abs() < 1e-16);
        assert!((speed.internal.expect("a speed") - 60.0 / 2000.0 * 1e4).abs() < 1e-9);
    }

    /// M28 in units of the axis: 1, 2, 4 counts.
    #[test]
    fn differences_err_by_counts_over_time() {
        let x = &machine::Machine::default().axis[&Axis::X];
        let needs = AxisNeeds::of(Axis::X, x, 25.0, 5e-4, &Steps::PUBLISHED);
        let count = 5.0 / 131_072.0;
        for (difference, want) in
            needs.differences().iter().zip([count * 2e3, 2.0 * count * 4e6, 4.0 * count * 8e9])
        {
            assert!((difference.largest / want - 1.0).abs() < 1e-12, "{difference:?}");
        }
        assert!((needs.differences()[1].of_limit_pct - 2.0 * count * 4e6 / 20.0).abs() < 1e-9);
    }
}
