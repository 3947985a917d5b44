//! How a program of a mill is gone on with. In: as in [`super::plan`]. Out: the plan; its way leads straight
//! up, over the place and down to it.
//!
//! | the tool stands | it goes |
//! |---|---|
//! | on the move that was broken off, on one behind it, or beside them where it was braked | straight up to where the axes stand at the start of the machine, over the place, down by feed |
//! | straight over one of these moves, or so high already: a lead-in was broken off as well | the same |
//! | below where a pass of a thread or tap starts | nowhere: nothing but the spindle takes it out |
//!
//! Where a tool stands it has come to, so all above it is free, and so it is above every place that it has
//! been led to; but of a cutter that is wider than its shank nobody knows that.

use machine::Machine;
use protocol::{Axis, Code, Feed, Item, PerAxis, Position, ThreadPass};

use super::{
    Last, Plan, Stands, State, before, elsewhere, find, is_work, look_ahead,
    reader::apart_mm,
    refusal::Refusal,
    route::{BACK, LED_MM, ON_MM, Step, Way, in_another, is_in_hole, last_change, moves, off, stands_on},
};

const Z: usize = Axis::Z as usize;
/// A tool that is straight over a move is so within this, mm.
const OVER_MM: f64 = 0.5;

/// A plan, and whether the tool stands on the first move that is not done.
pub(super) fn attempt(
    machine: &Machine,
    program: impl Iterator<Item = Item>,
    state: &State,
    here: &PerAxis<Position>,
    last_move: Last,
) -> Result<(Plan, bool), Refusal> {
    let mut program = program.fuse();
    let found = find(machine, &mut program, state, last_move)?;
    let (mut begin, mut steps) = (found.begin, found.steps);
    look_ahead(&mut steps, &mut program);
    let Some(mut first) = steps.iter().position(|step| moves(&step.0)) else {
        return Ok((Plan::new(begin, &steps, Stands::AtRest, Vec::new()), true));
    };
    let top = top(machine, here);
    let stood = stands_on(&steps, 0, here);
    let over = || top.mm_from(here[Z]) < ON_MM || steps[first..].iter().any(|step| is_over(step, here));
    let mut last = match stood {
        Some(last) => last,
        None if over() => first,
        None => return Err(elsewhere(machine, &steps[first], here)),
    };
    if let Some(Item { line, .. }) = steps[..=last].iter().map(|step| step.0).find(is_work) {
        return Err(Refusal::Work { line });
    }
    if let Some(line) = in_hole(&steps[last..], stood.is_some(), here) {
        return Err(Refusal::Tap { line });
    }
    if *state == State::nothing()
        && stood.is_some()
        && let Some(tools) = in_another(begin.tool, &steps, last, here)
    {
        return Err(Refusal::WhichTool { tools });
    }
    if let Some(change) = last_change(begin.tool, &steps[..last]) {
        // It stands behind that change, so what is before it is done.
        steps.drain(..=change).for_each(|(item, _)| begin.take(&item));
        last -= change + 1;
        first = steps.iter().position(|step| moves(&step.0)).unwrap_or(last);
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
    let way = way(here, top, begin.at, line);
    let line = steps.first().map_or(line, |step| step.0.line);
    let before = before(&begin, &way, &[], true, line);
    let plan = Plan { before, lifts: true, ..Plan::new(begin, &steps, stands, way) };
    Ok((plan, first == last && stood.is_some()))
}

/// So high nothing is in the way: where Z stands at the start of the machine, or here if that is higher.
fn top(machine: &Machine, here: &PerAxis<Position>) -> Position {
    machine.home()[Z].max(here[Z])
}

/// Straight up, over a place, down to it.
pub(super) fn way(here: &PerAxis<Position>, top: Position, to: PerAxis<Position>, line: u32) -> Vec<Item> {
    let mut way = Way { items: Vec::new(), at: *here, line };
    let top = top.max(to[Z]);
    let [mut up, mut over] = [*here, to];
    (up[Z], over[Z]) = (top, top);
    way.go(up, Feed::Rapid);
    way.go(over, Feed::Rapid);
    way.go(to, BACK);
    way.items
}

/// Takes the move down to the part off the end of a way, if it has one.
pub(super) fn down(way: &mut Vec<Item>) -> Option<Item> {
    way.pop_if(|item| matches!(item.code, Code::Line { feed: BACK, .. }))
}

/// The moves of another tool, from where the way of the one before leads down to its place.
pub(super) fn arrival(
    machine: &Machine,
    way: &mut Vec<Item>,
    was: PerAxis<Position>,
    to: PerAxis<Position>,
) -> Vec<Item> {
    let line = down(way).or(way.last().copied()).map_or(0, |item| item.line);
    let mut over = was;
    over[Z] = machine.home()[Z].max(was[Z]);
    let over = way.last().and_then(|item| item.code.target().copied()).unwrap_or(over);
    self::way(&over, over[Z], to, line)
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
