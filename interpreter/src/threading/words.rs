//! What the words of a thread ask for. In: G33 with its target, a cycle as the program has it. Out: the same
//! in mm of the machine, or what is wrong with it.

use gcode::Problem;
use gcode::canon::{ThreadCycle, Z};
use gcode::problem::{Blame, short};
use machine::Machine;
use protocol::Axis;

use super::{SAME, check_lead, in_plane, in_plane_of};
use crate::modal::Synchronised;
use crate::points::Points;
use crate::reach::{missing, within_travel};
use crate::spindle::Turning;
use crate::thread::{Chain, Cycle, Leg, Next, Point, Round, Single, Table};

/// Steepest infeed, degrees.
const INFEED_DEG: f64 = 80.0;
/// Highest degression.
const DEGRESSION: f64 = 100.0;

/// G33: one pass along the path to the target, a line or an arc, or what goes on from one. `line` of the
/// program.
pub(crate) fn single(
    (line, goes_on): (u32, bool),
    (target, round): (&gcode::Pose, Option<Round>),
    (synchronised, table): (&Synchronised, &Table),
    points: &Points,
    turning: Turning<'_>,
    machine: &Machine,
) -> Result<Single, Box<Problem>> {
    let Synchronised { lead_mm, growth_mm, start_deg } = *synchronised;
    let (from, to) = (in_plane(points.programmed()), in_plane(target));
    let (s_rpm, direction) = turning.at(from.x, machine)?;
    check_lead(lead_mm, 'K', turning.frame.units)?;
    if in_plane_of(target, from) != *points.programmed() {
        return Err(missing("a thread that turns the spindle as an axis", "move X and Z alone"));
    }
    if (to.z - from.z).abs().max((to.x - from.x).abs()) < SAME {
        let help = "give X or Z of its end";
        return Err(Problem::error("bad-value", Blame::Block, "the thread has no length", help));
    }
    if points.after_thread() && !goes_on {
        let message = "this thread would begin where another one ends, and something stands between them";
        let help = "let it follow at once, so that both are one chain, or put a G0 between them";
        return Err(Problem::error("not-available", Blame::Block, message, help));
    }
    let legs = match round {
        Some(_) if table.is_in_force() => return Err(table.refuses("a thread along an arc")),
        None if table.is_in_force() && growth_mm != 0.0 => return Err(table.refuses("G34")),
        None if table.is_in_force() => table.legs(line, [from, to], lead_mm, turning.frame)?,
        Some(round) => round.legs(line, [from, to], lead_mm),
        None => Leg::straight(line, [from, to], lead_mm, growth_mm).map(|leg| vec![leg]),
    };
    let legs = legs.and_then(|legs| Chain::of(&legs).map(|_| legs));
    let legs = legs.map_err(|why| why.problem(turning.frame.units))?;
    for (axis, at) in legs.iter().flat_map(|leg| [(Axis::X, leg.to.x), (Axis::Z, leg.to.z)]) {
        within_travel(machine, axis, at, Blame::Block)?;
    }
    Ok(Single {
        s_rpm,
        direction,
        units: turning.frame.units,
        from,
        legs,
        start_deg,
        next: Next::Stays,
        outwards: points.outwards(),
    })
}

/// A threading cycle in mm, machine coordinates.
pub(crate) fn cycle_on_machine(
    cycle: &ThreadCycle,
    turning: Turning<'_>,
    machine: &Machine,
) -> Result<Cycle, Box<Problem>> {
    let frame = turning.frame;
    let (units, unit) = (frame.units, frame.unit());
    let from = in_plane(&frame.machine(&cycle.from));
    let (s_rpm, direction) = turning.at(from.x + cycle.crest * unit, machine)?;
    let to_z = frame.machine(&in_plane_of(&cycle.from, Point { x: 0.0, z: cycle.end_z }))[Z];
    if (to_z - from.z).abs() < SAME {
        let help = "let Z differ from where the tool stands";
        return Err(Problem::error("bad-value", Blame::Word('Z'), "the thread has no length", help));
    }
    let lead_mm = cycle.lead * unit;
    check_lead(lead_mm, 'P', units)?;
    let out_of_range = |letter, value: f64, range: &str| {
        let message = format!("{letter}{} is out of range", short(value));
        Err(Problem::error("bad-value", Blame::Word(letter), message, format!("allowed: {range}")))
    };
    if cycle.infeed_deg.abs() > INFEED_DEG {
        return out_of_range('Q', cycle.infeed_deg, "-80 to 80 degrees");
    }
    if !(1.0..=DEGRESSION).contains(&cycle.degression.exponent) {
        return out_of_range('R', cycle.degression.exponent, "1 to 100");
    }
    if (cycle.chamfer_in || cycle.chamfer_out) && cycle.chamfer <= 0.0 {
        let help = "give its length with E, or leave L out";
        let message = "L asks for a taper that has no length";
        return Err(Problem::error("bad-value", Blame::Word('L'), message, help));
    }
    Ok(Cycle { s_rpm, direction, from, to_z, units, lead_mm, words: *cycle })
}
