//! Experiment `sweep`: how well X keeps to its law over the range of passes, overrides and beliefs. In: a
//! machine. Out: a row for each pass under each condition, with the servo error of X in µm.
//!
//! | what varies | how |
//! |---|---|
//! | pass | [`PASSES`]: S, ΔX, ΔC, spread over what the built-in machine can follow at 120 % |
//! | override | [`OVERRIDES`], per cent |
//! | mass as believed | off by [`MASS_ERRORS`], per cent of the truth |
//! | friction as believed, all parts of it | off by [`FRICTION_ERRORS`], per cent of the truth |
//! | seed | two: where encoders and spindle stand at the start |
//!
//! The ten passes of one condition are one program.

mod figures;
mod tables;
#[cfg(test)]
mod tests;
mod text;

use machine::Machine;
use protocol::Axis;
use rig::{observe::PassReport, trial::Trial};
use serde::Serialize;
use sim_plant::Belief;

use super::{Findings, stand::Stand};
use crate::ExperimentError;

/// S in 1/min, ΔX in mm, ΔC in degrees.
const PASSES: [[f64; 3]; 10] = [
    [200.0, 2.0, 180.0],
    [200.0, 10.0, 330.0],
    [250.0, 5.0, 300.0],
    [300.0, 5.0, 360.0],
    [300.0, 10.0, 900.0],
    [350.0, 3.0, 720.0],
    [400.0, 8.0, 600.0],
    [450.0, 2.0, 420.0],
    [500.0, 6.0, 630.0],
    [600.0, 8.0, 900.0],
];
const OVERRIDES: [f64; 4] = [120.0, 100.0, 80.0, 60.0];
const MASS_ERRORS: [f64; 3] = [-15.0, 0.0, 15.0];
const FRICTION_ERRORS: [f64; 3] = [-40.0, 0.0, 40.0];
const SEEDS: u64 = 2;

/// Turns of thread after each approach: one until it has died away, and more than one to measure.
const TURNS: f64 = 2.5;

/// What is asked of every case, µm: median and worst of the largest error in the approach.
const MEDIAN_UM: f64 = 1.0;
const WORST_UM: f64 = 2.5;

/// One pass under one condition.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    s_rpm: f64,
    delta_x_mm: f64,
    delta_c_deg: f64,
    override_pct: f64,
    mass_error_pct: f64,
    friction_error_pct: f64,
    seed: u64,
    approach_max_abs_um: f64,
    end_um: f64,
    thread_max_abs_um: f64,
    /// Largest magnitude from the end of the approach on.
    at_depth_max_abs_um: f64,
}

impl Row {
    /// Peak acceleration of the stroke at the speed it was made with (M5, M8), mm/s².
    fn peak_acceleration(&self) -> f64 {
        let ratio = self.override_pct / 100.0;
        288.0 * self.delta_x_mm * (self.s_rpm * ratio / self.delta_c_deg).powi(2)
    }
}

/// What is the same for the passes of one program.
#[derive(Clone, Copy, Debug)]
struct Condition {
    override_pct: f64,
    mass_error_pct: f64,
    friction_error_pct: f64,
    seed: u64,
}

impl Condition {
    /// Every condition of these values.
    fn all(overrides: &[f64], masses: &[f64], frictions: &[f64], seeds: &[u64]) -> Vec<Condition> {
        let mut all = Vec::new();
        for &seed in seeds {
            for &override_pct in overrides {
                for &mass_error_pct in masses {
                    for &friction_error_pct in frictions {
                        all.push(Condition { override_pct, mass_error_pct, friction_error_pct, seed });
                    }
                }
            }
        }
        all
    }

    /// Cuts the passes; a row for each.
    fn rows(&self, stand: &Stand, passes: &[[f64; 3]]) -> Result<Vec<Row>, ExperimentError> {
        let mut machine = stand.machine.clone();
        let truth =
            Belief::of_truth(&machine, Axis::X).map_err(|error| ExperimentError::Input(error.to_string()))?;
        if let Some(x) = machine.axis.get_mut(&Axis::X) {
            truth.off_by(self.mass_error_pct / 100.0, self.friction_error_pct / 100.0).put_into(x);
        }
        let trial = |&[s_rpm, delta_x_mm, delta_c_deg]: &[f64; 3]| Trial {
            s_rpm,
            delta_x_mm,
            delta_c_deg,
            turns: TURNS,
            ..Trial::default()
        };
        let trials: Vec<Trial> = passes.iter().map(trial).collect();
        let seen = Stand::run(&machine, &trials, self.override_pct, self.seed, &mut |_| ())?;
        Ok(trials.iter().zip(&seen.passes).map(|(trial, pass)| self.row(trial, pass)).collect())
    }

    fn row(&self, trial: &Trial, pass: &PassReport) -> Row {
        Row {
            s_rpm: trial.s_rpm,
            delta_x_mm: trial.delta_x_mm,
            delta_c_deg: trial.delta_c_deg,
            override_pct: self.override_pct,
            mass_error_pct: self.mass_error_pct,
            friction_error_pct: self.friction_error_pct,
            seed: self.seed,
            approach_max_abs_um: pass.x.approach_max_um.max(-pass.x.approach_min_um),
            end_um: pass.x.end_um,
            thread_max_abs_um: pass.x.settled_max_abs_um,
            at_depth_max_abs_um: pass.x.thread_max_abs_um,
        }
    }
}

/// A machine whose spindle encoder has twice the lines: what the count of the encoder costs is what it takes
/// away.
fn with_finer_encoder(machine: &Machine) -> Machine {
    let mut machine = machine.clone();
    machine.spindle.encoder_lines = machine.spindle.encoder_lines.saturating_mul(2);
    machine
}

/// Runs every condition.
fn rows(stand: &Stand, conditions: &[Condition], passes: &[[f64; 3]]) -> Result<Vec<Row>, ExperimentError> {
    let rows = stand.each(conditions, |condition| condition.rows(stand, passes))?;
    Ok(rows.into_iter().flatten().collect())
}

/// Runs every case.
///
/// # Errors
/// As [`Stand::run`].
pub(super) fn findings(stand: &Stand) -> Result<Findings<Row>, ExperimentError> {
    let seeds: Vec<u64> = (0..SEEDS).map(|n| stand.seed.wrapping_add(n)).collect();
    let conditions = Condition::all(&OVERRIDES, &MASS_ERRORS, &FRICTION_ERRORS, &seeds);
    let finer = Stand { machine: with_finer_encoder(&stand.machine), ..*stand };
    let finer = rows(&finer, &conditions, &PASSES)?;
    let rows = rows(stand, &conditions, &PASSES)?;
    Ok(Findings {
        title: "Sweep over passes, overrides and wrong beliefs",
        short: text::short(&rows, &finer),
        done: text::done(rows.len()),
        tables: tables::all(&rows, &finer),
        notes: Vec::new(),
        figures: figures::all(&rows),
        text: text::meaning(&stand.machine),
        rows,
    })
}
