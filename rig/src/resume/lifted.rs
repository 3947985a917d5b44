//! How a program of a mill is gone on with. In: as in [`super::plan`]. Out: the plan; its way leads straight
//! up, over the place and down to it.
//!
//! | the tool stands | it goes |
//! |---|---|
//! | on the move that was broken off, on one behind it, or beside them where it was braked | straight up, as high as the axes stand at the start of the machine and as the program has led them, over the place, down by feed |
//! | straight over one of these moves, or so high already: a lead-in was broken off as well | the same |
//! | below where a pass of a thread or tap starts | nowhere: nothing but the spindle takes it out |
//!
//! Where a tool stands it has come to, so all above it is free, and so it is above every place that it has
//! been led to; but of a cutter that is wider than its shank nobody knows that.

use machine::Machine;
use protocol::{Axis, Code, Feed, Item, PerAxis, Position, ThreadPass};
use route::{
    approach::{BACK, before, down, over},
    in_force::{Modal, apart_mm},
};

use super::{
    Front, Plan, Stands,
    refusal::Refusal,
    ways::{LED_MM, ON_MM, Step, is_in_hole, off},
};

const Z: usize = Axis::Z as usize;
/// A tool that is straight over a move is so within this, mm.
const OVER_MM: f64 = 0.5;

/// Whether a tool is straight over one of these steps, or as high as the program has led it before.
pub(super) fn is_above(begin: &Modal, steps: &[Step], here: &PerAxis<Position>) -> bool {
    begin.top.mm_from(here[Z]) < ON_MM || steps.iter().any(|step| is_over(step, here))
}

/// A plan, and whether the tool stands on the first move that is not done, or on none: nobody knows then that
/// this one is done.
pub(super) fn over_the_part(front: Front, here: &PerAxis<Position>) -> Result<(Plan, bool), Refusal> {
    let Front { mut begin, mut steps, first, stood, last } = front;
    if let Some(line) = in_hole(&steps[last..], stood.is_some(), here) {
        return Err(Refusal::Tap { line });
    }
    let Item { line, code } = steps[last].0;
    let stands = match code {
        _ if stood.is_none() => Stands::Above,
        Code::Pass(pass) => Stands::InPass(pass.pass),
        Code::Line { feed: Feed::Rapid, .. } => Stands::OnRapid(line),
        _ => Stands::OnContour(line),
    };
    if first == 0 && last == 0 && matches!(code, Code::Line { feed: Feed::Rapid, .. }) {
        // Where it leads is reached as well.
        steps.drain(..=first).for_each(|(item, _)| begin.take(&item));
    }
    let way = over(here, begin.top.max(here[Z]), begin.at, line);
    let line = steps.first().map_or(line, |step| step.0.line);
    let before = before(&begin, &way, &[], true, line);
    let plan = Plan { before, lifts: true, ..Plan::new(begin, &steps, stands, way) };
    Ok((plan, first == last || stood.is_none()))
}

/// The moves of another tool, from where the way of the one before leads down to its place.
pub(super) fn arrival(
    machine: &Machine,
    way: &mut Vec<Item>,
    was: PerAxis<Position>,
    to: PerAxis<Position>,
) -> Vec<Item> {
    let line = down(way).or(way.last().copied()).map_or(0, |item| item.line);
    let mut above = was;
    above[Z] = machine.home()[Z].max(was[Z]);
    let above = way.last().and_then(|item| item.code.target().copied()).unwrap_or(above);
    over(&above, above[Z], to, line)
}

/// Whether a tool is straight over a move.
fn is_over((item, from): &Step, here: &PerAxis<Position>) -> bool {
    let flat = |place: &PerAxis<Position>| {
        let mut flat = *place;
        flat[Z] = Position(0);
        flat
    };
    let (code, lowest) = match item.code {
        Code::Line { target, feed } => (Code::Line { target: flat(&target), feed }, from[Z].min(target[Z])),
        Code::Pass(pass) => {
            let target = pass.axes.map(|law| law.start);
            (Code::Line { target: flat(&target), feed: BACK }, target[Z])
        }
        _ => return here[Z] >= from[Z] && apart_mm(&flat(from), &flat(here)) < OVER_MM,
    };
    let flat_step = (Item { code, ..*item }, flat(from));
    here[Z] >= lowest && off(&flat_step, &flat(here)).is_some_and(|[mm, _]| mm < OVER_MM)
}

/// The line of a pass in whose hole the tool may stand: of the first of these steps, or of a later one if it
/// is beside the first, because the journal may be old.
fn in_hole(steps: &[Step], stood: bool, here: &PerAxis<Position>) -> Option<u32> {
    let within =
        |pass: &ThreadPass| is_in_hole(pass, here) && apart_mm(here, &pass.axes.map(|law| law.start)) > ON_MM;
    let (first, later) = steps.split_first()?;
    let passes = |steps: &[Step]| {
        let pass = |(item, _): &Step| match item.code {
            Code::Pass(pass) if within(&pass) => Some(item.line),
            _ => None,
        };
        steps.iter().find_map(pass)
    };
    let is_on = stood && off(first, here).is_some_and(|[mm, _]| mm <= LED_MM);
    passes(&steps[..1]).or_else(|| if is_on { None } else { passes(later) })
}
