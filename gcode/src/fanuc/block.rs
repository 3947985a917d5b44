//! What one block does: units, then tool, spindle, feed and modes, then the move or cycle, then M05, M09 and
//! stops.
//!
//! In: a [`Line`] and what it does ([`Deed`]). Out: calls. Most of it is executed as an equivalent block of
//! RS274/NGC:
//!
//! | here | there | | here | there |
//! |---|---|---|---|---|
//! | G98 G99 | G94 G95 | | G50 X Z | G92 X Z |
//! | G96 S, G50 S | G96 S D | | U W | X Z, absolute |
//! | G04 X U P | G4 P | | G10 L2, G28, G30, G52, G53 | the same |
//! | G61, G64 | G61.1, G64 | | G09 | G61.1 for one block |

use super::codes::{self, Deed};
use super::corner;
use super::execution::{Execution, target};
use super::modal::{Pending, SingleWords};
use super::{drilling, once, pecks, rates, single, stops, threads, tool};
use crate::canon::Pose;
use crate::codes::{G, M, group, m_group};
use crate::execute::Done;
use crate::problem::{Blame, Problem, Span, short};

/// Executes all but what concerns flow, contours, and the codes that come last ([`last`]).
///
/// # Errors
/// The block contradicts itself or the run.state.
pub(super) fn run(deed: Deed, run: &mut Execution) -> Done {
    let Some(pending) = run.modal.pending.take() else { return rest(deed, None, run) };
    corner::undisturbed(run.line)?;
    let next = target(run.line, pending.end)?;
    corner::close(&pending, deed, next, run)?;
    rest(deed, Some(pending.end), run)
}

/// `corner`: where the move before ended as it was programmed, if its end was cut off.
fn rest(deed: Deed, corner: Option<Pose>, run: &mut Execution) -> Done {
    units(run)?;
    side(run)?;
    if !run.modal.shape_only {
        tool::call(run.line, run.state, run.out)?;
    }
    run.begin();
    run.equivalent.comment.clone_from(&run.line.block.comment);
    rates::spindle(run)?;
    rates::feed(deed, run)?;
    modes(run)?;
    stops::modal(run.line, run.state, run.out)?;
    if let Some(code) = run.line.block.g(group::MOTION).filter(|code| acts(*code, run)) {
        if code != run.modal.motion {
            run.modal.single = SingleWords::default();
        }
        run.modal.motion = code;
    }
    // U and W count from the point as these modes show it.
    run.execute()?;
    run.begin();
    stops::begin(run.line, deed, run.state, run.out)?;
    let Deed::G(code) = deed else { return Ok(()) };
    match code.0 {
        0 | 10 | 20 | 30 => {
            let end = target(run.line, corner.unwrap_or(run.state.axes.position))?;
            travel(code, end, run)?;
            stops::end(run)
        }
        40 | 100 | 280 | 300 | 500 | 520 | 530 => {
            once::once(code, run)?;
            run.execute()
        }
        320 | 340 => threads::single_move(code, run),
        350 | 360 => threads::along_arc(code, run),
        760 => threads::cycle(run),
        900 | 920 | 940 => single::cycle(code, run),
        740 | 750 => pecks::cycle(code, run),
        810..=890 => drilling::cycle(code, run),
        _ => Ok(()),
    }
}

/// M05, M09 and stops, which act after the move.
pub(super) fn last(run: &mut Execution) -> Done {
    run.begin();
    for group in [m_group::SPINDLE, m_group::FLOOD, m_group::STOP] {
        let acts_last = |code: &M| group == m_group::STOP || matches!(code, M(5 | 9));
        let Some(code) = run.line.block.m(group).filter(acts_last) else { continue };
        if run.modal.pending.is_some() {
            return Err(corner::not_at_its_end(code));
        }
        run.add_m(group, code)?;
    }
    if run.equivalent.is_empty() { Ok(()) } else { run.execute() }
}

/// G20, G21: before all other words, which count in the new units.
pub(super) fn units(run: &mut Execution) -> Done {
    let Some(code) = run.line.block.g(group::UNITS) else { return Ok(()) };
    run.begin();
    run.add_g(group::UNITS, code)?;
    let before = run.state.units.program();
    run.execute()?;
    if run.state.units.program() != before {
        run.modal.convert(before.mm() / run.state.units.mm());
    }
    Ok(())
}

/// Whether a code of group 01 does anything in its block, or later.
fn acts(code: G, run: &mut Execution) -> bool {
    let idle = codes::is_idle(code, run.line);
    if idle && !(code == G(920) && run.line.has('S')) {
        let message = format!("{code} without X and Z does nothing: in G-code system A it is a cycle");
        let help = "coordinates are always absolute, U and W incremental: leave it out";
        run.out.warn(Problem::warning("no-effect", Blame::G(code), message, help));
    }
    !idle
}

/// Ends compensation before its time: G40 beside T lets the tool go first, and from G41 to G42 the way is by
/// G40.
fn side(run: &mut Execution) -> Done {
    let on = run.state.compensation.code();
    let ends = match run.line.block.g(group::COMPENSATION) {
        Some(G(400)) => run.line.has('T'),
        Some(code) => code != on,
        None => false,
    };
    if on == G(400) || !ends || run.modal.shape_only {
        return Ok(());
    }
    run.begin();
    run.equivalent.add_g(group::COMPENSATION, G(400), Span::default())?;
    run.execute()
}

/// Codes that are the same in both languages.
fn modes(run: &mut Execution) -> Done {
    for group in [group::PLANE, group::COORDINATES, group::COMPENSATION] {
        let Some(code) = run.line.block.g(group) else { continue };
        let again = code != G(400) && code == run.state.compensation.code();
        if group != group::COMPENSATION || !again && !run.modal.shape_only {
            run.add_g(group, code)?;
        }
    }
    for group in [m_group::MIST, m_group::FLOOD, m_group::MACHINE] {
        if let Some(code) = run.line.block.m(group).filter(|code| *code != M(9)) {
            run.add_m(group, code)?;
        }
    }
    Ok(())
}

/// G00, G01, G02, G03.
fn travel(code: G, end: Pose, run: &mut Execution) -> Done {
    let from = run.state.axes.position;
    let cut = if code == G(10) { corner::of(run.line, &from, &end)? } else { None };
    if let Some(cut) = cut {
        run.modal.pending = Some(Pending { end, cut, place: run.line.block.place() });
        return Ok(());
    }
    run.add_g(group::MOTION, code)?;
    run.add_point(&end)?;
    if matches!(code.0, 20 | 30) {
        round(run)?;
    }
    run.execute()
}

/// The words of an arc beside its end.
pub(super) fn round(run: &mut Execution) -> Done {
    if let Some(radius) = run.line.length('R').filter(|radius| *radius <= 0.0) {
        let message = format!("R{} is not a radius", short(radius));
        let help = "R is greater than 0; an arc of more than 180 degrees is written with I and K";
        return Err(Problem::error("bad-value", Blame::Word('R'), message, help));
    }
    for letter in ['I', 'K', 'R'] {
        if let Some(value) = run.line.length(letter) {
            run.add(letter, value)?;
        }
    }
    Ok(())
}
