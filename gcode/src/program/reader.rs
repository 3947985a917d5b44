//! The readers of the dialects, and of files that are jobs: equals, each with its own flow and its own
//! blocks.
//!
//! In: the files of a program. Out: calls, line by line.

use crate::block::Block;
use crate::codes::G;
use crate::execute::{self, Done, Output};
use crate::options::{Dialect, Options};
use crate::state::State;
use crate::text::{Files, job};
use crate::{fanuc, ngc};

/// What reads and executes the lines of a program.
pub(super) enum Reader {
    Ngc(Box<ngc::Control>),
    Fanuc(Box<fanuc::Control>),
    /// A file that is a job.
    Job(Box<JobFile>),
}

/// A file that is a job, and the block that its problems are placed by.
pub(super) struct JobFile {
    files: Files,
    block: Block,
}

impl Reader {
    /// The reader of the dialect that the options name.
    pub(super) fn new(files: Files, options: &Options) -> Reader {
        match options.dialect {
            Dialect::Linuxcnc => Reader::Ngc(Box::new(ngc::Control::new(files, options))),
            Dialect::Fanuc | Dialect::FanucMill => {
                Reader::Fanuc(Box::new(fanuc::Control::new(files, options)))
            }
        }
    }

    /// Goes on with another text. What LinuxCNC keeps from block to block is in the state.
    pub(super) fn goes_on(&mut self, files: Files, options: &Options) {
        match self {
            Reader::Fanuc(reader) => reader.goes_on(files, options),
            Reader::Ngc(_) | Reader::Job(_) => *self = Reader::new(files, options),
        }
    }

    /// What moves the words of a block that has no code for them, where the state does not tell.
    pub(super) fn motion(&self) -> Option<G> {
        match self {
            Reader::Fanuc(reader) => Some(reader.motion()),
            Reader::Ngc(_) | Reader::Job(_) => None,
        }
    }

    /// The reader of a file that is a job.
    pub(super) fn of_job(files: Files) -> Reader {
        Reader::Job(Box::new(JobFile { files, block: Block::default() }))
    }

    /// Reads and executes the next line. The state tells whether it was the last.
    ///
    /// # Errors
    /// What is wrong with the line, or what the sink refuses.
    pub(super) fn next(&mut self, state: &mut State, out: &mut Output) -> Done {
        match self {
            Reader::Ngc(reader) => reader.next(state, out),
            Reader::Fanuc(reader) => reader.next(state, out),
            Reader::Job(reader) => reader.next(state, out),
        }
    }

    /// Something was wrong: nothing is repeated any more.
    pub(super) fn only_look(&mut self, state: &mut State) {
        match self {
            Reader::Ngc(reader) => reader.only_look(state),
            Reader::Fanuc(reader) => reader.only_look(),
            Reader::Job(_) => {}
        }
    }

    /// How many subroutines have been called that have not returned.
    pub(super) fn depth(&self) -> usize {
        match self {
            Reader::Ngc(reader) => reader.depth(),
            Reader::Fanuc(reader) => reader.depth(),
            Reader::Job(_) => 0,
        }
    }

    /// The block that was read last.
    pub(super) fn block(&self) -> &Block {
        match self {
            Reader::Ngc(reader) => reader.block(),
            Reader::Fanuc(reader) => reader.block(),
            Reader::Job(reader) => &reader.block,
        }
    }

    /// The files of the program.
    pub(super) fn files(&self) -> &Files {
        match self {
            Reader::Ngc(reader) => reader.files(),
            Reader::Fanuc(reader) => reader.files(),
            Reader::Job(reader) => &reader.files,
        }
    }

    /// The files of the program, to read a line again.
    pub(super) fn files_mut(&mut self) -> &mut Files {
        match self {
            Reader::Ngc(reader) => reader.files_mut(),
            Reader::Fanuc(reader) => reader.files_mut(),
            Reader::Job(reader) => &mut reader.files,
        }
    }

    /// A message in the words of the program.
    pub(super) fn in_its_words(&self, text: String) -> String {
        match self {
            Reader::Fanuc(reader) => reader.in_its_words(text),
            Reader::Ngc(_) | Reader::Job(_) => text,
        }
    }

    /// The value of a common variable of FANUC: `None` if there is none of this number, `Some(None)` if it is
    /// vacant.
    pub(super) fn shared(&self, number: u32) -> Option<Option<f64>> {
        match self {
            Reader::Fanuc(reader) => reader.shared(number),
            Reader::Ngc(_) | Reader::Job(_) => None,
        }
    }
}

impl JobFile {
    fn next(&mut self, state: &mut State, out: &mut Output) -> Done {
        state.progress.ended = true;
        let read = job::read_file(&mut self.files);
        let job = read.inspect_err(|_| self.block.clear(0, self.files.mark().lines))?;
        out.place.line = job.line;
        execute::job(&job, state, out)
    }
}
