//! The simulated machine as a bench for commissioning: it shows what it measures, and nothing else of it is
//! seen. In: a machine file. Out: its axes tuned.

use machine::Machine;
use protocol::{Axis, DriveCommand, Measurement, PerAxis, SpindleCommand};
use sim_plant::{Plant, PlantError, Scenario};
use tune::{Bench, Goals, Refusal, Tuned};

/// Why an axis of a machine was not tuned.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// The truth about the plant is not as it has to be.
    #[error(transparent)]
    Plant(#[from] PlantError),
    /// The measurements of an axis are not good enough, with what to do about it.
    #[error(transparent)]
    Axis(#[from] Refusal),
}

/// The plant with its spindle at rest.
struct PlantBench(Plant);

impl Bench for PlantBench {
    fn measurement(&self) -> &Measurement {
        self.0.measurement()
    }

    fn tick(&mut self, drives: &PerAxis<DriveCommand>) {
        self.0.tick(drives, &SpindleCommand::default(), None);
    }
}

/// The linear axes of a machine.
pub fn linear(machine: &Machine) -> Vec<Axis> {
    machine.axes().map(|(axis, _)| axis).filter(|axis| !axis.is_rotary()).collect()
}

/// Tunes axes of a machine, one after the other, from where they stand at the start.
///
/// # Errors
/// Why an axis cannot be tuned, and what to do.
pub fn all(machine: &Machine, axes: &[Axis], seed: u64, goals: &Goals) -> Result<Vec<Tuned>, BenchError> {
    let mut bench = PlantBench(Plant::new(machine, Scenario::none(), seed)?);
    let tuned = |axis: &Axis| Ok(tune::tune_towards(&mut bench, *axis, machine, goals)?);
    axes.iter().map(tuned).collect()
}

/// The machine with what was found of its axes in the place of what was believed.
pub fn with(machine: &Machine, tuned: &[Tuned]) -> Machine {
    let mut machine = machine.clone();
    machine.axis.extend(tuned.iter().map(|tuned| (tuned.axis, tuned.proposal.clone())));
    machine
}

/// The machine with every linear axis tuned.
///
/// # Errors
/// Why an axis cannot be tuned, and what to do.
pub fn tuned(machine: &Machine, seed: u64) -> Result<Machine, BenchError> {
    Ok(with(machine, &all(machine, &linear(machine), seed, &Goals::default())?))
}
