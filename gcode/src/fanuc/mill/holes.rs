//! G73, G74, G81 to G86, G88, G89: a hole wherever a block has the word of an axis, until G80 or G00 to G03.
//!
//! In: X Y Z R Q P, K or L times (0: the words are kept, and the first hole comes with the next block). Out:
//! the same cycle of RS274/NGC, with all its words: those of FANUC stay in force from one cycle to another.

use super::super::drilling::times;
use super::super::execution::Execution;
use super::super::modal::Held;
use super::super::once;
use super::super::points::doubt_cut;
use super::super::taps;
use crate::codes::{G, group};
use crate::execute::Done;
use crate::problem::{Blame, Problem};

/// A cycle.
///
/// # Errors
/// A word is missing or makes no sense; what the moves refuse.
pub(super) fn cycle(code: G, run: &mut Execution) -> Done {
    let incremental = run.state.modes.incremental;
    let (.., along) = run.state.modes.plane.axes();
    let depth = crate::block::AXES[along];
    let before = run.modal.held;
    // Without R the feed begins where the tool stands, as Haas has it.
    let here = if incremental { 0.0 } else { run.state.axes.position[along] };
    let same = before.filter(|held| held.incremental == incremental);
    let held = Held {
        code,
        bottom: run.line.length(depth).or(same.and_then(|held| held.bottom)),
        r: run.line.length('R').or(same.and_then(|held| held.r)).or(Some(here)),
        peck: run.line.length('Q').or(before.and_then(|held| held.peck)),
        dwell_s: once::milliseconds(run.line)?.or(before.and_then(|held| held.dwell_s)),
        incremental,
    };
    run.modal.held = Some(held);
    let times = times(run)?;
    if !run.line.has_any("XYZR")
        && let Some(letter) = ['K', 'L'].into_iter().find(|letter| run.line.has(*letter))
    {
        let message = format!("{letter} does nothing here: the block has no place of a hole");
        run.out.warn(Problem::warning("no-effect", Blame::Word(letter), message, "leave it out"));
    }
    if times == 0.0 || !run.line.has_any("XYZR") {
        return Ok(());
    }
    run.add_g(group::MOTION, code)?;
    let blame = run.span_of(Blame::G(code));
    for letter in ['X', 'Y', 'Z'].into_iter().filter(|letter| *letter != depth) {
        if let Some(value) = run.line.length(letter) {
            run.add(letter, value)?;
        }
    }
    let (pecks, waits) = (matches!(code.0, 730 | 830), matches!(code.0, 740 | 820 | 840 | 860 | 880 | 890));
    let peck = held.peck.filter(|_| pecks);
    if let Some(peck) = peck.filter(|_| run.line.has('Q')) {
        doubt_cut(("a peck", 'Q', false), peck, 0.0, run.line, run.out);
    }
    let dwell = held.dwell_s.or(Some(0.0)).filter(|_| waits);
    let idle = [('Q', pecks || matches!(code.0, 740 | 840)), ('P', waits)]
        .into_iter()
        .filter(|(letter, used)| !used && run.line.has(*letter));
    let idle: Vec<char> = idle.map(|(letter, _)| letter).collect();
    if let Some(letter) = idle.first() {
        let (those, does) =
            if idle.len() > 1 { ("Q and P".into(), "do") } else { (letter.to_string(), "does") };
        let message = format!("{those} {does} nothing in {code}, and stay for the cycles after it");
        run.out.warn(Problem::warning("no-effect", Blame::Word(*letter), message, "leave it out"));
    }
    for (letter, value) in [(depth, held.bottom), ('R', held.r), ('Q', peck), ('P', dwell)] {
        if let Some(value) = value {
            let span = run.line.block.span(Blame::Word(letter)).unwrap_or(blame);
            run.equivalent.add(letter, value, span)?;
        }
    }
    if times != 1.0 {
        run.equivalent.add('L', times, blame)?;
    }
    if matches!(code.0, 740 | 840) {
        let way =
            held.r.zip(held.bottom).map_or(0.0, |(r, bottom)| if incremental { bottom } else { bottom - r });
        let own = run.line.length('Q').or(before.filter(|held| held.code == code).and_then(|held| held.peck));
        run.state.rigid = Some(taps::rigid(code, way, own.unwrap_or(0.0), run)?);
    }
    let done = run.execute();
    run.state.rigid = None;
    done
}
