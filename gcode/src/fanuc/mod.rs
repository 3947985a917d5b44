//! FANUC programs, of lathes (G-code system A; the codes of B become those of A, `system.rs`) and of mills,
//! with custom macro B.
//!
//! In: the lines of a program. Out: the same calls as from the other dialect: X of a call is a radius,
//! threads are [`Call::ThreadCycle`] or moves that follow the spindle. What a code has in common with
//! RS274/NGC is made a block of that language and executed by [`crate::execute`]; cycles send their own
//! calls.
//!
//! ```text
//! line ─► reading.rs ─ words ─► codes.rs ─ what the block does ─► block.rs ─ modes, tool, moves ─► execute
//!            │ IF GOTO WHILE · M98 G65 M99 (calls.rs)            │ cycles
//!            ▼                                                   ▼
//!         flow.rs                                     threads.rs single.rs pecks.rs contour.rs drilling.rs
//! ```
//!
//! Mills have codes and blocks of their own (`mill/`), and all the rest in common with lathes.
//!
//! X and U are diameters, I R P of cycles radii. Numbers without a decimal point count least input
//! increments, 0.001 mm or 0.0001 inch (IS-B), unless the machine says otherwise (`points.rs`). F without a
//! point is taken as mm or inch, with a warning under
//! G99: controls differ there.

mod alone;
mod block;
mod by_hand;
mod calls;
mod codes;
mod contour;
mod corner;
mod drilling;
mod execution;
mod expression;
mod first_line;
mod flow;
mod labels;
mod line;
mod mill;
mod modal;
mod once;
mod one_block;
mod pecks;
mod points;
mod rates;
mod reading;
mod shape;
mod simulator;
mod single;
mod skip;
mod stops;
mod system;
mod taps;
mod threads;
mod tool;
mod variables;

use crate::block::{Block, letter_bit, letter_bits};
use crate::canon::{Call, FeedMode, Plane};
use crate::codes::{G, M, group, m_group};
use crate::execute::{Done, Output, compensation, refused};
use crate::options::{DecimalPoint, Dialect, Options, Skips};
use crate::problem::{Blame, Problem, short};
use crate::state::State;
use crate::text::Files;
pub(crate) use alone::{line_alone, value_alone};
use calls::Behind;
use codes::Deed;
use execution::Execution;
use flow::Flow;
pub use flow::program_files;
use line::{Line, Statement};
use modal::Modal;
use points::Points;
use reading::Reading;
use simulator::Simulator;
pub use system::{in_system_a, is_system_b};
use variables::Variables;

/// A FANUC program that is being run.
pub(crate) struct Control {
    line: Line,
    variables: Variables,
    flow: Flow,
    modal: Modal,
    /// The block of RS274/NGC that is executed in place of this one.
    equivalent: Block,
    skips: Skips,
    deepest: u32,
    decimal_point: Option<DecimalPoint>,
    /// G66: what is called behind each move.
    behind: Option<Behind>,
    points: Points,
    simulator: Simulator,
    started: bool,
    /// Nothing of the program was executed so far: its O may come.
    fresh: bool,
}

impl Control {
    /// At the beginning of a program.
    pub(crate) fn new(files: Files, options: &Options) -> Control {
        Control {
            line: Line::new(options.decimal_point, options.dialect == Dialect::FanucMill),
            variables: Variables::new(&options.parameters),
            flow: Flow::new(files, options.limits.call_depth),
            modal: Modal::default(),
            equivalent: Block::default(),
            skips: options.skips,
            deepest: options.limits.expression_depth,
            decimal_point: options.decimal_point,
            points: Points::default(),
            simulator: Simulator::default(),
            behind: None,
            started: false,
            fresh: true,
        }
    }

    /// The block that was read last, to find the place of a problem.
    pub(crate) fn block(&self) -> &Block {
        &self.line.block
    }

    /// A message in the words of the program: one of system B has other names for some codes.
    pub(crate) fn in_its_words(&self, text: String) -> String {
        if self.line.is_system_b() { system::in_its_words(text) } else { text }
    }

    /// How many subprograms have been called that have not returned.
    pub(crate) fn depth(&self) -> usize {
        self.flow.depth()
    }

    /// Whether a loop is open.
    pub(crate) fn is_in_loop(&self) -> bool {
        self.flow.is_in_loop()
    }

    /// Whether a corner waits for the move that ends it.
    pub(crate) fn is_at_corner(&self) -> bool {
        self.modal.pending.is_some()
    }

    /// The files of the program.
    pub(crate) fn files(&self) -> &Files {
        &self.flow.files
    }

    /// The files of the program, to read a line again.
    pub(crate) fn files_mut(&mut self) -> &mut Files {
        &mut self.flow.files
    }

    /// The value of a common variable, #100 to #199 and #500 to #999: `None` for other numbers, `Some(None)`
    /// if it is vacant.
    pub(crate) fn shared(&self, number: u32) -> Option<Option<f64>> {
        self.variables.shared(number)
    }

    /// Something was wrong: nothing is repeated any more.
    pub(crate) fn only_look(&mut self) {
        self.flow.repeats = false;
    }

    /// Reads and executes the next line. The state tells whether it was the last.
    ///
    /// # Errors
    /// What is wrong with the line, or what the sink refuses.
    pub(crate) fn next(&mut self, state: &mut State, out: &mut Output) -> Done {
        self.statement(state, out).inspect_err(|problem| out.assume(|out| self.failed(problem, state, out)))
    }

    fn statement(&mut self, state: &mut State, out: &mut Output) -> Done {
        if !self.started {
            self.started = true;
            self.start(state, out)?;
        }
        let at = self.flow.files.mark();
        let Some(statement) = self.read(state, out)? else { return self.end_of_text(state, out) };
        let fresh = self.fresh;
        self.fresh &= matches!(statement, Statement::Nothing | Statement::Simulator(_));
        match statement {
            Statement::Nothing => self.comment(out),
            Statement::Program(_) if fresh => self.comment(out),
            Statement::Program(_) => self.end_of_text(state, out),
            Statement::Simulator(line) => self.simulator.take(line, &self.line, out),
            Statement::Block => {
                self.modal.rigid |= self.line.rigid;
                self.simulator.stock(&self.line, out)?;
                self.points.see(self.decimal_point, &mut self.line, out)?;
                if let Some(idle) = &self.line.idle {
                    let (blame, message) = (Blame::Span(idle.span), idle.message.as_str());
                    out.warn(Problem::warning("no-effect", blame, message, "leave it out"));
                }
                self.execute(state, out)?;
                self.started = !state.progress.ended;
                Ok(())
            }
            Statement::Goto(label) => self.flow.goto(label),
            Statement::While(number, holds) => self.flow.begin(number, at, holds),
            Statement::End(number) => self.flow.end(number),
            Statement::Alarm(number) => self.alarm(number, state),
            Statement::Message => {
                if let Some(pending) = self.modal.pending.take() {
                    return Err(corner::alone(&pending, "#3006"));
                }
                let text = self.line.block.comment.take().map(|comment| comment.text).unwrap_or_default();
                out.call(Call::Message(&text))?;
                out.call(Call::ProgramStop)
            }
        }
    }

    /// A block failed. What it would have left in force counts, and a contour that it would have roughed is
    /// not cut by itself: the blocks behind it are not to blame.
    fn failed(&mut self, problem: &Problem, state: &mut State, out: &mut Output) {
        if self.line.block.is_empty() {
            self.flow.lost_a_loop();
            return;
        }
        refused::may_turn(problem, &self.line.block, state, out);
        if self.without_word(problem, state, out) {
            return;
        }
        let line = &self.line;
        let speed = line.plain('S').filter(|_| line.block.g(group::ONCE) != Some(G(500)));
        refused::turns(line.plain('F'), speed, line.block.m(m_group::SPINDLE), state, out);
        if let Some(feed) = line.plain('F').filter(|feed| *feed > 0.0) {
            self.modal.lead = Some(feed);
        }
        if let Some(code) = line.block.g(group::MOTION).filter(|code| !codes::is_idle(*code, line)) {
            self.modal.motion = code;
        }
        if matches!(line.block.g(group::ONCE), Some(G(710 | 720 | 730))) {
            let label =
                |letter| line.plain(letter).filter(|number| *number > 0.0).map(|number| number as u32);
            if let (Some(first), Some(last)) = (label('P'), label('Q')) {
                self.pass_contour(first, last);
            }
        }
        self.skip_to_end(state, out);
    }

    /// Executes the block without the word that is too much in it, if that is what is wrong. What else is
    /// found is not told: the line has its error.
    fn without_word(&mut self, problem: &Problem, state: &mut State, out: &mut Output) -> bool {
        let whole = self.line.block.clone();
        match refused::too_much(problem) {
            Some(Some(letter)) if whole.has(letter) => self.line.block.remove(letter),
            Some(None) => {}
            _ => return false,
        }
        let done = self.execute(state, out);
        self.line.block = whole;
        done.is_ok()
    }

    /// The program is taken to be where the move of a refused block was to go.
    fn skip_to_end(&mut self, state: &mut State, out: &mut Output) {
        let line = &self.line;
        let moves =
            matches!(self.modal.motion, G(0 | 10 | 20 | 30 | 320 | 340 | 350 | 360)) && line.has_any("XYZUW");
        if !moves || line.block.g(group::ONCE).is_some() || self.modal.pending.is_some() {
            return;
        }
        let from = state.axes.position;
        let end = match line.mill {
            true => execution::on_mill(line, from, state.modes.incremental),
            false => match execution::target(line, from) {
                Ok(end) => end,
                Err(_) => return,
            },
        };
        refused::goes_to(end, state, out);
    }

    /// G18, X as a diameter, G99: what a lathe with G-code system A begins with. G98: what a mill does.
    fn start(&mut self, state: &mut State, out: &mut Output) -> Done {
        if self.line.mill {
            state.modes.retract_to_start = true;
            return Ok(());
        }
        state.modes.plane = Plane::Xz;
        state.modes.diameter = true;
        state.modes.feed_mode = FeedMode::PerRevolution;
        out.call(Call::SelectPlane(Plane::Xz))?;
        out.call(Call::SetFeedMode(FeedMode::PerRevolution))
    }

    /// Reads the next line; `None` at the end of the text.
    fn read(&mut self, state: &State, out: &mut Output) -> Result<Option<Statement>, Box<Problem>> {
        let file = self.flow.files.current() as u16;
        let line = match self.flow.files.take() {
            Ok(line) => line,
            Err(problem) => {
                self.line.block.clear(file, self.flow.files.mark().lines);
                return Err(problem);
            }
        };
        let Some(line) = line else { return Ok(None) };
        let mut reading = Reading {
            text: self.flow.files.bytes(&line),
            variables: &mut self.variables,
            state,
            skips: self.skips,
            deepest: self.deepest,
        };
        let statement = reading.statement(file, line.number(), &mut self.line);
        out.place = self.line.block.place();
        statement.map(Some)
    }

    fn comment(&mut self, out: &mut Output) -> Done {
        match self.line.block.comment.take() {
            Some(comment) => out.call(Call::Comment(&comment.text)),
            None => Ok(()),
        }
    }

    /// The block with all that it acts on.
    fn execution<'a, 'b>(&'a mut self, state: &'a mut State, out: &'a mut Output<'b>) -> Execution<'a, 'b> {
        let Control { line, modal, equivalent, .. } = self;
        Execution { line, modal, equivalent, state, out }
    }

    /// The code of a block that is a straight move and nothing else, as most blocks are.
    fn plain_move(&self) -> Option<G> {
        let (line, modal) = (&self.line, &self.modal);
        let words = if line.mill { letter_bits("XYZF") } else { letter_bits("XZUWF") };
        let within = line.block.present() & !words == 0 && line.block.present() & !letter_bit('F') != 0;
        let idle =
            modal.pending.is_none() && modal.drill.is_none() && modal.held.is_none() && !modal.shape_only;
        if !within || !idle || !line.block.only_moves() || line.is_bare('F') || self.behind.is_some() {
            return None;
        }
        let code = line.block.g(group::MOTION).unwrap_or(modal.motion);
        (matches!(code, G(0 | 10)) && line.idle.is_none()).then_some(code)
    }

    /// The block, and what it does to the flow.
    fn execute(&mut self, state: &mut State, out: &mut Output) -> Done {
        if let Some(code) = self.plain_move() {
            return self.execution(state, out).plain(code);
        }
        let acting = self.modal.acting(&self.line);
        let deed = match self.line.mill {
            true => mill::codes::deed(&self.line, acting)?,
            false => codes::deed(&self.line, acting)?,
        };
        match self.line.mill {
            true => mill::run(deed, &mut self.execution(state, out))?,
            false => block::run(deed, &mut self.execution(state, out))?,
        }
        if let (Deed::G(code @ G(700 | 710 | 720 | 730)), false) = (deed, self.line.mill) {
            self.contour_cycle(code, state, out)?;
            out.place = self.line.block.place();
        }
        block::last(&mut self.execution(state, out))?;
        match deed {
            Deed::M(M(98)) => self.subprogram(state),
            Deed::M(M(97)) => self.part_of_program(state),
            Deed::M(_) => self.leave(state, out),
            Deed::G(G(650)) => self.macro_call(state),
            Deed::G(G(660)) => self.behind_moves(),
            deed => self.behind_move(deed, state),
        }
    }

    /// #3000: the program ends with an error of its own.
    fn alarm(&mut self, number: f64, state: &mut State) -> Done {
        state.progress.ended = true;
        let text = self.line.block.comment.take().map(|comment| comment.text).unwrap_or_default();
        if !self.flow.repeats {
            // A jump around it may have been refused.
            return Ok(());
        }
        let message = format!("the program gives alarm {}: {text}", short(3000.0 + number));
        Err(Problem::error("alarm", Blame::Block, message, "see what the program says before #3000"))
    }

    /// The text ends, or another program begins. A text by hand may: what waits for a next move is made.
    fn end_of_text(&mut self, state: &mut State, out: &mut Output) -> Done {
        compensation::flush(state, out)?;
        state.progress.ended = true;
        if !self.flow.repeats {
            // The block that ends the program may have been wrong itself.
            return Ok(());
        }
        self.line.block.clear(self.flow.files.current() as u16, self.flow.files.mark().lines);
        let (message, help) = match self.flow.depth() {
            0 => ("the program ends without M30", "write M30 (or M02) as its last block"),
            _ => ("the subprogram ends without M99", "write M99 as its last block"),
        };
        Err(Problem::error("no-program-end", Blame::Block, message, help))
    }
}
