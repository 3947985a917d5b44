//! RS274/NGC as LinuxCNC speaks it.
//!
//! In: the lines of a program. Out: blocks, which [`crate::execute`] executes as they are.
//!
//! ```text
//! line ─► words ─ block ─► execute ─ calls
//!  ▲        │ O words, M98, M99
//!  └─ flow ◄┘
//! ```

mod flow;
mod words;

use crate::block::Block;
use crate::canon::{Job, Place};
use crate::codes::{M, m_group};
use crate::execute::{self, Done, Output, refused::refused, roughing};
use crate::options::Options;
use crate::problem::{Blame, Problem};
use crate::state::State;
use crate::text::{Cursor, Files, job};
use flow::{Flow, Order, Run};
use words::{LineReader, head};

/// A program that is being run.
pub(crate) struct Control {
    flow: Flow,
    words: LineReader,
    block: Block,
    block_delete: bool,
}

/// What a line holds; words are in the block.
enum Content {
    Words,
    /// An O word, or what is wrong with it.
    Control(Result<Order, Box<Problem>>),
    Job(Job),
    /// It is left out.
    Nothing,
    End,
}

/// Reads one line at the start of a program, see [`crate::alone::line`].
///
/// # Errors
/// What is wrong with it.
pub(crate) fn line_alone(text: &[u8], state: &mut State, options: &Options) -> Result<Block, Box<Problem>> {
    let mut block = Block::default();
    let mut cursor = Cursor::new(text);
    let head = head(&mut cursor)?;
    block.begin(0, 1, head.number);
    if cursor.peek() != Some(b'o') {
        LineReader::new(options.limits.expression_depth).words(&mut cursor, state, &mut block)?;
    }
    Ok(block)
}

/// Computes one value, see [`crate::alone::value`].
///
/// # Errors
/// It is missing, or cannot be computed.
pub(crate) fn value_alone(
    cursor: &mut Cursor,
    state: &State,
    options: &Options,
) -> Result<f64, Box<Problem>> {
    LineReader::new(options.limits.expression_depth).values(state).value(cursor)
}

impl Control {
    /// At the beginning of a program.
    pub(crate) fn new(files: Files, options: &Options) -> Control {
        Control {
            flow: Flow::new(files, options.skips.is_on(1), options.limits.call_depth),
            words: LineReader::new(options.limits.expression_depth),
            block: Block::default(),
            block_delete: options.skips.is_on(1),
        }
    }

    /// The block that was read last, to find the place of a problem.
    pub(crate) fn block(&self) -> &Block {
        &self.block
    }

    /// How many subroutines have been called that have not returned.
    pub(crate) fn depth(&self) -> usize {
        self.flow.depth()
    }

    /// Whether a loop is open.
    pub(crate) fn is_in_loop(&self) -> bool {
        self.flow.is_in_loop()
    }

    /// The files of the program.
    pub(crate) fn files(&self) -> &Files {
        &self.flow.files
    }

    /// The files of the program, to read a line again.
    pub(crate) fn files_mut(&mut self) -> &mut Files {
        &mut self.flow.files
    }

    /// Something was wrong: nothing is repeated any more, and the stand-alone interpreter gives up all calls.
    pub(crate) fn only_look(&mut self, state: &mut State) {
        self.flow.repeats = false;
        if state.settings.stand_alone {
            self.flow.end_calls(state);
        }
    }

    /// Reads and executes the next line.
    ///
    /// # Errors
    /// What is wrong with the line, or what the sink refuses.
    pub(crate) fn next(&mut self, state: &mut State, out: &mut Output) -> Done {
        let content = self.read(state);
        out.place = self.block.place();
        out.warn_all(&mut self.words.warnings);
        let done = match content {
            Ok(Content::Words) => self.execute(state, out),
            Ok(Content::Control(order)) => self.control(order, state, out),
            Ok(Content::Job(job)) => {
                out.place = Place { line: job.line, ..out.place };
                execute::job(&job, state, out)
            }
            Ok(Content::Nothing) => Ok(()),
            Ok(Content::End) => self.end_of_file(state, out),
            Err(problem) => Err(problem),
        };
        done.inspect_err(|problem| refused(problem, &self.block, state, out))
    }

    /// Reads the next line.
    fn read(&mut self, state: &mut State) -> Result<Content, Box<Problem>> {
        let repeating = self.flow.is_repeating();
        if repeating && let Some(known) = self.flow.read_again(&mut self.words, state, &mut self.block) {
            return Ok(known?.map_or(Content::Words, |order| Content::Control(Ok(order))));
        }
        let file = self.flow.files.current() as u16;
        let line = match self.flow.files.take() {
            Ok(Some(line)) => line,
            Ok(None) => return Ok(Content::End),
            Err(problem) => {
                self.block.clear(file, self.flow.files.mark().lines);
                return Err(problem);
            }
        };
        self.block.clear(file, line.number());
        state.progress.line = line.number();
        if job::begins(self.flow.files.bytes(&line)) {
            return job::read(&mut self.flow.files, &line).map(Content::Job);
        }
        let mut cursor = Cursor::new(self.flow.files.bytes(&line));
        let head = head(&mut cursor)?;
        if head.optional && self.block_delete {
            return Ok(Content::Nothing);
        }
        self.block.begin(file, line.number(), head.number);
        self.words.notes.begin(repeating);
        if cursor.peek() == Some(b'o') {
            return Ok(Content::Control(self.flow.read(&line, &mut self.words, state)));
        }
        self.words.words(&mut cursor, state, &mut self.block)?;
        self.flow.remember_words(&line, head, &mut self.words);
        Ok(Content::Words)
    }

    /// Executes an O word.
    fn control(&mut self, order: Result<Order, Box<Problem>>, state: &mut State, out: &mut Output) -> Done {
        let mut run = Run { words: &mut self.words, state, out };
        let done = order.and_then(|order| self.flow.control(&order, &mut run));
        match state.recorder.is_on() {
            true => roughing::end(done, state, out),
            false => done,
        }
    }

    /// Executes the block.
    fn execute(&mut self, state: &mut State, out: &mut Output) -> Done {
        if let Some(code) = self.block.m(m_group::CALL).filter(|_| state.settings.no_fanuc_subs) {
            let message =
                format!("{code} is switched off: DISABLE_FANUC_STYLE_SUB of the machine description");
            let help = "write the subroutine as o100 sub … o100 endsub, and call it by o100 call";
            return Err(Problem::error("not-available", Blame::M(code), message, help));
        }
        execute::execute(&self.block, state, out)?;
        self.flow.begun = self.flow.begun || self.block.has_words();
        let mut run = Run { words: &mut self.words, state, out };
        if run.state.progress.ended {
            return self.flow.check_ends_exist(&mut run);
        }
        if let Some(number) = run.state.recorder.take_call() {
            let called = self.flow.call_number(number, &mut run);
            return called.inspect_err(|_| state.recorder.cancel());
        }
        match self.block.m(m_group::CALL) {
            None => Ok(()),
            Some(M(98)) => self.flow.m98(&self.block, &mut run),
            Some(_) => self.flow.m99(&mut run),
        }
    }

    fn end_of_file(&mut self, state: &mut State, out: &mut Output) -> Done {
        let mut ended = self.flow.end(&mut Run { words: &mut self.words, state, out });
        if state.recorder.is_on() {
            ended = roughing::end(ended, state, out);
        }
        ended?;
        execute::finish(state, out)
    }
}
