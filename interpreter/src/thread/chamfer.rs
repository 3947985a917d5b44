//! The plans of a cycle, and what becomes of a chamfer that X cannot follow.
//!
//! In: a cycle and its cuts. Out: a plan for each. Where the chamfer yields, as that of FANUC does, all cuts
//! lose it as soon as one of them is too steep: X then leaves as fast as it can, as it does without one.

use gcode::Problem;
use gcode::problem::{Blame, short};
use machine::Machine;

use super::cut::Cut;
use super::cycle::Cycle;
use super::plan::{Plan, plan};
use super::refusal::{Refusal, highest_speed};

/// The plans of all cuts, and a warning if the chamfer is another one. It is taken out of `cuts` then.
///
/// # Errors
/// A cut has no law.
pub(crate) fn plans(
    cycle: &Cycle,
    cuts: &mut [Cut],
    line: u32,
    machine: &Machine,
) -> Result<(Vec<Plan>, Option<Problem>), Box<Problem>> {
    let all = |cuts: &[Cut]| cuts.iter().map(|cut| plan(cut, machine)).collect::<Result<Vec<_>, _>>();
    let refused = match all(cuts) {
        Ok(plans) => return Ok((plans, None)),
        Err(Refusal::ExitTaper { .. }) if cycle.words.chamfer_yields => highest_speed(cuts, machine),
        Err(why) => return Err(why.problem(cuts, cycle.units, machine)),
    };
    cuts.iter_mut().for_each(|cut| cut.exit = None);
    let plans = all(cuts).map_err(|why| why.problem(cuts, cycle.units, machine))?;
    let ways = cuts.iter().zip(&plans).map(|(cut, plan)| (cut.to_mm - plan.full_depth_mm[1]).abs());
    let message = format!(
        "X cannot leave within the chamfer of {}: it leaves as steeply as it can, over {}",
        cycle.units.length(cycle.words.chamfer * cycle.units.mm()),
        cycle.units.length(ways.fold(0.0, f64::max))
    );
    let slower = refused.map(|rpm| format!(", or lower S: S{} is slow enough", short(rpm)));
    let help = format!("ask for a longer chamfer{}", slower.unwrap_or_default());
    Ok((plans, Some(*Problem::warning("steep-chamfer", Blame::Line(line), message, help))))
}
