//! Cutter radius and tool nose compensation.

use crate::block::Block;
use crate::canon::Call;
use crate::codes::G;
use crate::problem::{Blame, Problem};
use crate::state::State;

use super::{Done, Output};

/// G40, G41, G42 and the moves that wait for the next corner.
#[derive(Clone, Debug, Default)]
pub struct Compensation;

impl Compensation {
    /// Whether G41 or G42 is on.
    pub fn is_on(&self) -> bool {
        false
    }

    /// G40, G41 or G42.
    pub fn code(&self) -> G {
        G(400)
    }

    /// Converts its lengths.
    pub(crate) fn scale(&mut self, _factor: f64) {}
}

/// G40, G41, G42, G41.1, G42.1.
pub(crate) fn switch(code: G, _block: &Block, _state: &mut State, out: &mut Output) -> Done {
    if code == G(400) {
        return out.call(Call::Note("interpreter: cutter radius compensation off"));
    }
    let message = format!("{code} is not available");
    Err(Problem::error("not-available", Blame::G(code), message, "program the path of the tool's centre"))
}

/// Sends the moves that wait.
pub(crate) fn flush(_state: &mut State, _out: &mut Output) -> Done {
    Ok(())
}
