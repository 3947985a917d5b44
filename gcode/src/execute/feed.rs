//! What F must be before a move cuts, and what it becomes under G93.
//!
//! In: a block and the state. Out: nothing, or the feed in units per minute of a move that is to take `1/F`
//! minutes.

use super::{Done, Output};
use crate::block::Block;
use crate::canon::{Call, FeedMode, Pose};
use crate::problem::{Blame, Problem, short};
use crate::state::State;

/// Refuses to cut without a feed.
///
/// # Errors
/// No F, no F greater than 0 in this block (G93), no S (G95).
pub(super) fn ready(block: &Block, state: &State) -> Done {
    match state.modes.feed_mode {
        FeedMode::InverseTime if !block.has('F') => {
            let message = "under G93 every block that cuts needs an F of its own";
            let help = "add F: one divided by the minutes that the move takes; or return to G94";
            Err(Problem::error("no-feed", Blame::Block, message, help))
        }
        FeedMode::InverseTime => match block.get('F') {
            Some(feed) if feed <= 0.0 => {
                let message = format!("under G93 a move takes 1/F minutes, and F is {}", short(feed));
                Err(Problem::error("bad-value", Blame::Word('F'), message, "give a value greater than 0"))
            }
            _ => Ok(()),
        },
        _ if state.modes.feed == 0.0 => {
            let [minute, turn] = state.settings.feed_codes;
            let (blame, message) = match block.has('F') {
                true => (Blame::Word('F'), "F is 0: the move would not end"),
                false => (Blame::Block, "there is no feed for a move that cuts"),
            };
            let help = format!(
                "program F in this block or an earlier one; {minute} and {turn} forget the F before them"
            );
            Err(Problem::error("no-feed", blame, message, help))
        }
        FeedMode::PerRevolution if state.spindle.speed == 0.0 => {
            let [_, code] = state.settings.feed_codes;
            let message = format!("{code} feeds per revolution, and the spindle has no speed");
            Err(Problem::error("no-spindle-speed", Blame::Block, message, "program S with M3 or M4 first"))
        }
        _ => Ok(()),
    }
}

/// Under G93, sends the feed of a move, whose `length` from the programmed point on is asked for only then.
pub(super) fn inverse_time(
    length: impl FnOnce(&Pose) -> f64,
    block: &Block,
    state: &mut State,
    out: &mut Output,
) -> Done {
    if state.modes.feed_mode != FeedMode::InverseTime {
        return Ok(());
    }
    let feed = length(&state.axes.position) * block.get('F').unwrap_or(0.0);
    state.modes.feed = feed;
    out.call(Call::SetFeedRate(feed))
}
