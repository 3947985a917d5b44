//! G74 and G75: grooves and holes, cut in pecks along Z (G74) or X (G75), one beside the other along the
//! other axis.
//!
//! In: `G74 R(e)`, then `G74 X Z P(Δi) Q(Δk) R(Δd) F`. P (along X, a radius) and Q (along Z) are lengths in
//! least increments. In one block they are I and K, `G75 X Z I(Δi) K(Δk) F`, and e is 0.1 mm, 0.004 inch.
//! Out: for each column, pecks that go back by e, the way out, and the step to the next column. At the bottom
//! the tool moves aside by Δd before it goes back.

use super::execution::{Execution, target};
use super::line::Line;
use super::points::doubt_cut;
use crate::bounds::MOST_PECKS;
use crate::canon::{X, Z};
use crate::codes::G;
use crate::execute::{Done, Output};
use crate::problem::{Blame, Problem, short};
use crate::state::State;

/// e of a cycle in one block, mm and inch.
const BACK: [f64; 2] = [0.1, 0.004];

/// One axis of the cycle.
#[derive(Clone, Copy)]
struct Way {
    from: f64,
    to: f64,
    /// 0: in one go.
    step: f64,
}

impl Way {
    fn sign(&self) -> f64 {
        if self.to < self.from { -1.0 } else { 1.0 }
    }

    /// How many steps it takes.
    fn count(&self) -> f64 {
        let way = (self.to - self.from).abs();
        if self.step > 0.0 { (way / self.step - 1e-9).ceil().max(1.0) } else { 1.0 }
    }

    /// Where step `n` ends; the last one at the end.
    fn at(&self, n: f64) -> f64 {
        if n >= self.count() { self.to } else { self.from + self.sign() * self.step * n }
    }
}

/// The way of the cut and the way across it.
fn ways(code: G, line: &Line, state: &State, out: &mut Output) -> Result<(Way, Way), Box<Problem>> {
    let end = target(line, state.axes.position)?;
    let [x, z] = [('P', 'I', X), ('Q', 'K', Z)].map(|(bare, letter, axis)| {
        let (letter, step) = match line.length(letter) {
            Some(step) => (letter, step),
            None => (bare, line.increments(bare)?.unwrap_or(0.0)),
        };
        if step < 0.0 {
            let message = format!("{letter} is {}", short(step));
            return Err(Problem::error("bad-value", Blame::Word(letter), message, "give 0 or more"));
        }
        Ok(Way { from: state.axes.position[axis], to: end[axis], step })
    });
    let along_z = code == G(740);
    let (cut, beside) = if along_z { (z?, x?) } else { (x?, z?) };
    let written = |own, counted| if line.has(own) { own } else { counted };
    let (by_x, by_z) = (written('I', 'P'), written('K', 'Q'));
    let (peck, across) = if along_z { (by_z, by_x) } else { (by_x, by_z) };
    if cut.to == cut.from {
        let message = format!("{code} cuts nothing: it ends where it begins");
        let help = format!("add {}", if along_z { "Z or W" } else { "X or U" });
        return Err(Problem::error("missing-word", Blame::G(code), message, help));
    }
    if cut.count() * columns(&beside) > MOST_PECKS {
        let message = format!("this would take more than {MOST_PECKS} pecks");
        return Err(Problem::error(
            "bad-value",
            Blame::Word(peck),
            message,
            format!("give a greater {peck}"),
        ));
    }
    for (what, letter, way) in [("a peck", peck, cut), ("the step aside", across, beside)] {
        if line.has(letter) && way.to != way.from {
            doubt_cut((what, letter, "PQ".contains(letter)), way.step, way.count(), line, out);
        }
    }
    Ok((cut, beside))
}

/// G74, G75.
///
/// # Errors
/// A word is missing or makes no sense; what the moves refuse.
pub(super) fn cycle(code: G, run: &mut Execution) -> Done {
    let retract = run.line.length('R');
    if !run.line.has_any("XZUWPQIK") {
        let Some(retract) = retract.filter(|retract| *retract >= 0.0) else {
            let message = format!("the first line of {code} needs R, how far a peck goes back");
            return Err(Problem::error("missing-word", Blame::G(code), message, "add R, such as R0.5"));
        };
        run.modal.first.retract = Some(retract);
        return Ok(());
    }
    let in_one_block = run.line.has_any("IK");
    if let Some((bare, letter)) =
        [('P', 'I'), ('Q', 'K')].into_iter().find(|(bare, _)| in_one_block && run.line.has(*bare))
    {
        let message = format!("{bare} beside I or K: {code} has its steps by P and Q, or by I and K");
        let help = format!("write {letter} in place of {bare}");
        return Err(Problem::error("unused-word", Blame::Word(bare), message, help));
    }
    let usual = BACK[usize::from(run.line.unit() == "inch")];
    let told = if in_one_block { Some(usual) } else { run.modal.first.retract };
    let back = told.unwrap_or(usual);
    if told.is_none() && run.line.has_any("PQ") {
        let message = format!("no {code} R was before this: a peck goes back by {usual} {}", run.line.unit());
        let help = format!("write {code} R0.5 before it, or what the parameter of the control says");
        run.out.warn(Problem::warning("no-first-line", Blame::G(code), message, help));
    }
    let along_z = code == G(740);
    let (cut, beside) = ways(code, run.line, run.state, run.out)?;
    let (axes, step, help) = match along_z {
        true => ("XU", if in_one_block { 'I' } else { 'P' }, "leave it out, or add X or U"),
        false => ("ZW", if in_one_block { 'K' } else { 'Q' }, "leave it out, or add Z or W"),
    };
    if run.line.has(step) && !run.line.has_any(axes) && beside.step > 0.0 {
        let message = format!("{step} does nothing here: the block has one cut, and goes nowhere beside it");
        run.out.warn(Problem::warning("no-effect", Blame::Word(step), message, help));
    }
    let aside = if beside.to == beside.from {
        retract.unwrap_or(0.0)
    } else {
        -beside.sign() * retract.unwrap_or(0.0)
    };
    let place = run.line.block.place();
    let mut go = |kind, along: f64, across: f64| {
        let end = if along_z { [along, across] } else { [across, along] };
        run.go(kind, end, None, place)
    };
    let (rapid, feed) = (G(0), G(10));
    let mut column = 0.0;
    while column < columns(&beside) {
        let across = beside.at(column);
        if column > 0.0 {
            go(rapid, cut.from, across)?;
        }
        let mut n = 1.0;
        while n <= cut.count() {
            go(feed, cut.at(n), across)?;
            if n < cut.count() && back > 0.0 {
                go(rapid, cut.at(n) - cut.sign() * back, across)?;
            }
            n += 1.0;
        }
        if aside != 0.0 {
            go(rapid, cut.to, across + aside)?;
        }
        go(rapid, cut.from, across + aside)?;
        column += 1.0;
    }
    go(rapid, cut.from, beside.from)
}

/// How many columns there are: one at the beginning, and one for each step.
fn columns(beside: &Way) -> f64 {
    if beside.to == beside.from { 1.0 } else { beside.count() + 1.0 }
}
