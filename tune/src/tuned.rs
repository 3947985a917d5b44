//! The commissioning of one axis, from the first test move to the proposal.

use machine::{AxisConfig, Machine};
use protocol::Axis;

use crate::{
    cogging::{self, Wave},
    estimate::Estimate,
    margins::{self, Margins, OpenLoops, Timing},
    mode::{self, Mode},
    presliding,
    proposal::{self, Goals},
    refusal::Refusal,
    response::{self, Line},
    rigid,
    stand::{Bench, Stand},
    torque_path,
};

/// Most and least travel that the test moves take, and what they leave to the end of it, mm.
const MOST_MM: f64 = 50.0;
const LEAST_MM: f64 = 5.0;
const RESERVE_MM: f64 = 1.0;
/// A weight is so many of its deviations, and so large, N.
const SEEN: f64 = 5.0;
const LEAST_N: f64 = 5.0;
/// Most relative deviation of a line that margins are read from.
const MOST_SCATTER: f64 = 0.2;

/// An axis that has been measured.
#[derive(Clone, Debug)]
pub struct Tuned {
    /// Which axis.
    pub axis: Axis,
    /// Travel that the test moves took, mm; negative towards lower positions.
    pub reach_mm: f64,
    /// Everything that accelerates, kg.
    pub mass_kg: Estimate,
    /// Coulomb friction, N.
    pub coulomb_n: Estimate,
    /// Viscous friction, N s/mm.
    pub viscous_n_s_mm: Estimate,
    /// Force that the motor gives at rest too, N: against weight, balance.
    pub constant_n: Estimate,
    /// Stiffness of friction before it slides, N/mm; none where there is too little friction to tell.
    pub presliding_n_mm: Option<Estimate>,
    /// Friction from which the axis breaks away, N.
    pub breakaway_n: f64,
    /// What comes back with every turn of the motor; none where there is no room for a turn.
    pub cogging: Option<Vec<Wave>>,
    /// From the measurement to the torque that answers it, s.
    pub delay_s: Estimate,
    /// Lag of the current loop, s.
    pub lag_s: Estimate,
    /// The mode of the slide, if one is seen.
    pub mode: Option<Mode>,
    /// Shortest approach whose stroke leaves no more than the wanted residual in that mode, s (M8a); none for
    /// a rotary axis, nor behind a backlash, where the mode is not to be trusted.
    pub approach_s: Option<f64>,
    /// Frequency response in motion; below 6 Hz that of a mass with viscous friction.
    pub lines: Vec<Line>,
    /// Friction against speed: mm/s and N.
    pub friction_curve: Vec<[f64; 2]>,
    /// Friction against position in small reversals: mm and N.
    pub reversals: Vec<[f64; 2]>,
    /// Margins with the axis as it was configured.
    pub before: Margins,
    /// Margins with the proposal.
    pub after: Margins,
    /// `[axis.*]` with the identified values and the gains that follow.
    pub proposal: AxisConfig,
    /// When its loops are closed.
    pub timing: Timing,
}

impl Tuned {
    /// The loops of a configuration on the measured response, opened.
    pub fn open_loops(&self, config: &AxisConfig) -> Vec<OpenLoops> {
        margins::open(&self.lines, config, self.timing)
    }
}

/// Measures an axis that stands still somewhere in its travel, and proposes its `[axis.*]`. The drive is off
/// afterwards.
///
/// # Errors
/// A [`Refusal`] that says what was wrong and what to do. The axis has been stopped then.
pub fn tune(bench: &mut impl Bench, axis: Axis, machine: &Machine) -> Result<Tuned, Refusal> {
    tune_towards(bench, axis, machine, &Goals::default())
}

/// [`tune`] with margins of one's own.
///
/// # Errors
/// As [`tune`]; [`Refusal::NoGain`] if no gains reach the margins.
pub fn tune_towards(
    bench: &mut impl Bench,
    axis: Axis,
    machine: &Machine,
    goals: &Goals,
) -> Result<Tuned, Refusal> {
    let config = machine.axis.get(&axis).ok_or(Refusal::NoAxis(axis))?;
    let here = bench.measurement().axes[axis.index()].position.mm();
    let reach = reach(axis, config, here)?;
    let mut stand = Stand::enable(bench, axis, config, machine.general.cycle_s, machine.bus)?;
    let found = measure(&mut stand, axis, config, reach, goals);
    stand.release();
    found
}

/// Where the test moves go: to the side with more room, mm.
fn reach(axis: Axis, config: &AxisConfig, here: f64) -> Result<f64, Refusal> {
    let [low, high] = config.travel_mm;
    let (up, down) = (high - here - RESERVE_MM, here - low - RESERVE_MM);
    let room = up.max(down);
    if !(LEAST_MM..).contains(&room) {
        return Err(Refusal::Travel(axis, room + RESERVE_MM, LEAST_MM + RESERVE_MM));
    }
    Ok(room.min(MOST_MM).copysign(up - down))
}

fn measure<B: Bench>(
    stand: &mut Stand<B>,
    axis: Axis,
    config: &AxisConfig,
    reach_mm: f64,
    goals: &Goals,
) -> Result<Tuned, Refusal> {
    let timing = stand.timing();
    let cycle_s = timing.cycle_s;
    stand.rest(0.0, 0.1)?;
    let none = |what, remedy| Refusal::Untold(axis, what, remedy);
    let rigid = rigid::measure(stand, config, reach_mm)?
        .ok_or(none("mass and friction", "the runs are too short; give the axis more travel"))?;
    let cogging = cogging::measure(stand, config, &rigid, reach_mm)?;
    stand.knows(cogging.iter().flatten().map(Wave::row).collect());
    let sliding = presliding::measure(stand, config, &rigid, &rigid::limits(config))?
        .ok_or(none("presliding stiffness", "the reversals did not move the axis"))?;
    let (lines, speed) = response::measure(stand, config, reach_mm)?;
    let path = torque_path::identify(&lines, cycle_s).ok_or(none(
        "delay of the torque",
        "the measured torque does not follow the commanded one; check its unit and sign",
    ))?;
    let mode = mode::identify(&lines, config, &path, cycle_s);
    let body = [rigid.mass_kg.value, rigid.viscous_n_s_mm.value];
    let lines = [response::below(&lines, config, &path, body, cycle_s), lines].concat();
    let before = margins::of(&lines, config, timing);
    let stiffness = sliding.stiffness_n_mm.map(|found| found.value);
    let trusted = mode.filter(|_| trusted(axis, config));
    let mut proposal = AxisConfig {
        presliding_n_mm: stiffness.unwrap_or(config.presliding_n_mm),
        ..known(&shaking(config, trusted, cogging.as_deref()), &rigid, &path, cycle_s)
    };
    plausible(axis, &rigid, &path, &sliding)?;
    stable(axis, &before, speed)?;
    proposal::gains(axis, &mut proposal, &lines, timing, goals)?;
    let mut proposal = proposal::rounded(proposal);
    if stiffness.is_none() {
        // As it is written, digit by digit.
        proposal.presliding_n_mm = config.presliding_n_mm;
    }
    let after = margins::of(&lines, &proposal, timing);
    scatter(axis, [before, after], &lines, speed)?;
    Ok(Tuned {
        axis,
        reach_mm,
        mass_kg: rigid.mass_kg,
        coulomb_n: rigid.coulomb_n,
        viscous_n_s_mm: rigid.viscous_n_s_mm,
        constant_n: rigid.constant_n,
        cogging,
        presliding_n_mm: sliding.stiffness_n_mm,
        breakaway_n: sliding.breakaway_n,
        delay_s: path.delay_s,
        lag_s: path.lag_s,
        approach_s: trusted.map(|mode| proposal::shortest_approach(&mode, goals)),
        mode,
        before,
        after,
        lines,
        friction_curve: rigid.curve,
        reversals: sliding.loops,
        proposal,
        timing,
    })
}

/// Whether the mode is what it seems: approaches are strokes of linear axes, and a backlash makes the slide
/// seem to swing slower than it does.
fn trusted(axis: Axis, config: &AxisConfig) -> bool {
    !axis.is_rotary() && config.backlash_mm <= 0.0
}

/// The axis with its mode and its cogging, as far as they were found.
fn shaking(config: &AxisConfig, mode: Option<Mode>, cogging: Option<&[Wave]>) -> AxisConfig {
    let rows = cogging.map(|waves| waves.iter().map(Wave::row).collect());
    AxisConfig {
        mode_hz: mode.map(|mode| proposal::digits(mode.hz.value, 4)).or(config.mode_hz),
        cogging: rows.unwrap_or_else(|| config.cogging.clone()),
        ..config.clone()
    }
}

/// The axis with its mass, its frictions and the delays of its torque as they were found.
fn known(
    config: &AxisConfig,
    rigid: &rigid::Rigid,
    path: &torque_path::TorquePath,
    cycle_s: f64,
) -> AxisConfig {
    AxisConfig {
        mass_kg: rigid.mass_kg.value,
        coulomb_n: rigid.coulomb_n.value.max(0.0),
        viscous_n_s_mm: rigid.viscous_n_s_mm.value.max(0.0),
        gravity_n: weight_n(rigid.constant_n),
        velocity_lead_s: -0.5 * cycle_s,
        acceleration_lead_s: path.delay_s.value + 0.5 * cycle_s + path.lag_s.value,
        ..config.clone()
    }
}

/// The weight against which the motor gives a force, N; 0 where nothing stands out.
fn weight_n(constant_n: Estimate) -> f64 {
    let Estimate { value, deviation } = constant_n;
    if value.abs() > SEEN * deviation && value.abs() > LEAST_N { -value } else { 0.0 }
}

/// Refuses a response with which the loops that have just moved the axis would be unstable.
fn stable(axis: Axis, before: &Margins, speed: f64) -> Result<(), Refusal> {
    let reason = "with it, the loops that moved the axis would be unstable";
    if before.stable() { Ok(()) } else { Err(Refusal::Response(axis, reason, speed)) }
}

/// Refuses a response that is not known about the crossover.
fn scatter(axis: Axis, margins: [Margins; 2], lines: &[Line], speed: f64) -> Result<(), Refusal> {
    if margins.iter().any(|margins| margins.velocity.known_to(lines) > MOST_SCATTER) {
        return Err(Refusal::Response(axis, "its periods scatter too much about the crossover", speed));
    }
    Ok(())
}

/// Refuses values that no axis has, or that are known too badly to write them down.
fn plausible(
    axis: Axis,
    rigid: &rigid::Rigid,
    path: &torque_path::TorquePath,
    sliding: &presliding::Presliding,
) -> Result<(), Refusal> {
    let weighing = "check that the axis is free and that its torque is measured in N·m at the motor";
    let timing = "check input_cycles and output_cycles of [bus] first, then that torque is measured in every control \
                  cycle, and that mass_kg and the loops are those of the drive";
    let slow = "check whether something else moves or holds the axis";
    let mass = rigid.mass_kg;
    let most_sliding = |found: Estimate| ("presliding_n_mm", found, 1e-6, 1e9, 0.5 * found.value, slow);
    let sliding = sliding.stiffness_n_mm.map(most_sliding);
    for (what, estimate, low, high, most, remedy) in [
        ("mass_kg", mass, 1e-3, 1e6, 0.05 * mass.value, weighing),
        ("coulomb_n", rigid.coulomb_n, -0.1, 1e6, (0.2 * rigid.coulomb_n.value).max(1.0), weighing),
        ("viscous_n_s_mm", rigid.viscous_n_s_mm, -0.1, 1e6, f64::INFINITY, weighing),
        ("gain of the torque", path.gain, 0.8, 1.25, 0.05, timing),
        ("delay of the torque", path.delay_s, -1e-6, 0.01, 1e-3, timing),
        ("lag of the current", path.lag_s, 0.0, 0.01, 1e-3, timing),
    ]
    .into_iter()
    .chain(sliding)
    {
        let Estimate { value, deviation } = estimate;
        if !((low..=high).contains(&value) && deviation <= most) {
            return Err(Refusal::Implausible(axis, what, value, deviation, remedy));
        }
    }
    Ok(())
}
