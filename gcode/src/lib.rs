//! G-code to canonical machining functions: RS274/NGC as lathes and mills speak it, and FANUC lathe programs.
//!
//! In: part programs as they exist on disks, a tool table, a parameter file. Out: a stream of [`Call`]s, each
//! with the line it comes from, and [`Diagnostic`]s. Nothing here knows a machine: limits, axes and threads
//! are the business of whoever receives the calls.
//!
//! # Text in, calls out
//!
//! ```
//! use gcode::{Call, Options, Place, Problem, Program, Sink, Step};
//!
//! /// Writes down where the tool goes.
//! struct Moves(Vec<String>);
//!
//! impl Sink for Moves {
//!     fn call(&mut self, place: Place, call: Call<'_>) -> Result<(), Box<Problem>> {
//!         if let Call::StraightTraverse(to) | Call::StraightFeed(to) = call {
//!             self.0.push(format!("line {}: X{} Z{}", place.line, to[0], to[2]));
//!         }
//!         Ok(())
//!     }
//! }
//!
//! let text = "G21 G18 G90 F100\n#1 = 4\nG0 X10 Z2\nG1 Z[2 - 3*#1]\nM2\n";
//! let mut program = Program::from_text("part.ngc", text, &Options::default());
//! let mut moves = Moves(Vec::new());
//! while program.step(&mut moves)? == Step::More {}
//! assert_eq!(moves.0, ["line 3: X10 Z2", "line 4: X10 Z-10"]);
//! # Ok::<(), Box<gcode::Diagnostic>>(())
//! ```
//!
//! What is wrong with a program comes with its place and a remedy:
//!
//! ```
//! # use gcode::{Call, Options, Place, Problem, Program, Sink};
//! # struct Nowhere;
//! # impl Sink for Nowhere {
//! #     fn call(&mut self, _: Place, _: Call<'_>) -> Result<(), Box<Problem>> { Ok(()) }
//! # }
//! let mut program = Program::from_text("part.ngc", "G1 X5\n", &Options::default());
//! let diagnostic = program.step(&mut Nowhere).unwrap_err();
//! assert_eq!(diagnostic.headline(), "part.ngc:1:1: error[no-feed]: there is no feed for a move that cuts");
//! println!("{}", diagnostic.render(false)); // the line, a caret, and what to do about it
//! ```
//!
//! # How it is built
//!
//! Every room depends on those below it only.
//!
//! | room | from | to |
//! |---|---|---|
//! | `program` | text and [`Options`] | calls and diagnostics, line by line |
//! | `ngc`, `fanuc` | lines of a dialect | blocks, and the line that comes next |
//! | `execute` | a block and the state | calls, in the order of RS274/NGC |
//! | `state` | | what stays in force from block to block |
//! | `geometry` | contours, tools | passes, the way of a tool's centre |
//! | `text` | a file, standard input, a text | lines in constant memory, characters, numbers, comments |
//! | [`canon`] | calls | text, as LinuxCNC's `rs274` prints it or tidier |
//! | [`files`] | tool table, parameter file, machine file | values |
//! | [`alone`] | one line, one value | what it says, a number |
//!
//! Lines that begin with `;@` are a [`Job`]: text for a receiver that knows what to do with it, see
//! [`Sink::job`].
#![forbid(unsafe_code)]

pub mod alone;
mod block;
mod bounds;
pub mod canon;
pub mod codes;
mod execute;
mod fanuc;
pub mod files;
mod foreign;
mod geometry;
mod guess;
mod ngc;
mod options;
mod plane;
pub mod problem;
mod program;
mod state;
mod text;

pub use canon::{Call, Job, Place, Pose, Sink};
pub use fanuc::{in_system_a, is_system_b, program_files};
pub use foreign::foreign;
pub use guess::{Guess, guess, guess_of_mill};
pub use options::{DecimalPoint, Dialect, Limits, MachineCode, Options, Skips, UnknownDialect};
pub use problem::{Diagnostic, Problem, Severity};
pub use program::{Outlasting, Program, Step, Waits};
pub use text::{job_line, readable};
