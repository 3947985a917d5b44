//! G-code to canonical machining functions: the language of pitchlock.
//!
//! In: part programs as they exist on disks (RS274/NGC as lathes and mills speak it, or FANUC lathe programs), a tool
//! table, a parameter file. Out: a stream of [`Call`]s, each with the line it comes from, and [`Diagnostic`]s. Nothing
//! here knows a machine: limits, axes and threads are the business of whoever receives the calls.
//!
//! | module | from | to |
//! |---|---|---|
//! | [`source`] | a file, standard input, a text | lines, in constant memory, with a way back for loops |
//! | [`words`] | a line | a [`Block`]: words with values (expressions, parameters, comments) |
//! | `flow` | O-words, M98, M99 | the line that comes next |
//! | `execute` | a block and the [`State`] | calls, in the order of RS274/NGC |
//! | `fanuc` | a FANUC lathe program | the same calls |
//! | [`job`] | lines with `;@`, a job file | the text of a job |
//! | [`canon`] | calls | text, as LinuxCNC's `rs274` prints it or tidier |
//! | [`alone`] | one line, one value | a [`Block`], a number |
//! | [`files`] | tool table, parameter file, machine file | values |
#![forbid(unsafe_code)]

pub mod alone;
pub mod block;
pub mod canon;
pub mod codes;
pub mod execute;
mod fanuc;
pub mod files;
mod flow;
pub mod job;
mod options;
pub mod problem;
mod program;
pub mod source;
pub mod state;
mod watch;
pub mod words;

pub use block::Block;
pub use canon::{Call, Place, Position, Sink};
pub use options::{Dialect, Limits, Options};
pub use problem::{Diagnostic, Problem, Severity};
pub use program::{Program, Step};
pub use state::State;
