//! Speed and feed: S, G96 G97, G50 S, M03 M04; F, G98 G99.
//!
//! In: a line. Out: the words of the equivalent block: G96 with D, G94 and G95.

use super::Done;
use super::block::{Modal, span_of};
use super::codes::Deed;
use super::line::Line;
use crate::block::Block;
use crate::canon::FeedMode;
use crate::codes::{G, M, group, m_group};
use crate::execute::Output;
use crate::problem::{Blame, Problem};
use crate::state::State;

/// S, G96 G97, G50 S, M03 M04.
pub(super) fn spindle(
    line: &Line,
    modal: &mut Modal,
    equivalent: &mut Block,
    state: &State,
    out: &mut Output,
) -> Done {
    let span = span_of(line, Blame::Word('S'));
    let limit = line.block.g(group::ONCE) == Some(G(500)) && line.has('S');
    let mode = line.block.g(group::SPINDLE_MODE);
    let mut speed = line.plain('S');
    if limit {
        modal.highest = speed.take().filter(|highest| *highest > 0.0);
    }
    let surface = match mode {
        Some(code) => code == G(960),
        None => state.spindle.constant_surface.is_some(),
    };
    if let (Some(G(970)), None, true) = (mode, speed, state.spindle.constant_surface.is_some()) {
        let message = "G97 behind G96 needs S: the speed in force is a surface speed";
        return Err(Problem::error(
            "missing-word",
            Blame::G(G(970)),
            message,
            "add S in 1/min, such as G97 S1200",
        ));
    }
    if surface {
        modal.surface = speed.or(modal.surface);
        speed = speed.or(modal.surface.filter(|_| mode.is_some()));
    }
    match mode {
        Some(G(960)) => {
            if speed.is_none() {
                let message = "G96 needs S, the surface speed";
                return Err(Problem::error(
                    "missing-word",
                    Blame::G(G(960)),
                    message,
                    "add S in m/min, such as G96 S180",
                ));
            }
            if modal.highest.is_none() {
                let message =
                    "G96 without G50 S before it: nothing bounds the speed of the spindle as X comes near 0";
                let help = "give the highest speed, 1/min, such as G50 S2500";
                out.warn(Problem::warning("no-highest-speed", Blame::G(G(960)), message, help));
            }
            equivalent.add_g(group::SPINDLE_MODE, G(960), span_of(line, Blame::G(G(960))))?;
            equivalent.add('D', modal.highest.unwrap_or(1e30), span)?;
        }
        Some(code) => equivalent.add_g(group::SPINDLE_MODE, code, span_of(line, Blame::G(code)))?,
        None if limit && surface => {
            equivalent.add_g(group::SPINDLE_MODE, G(960), span)?;
            equivalent.add('D', modal.highest.unwrap_or(1e30), span)?;
            speed = Some(state.spindle.speed);
        }
        None => {}
    }
    if let Some(speed) = speed {
        equivalent.add('S', speed, span)?;
    }
    match line.block.m(m_group::SPINDLE).filter(|code| *code != M(5)) {
        Some(code) => equivalent.add_m(m_group::SPINDLE, code, span_of(line, Blame::M(code))),
        None => Ok(()),
    }
}

/// F, G98 G99. F of a thread under G98 is a lead only.
pub(super) fn feed(
    line: &Line,
    deed: Deed,
    modal: &mut Modal,
    equivalent: &mut Block,
    state: &State,
    out: &mut Output,
) -> Done {
    let mut mode = state.feed_mode;
    if let Some(code) = line.block.g(group::FEED_MODE) {
        let (new, there) = match code.0 {
            980 => (FeedMode::PerMinute, G(940)),
            _ => (FeedMode::PerRevolution, G(950)),
        };
        if new != mode {
            equivalent.add_g(group::FEED_MODE, there, span_of(line, Blame::G(code)))?;
        }
        mode = new;
    }
    let Some(value) = line.plain('F') else { return Ok(()) };
    let thread = matches!(deed, Deed::G(G(320 | 920 | 760)));
    if thread {
        modal.lead = Some(value);
    }
    if line.is_bare('F') && (thread || mode == FeedMode::PerRevolution) && value != 0.0 {
        let message = format!("F{value} has no decimal point: it is taken as {value} per revolution");
        let help = format!("some controls count hundredths or less here; write F{value}. to be sure");
        out.warn(Problem::warning("no-decimal-point", Blame::Word('F'), message, help));
    }
    if thread && mode == FeedMode::PerMinute {
        return Ok(());
    }
    equivalent.add('F', value, span_of(line, Blame::Word('F')))
}
