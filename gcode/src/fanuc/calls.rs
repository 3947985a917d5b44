//! Subprograms and macros: M98, M97, G65, G66 and G67, M99.
//!
//! In: P (a program, or N of a block), L (how often), arguments. Out: where the program goes on, and the
//! local variables there.

use super::Control;
use super::codes::{self, Deed};
use super::flow::Left;
use super::variables::Locals;
use crate::codes::{G, M, m_group};
use crate::execute::{Done, Output};
use crate::problem::{Blame, Problem, Span};
use crate::state::State;

/// What G66 calls, and in which program.
#[derive(Clone, Copy)]
pub(super) struct Behind {
    program: i64,
    times: i64,
    arguments: Locals,
    /// Depth of the calls where G66 stands.
    depth: usize,
}

impl Control {
    /// M98 P L: four digits of P are the program, those before them how often, unless L tells.
    pub(super) fn subprogram(&mut self, state: &mut State) -> Done {
        let (program, times) = (self.line.whole('P')?, self.line.whole('L')?);
        let (program, times) = match (program, times) {
            (Some(word @ 10_000..), None) => (word % 10_000, word / 10_000),
            (Some(program), times) => (program, times.unwrap_or(1)),
            (None, _) => (0, 1),
        };
        self.call(program, times, false, state).map(|_| ())
    }

    /// G65 P L with arguments.
    pub(super) fn macro_call(&mut self, state: &mut State) -> Done {
        let (program, times) = (self.line.whole('P')?, self.line.whole('L')?);
        if self.call(program.unwrap_or(0), times.unwrap_or(1), true, state)? {
            self.variables.enter(self.line.arguments.take().map_or([None; 34], |arguments| *arguments));
        }
        Ok(())
    }

    /// M97 P L: from the block with N P on, to M99.
    pub(super) fn part_of_program(&mut self, state: &mut State) -> Done {
        let label = self.line.whole('P')?.and_then(|label| u32::try_from(label).ok()).unwrap_or(0);
        let times = self.line.whole('L')?.unwrap_or(1);
        let Some(times) = u32::try_from(times).ok().filter(|times| *times <= 9999) else {
            return Err(not_a_call("M97 P100 L2: P is N of a block of this program"));
        };
        self.flow.call_block(label, times)?;
        state.progress.call_level = self.flow.depth() as u32;
        Ok(())
    }

    /// G66 P L: a macro is called behind each move, to G67.
    pub(super) fn behind_moves(&mut self) -> Done {
        let (program, times) = (self.line.whole('P')?.unwrap_or(0), self.line.whole('L')?.unwrap_or(1));
        let arguments = self.line.arguments.take().map_or([None; 34], |arguments| *arguments);
        self.behind = Some(Behind { program, times, arguments, depth: self.flow.depth() });
        Ok(())
    }

    /// Calls the macro of G66 if the block was a move of the program that has G66.
    pub(super) fn behind_move(&mut self, deed: Deed, state: &mut State) -> Done {
        if self.line.block.g(codes::MACRO) == Some(G(670)) {
            self.behind = None;
        }
        let Some(Behind { program, times, arguments, depth }) = self.behind else { return Ok(()) };
        let moved = matches!(deed, Deed::G(G(0 | 10 | 20 | 30))) && self.line.has_any("XYZUWABC");
        if !moved || depth != self.flow.depth() {
            return Ok(());
        }
        if self.call(program, times, true, state)? {
            self.variables.enter(arguments);
        }
        Ok(())
    }

    /// Whether the program is entered.
    fn call(
        &mut self,
        program: i64,
        times: i64,
        is_macro: bool,
        state: &mut State,
    ) -> Result<bool, Box<Problem>> {
        let (Ok(program @ 1..), Ok(times @ 0..=9999)) = (u32::try_from(program), u32::try_from(times)) else {
            let help = "P is the number of the program, L (up to 9999) how often it is run: M98 P1000 L2";
            return Err(not_a_call(help));
        };
        let entered = self.flow.call(program, times, is_macro)?;
        self.fresh = self.flow.at_beginning();
        state.progress.call_level = self.flow.depth() as u32;
        Ok(entered)
    }

    /// M99, with P: back to that block of the caller. In the main program it begins anew, which is done once.
    pub(super) fn leave(&mut self, state: &mut State, out: &mut Output) -> Done {
        let label = self.line.whole('P')?.and_then(|label| u32::try_from(label).ok());
        let left = self.flow.leave(label)?;
        state.progress.call_level = self.flow.depth() as u32;
        self.fresh = self.flow.at_beginning();
        match left {
            Left::MacroAgain => self.variables.again(),
            Left::Macro => self.variables.leave(),
            Left::Again | Left::Subprogram => {}
            Left::Main => {
                let message = "M99 repeats the main program for ever: here it runs once";
                out.warn(Problem::warning("no-effect", Blame::M(M(99)), message, "end it with M30"));
                let mut run = self.execution(state, out);
                run.begin();
                run.equivalent.add_m(m_group::STOP, M(2), Span::default())?;
                return run.execute();
            }
        }
        Ok(())
    }
}

fn not_a_call(help: &str) -> Box<Problem> {
    Problem::error("bad-value", Blame::Word('P'), "this does not name a program to call", help)
}
