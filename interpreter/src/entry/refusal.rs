//! Why a program is not begun at a line, with what to do instead.

use gcode::Diagnostic;

/// Why a program is not begun at a line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoEntry {
    /// The program is wrong.
    #[error("{}", .0.render(false))]
    Wrong(Box<Diagnostic>),
    /// It is a file without lines that could be begun at.
    #[error("{what} has no lines to begin at: --from is for part programs (G-code)")]
    NoLines {
        /// What it is.
        what: &'static str,
    },
    /// The kinematics are those of a positioner, which does nothing but jobs.
    #[error("a positioner does jobs, and a job has no lines to begin at: start it from its beginning")]
    Positioner,
    /// The line is executed by a call only.
    #[error("line {line} is in a subprogram that line {caller} calls: begin at line {caller}")]
    Subprogram {
        /// The line.
        line: u32,
        /// The line of the program that calls it.
        caller: u32,
    },
    /// Others are executed, the line is not.
    #[error(
        "line {line} is not executed by itself: it is in a subprogram, the contour of a cycle or a branch that is not taken, or \
         it is jumped over; the next line that is executed is line {next}"
    )]
    PassedOver {
        /// The line.
        line: u32,
        /// The next one that is executed.
        next: u32,
    },
    /// The program ends before.
    #[error("the program comes to its end before line {line}: name an earlier line")]
    BehindEnd {
        /// The line.
        line: u32,
    },
    /// No move follows.
    #[error("from line {line} on nothing moves any more: there is nothing to begin with")]
    NothingMoves {
        /// The line.
        line: u32,
    },
    /// Moves of a contour wait for each other.
    #[error(
        "line {line} is in a contour with compensation (G41, G42), of which each move ends where the next one says: begin at \
         the line that switches it on"
    )]
    Contour {
        /// The line.
        line: u32,
    },
    /// A corner is rounded.
    #[error(
        "line {line} ends a corner that the line before rounds or chamfers: begin at the line before, or at a later one"
    )]
    Corner {
        /// The line.
        line: u32,
    },
    /// Threads that follow each other are one pass.
    #[error(
        "line {line} is in a chain of threads that begins in line {begins}, and a chain is one pass, from one index of the \
         spindle: begin at line {begins}"
    )]
    Chain {
        /// The line.
        line: u32,
        /// Where the chain begins.
        begins: u32,
    },
    /// A thread before it does not lead the tool out.
    #[error(
        "the thread of line {thread} ends in its groove, and line {line} begins there: begin at line {thread}, or behind the \
         move that takes the tool out"
    )]
    InGroove {
        /// The line.
        line: u32,
        /// That of the thread.
        thread: u32,
    },
    /// Where a work ends is known when it has been done.
    #[error(
        "the contour, surface or seam of line {work} lies before line {line}: start the program from its beginning"
    )]
    Work {
        /// The line.
        line: u32,
        /// That of the work.
        work: u32,
    },
    /// Nothing that the program does leads to the place.
    #[error(
        "the program leads the tool to where line {line} begins by nothing that could be gone again: begin at another line"
    )]
    NoWay {
        /// The line.
        line: u32,
    },
    /// There are too many moves to find a way over.
    #[error(
        "the tool in place makes more than {most} moves before line {line}: begin where it is put in, or earlier"
    )]
    TooLong {
        /// The line.
        line: u32,
        /// So many are looked at.
        most: usize,
    },
}
