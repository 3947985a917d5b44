//! How a program that was broken off is gone on with. In: its machine code, what the journal knows of the
//! run, where the axes are measured now. Out: a [`Plan`]: where it begins again, what is in force there, the
//! way to get there; or a [`Refusal`].
//!
//! | rule | why |
//! |---|---|
//! | it begins at the first pass that the journal does not know as cut, or at the first move that is not done | what is not known to be done is done again: in a groove that is there a pass takes nothing |
//! | a pass is cut again whole, from its start | same index, same angles: the same helix |
//! | a contour that was broken off is begun where its first feed began | there the tool came to it through the air |
//! | everything before is read and not executed | what is in force follows from the program, not from a guess |
//! | behind a change of the tool everything before it is done | the tool stands there, and another one does not go over what it did |
//! | the way there begins where the tool is *measured*: straight out of a groove, back on a contour (`ways`) | the tool has been there |
//! | on a mill it begins with the move that was broken off, and the tool goes up, over the place and down (`lifted`) | where a tool stands all above it is free |
//!
//! Outputs, tool and path are as the program has them there before anything moves; spindle and coolant go on
//! where the tool has come to the start.

mod lifted;
mod refusal;
mod retooled;
mod ways;

use machine::{Kinematics, Machine};
use protocol::{Code, Feed, Item, PerAxis, Position};
use route::{
    approach::before,
    in_force::{Modal, apart_mm, end},
};

use crate::journal::State;
pub use refusal::{Place, Refusal};
pub use retooled::Changed;
use ways::{ON_MM, Step, in_another, last_change, moves, perhaps_in, stands_on, way_back, way_out};

/// A contour that is broken off has at most so many items; so far is looked for the place of the tool.
const MOST: usize = 1 << 14;

/// How a program is gone on with.
#[derive(Clone, Debug)]
pub struct Plan {
    /// What is in force at the item at which it begins again; [`Modal::items`] of the program are left out.
    pub modal: Modal,
    /// The item at which it begins again: its line, and its number if it is a pass.
    pub line: u32,
    /// See there.
    pub pass: Option<u32>,
    /// Where the tool stands now.
    pub stands: Stands,
    /// The moves from where the axes are measured to where it begins.
    pub way: Vec<Item>,
    /// What is executed before the rest of the program: `way` is part of it.
    pub before: Vec<Item>,
    /// The tool that is put in behind `way`, but for its last moves, if it is another one.
    pub changed: Option<Changed>,
    /// The way leads up, over the place and down to it.
    lifts: bool,
}

/// Where the tool of a run that was broken off stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stands {
    /// Where a pass leads it, perhaps in its groove.
    InPass(u32),
    /// On a rapid of a line.
    OnRapid(u32),
    /// On a contour, in a line.
    OnContour(u32),
    /// Over the part, on a way that led over it.
    Above,
    /// Where the program has left it: nothing moves any more.
    AtRest,
}

/// Finds how a program is gone on with, by what the journal knows and where the axes are measured. The
/// program is read twice at most.
///
/// # Errors
/// [`Refusal`] says why it is not, and what to do.
pub fn plan<I: Iterator<Item = Item>>(
    machine: &Machine,
    program: impl Fn() -> I,
    state: &State,
    here: &PerAxis<Position>,
) -> Result<Plan, Refusal> {
    if machine.general.kinematics == Kinematics::Positioner {
        return Err(Refusal::Positioner);
    }
    if state.is_complete() {
        return Err(Refusal::Complete);
    }
    // A move that was taken last counts before it is done: it is, if the tool stands on a later one.
    let in_hand = attempt(machine, program(), state, here, Last::InHand);
    match in_hand {
        Ok((plan, true)) => Ok(plan),
        _ => attempt(machine, program(), state, here, Last::Done).map(|(plan, _)| plan),
    }
}

/// The move that was taken last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Last {
    InHand,
    Done,
}

/// A plan, and whether the tool stands on the first move that is not done.
fn attempt(
    machine: &Machine,
    program: impl Iterator<Item = Item>,
    state: &State,
    here: &PerAxis<Position>,
    last_move: Last,
) -> Result<(Plan, bool), Refusal> {
    let mut program = program.fuse();
    let mut found = find(machine, &mut program, state, last_move)?;
    look_ahead(&mut found.steps, &mut program);
    let Some(first) = found.first_move() else {
        return Ok((Plan::new(found.begin, &found.steps, Stands::AtRest, Vec::new()), true));
    };
    let front = Front::find(machine, found, first, state, here)?;
    if is_mill(machine) { lifted::over_the_part(front, here) } else { where_it_has_been(front, here) }
}

fn is_mill(machine: &Machine) -> bool {
    machine.general.kinematics == Kinematics::Mill
}

/// What is not done, and where in it the tool stands.
struct Front {
    /// What is in force where it begins.
    begin: Modal,
    /// Items from there on, with the places before them.
    steps: Vec<Step>,
    /// The first move that is not done.
    first: usize,
    /// The step on which the tool stands, if it is on one; and the one from which it goes on.
    stood: Option<usize>,
    /// See there.
    last: usize,
}

impl Front {
    /// Finds it in a program whose first move that is not done is known. The tool of a mill that is on no
    /// step may be above those that are not done.
    fn find(
        machine: &Machine,
        found: Found,
        mut first: usize,
        state: &State,
        here: &PerAxis<Position>,
    ) -> Result<Front, Refusal> {
        let Found { mut begin, mut steps, known } = found;
        let stood = stands_on(&steps, known, here);
        let to = steps[..=stood.unwrap_or(first)].iter().map(|step| step.0).find(is_work);
        if let Some(Item { line, .. }) = to {
            return Err(Refusal::Work { line });
        }
        let mut last = match stood {
            Some(last) => last,
            None if is_mill(machine) && lifted::is_above(&begin, &steps[first..], here) => first,
            None => return Err(elsewhere(machine, &steps[first], here)),
        };
        if *state == State::nothing()
            && stood.is_some()
            && let Some(tools) = in_another(begin.tool, &steps, last, here)
        {
            return Err(Refusal::WhichTool { tools });
        }
        if let Some(change) = last_change(begin.tool, &steps[..last]) {
            // It stands behind that change, so what is before it is done: another tool does not go over it.
            steps.drain(..=change).for_each(|(item, _)| begin.take(&item));
            last -= change + 1;
            first = steps.iter().position(|step| moves(&step.0)).unwrap_or(last);
        }
        Ok(Front { begin, steps, first, stood, last })
    }
}

/// A plan of a lathe: its tool goes over nothing but what it has been over.
fn where_it_has_been(front: Front, here: &PerAxis<Position>) -> Result<(Plan, bool), Refusal> {
    let Front { mut begin, mut steps, first, last, .. } = front;
    let Item { line, code } = steps[last].0;
    if let Code::Pass(pass) = code
        && pass.returns()
        && apart_mm(here, &pass.axes.map(|law| law.start)) > ON_MM
    {
        return Err(Refusal::Tap { line });
    }
    let stands = match code {
        Code::Pass(pass) => Stands::InPass(pass.pass),
        Code::Line { feed: Feed::Rapid, .. } => Stands::OnRapid(line),
        _ => Stands::OnContour(line),
    };
    let groove = perhaps_in(&steps[last..], here);
    let waits = steps[..first].iter().any(|step| is_wait(&step.0)) && apart_mm(here, &steps[first].1) < ON_MM;
    if let Code::Line { target, feed: Feed::Rapid } = code
        && first == last
        && !waits
    {
        // Forward, on the way on which it was.
        let way = groove.map_or_else(|| vec![steps[last].0], |pass| way_out(&pass, line, here, target));
        steps.drain(..=first).for_each(|(item, _)| begin.take(&item));
        return Ok((Plan::new(begin, &steps, stands, way), true));
    }
    let way = match groove {
        Some(pass) => way_out(&pass, line, here, steps[0].1),
        None => way_back(&steps[..=last], here),
    };
    Ok((Plan::new(begin, &steps, stands, way), first == last))
}

/// Where a program begins again.
struct Found {
    /// What is in force there.
    begin: Modal,
    /// Items from there on, with the places before them.
    steps: Vec<Step>,
    /// How many of them are known to be done.
    known: usize,
}

impl Found {
    /// The first move that is not done; none if nothing moves any more.
    fn first_move(&self) -> Option<usize> {
        let first = self.steps.iter().skip(self.known).position(|step| moves(&step.0))?;
        Some(self.known + first)
    }
}

/// Reads a program up to what is not done.
fn find(
    machine: &Machine,
    program: &mut impl Iterator<Item = Item>,
    state: &State,
    last_move: Last,
) -> Result<Found, Refusal> {
    let mut modal = Modal::new(machine);
    // The contour in hand: what was in force before its first feed, and all since.
    let mut contour: Option<(Modal, Vec<Step>)> = None;
    let goes_back = !is_mill(machine);
    loop {
        let item = program.next().ok_or(Refusal::OtherProgram)?;
        if is_not_done(&modal, &item, state, last_move) {
            let at_end = matches!(item.code, Code::End) && state.step > modal.steps + 1;
            if at_end || state.passes > modal.passes {
                return Err(Refusal::OtherProgram);
            }
            if let Code::Pass(pass) = item.code
                && state.open != 0
                && pass.pass != state.open
            {
                return Err(Refusal::OtherPass { open: state.open, next: pass.pass });
            }
            return Ok(begins_at(modal, contour, item, program));
        }
        match item.code {
            Code::Line { feed: Feed::Rapid, .. } | Code::Pass(_) => contour = None,
            _ if goes_back && (item.is_move() || contour.is_some()) => {
                let (_, steps) = contour.get_or_insert_with(|| (modal.clone(), Vec::new()));
                steps.push((item, modal.at));
                if steps.len() > MOST {
                    return Err(Refusal::TooLong { line: steps[0].0.line });
                }
            }
            _ => {}
        }
        modal.take(&item);
    }
}

/// Whether an item is the first that the journal does not know as done. A pass in hand counts as taken while
/// it still waits for its spindle, so passes are counted by themselves; what needs no motion is done again.
fn is_not_done(modal: &Modal, item: &Item, state: &State, last_move: Last) -> bool {
    let steps = modal.steps + item.steps();
    match item.code {
        Code::Pass(_) => modal.passes >= state.passes,
        Code::End => true,
        _ if item.is_move() && last_move == Last::Done => steps > state.step,
        _ => steps >= state.step,
    }
}

/// A contour goes on if a feed is what comes next; else it is over.
fn begins_at(
    modal: Modal,
    contour: Option<(Modal, Vec<Step>)>,
    item: Item,
    program: &mut impl Iterator<Item = Item>,
) -> Found {
    let mut steps = vec![(item, modal.at)];
    while let Some((last, from)) = steps.last()
        && !(moves(last) || matches!(last.code, Code::End))
    {
        let at = end(last, from);
        let Some(item) = program.next() else { break };
        steps.push((item, at));
    }
    let feeds = steps.last().is_some_and(|(item, _)| {
        item.is_move() && !matches!(item.code, Code::Line { feed: Feed::Rapid, .. })
    });
    match contour {
        Some((begin, mut done)) if feeds => {
            let known = done.len();
            done.append(&mut steps);
            Found { begin, steps: done, known }
        }
        _ => Found { begin: modal, steps, known: 0 },
    }
}

/// Reads on: the tool can have come farther than the journal knows.
fn look_ahead(steps: &mut Vec<Step>, program: &mut impl Iterator<Item = Item>) {
    let most = steps.len() + MOST;
    while let Some((last, from)) = steps.last()
        && steps.len() < most
        && !matches!(last.code, Code::End)
    {
        let at = end(last, from);
        let Some(item) = program.next() else { break };
        steps.push((item, at));
    }
}

/// Whether somebody may still wait for the end of this where the tool stands before the next move.
fn is_wait(item: &Item) -> bool {
    matches!(item.code, Code::Dwell { .. } | Code::Await { .. } | Code::Pause | Code::OptionalPause)
}

fn is_work(item: &Item) -> bool {
    matches!(item.code, Code::Work(_))
}

fn elsewhere(machine: &Machine, (item, from): &Step, here: &PerAxis<Position>) -> Refusal {
    let [here, begins] = [here, from].map(|place| Place::of(machine, place));
    Refusal::Elsewhere { here, line: item.line, begins }
}

impl Plan {
    /// The machine code that is executed: the way there, then the rest of the program.
    pub fn executed<I: Iterator<Item = Item>>(&self, program: I) -> impl Iterator<Item = Item> + use<I> {
        let left_out = usize::try_from(self.modal.items).unwrap_or(usize::MAX);
        self.before.clone().into_iter().chain(program.skip(left_out))
    }

    /// What the items before the rest of the program count in its progress.
    pub fn steps_before(&self) -> u64 {
        self.before.iter().map(Item::steps).sum()
    }

    /// A plan that begins at the first of these steps.
    fn new(modal: Modal, steps: &[Step], stands: Stands, way: Vec<Item>) -> Plan {
        let first = steps.first().map_or(Item { line: 0, code: Code::End }, |step| step.0);
        let next = steps.iter().map(|step| &step.0).find(|item| moves(item)).unwrap_or(&first);
        let pass = if let Code::Pass(pass) = next.code { Some(pass.pass) } else { None };
        let line = next.line;
        let before = before(&modal, &way, &[], false, first.line);
        Plan { modal, line, pass, stands, way, before, changed: None, lifts: false }
    }
}
