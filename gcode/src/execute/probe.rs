//! Probing moves: G38.2 to G38.5.
//!
//! Nothing here can touch. The moves are sent for a receiver that can show them; the point that is touched is
//! taken to be their end, as LinuxCNC's stand-alone interpreter has it, and the tool to stand a little short
//! of it.

use super::{Done, Output, straight};
use crate::block::Block;
use crate::canon::{Call, FeedMode, X, Y, Z};
use crate::codes::G;
use crate::problem::{Blame, Problem};
use crate::state::State;

/// How far the tool stands from the point it touched, mm.
const BACK: f64 = 0.254;
/// #5061 to #5069: the point that was touched.
const TOUCHED: u32 = 5061;
/// #5070: whether anything was.
const FOUND: u32 = 5070;

/// G38.2, G38.3 (towards), G38.4, G38.5 (away); the odd ones do without contact.
pub(super) fn probe(code: G, block: &Block, state: &mut State, out: &mut Output) -> Done {
    let refuse = |kind, message: &str, help: &str| Err(Problem::error(kind, Blame::G(code), message, help));
    straight::some_axis(code, block)?;
    if state.compensation.is_on() {
        return refuse("not-available", "no probing while G41 or G42 is on", "switch it off with G40 first");
    }
    if state.modes.feed_mode == FeedMode::PerRevolution {
        return refuse("bad-value", "no probing with a feed per revolution (G95)", "select G94 and give F");
    }
    if state.modes.feed == 0.0 {
        return refuse(
            "no-feed",
            "there is no feed to probe with",
            "program F in this block or an earlier one",
        );
    }
    let target = straight::target(block, state)?;
    if code.0.is_multiple_of(2) && target == state.axes.position {
        return refuse("bad-value", "the tool stands at the end of the probing move", "move it away first");
    }
    out.call(Call::StraightProbe((code.0 % 10) as u8, target))?;
    for (index, value) in (TOUCHED..FOUND).zip(target.into_iter().chain([0.0; 3])) {
        state.set_parameter(index, value);
    }
    state.set_parameter(FOUND, 0.0);
    let way = [X, Y, Z].map(|axis| state.axes.position[axis] - target[axis]);
    let length = way.iter().map(|way| way * way).sum::<f64>().sqrt();
    state.axes.position = target;
    if length > 0.0 {
        for axis in [X, Y, Z] {
            state.axes.position[axis] += BACK / state.units.mm() * way[axis] / length;
        }
    }
    Ok(())
}
