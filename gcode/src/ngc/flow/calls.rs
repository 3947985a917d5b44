//! sub, call, return; M98 and M99. In: the label of a subroutine and its arguments. Out: the line that comes
//! next.
//!
//! A subroutine is looked for among those that were met before, then as a file of its name, then in the rest
//! of the file that calls it.

use super::control::{Control, Keyword};
use super::labels::{Definition, Label, Style};
use super::skip::Goal;
use super::{Done, Flow, Here, Run};
use crate::block::Block;
use crate::codes::M;
use crate::execute::context;
use crate::problem::{Blame, Problem, short};
use crate::state::State;
use crate::state::memory::Arguments;
use crate::text::{Mark, whole};

/// A subroutine that is being executed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    label: Label,
    definition: Definition,
    /// Where it was called from.
    file: usize,
    back: Mark,
    /// What was open there.
    pub(super) opens: usize,
    /// M98 L: turns that are left.
    left: u64,
}

/// A subroutine that is to be entered, and how often it is executed.
struct Entry {
    label: Label,
    definition: Definition,
    turns: u32,
}

impl Flow {
    /// The definition of a subroutine, reached in the course of the program: it is passed over.
    pub(super) fn pass_over(&mut self, here: Here, run: &mut Run) -> Done {
        let Here { label, at } = here;
        let name = self.labels.text(label);
        if let Some(frame) = self.frames.last() {
            let outer = self.labels.text(frame.label);
            let message = format!("{name} sub begins inside of {outer}");
            let help = format!("end {outer} first, and call {name} from it");
            return Err(Problem::error("nested-subroutine", Blame::Block, message, help));
        }
        let file = self.files.current();
        let found = Definition { style: Style::Sub, file, line: at.lines + 1, body: self.files.mark() };
        let first = self.labels.define(label, found);
        let end = self.find(here, Goal::EndSub, run)?;
        self.files.go(file, end.next)?;
        if first == found {
            return Ok(());
        }
        let name = self.labels.text(label);
        let message = format!("{name} is defined twice: first in {}", self.place(first));
        Err(Problem::error("nested-subroutine", Blame::Block, message, "give one of them another name"))
    }

    fn place(&self, definition: Definition) -> String {
        let file = self.files.get(definition.file).map_or("", |source| source.name());
        format!("line {} of {file}", definition.line)
    }

    pub(super) fn call(&mut self, label: Label, arguments: &Arguments, run: &mut Run) -> Done {
        let definition = self.resolve(label, Style::Sub, run)?;
        self.enter(Entry { label, definition, turns: 1 }, Some(arguments), run.state)
    }

    /// Calls the subroutine of a number, without arguments.
    ///
    /// # Errors
    /// There is no such subroutine; calls are too deep.
    pub(crate) fn call_number(&mut self, number: u32, run: &mut Run) -> Done {
        let label = self.labels.number(number);
        self.call(label, &Arguments::NONE, run)
    }

    /// M98: `P` is the label, `L` how often.
    ///
    /// # Errors
    /// P is missing or not a label; there is no such program; calls are too deep.
    pub(crate) fn m98(&mut self, block: &Block, run: &mut Run) -> Done {
        let Some(number) = block.get('P') else {
            let help = "M98 P100 calls the program that begins with o100";
            return Err(Problem::error("missing-word", Blame::M(M(98)), "M98 has no P word", help));
        };
        let count = |letter: char, value: f64| {
            whole(value).and_then(|value| u32::try_from(value).ok()).ok_or_else(|| {
                let message = format!("{letter}{} is not a whole number that M98 can use", short(value));
                let help = "P is the number of a program, L how often it is called";
                Problem::error("bad-value", Blame::Word(letter), message, help)
            })
        };
        let label = self.labels.number(count('P', number)?);
        let turns = count('L', block.get('L').unwrap_or(1.0))?;
        if turns == 0 {
            return Ok(());
        }
        let definition = self.resolve(label, Style::Program, run)?;
        self.enter(Entry { label, definition, turns }, None, run.state)
    }

    /// A bare `o100` in front of everything is the name of the program, and M98 enters at another one. One
    /// that the program runs into is a keyword that was forgotten, or an M2.
    pub(super) fn warn_of_a_bare_label(&self, label: Label, run: &mut Run) {
        if !self.begun || !self.frames.is_empty() {
            return;
        }
        let name = self.labels.text(label);
        let message =
            format!("{name} without a keyword does nothing here: the program runs on into what follows");
        let number = name.trim_start_matches('o');
        let help = format!(
            "write its keyword, as in {name} call; or M2 above it, if it begins what M98 P{number} calls"
        );
        run.out.warn(Problem::warning("no-effect", Blame::Block, message, help));
    }

    /// Where a subroutine is.
    fn resolve(&mut self, label: Label, style: Style, run: &mut Run) -> Result<Definition, Box<Problem>> {
        let definition = match self.labels.definition(label) {
            Some(definition) => definition,
            None => self.search_for(label, style, run)?,
        };
        if definition.style == style {
            return Ok(definition);
        }
        let name = self.labels.text(label);
        let (how, help) = match definition.style {
            Style::Sub => ("sub", format!("call it by {name} call")),
            Style::Program => {
                ("the beginning of a program", format!("call it by M98 P{}", &name.trim_start_matches('o')))
            }
        };
        let message =
            format!("{name} in {} is {how}, which is called in another way", self.place(definition));
        Err(Problem::error("wrong-call", Blame::Block, message, help))
    }

    /// `call` in a subroutine file does not reach what stands further down in it: newer tests of LinuxCNC ask
    /// for that.
    fn search_for(&mut self, label: Label, style: Style, run: &mut Run) -> Result<Definition, Box<Problem>> {
        let stem = self.labels.file_stem(label).to_owned();
        if let Some(file) = self.files.open(&stem)? {
            let (caller, back) = (self.files.current(), self.files.mark());
            let beginning = self.files.get(file).map_or(Mark::default(), |source| source.beginning());
            self.files.go(file, beginning)?;
            self.search_definitions(Some(label), run)?;
            self.files.go(caller, back)?;
        } else if style == Style::Program || self.files.current() == 0 {
            self.search_definitions(None, run)?;
        }
        self.labels.definition(label).ok_or_else(|| {
            let name = self.labels.text(label);
            let files: Vec<String> =
                self.files.candidates(&stem).iter().map(|path| path.display().to_string()).collect();
            let message = match files.as_slice() {
                [] => format!("there is no subroutine {name} in this file"),
                files => {
                    format!("there is no subroutine {name}, neither in this file nor in {}", files.join(", "))
                }
            };
            let help = match self.files.current() {
                0 => "define it, put its file into a folder for subroutines, or correct the label",
                _ => "put it into a file of its own, or before the subroutine that this file is named after",
            };
            Problem::error("no-subroutine", Blame::Block, message, help)
        })
    }

    fn enter(&mut self, entry: Entry, arguments: Option<&Arguments>, state: &mut State) -> Done {
        let Entry { label, definition, turns } = entry;
        let is_inside = self.frames.iter().any(|frame| frame.label == label);
        if !self.repeats && (is_inside || !self.labels.look(label)) {
            return Ok(());
        }
        if self.frames.len() >= self.deepest as usize {
            let name = self.labels.text(label);
            let message = format!(
                "{name} would be call number {} inside each other: the limit call_depth",
                self.frames.len() + 1
            );
            let help = "end the recursion by an if, or make a loop of it";
            return Err(Problem::error("calls-too-deep", Blame::Block, message, help));
        }
        let (file, back) = (self.files.current(), self.files.mark());
        let (opens, left) = (self.opens.len(), u64::from(turns) - 1);
        self.frames.push(Frame { label, definition, file, back, opens, left });
        state.memory.enter(arguments);
        state.progress.call_level += 1;
        context::on_call(state);
        self.files.go(definition.file, definition.body)
    }

    /// return and endsub.
    pub(super) fn end_sub(&mut self, control: Control, value: Option<f64>, run: &mut Run) -> Done {
        let keyword = control.keyword.text();
        let name = self.labels.text(control.label);
        match self.frames.last() {
            // LinuxCNC looks at the label of endsub only.
            Some(frame)
                if frame.definition.style == Style::Sub
                    && (frame.label == control.label || control.keyword == Keyword::Return) => {}
            Some(frame) => {
                let inside = self.labels.text(frame.label);
                let end = if frame.definition.style == Style::Sub { keyword } else { "M99" };
                let message = format!("{name} {keyword} stands in {inside}");
                let help = format!("{inside} ends with {end}");
                return Err(Problem::error("unmatched", Blame::Block, message, help));
            }
            None => {
                let message = format!("{name} {keyword} stands outside of a subroutine");
                let help = format!("add {name} sub where it begins, or correct the label");
                return Err(Problem::error("unmatched", Blame::Block, message, help));
            }
        }
        let closed = if control.keyword == Keyword::EndSub { self.check_closed() } else { Ok(()) };
        run.state.memory.set_named("_value", value.unwrap_or(0.0));
        run.state.memory.set_named("_value_returned", f64::from(value.is_some()));
        self.leave(run)?;
        closed
    }

    /// M99 in a program that M98 called.
    ///
    /// # Errors
    /// The subroutine was called in another way.
    pub(crate) fn m99(&mut self, run: &mut Run) -> Done {
        let Some(frame) = self.frames.last_mut() else { return Ok(()) };
        let (definition, label) = (frame.definition, frame.label);
        if definition.style == Style::Sub {
            let name = self.labels.text(label);
            let message = format!("M99 stands in {name} sub");
            return Err(Problem::error(
                "unmatched",
                Blame::M(M(99)),
                message,
                format!("end it with {name} endsub"),
            ));
        }
        match frame.left.checked_sub(1).filter(|_| self.repeats) {
            Some(left) => {
                frame.left = left;
                self.opens.truncate(frame.opens);
                let restored = context::on_return(run.state, run.out);
                run.state.memory.leave(false);
                run.state.memory.enter(None);
                context::on_call(run.state);
                self.files.go(definition.file, definition.body)?;
                restored
            }
            None => self.leave(run),
        }
    }

    /// Goes on after the call.
    fn leave(&mut self, run: &mut Run) -> Done {
        let Some(frame) = self.frames.pop() else { return Ok(()) };
        self.opens.truncate(frame.opens);
        let restored = context::on_return(run.state, run.out);
        run.state.memory.leave(frame.definition.style == Style::Sub);
        run.state.progress.call_level = run.state.progress.call_level.saturating_sub(1);
        self.files.go(frame.file, frame.back)?;
        restored
    }

    /// Gives up all calls: the program goes on after the outermost one. A place that cannot be gone to is
    /// reported when the next line is taken.
    pub(crate) fn end_calls(&mut self, state: &mut State) {
        while let Some(frame) = self.frames.pop() {
            self.opens.truncate(frame.opens);
            state.memory.leave(frame.definition.style == Style::Sub);
            state.progress.call_level = state.progress.call_level.saturating_sub(1);
            let _ = self.files.go(frame.file, frame.back);
        }
    }

    /// The end of a file.
    ///
    /// # Errors
    /// The subroutine, an if or a loop is not ended; it is given up, so that the next call goes on after it.
    /// Or the program has no end.
    pub(crate) fn end(&mut self, run: &mut Run) -> Done {
        self.check_closed()?;
        if let Some(frame) = self.frames.last() {
            let name = self.labels.text(frame.label).to_owned();
            let end = match frame.definition.style {
                Style::Sub => format!("{name} endsub"),
                Style::Program => "M99".into(),
            };
            let message = format!("the file ends inside of the subroutine {name}");
            self.leave(run)?;
            return Err(Problem::error("missing-end", Blame::Block, message, format!("add {end}")));
        }
        run.state.progress.ended = true;
        match self.files.get(0) {
            Some(program) if program.is_closed() => Ok(()),
            Some(program) if program.is_tape() => {
                let message = "the program ends without the % that belongs to its first line, and without M2";
                Err(Problem::error(
                    "no-program-end",
                    Blame::Block,
                    message,
                    "end it with M2, M30 or a line with %",
                ))
            }
            _ => {
                let message = "the program ends without M2 or M30";
                Err(Problem::error("no-program-end", Blame::Block, message, "end it with M2 or M30"))
            }
        }
    }
}
