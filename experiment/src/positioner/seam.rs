//! A seam in the whole machine: the pipe and its branch of `examples/positioner/cylinders.toml`, welded on
//! four axes with backlash and encoders. In: a positioner. Out: how far the beam was from the seam, how far
//! off the bisector, and its feed; commanded, and true.

use machine::Machine;
use rig::observe::{TraceReport, Traced};

use crate::{ExperimentError, stand::Stand};

const NAME: &str = "cylinders.toml";
const JOB: &str = include_str!("../../../examples/positioner/cylinders.toml");

/// Control cycles from one point of the curve to the next.
const EVERY: u64 = 16;

/// What was seen of the seam.
pub(super) struct SeamRun {
    pub(super) report: TraceReport,
    /// Time from the start of the seam in s, and what was measured then; one in [`EVERY`] control cycles.
    pub(super) curve: Vec<(f64, Traced)>,
}

/// Runs the seam on a machine.
///
/// # Errors
/// The seam does not fit on the machine, or it did not come to its end.
pub(super) fn run(machine: &Machine, seed: u64) -> Result<SeamRun, ExperimentError> {
    let (mut curve, mut cycles) = (Vec::new(), 0_u64);
    let report = Stand::cut(machine, NAME, JOB, seed, &mut |_, traced| {
        if traced.trace == 0 {
            return;
        }
        if cycles.is_multiple_of(EVERY) {
            curve.push((cycles as f64 * machine.general.cycle_s, traced));
        }
        cycles += 1;
    })?;
    Ok(SeamRun { report, curve })
}
