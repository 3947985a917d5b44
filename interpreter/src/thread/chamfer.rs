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
    let (chamfer, way) = (cycle.words.chamfer * cycle.units.mm(), ways.fold(0.0, f64::max));
    let (length, over) = (cycle.units.length(chamfer), cycle.units.length(way));
    let (message, help) = match way > chamfer {
        true => (
            format!(
                "X cannot leave within the chamfer of {length}: it leaves as steeply as it can, over {over}"
            ),
            "ask for a longer chamfer, or lower S",
        ),
        false => (
            format!(
                "X cannot rise along the chamfer of {length}: it leaves within it by a curve, over {over}"
            ),
            "to have the line of the chamfer, lower S",
        ),
    };
    let slower = refused.map(|rpm| format!(": S{} is slow enough", short(rpm)));
    let help = help.to_owned() + &slower.unwrap_or_default();
    Ok((plans, Some(*Problem::warning("steep-chamfer", Blame::Line(line), message, help))))
}
