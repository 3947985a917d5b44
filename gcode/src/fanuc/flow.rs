//! Which line comes next: GOTO, WHILE, M98, G65, M99.
//!
//! In: labels and program numbers. Out: the place where the program goes on. Programs begin with O; the main
//! program is the first of its file, a subprogram another of the same file, or a file of its own, `O1000.nc`.
//! A place that was searched once is remembered: a loop does not search again.

use std::collections::{BTreeMap, BTreeSet};

use super::labels::{Heading, Wanted};
use crate::execute::Done;
use crate::problem::{Blame, Problem};
use crate::text::{Files, Mark};

/// The names that the file of a program may have, in the order in which they are looked for.
pub fn program_files(program: u32) -> impl Iterator<Item = String> {
    const ENDINGS: [&str; 4] = [".nc", ".ngc", ".NC", ""];
    let stems =
        [format!("O{program:04}"), format!("o{program:04}"), format!("O{program}"), format!("o{program}")];
    stems.into_iter().flat_map(|stem| ENDINGS.map(|ending| format!("{stem}{ending}")))
}

/// A subprogram that is being run.
#[derive(Clone, Debug)]
struct Level {
    /// Where it begins: after its O.
    file: usize,
    beginning: Mark,
    /// Where the caller goes on, and where the caller's own program begins is told by the level below.
    back: (usize, Mark),
    /// Times that it is run after this one.
    repeats: u32,
    /// It was called by G65: it has variables of its own.
    macro_call: bool,
    /// Loops that were open when it was called.
    loops: usize,
}

/// A loop that is being run.
#[derive(Clone, Copy, Debug)]
struct Loop {
    number: u8,
    at: Mark,
    end: Mark,
}

/// Where a program is.
pub(super) struct Flow {
    pub(super) files: Files,
    levels: Vec<Level>,
    loops: Vec<Loop>,
    /// Lines that were searched for: from a file and a line.
    found: BTreeMap<(usize, u32, Wanted), Mark>,
    programs: BTreeMap<u32, (usize, Mark)>,
    /// Programs that were called since the first error: they are also looked through once.
    looked: BTreeSet<u32>,
    deepest: u32,
    /// Nothing was wrong so far. From the first error on nothing is repeated: the rest is looked through
    /// once.
    pub(super) repeats: bool,
    /// The beginning of a loop may have been refused.
    lost: bool,
}

/// What M99 came back from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Left {
    /// The main program.
    Main,
    /// A subprogram of M98; it is run once more.
    Again,
    /// A macro of G65; it is run once more.
    MacroAgain,
    /// A subprogram of M98.
    Subprogram,
    /// A macro of G65.
    Macro,
}

impl Flow {
    pub(super) fn new(files: Files, deepest: u32) -> Flow {
        Flow {
            files,
            levels: Vec::new(),
            loops: Vec::new(),
            found: BTreeMap::new(),
            programs: BTreeMap::new(),
            looked: BTreeSet::new(),
            deepest,
            repeats: true,
            lost: false,
        }
    }

    /// Depth of calls.
    pub(super) fn depth(&self) -> usize {
        self.levels.len()
    }

    /// Whether a loop is open.
    pub(super) fn is_in_loop(&self) -> bool {
        !self.loops.is_empty()
    }

    /// Whether a file begins here: its O may come.
    pub(super) fn at_beginning(&self) -> bool {
        self.files.mark() == beginning_of(&self.files, self.files.current())
    }

    /// The beginning of the program that is being run.
    fn beginning(&self) -> Mark {
        self.levels.last().map_or_else(|| beginning_of(&self.files, 0), |level| level.beginning)
    }

    /// GOTO: the next line with this N, else the first one of the program.
    ///
    /// # Errors
    /// The program has none.
    pub(super) fn goto(&mut self, label: u32) -> Done {
        let target = self.label(label)?;
        if !self.repeats && target.lines < self.files.mark().lines {
            return Ok(());
        }
        let base = self.levels.last().map_or(0, |level| level.loops);
        let lines = target.lines;
        let outside = |open: &Loop| lines <= open.at.lines || lines > open.end.lines;
        if let Some(first) = self.loops.iter().skip(base).position(outside) {
            self.loops.truncate(base + first);
        }
        self.files.go(self.files.current(), target)
    }

    /// Where the line with an N begins, looked for as GOTO does. The program stays where it is.
    ///
    /// # Errors
    /// The program has none.
    pub(super) fn label(&mut self, label: u32) -> Result<Mark, Box<Problem>> {
        let here = self.files.mark();
        if let Some(mark) = self.search(here, None, Wanted::Label(label))? {
            return Ok(mark);
        }
        let beginning = self.beginning();
        self.search(beginning, Some(here), Wanted::Label(label))?.ok_or_else(|| {
            let help = "write this N in front of a block of the same program";
            Problem::error(
                "unknown-label",
                Blame::Block,
                format!("no block of this program has N{label}"),
                help,
            )
        })
    }

    /// Whether a line with this N stands at a place or behind it.
    pub(super) fn is_behind(&mut self, place: Mark, label: u32) -> Result<bool, Box<Problem>> {
        Ok(self.search(place, None, Wanted::Label(label))?.is_some())
    }

    /// WHILE and DO, at the line that begins at `at`: enters the loop or goes after its end.
    ///
    /// # Errors
    /// The loop has no end, or loops cross.
    pub(super) fn begin(&mut self, number: u8, at: Mark, enter: bool) -> Done {
        let base = self.levels.last().map_or(0, |level| level.loops);
        if let Some(open) = self.loops.iter().skip(base).position(|open| open.number == number) {
            let same = self.loops.get(base + open).is_some_and(|open| open.at == at);
            if !same {
                let message = format!("DO {number} begins inside of another DO {number}");
                return Err(Problem::error(
                    "bad-loop",
                    Blame::Block,
                    message,
                    "number loops inside each other differently",
                ));
            }
            self.loops.truncate(base + open);
        }
        let here = self.files.mark();
        let Some(end) = self.search(here, None, Wanted::End(number))? else {
            let message = format!("DO {number} has no END {number} after it");
            return Err(Problem::error(
                "bad-loop",
                Blame::Block,
                message,
                "write END after the last block of the loop",
            ));
        };
        if let Some(outer) =
            self.loops.get(base..).and_then(<[Loop]>::last).filter(|outer| end.lines > outer.end.lines)
        {
            let message = format!("DO {number} and DO {} cross", outer.number);
            return Err(Problem::error(
                "bad-loop",
                Blame::Block,
                message,
                "end the inner loop before the outer one",
            ));
        }
        if enter {
            self.loops.push(Loop { number, at, end });
            return Ok(());
        }
        self.files.go(self.files.current(), end)?;
        self.files.take().map(|_| ())
    }

    /// A line without words was refused: it may have been the beginning of a loop.
    pub(super) fn lost_a_loop(&mut self) {
        self.lost = true;
    }

    /// END: back to the beginning of the loop.
    ///
    /// # Errors
    /// No such loop is open.
    pub(super) fn end(&mut self, number: u8) -> Done {
        let base = self.levels.last().map_or(0, |level| level.loops);
        let open = self.loops.iter().skip(base).position(|open| open.number == number);
        let Some(open) = open.and_then(|open| self.loops.get(base + open).copied()) else {
            if self.lost {
                return Ok(());
            }
            let message = format!("END {number} without DO {number} before it");
            return Err(Problem::error(
                "bad-loop",
                Blame::Block,
                message,
                "begin the loop with WHILE [..] DO; do not jump into it",
            ));
        };
        if !self.repeats {
            return Ok(());
        }
        self.files.go(self.files.current(), open.at)
    }

    /// M98 and G65. Whether the program is entered.
    ///
    /// # Errors
    /// There is no such program, or calls are too deep.
    pub(super) fn call(&mut self, program: u32, times: u32, macro_call: bool) -> Result<bool, Box<Problem>> {
        if times == 0 || !self.repeats && !self.looked.insert(program) {
            return Ok(false);
        }
        self.not_too_deep()?;
        let back = (self.files.current(), self.files.mark());
        let (file, mark) = self.program(program)?;
        self.files.go(file, mark)?;
        let beginning = mark;
        let loops = self.loops.len();
        self.levels.push(Level { file, beginning, back, repeats: times - 1, macro_call, loops });
        Ok(true)
    }

    /// M97: a part of the same program, from the block with this N to M99.
    ///
    /// # Errors
    /// There is no such block, or calls are too deep.
    pub(super) fn call_block(&mut self, label: u32, times: u32) -> Result<bool, Box<Problem>> {
        // Numbers of programs are far smaller.
        if times == 0 || !self.repeats && !self.looked.insert(u32::MAX - label) {
            return Ok(false);
        }
        self.not_too_deep()?;
        let beginning = self.label(label)?;
        let (file, back) = (self.files.current(), (self.files.current(), self.files.mark()));
        self.files.go(file, beginning)?;
        let loops = self.loops.len();
        self.levels.push(Level { file, beginning, back, repeats: times - 1, macro_call: false, loops });
        Ok(true)
    }

    /// # Errors
    /// One call more would be too many.
    fn not_too_deep(&self) -> Done {
        if self.levels.len() < self.deepest as usize {
            return Ok(());
        }
        let message = format!("more than {} calls inside each other, the limit call_depth", self.deepest);
        let help = "check whether the program calls itself";
        Err(Problem::error("calls-too-deep", Blame::Block, message, help))
    }

    /// M99: once more, or back to the caller (to its block `label`).
    ///
    /// # Errors
    /// The caller has no such block.
    pub(super) fn leave(&mut self, label: Option<u32>) -> Result<Left, Box<Problem>> {
        let Some(level) = self.levels.last_mut() else { return Ok(Left::Main) };
        self.loops.truncate(level.loops);
        if level.repeats > 0 && self.repeats {
            level.repeats -= 1;
            let (file, mark, macro_call) = (level.file, level.beginning, level.macro_call);
            self.files.go(file, mark)?;
            return Ok(if macro_call { Left::MacroAgain } else { Left::Again });
        }
        let ((file, mark), macro_call) = (level.back, level.macro_call);
        self.levels.pop();
        self.files.go(file, mark)?;
        if let Some(label) = label {
            self.goto(label)?;
        }
        Ok(if macro_call { Left::Macro } else { Left::Subprogram })
    }

    /// Where a program begins: in the main file, in the file of the caller, or in one of its own.
    fn program(&mut self, program: u32) -> Result<(usize, Mark), Box<Problem>> {
        if let Some(place) = self.programs.get(&program) {
            return Ok(*place);
        }
        let back = (self.files.current(), self.files.mark());
        let mut found = None;
        for file in [0, back.0] {
            self.files.go(file, beginning_of(&self.files, file))?;
            let from = self.files.mark();
            let line = self.search(from, None, Wanted::Program(program))?;
            if let Some(mark) = line {
                self.files.go(file, mark)?;
                self.files.take()?;
                found = Some((file, self.files.mark()));
                break;
            }
        }
        self.files.go(back.0, back.1)?;
        for name in program_files(program) {
            if found.is_none() {
                let file = self.files.open_file(&name)?;
                found = file.map(|file| (file, beginning_of(&self.files, file)));
            }
        }
        let Some(place) = found else {
            let message = format!("there is no program O{program:04}");
            let help =
                format!("write it after the main program, or save it as O{program:04}.nc in its folder");
            return Err(Problem::error("no-subroutine", Blame::Block, message, help));
        };
        self.programs.insert(program, place);
        Ok(place)
    }

    /// The first line from a mark (to another) that holds what is wanted. Labels and END are looked for up to
    /// the next program.
    fn search(&mut self, from: Mark, to: Option<Mark>, wanted: Wanted) -> Result<Option<Mark>, Box<Problem>> {
        let file = self.files.current();
        let key = (file, from.lines, wanted);
        if let Some(mark) = self.found.get(&key) {
            return Ok(Some(*mark));
        }
        let back = self.files.mark();
        self.files.go(file, from)?;
        let mut found = None;
        // The O of the program itself may stand on its first line.
        let mut inside = from != beginning_of(&self.files, file);
        while to.is_none_or(|to| self.files.mark().lines < to.lines) {
            // A line that is too long is reported when it is executed.
            let before = self.files.mark();
            let line = match self.files.take() {
                Ok(Some(line)) => line,
                Err(_) if self.files.mark() != before => continue,
                _ => break,
            };
            let heading = Heading::of(self.files.bytes(&line));
            if heading.is(wanted) {
                found = Some(line.mark);
                break;
            }
            if heading.program.is_some() && inside && !matches!(wanted, Wanted::Program(_)) {
                break;
            }
            inside |= heading.program.is_some();
        }
        self.files.go(file, back)?;
        if let Some(mark) = found {
            self.found.insert(key, mark);
        }
        Ok(found)
    }
}

fn beginning_of(files: &Files, file: usize) -> Mark {
    files.get(file).map_or(Mark::default(), |source| source.beginning())
}
