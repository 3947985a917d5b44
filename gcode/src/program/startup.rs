//! The block that a control executes before each program, so that what is in force is what the shop expects.
//!
//! In: [`Options::startup`]. Out: calls, before those of the first line.

use crate::block::Block;
use crate::execute::{self, Done, Output};
use crate::ngc;
use crate::options::{Dialect, Options};
use crate::problem::{Blame, Problem};
use crate::state::State;

/// Axes: what a block that nobody sees must not move.
const AXES: &str = "XYZABCUVW";

/// M codes of such a block: what stops stands already.
const STOPS: [u16; 2] = [5, 9];

/// The block, as far as it can be read.
pub(super) struct Startup {
    text: String,
    block: Result<Block, Box<Problem>>,
}

impl Startup {
    pub(super) fn read(options: &Options, state: &mut State) -> Option<Startup> {
        let text = options.startup.clone().filter(|_| options.dialect == Dialect::Linuxcnc)?;
        let block = ngc::line_alone(text.as_bytes(), state, options);
        Some(Startup { text, block })
    }

    /// Executes it. Its problems are told as such of the program, which has no line for them.
    ///
    /// # Errors
    /// What is wrong with it.
    pub(super) fn run(self, state: &mut State, out: &mut Output) -> Done {
        let Startup { text, block } = self;
        let told = |message: &str, help: &str| {
            Problem::error("bad-startup", Blame::Block, format!("the startup code `{text}`: {message}"), help)
        };
        let wrong = |problem: Box<Problem>| told(&problem.message, &problem.help);
        let block = block.map_err(wrong)?;
        if block.letters().any(|letter| AXES.contains(letter))
            || block.m_codes().any(|code| !STOPS.contains(&code.0))
        {
            let help = "leave in it what says how programs are read, as G21 G40 G90 M5 M9";
            return Err(told("it moves an axis, or it has an M code other than M5 and M9", help));
        }
        execute::execute(&block, state, out).map_err(wrong)
    }
}
