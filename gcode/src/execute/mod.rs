//! A block becomes calls, in the order of RS274/NGC.
//!
//! ```text
//! comment · spindle mode (G96, G97) · feed mode · F · S · T · M62-M68 · M6 M61 · M3 M4 M5 M19 · M70-M73
//! M7 M8 M9 · M48-M53 · G4 · plane · units · G7 G8 · G40-G42 · G43 G49 · G54-G59.3 · G61 G64 · G90 G91
//! G90.1 G91.1 · G98 G99 · G10 G28 G30 G52 G92 · G92.1-G92.3 · motion (modified by G53) · M0 M1 M2 M30 M60
//! ```
//!
//! | file | what it executes |
//! |---|---|
//! | `check.rs`, `words.rs` | refuse blocks whose words no code uses or whose codes contradict |
//! | `modes.rs`, `context.rs` | planes, units, distance, feed, path, retract modes; M70 to M73 |
//! | `spindle.rs`, `tool.rs` | S M3-M5 M19 G96 G97; T M6 M61 G43 G49 G10 L1 |
//! | `outputs.rs` | coolant, M48-M53, M62-M68 |
//! | `job.rs` | jobs, which are handed on |
//! | `coordinates.rs` | G10 L2 L20, G28 G30, G52, G54-G59.3, G92 |
//! | `straight.rs`, `arc.rs`, `feed.rs` | G0 G1 G53 polar points; G2 G3; the F they need |
//! | `spline.rs` | G5 G5.1 G5.2 G5.3 |
//! | `knots.rs` | G6.2 |
//! | `threading.rs` | G33 G33.1 G76 |
//! | `probe.rs` | G38.2 to G38.5 |
//! | `cycles/` | G73 G74 G80 to G89 |
//! | `roughing/` | G70 G71 G72 |
//! | `compensation/` | G40 to G42.1: contour offset by the radius of the tool |
//! | `refused.rs` | what a block that was refused leaves behind |
//! | `thin.rs` | depths of cut that are hardly meant |
//! | `stop.rs` | M0 M1 M60, M2 M30, end of the tape |

pub(crate) mod arc;
mod check;
pub(crate) mod compensation;
pub(crate) mod context;
mod coordinates;
mod cycles;
mod feed;
mod job;
mod kind;
mod knots;
mod modes;
pub(crate) mod output;
mod outputs;
mod probe;
pub(crate) mod refused;
pub(crate) mod roughing;
mod spindle;
mod spline;
mod stop;
pub(crate) mod straight;
pub(crate) mod thin;
pub(crate) mod threading;
mod tool;
mod words;

use crate::block::{Block, Comment, CommentKind};
use crate::canon::{Call, FeedMode, Pose};
use crate::codes::{G, group, m_group};
use crate::problem::{Blame, Problem};
use crate::state::State;

pub(crate) use job::job;
pub(crate) use kind::Kind;
pub(crate) use output::{Done, Output};
pub(crate) use stop::finish;
pub(crate) use tool::other_length;

/// What a control says before the first block: units, offsets, feed reference.
pub(crate) fn start(state: &State, out: &mut Output) -> Done {
    out.call(Call::UseLengthUnits(state.units.program()))?;
    out.call(Call::SetG5xOffset(state.axes.system(), state.axes.g5x()))?;
    out.call(Call::SetG92Offset(state.axes.g92()))?;
    out.call(Call::SetXyRotation(state.axes.rotation()))?;
    out.call(Call::SetFeedReference)?;
    out.call(Call::OnReset)
}

/// Executes one block.
///
/// # Errors
/// The block contradicts itself or the state. What stood before the error in the order of execution has been
/// sent.
pub(crate) fn execute(block: &Block, state: &mut State, out: &mut Output) -> Done {
    if state.recorder.is_on() {
        return roughing::record(block, state, out);
    }
    if block.is_empty() {
        return Ok(());
    }
    if state.spline.open.is_some() {
        spline::only_points(block, state)?;
    }
    if state.spline.knotted.is_some() {
        knots::only_blocks(block, state)?;
    }
    let motion = check::check(block, state)?;
    if let Some(comment) = block.comment.as_ref().filter(|comment| !comment.text.is_empty()) {
        say(comment, out)?;
    }
    rates(block, motion, state, out)?;
    if block.m_codes().next().is_some() {
        m_codes(block, state, out)?;
    }
    if block.g_codes().next().is_some() {
        g_codes(block, state, out)?;
    }
    if let Some(code) = motion {
        move_by(code, block, state, out)?;
        state.axes.moved();
    }
    if block.m(m_group::TOOL).is_some() {
        tool::after_change(state);
    }
    match block.m(m_group::STOP) {
        Some(code) => stop::stop(code, state, out),
        None => Ok(()),
    }
}

fn say(comment: &Comment, out: &mut Output) -> Done {
    let text = comment.text.as_str();
    out.call(match comment.kind {
        CommentKind::Plain => Call::Comment(text),
        CommentKind::Message | CommentKind::Debug => Call::Message(text),
        CommentKind::Print => Call::Print(text),
        CommentKind::Log => {
            let (verb, text) = text.split_once(',').unwrap_or((text, ""));
            Call::Log(verb, text)
        }
    })
}

/// Spindle mode, feed mode, F, S, T.
fn rates(block: &Block, motion: Option<G>, state: &mut State, out: &mut Output) -> Done {
    if let Some(code) = block.g(group::SPINDLE_MODE) {
        spindle::mode(code, block, state, out)?;
    }
    if let Some(code) = block.g(group::FEED_MODE) {
        modes::feed_mode(code, state, out)?;
    }
    modes::feed(block, motion, state, out)?;
    spindle::speed(block, state, out)?;
    tool::select(block, state, out)
}

fn m_codes(block: &Block, state: &mut State, out: &mut Output) -> Done {
    if let Some(code) = block.m(m_group::IO) {
        outputs::io(code, block, state, out)?;
    }
    if let Some(code) = block.m(m_group::MACHINE) {
        outputs::of_machine(code, state, out)?;
    }
    if let Some(code) = block.m(m_group::TOOL) {
        tool::change(code, block, state, out)?;
    }
    if let Some(code) = block.m(m_group::SPINDLE) {
        spindle::turn(code, block, state, out)?;
    }
    if let Some(code) = block.m(m_group::STATE) {
        context::save_or_restore(code, state, out)?;
    }
    outputs::coolant(block, state, out)?;
    match block.m(m_group::OVERRIDE) {
        Some(code) => outputs::overrides(code, block, state, out),
        None => Ok(()),
    }
}

/// G codes but those of motion, spindle mode and feed mode.
fn g_codes(block: &Block, state: &mut State, out: &mut Output) -> Done {
    let once = block.g(group::ONCE);
    if once == Some(G(40)) {
        out.call(Call::Dwell(block.get('P').unwrap_or(0.0)))?;
    }
    for group in [group::PLANE, group::UNITS, group::DIAMETER] {
        if let Some(code) = block.g(group) {
            modes::set(code, block, state, out)?;
        }
    }
    if let Some(code) = block.g(group::COMPENSATION) {
        compensation::switch(code, block, state, out)?;
    }
    if let Some(code) = block.g(group::TOOL_LENGTH) {
        tool::offset(code, block, state, out)?;
    }
    if let Some(code) = block.g(group::COORDINATES) {
        coordinates::system(code, state, out)?;
    }
    for group in [group::PATH, group::DISTANCE, group::ARC_DISTANCE, group::RETRACT] {
        if let Some(code) = block.g(group) {
            modes::set(code, block, state, out)?;
        }
    }
    match once {
        Some(G(100)) if matches!(block.integer('L'), Some(1 | 10 | 11)) => {
            tool::set_entry(block, state, out)?
        }
        Some(G(100)) => coordinates::set_offset(block, state, out)?,
        Some(code @ G(280 | 300)) => coordinates::home(code, block, state, out)?,
        Some(code @ G(281 | 301)) => coordinates::set_home(code, state)?,
        Some(code @ G(520 | 920)) => coordinates::shift(code, block, state, out)?,
        _ => {}
    }
    match block.g(group::SUSPENSION) {
        Some(code) => coordinates::suspend(code, state, out),
        None => Ok(()),
    }
}

/// Executes a block that is a straight move to a point and has no word but F beside it.
///
/// # Errors
/// As [`execute`].
pub(crate) fn straight_move(
    code: G,
    target: Pose,
    block: &Block,
    state: &mut State,
    out: &mut Output,
) -> Done {
    modes::feed(block, Some(code), state, out)?;
    begin_move(code, block, state, out);
    straight::to(|_| Ok(target), code, block, state, out)?;
    state.axes.moved();
    Ok(())
}

/// Motion codes.
fn move_by(code: G, block: &Block, state: &mut State, out: &mut Output) -> Done {
    begin_move(code, block, state, out);
    if code == G(800) {
        state.modes.motion = None;
        return out.call(Call::Note("motion mode set to none"));
    }
    run_motion(code, block, state, out)
}

/// `code` is that of the state from here.
fn begin_move(code: G, block: &Block, state: &mut State, out: &mut Output) {
    tool::moves(block, state, out);
    if !cycles::is_cycle(code) {
        state.cycle.end();
    }
    if code != G(50) {
        state.spline.onwards = None;
    }
    if state.modes.feed_mode == FeedMode::PerRevolution && matches!(code.0, 10 | 20 | 30) {
        spindle::must_turn(code, state, out);
    }
    state.modes.motion = Some(code);
}

fn run_motion(code: G, block: &Block, state: &mut State, out: &mut Output) -> Done {
    match code.0 {
        0 | 10 => straight::straight(code, block, state, out),
        20 | 30 => arc::arc(code, block, state, out),
        50..=53 | 62 => spline::spline(code, block, state, out),
        330 | 331 | 760 => threading::threading(code, block, state, out),
        382..=385 => probe::probe(code, block, state, out),
        700..=722 => roughing::begin(code, block, state, out),
        730 | 740 | 810..=890 => cycles::cycle(code, block, state, out),
        _ => {
            let message = format!("{code} is not available");
            Err(Problem::error("not-available", Blame::G(code), message, "write the moves it stands for"))
        }
    }
}
