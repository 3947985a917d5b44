//! The same on the whole machine, in its own control cycle: a pass of a thread is cut, and the observer of
//! the truth says how far Z lay beside the true helix. In: machine, encoder, bandwidth, case. Out: error of
//! the helix in µm.
//!
//! Here the spindle has inertia, ripple and a drive, and Z has mass and friction: their errors are in the
//! figure. The dip is made by a torque M = J Δω/D, which comes on and goes within a millisecond.

use core::f64::consts::TAU;

use machine::Machine;
use rig::{
    observe::{Outcome, PassReport},
    trial::{self, Trial},
};
use sim_plant::Scenario;

use super::{Case, LEAD_MM};
use crate::ExperimentError;

/// Programmed speed, 1/min.
const S_RPM: f64 = 500.0;
/// Angle of the pass at which something happens, degrees.
const CHANGE_DEG: f64 = 1440.0;
/// Length of the thread in turns; and of the slow one, which takes 300 s for each.
const TURNS: f64 = 10.0;
const SLOW_TURNS: f64 = 0.1;
/// The dip: share of the speed, and time.
const DIP: (f64, f64) = (0.03, 0.015);
/// The step of the axial force, N.
const FORCE_N: f64 = 200.0;
/// Time in which the load of a dip comes on, and the force, s: the latter as in the reference simulation.
const RISE_S: f64 = 0.001;
const FORCE_RISE_S: f64 = 0.01;

fn failed(reason: impl std::fmt::Display) -> ExperimentError {
    ExperimentError::Machine(format!("the trial could not be made: {reason}"))
}

/// A machine with another encoder and another observer, on which what happens in a case comes on in its time.
fn with(machine: &Machine, lines: u32, bandwidth_hz: f64, case: Case) -> Machine {
    let mut machine = machine.clone();
    machine.spindle.encoder_lines = lines;
    machine.spindle.observer_hz = bandwidth_hz;
    let cutting = machine.plant.entry("cutting").or_insert_with(|| toml::Value::Table(toml::Table::new()));
    if let Some(cutting) = cutting.as_table_mut() {
        let rise_s = if matches!(case, Case::Force) { FORCE_RISE_S } else { RISE_S };
        cutting.insert("rise_s".into(), rise_s.into());
    }
    machine
}

fn scenario(machine: &Machine, case: Case) -> Result<Scenario, ExperimentError> {
    let action = match case {
        Case::Constant | Case::Slow => return Ok(Scenario::none()),
        Case::Force => format!("axial_force_n = {FORCE_N}"),
        Case::OverrideRamp => "spindle_override_pct = 60\nramp_s = 0.3".to_owned(),
        Case::Dip => {
            let (share, dip_s) = DIP;
            let inertia = sim_plant::spindle_inertia_kg_m2(machine).map_err(failed)?;
            let torque_nm = inertia * share * S_RPM / 60.0 * TAU / dip_s;
            format!("spindle_load = {{ torque_nm = {torque_nm}, for_s = {dip_s} }}")
        }
    };
    let event = format!("[[event]]\nat = {{ pass = 1, angle_deg = {CHANGE_DEG} }}\n{action}\n");
    Scenario::from_toml(&event).map_err(failed)
}

/// Cuts a pass and gives its report; the fault if the machine does not come to its end.
///
/// # Errors
/// The machine cannot follow the pass.
pub(super) fn pass(
    machine: &Machine,
    lines: u32,
    bandwidth_hz: f64,
    case: Case,
    seed: u64,
) -> Result<Result<PassReport, String>, ExperimentError> {
    let machine = with(machine, lines, bandwidth_hz, case);
    let (s_rpm, turns) = if case == Case::Slow { (0.2, SLOW_TURNS) } else { (S_RPM, TURNS) };
    let trial = Trial { s_rpm, turns, delta_x_mm: 0.0, lead_mm: -LEAD_MM, ..Trial::default() };
    let items = trial::program(&machine, &[trial]).map_err(failed)?;
    let scenario = scenario(&machine, case)?;
    let seen = trial::run(&machine, &items, &scenario, seed, &mut |_| ()).map_err(failed)?;
    Ok(match (seen.outcome, seen.passes.into_iter().next()) {
        (Outcome::Completed, Some(pass)) => Ok(pass),
        _ => Err(seen.faults.into_iter().next().map_or("the pass was not cut".into(), |fault| fault.text)),
    })
}
