//! Makes a case that breaks an invariant smaller. In: the case, the invariant. Out: a case that still breaks
//! the same one, with fewer events and fewer blocks of the program: greedy, one at a time, until nothing more
//! can be left out.

use crate::case::Case;
use crate::judge::Broken;
use crate::run;

/// Runs that are made at most.
const MOST_RUNS: u32 = 60;

/// The smallest case found, and what it breaks.
pub fn shrink(case: &Case, broken: &Broken) -> (Case, Broken) {
    let mut best = (case.clone(), broken.clone());
    let mut runs = 0;
    loop {
        let found = smaller(&best.0).into_iter().find_map(|case| {
            runs += 1;
            let still = (runs <= MOST_RUNS).then(|| breaks(&case)).flatten()?;
            (still.invariant == broken.invariant).then_some((case, still))
        });
        match found {
            Some(smaller) => best = smaller,
            None => return best,
        }
    }
}

/// What a case breaks.
pub fn breaks(case: &Case) -> Option<Broken> {
    let ready = case.ready()?;
    let alone = run::undisturbed(case, &ready);
    if case.events.is_empty() || alone.broken.is_some() {
        return alone.broken;
    }
    run::disturbed(case, &ready, &alone.measured).broken
}

/// Every case with one event, or one block, less.
fn smaller(case: &Case) -> Vec<Case> {
    let without_event = (0..case.events.len()).map(|left_out| {
        let mut case = case.clone();
        case.events.remove(left_out);
        case
    });
    let inner = 1..case.blocks.len().saturating_sub(1);
    let without_block = inner.rev().map(|left_out| {
        let mut case = case.clone();
        case.blocks.remove(left_out);
        case
    });
    without_event.chain(without_block).collect()
}
