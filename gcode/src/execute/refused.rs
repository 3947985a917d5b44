//! What a block that was refused leaves behind, so that the blocks after it are not blamed for it.
//!
//! In: the block and what is wrong with it. Out: the state, and the receiver, as if the rest of the block had
//! been executed: where only a word was too much, it is; else F, S, the spindle, the modes and the point that
//! the block names count. What is found wrong with the rest is not told, and nothing of it is executed.

use super::{Output, execute, modes, straight};
use crate::block::Block;
use crate::canon::{Call, Turn};
use crate::codes::{G, M, group, m_group};
use crate::problem::{Blame, Problem};
use crate::state::{SPINDLE_MAY_TURN, State};

/// So many words of a block are left out, one after the other.
const MOST_LEFT_OUT: usize = 4;

/// The word that is too much in a block; `Some(None)`: it was left out as the line was read.
pub(crate) fn too_much(problem: &Problem) -> Option<Option<char>> {
    match (problem.code, problem.blame) {
        ("unused-word" | "not-available" | "feed-in-thread" | "repeated-word", Blame::Word(letter)) => {
            Some(Some(letter))
        }
        ("repeated-word" | "unknown-m-code", Blame::Span(_)) | ("no-decimal-point", _) => Some(None),
        _ => None,
    }
}

/// Takes what a refused block would have left. The stand-alone interpreter of LinuxCNC takes nothing.
pub(crate) fn refused(problem: &Problem, block: &Block, state: &mut State, out: &mut Output) {
    if state.settings.stand_alone || state.recorder.is_on() || block.is_empty() {
        return;
    }
    out.assume(|out| leaves(problem, block, state, out));
}

fn leaves(problem: &Problem, block: &Block, state: &mut State, out: &mut Output) {
    may_turn(problem, block, state, out);
    let (mut rest, mut word) = (block.clone(), too_much(problem));
    for _ in 0..MOST_LEFT_OUT {
        match word {
            Some(Some(letter)) if rest.has(letter) => rest.remove(letter),
            Some(None) => {}
            _ => break,
        }
        if roughs(&rest) {
            break;
        }
        word = match execute(&rest, state, out) {
            Ok(()) => return,
            Err(next) => too_much(&next).filter(Option::is_some),
        };
    }
    quietly(&rest, state, out);
}

/// F, S, spindle, modes and the point of a block. What the receiver says of it is not told.
fn quietly(block: &Block, state: &mut State, out: &mut Output) {
    if let Some(code) = block.g(group::FEED_MODE) {
        let _ = modes::feed_mode(code, state, out);
    }
    turns(block.get('F'), block.get('S'), block.m(m_group::SPINDLE), state, out);
    for group in [group::PLANE, group::UNITS, group::DIAMETER, group::DISTANCE] {
        if let Some(code) = block.g(group) {
            let _ = modes::set(code, block, state, out);
        }
    }
    state.modes.motion = match block.g(group::MOTION) {
        Some(G(800)) => None,
        Some(code) if !roughs(block) => Some(code),
        _ => state.modes.motion,
    };
    state.cycle.refused |= block.g(group::MOTION).is_some_and(super::cycles::is_cycle);
    let moves = matches!(state.modes.motion, Some(G(0 | 10 | 20 | 30 | 330))) && block.has_axes();
    if moves
        && matches!(block.g(group::ONCE), None | Some(G(530)))
        && let Ok(target) = straight::target(block, state)
    {
        goes_to(target, state, out);
    }
}

/// F and S of a refused block, and M3 or M4.
pub(crate) fn turns(
    feed: Option<f64>,
    speed: Option<f64>,
    code: Option<M>,
    state: &mut State,
    out: &mut Output,
) {
    if let Some(feed) = feed.filter(|feed| *feed > 0.0) {
        state.modes.feed = feed;
        let _ = out.call(Call::SetFeedRate(feed));
    }
    if let Some(speed) = speed.map(f64::abs).filter(|speed| *speed > 0.0) {
        state.spindle.speed = speed;
        let _ = out.call(Call::SetSpindleSpeed(speed));
    }
    let turn = match code {
        Some(M(3)) => Turn::Clockwise,
        Some(M(4)) => Turn::Counterclockwise,
        _ => return,
    };
    state.spindle.turning = Some(turn);
    let _ = out.call(Call::StartSpindle(turn));
}

/// A word was misread beside one that may have started the spindle: it is taken to turn.
pub(crate) fn may_turn(problem: &Problem, block: &Block, state: &mut State, out: &mut Output) {
    let starts = matches!(block.m(m_group::SPINDLE), Some(M(3 | 4)));
    if problem.code == "unknown-m-code" || starts && state.spindle.speed == 0.0 {
        for call in state.assume(SPINDLE_MAY_TURN) {
            let _ = out.call(call);
        }
    }
}

/// The program is taken to be where a refused move was to go. A compensated contour keeps its own points.
pub(crate) fn goes_to(target: crate::canon::Pose, state: &mut State, out: &mut Output) {
    if !state.compensation.is_on() {
        state.axes.position = target;
        out.skips_to(&target);
    }
}

/// G70 to G72, whose contour would have to be read.
fn roughs(block: &Block) -> bool {
    block.g(group::MOTION).is_some_and(|code| matches!(code.0, 700..=722))
}
