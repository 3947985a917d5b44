//! S, G96 G97, M3 M4 M5 M19. There is one spindle: `$0`, or `$-1` for all.

use super::{Done, Output};
use crate::block::Block;
use crate::bounds::NO_HIGHEST_SPEED;
use crate::canon::{Call, Turn};
use crate::codes::{G, M};
use crate::problem::{Blame, Problem, short};
use crate::state::State;

/// G96 D, G97.
pub(super) fn mode(code: G, block: &Block, state: &mut State, out: &mut Output) -> Done {
    chosen(block)?;
    if code.0 == 970 {
        state.spindle.constant_surface = None;
        return out.call(Call::SetSpindleMode(0.0));
    }
    let highest = block.get('D').map_or(f64::INFINITY, f64::abs);
    if highest.is_infinite() {
        let message = "G96 without D: nothing limits the speed of the spindle as X comes near 0";
        let help = "give the highest speed, 1/min, such as G96 D2500";
        out.warn(Problem::warning("no-highest-speed", Blame::G(code), message, help));
    }
    state.spindle.constant_surface = Some(highest);
    out.call(Call::SetSpindleMode(highest.min(NO_HIGHEST_SPEED)))
}

/// S.
pub(super) fn speed(block: &Block, state: &mut State, out: &mut Output) -> Done {
    let Some(speed) = block.get('S') else { return Ok(()) };
    chosen(block)?;
    if speed < 0.0 {
        let message = format!("the spindle speed S{} is negative", short(speed));
        return Err(Problem::error(
            "bad-value",
            Blame::Word('S'),
            message,
            "M4 turns the other way; S is not negative",
        ));
    }
    state.spindle.speed = speed;
    out.call(Call::SetSpindleSpeed(speed))
}

/// M3, M4, M5, M19.
pub(super) fn turn(code: M, block: &Block, state: &mut State, out: &mut Output) -> Done {
    chosen(block)?;
    match code.0 {
        3 => begin(Turn::Clockwise, code, state, out),
        4 => begin(Turn::Counterclockwise, code, state, out),
        5 => {
            state.spindle.turning = None;
            out.call(Call::StopSpindle)
        }
        _ => orient(block, state, out),
    }
}

fn begin(turn: Turn, code: M, state: &mut State, out: &mut Output) -> Done {
    if state.spindle.speed == 0.0 {
        let message = format!("{code} starts the spindle without a speed");
        out.warn(Problem::warning(
            "no-spindle-speed",
            Blame::M(code),
            message,
            "give S in this block or an earlier one",
        ));
    }
    state.spindle.turning = Some(turn);
    out.call(Call::StartSpindle(turn))
}

/// Warns, once until the spindle is started, of a feed per revolution while it stands.
pub(super) fn must_turn(code: G, state: &mut State, out: &mut Output) {
    let standing = state.spindle.turning.is_none();
    if standing && !state.spindle.standing_feed {
        let [_, mode] = state.settings.feed_codes;
        let message = format!("{code} feeds per revolution ({mode}), and the spindle does not turn");
        out.warn(Problem::warning(
            "spindle-not-turning",
            Blame::Block,
            message,
            "start it with M3 or M4 first",
        ));
    }
    state.spindle.standing_feed = standing;
}

/// M19 R (angle, 0 if left out) P (direction) Q (time to wait). LinuxCNC's stand-alone interpreter sends
/// nothing where both R and P are left out.
fn orient(block: &Block, state: &mut State, out: &mut Output) -> Done {
    state.spindle.turning = None;
    if !state.settings.stand_alone || block.has('R') || block.has('P') {
        let direction = block.get('P').unwrap_or(0.0).round();
        let angle = block.get('R').unwrap_or(0.0) + state.settings.orient_offset;
        out.call(Call::OrientSpindle(angle % 360.0, direction as u8))?;
    }
    match block.get('Q') {
        Some(seconds) => out.call(Call::WaitSpindleOrient(seconds)),
        None => Ok(()),
    }
}

fn chosen(block: &Block) -> Done {
    match block.get('$') {
        None | Some(0.0 | -1.0) => Ok(()),
        Some(other) => {
            let message = format!("${} names a spindle that is not there: there is one, $0", short(other));
            Err(Problem::error("bad-value", Blame::Word('$'), message, "leave the word out"))
        }
    }
}
