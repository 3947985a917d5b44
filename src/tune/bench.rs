//! The simulated machine as a bench for commissioning: it shows what it measures, and nothing else of it is seen. In: a
//! machine file. Out: its axes tuned.

use machine::Machine;
use protocol::{Axis, DriveCommand, Measurement, PerAxis, SpindleCommand};
use sim_plant::{Plant, Scenario};
use tune::{Bench, Goals, Tuned};

use crate::error::CliError;

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
pub(crate) fn linear(machine: &Machine) -> Vec<Axis> {
    machine.axes().map(|(axis, _)| axis).filter(|axis| !axis.is_rotary()).collect()
}

/// Tunes axes of a machine, one after the other, from where they stand at the start.
///
/// # Errors
/// Why an axis cannot be tuned, and what to do.
pub(super) fn all(
    machine: &Machine,
    axes: &[Axis],
    seed: u64,
    goals: &Goals,
) -> Result<Vec<Tuned>, CliError> {
    let failed = |reason: String| CliError::Machine(reason);
    let plant = Plant::new(machine, Scenario::none(), seed).map_err(|error| failed(error.to_string()))?;
    let mut bench = PlantBench(plant);
    let tuned = |axis: &Axis| {
        tune::tune_towards(&mut bench, *axis, machine, goals).map_err(|error| failed(error.to_string()))
    };
    axes.iter().map(tuned).collect()
}

/// The machine with what was found of its axes in the place of what was believed.
pub(crate) fn with(machine: &Machine, tuned: &[Tuned]) -> Machine {
    let mut machine = machine.clone();
    machine.axis.extend(tuned.iter().map(|tuned| (tuned.axis, tuned.proposal.clone())));
    machine
}

/// The machine with every linear axis tuned.
///
/// # Errors
/// As `pitchlock tune`.
pub(crate) fn machine(machine: &Machine, seed: u64) -> Result<Machine, CliError> {
    Ok(with(machine, &all(machine, &linear(machine), seed, &Goals::default())?))
}
