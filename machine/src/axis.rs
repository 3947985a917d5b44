//! `[axis.*]` of the machine file: one axis as the controller believes it to be. In: mm, s, kg, N; degrees
//! instead of mm for a rotary axis. Out: checked values, or the path of the key and the reason.

use std::collections::BTreeMap;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error, ser};

use protocol::{Axis, AxisMeasurement, Position};

use super::{Bus, General, MachineError, ReferenceConfig, range, refuse};

/// Rows of a table of errors of a screw are at least so far apart, mm.
pub const CLOSEST_MM: f64 = 0.1;
/// A table of errors changes by no more than this, µm for each mm.
const STEEPEST_UM_MM: f64 = 5.0;
/// Most rows of a table of errors of a screw.
pub const MOST_ROWS: usize = 256;
/// Most rows of cogging as believed.
pub const MOST_COGGING: usize = 8;
/// A motor is believed to cog at most so often a turn.
pub const MOST_A_TURN: u32 = 64;

/// `[axis.*]`: limits, encoder scale, loops, and what the controller believes about the mechanics.
///
/// A rotary axis has degrees where the names say mm, and its keys are spelled so (`travel_deg`). Its masses
/// and forces are referred to the radius of 57.3 mm, on which one degree is one millimetre.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisConfig {
    /// Lowest and highest position, mm (X: radius).
    #[serde(alias = "travel_deg", deserialize_with = "pair")]
    pub travel_mm: [f64; 2],
    /// Position at the start of the machine, mm.
    #[serde(alias = "home_deg")]
    pub home_mm: f64,
    /// Highest speed, mm/s.
    #[serde(alias = "velocity_deg_s")]
    pub velocity_mm_s: f64,
    /// Highest acceleration, mm/s².
    #[serde(alias = "acceleration_deg_s2")]
    pub acceleration_mm_s2: f64,
    /// Highest jerk, mm/s³.
    #[serde(alias = "jerk_deg_s3")]
    pub jerk_mm_s3: f64,
    /// Highest rate of jerk, mm/s⁴.
    #[serde(alias = "jerk_rate_deg_s4")]
    pub jerk_rate_mm_s4: f64,
    /// Lead of the screw, mm per turn of the motor.
    #[serde(alias = "screw_lead_deg")]
    pub screw_lead_mm: f64,
    /// Encoder counts per turn of the motor.
    pub encoder_counts: u32,
    /// Gain of the position loop in the regulator, 1/s.
    pub position_gain_1_s: f64,
    /// Bandwidth of the velocity loop in the drive, Hz: Kp = believed inertia × 2π × bandwidth.
    pub velocity_bandwidth_hz: f64,
    /// Integral time of the velocity loop in the drive, s.
    pub velocity_integral_s: f64,
    /// Torque limit of the drive, N·m.
    pub torque_limit_nm: f64,
    /// Moving mass as believed: everything that accelerates, referred to the slide, kg.
    pub mass_kg: f64,
    /// Coulomb friction as believed, N at the slide.
    pub coulomb_n: f64,
    /// Stiffness of friction before it slides, as believed, N/mm.
    #[serde(alias = "presliding_n_deg")]
    pub presliding_n_mm: f64,
    /// Viscous friction as believed, N·s/mm.
    #[serde(alias = "viscous_n_s_deg")]
    pub viscous_n_s_mm: f64,
    /// Lead of the velocity feedforward (M54), s.
    pub velocity_lead_s: f64,
    /// Lead of the acceleration feedforward (M54), s.
    pub acceleration_lead_s: f64,
    /// Largest servo error in timed motion, mm; beyond it the axis faults.
    #[serde(alias = "following_error_deg")]
    pub following_error_mm: f64,
    /// Largest servo error on the helix, mm; beyond it the axis faults.
    #[serde(alias = "thread_error_deg")]
    pub thread_error_mm: f64,
    /// Servo error below which an axis at rest counts as in position, mm.
    #[serde(alias = "in_position_deg")]
    pub in_position_mm: f64,
    /// What is fed forward (M54).
    #[serde(default)]
    pub feedforward: Feedforward,
    /// How the structures that difference positions do it.
    #[serde(default)]
    pub difference: Difference,
    /// Step of the linear scale at the slide, mm. With it the position loop closes over the scale; without,
    /// over the encoder of the motor.
    #[serde(default, alias = "scale_step_deg")]
    pub scale_step_mm: Option<f64>,
    /// Backlash between motor and slide as believed, mm: what the motor turns for nothing when it reverses
    /// (M69).
    #[serde(default, alias = "backlash_deg")]
    pub backlash_mm: f64,
    /// Mode of the slide against the standing motor as believed, Hz. With it the motor is led so that the
    /// slide does what is commanded (M131); without, the slide is taken to be rigid.
    #[serde(default)]
    pub mode_hz: Option<f64>,
    /// Weight that the axis carries, as believed: a force along it, N; negative pulls it down.
    #[serde(default)]
    pub gravity_n: f64,
    /// How far an approach to depth goes beyond it and comes back, so that the guide is not left loaded
    /// (M132), mm; about 0.7 of what its friction bends it before it slides. 0: it stops at depth.
    #[serde(default, alias = "unload_deg")]
    pub unload_mm: f64,
    /// Learns what torque each place of a turn of the motor needs beyond what is believed (M133).
    #[serde(default)]
    pub learning: bool,
    /// Cogging as believed: rows of n times a turn of the motor, torque T in N·m and phase in degrees. Fed
    /// forward is the sum of T sin(n 360° x/lead + phase), with the motor at x as it is measured (M133).
    #[serde(default, deserialize_with = "rows")]
    pub cogging: Vec<[f64; 3]>,
    /// Error of the screw as believed (M68): pairs of position in mm, rising, and how much too far the slide
    /// stands, in thousandths of that unit (µm). Only its change since home counts. Empty for none.
    #[serde(default, deserialize_with = "rows")]
    pub screw_error: Vec<[f64; 2]>,
    /// Its reference run. Without, its encoder is believed from the first cycle on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference: Option<ReferenceConfig>,
}

/// What a regulator feeds forward. All but [`Feedforward::Full`] exist to be compared with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Feedforward {
    /// Nothing: the position loop alone.
    None,
    /// Speed, by differences of rounded positions.
    DifferenceV,
    /// Speed and acceleration, by differences of rounded positions.
    DifferenceVa,
    /// Speed of the law.
    AnalyticV,
    /// Speed and acceleration of the law, both at the sample instant.
    AnalyticVaNoLead,
    /// Speed and acceleration of the law, each at its own lead, and friction (M54).
    #[default]
    Full,
}

/// How [`Feedforward::DifferenceV`] and [`Feedforward::DifferenceVa`] see the motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Difference {
    /// Positions are rounded to this, mm.
    #[serde(alias = "quantum_deg")]
    pub quantum_mm: f64,
    /// Control cycles between two positions; the reference is held as long.
    pub cycles: u32,
    /// Differences about the lead of each feedforward instead of backward ones, and friction.
    pub centred: bool,
}

impl Default for Difference {
    fn default() -> Self {
        Difference { quantum_mm: 1e-3, cycles: 2, centred: false }
    }
}

impl AxisConfig {
    /// The limits of the axis as laws of motion take them.
    pub fn limits(&self) -> motion::Limits {
        motion::Limits {
            v: self.velocity_mm_s,
            a: self.acceleration_mm_s2,
            j: self.jerk_mm_s3,
            dj: self.jerk_rate_mm_s4,
        }
    }

    /// The position that the loop of the axis closes over: that of the scale, or that of the motor.
    pub fn position(&self, measured: &AxisMeasurement) -> Position {
        if self.scale_step_mm.is_some() { measured.scale } else { measured.position }
    }

    pub(super) fn check(&self, axis: Axis, general: &General, bus: &Bus) -> Result<(), MachineError> {
        let key = |name: &str| key(axis, name);
        let [low, high] = self.travel_mm;
        range(&key("travel_mm[0]"), low, -1e5, 1e5)?;
        if high <= low {
            let reason = format!("must be above travel_mm[0] = {low}: the lower end comes first");
            return Err(refuse(&key("travel_mm[1]"), high, &reason));
        }
        range(&key("travel_mm[1]"), high, low + 1e-3, 1e5)?;
        range(&key("home_mm"), self.home_mm, low, high)?;
        for (name, value, high) in [
            ("velocity_mm_s", self.velocity_mm_s, 1e4),
            ("acceleration_mm_s2", self.acceleration_mm_s2, 1e6),
            ("jerk_mm_s3", self.jerk_mm_s3, 1e9),
            ("jerk_rate_mm_s4", self.jerk_rate_mm_s4, 1e13),
            ("screw_lead_mm", self.screw_lead_mm, 1e3),
            ("position_gain_1_s", self.position_gain_1_s, 1e3),
            ("velocity_bandwidth_hz", self.velocity_bandwidth_hz, 1e3),
            ("velocity_integral_s", self.velocity_integral_s, 10.0),
            ("torque_limit_nm", self.torque_limit_nm, 1e4),
            ("mass_kg", self.mass_kg, 1e6),
            ("presliding_n_mm", self.presliding_n_mm, 1e9),
            ("following_error_mm", self.following_error_mm, 100.0),
            ("thread_error_mm", self.thread_error_mm, 10.0),
            ("in_position_mm", self.in_position_mm, 10.0),
        ] {
            range(&key(name), value, 1e-6, high)?;
        }
        range(&key("encoder_counts"), f64::from(self.encoder_counts), 16.0, 4e9)?;
        range(&key("coulomb_n"), self.coulomb_n, 0.0, 1e6)?;
        range(&key("viscous_n_s_mm"), self.viscous_n_s_mm, 0.0, 1e6)?;
        range(&key("velocity_lead_s"), self.velocity_lead_s, -0.01, 0.01)?;
        range(&key("acceleration_lead_s"), self.acceleration_lead_s, -0.01, 0.01)?;
        if let Some(step_mm) = self.scale_step_mm {
            // A coarser scale would never show the axis in position.
            range(&key("scale_step_mm"), step_mm, 1e-7, self.in_position_mm)?;
        }
        if let Some(mode_hz) = self.mode_hz {
            range(&key("mode_hz"), mode_hz, 5.0, 1000.0)?;
        }
        range(&key("backlash_mm"), self.backlash_mm, 0.0, 10.0)?;
        range(&key("gravity_n"), self.gravity_n, -1e5, 1e5)?;
        range(&key("unload_mm"), self.unload_mm, 0.0, 0.1)?;
        self.check_reach(axis, general, bus)?;
        self.check_cogging(&key("cogging"))?;
        self.check_torque(axis)?;
        self.reference.map_or(Ok(()), |reference| reference.check(axis, self, general))?;
        self.check_screw_error(&key("screw_error"))
    }

    /// Feedforward looks no farther than the setpoints of a stream reach: at the first cycle of a tick one
    /// tick back, at its last one tick and one cycle ahead. What is on its way to the drive is part of that.
    fn check_reach(&self, axis: Axis, general: &General, bus: &Bus) -> Result<(), MachineError> {
        let Difference { quantum_mm, cycles, centred } = self.difference;
        let difference = |name: &str| key(axis, &format!("difference.{name}"));
        range(&difference("quantum_mm"), quantum_mm, 1e-12, 1.0)?;
        range(&difference("cycles"), f64::from(cycles), 1.0, 16.0)?;
        let output_s = bus.output_s(general.cycle_s);
        let back_s = general.interpolator_cycle_s + output_s;
        let reach_s = general.interpolator_cycle_s + general.cycle_s - output_s;
        let beyond = |look_s: f64, reach_s: f64| look_s > reach_s * (1.0 + 1e-9);
        let leads = [self.velocity_lead_s, self.acceleration_lead_s];
        for (name, lead_s) in ["velocity_lead_s", "acceleration_lead_s"].into_iter().zip(leads) {
            if beyond(lead_s, reach_s) || beyond(-lead_s, back_s) {
                let reason = format!(
                    "must lie between -{back_s} and {reach_s}: setpoints reach only so far back and ahead"
                );
                return Err(refuse(&key(axis, name), lead_s, &reason));
            }
        }
        let step_s = f64::from(cycles) * general.cycle_s;
        for lead_s in leads.into_iter().filter(|_| centred) {
            let (ahead_s, behind_s) = (step_s + lead_s, step_s - lead_s);
            let (look_s, way, reach_s) = if beyond(behind_s, back_s) {
                (behind_s, "back", back_s)
            } else {
                (ahead_s, "ahead", reach_s)
            };
            if beyond(look_s, reach_s) {
                let reason = format!(
                    "centred differences look {look_s} s {way}, and setpoints reach {reach_s} s: take fewer cycles"
                );
                return Err(refuse(&difference("cycles"), cycles, &reason));
            }
        }
        Ok(())
    }

    fn check_cogging(&self, key: &str) -> Result<(), MachineError> {
        if self.cogging.len() > MOST_COGGING {
            let reason = format!("must have at most {MOST_COGGING} rows");
            return Err(refuse(key, format!("{} rows", self.cogging.len()), &reason));
        }
        for (row, [times, torque_nm, phase_deg]) in self.cogging.iter().enumerate() {
            let key = |column| format!("{key}[{row}][{column}]");
            range(&key(0), *times, 1.0, f64::from(MOST_A_TURN))?;
            if times.fract() != 0.0 {
                return Err(refuse(&key(0), times, "must be whole: so often a turn of the motor"));
            }
            range(&key(1), *torque_nm, 0.0, self.torque_limit_nm)?;
            range(&key(2), *phase_deg, -360.0, 360.0)?;
        }
        Ok(())
    }

    /// What the motor gives against weight, friction and cogging before anything accelerates is less than it
    /// has.
    fn check_torque(&self, axis: Axis) -> Result<(), MachineError> {
        let torque_nm = |newton: f64| newton.abs() * 1e-3 * self.screw_lead_mm / core::f64::consts::TAU;
        let shares = [
            ("gravity_n", self.gravity_n, torque_nm(self.gravity_n)),
            ("coulomb_n", self.coulomb_n, torque_nm(self.coulomb_n)),
            (
                "cogging",
                self.cogging.len() as f64,
                self.cogging.iter().map(|[_, torque_nm, _]| torque_nm).sum(),
            ),
        ];
        let (sum_nm, limit_nm) = (shares.iter().map(|(.., nm)| nm).sum::<f64>(), self.torque_limit_nm);
        if sum_nm < limit_nm {
            return Ok(());
        }
        let most = shares.iter().max_by(|(.., one), (.., other)| one.total_cmp(other));
        let (name, value, nm) = most.copied().unwrap_or(shares[0]);
        let value = if name == "cogging" { format!("{value} rows") } else { value.to_string() };
        let reason = format!(
            "takes {nm:.3} N·m at the motor, with gravity_n, coulomb_n and cogging together {sum_nm:.3}, and \
             torque_limit_nm is {limit_nm}: lower it, or raise torque_limit_nm if the drive has more"
        );
        Err(refuse(&key(axis, name), value, &reason))
    }

    fn check_screw_error(&self, key: &str) -> Result<(), MachineError> {
        let rows = &self.screw_error;
        if rows.len() == 1 || rows.len() > MOST_ROWS {
            let reason = format!("must have between 2 and {MOST_ROWS} rows, or none");
            return Err(refuse(key, format!("{} rows", rows.len()), &reason));
        }
        for (row, [mm, um]) in rows.iter().enumerate() {
            range(&format!("{key}[{row}][0]"), *mm, -1e5, 1e5)?;
            range(&format!("{key}[{row}][1]"), *um, -1000.0, 1000.0)?;
        }
        for (row, (before, here)) in rows.iter().zip(rows.iter().skip(1)).enumerate() {
            let ([from_mm, from_um], [mm, um]) = (before, here);
            let (way, rise) = (mm - from_mm, um - from_um);
            if way < CLOSEST_MM {
                let reason = format!("must be at least {CLOSEST_MM} above {from_mm}, the row before");
                return Err(refuse(&format!("{key}[{}][0]", row + 1), mm, &reason));
            }
            if rise.abs() > STEEPEST_UM_MM * way {
                let reason = format!(
                    "may differ from {from_um}, the row before, by at most {STEEPEST_UM_MM} for each mm"
                );
                return Err(refuse(&format!("{key}[{}][1]", row + 1), um, &reason));
            }
        }
        Ok(())
    }
}

/// Two numbers; a third one is an error too, which serde's arrays let pass.
pub(super) fn pair<'de, D: Deserializer<'de>>(values: D) -> Result<[f64; 2], D::Error> {
    row(Vec::deserialize(values)?)
}

/// Rows of so many numbers.
fn rows<'de, D: Deserializer<'de>, const N: usize>(rows: D) -> Result<Vec<[f64; N]>, D::Error> {
    Vec::<Vec<f64>>::deserialize(rows)?.into_iter().map(row).collect()
}

fn row<E: Error, const N: usize>(values: Vec<f64>) -> Result<[f64; N], E> {
    let (found, due) = (values.len(), ["none", "one", "two", "three"][N]);
    values.try_into().map_err(|_| E::custom(format!("{found} numbers were found, and there must be {due}")))
}

/// The path of a key, in the unit of the axis: `axis.x.travel_mm`, `axis.c.travel_deg`.
pub(super) fn key(axis: Axis, name: &str) -> String {
    let name = if axis.is_rotary() { name.replace("mm", "deg") } else { name.into() };
    format!("axis.{}.{name}", axis.name())
}

/// Writes axes by keys in the unit of each.
pub(super) fn spelled<S: Serializer>(axes: &BTreeMap<Axis, AxisConfig>, to: S) -> Result<S::Ok, S::Error> {
    let in_degrees = |keys: toml::Table| {
        keys.into_iter().map(|(name, value)| (name.replace("mm", "deg"), value)).collect::<toml::Table>()
    };
    let mut tables = BTreeMap::new();
    for (axis, config) in axes {
        let mut keys = toml::Table::try_from(config).map_err(ser::Error::custom)?;
        if axis.is_rotary() {
            keys = in_degrees(keys);
            for name in ["difference", "reference"] {
                if let Some(toml::Value::Table(inner)) = keys.get_mut(name) {
                    *inner = in_degrees(std::mem::take(inner));
                }
            }
        }
        tables.insert(axis, keys);
    }
    tables.serialize(to)
}
