//! FANUC and Haas mills: G17 G43 H, G54.1 P, G68, G81 to G89 with G98 and G99.
//!
//! In: a line and what it does. Out: calls. A block is executed as one or two blocks of RS274/NGC: what
//! switches, then what moves. They share flow, macros, numbers and words with lathes (`fanuc/`).
//!
//! | here | there | | here | there |
//! |---|---|---|---|---|
//! | G43 H, G44 H | G43.1 Z | | G04 X P | G4 P |
//! | G41 D, G42 D | the same, if D is in the table | | G10 L2, L10, L12 | G10 L2, L1 |
//! | G81 to G89, K or L | the same, P in s, with all words in force | | G53 | G0 G53 |
//! | G54.1 P, G10 L20 | `offsets.rs` | | G68, G69 | `rotation.rs` |

pub(super) mod codes;
mod holes;
mod offsets;
mod rotation;

use super::block as lathe;
use super::codes::{Deed, HOLES, ROTATION};
use super::execution::Execution;
use super::{once, stops};
use crate::canon::FeedMode;
use crate::codes::{G, M, group, m_group};
use crate::execute::Done;
use crate::problem::{Blame, Problem};

/// Executes all but what concerns flow and the codes that come last.
///
/// # Errors
/// The block contradicts itself or the state.
pub(super) fn run(deed: Deed, run: &mut Execution) -> Done {
    let block = &run.line.block;
    let plain = matches!(deed, Deed::G(G(0 | 10 | 20 | 30)))
        && block.m_codes().next().is_none()
        && !run.line.has_any("STDH")
        && block.g_codes().all(|code| matches!(code.0, 0 | 10 | 20 | 30))
        && block.comment.is_none();
    if !plain {
        lathe::units(run)?;
        switches(deed, run)?;
    }
    if let Some(code) = run.line.block.g(group::MOTION) {
        run.modal.motion = code;
    }
    stops::begin(run.line, deed, run.state, run.out)?;
    let Deed::G(code) = deed else { return Ok(()) };
    run.begin();
    match code.0 {
        0 | 10 | 20 | 30 => {
            travel(code, plain, run)?;
            stops::end(run)
        }
        40 => {
            let seconds = once::dwell(run.line)?;
            run.add_g(group::ONCE, code)?;
            run.equivalent.add('P', seconds, run.span_of(Blame::G(code)))?;
            run.execute()
        }
        100 => offsets::set(run),
        280 | 300 | 520 | 530 | 920 => {
            rotation::refuse_inside(code, run)?;
            if code == G(530) {
                run.equivalent.add_g(group::MOTION, G(0), run.span_of(Blame::G(code)))?;
            }
            run.add_g(group::ONCE, code)?;
            axes(run)?;
            run.execute()
        }
        680 => rotation::begin(run),
        730 | 740 | 810..=890 => holes::cycle(code, run),
        _ => Ok(()),
    }
}

/// Tool, spindle, feed, modes: what takes effect before the move.
fn switches(deed: Deed, run: &mut Execution) -> Done {
    end_side(run)?;
    run.begin();
    run.equivalent.comment.clone_from(&run.line.block.comment);
    for letter in ['S', 'T'] {
        if let Some(value) = run.line.plain(letter) {
            run.add(letter, value)?;
        }
    }
    let mode = run.line.block.g(group::FEED_MODE);
    let new = mode.map(|code| match code.0 {
        930 => FeedMode::InverseTime,
        940 => FeedMode::PerMinute,
        _ => FeedMode::PerRevolution,
    });
    if let Some(code) = mode.filter(|_| new != Some(run.state.modes.feed_mode)) {
        run.add_g(group::FEED_MODE, code)?;
    }
    // Under G93 it belongs to the move.
    let cuts = matches!(deed, Deed::G(G(10 | 20 | 30)));
    if !(cuts && new.unwrap_or(run.state.modes.feed_mode) == FeedMode::InverseTime)
        && let Some(feed) = run.line.plain('F')
    {
        run.add('F', feed)?;
    }
    let first = [group::PLANE, group::DISTANCE, group::RETRACT, group::SPINDLE_MODE];
    for code in
        first.into_iter().filter_map(|group| Some((group, run.line.block.g(group)?))).collect::<Vec<_>>()
    {
        run.add_g(code.0, code.1)?;
    }
    if run.line.block.g(HOLES) == Some(G(800)) {
        let span = run.span_of(Blame::G(G(800)));
        run.equivalent.add_g(group::MOTION, G(800), span)?;
    }
    for group in [m_group::TOOL, m_group::SPINDLE, m_group::MIST, m_group::FLOOD, m_group::MACHINE] {
        if let Some(code) = run.line.block.m(group).filter(|code| !matches!(code, M(5 | 9))) {
            run.add_m(group, code)?;
        }
    }
    run.execute()?;
    stops::modal(run.line, run.state, run.out)?;
    if run.line.block.g(ROTATION) == Some(G(690)) {
        rotation::end(run)?;
    }
    offsets::coordinates(run)?;
    offsets::length(run)?;
    offsets::radius(deed, run)
}

/// Ends compensation where a block goes from one side to the other.
fn end_side(run: &mut Execution) -> Done {
    let on = run.state.compensation.code();
    match run.line.block.g(group::COMPENSATION) {
        Some(code) if code != on && on != G(400) => {
            run.begin();
            run.equivalent.add_g(group::COMPENSATION, G(400), run.span_of(Blame::G(code)))?;
            run.execute()
        }
        _ => Ok(()),
    }
}

/// Adds the words of the axes.
fn axes(run: &mut Execution) -> Done {
    for letter in crate::block::AXES {
        let value = if matches!(letter, 'A' | 'B' | 'C') {
            run.line.degrees(letter)
        } else {
            run.line.length(letter)
        };
        if let Some(value) = value {
            run.add(letter, value)?;
        }
    }
    Ok(())
}

/// G00, G01, G02, G03. F of a `plain` block was not executed before.
fn travel(code: G, plain: bool, run: &mut Execution) -> Done {
    // A code alone moves nothing, and is in force from here on.
    if run.line.has_any("XYZABCIJKR") {
        run.add_g(group::MOTION, code)?;
    }
    axes(run)?;
    if matches!(code.0, 20 | 30) {
        for letter in ['I', 'J', 'K', 'R'] {
            if let Some(value) = run.line.length(letter) {
                run.add(letter, value)?;
            }
        }
    }
    if (plain || code != G(0) && run.state.modes.feed_mode == FeedMode::InverseTime)
        && let Some(feed) = run.line.plain('F')
    {
        run.add('F', feed)?;
    }
    run.execute()
}

/// What no move may come in between.
fn compensation_off(blame: Blame, what: &str, run: &Execution) -> Done {
    if !run.state.compensation.is_on() {
        return Ok(());
    }
    let message = format!("cannot {what} while {} is on", run.state.compensation.code());
    Err(Problem::error("compensation-on", blame, message, "end it with G40 first"))
}
